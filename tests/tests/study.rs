//! `voxtrace study` as its users start it: the report and what belongs to it, going on after a stop, what is refused.

use octvox_tests::meshes::torus;
use octvox_tests::programs::{Program, error_line, files_in, json};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

/// Quick, small, and nothing that is large to convert.
const SMALL: [&str; 8] =
    ["--quick", "--quiet", "--size=48x40", "--fov=35", "--finest=64", "--check-rays=2000", "-r=64", "--json"];

fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("torus.obj"), torus(0.15, 48, 24).obj()).unwrap();
    folder
}

fn study(folder: &Path, arguments: &[&str]) -> Output {
    Program::Voxtrace.run_in(folder, &[&["study", "torus.obj", "-o", "study"], arguments].concat())
}

/// Runs the command of each setting that has a picture: it must be that of the study, to the last bit. Returns how many there
/// were. What is said behind a `#` is for people, and not tried.
fn repeat_pictures(folder: &Path) -> usize {
    let folders = [Program::Voxtrace, Program::Obj2vox].map(|program| program.path().parent().unwrap());
    let inherited = std::env::var_os("PATH").unwrap_or_default();
    let path =
        std::env::join_paths(folders.iter().map(PathBuf::from).chain(std::env::split_paths(&inherited)))
            .unwrap();
    let results = std::fs::read_to_string(folder.join("study/results.jsonl")).unwrap();
    let mut repeated = 0;
    for line in results.lines() {
        let setting = &serde_json::from_str::<Value>(line).unwrap()["setting"];
        let (Some(command), Some(picture)) = (setting["command"].as_str(), setting["picture"].as_str())
        else {
            continue;
        };
        if command.contains('#') {
            continue;
        }
        let output =
            Command::new("sh").args(["-c", command]).env("PATH", &path).current_dir(folder).output().unwrap();
        assert!(output.status.success(), "{command}: {}", String::from_utf8_lossy(&output.stderr));
        let pixels = |path: &str| image::open(folder.join(path)).unwrap().into_rgba8();
        assert!(pixels("picture.png") == pixels(&format!("study/{picture}")), "{command}: not {picture}");
        repeated += 1;
    }
    repeated
}

#[test]
fn a_mesh_is_studied_and_the_study_goes_on_after_a_stop() {
    let folder = folder();
    let told = json(&study(folder.path(), &SMALL));
    let settings = told["settings"].as_u64().unwrap();
    assert!(settings > 40, "{told}");
    assert!(told["farthest_default"].as_f64().unwrap() >= 1.0, "{told}");
    // Along the front, whoever waits longer gets a better picture. The default stands there once for each knob that has it.
    let front: Vec<[f64; 2]> = told["front"]
        .as_array()
        .unwrap()
        .iter()
        .map(|point| ["seconds", "error"].map(|key| point[key].as_f64().unwrap()))
        .collect();
    assert!(front.len() >= 2, "{told}");
    let goes_on = |[a, b]: [[f64; 2]; 2]| a == b || (a[0] <= b[0] && a[1] > b[1]);
    assert!(front.windows(2).all(|pair| goes_on([pair[0], pair[1]])), "{front:?}");

    let study_folder = folder.path().join("study");
    let files = files_in(&study_folder);
    for name in ["report.html", "results.csv", "results.jsonl"] {
        assert!(files.contains(&name.into()), "{name} of {files:?}");
    }
    let csv = std::fs::read_to_string(study_folder.join("results.csv")).unwrap();
    assert_eq!(csv.lines().count() as u64, settings + 1);
    let report = std::fs::read_to_string(study_folder.join("report.html")).unwrap();
    for words in ["torus.obj", "double precision", "integers", "The tables of the thesis again", "<svg"] {
        assert!(report.contains(words), "{words}");
    }

    // Stopped while the last line was written: only what is missing is measured again.
    let path = study_folder.join("results.jsonl");
    let all = std::fs::read_to_string(&path).unwrap();
    std::fs::write(&path, &all[..all.len() / 2]).unwrap();
    let kept = all[..all.len() / 2].rfind('\n').unwrap();
    let told = json(&study(folder.path(), &SMALL));
    assert_eq!(told["settings"].as_u64(), Some(settings));
    let again = std::fs::read_to_string(&path).unwrap();
    assert_eq!(again[..kept], all[..kept], "what had been measured was measured again");
    // Settings and chapters; how often the default was timed depends on where it stopped.
    let measured = |text: &str| text.lines().filter(|line| !line.contains("default_seconds")).count();
    assert_eq!(measured(&again), measured(&all));
    assert!(repeat_pictures(folder.path()) > 30);
}

#[test]
fn a_scene_with_effects_is_held_against_its_exact_setting() {
    let folder = folder();
    let scene = "
        [[model]]
        name = 'ring'
        file = 'torus.obj'
        resolution = 64
        [[model.material]]
        reflectivity = 0.5
        [ground]
        [[light]]
        kind = 'directional'
        towards = [1, 2, 1]
        angle = 5
        [ambient]
        occlusion = 0.3
    ";
    std::fs::write(folder.path().join("scene.toml"), scene).unwrap();
    let arguments = ["--quick", "--quiet", "--size=32x24", "--finest=64", "--json"];
    let output = Program::Voxtrace
        .run_in(folder.path(), &[&["study", "scene.toml", "-o", "study"], &arguments[..]].concat());
    assert!(json(&output)["settings"].as_u64().unwrap() > 30);
    let csv = std::fs::read_to_string(folder.path().join("study/results.csv")).unwrap();
    for knob in ["bounces", "light-samples", "ambient-samples", "cutoff", "leave", "lod", "samples"] {
        assert!(csv.lines().any(|line| line.starts_with(knob)), "{knob} of {csv}");
    }
    assert!(repeat_pictures(folder.path()) > 20);
}

#[test]
fn what_cannot_be_studied_is_refused() {
    let folder = folder();
    let refused = |model: &str, arguments: &[&str]| {
        let output =
            Program::Voxtrace.run_in(folder.path(), &[&["study", model, "-o", "study"], arguments].concat());
        error_line(&output)
    };
    let line = refused("none.obj", &[]);
    assert!(line.contains("none.obj"), "{line}");
    let nowhere = refused("torus.obj", &["-r=64", "--eye=0,0,0", "--target=0,0,0"]);
    assert!(nowhere.contains("cannot look at"), "{nowhere}");
    std::fs::create_dir_all(folder.path().join("study")).unwrap();
    std::fs::write(folder.path().join("study/results.jsonl"), "{\"study\":\"another\"}\n").unwrap();
    let line = refused("torus.obj", &SMALL);
    assert!(line.contains("--anew") && line.contains("results.jsonl"), "{line}");
}
