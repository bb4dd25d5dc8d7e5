//! The programs when something is wrong: one line that names the file, exit status 1, and nothing half-written.

use octvox_tests::meshes::sphere;
use octvox_tests::models::Model;
use octvox_tests::programs::{Program, error_line, files_in};
use octvox_tests::{FIGURE_17, meshes};
use std::path::Path;
use tempfile::TempDir;

/// A folder with a good mesh and a good octree.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("good.obj"), meshes::cube().obj()).unwrap();
    std::fs::write(folder.path().join("good.vox"), FIGURE_17).unwrap();
    folder
}

/// Runs a program that is to fail, and returns its error line. The folder stays as it was.
fn fail(program: Program, folder: &Path, arguments: &[&str]) -> String {
    let before = files_in(folder);
    let line = error_line(&program.run_in(folder, arguments));
    assert_eq!(files_in(folder), before, "{program:?} {arguments:?} leaves something behind");
    line
}

/// Everything that reads an OBJ file refuses `text`, with a line that names the file and has `expected` in it.
fn assert_obj_is_refused(text: &[u8], expected: &str) {
    let folder = folder();
    std::fs::write(folder.path().join("bad.obj"), text).unwrap();
    for (program, arguments) in [
        (Program::Obj2vox, &["bad.obj", "-r", "8"][..]),
        (Program::Obj2vox, &["bad.obj", "-r", "8", "-o", "out.vox"]),
        (Program::Voxtrace, &["render", "bad.obj", "-r", "8", "-o", "out.png"]),
        (Program::Voxtrace, &["bench", "bad.obj", "-r", "8"]),
        (Program::Voxtrace, &["check", "bad.obj", "-r", "8", "--rays", "10"]),
    ] {
        let line = fail(program, folder.path(), arguments);
        assert!(line.starts_with("error: bad.obj") && line.contains(expected), "{program:?}: {line}");
    }
}

/// Everything that reads a `.vox` file refuses `bytes`.
fn assert_vox_is_refused(bytes: &[u8], expected: &str) {
    let folder = folder();
    std::fs::write(folder.path().join("bad.vox"), bytes).unwrap();
    for (program, arguments) in [
        (Program::Voxinfo, &["bad.vox"][..]),
        (Program::Voxinfo, &["bad.vox", "--json"]),
        (Program::Voxtrace, &["render", "bad.vox", "-o", "out.png", "--size", "8x8"]),
        (Program::Voxtrace, &["bench", "bad.vox", "--size", "8x8"]),
        (Program::Voxtrace, &["check", "bad.vox", "--rays", "10"]),
    ] {
        let line = fail(program, folder.path(), arguments);
        assert!(line.starts_with("error: bad.vox: ") && line.contains(expected), "{program:?}: {line}");
        // Each part of the line is told once.
        let mut parts: Vec<&str> = line.split(": ").collect();
        let count = parts.len();
        parts.sort_unstable();
        parts.dedup();
        assert_eq!(parts.len(), count, "{program:?}: {line}");
    }
}

#[test]
fn meshes_without_a_surface() {
    assert_obj_is_refused(b"", "no faces");
    assert_obj_is_refused(b"# nothing\n\n", "no faces");
    assert_obj_is_refused(b"v 0 0 0\nv 1 0 0\nv 0 1 0\n", "no faces");
}

#[test]
fn faces_of_vertices_that_are_not_there() {
    let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for face in ["f 1 2 4", "f 0 1 2", "f -4 -1 -2", "f 1 2 99999999999", "f 1//1 2//1 3//1"] {
        assert_obj_is_refused(format!("{vertices}{face}\n").as_bytes(), "bad.obj:4:");
    }
}

#[test]
fn numbers_that_are_none() {
    for vertex in ["v 0 NaN 0", "v 0 0 inf", "v 0 1e999 0", "v 0 zero 0", "v 0 0"] {
        assert_obj_is_refused(format!("v 0 0 0\n{vertex}\nv 0 1 0\nf 1 2 3\n").as_bytes(), "bad.obj:2:");
    }
}

#[test]
fn files_that_are_not_text() {
    for bytes in [&[0xFF; 300][..], &[0; 300], b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR"] {
        assert_obj_is_refused(bytes, "");
    }
}

