//! The three programs, as their users start them.

use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

/// One of the programs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Program {
    /// Mesh in, `.vox` out.
    Obj2vox,
    /// Looks into a `.vox`.
    Voxinfo,
    /// Pictures.
    Voxtrace,
}

impl Program {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Obj2vox, Self::Voxinfo, Self::Voxtrace];

    /// The program's name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Obj2vox => "obj2vox",
            Self::Voxinfo => "voxinfo",
            Self::Voxtrace => "voxtrace",
        }
    }

    /// The program's file, built in the profile of the tests when it is first asked for.
    ///
    /// # Panics
    /// If it cannot be built.
    #[must_use]
    pub fn path(self) -> &'static Path {
        static PATHS: [OnceLock<PathBuf>; 3] = [const { OnceLock::new() }; 3];
        PATHS[self as usize].get_or_init(|| {
            let name = self.name();
            // The whole workspace with a test: libraries then have the features that `cargo test --workspace` has built them
            // with, and only the program itself is left to build.
            let build = escargot::CargoBuild::new()
                .arg("--workspace")
                .bin(name)
                .test("command_lines")
                .current_release();
            let run = build.run().unwrap_or_else(|error| {
                panic!("{error}\n`cargo build --workspace --bin {name}` may tell more")
            });
            run.path().to_path_buf()
        })
    }

    /// Runs the program in a folder, to its end.
    #[must_use]
    pub fn run_in(self, folder: &Path, arguments: &[&str]) -> Output {
        Command::new(self.path()).args(arguments).current_dir(folder).output().unwrap()
    }
}

/// Standard output of a program that succeeded.
///
/// # Panics
/// If it failed.
pub fn stdout(output: &Output) -> String {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// The one line of JSON that a program that succeeded has printed.
///
/// # Panics
/// If it failed or printed anything else.
#[must_use]
pub fn json(output: &Output) -> Value {
    let text = stdout(output);
    assert!(text.ends_with('\n') && text.lines().count() == 1, "{text}");
    let value: Value = serde_json::from_str(&text).unwrap();
    assert!(value.is_object(), "{text}");
    value
}

/// The error line of a program that failed.
///
/// # Panics
/// If the exit status is not 1, or there is anything but one line, beginning with `error: `.
#[must_use]
pub fn error_line(output: &Output) -> String {
    let text = String::from_utf8(output.stderr.clone()).unwrap();
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.starts_with("error: ") && text.ends_with('\n') && text.lines().count() == 1, "{text:?}");
    assert!(output.stdout.is_empty(), "{}", String::from_utf8_lossy(&output.stdout));
    text
}

/// The names of all files in a folder, hidden ones too, in order.
#[must_use]
pub fn files_in(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}
