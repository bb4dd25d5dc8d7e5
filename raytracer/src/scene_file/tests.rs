//! What scene files say, and how they are refused.

use super::*;
use crate::scene::Source;
use crate::{Arithmetic, Filter, Leave, Projection, ToneMapping, to_linear};
use glam::{DVec3, Vec3};
use octvox_format::{Palette, SphericalNormal, Voxel, Writer};
use std::path::PathBuf;

const DOCUMENTATION: &str = include_str!("../../SCENES.md");
const MODEL: &str = "[[model]]\nname = 'a'\nfile = 'a.vox'\n";
const COLORS: [[u8; 3]; 3] = [[9, 9, 9], [255, 0, 16], [9, 9, 9]];

/// The cell at the cube's greatest coordinates is filled, an eighth of its edge wide.
fn corner() -> Octree {
    let mut writer = Writer::new(Vec::new(), &Palette::new(COLORS.to_vec()).unwrap()).unwrap();
    let voxel = Voxel { palette_index: 1, normal: SphericalNormal { theta: 0, phi: 0 } };
    for level in 0..4 {
        for _ in 0..if level == 0 { 0 } else { 7 } {
            writer.leaf(Voxel::EMPTY).unwrap();
        }
        if level == 3 { writer.leaf(voxel).unwrap() } else { writer.node(voxel).unwrap() }
    }
    Octree::from_bytes(&writer.finish().unwrap()).unwrap()
}

fn parse(text: &str) -> Result<SceneFile, SceneFileError> {
    SceneFile::parse(text, "scenes/test.toml".as_ref())
}

/// A file with one model, and `text`.
fn file(text: &str) -> SceneFile {
    parse(&format!("{MODEL}{text}")).unwrap_or_else(|error| panic!("{error}"))
}

/// The scene of one model and `text`, at a frame.
fn shot<'a>(octrees: &'a [Octree], text: &str, frame: u32) -> Shot<'a> {
    file(text).shot(frame, 1.5, octrees).unwrap_or_else(|error| panic!("{error}"))
}

/// What is said of one model and `text`, before its models are loaded or after.
fn error(text: &str) -> String {
    let octrees = [corner()];
    let text = format!("{MODEL}{text}");
    let result = parse(&text).and_then(|file| file.shot(0, 1.5, &octrees).map(|_| ()));
    result.expect_err(&text).to_string()
}

/// The error is at a line and column after the model, and says something.
fn refused(text: &str, [line, column]: [usize; 2], says: &str) {
    let message = error(text);
    let line = line + MODEL.lines().count();
    assert!(message.starts_with(&format!("scenes/test.toml:{line}:{column}: ")), "{text}: {message}");
    assert!(message.contains(says), "{text}: {message}");
    assert!(!message.contains('\n'), "{message}");
}

fn near(found: DVec3, expected: [f64; 3]) {
    let expected = DVec3::from_array(expected);
    assert!((found - expected).length() < 1e-6, "{found}, expected {expected}");
}

/// The TOML examples of the documentation.
fn examples() -> Vec<&'static str> {
    let blocks = DOCUMENTATION.split("```toml\n").skip(1);
    blocks.map(|block| block.split("```").next().unwrap()).collect()
}

#[test]
fn the_documentation_is_right() {
    let folder = tempfile::tempdir().unwrap();
    image::RgbImage::from_pixel(2, 1, image::Rgb([255; 3])).save(folder.path().join("sky.png")).unwrap();
    let examples = examples();
    assert!(examples.len() > 12);
    for example in &examples {
        let text =
            if *example == examples[0] { (*example).into() } else { format!("{}\n{example}", examples[0]) };
        let file = SceneFile::parse(&text, &folder.path().join("scene.toml"));
        let file = file.unwrap_or_else(|error| panic!("{error} in\n{text}"));
        let octrees: Vec<Octree> = file.models().map(|_| corner()).collect();
        // Materials are chosen by what a palette has, of which this is none.
        if !example.contains("model.material") {
            file.shot(0, 1.5, &octrees).unwrap_or_else(|error| panic!("{error} in\n{text}"));
        }
    }
}

