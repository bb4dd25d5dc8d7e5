//! What a scene does not need costs no ray, and no scene is too odd for a picture.

use glam::{DVec3, Vec3};
use octvox_raytracer::scene::{
    Ambient, Background, Ground, Instance, Light, Model, Scene, Similarity, Source, SurfaceMaterial,
};
use octvox_raytracer::{
    Camera, CameraError, Lens, Plan, Projection, Quality, RayCounts, RenderOptions, Width, render_scene,
};
use octvox_tests::stage::{alone, exact, floor, from_above, glass, glowing, mirror, render_with, voxels};
use octvox_tests::tree::Tree;

const SIZE: [u32; 2] = [64, 64];
const PIXELS: u64 = 64 * 64;
const WHITE: fn() -> SurfaceMaterial = || SurfaceMaterial::matte(Vec3::ONE);
const BACKGROUND: Vec3 = Vec3::new(0.25, 0.5, 0.75);

fn lamp(source: Source, shadow: bool) -> Light {
    Light { source, color: Vec3::ONE, shadow }
}

fn sun(shadow: bool) -> Light {
    lamp(Source::Directional { towards: Vec3::new(0.6, 0.8, 0.0), radius: 0.0 }, shadow)
}

fn sent(scene: &Scene<'_>, lens: Lens, quality: Quality) -> (Plan, RayCounts) {
    let options = RenderOptions { size: SIZE, quality, ..RenderOptions::default() };
    let report = render_with(scene, &(from_above().0, lens), &options).1;
    (report.plan, report.rays)
}

/// Rays of each kind, and the names of effects, for a scene and one more effect at a time.
#[test]
fn rays_are_sent_for_what_is_needed_alone() {
    let octree = floor(4);
    let orthographic = from_above().1;
    // Light from around and something behind, so that rays of any kind would find something.
    let scene = |surface| Scene {
        ambient: Ambient { color: Vec3::ONE, occlusion: None, glow: false },
        background: Background::uniform(Vec3::ONE),
        ..alone(&octree, &[surface])
    };
    let only = RayCounts { primary: PIXELS, ..RayCounts::default() };
    let kinds =
        |rays: RayCounts| [rays.shadow, rays.reflection, rays.refraction, rays.ambient].map(|rays| rays > 0);
    let check = |name: &str, scene: &Scene<'_>, quality, expected: [bool; 4], names: &[&str]| {
        let (plan, rays) = sent(scene, orthographic, quality);
        assert_eq!(kinds(rays), expected, "{name}: {rays:?}");
        assert_eq!(plan.names()[1..], *names, "{name}");
    };
    const NONE: [bool; 4] = [false; 4];

    assert_eq!(sent(&scene(WHITE()), orthographic, exact()), (Plan::default(), only));
    let unshadowed = Scene { lights: vec![sun(false)], ..scene(WHITE()) };
    assert_eq!(sent(&unshadowed, orthographic, exact()).1, only);
    check("no shadows", &unshadowed, exact(), NONE, &[]);
    let shadowed = Scene { lights: vec![sun(true), sun(false)], ..scene(WHITE()) };
    check("shadows", &shadowed, exact(), [true, false, false, false], &["shadows"]);
    assert_eq!(sent(&shadowed, orthographic, exact()).1.shadow, PIXELS, "one ray to one of two lamps");
    let source = Source::Point { position: Vec3::ONE, radius: 0.1 };
    let soft = Scene { lights: vec![lamp(source, true)], ..scene(WHITE()) };
    let quality = Quality { light_samples: 5, ..exact() };
    check("soft shadows", &soft, quality, [true, false, false, false], &["shadows", "soft shadows"]);
    assert_eq!(sent(&soft, orthographic, quality).1.shadow, 5 * PIXELS);
    let hidden = Scene { lights: vec![lamp(source, false)], ..scene(WHITE()) };
    check("an extent without shadows", &hidden, quality, NONE, &[]);

    let mirrors = [false, true, false, false];
    check("a mirror", &scene(mirror(0.5)), exact(), mirrors, &["reflection"]);
    check("no bounces", &scene(mirror(0.5)), Quality { bounces: 0, ..exact() }, NONE, &[]);
    check("thin air", &scene(glass(1.0)), exact(), [false, false, true, false], &["refraction"]);
    check("glass", &scene(glass(1.5)), exact(), [false, true, true, false], &["reflection", "refraction"]);
    let ground = |surface| Some(Ground { height: -1.0, surfaces: [WHITE(), surface], square: 0.3 });
    let above = Scene { ground: ground(mirror(0.5)), instances: Vec::new(), ..scene(WHITE()) };
    check("a ground that mirrors", &above, exact(), mirrors, &["reflection"]);

    let glow =
        |glow, surface| Scene { ambient: Ambient { glow, ..scene(WHITE()).ambient }, ..scene(surface) };
    let around = [false, false, false, true];
    let mut occluded = scene(WHITE());
    occluded.ambient.occlusion = Some(0.1);
    let quality = Quality { ambient_samples: 3, ..exact() };
    check("occlusion", &occluded, quality, around, &["ambient occlusion"]);
    assert_eq!(sent(&occluded, orthographic, quality).1.ambient, 3 * PIXELS);
    let shining = SurfaceMaterial { emission: Vec3::ONE, ..WHITE() };
    check("glow", &glow(true, shining), quality, around, &["emission", "glow"]);
    check("shining alone", &glow(false, shining), quality, NONE, &["emission"]);
    check("glow of nothing", &glow(true, WHITE()), quality, NONE, &[]);
}

