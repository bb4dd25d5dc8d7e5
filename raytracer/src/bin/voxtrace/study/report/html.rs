//! The page: one file that needs nothing else.

use super::super::front::{Front, NEAR};
use super::super::record::{Chapter, Errors, Knob, Setting, Study};
use super::escape::escape;
use super::font::Letters;
use super::front_plot::{self, Format};
use super::knob_plot;
use super::number::{Unit, memory};
use super::pictures::{badges, embed, gallery};
use super::table::{Column, Table, parse_figures};
use super::words;
use std::fmt::Write;
use std::path::Path;

/// What the page is made of.
pub struct Page<'a> {
    /// Where the pictures are.
    pub folder: &'a Path,
    pub study: &'a Study,
    pub front: &'a Front,
    /// To measure texts with.
    pub letters: &'a Letters,
}

impl Page<'_> {
    /// The whole file.
    pub fn to_html(&self) -> String {
        let mut html = format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\" />\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\" />\n\
             <title>{}: what accuracy costs in time</title>\n<style>\n{}</style>\n</head>\n<body>\n",
            escape(&self.study.title),
            include_str!("style.css")
        );
        html += &self.header();
        html += "<main>\n";
        html += &self.front_section();
        html += &self.truth();
        for (index, knob) in self.study.knobs.iter().enumerate() {
            html += &self.knob(index, knob);
        }
        for (index, part) in self.study.chapters.iter().enumerate() {
            html += &chapter(index, part);
        }
        html += &self.machine();
        html += &self.repeat();
        html += &words::glossary();
        let program = escape(&self.study.machine.program);
        let _ = write!(
            html,
            "</main>\n<footer>Written by {program}. All figures are in results.csv, the plots in plots.\
             </footer>\n<script>\n{}</script>\n</body>\n</html>\n",
            include_str!("sort.js")
        );
        html
    }

    fn header(&self) -> String {
        let study = self.study;
        let mut html = format!(
            "<header>\n<p class=\"kicker\">What accuracy costs in time</p>\n<h1>{}</h1>\n",
            escape(&study.title)
        );
        let [width, height] = study.size;
        let _ = writeln!(
            html,
            "<p class=\"facts\">{} of {}, pictures of {width} × {height} pixels, {} on {}</p>",
            words::count(study.settings.len(), "setting"),
            words::count(study.knobs.len(), "knob"),
            words::count(study.machine.threads, "thread"),
            escape(&study.machine.processor)
        );
        if study.is_quick {
            html += "<p class=\"notice\">This is the short study: fewer settings and repetitions, so times are \
                     less certain.</p>\n";
        }
        html += "<nav aria-label=\"Contents\"><ul>\n";
        let mut link = |id: &str, text: &str| {
            let _ = writeln!(html, "<li><a href=\"#{id}\">{}</a></li>", escape(text));
        };
        link("front", "Error over time");
        if has_truth(study) {
            link("truth", "The truth");
        }
        for (index, knob) in study.knobs.iter().enumerate() {
            link(&format!("knob-{index}"), &knob.title);
        }
        for (index, chapter) in study.chapters.iter().enumerate() {
            link(&format!("chapter-{index}"), &chapter.title);
        }
        link("machine", "Machine");
        link("repeat", "How to repeat it");
        link("glossary", "What the figures mean");
        html + "</ul></nav>\n</header>\n"
    }

    fn truth(&self) -> String {
        let study = self.study;
        if !has_truth(study) {
            return String::new();
        }
        let mut html = "<section id=\"truth\">\n<h2>The truth</h2>\n".to_string();
        html += &paragraphs(&study.truth);
        if let Some(name) = &study.truth_picture {
            let picture = embed(self.folder, name, "the truth");
            let _ = writeln!(html, "<figure class=\"truth\">{picture}</figure>");
        }
        html + "</section>\n"
    }

    fn front_section(&self) -> String {
        let (study, front) = (self.study, self.front);
        let mut html = "<section id=\"front\">\n<h2>Error over time</h2>\n".to_string();
        if front.points.is_empty() {
            html +=
                "<p>There is no setting with both a time and an error, so there is nothing to compare.</p>\n";
            return html + "</section>\n";
        }
        let _ = writeln!(
            html,
            "<p>Each point is a setting: the further to the left, the faster, and the lower, the closer to {}. \
             {} of {} are on the front: none of the others is at least as fast and as close.</p>",
            front.reference.name(),
            front.settings.len(),
            words::count(front.points.len(), "setting")
        );
        html += "<figure>\n";
        for (class, format) in [("wide", Format::WIDE), ("narrow", Format::NARROW)] {
            if let Some(plot) = front_plot::draw(study, front, format, self.letters) {
                html += &plot.to_svg(class);
            }
        }
        html += "<figcaption>Bars reach from the least to the greatest of the measured times. A pointer over a \
                 point is told its name and figures.</figcaption>\n</figure>\n";
        html += &self.defaults();
        html += "<h3>From preview to exact</h3>\n<p>The front, from its cheapest setting to its closest. \
                 Times are medians.</p>\n";
        html += &self.front_table().to_html();
        html + "</section>\n"
    }

    /// For each default a sentence.
    fn defaults(&self) -> String {
        let mut items = String::new();
        for (index, setting) in
            self.study.settings.iter().enumerate().filter(|(_, setting)| setting.is_default)
        {
            let Some(knob) = self.study.knobs.iter().find(|knob| knob.name == setting.knob) else { continue };
            let _ = writeln!(
                items,
                "<li><strong>{}: {}</strong>. {} {}</li>",
                escape(&knob.title),
                escape(&setting.label),
                escape(&knob.default_reason),
                words::distance(self.front, index)
            );
        }
        match items.is_empty() {
            true => items,
            false => format!(
                "<h3>Defaults</h3>\n<p>How far a setting is off the front is a factor: by how much less time its \
                 error could be had, or by how much less error in its time, whichever is smaller. Within {:.0} % \
                 it is as good as on the front.</p>\n<ul>\n{items}</ul>\n",
                (NEAR - 1.0) * 100.0
            ),
        }
    }

    fn front_table(&self) -> Table {
        let study = self.study;
        let settings: Vec<&Setting> =
            self.front.settings.iter().map(|&index| &study.settings[index]).collect();
        let times: Vec<f64> = settings.iter().map(|setting| setting.cost.seconds.median).collect();
        let unit = Unit::of_times(times.iter().copied());
        let first = times.first().copied().unwrap_or(0.0);
        let name = |setting: &&Setting| {
            let knob = study.knobs.iter().find(|knob| knob.name == setting.knob);
            let title = knob.map_or(&setting.knob, |knob| &knob.title);
            format!("{}: {}{}", escape(title), escape(&setting.label), badges(setting))
        };
        let error = |setting: &&Setting| self.front.reference.errors(setting).map(|errors| errors.flip);
        let slower = |&time: &f64| (first > 0.0).then(|| time / first);
        Table::of([
            Column::of_html("Setting", settings.iter().map(name)),
            Column::figures("Time", unit.name, times.iter().map(|&time| Some(time / unit.size))),
            Column::figures("Error", "FLIP", settings.iter().map(error)),
            Column::figures("Times slower", "than the first", times.iter().map(slower)),
            Column::commands("Command", settings.iter().map(|setting| setting.command.as_str())),
        ])
    }

    fn knob(&self, index: usize, knob: &Knob) -> String {
        let of_knob = self.study.settings.iter().filter(|setting| setting.knob == knob.name);
        let settings: Vec<&Setting> = of_knob.collect();
        let mut html = format!("<section id=\"knob-{index}\">\n<h2>{}</h2>\n", escape(&knob.title));
        html += &paragraphs(&knob.explanation);
        if settings.is_empty() {
            return html + "<p class=\"note\">No setting of it was measured.</p>\n</section>\n";
        }
        let plots = [
            knob_plot::draw_times(knob, &settings, self.letters),
            knob_plot::draw_errors(knob, &settings, self.letters),
        ];
        html += "<div class=\"plots\">\n";
        for plot in plots.iter().flatten() {
            let _ = writeln!(html, "<figure>{}</figure>", plot.to_svg("plot"));
        }
        html += "</div>\n<h3>What it costs</h3>\n";
        html += &costs(&settings).to_html();
        if let Some(errors) = errors(&settings) {
            html += "<h3>How far it is off</h3>\n";
            html += &errors.to_html();
        }
        let pictures = gallery(self.folder, &settings, self.front.reference);
        if !pictures.is_empty() {
            let _ = write!(html, "<h3>Pictures</h3>\n{pictures}");
        }
        html + "</section>\n"
    }

    fn machine(&self) -> String {
        let machine = &self.study.machine;
        let facts = [
            ("Processor", machine.processor.clone()),
            ("Threads", machine.threads.to_string()),
            ("Built for", machine.instruction_set.clone()),
            ("Memory", memory(machine.memory_bytes)),
            ("System", machine.system.clone()),
            ("Program", machine.program.clone()),
        ];
        let mut html = "<section id=\"machine\">\n<h2>Machine</h2>\n<dl class=\"pairs\">\n".to_string();
        for (name, value) in facts.iter().filter(|(_, value)| !value.is_empty()) {
            let _ = writeln!(html, "<dt>{name}</dt><dd>{}</dd>", escape(value));
        }
        html + "</dl>\n</section>\n"
    }

    fn repeat(&self) -> String {
        format!(
            "<section id=\"repeat\">\n<h2>How to repeat it</h2>\n<p>The whole study:</p>\n\
             <pre><code>{}</code></pre>\n<p>A single picture: the command beside its setting in the tables \
             above. Times differ from machine to machine and a little from run to run; errors and counts \
             do not.</p>\n</section>\n",
            escape(&self.study.command)
        )
    }
}

