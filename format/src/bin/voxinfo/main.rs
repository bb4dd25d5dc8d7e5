//! Looks into a `.vox` file: what it holds, whether it makes sense, and its first records.

mod inspection;
mod report;
mod table;

use anyhow::Context;
use clap::Parser;
use inspection::Inspection;
use octvox_cli::{CommonArgs, Progress, grouped, print_json, print_line};
use report::Report;
use std::fs::File;
use std::path::PathBuf;
use std::process::ExitCode;

/// Show what a .vox file holds.
///
/// The whole file is read and checked; one that is damaged is an error that names the place.
#[derive(Parser)]
#[command(name = "voxinfo", version, after_help = EXAMPLES)]
struct Arguments {
    /// The .vox file
    file: PathBuf,
    /// Fail if a node is empty but has filled children, or has only empty ones
    #[arg(long)]
    validate: bool,
    /// Show how many voxels are stored with each palette index
    #[arg(long)]
    histogram: bool,
    /// Show the first N records
    #[arg(long, value_name = "N")]
    records: Option<u64>,
    #[command(flatten)]
    common: CommonArgs,
}

const EXAMPLES: &str = "\
Examples:
  voxinfo bunny.vox                     what is in the file
  voxinfo bunny.vox --validate --quiet  exit status 1 if the octree makes no sense
  voxinfo bunny.vox --records 9         the root and what comes first below it
  voxinfo bunny.vox --json | jq .depth  for scripts";

fn main() -> ExitCode {
    octvox_cli::run(|| inspect(&Arguments::parse()))
}

fn inspect(arguments: &Arguments) -> anyhow::Result<()> {
    arguments.common.start_thread_pool()?;
    let name = || arguments.file.display().to_string();
    let file = File::open(&arguments.file).with_context(name)?;
    let length = file.metadata().with_context(name)?.len();
    let progress = Progress::new(length, arguments.common.quiet);
    progress.stage("reading", length);

    let mut first = Vec::new();
    let wanted = arguments.records.unwrap_or(0);
    let result = Inspection::of(&file, &progress, wanted, &mut first);
    progress.finish();
    if result.is_err() && !arguments.common.json && !first.is_empty() {
        // What can be read of a damaged file helps to find out what happened to it.
        print_line(table::of_records(&first).trim_end())?;
    }
    let inspection = result.with_context(name)?;

    if arguments.common.json {
        let records = arguments.records.map(|_| &first[..]);
        print_json(&Report::new(&inspection, arguments.histogram, records))?;
    } else {
        let mut tables = vec![table::of_summary(&inspection), table::of_levels(&inspection.summary.levels)];
        tables.extend(arguments.histogram.then(|| table::of_palette(&inspection)));
        tables.extend(arguments.records.map(|_| table::of_records(&first)));
        print_line(tables.join("\n").trim_end())?;
    }
    judge(arguments, &inspection)
}

/// With `--validate`, an octree that makes no sense is a failure.
fn judge(arguments: &Arguments, inspection: &Inspection) -> anyhow::Result<()> {
    match inspection.summary.first_defect {
        Some(defect) if arguments.validate => {
            let others = match inspection.summary.defects - 1 {
                0 => String::new(),
                others => format!(" ({} more such nodes)", grouped(others)),
            };
            anyhow::bail!("{}: {defect}{others}; convert the mesh again", arguments.file.display())
        }
        _ => Ok(()),
    }
}
