//! The launcher beside builds that are shell scripts.

#![cfg(all(unix, target_arch = "x86_64"))]

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Command, Output};

fn launcher_in(folder: &Path) -> Command {
    let launcher = folder.join("voxtrace");
    fs::copy(env!("CARGO_BIN_EXE_octvox-launcher"), &launcher).unwrap();
    Command::new(launcher)
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
    let folder = tempfile::tempdir().unwrap();
    write_build(folder.path(), "x86-64-v2");
    let output = launcher_in(folder.path()).args(["render", "a b"]).output().unwrap();
    assert_eq!(text(&output).0, "x86-64-v2: render a b\n");
    assert_eq!(output.status.code(), Some(3));
}

#[test]
fn the_best_build_that_the_processor_can_run_is_started() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["x86-64-v2", "x86-64-v3", "x86-64-v4"] {
        write_build(folder.path(), name);
    }
    // Linux tells it by other means than the launcher asks.
    let Ok(processor) = fs::read_to_string("/proc/cpuinfo") else { return };
    let has = |flag: &str| processor.split_whitespace().any(|word| word == flag);
    let expected = match (has("avx512_vpopcntdq"), has("avx2")) {
        (true, _) => "x86-64-v4: \n",
        (false, true) => "x86-64-v3: \n",
        (false, false) => "x86-64-v2: \n",
    };
    assert_eq!(text(&launcher_in(folder.path()).output().unwrap()).0, expected);
}

#[test]
fn without_builds_it_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let output = launcher_in(folder.path()).output().unwrap();
    let (printed, error) = text(&output);
    assert!(printed.is_empty() && error.starts_with("error: ") && error.lines().count() == 1, "{error}");
    assert_eq!(output.status.code(), Some(1));
}
