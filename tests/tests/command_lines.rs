//! The programs when all is well: what they print, and that they agree with each other.

use octvox_raytracer::Width;
use octvox_tests::meshes::{cube, torus};
use octvox_tests::models::sample_path;
use octvox_tests::programs::{Program, files_in, json, stdout};
use octvox_tests::{FIGURE_17, models::SAMPLES};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::path::Path;
use tempfile::TempDir;

/// A folder with a mesh of a closed torus.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("torus.obj"), torus(0.15, 64, 32).obj()).unwrap();
    folder
}

/// A folder with the torus and its octree of 64 cells per axis.
fn converted() -> TempDir {
    let folder = folder();
    stdout(&Program::Obj2vox.run_in(folder.path(), &["torus.obj", "-r", "64", "--quiet"]));
    folder
}

fn run_json(program: Program, folder: &Path, arguments: &[&str]) -> Value {
    json(&program.run_in(folder, &[arguments, &["--json"]].concat()))
}

/// The names of an object's fields, which must include the expected ones.
fn assert_has_fields(object: &Value, expected: &[&str]) {
    let names: BTreeSet<&str> = object.as_object().unwrap().keys().map(String::as_str).collect();
    for name in expected {
        assert!(names.contains(name), "{name} is missing from {names:?}");
    }
}

fn number(object: &Value, name: &str) -> f64 {
    object[name].as_f64().unwrap_or_else(|| panic!("{name} is no number in {object}"))
}

#[test]
fn obj2vox_tells_what_it_has_made() {
    let folder = folder();
    let report = run_json(Program::Obj2vox, folder.path(), &["torus.obj", "-r", "64", "-o", "out.vox"]);
    #[rustfmt::skip]
    assert_has_fields(&report, &[
        "triangles", "degenerate_triangles", "resolution", "depth", "leaf_voxels", "nodes", "stored_voxels",
        "thesis_voxels", "colors_found", "palette_size", "palette_error", "file_bytes", "peak_memory_bytes",
        "seconds", "warnings",
    ]);
    assert_eq!(report["triangles"], 2 * 64 * 32);
    assert_eq!(
        (&report["degenerate_triangles"], &report["resolution"], &report["depth"]),
        (&json!(0), &json!(64), &json!(6))
    );
    assert_eq!((&report["colors_found"], &report["palette_size"]), (&json!(1), &json!(1)));
    assert_eq!((&report["palette_error"], &report["warnings"]), (&json!(0.0), &json!([])));
    assert!((2000.0..20_000.0).contains(&number(&report, "leaf_voxels")), "{report}");
    assert_eq!(number(&report, "stored_voxels"), 1.0 + 8.0 * number(&report, "nodes"));
    assert!(number(&report, "thesis_voxels") >= number(&report, "stored_voxels"));
    assert!(number(&report, "peak_memory_bytes") > 1e6);
    let length = std::fs::metadata(folder.path().join("out.vox")).unwrap().len();
    assert_eq!(report["file_bytes"], length);
    let seconds = &report["seconds"];
    assert_has_fields(seconds, &["read", "palette", "scan", "build", "write", "total"]);
    let sum: f64 =
        ["read", "palette", "scan", "build", "write"].iter().map(|stage| number(seconds, stage)).sum();
    assert!(sum > 0.0 && sum <= number(seconds, "total") * 1.001, "{seconds}");
}

