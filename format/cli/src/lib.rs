//! What the programs of octvox do alike: refuse a processor they were not built for,
//! print one `error:` line, show progress, and write files whole or not at all.

mod byte_size;
mod cpu;
mod grouping;
mod memory;
mod output;
mod progress;

pub use byte_size::parse_byte_size;
pub use cpu::instruction_set;
pub use grouping::grouped;
pub use memory::{available_memory_bytes, memory_in_use_bytes, peak_memory_bytes};
pub use output::{write_atomically, write_file_atomically};
pub use progress::Progress;

use std::io::{ErrorKind, Write};
use std::process::ExitCode;

/// Options that every program takes.
#[derive(Debug, Clone, clap::Args)]
pub struct CommonArgs {
    /// Number of worker threads [default: all cores]
    #[arg(long, value_name = "N", global = true, value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub threads: Option<u16>,
    /// No progress bar on standard error
    #[arg(long, global = true)]
    pub quiet: bool,
    /// Print one JSON object on standard output instead of the table
    #[arg(long, global = true)]
    pub json: bool,
}

impl CommonArgs {
    /// Sizes the global thread pool. Call once, before any parallel work.
    ///
    /// # Errors
    /// If the pool already runs or its threads cannot be started.
    pub fn start_thread_pool(&self) -> anyhow::Result<()> {
        if let Some(threads) = self.threads {
            rayon::ThreadPoolBuilder::new()
                .num_threads(usize::from(threads))
                .build_global()
                .map_err(|error| anyhow::anyhow!("cannot start {threads} threads: {error}"))?;
        }
        Ok(())
    }
}

/// The frame of a program's `main`: checks the processor, arms Ctrl-C, runs `body`, and turns a failure
/// into one `error:` line on standard error and exit status 1.
pub fn run(body: impl FnOnce() -> anyhow::Result<()>) -> ExitCode {
    // Before anything else: the code below may already use instructions this processor lacks.
    // (On Linux the check has been made before `main`.)
    cpu::refuse_lesser_processor();
    run_on_this_processor(body)
}

/// Not inlined, so that nothing of `body` moves before the check of the processor.
#[inline(never)]
fn run_on_this_processor(body: impl FnOnce() -> anyhow::Result<()>) -> ExitCode {
    output::remove_temporary_files_on_interrupt();
    match body() {
        Ok(()) => ExitCode::SUCCESS,
        // Who closes the pipe early (`voxinfo … | head`) has what he wanted.
        Err(error) if error.is::<StandardOutputClosed>() => ExitCode::SUCCESS,
        Err(error) => {
            // One line, whatever the causes contain. If standard error is closed, the exit status must do.
            let line = format!("{error:#}").replace(['\n', '\r'], " ");
            let _ = writeln!(std::io::stderr(), "error: {line}");
            ExitCode::FAILURE
        }
    }
}

/// Prints `value` as one line of JSON on standard output.
///
/// # Errors
/// If standard output cannot be written.
pub fn print_json(value: &impl serde::Serialize) -> anyhow::Result<()> {
    print_line(&serde_json::to_string(value)?)
}

/// Prints a line, or several, on standard output, as an error instead of a panic if that fails.
///
/// # Errors
/// If standard output cannot be written. [`run`] takes no notice of one that has been closed by its reader.
pub fn print_line(line: &str) -> anyhow::Result<()> {
    let mut output = std::io::stdout().lock();
    match output
        .write_all(line.as_bytes())
        .and_then(|()| output.write_all(b"\n"))
        .and_then(|()| output.flush())
    {
        Ok(()) => Ok(()),
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Err(StandardOutputClosed.into()),
        Err(error) => Err(anyhow::Error::new(error).context("cannot write to standard output")),
    }
}

/// The reader of standard output has gone. A file or pipe named by the user that breaks is an ordinary error.
#[derive(Debug)]
struct StandardOutputClosed;

impl std::fmt::Display for StandardOutputClosed {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str("standard output is closed")
    }
}

impl std::error::Error for StandardOutputClosed {}