#[test]
fn every_key_is_documented() {
    let tables = [
        ("", "model"),
        ("[[model]]", "file"),
        ("[[model]]\nname = 'b'\nfile = 'b'\n[[model.material]]", "diffuse"),
        ("[[instance]]", "anchor"),
        ("[[instance]]\nmodel = 'a'\n[[instance.key]]", "turn"),
        ("[[scatter]]", "area"),
        ("[camera]", "fov"),
        ("[[camera.key]]", "target"),
        ("[camera.turntable]", "axis"),
        ("[[light]]", "cone"),
        ("[ambient]", "glow"),
        ("[background]", "picture"),
        ("[ground]", "checker"),
        ("[picture]", "exposure"),
        ("[quality]", "cutoff"),
    ];
    for (table, known) in tables {
        let text = format!("{table}\nunknown = 1\n");
        let message = parse(&text).unwrap_err().to_string();
        let line = text.lines().position(|line| line.starts_with("unknown")).unwrap() + 1;
        assert!(
            message.starts_with(&format!("scenes/test.toml:{line}:1: unknown field")),
            "{table}: {message}"
        );
        let keys: Vec<&str> = message.split('`').skip(3).step_by(2).collect();
        assert!(keys.contains(&known), "{message}");
        for key in keys {
            let is_there = examples().iter().any(|block| {
                block.lines().any(|line| match line.strip_prefix(key) {
                    Some(rest) => rest.starts_with(" = "),
                    None => line.starts_with(&format!("[{key}]")) || line.starts_with(&format!("[[{key}]]")),
                }) || block.contains(&format!(".{key}]"))
            });
            let in_text = DOCUMENTATION.contains(&format!("`{key}`"));
            assert!(is_there || in_text, "{key} of {table}");
        }
    }
}

#[test]
fn a_file_of_one_model_shows_it() {
    let octrees = [corner()];
    let file = file("");
    let path = PathBuf::from("scenes/a.vox");
    assert_eq!(file.models().collect::<Vec<_>>(), [ModelFile { path, depth: None, line: 3 }]);
    assert_eq!((file.size(), file.quality(), file.tone()), (None, Quality::default(), Tone::default()));
    assert_eq!(file.frames(), 1);
    let shot = file.shot(0, 1.5, &octrees).unwrap();
    assert!(shot.studio && shot.scene.lights.is_empty() && shot.scene.ground.is_none());
    assert_eq!(shot.scene.models, [Model::new(&octrees[0])]);
    assert_eq!(shot.scene.instances[0].placement, crate::scene::Similarity::IDENTITY);
    assert_eq!(shot.camera, Camera::framing(&octrees[0], 1.5, crate::DEFAULT_FOV));
    assert_eq!(shot.lens, Lens::default());
}

#[test]
fn one_file_is_loaded_once() {
    let file = parse(
        "[[model]]\nname = 'a'\nfile = 'x.obj'\n[[model]]\nname = 'b'\nfile = 'x.obj'\nresolution = 64\n\
         [[model]]\nname = 'c'\nfile = 'x.obj'\n[[model.material]]\ntransparency = 0.5",
    )
    .unwrap();
    let depths: Vec<_> = file.models().map(|model| (model.depth, model.line)).collect();
    assert_eq!(depths, [(None, 3), (Some(6), 6)]);
    let octrees = [corner(), corner()];
    let shot = file.shot(0, 1.0, &octrees).unwrap();
    let transparencies: Vec<_> =
        shot.scene.models.iter().map(|model| model.surfaces[0].transparency).collect();
    assert_eq!(transparencies, [0.0, 0.0, 0.5]);
    assert!(std::ptr::eq(shot.scene.models[0].octree, shot.scene.models[2].octree));
}

#[test]
fn materials_are_changed_where_they_are_chosen() {
    let octrees = [corner()];
    let shot = shot(
        &octrees,
        "[[model.material]]\nspecular = 0.5\nshininess = 7\n\
         [[model.material]]\nentry = 2\ndiffuse = '#ff0080'\nreflectivity = [0.1, 0.2, 0.3]\n\
         [[model.material]]\nentries = [1, 2]\ntransparency = 0.25\nrefraction_index = 0.7\n\
         [[model.material]]\ncolor = '#090909'\nabsorption = [1, 2, 3]\nemission = 4",
        0,
    );
    let [first, second, third] = shot.scene.models[0].surfaces[..] else { panic!() };
    for surface in [first, second, third] {
        assert_eq!((surface.specular, surface.shininess), (Vec3::splat(0.5), 7.0));
    }
    assert_eq!(second.diffuse, Vec3::new(1.0, 0.0, to_linear(128)));
    assert_eq!(second.reflectivity, Vec3::new(0.1, 0.2, 0.3));
    assert_eq!([first, second, third].map(|surface| surface.transparency), [0.25, 0.25, 0.0]);
    assert_eq!([first, second, third].map(|surface| surface.refraction_index), [0.7, 0.7, 1.0]);
    assert_eq!((first.emission, third.emission), (Vec3::splat(4.0), Vec3::splat(4.0)));
    assert_eq!((first.absorption, second.absorption), (Vec3::new(1.0, 2.0, 3.0), Vec3::ZERO));
}

#[test]
fn materials_that_are_not_there_are_refused() {
    refused("[[model.material]]\nentry = 4", [2, 9], "no entry 4; its entries are 1 to 3");
    refused("[[model.material]]\nentry = 0", [2, 9], "no entry 0");
    refused("[[model.material]]\nentries = [1,\n 99]", [3, 2], "no entry 99");
    refused("\n[[model.material]]\nentries = []", [2, 1], "changes no entry");
    refused("[[model.material]]\ncolor = '#123456'", [2, 9], "the colour #123456");
    refused("[[model.material]]\ncolor = '#090909'\nentry = 1", [3, 9], "exclude each other");
    refused("[[model.material]]\nreflectivity = 1.5", [2, 16], "shares from 0 to 1");
    refused("[[model.material]]\nrefraction_index = 0", [2, 20], "above zero");
}

