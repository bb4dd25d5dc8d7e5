//! The plots of a knob: time and error of its settings, by their place on its axis.

use super::super::record::{Errors, Knob, Setting};
use super::axis::{Axis, Scale};
use super::chart::{Chart, LINE_HEIGHT, Sample, draw_legend, text_width};
use super::drawing::{Align, Drawing, Form, Ink, Shape};
use super::font::Letters;
use super::label::Area;
use super::number::{duration, duration_tick, figure, tick};

/// Size of each of the two.
const SIZE: [f64; 2] = [560.0, 400.0];
/// Between them, and around them in a file.
const GAP: f64 = 20.0;

/// A line of points.
struct Series {
    name: &'static str,
    /// Which look it has.
    index: usize,
    is_dashed: bool,
    points: Vec<Value>,
}

struct Value {
    place: f64,
    value: f64,
    /// Least and most of repeated measurements.
    spread: Option<[f64; 2]>,
    is_default: bool,
    hint: String,
}

/// Time by place; `None` without a setting.
pub fn draw_times(knob: &Knob, settings: &[&Setting], letters: &Letters) -> Option<Drawing> {
    let points = settings.iter().map(|setting| {
        let spread = setting.cost.seconds;
        let hint = format!(
            "{}: {} ({} to {}, {} times)",
            setting.label,
            duration(spread.median),
            duration(spread.least),
            duration(spread.most),
            spread.repetitions
        );
        let ends = Some([spread.least, spread.most]);
        Value {
            place: setting.place,
            value: spread.median,
            spread: ends,
            is_default: setting.is_default,
            hint,
        }
    });
    let series = [Series { name: "time per picture", index: 0, is_dashed: false, points: points.collect() }];
    let values = values(&series);
    let y = Axis::of("Time per picture", &values, Scale::for_amounts(&values), duration_tick);
    draw(knob, settings, &series, y, letters)
}

/// Errors by place; `None` if there are none.
pub fn draw_errors(knob: &Knob, settings: &[&Setting], letters: &Letters) -> Option<Drawing> {
    let points = |name: &str, errors: fn(&Setting) -> Option<&Errors>| {
        let value = |setting: &&Setting| {
            let value = errors(setting)?.flip;
            let hint = format!("{}: FLIP {} {name}", setting.label, figure(value));
            let Setting { place, is_default, .. } = **setting;
            Some(Value { place, value, spread: None, is_default, hint })
        };
        settings.iter().filter_map(value).collect::<Vec<_>>()
    };
    let of = |name, index, is_dashed, errors| Series { name, index, is_dashed, points: points(name, errors) };
    let mut series = vec![
        of("against the truth", 0, false, |setting| setting.against_truth.as_ref()),
        of("against the exact setting", 1, true, |setting| setting.against_exact.as_ref()),
    ];
    series.retain(|series| !series.points.is_empty());
    let y = Axis::of("Error: mean FLIP", &values(&series), Scale::Logarithmic, tick);
    draw(knob, settings, &series, y, letters)
}

/// Both beside each other with a heading, for a file of their own.
pub fn draw_both(knob: &Knob, plots: &[Drawing]) -> Drawing {
    let heading = 2.0 * LINE_HEIGHT;
    let columns = plots.len().max(1) as f64;
    let size = [columns * (SIZE[0] + GAP) + GAP, SIZE[1] + heading + GAP];
    let mut both = Drawing::new(size, knob.title.clone());
    let title = both.text(&knob.title, [GAP, heading / 2.0], Align::Start, Ink::Text);
    if let Shape::Text { is_bold, .. } = &mut title.shape {
        *is_bold = true;
    }
    for (index, plot) in plots.iter().enumerate() {
        both.place(plot, [GAP + index as f64 * (SIZE[0] + GAP), heading]);
    }
    both
}

fn values(series: &[Series]) -> Vec<f64> {
    let of_point = |point: &Value| [point.value].into_iter().chain(point.spread.into_iter().flatten());
    series.iter().flat_map(|series| series.points.iter().flat_map(of_point)).collect()
}

