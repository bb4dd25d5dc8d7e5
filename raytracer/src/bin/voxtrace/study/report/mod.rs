//! A study as files: a page for people, a table for programs, plots for papers.

mod axis;
mod bitmap;
mod chart;
mod csv;
mod drawing;
mod escape;
mod font;
mod front_plot;
mod html;
mod knob_plot;
mod label;
mod number;
mod pictures;
#[cfg(test)]
mod sample;
mod table;
#[cfg(test)]
mod tests;
mod words;

use super::front::front;
use super::record::{Setting, Study};
use anyhow::Context;
use drawing::{Drawing, TEXT_HEIGHT};
use font::Letters;
use front_plot::Format;
use html::Page;
use octvox_cli::write_atomically;
use std::io::Write;
use std::path::Path;

/// Columns of the plots' files.
const PLOT_WIDTH: u32 = 1200;

/// Writes `report.html`, `results.csv`, `plots/front.png` and a file in `plots` for each knob into the folder
/// in which the study's pictures are. Files appear whole or not at all; older ones are replaced. What the
/// study does not have is left out.
///
/// # Errors
/// If a file cannot be written. Pictures that cannot be read are named in the page instead.
pub fn write(folder: &Path, study: &Study) -> anyhow::Result<()> {
    let plots = folder.join("plots");
    std::fs::create_dir_all(&plots)
        .with_context(|| format!("{}: cannot make the folder", plots.display()))?;
    let front = front(study);
    let letters = Letters::of_height(TEXT_HEIGHT)?;
    if let Some(plot) = front_plot::draw(study, &front, Format::WIDE, &letters) {
        write_plot(&plots.join("front.png"), &plot)?;
    }
    for knob in &study.knobs {
        let of_knob = study.settings.iter().filter(|setting| setting.knob == knob.name);
        let settings: Vec<&Setting> = of_knob.collect();
        let drawn = [
            knob_plot::draw_times(knob, &settings, &letters),
            knob_plot::draw_errors(knob, &settings, &letters),
        ];
        let drawn: Vec<Drawing> = drawn.into_iter().flatten().collect();
        if !drawn.is_empty() {
            let path = plots.join(file_name(&knob.name)).with_extension("png");
            write_plot(&path, &knob_plot::draw_both(knob, &drawn))?;
        }
    }
    write_atomically(&folder.join("results.csv"), |out| csv::write(out, study, &front))?;
    let page = Page { folder, study, front: &front, letters: &letters }.to_html();
    write_atomically(&folder.join("report.html"), |out| Ok(out.write_all(page.as_bytes())?))
}

fn write_plot(path: &Path, plot: &Drawing) -> anyhow::Result<()> {
    let bytes = bitmap::to_png(plot, PLOT_WIDTH)?;
    write_atomically(path, |out| Ok(out.write_all(&bytes)?))
}

/// A knob's name with only such characters as every system allows in the name of a file.
fn file_name(name: &str) -> String {
    name.chars().map(|c| if c.is_alphanumeric() || c == '_' { c } else { '-' }).collect()
}
