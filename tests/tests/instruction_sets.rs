//! The programs built for lesser processors: the same pictures and the same hits, bit for bit.

#![cfg(target_arch = "x86_64")]

use octvox_tests::meshes::torus;
use octvox_tests::models::Model;
use octvox_tests::programs::json;
use serde_json::Value;
use std::path::Path;
use std::process::Command;

/// Voxtrace, built for a processor.
fn build(processor: &str) -> std::path::PathBuf {
    let target = Path::new(env!("CARGO_TARGET_TMPDIR")).join(processor);
    escargot::CargoBuild::new()
        .package("octvox-raytracer")
        .bin("voxtrace")
        .current_release()
        .target_dir(target)
        .env("RUSTFLAGS", format!("-C target-cpu={processor}"))
        .run()
        .unwrap()
        .path()
        .to_path_buf()
}

#[test]
#[ignore = "long: builds the ray tracer up to five times more"]
fn pictures_and_hits_do_not_depend_on_the_instruction_set() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(
        folder.path().join("torus.vox"),
        Model::of_depth(&torus(0.1, 96, 48).colored_mesh(), 8).file,
    )
    .unwrap();
    let mut processors = vec!["x86-64", "x86-64-v2", "x86-64-v3", "native"];
    if is_x86_feature_detected!("avx512bw") && is_x86_feature_detected!("avx512dq") {
        processors.push("x86-64-v4");
    }
    let result_of = |processor: &&str| {
        let program = build(processor);
        let run = |arguments: &[&str]| -> Value {
            json(
                &Command::new(&program)
                    .args(arguments)
                    .arg("--json")
                    .current_dir(folder.path())
                    .output()
                    .unwrap(),
            )
        };
        let render = |options: &[&str]| {
            let arguments =
                [&["render", "torus.vox", "-o", "out.png", "--size", "333x222"], options].concat();
            let report = run(&arguments);
            [report["image_hash"].clone(), report["hit_pixels"].clone()]
        };
        let pictures = [
            render(&[]),
            render(&["--lod", "0"]),
            render(&["--samples", "3", "--lod", "2"]),
            render(&["--eye", "1e5,2e5,3e5", "--fov", "0.001"]),
            render(&["--eye", "0.2,0.3,0.8", "--fov", "90"]),
        ];
        (pictures, run(&["check", "torus.vox", "--rays", "100000"]))
    };
    let results: Vec<_> = processors.iter().map(result_of).collect();
    for (processor, result) in processors.iter().zip(&results) {
        assert_eq!(result, &results[0], "{processor}");
    }
}
