//! The files in `models/` are those the program writes.

use std::path::{Path, PathBuf};
use std::process::Command;

fn committed(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("models").join(name)
}

#[test]
fn the_program_writes_the_committed_files() {
    let folder = tempfile::tempdir().unwrap();
    let program = env!("CARGO_BIN_EXE_octvox-samples");
    let output = Command::new(program).arg("all").arg("-o").arg(folder.path()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder.path()).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        let (written, expected) = (folder.path().join(&name), committed(&name));
        if name.ends_with(".png") {
            // How pixels are packed may change with the encoder, the pixels may not.
            let [written, expected] = [written, expected].map(|path| image::open(path).unwrap().into_rgb8());
            assert!(written == expected, "{name} differs from the committed file");
        } else {
            let [written, expected] = [written, expected].map(|path| std::fs::read(path).unwrap());
            assert!(written == expected, "{name} differs from the committed file");
        }
        names.push(name);
    }
    assert_eq!(
        String::from_utf8(output.stdout).unwrap().lines().count(),
        names.len(),
        "one line for each file"
    );
    let committed_files = std::fs::read_dir(committed("")).unwrap().count();
    assert_eq!(names.len(), committed_files, "models/ holds files that the program does not write");
}

#[test]
fn the_readme_tells_the_number_of_triangles() {
    let readme = std::fs::read_to_string(committed("../README.md")).unwrap();
    for name in ["shell", "lighthouse", "knots", "globe", "tree", "pine", "ball"] {
        let text = std::fs::read_to_string(committed(&format!("{name}.obj"))).unwrap();
        let corners =
            text.lines().filter(|line| line.starts_with("f ")).map(|line| line.split(' ').count() - 1);
        let triangles: usize = corners.map(|corners| corners - 2).sum();
        let (thousands, rest) = (triangles / 1000, triangles % 1000);
        let row = format!("| `{name}.obj` | {thousands},{rest:03} |");
        assert!(readme.contains(&row), "README.md lacks a row that starts with {row}");
    }
}

#[test]
fn an_unknown_scene_is_a_wrong_argument() {
    let program = env!("CARGO_BIN_EXE_octvox-samples");
    let output = Command::new(program).arg("teapot").output().unwrap();
    assert_eq!(output.status.code(), Some(2));
}