#[test]
fn rays_from_the_eye_are_counted() {
    let octree = floor(4);
    let scene = alone(&octree, &[glowing(0.5)]);
    let pinhole = Lens::default();
    let quality = Quality { samples: 3, most_samples: 3, ..exact() };
    let (plan, rays) = sent(&scene, pinhole, quality);
    assert_eq!((plan.depth_of_field, plan.adaptive_sampling, rays.total()), (false, false, 3 * PIXELS));
    let wide = Lens { aperture: 0.1, ..pinhole };
    let (plan, rays) = sent(&scene, wide, quality);
    assert_eq!((plan.depth_of_field, rays.total()), (true, 3 * PIXELS));
    // At the edge of the floor pixels differ, elsewhere they do not.
    let (plan, rays) = sent(&scene, pinhole, Quality { most_samples: 11, ..quality });
    assert!(plan.adaptive_sampling && rays.total() > 3 * PIXELS && rays.total() < 6 * PIXELS, "{rays:?}");
    let even = Scene { background: Background::uniform(Vec3::splat(0.5)), ..scene };
    assert_eq!(sent(&even, pinhole, Quality { most_samples: 11, ..quality }).1.total(), 3 * PIXELS);
}

#[test]
fn materials_that_nothing_is_made_of_do_not_count() {
    let octree = floor(4);
    let odd = SurfaceMaterial { transparency: 0.5, emission: Vec3::ONE, ..mirror(0.5) };
    let mut scene = alone(&octree, &[WHITE(), odd, odd]);
    scene.ambient.glow = true;
    // Nor those of a model that does not stand in the scene.
    scene.models.push(Model { octree: &octree, surfaces: vec![odd; 3] });
    assert_eq!(sent(&scene, from_above().1, exact()).0, Plan::default());
    scene.instances[0].model = 1;
    assert_eq!(
        sent(&scene, from_above().1, exact()).0.names()[1..],
        ["reflection", "refraction", "emission", "glow"]
    );
}

/// The picture of a scene, the same for all widths, all of it finite.
fn picture(scene: &Scene<'_>, camera: &Camera, lens: Lens) -> (Vec<Vec3>, u64) {
    let mut first = None;
    for width in Width::ALL {
        for quality in [Quality { samples: 2, most_samples: 5, ..exact() }, exact()] {
            let options =
                RenderOptions { size: SIZE, width, quality, first_hits: true, ..RenderOptions::default() };
            let (frame, _) = render_with(scene, &(*camera, lens), &options);
            let light = frame.light.clone().unwrap();
            assert!(light.iter().all(|light| light.is_finite()), "{width:?}");
            assert_eq!(light.len() as u64, PIXELS);
            if quality.samples == 1 {
                let first = first.get_or_insert_with(|| frame.clone());
                assert!(frame == *first, "{width:?}");
            }
        }
    }
    let frame = first.unwrap();
    (frame.light.unwrap(), frame.hit_pixels)
}

/// Every effect, for scenes that are odd in another way.
fn with_everything<'a>(scene: Scene<'a>) -> Scene<'a> {
    let position = Vec3::new(0.4, 0.6, 0.5);
    Scene {
        lights: vec![sun(true), lamp(Source::Point { position, radius: 0.1 }, true)],
        ambient: Ambient { color: Vec3::ONE, occlusion: Some(0.2), glow: true },
        background: Background::uniform(BACKGROUND),
        ..scene
    }
}

#[test]
fn the_eye_may_be_in_a_voxel() {
    let full = voxels(2, |_| Some((1, DVec3::Y)));
    let camera = Camera { eye: DVec3::splat(0.4), target: DVec3::ZERO, up: DVec3::Y, vertical_fov: 60.0 };
    for surface in [WHITE(), mirror(0.5), glass(1.5), glowing(1.0)] {
        let scene = with_everything(alone(&full, &[surface]));
        let mut two = scene.clone();
        let far = Similarity { translation: DVec3::splat(9.0), ..Similarity::IDENTITY };
        two.instances.push(Instance { model: 0, placement: far });
        for scene in [scene, two] {
            let narrow = Projection::Orthographic { height: 0.1 };
            for lens in [
                Lens::default(),
                Lens { aperture: 0.01, ..Lens::default() },
                Lens { projection: narrow, ..Lens::default() },
            ] {
                assert_eq!(
                    picture(&scene, &camera, lens).1,
                    PIXELS,
                    "{lens:?}: the voxel is all that is seen"
                );
            }
        }
    }
    // What shines by itself and does nothing else is seen as it is.
    let found = picture(&alone(&full, &[glowing(0.7)]), &camera, Lens::default()).0;
    assert!(found.iter().all(|light| *light == Vec3::splat(0.7)));
}