#[test]
fn anchors_stand_at_the_position() {
    let octrees = [corner()];
    let text = |anchor: &str| {
        format!(
            "[[instance]]\nmodel = 'a'\nposition = [5, 6, 7]\nturn = [0, 90, 0]\nscale = 4\nanchor = '{anchor}'"
        )
    };
    let place = |anchor: &str| shot(&octrees, &text(anchor), 0).scene.instances[0].placement;
    near(place("cube").to_scene(DVec3::ZERO), [5.0, 6.0, 7.0]);
    near(place("center").to_scene(DVec3::splat(0.9375)), [5.0, 6.0, 7.0]);
    near(place("base").to_scene(DVec3::new(0.9375, 0.875, 0.9375)), [5.0, 6.0, 7.0]);
    // About y, z becomes x.
    near(place("cube").to_scene(DVec3::Z), [9.0, 6.0, 7.0]);
    near(place("cube").to_scene(DVec3::Y), [5.0, 10.0, 7.0]);
}

#[test]
fn turns_are_about_x_then_y_then_z() {
    let octrees = [corner()];
    let shot = shot(&octrees, "[[instance]]\nmodel = 'a'\nturn = [90, 90, 90]", 0);
    let place = shot.scene.instances[0].placement;
    // y to z about x, z to x about y, x to y about z.
    near(place.to_scene(DVec3::Y), [0.0, 1.0, 0.0]);
    near(place.to_scene(DVec3::Z), [1.0, 0.0, 0.0]);
}

#[test]
fn instances_move_between_their_keys() {
    let octrees = [corner()];
    let text = "[[instance]]\nmodel = 'a'\nscale = 1\n\
                [[instance.key]]\nframe = 10\nposition = [0, 0, 0]\nturn = [0, 0, 0]\n\
                [[instance.key]]\nframe = 30\nposition = [4, 0, 2]\nturn = [0, 0, 90]\nscale = 4";
    assert_eq!(file(text).frames(), 31);
    let place = |frame| shot(&octrees, text, frame).scene.instances[0].placement;
    near(place(0).translation, [0.0; 3]);
    near(place(20).translation, [2.0, 0.0, 1.0]);
    near(place(99).translation, [4.0, 0.0, 2.0]);
    near(place(20).direction_to_scene(Vec3::X).as_dvec3(), [0.5f64.sqrt(), 0.5f64.sqrt(), 0.0]);
    // The instance's own scale is that of frame 0.
    assert_eq!([0, 10, 20, 30].map(|frame| place(frame).scale), [1.0, 2.0, 3.0, 4.0]);
    refused(
        "[[instance]]\nmodel = 'a'\nscale = 1\n[[instance.key]]\nframe = 0\nscale = 2",
        [6, 9],
        "`scale` of frame 0",
    );
    refused(
        "[[instance]]\nmodel = 'a'\n[[instance.key]]\nframe = 5\n[[instance.key]]\nframe = 5",
        [6, 9],
        "ascending",
    );
}

#[test]
fn scattered_models_keep_their_distance() {
    let octrees = [corner()];
    let text = |more: &str| {
        format!(
            "[[scatter]]\nmodel = ['a']\ncount = 500\narea = [-3, 1, 5, 9]\nheight = 2\nscale = [0.5, 2]\n\
             distance = 0.2\n{more}"
        )
    };
    let shot = shot(&octrees, &text(""), 0);
    assert_eq!(shot, self::shot(&octrees, &text(""), 0));
    assert_ne!(shot, self::shot(&octrees, &text("seed = 1"), 0));
    assert_eq!(shot.scene.models.len(), 1);
    let base = DVec3::new(0.9375, 0.875, 0.9375);
    let instances = &shot.scene.instances;
    let places: Vec<DVec3> = instances.iter().map(|instance| instance.placement.to_scene(base)).collect();
    assert_eq!(places.len(), 500);
    for (number, place) in places.iter().enumerate() {
        assert!((-3.0..=5.0).contains(&place.x) && (1.0..=9.0).contains(&place.z), "{place}");
        assert!((place.y - 2.0).abs() < 1e-9);
        assert!(places[..number].iter().all(|other| other.distance(*place) > 0.2 - 1e-9));
    }
    let in_quarter = |x: f64, z: f64| places.iter().filter(|place| place.x < x && place.z < z).count();
    assert!((90..160).contains(&in_quarter(1.0, 5.0)) && (200..300).contains(&in_quarter(5.0, 5.0)));
    let scales = || instances.iter().map(|instance| instance.placement.scale);
    assert!(scales().all(|scale| (0.5..=2.0).contains(&scale)));
    assert!(scales().any(|scale| scale < 0.6) && scales().any(|scale| scale > 1.9));
    assert!(instances.iter().any(|instance| instance.placement.direction_to_scene(Vec3::X).x < -0.9));
    let straight = self::shot(&octrees, &text("turn = false"), 0);
    assert!(
        straight.scene.instances.iter().all(|instance| instance.placement.rotation == glam::DQuat::IDENTITY)
    );
}