#[test]
fn octrees_that_are_cut_or_foreign() {
    assert_vox_is_refused(b"", "byte 0");
    assert_vox_is_refused(&FIGURE_17[..49], "byte 49");
    assert_vox_is_refused(&FIGURE_17[..10], "byte 10");
    assert_vox_is_refused(&[&FIGURE_17[..], &[0]].concat(), "byte 50");
    assert_vox_is_refused(b"VOX \x96\0\0\0MAIN", "MagicaVoxel");
    assert_vox_is_refused(b"MB\x09\0\x01\0abc||\x02\0\0\0", "version 9");
    assert_vox_is_refused(meshes::cube().obj().as_bytes(), "byte 0");
}

/// Every length of a cut file, through the program.
#[test]
fn every_truncation() {
    let folder = folder();
    let path = folder.path().join("bad.vox");
    for length in 0..FIGURE_17.len() {
        std::fs::write(&path, &FIGURE_17[..length]).unwrap();
        let line = fail(Program::Voxinfo, folder.path(), &["bad.vox"]);
        assert!(line.starts_with(&format!("error: bad.vox: byte {length}: ")), "{line}");
    }
}

#[test]
fn files_that_are_missing_or_folders() {
    let folder = folder();
    for name in ["missing.obj", "folder.obj"] {
        std::fs::create_dir_all(folder.path().join("folder.obj")).unwrap();
        for (program, arguments) in [
            (Program::Obj2vox, &[name, "-o", "out.vox"][..]),
            (Program::Voxtrace, &["render", name, "-o", "out.png"]),
        ] {
            let line = fail(program, folder.path(), arguments);
            assert!(line.starts_with(&format!("error: {name}: ")), "{line}");
        }
    }
    for name in ["missing.vox", "folder.vox"] {
        std::fs::create_dir_all(folder.path().join("folder.vox")).unwrap();
        for (program, arguments) in [
            (Program::Voxinfo, &[name][..]),
            (Program::Voxtrace, &["render", name, "-o", "out.png"]),
            (Program::Voxtrace, &["bench", name]),
            (Program::Voxtrace, &["check", name]),
        ] {
            let line = fail(program, folder.path(), arguments);
            assert!(line.starts_with(&format!("error: {name}: ")), "{line}");
        }
    }
}

#[test]
fn endings_that_no_program_knows() {
    let folder = folder();
    std::fs::write(folder.path().join("model.blend"), "BLENDER-v300").unwrap();
    std::fs::write(folder.path().join("model"), [0x7F, 0x45, 0x4C, 0x46]).unwrap();
    for name in ["model.blend", "model"] {
        let line = fail(Program::Voxtrace, folder.path(), &["render", name, "-o", "out.png"]);
        assert!(line.starts_with(&format!("error: {name}: ")) && line.contains(".obj"), "{line}");
        let line = fail(Program::Obj2vox, folder.path(), &[name, "-o", "out.vox"]);
        assert!(line.starts_with(&format!("error: {name}: ")) && line.contains(".obj"), "{line}");
    }
    let line = fail(Program::Voxtrace, folder.path(), &["render", "good.vox", "-o", "out.bmp"]);
    assert!(line.starts_with("error: out.bmp: ") && line.contains("png"), "{line}");
}

/// Output that cannot be: in a folder that is not there, over a folder, below a file.
#[test]
fn output_that_cannot_be_written() {
    let folder = folder();
    std::fs::create_dir(folder.path().join("taken.vox")).unwrap();
    std::fs::create_dir(folder.path().join("taken.png")).unwrap();
    for output in ["nowhere/out.vox", "taken.vox", "good.vox/out.vox"] {
        let line = fail(Program::Obj2vox, folder.path(), &["good.obj", "-r", "8", "-o", output]);
        assert!(line.starts_with(&format!("error: {output}: ")), "{line}");
    }
    for output in ["nowhere/out.png", "taken.png", "good.vox/out.png"] {
        let line =
            fail(Program::Voxtrace, folder.path(), &["render", "good.vox", "--size", "8x8", "-o", output]);
        assert!(line.starts_with(&format!("error: {output}: ")), "{line}");
    }
}

/// The model would be lost.
#[test]
fn output_over_the_model() {
    let folder = folder();
    let line = fail(Program::Obj2vox, folder.path(), &["good.obj", "-o", "./good.obj", "-r", "8"]);
    assert!(line.starts_with("error: ./good.obj: is the model itself"), "{line}");
}