#[test]
fn voxinfo_tells_what_obj2vox_has_told() {
    let folder = folder();
    let made = run_json(Program::Obj2vox, folder.path(), &["torus.obj", "--depth", "6", "-o", "out.vox"]);
    let info = run_json(Program::Voxinfo, folder.path(), &["out.vox", "--validate", "--records", "3"]);
    #[rustfmt::skip]
    assert_has_fields(&info, &[
        "format", "depth", "resolution", "palette_size", "stored_voxels", "leaf_voxels", "nodes", "levels",
        "file_bytes", "valid", "world", "records",
    ]);
    for name in ["depth", "resolution", "palette_size", "stored_voxels", "leaf_voxels", "nodes", "file_bytes"]
    {
        assert_eq!(info[name], made[name], "{name}");
    }
    assert_eq!((&info["format"], &info["valid"]), (&json!(4), &json!(true)));
    let levels: Vec<u64> =
        info["levels"].as_array().unwrap().iter().map(|count| count.as_u64().unwrap()).collect();
    assert_eq!((levels.len(), levels[0]), (7, 1));
    assert!(levels.windows(2).all(|pair| pair[1] <= 8 * pair[0]), "{levels:?}");
    let records = info["records"].as_array().unwrap();
    assert_eq!(records.len(), 3);
    assert_has_fields(&records[0], &["level", "octant", "palette", "theta", "phi", "has_children"]);
    assert_eq!((&records[0]["level"], &records[0]["has_children"]), (&json!(0), &json!(true)));
}

#[test]
fn render_writes_the_picture_that_it_tells_of() {
    let folder = converted();
    let arguments = ["render", "torus.vox", "-o", "torus.png", "--size", "120x80", "--samples", "2"];
    let report = run_json(Program::Voxtrace, folder.path(), &arguments);
    assert_has_fields(&report, &["width", "height", "seconds", "plan", "rays", "image_hash", "hit_pixels"]);
    assert_eq!((&report["width"], &report["height"]), (&json!(120), &json!(80)));
    assert_has_fields(&report["seconds"], &["load", "trace", "write"]);
    assert!(report["plan"].as_array().is_some_and(|plan| plan.iter().all(Value::is_string)), "{report}");
    assert_eq!(report["rays"]["primary"], 120 * 80 * 2);
    let picture = image::open(folder.path().join("torus.png")).unwrap().into_rgba8();
    assert_eq!(picture.dimensions(), (120, 80));
    // The hash of the file's pixels is the one printed: FNV-1a of the bytes.
    let hash = picture.as_raw().iter().fold(0xCBF2_9CE4_8422_2325_u64, |hash, &byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01B3)
    });
    assert_eq!(report["image_hash"], format!("{hash:016x}"));
    let hit_pixels = number(&report, "hit_pixels");
    assert!(hit_pixels > 120.0 * 80.0 / 10.0 && hit_pixels < 120.0 * 80.0, "{hit_pixels}");
}

/// Cameras, levels of detail and further pictures.
#[test]
fn render_takes_a_camera() {
    let folder = converted();
    let render = ["render", "torus.vox", "-o", "out.png", "--size", "64x64"];
    let run = |options: &[&str]| run_json(Program::Voxtrace, folder.path(), &[&render[..], options].concat());
    let framed = run(&[]);
    let front = run(&["--eye", "0.5,0.5,3", "--target", "0.5,0.5,0.5", "--up", "0,1,0", "--fov", "25"]);
    assert_ne!(front["image_hash"], framed["image_hash"]);
    // In space `unit`, which is the default, the eye is where it is.
    let unit = run(&["--eye", "0.5,0.5,3", "--target", "0.5,0.5,0.5", "--fov", "25", "--space", "unit"]);
    assert_eq!(unit["image_hash"], front["image_hash"]);
    let past = run(&["--eye", "-1,0.5,3", "--target", "-1,0.5,5"]);
    assert_eq!(past["hit_pixels"], 0);
    let coarse = run(&["--lod", "8"]);
    assert!(number(&coarse, "hit_pixels") >= number(&framed, "hit_pixels"));
    run(&["--aov", "depth,normal,steps,level"]);
    for name in ["depth", "normal", "steps", "level"] {
        let path = folder.path().join(format!("out.{name}.png"));
        assert_eq!(image::open(path).unwrap().into_rgba8().dimensions(), (64, 64), "{name}");
    }
}

