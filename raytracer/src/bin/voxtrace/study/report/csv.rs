//! All figures of all settings, for other programs.

use super::super::front::Front;
use super::super::record::{Errors, Setting, Study};
use std::io::Write;

/// Names of the figures of [`Errors`], to which `exact_` or `truth_` is put in front.
const ERRORS: [&str; 8] =
    ["depth_voxels", "depth_pixels", "normal_degrees", "color", "ssim", "flip", "silhouette", "other_voxels"];

/// Writes a line for each setting, after a line of names. What was not measured is empty.
///
/// # Errors
/// If `out` fails.
pub fn write(out: impl Write, study: &Study, front: &Front) -> anyhow::Result<()> {
    let mut lines = csv::WriterBuilder::new().terminator(csv::Terminator::CRLF).from_writer(out);
    let mut names: Vec<String> = [
        "knob",
        "setting",
        "place",
        "is_default",
        "is_exact",
        "is_on_front",
        "distance_from_front",
        "seconds_median",
        "seconds_least",
        "seconds_most",
        "repetitions",
        "instructions",
        "rays",
        "steps",
        "octree_bytes",
        "preparation_seconds",
    ]
    .map(str::to_string)
    .to_vec();
    for reference in ["exact", "truth"] {
        names.extend(ERRORS.iter().map(|name| format!("{reference}_{name}")));
    }
    names.extend(["picture", "difference", "command"].map(str::to_string));
    lines.write_record(&names)?;
    for (index, setting) in study.settings.iter().enumerate() {
        lines.write_record(values(index, setting, front))?;
    }
    lines.flush()?;
    Ok(())
}

fn values(index: usize, setting: &Setting, front: &Front) -> Vec<String> {
    let cost = &setting.cost;
    let mut values = vec![
        setting.knob.clone(),
        setting.label.clone(),
        setting.place.to_string(),
        setting.is_default.to_string(),
        setting.is_exact.to_string(),
        front.contains(index).to_string(),
        optional(front.distance(index)),
        cost.seconds.median.to_string(),
        cost.seconds.least.to_string(),
        cost.seconds.most.to_string(),
        cost.seconds.repetitions.to_string(),
        optional(cost.instructions),
        cost.rays.to_string(),
        cost.steps.to_string(),
        cost.bytes.to_string(),
        cost.preparation.to_string(),
    ];
    values.extend(errors(setting.against_exact.as_ref()));
    values.extend(errors(setting.against_truth.as_ref()));
    values.extend([
        optional(setting.picture.as_ref()),
        optional(setting.difference.as_ref()),
        setting.command.clone(),
    ]);
    values
}

/// In the order of [`ERRORS`].
fn errors(errors: Option<&Errors>) -> [String; 8] {
    let of = |value: fn(&Errors) -> f64| optional(errors.map(value));
    [
        of(|errors| errors.depth_voxels),
        of(|errors| errors.depth_pixels),
        of(|errors| errors.normal_degrees),
        of(|errors| errors.color),
        of(|errors| errors.ssim),
        of(|errors| errors.flip),
        of(|errors| errors.silhouette),
        optional(errors.and_then(|errors| errors.other_voxels)),
    ]
}

fn optional(value: Option<impl ToString>) -> String {
    value.map_or(String::new(), |value| value.to_string())
}
