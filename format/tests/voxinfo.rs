//! The command line of `voxinfo`.

mod common;

use common::{FIGURE_17, Settings, Tree, palette};
use octvox_format::v5::{Compression, Header};
use octvox_format::{WorldTransform, to_version_5};
use serde_json::{Value, json};
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};
use tempfile::TempDir;

fn voxinfo() -> Command {
    Command::new(env!("CARGO_BIN_EXE_voxinfo"))
}

/// A file in a folder that is removed when the test ends.
fn file(bytes: &[u8]) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.vox");
    std::fs::write(&path, bytes).unwrap();
    (folder, path)
}

fn run(bytes: &[u8], options: &[&str]) -> Output {
    let (_folder, path) = file(bytes);
    voxinfo().arg(path).args(options).output().unwrap()
}

fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// The one line on standard error of a run that failed.
fn error_line(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(1));
    let text = String::from_utf8(output.stderr.clone()).unwrap();
    assert!(text.starts_with("error: ") && text.ends_with('\n') && text.lines().count() == 1, "{text}");
    text
}

/// An empty node with a filled child, which readers accept.
fn senseless() -> Vec<u8> {
    Tree::node(0, [0, 0, 0, 3, 0, 0, 0, 0].map(Tree::leaf)).file(&palette())
}

#[test]
fn json_has_the_promised_fields() {
    let output = run(&FIGURE_17, &["--json", "--records", "2"]);
    assert!(output.status.success());
    let report: Value = serde_json::from_str(&stdout(&output)).unwrap();
    let expected = json!({
        "format": 4, "depth": 1, "resolution": 2, "palette_size": 2,
        "stored_voxels": 9, "leaf_voxels": 8, "nodes": 1, "levels": [1, 8],
        "file_bytes": 50, "valid": true, "world": null,
        "records": [
            {"level": 0, "octant": 0, "palette": 2, "theta": 0xA1, "phi": 0x76, "has_children": true},
            {"level": 1, "octant": 0, "palette": 2, "theta": 0x3D, "phi": 0x42, "has_children": false},
        ],
    });
    assert_eq!(report, expected);
    assert!(output.stderr.is_empty());
}

/// The example of the thesis in version 5.
fn figure_17_v5() -> Vec<u8> {
    let world = Some(WorldTransform { origin: [1.0, 2.5, -3.0], voxel_size: 0.125 });
    let header = |depth| Header {
        world,
        cut_level: 1,
        writer: "test\u{7}".to_owned(),
        ..Settings::PLAIN.header(depth)
    };
    to_version_5(std::io::Cursor::new(FIGURE_17), Vec::new(), header).unwrap()
}

#[test]
fn json_of_version_5_has_more_fields() {
    let bytes = figure_17_v5();
    let output = run(&bytes, &["--json", "--records", "2", "--histogram", "--validate"]);
    assert!(output.status.success(), "{output:?}");
    let report: Value = serde_json::from_str(&stdout(&output)).unwrap();
    let expected = json!({
        "format": 5, "depth": 1, "resolution": 2, "palette_size": 2,
        "stored_voxels": 9, "leaf_voxels": 8, "nodes": 1, "levels": [1, 8],
        "file_bytes": bytes.len(), "valid": true, "world": {"origin": [1.0, 2.5, -3.0], "voxel_size": 0.125},
        "writer": "test\u{7}", "compression": "none", "normal_code": "spherical", "cut_level": 1, "subtrees": 8,
        "bytes_per_leaf_voxel": bytes.len() as f64 / 8.0,
        "sections": {
            "header": 96, "materials": 32 + 2 * 40, "subtrees": 8 * (32 + 4), "top": 32 + 5,
            "index": 32 + 2 * 16 + 8 * 32, "trailer": 36,
        },
        "histogram": [
            {"palette": 1, "color": [255, 255, 255], "stored_voxels": 4},
            {"palette": 2, "color": [0, 0, 0], "stored_voxels": 5},
        ],
        "records": [
            {"level": 0, "octant": 0, "palette": 2, "theta": 0xA1, "phi": 0x76, "has_children": true},
            {"level": 1, "octant": 0, "palette": 2, "theta": 0x3D, "phi": 0x42, "has_children": false},
        ],
    });
    assert_eq!(report, expected);
    let sections = report["sections"].as_object().unwrap().values();
    assert_eq!(sections.map(|bytes| bytes.as_u64().unwrap()).sum::<u64>(), bytes.len() as u64);
}

#[test]
fn the_table_of_version_5_is_aligned() {
    let expected = "\
format         version 5
resolution     2³ (depth 1)
palette        2 colours, 2 in use
leaf voxels    8
nodes          1
stored voxels  9
file           889 bytes
a leaf voxel   111.12 bytes
sections       materials 112, subtrees 288, top 37, index 320 bytes
subtrees       8, cut at level 1
coding         compression none, normals spherical
world          origin 1, 2.5, -3; voxel size 0.125
written by     test
valid          yes

level  resolution  filled voxels
    0           1              1
    1           2              8
";
    assert_eq!(stdout(&run(&figure_17_v5(), &[])), expected);
}

#[test]
fn damage_of_version_5_is_found() {
    for settings in Settings::all(1) {
        let file = Tree::chain(5).file_v5(&palette(), settings);
        assert!(run(&file, &["--validate"]).status.success());
        let mut damaged = file.clone();
        let place = file.len() / 2;
        damaged[place] ^= 4;
        error_line(&run(&damaged, &[]));
        let line = error_line(&run(&file[..place], &[]));
        assert!(line.contains(&format!("model.vox: byte {place}: the file ends")), "{line}");
    }
}