/// Whether there is anything to say about the truth, be it why there is none.
fn has_truth(study: &Study) -> bool {
    !study.truth.is_empty() || study.truth_picture.is_some()
}

/// Text with an element for each of its paragraphs, which empty lines separate.
fn paragraphs(text: &str) -> String {
    let paragraphs = text.split("\n\n").map(str::trim).filter(|paragraph| !paragraph.is_empty());
    paragraphs.map(|paragraph| format!("<p>{}</p>\n", escape(paragraph))).collect()
}

/// The names of settings with what they are besides.
fn names(settings: &[&Setting]) -> Column {
    let name = |setting: &&Setting| escape(&setting.label) + &badges(setting);
    Column::of_html("Setting", settings.iter().map(name))
}

fn costs(settings: &[&Setting]) -> Table {
    let each =
        |of: fn(&Setting) -> Option<f64>| settings.iter().map(|setting| of(setting)).collect::<Vec<_>>();
    let in_unit = |head: &str, unit: Unit, values: Vec<Option<f64>>| {
        Column::figures(head, unit.name, values.into_iter().map(|value| Some(value? / unit.size)))
    };
    let counted = |head: &str, values: Vec<Option<f64>>| {
        in_unit(head, Unit::of_counts(values.iter().copied().flatten()), values)
    };
    // What was not counted at all is no column of zeros.
    let if_any = |values: Vec<Option<f64>>| match values.iter().flatten().all(|&value| value == 0.0) {
        true => vec![None; values.len()],
        false => values,
    };
    let times = each(|setting| Some(setting.cost.seconds.median));
    let unit = Unit::of_times(times.iter().copied().flatten());
    let preparation = if_any(each(|setting| Some(setting.cost.preparation).filter(|&time| time > 0.0)));
    let preparation_unit = Unit::of_times(preparation.iter().copied().flatten());
    Table::of([
        names(settings),
        in_unit("Time", unit, times),
        in_unit("Least", unit, each(|setting| Some(setting.cost.seconds.least))),
        in_unit("Most", unit, each(|setting| Some(setting.cost.seconds.most))),
        counted("Instructions", each(|setting| Some(setting.cost.instructions? as f64))),
        counted("Rays", if_any(each(|setting| Some(setting.cost.rays as f64)))),
        counted("Steps", if_any(each(|setting| Some(setting.cost.steps as f64)))),
        in_unit("Octree", Unit::MEBIBYTES, if_any(each(|setting| Some(setting.cost.bytes as f64)))),
        in_unit("Preparation", preparation_unit, preparation),
        Column::commands("Command", settings.iter().map(|setting| setting.command.as_str())),
    ])
}

