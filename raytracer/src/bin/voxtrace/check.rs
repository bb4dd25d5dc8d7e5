//! `voxtrace check`: whether the traversal is right on a model.

use crate::model::ModelArguments;
use anyhow::bail;
use octvox_cli::{CommonArgs, Progress, print_json, print_line};
use octvox_raytracer::{CheckOptions, CheckReport, Width, check};

#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    #[command(flatten)]
    model: ModelArguments,
    /// Number of rays
    #[arg(long, value_name = "N", default_value = "1000000", value_parser = parse_count)]
    rays: u64,
    /// Where the random numbers begin
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
}

const EXAMPLES: &str = "\
Examples:
  voxtrace check bunny.vox
  voxtrace check bunny.obj -r 256 --rays 1e7 --seed 2 --json

The exit status is 1 if a width or a beam makes a difference, a mismatch or a leak is found, or a ray did not end.";

/// A count, also as 1e7.
fn parse_count(text: &str) -> Result<u64, String> {
    let whole = text.parse::<u64>().ok();
    let float =
        || text.parse::<f64>().ok().filter(|count| count.fract() == 0.0 && (1.0..=1e15).contains(count));
    whole
        .or_else(|| float().map(|count| count as u64))
        .filter(|&count| count > 0)
        .ok_or_else(|| "expected a whole number above zero, such as 1000000 or 1e6".into())
}

pub fn run(arguments: &Arguments, common: &CommonArgs) -> anyhow::Result<()> {
    let model = arguments.model.load(common)?;
    let options = CheckOptions { rays: arguments.rays, seed: arguments.seed, widths: Width::ALL.to_vec() };
    // Single rays, and as many through the pixels of pictures.
    let rays = arguments.rays.saturating_mul(2);
    let progress = Progress::new(rays, common.quiet);
    progress.stage("checking", rays);
    let report = check(&model.octree, &options, |rays| progress.add(rays));
    progress.finish();
    if common.json {
        print_json(&report)?;
    } else {
        print_table(&report)?;
    }
    if !report.is_right() {
        bail!(
            "{}: the traversal is wrong on this model, see the counts above",
            arguments.model.model.display()
        );
    }
    Ok(())
}

fn print_table(report: &CheckReport) -> anyhow::Result<()> {
    let leaks = report.leaks.map_or_else(|| "the model is not closed".into(), |leaks| leaks.to_string());
    let rows = [
        ("rays", report.rays.to_string()),
        ("rays from or to the inside", report.enclosed_rays.to_string()),
        ("widths differ", report.width_differences.to_string()),
        ("voxel differs from the exact", report.differences.to_string()),
        ("… and rounding does not explain it", report.mismatches.to_string()),
        ("leaks", leaks),
        ("most cells on a ray", report.max_steps.to_string()),
        ("stopped by the bound on steps", report.guard_hits.to_string()),
        ("largest error of a distance", format!("{:.2e} voxels", report.max_distance_error)),
        ("rays through pixels", report.picture_rays.to_string()),
        ("widths or beams differ", report.picture_differences.to_string()),
    ];
    rows.iter().try_for_each(|(name, value)| print_line(&format!("{name:<36}{value:>12}")))
}
