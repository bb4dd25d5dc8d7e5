//! The command line of `voxconvert`.

mod common;

use common::{FIGURE_17, Settings, Tree, palette};
use octvox_format::v5::{Archive, Compression, Header};
use octvox_format::{NormalCode, WorldTransform, to_version_5};
use serde_json::{Value, json};
use std::io::Cursor;
use std::path::PathBuf;
use std::process::{Command, Output};
use tempfile::TempDir;

/// A folder that is removed when the test ends, and an input in it.
struct Place {
    folder: TempDir,
}

impl Place {
    fn new(input: &[u8]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("in.vox"), input).unwrap();
        Self { folder }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn run(&self, output: &str, options: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_voxconvert"))
            .args([self.path("in.vox"), self.path(output)])
            .args(options)
            .output()
            .unwrap()
    }

    /// What is written in a run that succeeds and says nothing on standard error.
    fn convert(&self, output: &str, options: &[&str]) -> Vec<u8> {
        let result = self.run(output, options);
        assert!(result.status.success() && result.stderr.is_empty(), "{result:?}");
        std::fs::read(self.path(output)).unwrap()
    }

    /// The one line on standard error of a run that fails and leaves nothing behind.
    fn error_line(&self, output: &str, options: &[&str]) -> String {
        let result = self.run(output, options);
        assert_eq!(result.status.code(), Some(1), "{result:?}");
        assert!(!self.path(output).exists());
        assert_eq!(std::fs::read_dir(self.folder.path()).unwrap().count(), 1);
        let text = String::from_utf8(result.stderr).unwrap();
        assert!(text.starts_with("error: ") && text.lines().count() == 1, "{text}");
        text
    }
}

fn header(file: &[u8]) -> Header {
    Archive::of_bytes(file).unwrap().header().clone()
}

#[test]
fn version_4_goes_through_version_5_and_comes_back() {
    for options in [&["--compression", "none"][..], &["--compression", "zstd", "--cut-level", "1"]] {
        let place = Place::new(&FIGURE_17);
        let file = place.convert("five.vox", &[options, &["--format", "5"]].concat());
        let header = header(&file);
        assert_eq!(header.normal_code, NormalCode::Spherical);
        assert_eq!(header.compression.name(), options[1]);
        assert_eq!(header.cut_level, u8::from(options.len() == 4));
        std::fs::rename(place.path("five.vox"), place.path("in.vox")).unwrap();
        assert_eq!(place.convert("four.vox", &["--format", "4"]), FIGURE_17);
    }
}

#[test]
fn without_options_the_version_stays() {
    assert_eq!(Place::new(&FIGURE_17).convert("out.vox", &[]), FIGURE_17);
    let settings =
        Settings { cut_level: 1, normal_code: NormalCode::Octahedral, compression: Compression::None };
    let file = Tree::chain(3).file_v5(&palette(), settings);
    assert_eq!(Place::new(&file).convert("out.vox", &[]), file);
}

#[test]
fn options_of_version_5_are_heard() {
    let place = Place::new(&Tree::chain(3).file(&palette()));
    let options = ["--format", "5", "--normals", "octahedral", "--cut-level", "2", "--level", "2"];
    let header = header(&place.convert("out.vox", &options));
    assert_eq!((header.depth, header.cut_level), (2, 2));
    assert_eq!((header.normal_code, header.compression), (NormalCode::Octahedral, Compression::Zstandard));
}

#[test]
fn levels_are_left_out() {
    let tree = Tree::chain(4);
    for input in [tree.file(&palette()), tree.file_v5(&palette(), Settings::PLAIN)] {
        let place = Place::new(&input);
        let expected = tree.down_to(2).file(&palette());
        assert_eq!(place.convert("out.vox", &["--format", "4", "--level", "2"]), expected);
        assert_eq!(place.convert("same.vox", &["--format", "4", "--level", "20"]), tree.file(&palette()));
    }
    let world = Some(WorldTransform { origin: [1.0, 2.0, 3.0], voxel_size: 0.5 });
    let file = to_version_5(Cursor::new(tree.file(&palette())), Vec::new(), |depth| Header {
        world,
        ..Header::new(depth)
    })
    .unwrap();
    let place = Place::new(&file);
    let coarse = header(&place.convert("out.vox", &["--level", "2"]));
    assert_eq!(coarse.world, Some(WorldTransform { origin: [1.0, 2.0, 3.0], voxel_size: 2.0 }));
    let binvox = place.convert("out.binvox", &["--level", "2"]);
    assert!(binvox.starts_with(b"#binvox 1\ndim 4 4 4\ntranslate 1 2 3\nscale 8\ndata\n"));
}