#[test]
fn many_are_scattered_quickly_or_not_at_all() {
    let start = std::time::Instant::now();
    // Darts alone fill about half of the area with disks; this is 0.4 of it.
    let file = file("[[scatter]]\nmodel = 'a'\ncount = 10_000\narea = [0, 0, 1, 1]\ndistance = 0.00714");
    assert_eq!(file.actors.len(), 10_000);
    refused(
        "[[scatter]]\nmodel = 'a'\ncount = 10_000\narea = [0, 0, 1, 1]\ndistance = 0.011",
        [3, 9],
        "of 10000 found a place at a distance of 0.011",
    );
    // Long and thin, and far apart: the grid stays small.
    self::file("[[scatter]]\nmodel = 'a'\ncount = 20\narea = [0, 0, 1e9, 1e-9]\ndistance = 1");
    assert!(start.elapsed().as_secs_f64() < 3.0, "{:?}", start.elapsed());
    refused("[[scatter]]\nmodel = 'a'\ncount = 1\narea = [0, 0, 0, 1]", [4, 8], "area is empty");
    refused("[[scatter]]\nmodel = 'a'\ncount = 1\narea = [0, 0, 1, 1]\nscale = [2, 1]", [5, 9], "more than");
    refused("[[scatter]]\nmodel = ['a', 'b']\ncount = 1\narea = [0, 0, 1, 1]", [2, 9], "no model `b`");
    refused("[[scatter]]\nmodel = []\ncount = 1\narea = [0, 0, 1, 1]", [2, 9], "empty");
    refused("[[scatter]]\nmodel = 'a'\ncount = 0\narea = [0, 0, 1, 1]", [3, 9], "found 0, expected 1 to");
}

#[test]
fn cameras_move_on_smooth_curves() {
    let octrees = [corner()];
    let text = "[camera]\ntarget = [0, 0, 0]\nup = [0, 2, 0]\nfov = 20\naperture = 0.5\nfocus = 3\n\
                [[camera.key]]\nframe = 0\neye = [0, 0, 10]\n[[camera.key]]\nframe = 10\neye = [2, 0, 10]\nfov = 40\n\
                [[camera.key]]\nframe = 20\neye = [4, 4, 10]\n[[camera.key]]\nframe = 30\neye = [6, 4, 10]";
    assert_eq!(file(text).frames(), 31);
    let camera = |frame| shot(&octrees, text, frame).camera;
    near(camera(10).eye, [2.0, 0.0, 10.0]);
    // Halfway: the mean of both keys, and an eighth of the difference of the speeds, which are alike here.
    near(camera(15).eye, [3.0, 2.0, 10.0]);
    // Half of the way up, speed 0 at the first key and 2 for each key at the second.
    near(camera(5).eye, [1.0, -0.25, 10.0]);
    assert_eq!([0, 5, 10, 99].map(|frame| camera(frame).vertical_fov), [20.0, 30.0, 40.0, 40.0]);
    near(camera(3).up, [0.0, 1.0, 0.0]);
    let lens = shot(&octrees, text, 0).lens;
    assert_eq!(lens, Lens { projection: Projection::Perspective, aperture: 0.5, focus: Some(3.0) });
}

#[test]
fn a_turntable_closes() {
    let octrees = [corner()];
    let text = "[camera]\neye = [3, 1, 0]\ntarget = [1, 0, 0]\n[camera.turntable]\nframes = 8";
    assert_eq!(file(text).frames(), 8);
    let eye = |frame| shot(&octrees, text, frame).camera.eye;
    near(eye(0), [3.0, 1.0, 0.0]);
    near(eye(2), [1.0, 1.0, -2.0]);
    near(eye(8), [3.0, 1.0, 0.0]);
    let half = format!("{text}\nangle = -180\naxis = [1, 0, 0]");
    near(shot(&octrees, &half, 4).camera.eye, [3.0, 0.0, -1.0]);
    near(shot(&octrees, &half, 4).camera.up, [0.0, 0.0, -1.0]);
    // Round the middle of what is seen, all of which stays in the picture.
    let round = "[[instance]]\nmodel = 'a'\nscale = 8\nposition = [1, 2, 3]\nturn = [0, 30, 0]\n\
                 [camera.turntable]\nframes = 12";
    for frame in 0..12 {
        let shot = shot(&octrees, round, frame);
        assert!((0.7..0.91).contains(&filled(&shot)), "{frame}: {}", filled(&shot));
    }
}