/// A failure leaves an older file as it was.
#[test]
fn an_older_file_survives_a_failure() {
    let folder = folder();
    let old = folder.path().join("old.vox");
    std::fs::write(&old, FIGURE_17).unwrap();
    std::fs::write(folder.path().join("bad.obj"), "f 1 2 3\n").unwrap();
    fail(Program::Obj2vox, folder.path(), &["bad.obj", "-o", "old.vox"]);
    // Readable, but too large for these bounds: fails after the output has been opened.
    let bounds = "--bounds=0,0,0,0.5,0.5,0.5";
    let line = fail(Program::Obj2vox, folder.path(), &["good.obj", "-r", "8", bounds, "-o", "old.vox"]);
    assert!(line.contains("good.obj"), "{line}");
    assert_eq!(std::fs::read(&old).unwrap(), FIGURE_17);
}

/// A disk that is full, which Linux has a device for.
#[test]
#[cfg(target_os = "linux")]
fn a_full_disk() {
    let folder = folder();
    let line = fail(Program::Obj2vox, folder.path(), &["good.obj", "-r", "64", "-o", "/dev/full"]);
    assert!(line.starts_with("error: /dev/full: "), "{line}");
    for program in Program::ALL {
        let arguments: &[&str] = match program {
            Program::Obj2vox => &["good.obj", "-r", "8", "-o", "made.vox"],
            Program::Voxinfo => &["good.vox"],
            Program::Voxtrace => &["bench", "good.vox", "--size", "8x8"],
        };
        let full = std::fs::File::create("/dev/full").unwrap();
        let output = std::process::Command::new(program.path())
            .args(arguments)
            .current_dir(folder.path())
            .stdout(full)
            .output()
            .unwrap();
        assert!(error_line(&output).contains("standard output"), "{program:?}");
    }
}

/// A folder without permission to write. (The superuser may write everywhere; then there is nothing to test.)
#[test]
#[cfg(unix)]
fn a_folder_that_is_write_protected() {
    use std::os::unix::fs::PermissionsExt;
    let folder = folder();
    let locked = folder.path().join("locked");
    std::fs::create_dir(&locked).unwrap();
    std::fs::set_permissions(&locked, std::fs::Permissions::from_mode(0o555)).unwrap();
    if std::fs::write(locked.join("probe"), "").is_ok() {
        println!("skipped: this user may write everywhere");
        return;
    }
    let line = fail(Program::Obj2vox, folder.path(), &["good.obj", "-r", "8", "-o", "locked/out.vox"]);
    assert!(line.starts_with("error: locked/out.vox: "), "{line}");
    assert!(files_in(&locked).is_empty());
}

#[test]
fn cameras_that_see_nothing() {
    let folder = folder();
    let render = ["render", "good.vox", "-o", "out.png", "--size", "8x8"];
    for (camera, expected) in [
        (&["--eye", "0.5,0.5,2", "--target", "0.5,0.5,2"][..], "two different points"),
        (&["--eye", "0.5,2,0.5", "--target", "0.5,0.5,0.5"], "up direction"),
        (&["--up", "0,0,0"], "up direction"),
        (&["--fov", "0"], "field of view"),
        (&["--fov", "180"], "field of view"),
        (&["--fov", "NaN"], "field of view"),
        (&["--space", "world", "--eye", "1,2,3"], "--space unit"),
    ] {
        let arguments = [&render[..], camera].concat();
        let line = fail(Program::Voxtrace, folder.path(), &arguments);
        assert!(line.contains(expected), "{camera:?}: {line}");
    }
}