#[test]
fn nothing_is_a_scene() {
    let (empty, octree) = (Tree::empty().octree(), floor(3));
    let (camera, _) = from_above();
    let nothing = Scene { instances: Vec::new(), ..with_everything(alone(&octree, &[WHITE()])) };
    let no_models = Scene { models: Vec::new(), ..nothing.clone() };
    let one = with_everything(alone(&empty, &[mirror(1.0)]));
    let two = Scene { instances: vec![one.instances[0]; 2], ..one.clone() };
    for scene in [nothing.clone(), no_models, one, two] {
        for lens in [Lens::default(), from_above().1] {
            let (light, hits) = picture(&scene, &camera, lens);
            assert_eq!(hits, 0);
            assert!(light.iter().all(|light| *light == BACKGROUND));
        }
        // There is a ground nevertheless.
        let ground = Ground { height: 0.0, surfaces: [mirror(0.2), WHITE()], square: 0.1 };
        let scene = Scene { ground: Some(ground), ..scene };
        assert_eq!(picture(&scene, &camera, Lens::default()).1, PIXELS);
    }
}

/// A lamp on a surface lights it from straight aside, and divides by no distance.
#[test]
fn a_lamp_may_be_on_a_surface() {
    let octree = floor(6);
    let (camera, lens) = from_above();
    // The middle of a pixel, on the upper face of its voxel.
    let position = Vec3::new(20.5 / 64.0, 1.0 / 64.0, 30.5 / 64.0);
    let directions = [Vec3::NEG_Y, Vec3::Y, Vec3::X];
    let spots = directions.map(|towards| Source::Spot { position, radius: 0.0, towards, cone: [0.9, 0.8] });
    let area = Source::Area { position, right: Vec3::X, up: Vec3::Z };
    let degenerate = Source::Area { position, right: Vec3::X, up: Vec3::X };
    let balls = [0.0, 0.01].map(|radius| Source::Point { position, radius });
    for source in spots.into_iter().chain(balls).chain([area, degenerate]) {
        for surface in [WHITE(), mirror(0.5), glass(1.5)] {
            let scene = Scene { lights: vec![lamp(source, true)], ..alone(&octree, &[surface]) };
            let (light, _) = picture(&scene, &camera, lens);
            assert!(light.iter().all(|light| light.min_element() >= 0.0), "{source:?}");
        }
    }
    let flat = Source::Point { position, radius: 0.0 };
    let scene = Scene { lights: vec![lamp(flat, true)], ..alone(&octree, &[WHITE()]) };
    let (light, _) = picture(&scene, &camera, lens);
    assert!(light.iter().all(|light| *light == Vec3::ZERO), "light along the floor does not light it");
}

#[test]
fn a_camera_that_sees_nothing_is_an_error() {
    let octree = floor(3);
    let scene = with_everything(alone(&octree, &[WHITE()]));
    let (camera, orthographic) = from_above();
    let error = |camera: Camera| {
        [Lens::default(), orthographic].map(|lens| {
            let options = RenderOptions { size: SIZE, ..RenderOptions::default() };
            render_scene(&scene, &camera, &lens, &options, |_| {}).unwrap_err()
        })
    };
    for bad in [f64::NAN, f64::INFINITY] {
        for axis in 0..3 {
            let mut cameras = [camera; 3];
            cameras[0].eye[axis] = bad;
            cameras[1].target[axis] = bad;
            cameras[2].up[axis] = bad;
            for (camera, is_up) in cameras.into_iter().zip([false, false, true]) {
                for error in error(camera) {
                    let is_right = if is_up {
                        matches!(error, CameraError::NoUp { .. })
                    } else {
                        matches!(error, CameraError::NoDirection { .. })
                    };
                    assert!(is_right, "{error}");
                }
            }
        }
        for error in error(Camera { vertical_fov: bad, ..camera }) {
            assert!(matches!(error, CameraError::FieldOfView { .. }), "{error}");
        }
    }
    // A lens is no part of that; one that is not a number shows what is behind everything, and does not go wrong.
    let lens = Lens { projection: Projection::Orthographic { height: f64::NAN }, ..Lens::default() };
    assert!(picture(&scene, &camera, lens).0.iter().all(|light| *light == BACKGROUND));
}