/// The share of half the picture's width or height that the corners of the models' boxes reach, for a width of 1.5 heights.
fn filled(shot: &Shot) -> f64 {
    let Camera { eye, target, up, vertical_fov } = shot.camera;
    let forward = (target - eye).normalize();
    let right = forward.cross(up).normalize();
    let above = right.cross(forward);
    let mut most: f64 = 0.0;
    for instance in &shot.scene.instances {
        let own = shot.scene.models[instance.model].octree.unit_bounds().map(DVec3::from_array);
        for corner in 0..8 {
            let upper = glam::BVec3::new(corner & 1 != 0, corner & 2 != 0, corner & 4 != 0);
            let offset = instance.placement.to_scene(DVec3::select(upper, own[1], own[0])) - eye;
            let half = match shot.lens.projection {
                Projection::Perspective => (vertical_fov / 2.0).to_radians().tan() * offset.dot(forward),
                Projection::Orthographic { height } => height / 2.0,
            };
            most = most.max(offset.dot(right).abs() / half / 1.5).max(offset.dot(above).abs() / half);
        }
    }
    most
}

#[test]
fn all_models_are_in_the_picture() {
    let octrees = [corner()];
    let instance = |x: f64| format!("[[instance]]\nmodel = 'a'\nposition = [{x}, 3, 0]\nanchor = 'base'\n");
    for many in [instance(-70.0), [-5.0, 0.5, 9.0].map(instance).concat()] {
        let perspective = filled(&shot(&octrees, &many, 0));
        assert!((0.85..0.91).contains(&perspective), "{perspective}");
        let text = format!("{many}[camera]\nprojection = 'orthographic'");
        let orthographic = filled(&shot(&octrees, &text, 0));
        assert!((0.89..0.91).contains(&orthographic), "{orthographic}");
    }
    let lens = shot(&octrees, "[camera]\nprojection = 'orthographic'\nheight = 3", 0).lens;
    assert_eq!(lens.projection, Projection::Orthographic { height: 3.0 });
    // One that moves does not move the camera.
    let moving = format!("{}[[instance.key]]\nframe = 9\nposition = [50, 9, 0]", instance(0.0));
    assert_eq!(shot(&octrees, &moving, 0).camera, shot(&octrees, &moving, 9).camera);
    assert!(filled(&shot(&octrees, &moving, 0)) < 0.91 && filled(&shot(&octrees, &moving, 9)) < 0.91);
}

#[test]
fn cameras_that_see_nothing_are_refused() {
    refused("[camera]\neye = [1, 1, 1]\ntarget = [1, 1, 1]", [1, 1], "cannot look at");
    refused("[camera]\neye = [0, 1, 0]\ntarget = [0, 0, 0]", [1, 1], "line of sight");
    refused("[camera]\nup = [0, 0, 0]", [2, 6], "not zero");
    refused("[camera]\nfov = 180", [2, 7], "0.001 to 179");
    refused("[camera]\nheight = 1", [2, 10], "orthographic");
    refused("[camera]\naperture = -1", [2, 12], "found -1");
    refused("[camera]\nfocus = 0", [2, 9], "above zero");
    refused("[camera]\nprojection = 'fish'", [2, 14], "`perspective` or `orthographic`");
    refused("[camera.turntable]\nframes = 0", [2, 10], "found 0");
}

#[test]
fn lamps_are_as_given() {
    let octrees = [corner()];
    let light = |text: &str| {
        let shot = shot(&octrees, &format!("[[light]]\n{text}"), 0);
        assert!(!shot.studio);
        shot.scene.lights[0]
    };
    let sun =
        light("kind = 'directional'\ntowards = [0, 2, 0]\nangle = 2\nintensity = 3\ncolor = [1, 0.5, 0]");
    assert_eq!(sun.source, Source::Directional { towards: Vec3::Y, radius: 1f32.to_radians() });
    assert_eq!((sun.color, sun.shadow), (Vec3::new(3.0, 1.5, 0.0), true));
    let sun = light("kind = 'directional'\ndirection = [0, 0, 5]\nshadow = false");
    assert_eq!(sun, Light::directional(-Vec3::Z, Vec3::ONE));
    let point = light("kind = 'point'\nposition = [1, 2, 3]\nradius = 0.5\ncolor = '#ff0000'");
    assert_eq!(point.source, Source::Point { position: Vec3::new(1.0, 2.0, 3.0), radius: 0.5 });
    assert_eq!(point.color, Vec3::X);
    let spot = light("kind = 'spot'\nposition = [0, 3, 0]\ntarget = [0, 0, 0]\ncone = [0, 60]");
    let Source::Spot { towards, cone, radius, .. } = spot.source else { panic!("{spot:?}") };
    assert_eq!((towards, radius), (-Vec3::Y, 0.0));
    assert!((cone[0] - 1.0).abs() < 1e-6 && (cone[1] - 0.5).abs() < 1e-6);
    let sharp = light("kind = 'spot'\nposition = [0, 3, 0]\ndirection = [1, 0, 0]\ncone = [0, 0]");
    let Source::Spot { cone, .. } = sharp.source else { panic!("{sharp:?}") };
    assert!(cone[0] > cone[1]);
    let area = light("kind = 'area'\nposition = [0, 3, 0]\nright = [1, 0, 0]\nup = [0, 0, 2]");
    let expected = Source::Area { position: Vec3::Y * 3.0, right: Vec3::X, up: Vec3::Z * 2.0 };
    assert_eq!(area.source, expected);
}

