//! The first plot of a report: error over time, of all settings.

use super::super::front::{Front, Point};
use super::super::record::{Knob, Setting, Study};
use super::axis::{Axis, Scale};
use super::chart::{Chart, LINE_HEIGHT, Sample, draw_legend, text_width};
use super::drawing::{Align, Drawing, Form, Ink, Shape, TEXT_HEIGHT};
use super::font::Letters;
use super::label::{self, Area, Label, Obstacle};
use super::number::{duration, duration_tick, figure, tick};

/// Defaults closer to each other than this share a label.
const TOGETHER: f64 = 16.0;

/// How large the plot is, and how much is written into it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Format {
    pub size: [f64; 2],
    pub most_labels: usize,
}

impl Format {
    /// For a screen, for paper and for a file of its own.
    pub const WIDE: Self = Self { size: [1080.0, 680.0], most_labels: 18 };
    /// For a phone.
    pub const NARROW: Self = Self { size: [460.0, 520.0], most_labels: 5 };
}

/// A setting where it stands.
struct Spot<'a> {
    index: usize,
    setting: &'a Setting,
    knob: &'a Knob,
    /// Of the knob, among those that are on the plot.
    series: usize,
    at: [f64; 2],
    point: &'a Point,
}

/// Draws it. Without any point it is `None`.
pub fn draw(study: &Study, front: &Front, format: Format, letters: &Letters) -> Option<Drawing> {
    if front.points.is_empty() {
        return None;
    }
    let description = format!(
        "Error against {} over time per picture, one point for each of {} settings",
        front.reference.name(),
        front.points.len()
    );
    let mut drawing = Drawing::new(format.size, description);
    let [width, height] = format.size;
    let legend = legend(study, front);
    // Drawn once for its height.
    let scratch = &mut Drawing::new(format.size, String::new());
    let legend_height = draw_legend(scratch, &legend, [0.0; 2], width - 10.0, letters);
    let part = Area([0.0, 8.0, width, height - legend_height - 6.0]);
    let chart = chart(study, front, &part, letters);
    chart.draw_frame(&mut drawing);
    draw_legend(&mut drawing, &legend, [5.0, height - legend_height], width - 10.0, letters);

    let spots = spots(study, front, &chart);
    let steps = steps(front, &chart);
    drawing.line(&steps, 1.5, Ink::Text);
    for is_of_front in [false, true] {
        for spot in spots.iter().filter(|spot| front.contains(spot.index) == is_of_front) {
            draw_spot(&mut drawing, spot, front, &chart);
        }
    }
    draw_labels(&mut drawing, &spots, &steps, front, format.most_labels, &chart, letters);
    Some(drawing)
}

fn chart<'a>(study: &Study, front: &Front, part: &Area, letters: &'a Letters) -> Chart<'a> {
    let spread = |point: &Point| {
        let spread = study.settings[point.setting].cost.seconds;
        [point.seconds, spread.least, spread.most]
    };
    let times: Vec<f64> = front.points.iter().flat_map(spread).collect();
    let errors: Vec<f64> = front.points.iter().map(|point| point.error).collect();
    let y_title = format!("Error: mean FLIP against {}", front.reference.name());
    Chart::within(
        part,
        Axis::of("Time per picture", &times, Scale::Logarithmic, duration_tick),
        Axis::of(&y_title, &errors, Scale::Logarithmic, tick),
        letters,
    )
}

fn series(study: &Study) -> impl Iterator<Item = (usize, &Knob)> {
    study.knobs.iter().filter(|knob| knob.is_on_front).enumerate()
}

fn legend(study: &Study, front: &Front) -> Vec<(Sample, String)> {
    let has_points =
        |knob: &Knob| front.points.iter().any(|point| study.settings[point.setting].knob == knob.name);
    let mut entries: Vec<_> = series(study)
        .filter(|(_, knob)| has_points(knob))
        .map(|(index, knob)| (Sample::Mark(index), knob.title.clone()))
        .collect();
    entries.push((Sample::Step, "front".to_string()));
    if front.points.iter().any(|point| study.settings[point.setting].is_default) {
        entries.push((Sample::Ring, "default".to_string()));
    }
    entries
}

fn spots<'a>(study: &'a Study, front: &'a Front, chart: &Chart<'_>) -> Vec<Spot<'a>> {
    let spot = |point: &'a Point| {
        let setting = &study.settings[point.setting];
        let (series, knob) = series(study).find(|(_, knob)| knob.name == setting.knob)?;
        let at = chart.at(point.seconds, point.error)?;
        Some(Spot { index: point.setting, setting, knob, series, at, point })
    };
    front.points.iter().filter_map(spot).collect()
}

/// The line of the least error that is had in a time: it falls where a point of the front stands.
fn steps(front: &Front, chart: &Chart<'_>) -> Vec<[f64; 2]> {
    let [_, top, right, _] = chart.area.0;
    let mut line: Vec<[f64; 2]> = Vec::new();
    for point in front.settings.iter().filter_map(|&index| front.point(index)) {
        let Some([x, y]) = chart.at(point.seconds, point.error) else { continue };
        let before = line.last().map_or(top, |last| last[1]);
        line.extend([[x, before], [x, y]]);
    }
    if let Some(&[_, y]) = line.last() {
        line.push([right, y]);
    }
    line
}