/// An OBJ file is converted in memory, to version 5, which keeps materials: the picture is that of such a file.
#[test]
fn render_takes_a_mesh() {
    let folder = folder();
    let convert = ["torus.obj", "-r", "64", "--format", "5", "-o", "torus.vox", "--quiet"];
    stdout(&Program::Obj2vox.run_in(folder.path(), &convert));
    let render = |options: &[&str]| {
        let arguments = [&["render", "-o", "out.png", "--size", "64x48"], options].concat();
        run_json(Program::Voxtrace, folder.path(), &arguments)
    };
    let from_vox = render(&["torus.vox"]);
    let from_obj = render(&["torus.obj", "-r", "64"]);
    assert_eq!(from_obj["image_hash"], from_vox["image_hash"]);
    // The torus is one wide, like the cube, and its corner is at (0, 0, 0): world and unit space are the same but for z.
    let unit = render(&["torus.obj", "-r", "64", "--eye", "0.5,0.5,3", "--target", "0.5,0.5,0.5"]);
    let world =
        ["torus.obj", "-r", "64", "--space", "world", "--eye", "0.5,0.5,3", "--target", "0.5,0.5,0.5"];
    let world = render(&world);
    assert_eq!(number(&world, "hit_pixels"), number(&unit, "hit_pixels"));
}

#[test]
fn the_picture_does_not_depend_on_threads() {
    let folder = converted();
    let hashes = ["1", "2", "3", "8"].map(|threads| {
        let arguments = ["render", "torus.vox", "-o", "out.png", "--size", "99x77", "--threads", threads];
        run_json(Program::Voxtrace, folder.path(), &arguments)["image_hash"].clone()
    });
    assert!(hashes.iter().all(|hash| *hash == hashes[0]), "{hashes:?}");
}

#[test]
fn the_file_does_not_depend_on_threads() {
    let folder = folder();
    let files = ["1", "2", "3", "8"].map(|threads| {
        stdout(
            &Program::Obj2vox
                .run_in(folder.path(), &["torus.obj", "-r", "128", "-o", "out.vox", "--threads", threads]),
        );
        std::fs::read(folder.path().join("out.vox")).unwrap()
    });
    assert!(files.iter().all(|file| *file == files[0]));
}

#[test]
fn bench_measures_every_setting() {
    let folder = converted();
    let arguments =
        ["bench", "torus.vox", "--size", "64x48", "--lanes", "1,4,8,16", "--grid", "0,16", "--threads", "2"];
    let report = run_json(Program::Voxtrace, folder.path(), &arguments);
    assert_has_fields(
        &report,
        &["model", "resolution", "leaf_voxels", "bytes_per_leaf", "instruction_set", "views"],
    );
    assert_eq!((&report["model"], &report["resolution"]), (&json!("torus.vox"), &json!(64)));
    assert!((1.0..1000.0).contains(&number(&report, "bytes_per_leaf")), "{report}");
    assert!(report["instruction_set"].as_str().is_some_and(|name| !name.is_empty()));
    let views = report["views"].as_array().unwrap();
    let mut settings = BTreeSet::new();
    for view in views {
        #[rustfmt::skip]
        assert_has_fields(view, &[
            "lanes", "grid", "beams", "lod", "threads", "mrays_per_s", "ms", "hit_fraction", "steps_per_ray",
            "rays", "arithmetic", "lane_utilisation", "counters",
        ]);
        assert!(view["beams"].is_boolean() && view["threads"] == 2, "{view}");
        assert!(number(view, "mrays_per_s") > 0.0 && number(view, "ms") > 0.0, "{view}");
        // Rays, time and speed belong together.
        let rays = number(view, "mrays_per_s") * number(view, "ms") * 1e3;
        assert!((rays / (64.0 * 48.0) - 1.0).abs() < 1e-6, "{view}");
        assert!(number(view, "hit_fraction") > 0.1 && number(view, "hit_fraction") < 1.0, "{view}");
        assert!(number(view, "steps_per_ray") > 0.0, "{view}");
        assert!((0.01..=1.0).contains(&number(view, "lane_utilisation")), "{view}");
        assert!(view["rays"] == "primary" && view["counters"].is_null(), "{view}");
        assert_eq!(view["hit_fraction"], views[0]["hit_fraction"], "{view}");
        settings.insert((view["lanes"].as_u64(), view["grid"].as_u64()));
    }
    let expected = [1, 4, 8, 16].into_iter().flat_map(|lanes| [0, 16].map(|grid| (Some(lanes), Some(grid))));
    assert_eq!(settings, expected.collect());
}

