//! Starts the build of a program that suits this processor.
//!
//! It stands under the name of the program, beside folders that are named by instruction sets and hold the builds:
//!
//! ```text
//!  voxtrace               this launcher
//!  x86-64-v2/voxtrace     any x86-64 processor since about 2009
//!  x86-64-v3/voxtrace     with AVX2
//!  x86-64-v4/voxtrace     with AVX-512
//! ```

mod builds;

use std::env;
use std::io::Error;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

fn main() -> ExitCode {
    match start() {
        Ok(status) => status,
        Err(problem) => {
            eprintln!("error: {problem}");
            ExitCode::FAILURE
        }
    }
}

fn start() -> Result<ExitCode, String> {
    let launcher =
        env::current_exe().map_err(|error| format!("cannot find out where this program is: {error}"))?;
    let program = suitable(&launcher)?;
    let mut command = Command::new(&program);
    command.args(env::args_os().skip(1));
    run(command).map_err(|error| format!("{}: cannot be started: {error}", program.display()))
}

/// The best build that is there and that this processor can run.
fn suitable(launcher: &Path) -> Result<PathBuf, String> {
    let (Some(folder), Some(name)) = (launcher.parent(), launcher.file_name()) else {
        return Err(format!("{}: expected to be in a folder", launcher.display()));
    };
    builds::suitable()
        .map(|build| folder.join(build).join(name))
        .find(|program| program.is_file())
        .ok_or_else(|| {
            format!(
                "{}: no build for this processor in its folder; build it here with `cargo build --release`",
                launcher.display()
            )
        })
}

/// Becomes the program. Returns only if that fails.
#[cfg(unix)]
fn run(mut command: Command) -> Result<ExitCode, Error> {
    use std::os::unix::process::CommandExt;
    Err(command.exec())
}

/// Waits for the program and ends as it does.
#[cfg(not(unix))]
fn run(mut command: Command) -> Result<ExitCode, Error> {
    let status = command.status()?;
    Ok(status.code().and_then(|code| u8::try_from(code).ok()).map_or(ExitCode::FAILURE, ExitCode::from))
}