/// Arguments that make no sense have an exit status of their own, and write nothing.
#[test]
fn wrong_arguments() {
    let folder = folder();
    let cases: [(Program, &[&[&str]]); 3] = [
        (
            Program::Obj2vox,
            &[
                &[],
                &["good.obj", "-r", "1000"],
                &["good.obj", "-r", "32768"],
                &["good.obj", "--depth", "15"],
                &["good.obj", "-r", "8", "--depth", "3"],
                &["good.obj", "--palette", "0"],
                &["good.obj", "--palette", "32768"],
                &["good.obj", "--format", "3"],
                &["good.obj", "--threads", "0"],
                &["good.obj", "--bounds", "a,b,c,d,e,f"],
                &["good.obj", "other.obj"],
                &["--no-such-option"],
            ],
        ),
        (
            Program::Voxinfo,
            &[
                &[],
                &["good.vox", "--records", "-1"],
                &["good.vox", "--threads", "many"],
                &["--no-such-option"],
            ],
        ),
        (
            Program::Voxtrace,
            &[
                &["no-such-command"],
                &["render"],
                &["render", "good.vox"],
                &["render", "good.vox", "-o", "out.png", "--size", "0x8"],
                &["render", "good.vox", "-o", "out.png", "--size", "8"],
                &["render", "good.vox", "-o", "out.png", "--samples", "0"],
                &["render", "good.vox", "-o", "out.png", "--lod", "-1"],
                &["render", "good.vox", "-o", "out.png", "--eye", "1,2"],
                &["render", "good.vox", "-o", "out.png", "--eye", "1,2,inf"],
                &["render", "good.vox", "-o", "out.png", "--aov", "beauty"],
                &["bench", "good.vox", "--lanes", "3"],
                &["bench", "good.vox", "--grid", "512"],
                &["check", "good.vox", "--rays", "0"],
                &["check", "good.vox", "--rays", "few"],
            ],
        ),
    ];
    for (program, lines) in cases {
        for arguments in lines {
            let before = files_in(folder.path());
            let output = program.run_in(folder.path(), arguments);
            assert_eq!(output.status.code(), Some(2), "{program:?} {arguments:?}");
            assert!(
                output.stderr.starts_with(b"error: ") || arguments.is_empty(),
                "{program:?} {arguments:?}"
            );
            assert!(output.stdout.is_empty());
            assert_eq!(files_in(folder.path()), before);
        }
    }
}

/// An octree that is deeper than can be traced is a good file, and a sentence for the tracer.
#[test]
fn an_octree_that_is_too_deep_to_trace() {
    use octvox_tests::tree::{Tree, voxel};
    let folder = folder();
    let cell = voxel(&mut octvox_tests::random::Random::new(1));
    std::fs::write(folder.path().join("deep.vox"), Tree::of_cells(23, &[([9; 3], cell)]).file()).unwrap();
    assert!(Program::Voxinfo.run_in(folder.path(), &["deep.vox", "--validate"]).status.success());
    let line = fail(Program::Voxtrace, folder.path(), &["render", "deep.vox", "-o", "out.png"]);
    assert!(line.starts_with("error: deep.vox: ") && line.contains("too deep"), "{line}");
}

/// What is interrupted leaves neither output nor temporary file.
#[test]
#[cfg(unix)]
fn an_interrupt_leaves_nothing() {
    use std::process::{Command, Stdio};
    use std::time::Duration;
    let folder = folder();
    std::fs::write(folder.path().join("large.obj"), sphere(8).obj()).unwrap();
    let mut child = Command::new(Program::Obj2vox.path())
        .args(["large.obj", "-r", "4096", "-o", "out.vox"])
        .current_dir(folder.path())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    // When the temporary file is there, the output has been begun.
    let is_begun = || files_in(folder.path()).iter().any(|name| name.starts_with(".octvox"));
    while !is_begun() && child.try_wait().unwrap().is_none() {
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert_eq!(files_in(folder.path()), ["good.obj", "good.vox", "large.obj"]);
}

/// The library refuses what the programs refuse.
#[test]
fn a_mesh_out_of_bounds_is_an_error_of_the_library() {
    use octvox_converter::{ConvertError, Options, convert};
    let options = Options { depth: 3, bounds: Some([0.0, 0.0, 0.0, 0.5, 0.5, 0.5]), ..Options::default() };
    let mut out = Vec::new();
    let mesh = meshes::cube().mesh();
    let error = convert(&mesh, &options, &octvox_cli::Progress::hidden(), &mut out).unwrap_err();
    assert!(matches!(error, ConvertError::OutsideCube { .. }), "{error}");
    assert!(out.is_empty());
    // Within them, it is a model.
    let bounds = Some([-1.0, -1.0, -1.0, 2.0, 2.0, 2.0]);
    assert!(Model::new(&mesh, &Options { bounds, ..options }).report.leaf_voxels > 0);
}