/// All errors of all settings; `None` if nothing was compared.
fn errors(settings: &[&Setting]) -> Option<Table> {
    type Measure = (&'static str, &'static str, fn(&Errors) -> Option<f64>);
    type Group = (&'static str, fn(&Setting) -> Option<&Errors>);
    const MEASURES: [Measure; 8] = [
        ("FLIP", "mean", |errors| Some(errors.flip)),
        ("1 − SSIM", "", |errors| Some(1.0 - errors.ssim)),
        ("Colour", "of 255", |errors| Some(errors.color)),
        ("Depth", "voxels", |errors| Some(errors.depth_voxels)),
        ("Depth", "pixels", |errors| Some(errors.depth_pixels)),
        ("Normal", "degrees", |errors| Some(errors.normal_degrees)),
        ("Outline", "%", |errors| Some(errors.silhouette * 100.0)),
        ("Other voxel", "%", |errors| Some(errors.other_voxels? * 100.0)),
    ];
    if settings.iter().all(|setting| setting.against_exact.is_none() && setting.against_truth.is_none()) {
        return None;
    }
    let times: Vec<f64> = settings.iter().map(|setting| setting.cost.seconds.median).collect();
    let unit = Unit::of_times(times.iter().copied());
    let mut columns = vec![
        names(settings),
        Column::figures("Time", unit.name, times.iter().map(|time| Some(time / unit.size))),
    ];
    let groups: [Group; 2] = [
        ("against the truth", |setting| setting.against_truth.as_ref()),
        ("against the exact setting", |setting| setting.against_exact.as_ref()),
    ];
    for (group, errors) in groups {
        columns.extend(MEASURES.map(|(head, unit, value)| {
            let values = settings.iter().map(|setting| value(errors(setting)?));
            Column::figures(head, unit, values).in_group(group)
        }));
    }
    Some(Table::of(columns))
}

fn chapter(index: usize, chapter: &Chapter) -> String {
    let mut html = format!("<section id=\"chapter-{index}\">\n<h2>{}</h2>\n", escape(&chapter.title));
    html += &paragraphs(&chapter.introduction);
    for table in &chapter.tables {
        if !table.title.is_empty() {
            let _ = writeln!(html, "<h3>{}</h3>", escape(&table.title));
        }
        if table.columns.is_empty() || table.rows.is_empty() {
            html += "<p class=\"note\">Nothing was measured.</p>\n";
        } else {
            let columns = table.columns.iter().enumerate().map(|(column, head)| {
                // Rows may be shorter than the head.
                let cell = |row: &Vec<String>| row.get(column).map_or("", String::as_str).to_string();
                let cells: Vec<String> = table.rows.iter().map(cell).collect();
                let cells: Vec<&str> = cells.iter().map(String::as_str).collect();
                match (column, parse_figures(&cells)) {
                    (1.., Some(values)) => Column::written(head, cells.into_iter().zip(values)),
                    _ => Column::texts(head, cells),
                }
            });
            html += &Table { columns: columns.collect() }.to_html();
        }
        if !table.note.is_empty() {
            let _ = writeln!(html, "<p class=\"note\">{}</p>", escape(&table.note));
        }
    }
    html + "</section>\n"
}