#[test]
fn lamps_that_cannot_be_are_refused() {
    let area = "[[light]]\nkind = 'area'\nposition = [0, 3, 0]\n";
    refused(&format!("{area}right = [1, 2, 0]\nup = [2, 4, 0]"), [5, 6], "no area");
    refused(&format!("{area}right = [0, 0, 0]\nup = [2, 4, 0]"), [5, 6], "no area");
    refused(&format!("{area}right = [1e-12, 0, 0]\nup = [0, 1e-12, 0]"), [5, 6], "no area");
    refused(area, [2, 8], "an area light needs `right`");
    refused("[[light]]\nkind = 'point'", [2, 8], "a point light needs `position`");
    refused("[[light]]\nkind = 'directional'", [2, 8], "needs `towards`");
    refused(
        "[[light]]\nkind = 'point'\nposition = [0, 0, 0]\ncone = [1, 2]",
        [4, 8],
        "it has position, radius",
    );
    refused("[[light]]\nkind = 'lamp'", [2, 8], "`directional`, `point`, `spot`, `area`");
    refused("[[light]]\nkind = 'point'\nposition = [nan, 0, 0]", [3, 12], "found NaN");
    refused("[[light]]\nkind = 'point'\nposition = [0, 0, inf]", [3, 12], "found inf");
    refused("[[light]]\nkind = 'point'\nposition = [0, 0, 0]\nradius = -1", [4, 10], "found -1");
    refused("[[light]]\nkind = 'point'\nintensity = -2", [3, 13], "found -2");
    refused("[[light]]\nkind = 'point'\nintensity = inf", [3, 13], "found inf");
    refused("[[light]]\nkind = 'point'\ncolor = [1, -1, 0]", [3, 9], "found -1");
    refused("[[light]]\nkind = 'point'\ncolor = [1, 1]", [3, 9], "length 2");
    refused("[[light]]\nkind = 'point'\ncolor = [1, 1, 1, 1]", [3, 9], "length 4");
    refused("[[light]]\nkind = 'point'\ncolor = '#12345g'", [3, 9], "such as \"#ff8800\"");
    refused("[[light]]\nkind = 'directional'\ntowards = [0, 0, 0]", [3, 11], "not zero");
    refused("[[light]]\nkind = 'directional'\nangle = 180", [3, 9], "less than 180");
    let spot = "[[light]]\nkind = 'spot'\nposition = [1, 1, 1]\n";
    refused(&format!("{spot}target = [1, 1, 1]"), [4, 10], "at its target");
    refused(&format!("{spot}target = [1, 0, 1]\ncone = [30, 20]"), [5, 8], "30 is more than 20");
    refused(&format!("{spot}target = [1, 0, 1]\ncone = [-1, 20]"), [5, 8], "0 to 180");
    refused(&format!("{spot}target = [1, 0, 1]\ndirection = [0, 1, 0]"), [5, 13], "exclude");
}

#[test]
fn light_from_around_and_beyond() {
    let octrees = [corner()];
    let text = "[ambient]\ncolor = 0.5\nintensity = 0.5\nocclusion = 2\nglow = true\n\
                [background]\nbottom = 0.25\ntop = [1, 0, 0]\nintensity = 2";
    let scene = shot(&octrees, text, 0).scene;
    assert_eq!(scene.ambient, Ambient { color: Vec3::splat(0.25), occlusion: Some(2.0), glow: true });
    let expected = Background::Gradient { bottom: Vec3::splat(0.5), top: Vec3::X * 2.0 };
    assert_eq!(scene.background, expected);
    let scene = shot(&octrees, "[background]\ncolor = 0.125", 0).scene;
    assert_eq!(scene.background, Background::uniform(Vec3::splat(0.125)));
    refused("[background]\ncolor = 1\ntop = 1", [3, 7], "exclude");
    refused("[background]\npicture = ''", [2, 11], "empty");
    refused("[background]\npicture = 'none.png'", [2, 11], "scenes/none.png: cannot read");
    refused("[ambient]\nocclusion = 0", [2, 13], "above zero");
}