/// In double precision there is one width.
#[test]
fn bench_measures_both_arithmetics() {
    let folder = converted();
    #[rustfmt::skip]
    let report = run_json(Program::Voxtrace, folder.path(), &[
        "bench", "torus.vox", "--size", "64x48", "--repeat", "5", "--lanes", "4,16", "--rays", "primary,shadow",
        "--arithmetic", "single,double",
    ]);
    let views = report["views"].as_array().unwrap();
    let settings: Vec<_> =
        views.iter().map(|view| (&view["rays"], &view["arithmetic"], &view["lanes"])).collect();
    let [primary, shadow, single, double] = ["primary", "shadow", "single", "double"].map(|name| json!(name));
    let [four, eight, sixteen] = [4, 8, 16].map(|lanes| json!(lanes));
    let expected = [&primary, &shadow]
        .into_iter()
        .flat_map(|rays| [(rays, &single, &four), (rays, &single, &sixteen), (rays, &double, &eight)]);
    assert_eq!(settings, expected.collect::<Vec<_>>());
    assert!(
        views.iter().all(|view| number(view, "hit_fraction") > 0.01 && number(view, "steps_per_ray") > 0.0)
    );
}

#[test]
fn bench_measures_secondary_rays_too() {
    let folder = converted();
    #[rustfmt::skip]
    let report = run_json(Program::Voxtrace, folder.path(), &[
        "bench", "torus.vox", "--size", "64x48", "--repeat", "5", "--lanes", "8", "--threads", "1",
        "--rays", "primary,shadow,ambient,reflection", "--counters", "--lod", "0",
    ]);
    let views = report["views"].as_array().unwrap();
    let kinds: Vec<_> = views.iter().map(|view| view["rays"].as_str().unwrap()).collect();
    assert_eq!(kinds, ["primary", "shadow", "ambient", "reflection"]);
    let hits = 64.0 * 48.0 * number(&views[0], "hit_fraction");
    for view in &views[1..] {
        // No more than one for each pixel that shows the torus, and some of them meet it again.
        let rays = number(view, "mrays_per_s") * number(view, "ms") * 1e3;
        assert!(rays <= hits + 0.5 && rays > hits / 4.0, "{view}");
        assert!(number(view, "hit_fraction") > 0.0 && number(view, "hit_fraction") < 0.9, "{view}");
        assert!(number(view, "steps_per_ray") > 0.0, "{view}");
    }
    // Where the machine has counters, they count.
    for counters in views.iter().map(|view| &view["counters"]).filter(|counters| !counters.is_null()) {
        assert!(number(counters, "cycles") > 1.0 && number(counters, "instructions") > 1.0, "{counters}");
    }
}

#[test]
fn check_finds_nothing() {
    let folder = converted();
    let report =
        run_json(Program::Voxtrace, folder.path(), &["check", "torus.vox", "--rays", "20000", "--seed", "7"]);
    #[rustfmt::skip]
    assert_has_fields(&report, &[
        "arithmetic", "rays", "widths", "width_differences", "differences", "mismatches", "leaks", "max_steps",
        "guard_hits", "max_distance_error", "worst_ray", "picture_rays", "picture_differences", "replay",
    ]);
    assert_eq!((&report["rays"], &report["widths"]), (&json!(20_000), &json!(Width::ALL.map(Width::lanes))));
    for name in ["width_differences", "mismatches", "leaks", "guard_hits", "picture_differences"] {
        assert_eq!(report[name], 0, "{name}");
    }
    assert!(number(&report, "picture_rays") >= 20_000.0, "{report}");
    assert!(number(&report, "max_steps") > 5.0 && number(&report, "max_steps") < 3.0 * 64.0, "{report}");
    assert!(number(&report, "max_distance_error") < 0.01, "{report}");
    // The worst ray, once more and alone.
    let command = report["replay"].as_str().unwrap();
    assert_eq!(command, format!("voxtrace check torus.vox --seed 7 --replay {}", report["worst_ray"]));
    let replay = run_json(Program::Voxtrace, folder.path(), &command.split(' ').skip(1).collect::<Vec<_>>());
    assert_eq!(replay["distance_error"], report["max_distance_error"], "{replay}");
    assert_eq!((&replay["widths_differ"], &replay["is_mismatch"]), (&json!(false), &json!(false)));
    let widths = replay["widths"].as_array().unwrap();
    assert!(widths.iter().all(|width| width["hit"]["cell"] == replay["exact"]["cell"]), "{replay}");
    assert_eq!(replay["double"]["hit"], replay["exact"], "{replay}");
    // The same rays again, and others.
    let again = run_json(
        Program::Voxtrace,
        folder.path(),
        &["check", "torus.vox", "--rays", "2e4", "--seed", "7", "--threads", "1"],
    );
    assert_eq!(again, report);
    let other =
        run_json(Program::Voxtrace, folder.path(), &["check", "torus.vox", "--rays", "20000", "--seed", "8"]);
    assert_ne!(other, report);
}