#[test]
#[cfg(unix)]
fn version_5_can_be_read_from_a_pipe() {
    let piped = |arguments: &[&str]| {
        let mut child = voxinfo()
            .args(["/dev/stdin", "--json"])
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let file = Tree::chain(5)
            .file_v5(&palette(), Settings { compression: Compression::Zstandard, ..Settings::PLAIN });
        std::io::Write::write_all(&mut child.stdin.take().unwrap(), &file).unwrap();
        child.wait_with_output().unwrap()
    };
    let report: Value = serde_json::from_str(&stdout(&piped(&[]))).unwrap();
    assert_eq!((&report["depth"], &report["leaf_voxels"]), (&json!(5), &json!(1)));
    // Its first record is at its end.
    assert!(error_line(&piped(&["--records", "1"])).contains("save it as a file"));
}

#[test]
fn the_histogram_lists_what_is_used() {
    let output = run(&FIGURE_17, &["--json", "--histogram"]);
    let report: Value = serde_json::from_str(&stdout(&output)).unwrap();
    let expected = json!([
        {"palette": 1, "color": [255, 255, 255], "stored_voxels": 4},
        {"palette": 2, "color": [0, 0, 0], "stored_voxels": 5},
    ]);
    assert_eq!(report["histogram"], expected);
    assert_eq!(report.get("records"), None);

    let table = stdout(&run(&senseless(), &["--histogram"]));
    assert!(table.contains("      0  empty                8\n"), "{table}");
    assert!(table.contains("      3  #0266ca              1\n"), "{table}");
}

#[test]
fn more_records_than_there_are_is_all() {
    let output = run(&FIGURE_17, &["--json", "--records", "18446744073709551615"]);
    let report: Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(report["records"].as_array().unwrap().len(), 9);
}

#[test]
fn the_table_is_aligned() {
    let expected = "\
format         version 4
resolution     2³ (depth 1)
palette        2 colours, 2 in use
leaf voxels    8
nodes          1
stored voxels  9
file           50 bytes
valid          yes

level  resolution  filled voxels
    0           1              1
    1           2              8

level  octant  palette  theta   phi  children
    0       0        2    161   118  yes
";
    assert_eq!(stdout(&run(&FIGURE_17, &["--records", "1"])), expected);
}

#[test]
fn a_senseless_octree_fails_only_if_asked() {
    let output = run(&senseless(), &["--json"]);
    assert!(output.status.success());
    let report: Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(report["valid"], false);

    let output = run(&senseless(), &["--json", "--validate"]);
    let line = error_line(&output);
    assert!(line.contains("model.vox: byte 17: the node on level 0 is empty"), "{line}");
    assert_eq!(serde_json::from_str::<Value>(&stdout(&output)).unwrap(), report);

    assert!(run(&FIGURE_17, &["--validate"]).status.success());
}

#[test]
fn a_damaged_file_fails_with_the_place() {
    let output = run(&FIGURE_17[..49], &["--json"]);
    let line = error_line(&output);
    assert!(line.contains("model.vox: byte 49: the file ends inside the octree"), "{line}");
    assert!(output.stdout.is_empty());

    // The records before the damage are shown all the same.
    let output = run(&FIGURE_17[..49], &["--records", "100"]);
    error_line(&output);
    assert_eq!(stdout(&output).trim_end().lines().count(), 1 + 8);

    let line = error_line(&run(b"VOX \x96\0\0\0", &[]));
    assert!(line.contains("MagicaVoxel"), "{line}");
    error_line(&run(b"", &[]));
}

#[test]
fn what_cannot_be_opened_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let output = voxinfo().arg(folder.path().join("absent.vox")).output().unwrap();
    assert!(error_line(&output).contains("absent.vox"));
    let output = voxinfo().arg(folder.path()).output().unwrap();
    assert!(error_line(&output).contains(folder.path().to_str().unwrap()));
}

#[test]
fn wrong_arguments_have_a_status_of_their_own() {
    for arguments in [&["--records", "-1"][..], &["--no-such-option"], &[]] {
        assert_eq!(voxinfo().args(arguments).output().unwrap().status.code(), Some(2));
    }
    let help = voxinfo().arg("--help").output().unwrap();
    assert!(help.status.success() && stdout(&help).contains("Examples:"));
}

#[test]
fn a_reader_that_goes_away_is_no_failure() {
    let (_folder, path) = file(&Tree::chain(23).file(&palette()));
    let mut child = voxinfo()
        .arg(path)
        .args(["--records", "1000"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success() && output.stderr.is_empty(), "{output:?}");
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_a_failure() {
    let (_folder, path) = file(&FIGURE_17);
    let full = std::fs::File::create("/dev/full").unwrap();
    let output = voxinfo().arg(path).stdout(full).output().unwrap();
    assert!(error_line(&output).contains("standard output"));
}

#[test]
#[cfg(unix)]
fn a_pipe_can_be_read() {
    let mut child = voxinfo()
        .args(["/dev/stdin", "--json"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    std::io::Write::write_all(&mut child.stdin.take().unwrap(), &FIGURE_17).unwrap();
    let output = child.wait_with_output().unwrap();
    let report: Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(report["file_bytes"], 50);
}
