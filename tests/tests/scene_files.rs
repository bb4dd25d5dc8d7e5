//! Scene files as their users render them: frames, parts and the whole, statistics, and what is refused.

use octvox_tests::meshes::torus;
use octvox_tests::programs::{Program, error_line, files_in, json, stdout};
use tempfile::TempDir;

const SCENE: &str = "
[[model]]
name = 'ring'
file = 'torus.obj'
resolution = 64

[[model.material]]
reflectivity = 0.5

[ground]

[camera.turntable]
frames = 3

[picture]
size = [48, 40]
";

/// A folder with a mesh and a scene of it.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("torus.obj"), torus(0.15, 48, 24).obj()).unwrap();
    std::fs::write(folder.path().join("scene.toml"), SCENE).unwrap();
    folder
}

fn render(folder: &TempDir, arguments: &[&str]) -> std::process::Output {
    Program::Voxtrace.run_in(folder.path(), &[&["render", "scene.toml", "--quiet"], arguments].concat())
}

#[test]
fn frames_are_pictures_of_their_own_and_can_be_had_one_by_one() {
    let folder = folder();
    let all = json(&render(&folder, &["-o", "turn.png", "--json"]));
    assert_eq!(all["frames"].as_array().unwrap().len(), 3);
    let first = &all["frames"][0];
    assert_eq!((&first["width"], &first["height"]), (&48.into(), &40.into()));
    assert_eq!(first["plan"], serde_json::json!(["phong", "shadows", "reflection"]));
    assert!(first["rays"]["reflection"].as_u64().unwrap() > 0);
    assert_eq!(first["rays"]["refraction"], 0);
    let files = files_in(folder.path());
    assert!(files.contains(&"turn.0002.png".into()) && !files.contains(&"turn.0003.png".into()), "{files:?}");
    let one = json(&render(&folder, &["-o", "one.png", "--frames", "2", "--json"]));
    assert_eq!(one["frames"][0]["image_hash"], all["frames"][2]["image_hash"]);
    assert_ne!(all["frames"][0]["image_hash"], all["frames"][1]["image_hash"]);
}

#[test]
fn parts_of_a_picture_merge_to_the_whole() {
    let folder = folder();
    for kind in ["png", "exr"] {
        let name = |part: &str| format!("{part}.0000.{kind}");
        for (part, region) in [("left", "0,0,17,40"), ("right", "17,0,31,40"), ("whole", "0,0,48,40")] {
            let arguments =
                ["-o", &format!("{part}.{kind}"), "--frames", "0", "--region", region, "--most-samples", "9"];
            stdout(&render(&folder, &arguments));
        }
        let merged = format!("merged.{kind}");
        let arguments = ["merge", &name("left"), &name("right"), "-o", &merged];
        stdout(&Program::Voxtrace.run_in(folder.path(), &arguments));
        let [merged, whole] =
            [merged, name("whole")].map(|name| std::fs::read(folder.path().join(name)).unwrap());
        assert!(merged == whole, "{kind}: the merged picture differs from the whole");
    }
}

#[test]
fn statistics_name_the_plan_and_the_rays() {
    let folder = folder();
    let text = stdout(&render(&folder, &["-o", "turn.png", "--frames", "0", "--stats"]));
    assert!(text.contains("plan: phong, shadows, reflection"), "{text}");
    assert!(text.contains("refraction 0"), "{text}");
}

#[test]
fn what_cannot_be_is_refused_with_its_place() {
    let folder = folder();
    let refused = |scene: &str, arguments: &[&str]| {
        std::fs::write(folder.path().join("scene.toml"), scene).unwrap();
        let line = error_line(&render(&folder, &[&["-o", "out.png"], arguments].concat()));
        assert!(!folder.path().join("out.png").exists());
        line
    };
    let line = refused(&SCENE.replace("frames = 3", "frams = 3"), &[]);
    assert!(line.contains("scene.toml:13:") && line.contains("frams"), "{line}");
    let line = refused(&SCENE.replace("torus.obj", "none.obj"), &[]);
    assert!(line.contains("none.obj"), "{line}");
    let line = refused(&SCENE.replace("0.5", "nan"), &[]);
    assert!(line.contains("scene.toml:8:"), "{line}");
    let line = refused(SCENE, &["--frames", "2..9"]);
    assert!(line.contains("3 frames"), "{line}");
    let line = refused(SCENE, &["--region", "0,0,49,1"]);
    assert!(line.contains("48x40"), "{line}");
    let line = refused(SCENE, &["--space", "world"]);
    assert!(line.contains("--space"), "{line}");
}