#[test]
fn volumes_are_written() {
    let place = Place::new(&FIGURE_17);
    assert_eq!(place.convert("out.raw", &[]), [2, 1, 2, 1, 2, 1, 2, 1]);
    assert_eq!(place.convert("two.raw", &["--cells", "u16", "--level", "0"]), [2, 0]);
    let array = place.convert("out.npy", &["--cells", "rgba", "--level", "0"]);
    assert_eq!(array[128..], [0, 0, 0, 255]);
    let binvox = place.convert("out.binvox", &[]);
    assert!(binvox.ends_with(b"data\n\x01\x08"));
}

#[test]
fn magicavoxel_goes_out_and_in() {
    let place = Place::new(&FIGURE_17);
    let file = place.convert("out.vox", &["--format", "magicavoxel"]);
    assert!(file.starts_with(b"VOX "));
    std::fs::rename(place.path("out.vox"), place.path("in.vox")).unwrap();
    let imported = place.convert("back.vox", &[]);
    let header = header(&imported);
    assert_eq!((header.depth, header.compression), (1, Compression::Zstandard));
    assert_eq!(header.world, Some(WorldTransform { origin: [-1.0, 0.0, -1.0], voxel_size: 1.0 }));
    assert_eq!(
        place.convert("out.raw", &["--cells", "rgba"]).chunks(4).filter(|cell| cell[0] == 255).count(),
        4
    );
    let four = place.convert("four.vox", &["--format", "4"]);
    assert_eq!(four[..6], [0x4D, 0x42, 4, 0, 2, 0]);
}

#[test]
fn the_report_says_what_was_done() {
    let place = Place::new(&FIGURE_17);
    let output = place.run("out.vox", &["--format", "5", "--json", "--quiet", "--threads", "2"]);
    assert!(output.status.success() && output.stderr.is_empty());
    let mut report: Value = serde_json::from_slice(&output.stdout).unwrap();
    let length = std::fs::metadata(place.path("out.vox")).unwrap().len();
    let report = report.as_object_mut().unwrap();
    assert!(report.remove("seconds").unwrap().as_f64().unwrap() >= 0.0);
    report.remove("peak_memory_bytes");
    let expected = json!({
        "input": "version 4", "output": "version 5", "depth": 1, "resolution": 2, "palette_size": 2,
        "input_bytes": 50, "file_bytes": length,
    });
    assert_eq!(Value::from(report.clone()), expected);
    let output = place.run("out.raw", &[]);
    let line = String::from_utf8(output.stdout).unwrap();
    assert!(line.ends_with("out.raw: raw, 2³, 8 bytes\n"), "{line}");
}

#[test]
fn failures_name_the_file_and_leave_nothing() {
    let mut damaged = Tree::chain(3).file_v5(&palette(), Settings::PLAIN);
    let length = damaged.len();
    damaged[length - 1] ^= 1;
    let line = Place::new(&damaged).error_line("out.vox", &["--format", "4"]);
    assert!(line.contains("in.vox") && line.contains("checksum"), "{line}");
    let line = Place::new(&FIGURE_17).error_line("out.raw", &["--max-bytes", "7"]);
    assert!(line.contains("in.vox") && line.contains("--level") && line.contains("2³"), "{line}");
    let line = Place::new(b"nothing").error_line("out.vox", &[]);
    assert!(line.contains("in.vox"), "{line}");
    let line = Place::new(b"VOX \x96\0\0\0MAIN").error_line("out.vox", &[]);
    assert!(line.contains("byte 12"), "{line}");
    let senseless = Tree::node(0, [0, 0, 0, 3, 0, 0, 0, 0].map(Tree::leaf)).file(&palette());
    let line = Place::new(&senseless).error_line("out.vox", &["--format", "5"]);
    assert!(line.contains("filled child"), "{line}");
}

#[test]
fn options_that_mean_nothing_are_refused() {
    let place = Place::new(&FIGURE_17);
    for (output, options) in [
        ("out.ply", &[][..]),
        ("out", &[]),
        ("out.vox", &["--compression", "none"]),
        ("out.npy", &["--format", "5"]),
        ("out.binvox", &["--cells", "u8"]),
        ("out.vox", &["--format", "6"]),
        ("out.vox", &["--level", "24"]),
    ] {
        let result = place.run(output, options);
        assert_eq!(result.status.code(), Some(2), "{output} {options:?}");
        assert!(!place.path(output).exists());
    }
}