/// In double precision every voxel and every distance is the exact one, of a mesh too.
#[test]
fn check_in_double_precision_finds_no_difference() {
    let folder = converted();
    let arguments = ["check", "torus.obj", "-r", "64", "--rays", "20000", "--arithmetic", "double"];
    let report = run_json(Program::Voxtrace, folder.path(), &arguments);
    assert_eq!((&report["arithmetic"], &report["widths"]), (&json!("double"), &json!([8])));
    for name in ["differences", "leaks", "guard_hits", "picture_differences"] {
        assert_eq!(report[name], 0, "{name}");
    }
    assert_eq!(report["max_distance_error"], 0.0);
    let command = report["replay"].as_str().unwrap();
    assert!(
        command.starts_with("voxtrace check torus.obj -r 64 --arithmetic double --seed 1 --replay "),
        "{command}"
    );
    run_json(Program::Voxtrace, folder.path(), &command.split(' ').skip(1).collect::<Vec<_>>());
}

/// An open model has no inside, so no count of leaks.
#[test]
fn check_tells_no_leaks_of_an_open_model() {
    let folder = tempfile::tempdir().unwrap();
    let mut open = cube();
    open.triangles.truncate(8);
    std::fs::write(folder.path().join("open.obj"), open.obj()).unwrap();
    let report =
        run_json(Program::Voxtrace, folder.path(), &["check", "open.obj", "-r", "32", "--rays", "1000"]);
    assert_eq!(report["leaks"], Value::Null);
}

/// Without `--json`, tables; with or without `--quiet`, nothing on standard error, which is no terminal here.
#[test]
fn results_are_on_standard_output_and_nothing_else_is() {
    let folder = converted();
    for (program, arguments) in [
        (Program::Obj2vox, &["torus.obj", "-r", "32", "-o", "again.vox"][..]),
        (Program::Voxinfo, &["torus.vox", "--histogram"]),
        (Program::Voxtrace, &["render", "torus.vox", "-o", "out.png", "--size", "32x32"]),
        (Program::Voxtrace, &["bench", "torus.vox", "--size", "32x32", "--lanes", "1,16"]),
        (Program::Voxtrace, &["check", "torus.vox", "--rays", "1000"]),
    ] {
        for options in [&[][..], &["--quiet"], &["--threads", "2"], &["--quiet", "--json"]] {
            let output = program.run_in(folder.path(), &[arguments, options].concat());
            let text = stdout(&output);
            assert!(!text.trim().is_empty(), "{program:?} {arguments:?}");
            assert_eq!(serde_json::from_str::<Value>(&text).is_ok(), options.contains(&"--json"), "{text}");
            assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
        }
    }
}

#[test]
fn help_has_an_example() {
    let folder = tempfile::tempdir().unwrap();
    for program in Program::ALL {
        let name = program.name();
        let help = stdout(&program.run_in(folder.path(), &["--help"]));
        assert!(help.contains("Example") && help.contains(&format!("{name} ")), "{help}");
        assert!(stdout(&program.run_in(folder.path(), &["--version"])).starts_with(name));
    }
    for command in ["render", "bench", "check"] {
        let help = stdout(&Program::Voxtrace.run_in(folder.path(), &[command, "--help"]));
        assert!(help.contains("Example") && help.contains(&format!("voxtrace {command} ")), "{help}");
    }
}

