//! The launcher beside builds that are shell scripts.

#![cfg(all(unix, target_arch = "x86_64"))]

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Command, Output};
use std::sync::{Mutex, PoisonError};

/// One at a time: a process that another test starts meanwhile would keep the programs that are being written open for
/// writing, and such a program cannot be started.
static STARTING: Mutex<()> = Mutex::new(());

/// What the launcher does beside builds of these names.
fn launched(builds: &[&str], arguments: &[&str]) -> Output {
    let _alone = STARTING.lock().unwrap_or_else(PoisonError::into_inner);
    let folder = tempfile::tempdir().unwrap();
    for name in builds {
        write_build(folder.path(), name);
    }
    let launcher = folder.path().join("voxtrace");
    fs::copy(env!("CARGO_BIN_EXE_octvox-launcher"), &launcher).unwrap();
    Command::new(launcher).args(arguments).output().unwrap()
}

fn write_build(folder: &Path, name: &str) {
    let folder = folder.join(name);
    fs::create_dir(&folder).unwrap();
    let program = folder.join("voxtrace");
    fs::write(&program, format!("#!/bin/sh\necho \"{name}: $*\"\nexit 3\n")).unwrap();
    fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
}

fn text(output: &Output) -> (String, String) {
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();
    (text(&output.stdout), text(&output.stderr))
}

#[test]
fn arguments_and_status_are_passed_on() {
    let output = launched(&["x86-64-v2"], &["render", "a b"]);
    assert_eq!(text(&output).0, "x86-64-v2: render a b\n");
    assert_eq!(output.status.code(), Some(3));
}

#[test]
fn the_best_build_that_the_processor_can_run_is_started() {
    // Linux tells it by other means than the launcher asks.
    let Ok(processor) = fs::read_to_string("/proc/cpuinfo") else { return };
    let has = |flag: &str| processor.split_whitespace().any(|word| word == flag);
    let expected = match (has("avx512_vpopcntdq"), has("avx2")) {
        (true, _) => "x86-64-v4: \n",
        (false, true) => "x86-64-v3: \n",
        (false, false) => "x86-64-v2: \n",
    };
    assert_eq!(text(&launched(&["x86-64-v2", "x86-64-v3", "x86-64-v4"], &[])).0, expected);
}

#[test]
fn without_builds_it_says_so() {
    let output = launched(&[], &[]);
    let (printed, error) = text(&output);
    assert!(printed.is_empty() && error.starts_with("error: ") && error.lines().count() == 1, "{error}");
    assert_eq!(output.status.code(), Some(1));
}
