//! `voxtrace check`: whether the traversal is right on a model.

use crate::model::ModelArguments;
use crate::render::parse_arithmetic;
use anyhow::bail;
use octvox_cli::{CommonArgs, Progress, print_json, print_line};
use octvox_raytracer::{
    Arithmetic, CheckOptions, CheckReport, Octree, Replay, ReplayedHit, Width, check, replay,
};
use serde::Serialize;

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
    /// How precisely rays are followed: single, or double, in which every voxel must be the exact one
    #[arg(long, value_name = "NAME", default_value = "single", value_parser = parse_arithmetic)]
    arithmetic: Arithmetic,
    /// Follow one ray again instead, by its number, in either arithmetic, and tell all about it
    #[arg(long, value_name = "NUMBER", conflicts_with = "rays")]
    replay: Option<u64>,
}

const EXAMPLES: &str = "\
Examples:
  voxtrace check bunny.vox
  voxtrace check bunny.obj -r 256 --rays 1e7 --seed 2 --json
  voxtrace check bunny.vox --arithmetic double
  voxtrace check bunny.vox --seed 2 --replay 123456

The exit status is 1 if a width or a beam makes a difference, a mismatch or a leak is found, a ray did not end, or a voxel
differs from the exact one in double precision.";

/// What is printed of a check.
#[derive(Serialize)]
struct Report<'a> {
    #[serde(flatten)]
    found: &'a CheckReport,
    /// The command that follows the worst ray again.
    replay: Option<String>,
}

/// A count, also as 1e7.
pub fn parse_count(text: &str) -> Result<u64, String> {
    let whole = text.parse::<u64>().ok();
    let float =
        || text.parse::<f64>().ok().filter(|count| count.fract() == 0.0 && (1.0..=1e15).contains(count));
    whole
        .or_else(|| float().map(|count| count as u64))
        .filter(|&count| count > 0)
        .ok_or_else(|| "expected a whole number above zero, such as 1000000 or 1e6".into())
}

impl Arguments {
    /// What to type to follow a ray again.
    fn command_to_replay(&self, ray: u64) -> String {
        let mut command = format!("voxtrace check {}", self.model.model.display());
        if let Some(depth) = self.model.resolution {
            command += &format!(" -r {}", 1u64 << depth);
        }
        if self.arithmetic != Arithmetic::default() {
            command += &format!(" --arithmetic {}", self.arithmetic.name());
        }
        command + &format!(" --seed {} --replay {ray}", self.seed)
    }
}

pub fn run(arguments: &Arguments, common: &CommonArgs) -> anyhow::Result<()> {
    let model = arguments.model.load(common)?;
    if let Some(ray) = arguments.replay {
        return run_replay(&model.octree, arguments, ray, common);
    }
    let options = CheckOptions {
        rays: arguments.rays,
        seed: arguments.seed,
        arithmetic: arguments.arithmetic,
        widths: Width::ALL.to_vec(),
    };
    // Single rays, and as many through the pixels of pictures.
    let rays = arguments.rays.saturating_mul(2);
    let progress = Progress::new(rays, common.quiet);
    progress.stage("checking", rays);
    let report = check(&model.octree, &options, |rays| progress.add(rays));
    progress.finish();
    let replay = report.worst_ray.map(|ray| arguments.command_to_replay(ray));
    if common.json {
        print_json(&Report { found: &report, replay })?;
    } else {
        print_table(&report, replay.as_deref())?;
    }
    if !report.is_right() {
        bail!(
            "{}: the traversal is wrong on this model, see the counts above",
            arguments.model.model.display()
        );
    }
    Ok(())
}

fn run_replay(octree: &Octree, arguments: &Arguments, ray: u64, common: &CommonArgs) -> anyhow::Result<()> {
    let replay = replay(octree, arguments.seed, ray);
    if common.json {
        print_json(&replay)?;
    } else {
        print_replay(&replay)?;
    }
    if replay.is_wrong {
        bail!("{}: the traversal is wrong on ray {ray}, see above", arguments.model.model.display());
    }
    Ok(())
}

fn print_replay(replay: &Replay) -> anyhow::Result<()> {
    let vector = |[x, y, z]: [f64; 3]| format!("{x}, {y}, {z}");
    let met = |hit: &Option<ReplayedHit>| {
        hit.map_or_else(
            || "nothing".into(),
            |ReplayedHit { cell: [x, y, z], size_log2, distance }| {
                format!("cell {x}, {y}, {z} (size {}) at distance {distance}", 1u64 << size_log2)
            },
        )
    };
    print_line(&format!("origin       {}", vector(replay.origin)))?;
    print_line(&format!("direction    {}", vector(replay.direction)))?;
    print_line(&format!("exact        {}", met(&replay.exact)))?;
    for width in &replay.widths {
        print_line(&format!(
            "{:>2} lanes     {}, {} cells visited",
            width.lanes,
            met(&width.hit),
            width.steps
        ))?;
    }
    print_line(&format!("double       {}, {} cells visited", met(&replay.double.hit), replay.double.steps))?;
    if let Some(error) = replay.distance_error {
        print_line(&format!("error        {error:.2e} voxels"))?;
    }
    for (is_so, what) in [
        (replay.widths_differ, "the widths differ"),
        (
            replay.is_other_voxel && !replay.is_mismatch,
            "another voxel than the exact one, as rounding explains",
        ),
        (replay.is_mismatch, "another voxel than the exact one, which rounding does not explain"),
        (replay.double_is_other_voxel, "another voxel than the exact one in double precision"),
        (replay.leaks, "a closed surface is crossed unseen"),
        (replay.is_guarded, "the bound on the number of steps stopped it"),
    ] {
        if is_so {
            print_line(what)?;
        }
    }
    Ok(())
}

fn print_table(report: &CheckReport, replay: Option<&str>) -> anyhow::Result<()> {
    let worst = replay.unwrap_or("none").to_owned();
    let leaks = report.leaks.map_or_else(|| "the model is not closed".into(), |leaks| leaks.to_string());
    let rows = [
        ("arithmetic", report.arithmetic.name().to_owned()),
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
        ("the ray to look at first", worst),
    ];
    // The command stands by itself below the numbers.
    let [numbers @ .., (name, command)] = &rows;
    numbers.iter().try_for_each(|(name, value)| print_line(&format!("{name:<36}{value:>20}")))?;
    print_line(&format!("{name:<36}{command}"))
}