fn draw_spot(drawing: &mut Drawing, spot: &Spot<'_>, front: &Front, chart: &Chart<'_>) {
    let is_of_front = front.contains(spot.index);
    let ink = Ink::Series(spot.series);
    let spread = spot.setting.cost.seconds;
    let ends = [spread.least, spread.most].map(|time| chart.at(time, spot.point.error));
    if let [Some(from), Some(to)] = ends
        && to[0] - from[0] > 1.0
    {
        drawing.line(&[from, to], 1.0, ink).opacity = 0.7;
        for [x, y] in [from, to] {
            drawing.line(&[[x, y - 3.5], [x, y + 3.5]], 1.0, ink).opacity = 0.7;
        }
    }
    let radius = if is_of_front { 5.5 } else { 4.5 };
    let mark = Shape::Mark { middle: spot.at, radius, form: Form::of_series(spot.series) };
    let item = drawing.add(mark, ink);
    item.hint = hint(spot, front);
    item.opacity = if is_of_front { 1.0 } else { 0.6 };
    if spot.setting.is_default {
        drawing.add(Shape::Ring { middle: spot.at, radius: 9.0, width: 2.0 }, Ink::Text);
    }
}

fn hint(spot: &Spot<'_>, front: &Front) -> String {
    let mut lines = vec![
        format!("{}: {}", spot.knob.title, spot.setting.label),
        format!("{}, FLIP {}", duration(spot.point.seconds), figure(spot.point.error)),
    ];
    if spot.setting.is_default {
        lines.push("a default".to_string());
    }
    lines.push(match front.distance(spot.index) {
        _ if front.contains(spot.index) => "on the front".to_string(),
        Some(distance) => format!("off the front by a factor of {}", figure(distance)),
        None => String::new(),
    });
    lines.join("\n")
}

/// A label, the point that it names, and what a pointer over it is told.
struct Name {
    text: String,
    at: [f64; 2],
    is_bold: bool,
    hint: String,
}

/// The defaults, then both ends of the front, then the rest of it.
fn names(spots: &[Spot<'_>], front: &Front) -> Vec<Name> {
    let name = |spot: &Spot<'_>| format!("{}: {}", spot.knob.name, spot.setting.label);
    let distance = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
    let mut groups: Vec<Vec<&Spot<'_>>> = Vec::new();
    for spot in spots.iter().filter(|spot| spot.setting.is_default) {
        match groups.iter_mut().find(|group| distance(group[0].at, spot.at) < TOGETHER) {
            Some(group) => group.push(spot),
            None => groups.push(vec![spot]),
        }
    }
    let of_group = |group: &Vec<&Spot<'_>>| {
        let names: Vec<String> = group.iter().map(|spot| name(spot)).collect();
        let text = match names.as_slice() {
            [name] => name.clone(),
            _ => format!("{} defaults", names.len()),
        };
        Name { text, at: group[0].at, is_bold: true, hint: names.join("\n") }
    };
    let mut names: Vec<Name> = groups.iter().map(of_group).collect();

    let at_index = |index: usize| spots.iter().find(|spot| spot.index == index);
    let mut of_front: Vec<&Spot<'_>> = front.settings.iter().filter_map(|&index| at_index(index)).collect();
    if of_front.len() > 2 {
        // Both ends first.
        of_front[1..].rotate_right(1);
    }
    for spot in of_front.into_iter().filter(|spot| !spot.setting.is_default) {
        if names.iter().all(|name| distance(name.at, spot.at) > 3.0) {
            names.push(Name { text: name(spot), at: spot.at, is_bold: false, hint: String::new() });
        }
    }
    names
}

fn draw_labels(
    drawing: &mut Drawing,
    spots: &[Spot<'_>],
    steps: &[[f64; 2]],
    front: &Front,
    most: usize,
    chart: &Chart<'_>,
    letters: &Letters,
) {
    let mut names = names(spots, front);
    names.truncate(most);
    let to_label = |name: &Name| {
        let width = text_width(letters, &name.text) * if name.is_bold { 1.06 } else { 1.0 };
        Label { point: name.at, size: [width + 4.0, 1.2 * TEXT_HEIGHT], is_needed: name.is_bold }
    };
    let labels: Vec<Label> = names.iter().map(to_label).collect();
    let mut obstacles: Vec<Obstacle> = spots
        .iter()
        .map(|spot| {
            let reach = if spot.setting.is_default { 10.0 } else { 6.0 };
            Obstacle { area: Area::around(spot.at, reach, reach), weight: 40.0 }
        })
        .collect();
    obstacles.extend(
        steps.windows(2).map(|pair| Obstacle { area: Area::spanned(pair[0], pair[1]), weight: 25.0 }),
    );
    for (name, area) in names.iter().zip(label::place(&labels, &obstacles, &chart.area)) {
        let Some(area) = area else { continue };
        draw_leader(drawing, name.at, &area);
        let item = drawing.add(
            Shape::Text {
                text: name.text.clone(),
                at: area.middle(),
                align: Align::Middle,
                is_bold: name.is_bold,
                is_turned: false,
                has_halo: true,
            },
            Ink::Text,
        );
        item.hint.clone_from(&name.hint);
    }
}

/// A thin line from a point to a label that is not close to it.
fn draw_leader(drawing: &mut Drawing, [x, y]: [f64; 2], label: &Area) {
    let [left, top, right, bottom] = label.0;
    let end = [x.clamp(left, right), y.clamp(top, bottom)];
    let length = (end[0] - x).hypot(end[1] - y);
    if length > LINE_HEIGHT {
        let start = 10.0 / length;
        let from = [x + (end[0] - x) * start, y + (end[1] - y) * start];
        drawing.line(&[from, end], 1.0, Ink::Muted);
    }
}
