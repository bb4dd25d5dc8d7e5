//! What `obj2vox` promises to people and scripts.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

fn obj2vox(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_obj2vox")).current_dir(folder).args(arguments).output().unwrap()
}

/// A folder with a pyramid.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let obj = "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 2 2 3\nf 4 3 2 1\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n";
    std::fs::write(folder.path().join("pyramid.obj"), obj).unwrap();
    folder
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

#[test]
fn json_has_every_field_and_nothing_else_is_printed() {
    let folder = folder();
    let output = obj2vox(folder.path(), &["pyramid.obj", "-r", "64", "--json"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_eq!(text(&output.stderr), "");
    assert_eq!(text(&output.stdout).lines().count(), 1);
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["triangles"], 6);
    assert_eq!(report["degenerate_triangles"], 0);
    assert_eq!((&report["resolution"], &report["depth"]), (&64.into(), &6.into()));
    for field in ["leaf_voxels", "nodes", "stored_voxels", "thesis_voxels", "colors_found", "palette_size"] {
        assert!(report[field].as_u64().unwrap() > 0, "{field}");
    }
    assert_eq!(report["palette_error"], 0.0);
    assert_eq!(report["warnings"], Value::Array(vec![]));
    for stage in ["read", "palette", "scan", "build", "write", "total"] {
        assert!(report["seconds"][stage].as_f64().unwrap() >= 0.0, "{stage}");
    }
    assert_eq!(report["world"]["voxel_size"], 4.0 / 64.0);
    // The default output: the model's name, in the current folder.
    let bytes = std::fs::metadata(folder.path().join("pyramid.vox")).unwrap().len();
    assert_eq!(report["file_bytes"], bytes);
    assert_eq!(bytes, 8 + 3 + 4 * report["stored_voxels"].as_u64().unwrap());
}

#[test]
fn the_table_names_the_file_and_its_size() {
    let folder = folder();
    let output = obj2vox(folder.path(), &["pyramid.obj", "-o", "p.vox", "--depth", "3", "--threads", "1"]);
    assert!(output.status.success());
    let table = text(&output.stdout);
    assert!(table.starts_with("p.vox\n") && table.contains("8³") && table.contains("leaf voxels"), "{table}");
}

#[test]
fn options_reach_the_conversion() {
    let folder = folder();
    let report = |arguments: &[&str]| {
        let arguments = [&["pyramid.obj", "-r", "32", "--json"], arguments].concat();
        let output = obj2vox(folder.path(), &arguments);
        assert!(output.status.success(), "{}", text(&output.stderr));
        serde_json::from_slice::<Value>(&output.stdout).unwrap()
    };
    let plain = report(&[]);
    let leaves = |report: &Value| report["leaf_voxels"].as_u64().unwrap();
    assert!(leaves(&report(&["--conservative"])) > leaves(&plain));
    assert!(leaves(&report(&["--bounds", "-4,-4,-4,8,8,8"])) < leaves(&plain));
    assert_eq!(report(&["--voxel-size", "0.25"])["world"]["voxel_size"], 0.25);
    let unpruned = report(&["--no-prune"]);
    assert_eq!(unpruned["stored_voxels"], unpruned["thesis_voxels"]);
}

#[test]
fn the_file_is_the_same_however_little_memory_there_is() {
    let folder = folder();
    for format in ["4", "5"] {
        let convert = |arguments: &[&str]| {
            let arguments = [&["pyramid.obj", "-r", "256", "--json", "--format", format], arguments].concat();
            let output = obj2vox(folder.path(), &arguments);
            assert!(output.status.success(), "{}", text(&output.stderr));
            let report: Value = serde_json::from_slice(&output.stdout).unwrap();
            assert_eq!(report["format"], format.parse::<u64>().unwrap());
            (report, std::fs::read(folder.path().join("pyramid.vox")).unwrap())
        };
        let (report, expected) = convert(&[]);
        assert_eq!(report["temporary_bytes"], 0);
        let (report, found) = convert(&["--memory", "1M", "--force"]);
        assert!(report["temporary_bytes"].as_u64().unwrap() > 10_000);
        assert!(found == expected);
    }
    // The model and two files of the same name: no temporary file is left.
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
    let output = obj2vox(folder.path(), &["pyramid.obj", "--memory", "1M"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stderr).contains("bytes of memory are needed"), "{}", text(&output.stderr));
}

#[test]
fn failures_are_one_line_with_file_and_place() {
    let folder = folder();
    std::fs::write(folder.path().join("bad.obj"), "v 0 0 0\nf 1 2 3\n").unwrap();
    for (arguments, expected) in [
        (vec!["bad.obj"], "error: bad.obj:2: the face refers to vertex 2, but 1 precede it"),
        (vec!["lost.obj"], "error: lost.obj: cannot read the model"),
        (vec!["pyramid.obj", "-o", "no/such/folder/p.vox"], "error: no/such/folder/p.vox: cannot write"),
        (vec!["pyramid.obj", "--bounds", "0,0,0,1,1,1"], "error: "),
        (vec!["pyramid.obj", "--bounds", "0,0,0,1,1"], "error: --bounds has 5 numbers"),
        (vec!["pyramid.obj", "--voxel-size", "0"], "error: a voxel size of 0 is not possible"),
        (vec!["pyramid.obj", "--crease", "200"], "error: a crease angle of 200 degrees"),
        (vec!["pyramid.obj", "--compression", "zstd"], "error: --compression is for version 5"),
    ] {
        let output = obj2vox(folder.path(), &arguments);
        assert_eq!(output.status.code(), Some(1), "{arguments:?}");
        let message = text(&output.stderr);
        assert!(message.starts_with(expected) && message.lines().count() == 1, "{arguments:?}: {message}");
        assert_eq!(text(&output.stdout), "");
    }
    // Nothing half-written is left.
    let files = std::fs::read_dir(folder.path()).unwrap().count();
    assert_eq!(files, 2);
}

#[test]
fn wrong_arguments_are_explained_with_status_two() {
    let folder = folder();
    for (arguments, expected) in [
        (vec!["pyramid.obj", "-r", "100"], "must be a power of two from 1 to 16384"),
        (vec!["pyramid.obj", "-r", "32768"], "must be a power of two from 1 to 16384"),
        (vec!["pyramid.obj", "-r", "0"], "must be a power of two"),
        (vec!["pyramid.obj", "--depth", "15"], "15"),
        (vec!["pyramid.obj", "-r", "8", "--depth", "3"], "cannot be used with"),
        (vec!["pyramid.obj", "--palette", "0"], "1..=32767"),
        (vec!["pyramid.obj", "--format", "7"], "7"),
        (vec!["pyramid.obj", "--memory", "much"], "expected a number such as 800M or 2G"),
        (vec!["pyramid.obj", "--format", "5", "--compression", "zip"], "zip"),
        (vec![], "MODEL.obj"),
    ] {
        let output = obj2vox(folder.path(), &arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(text(&output.stderr).contains(expected), "{arguments:?}: {}", text(&output.stderr));
    }
}

#[test]
fn warnings_go_to_standard_error_and_into_the_report() {
    let folder = folder();
    let path = folder.path().join("pyramid.obj");
    let obj = format!("mtllib lost.mtl\n{}", std::fs::read_to_string(&path).unwrap());
    std::fs::write(&path, obj).unwrap();
    let output = obj2vox(folder.path(), &["pyramid.obj", "-r", "8", "--json"]);
    assert!(output.status.success());
    assert!(
        text(&output.stderr).starts_with("warning: lost.mtl: cannot read the materials"),
        "{}",
        text(&output.stderr)
    );
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["warnings"].as_array().unwrap().len(), 1);
}

#[test]
fn help_has_an_example() {
    let output = obj2vox(Path::new("."), &["--help"]);
    assert!(output.status.success());
    assert!(text(&output.stdout).contains("Example: obj2vox bunny.obj"));
}
