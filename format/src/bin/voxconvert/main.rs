//! Converts voxel octrees: between the versions of the `.vox` file, and to and from the formats of other programs.

mod arguments;
mod conversion;
mod input;
mod report;

use anyhow::Context;
use arguments::Arguments;
use clap::Parser;
use input::Input;
use octvox_cli::{Progress, grouped, print_json, print_line, write_file_atomically};
use octvox_format::FormatError;
use report::Report;
use std::process::ExitCode;
use std::time::Instant;

fn main() -> ExitCode {
    octvox_cli::run(|| convert(&Arguments::parse()))
}

fn convert(arguments: &Arguments) -> anyhow::Result<()> {
    let started = Instant::now();
    arguments.common.start_thread_pool()?;
    let name = || arguments.input.display().to_string();
    let progress = Progress::new(0, arguments.common.quiet);
    let input = Input::open(&arguments.input, &progress).with_context(name)?;
    let target = arguments.target(input.kind());
    arguments.check(target);
    progress.stage("converting", input.byte_length());
    let written = write_file_atomically(&arguments.output, |file| {
        let result = conversion::write(&input, arguments, target, file);
        // What is wrong with the output is said with its name, by the caller.
        result.map_err(|error| match error {
            FormatError::Write { .. } => anyhow::Error::new(error),
            _ => anyhow::Error::new(error).context(name()),
        })
    });
    progress.finish();
    let depth = written?;
    let path = &arguments.output;
    let file_bytes = std::fs::metadata(path).with_context(|| path.display().to_string())?.len();
    let report = Report::new(&input, target, depth, file_bytes, started.elapsed());
    if arguments.common.json {
        return print_json(&report);
    }
    print_line(&format!(
        "{}: {}, {}³, {} bytes",
        path.display(),
        target.name(),
        grouped(report.resolution),
        grouped(file_bytes)
    ))
}