#[test]
fn pictures_of_the_surroundings_are_amounts_of_light() {
    use crate::scene::Surroundings;
    let folder = tempfile::tempdir().unwrap();
    let png = image::RgbImage::from_fn(2, 2, |x, y| image::Rgb([(x * 128) as u8, (y * 255) as u8, 7]));
    png.save(folder.path().join("sky.png")).unwrap();
    let exr = |name: &str, value: f32| {
        let pixel = move |x: usize, _: usize| (x as f32, value, -1f32);
        exr::prelude::write_rgb_file(folder.path().join(name), 3, 1, pixel).unwrap();
    };
    exr("sky.exr", 1000.0);
    exr("broken.exr", f32::NAN);
    std::fs::write(folder.path().join("no.png"), "no picture").unwrap();
    std::fs::write(folder.path().join("no.exr"), "no picture").unwrap();
    let background = |picture: &str| {
        let text = format!("{MODEL}[background]\npicture = '{picture}'\nintensity = 2");
        SceneFile::parse(&text, &folder.path().join("scene.toml")).map(|file| file.background)
    };
    let light = |x: u8, y: u8| Vec3::new(to_linear(x), to_linear(y), to_linear(7)) * 2.0;
    let expected = Surroundings::new(2, 2, vec![light(0, 0), light(128, 0), light(0, 255), light(128, 255)]);
    assert_eq!(background("sky.png").unwrap(), Background::Surroundings(expected.unwrap()));
    let expected = Surroundings::new(3, 1, (0..3).map(|x| Vec3::new(x as f32, 1000.0, 0.0) * 2.0).collect());
    assert_eq!(background("sky.exr").unwrap(), Background::Surroundings(expected.unwrap()));
    let error = |picture: &str| background(picture).unwrap_err().to_string();
    assert!(error("broken.exr").contains("column 0, row 0"), "{}", error("broken.exr"));
    for broken in ["no.png", "no.exr"] {
        assert!(error(broken).contains(":5:11: ") && error(broken).contains("give a"), "{}", error(broken));
    }
}

#[test]
fn the_ground_is_below_it_all() {
    let octrees = [corner()];
    let ground = |text: &str| shot(&octrees, text, 0).scene.ground.unwrap();
    assert_eq!(ground("[ground]").height, 0.875);
    let instance = "[[instance]]\nmodel = 'a'\nanchor = 'center'\nscale = 8\n";
    assert_eq!(ground(&format!("{instance}[ground]")).height, -0.5);
    // A cube on its edge.
    let edge = ground(&format!("{instance}turn = [0, 0, 45]\n[ground]")).height;
    assert!((edge + 0.5f64.sqrt()).abs() < 1e-9, "{edge}");
    let keys = "[[instance.key]]\nframe = 3\nposition = [0, 1, 0]\n[[instance.key]]\nframe = 5\nposition = [0, -2, 0]\n";
    assert_eq!(ground(&format!("{instance}{keys}[ground]")).height, -2.5);
    let text = "[ground]\nheight = -3\nchecker = [0.5, '#ffffff']\nsquare = 2\nreflectivity = 0.1\n\
                specular = 0.2\nshininess = 30";
    let found = ground(text);
    assert_eq!((found.height, found.square), (-3.0, 2.0));
    assert_eq!(found.surfaces.map(|surface| surface.diffuse), [Vec3::splat(0.5), Vec3::ONE]);
    for surface in found.surfaces {
        assert_eq!((surface.reflectivity, surface.specular), (Vec3::splat(0.1), Vec3::splat(0.2)));
        assert_eq!(surface.shininess, 30.0);
    }
    assert_eq!(
        ground("[ground]\ncolor = 0.25").surfaces.map(|surface| surface.diffuse),
        [Vec3::splat(0.25); 2]
    );
    refused("[ground]\ncolor = 0.5\nchecker = [0, 1]", [3, 11], "exclude");
    refused("[ground]\nsquare = 1", [2, 10], "one colour");
    refused("[ground]\nchecker = [0, 1]\nsquare = 0", [3, 10], "above zero");
}