fn draw(
    knob: &Knob,
    settings: &[&Setting],
    series: &[Series],
    y: Axis,
    letters: &Letters,
) -> Option<Drawing> {
    if series.iter().all(|series| series.points.is_empty()) {
        return None;
    }
    let description = format!("{}: {} by {}", knob.title, y.title, knob.axis);
    let mut drawing = Drawing::new(SIZE, description);
    let mut legend: Vec<_> = match series {
        [_] => Vec::new(),
        _ => series
            .iter()
            .map(|series| (Sample::Series(series.index, series.is_dashed), series.name.to_string()))
            .collect(),
    };
    if settings.iter().any(|setting| setting.is_default) {
        legend.push((Sample::Ring, "default".to_string()));
    }
    draw_legend(&mut drawing, &legend, [40.0, 0.0], SIZE[0] - 40.0, letters);
    // All plots are equally high, with a legend or without.
    let part = Area([0.0, LINE_HEIGHT + 8.0, SIZE[0], SIZE[1]]);
    let chart = Chart::within(&part, place_axis(knob, settings, letters), y, letters);
    chart.draw_frame(&mut drawing);
    for series in series {
        draw_series(&mut drawing, series, &chart);
    }
    Some(drawing)
}

/// The knob's axis, marked by its settings where there is room for their labels.
fn place_axis(knob: &Knob, settings: &[&Setting], letters: &Letters) -> Axis {
    let places: Vec<f64> = settings.iter().map(|setting| setting.place).collect();
    let scale = if knob.is_logarithmic { Scale::Logarithmic } else { Scale::Linear };
    let mut axis = Axis::of(&knob.axis, &places, scale, tick);
    // What the axis says need not be said by each mark.
    let unit = format!(" {}", knob.axis);
    let mut marks: Vec<(f64, String)> = settings
        .iter()
        .filter(|setting| axis.position(setting.place).is_some())
        .map(|setting| {
            (setting.place, setting.label.strip_suffix(&unit).unwrap_or(&setting.label).to_string())
        })
        .collect();
    marks.sort_by(|a, b| a.0.total_cmp(&b.0));
    marks.dedup();
    let length = SIZE[0] - 100.0;
    let ends = marks.iter().filter_map(|(place, text)| {
        let middle = axis.position(*place)? * length;
        let half = text_width(letters, text) / 2.0 + 3.0;
        Some([middle - half, middle + half])
    });
    let ends: Vec<[f64; 2]> = ends.collect();
    if !ends.is_empty() && ends.windows(2).all(|pair| pair[0][1] <= pair[1][0]) {
        axis.ticks = marks;
    }
    axis
}

fn draw_series(drawing: &mut Drawing, series: &Series, chart: &Chart<'_>) {
    let ink = Ink::Series(series.index);
    let mut placed: Vec<([f64; 2], &Value)> =
        series.points.iter().filter_map(|point| Some((chart.at(point.place, point.value)?, point))).collect();
    placed.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]));
    let points: Vec<[f64; 2]> = placed.iter().map(|(at, _)| *at).collect();
    if points.len() > 1 {
        drawing.add(Shape::Line { points, width: 1.5, is_dashed: series.is_dashed }, ink);
    }
    for (at, value) in placed {
        let ends = value.spread.map(|ends| ends.map(|end| chart.at(value.place, end)));
        if let Some([Some(least), Some(most)]) = ends {
            drawing.line(&[least, most], 1.0, ink).opacity = 0.7;
            for [x, y] in [least, most] {
                drawing.line(&[[x - 4.0, y], [x + 4.0, y]], 1.0, ink).opacity = 0.7;
            }
        }
        let mark = Shape::Mark { middle: at, radius: 5.0, form: Form::of_series(series.index) };
        drawing.add(mark, ink).hint.clone_from(&value.hint);
        if value.is_default {
            drawing.add(Shape::Ring { middle: at, radius: 9.0, width: 2.0 }, Ink::Text);
        }
    }
}
