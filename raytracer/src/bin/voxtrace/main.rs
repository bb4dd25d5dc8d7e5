//! Traces voxel octrees: pictures, measurements, checks.

mod bench;
mod camera;
mod check;
mod counters;
mod merge;
mod model;
mod picture_file;
mod region;
mod render;
mod showcase;
mod study;

use clap::{Parser, Subcommand};
use octvox_cli::CommonArgs;
use std::process::ExitCode;

/// Render voxel octrees, measure how fast that is, and check that it is right.
///
/// Without a command, a sample is converted and rendered.
#[derive(Parser)]
#[command(name = "voxtrace", version, after_help = EXAMPLES)]
struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    common: CommonArgs,
}

const EXAMPLES: &str = "\
Examples:
  voxtrace                                    convert a sample, render it, say what to try next
  voxtrace render bunny.vox -o bunny.png      the whole model, framed
  voxtrace bench bunny.vox --lanes 1,16       single rays against packets of 16
  voxtrace check bunny.vox --rays 1000000     every width against exact arithmetic
  voxtrace study bunny.obj -o study --quick   what accuracy costs in time, as a report
  voxtrace merge part*.png -o bunny.png       parts of a picture, from several machines, to the whole";

#[derive(Subcommand)]
enum Command {
    /// Render a model or a scene to a picture
    Render(render::Arguments),
    /// Measure primary visibility: distance and voxel for each ray, no shading
    Bench(bench::Arguments),
    /// Hold every packet width against exact arithmetic, ray by ray
    Check(check::Arguments),
    /// Tell what accuracy costs in time: error over time of every setting, in a report
    Study(study::Arguments),
    /// Put a picture together from parts rendered apart
    Merge(merge::Arguments),
}

fn main() -> ExitCode {
    octvox_cli::run(|| {
        let arguments = Arguments::parse();
        arguments.common.start_thread_pool()?;
        match &arguments.command {
            Some(Command::Render(render)) => render::run(render, &arguments.common),
            Some(Command::Bench(bench)) => bench::run(bench, &arguments.common),
            Some(Command::Check(check)) => check::run(check, &arguments.common),
            Some(Command::Study(study)) => study::run(study, &arguments.common),
            Some(Command::Merge(merge)) => merge::run(merge, &arguments.common),
            None => showcase::run(&arguments.common),
        }
    })
}