#[test]
fn pictures_and_their_quality() {
    let found = file(
        "[picture]\nsize = [640, 480]\nexposure = 2\ntone = 'clip'\n\
         [quality]\nsamples = 4\nmost_samples = 16\ncontrast = 0.5\nfilter = 'tent'\nlod_pixels = 3\n\
         light_samples = 5\nambient_samples = 6\nbounces = 0\ncutoff = 0\nleave = 'raised'\nsmooth_pixels = 7\n\
         arithmetic = 'double'",
    );
    assert_eq!(found.size(), Some([640, 480]));
    assert_eq!(found.tone(), Tone { exposure: 2.0, mapping: ToneMapping::Clip });
    let expected = Quality {
        lod_pixels: 3.0,
        samples: 4,
        most_samples: 16,
        contrast: 0.5,
        filter: Filter::Tent,
        light_samples: 5,
        ambient_samples: 6,
        bounces: 0,
        cutoff: 0.0,
        leave: Leave::Raised,
        smooth_pixels: 7.0,
        arithmetic: Arithmetic::Double,
    };
    assert_eq!(found.quality(), expected);
    assert_eq!(file("[quality]\nsamples = 9").quality(), Quality::of_samples(9));
    assert_eq!(file("[quality]\nsmooth_pixels = inf").quality(), Quality::default());
    refused("[quality]\nsmooth_pixels = nan", [2, 17], "found NaN");
    refused("[quality]\nsamples = 0", [2, 11], "found 0");
    refused("[quality]\nsamples = 4\nmost_samples = 2", [3, 16], "less than");
    refused("[quality]\nfilter = 'sinc'", [2, 10], "box, tent, gaussian");
    refused("[quality]\nleave = 'no'", [2, 9], "surface, voxel, raised");
    refused("[quality]\narithmetic = 'half'", [2, 14], "single, double");
    refused("[picture]\nsize = [0, 1]", [2, 8], "above zero");
    refused("[picture]\nsize = [100000, 100000]", [2, 8], "pixels");
    refused("[picture]\nexposure = 0", [2, 12], "above zero");
    refused("[picture]\ntone = 'loud'", [2, 8], "clip");
}

#[test]
fn models_that_cannot_be_are_refused() {
    let message = |text: &str| parse(text).unwrap_err().to_string();
    assert!(message("").starts_with("scenes/test.toml:1:1: there is nothing to see"), "{}", message(""));
    refused("[[model]]\nname = 'b'", [1, 1], "missing field `file`");
    refused("[[model]]\nfile = 'b.vox'", [1, 1], "missing field `name`");
    refused("[[model]]\nname = 'b'\nfile = ''", [3, 8], "`file` is empty");
    refused("[[model]]\nname = ''\nfile = 'b'", [2, 8], "`name` is empty");
    refused("[[model]]\nname = 'a'\nfile = 'b'", [2, 8], "already a model `a`");
    refused("[[model]]\nname = 'b'\nfile = 'b.VOX'\nresolution = 64", [4, 14], "meshes");
    refused("[[model]]\nname = 'b'\nfile = 'b.obj'\nresolution = 100", [4, 14], "power of two");
    refused("[[instance]]\nmodel = 'z'", [2, 9], "no model `z`; the file has `a`");
    refused("[[instance]]\nposition = [0, 0, 0]", [1, 1], "missing field `model`");
    refused("[[instance]]\nmodel = 'a'\nscale = 0", [3, 9], "found 0, expected a number above zero");
    refused("[[instance]]\nmodel = 'a'\nscale = 1e-320", [3, 9], "above zero");
    refused("[[instance]]\nmodel = 'a'\nscale = nan", [3, 9], "found NaN");
    refused("[[instance]]\nmodel = 'a'\nposition = [0, 1e300, 0]", [3, 12], "found 1e300");
    refused("[[instance]]\nmodel = 'a'\nposition = [0, 1]", [3, 12], "length");
    refused("[[instance]]\nmodel = 'a'\nscale = 'one'", [3, 9], "expected f64");
    refused("[[instance]\n", [1, 12], "");
}

#[test]
fn a_file_that_is_not_there_is_named() {
    let error = SceneFile::open("no/scene.toml".as_ref()).unwrap_err().to_string();
    assert!(error.starts_with("no/scene.toml: cannot read: "), "{error}");
}

#[test]
fn what_is_absorbed_depends_on_the_size() {
    let material =
        octvox_format::Material { absorption: [8.0, 4.0, 2.0], ..octvox_format::Material::matte([9; 3]) };
    let mut octree = corner();
    octree.materials = octvox_format::MaterialPalette::new(vec![material]).unwrap();
    let octrees = [octree];
    let two = "[[instance]]\nmodel = 'a'\nscale = 2\n";
    let text = format!("{two}{two}[[instance]]\nmodel = 'a'\n[[instance.key]]\nframe = 4\nscale = 4");
    let scene = shot(&octrees, &text, 0).scene;
    assert_eq!(scene.instances.iter().map(|instance| instance.model).collect::<Vec<_>>(), [0, 0, 1]);
    let reference = |scale: f64| Model::scaled(&octrees[0], scale);
    assert_eq!(scene.models, [reference(2.0), reference(4.0)]);
    let scattered = "[[scatter]]\nmodel = 'a'\ncount = 9\narea = [0, 0, 1, 1]\nscale = [1, 3]";
    assert_eq!(shot(&octrees, scattered, 0).scene.models, [reference(2.0)]);
    let all = "[[model.material]]\nabsorption = 5\n[[instance]]\nmodel = 'a'\nscale = 2";
    assert_eq!(shot(&octrees, all, 0).scene.models[0].surfaces[0].absorption, Vec3::splat(5.0));
}