/// The default output of `obj2vox` is the model's name in the current folder.
#[test]
fn obj2vox_names_its_output() {
    let folder = folder();
    stdout(&Program::Obj2vox.run_in(folder.path(), &["torus.obj", "-r", "16"]));
    assert_eq!(files_in(folder.path()), ["torus.obj", "torus.vox"]);
}

/// What conversion can be told: each option has its effect.
#[test]
fn obj2vox_takes_options() {
    let folder = folder();
    let convert = |options: &[&str]| {
        let arguments = [&["torus.obj", "-r", "32", "-o", "out.vox"], options].concat();
        run_json(Program::Obj2vox, folder.path(), &arguments)
    };
    let plain = convert(&[]);
    assert!(number(&convert(&["--conservative"]), "leaf_voxels") > 1.3 * number(&plain, "leaf_voxels"));
    let unpruned = convert(&["--no-prune"]);
    assert_eq!(unpruned["stored_voxels"], unpruned["thesis_voxels"]);
    let half = convert(&["--bounds=0,0,0,2,2,2"]);
    let ratio = number(&half, "leaf_voxels") / number(&plain, "leaf_voxels");
    assert!((0.2..0.3).contains(&ratio), "{ratio}");
    let sized = convert(&["--voxel-size", "0.0625"]);
    let ratio = number(&sized, "leaf_voxels") / number(&plain, "leaf_voxels");
    assert!((0.2..0.3).contains(&ratio), "{ratio}");
}

/// The samples, from the folder of the project, through all three programs.
#[test]
fn samples_go_through_all_programs() {
    let folder = tempfile::tempdir().unwrap();
    for name in SAMPLES {
        let (obj, vox, png) = (sample_path(name), format!("{name}.vox"), format!("{name}.png"));
        let made =
            run_json(Program::Obj2vox, folder.path(), &[obj.to_str().unwrap(), "-r", "128", "-o", &vox]);
        assert_eq!(made["warnings"], json!([]), "{name}");
        let info = run_json(Program::Voxinfo, folder.path(), &[&vox, "--validate"]);
        assert_eq!(info["leaf_voxels"], made["leaf_voxels"], "{name}");
        let report =
            run_json(Program::Voxtrace, folder.path(), &["render", &vox, "-o", &png, "--size", "96x64"]);
        assert!(number(&report, "hit_pixels") > 500.0, "{name}");
        let check = run_json(Program::Voxtrace, folder.path(), &["check", &vox, "--rays", "5000"]);
        assert_eq!((&check["mismatches"], &check["width_differences"]), (&json!(0), &json!(0)), "{name}");
    }
}

/// The example of the thesis, rendered by the program.
#[test]
fn figure_17_goes_through_the_programs() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("figure17.vox"), FIGURE_17).unwrap();
    let info = run_json(Program::Voxinfo, folder.path(), &["figure17.vox", "--validate"]);
    assert_eq!(
        (&info["stored_voxels"], &info["leaf_voxels"], &info["depth"]),
        (&json!(9), &json!(8), &json!(1))
    );
    let report = run_json(
        Program::Voxtrace,
        folder.path(),
        &["render", "figure17.vox", "-o", "out.png", "--size", "64x64"],
    );
    assert!(number(&report, "hit_pixels") > 1000.0);
}

/// Without arguments, `voxtrace` shows the whole chain on a sample.
#[test]
fn voxtrace_without_arguments_shows_a_sample() {
    let folder = tempfile::tempdir().unwrap();
    let text = stdout(&Program::Voxtrace.run_in(folder.path(), &[]));
    assert!(text.contains("shell.vox") && text.contains("shell.png"), "{text}");
    assert_eq!(files_in(&folder.path().join("out")), ["shell.png", "shell.vox"]);
    run_json(Program::Voxinfo, folder.path(), &["out/shell.vox", "--validate"]);
}
