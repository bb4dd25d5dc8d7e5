//! Rays where they are needed: as many as anywhere else, a picture is nearer to the truth.

use octvox_raytracer::scene::Scene;
use octvox_raytracer::{Camera, DEFAULT_FOV, Lens, Quality, RenderOptions, render_scene};
use octvox_tests::meshes::torus;
use octvox_tests::models::Model;

const SIZE: [u32; 2] = [160, 120];

/// The displayed values of a picture, and the rays that it took.
fn picture(model: &Model, samples: u32, most_samples: u32) -> (Vec<[u8; 4]>, u64) {
    let camera = Camera::framing(&model.octree, f64::from(SIZE[0]) / f64::from(SIZE[1]), DEFAULT_FOV);
    let scene = Scene::of_model(&model.octree, &camera);
    // The same cells for all of them.
    let quality = Quality { lod_pixels: 0.0, most_samples, ..Quality::of_samples(samples) };
    let options = RenderOptions { size: SIZE, quality, ..RenderOptions::default() };
    let (frame, report) = render_scene(&scene, &camera, &Lens::default(), &options, |_| {}).unwrap();
    (frame.pixels, report.rays.total())
}

/// Root of the mean square of differences, in displayed steps.
fn difference(a: &[[u8; 4]], b: &[[u8; 4]]) -> f64 {
    let squares =
        a.as_flattened().iter().zip(b.as_flattened()).map(|(a, b)| f64::from(a.abs_diff(*b)).powi(2));
    (squares.sum::<f64>() / (3 * a.len()) as f64).sqrt()
}

#[test]
fn half_the_rays_make_a_better_picture_where_they_are_needed() {
    let model = Model::of_depth(&torus(0.15, 96, 48).colored_mesh(), 8);
    let (truth, _) = picture(&model, 256, 256);
    let (uniform, uniform_rays) = picture(&model, 16, 16);
    let (adaptive, adaptive_rays) = picture(&model, 4, 64);
    let [off, adaptively_off] = [&uniform, &adaptive].map(|picture| difference(picture, &truth));
    println!(
        "uniform {uniform_rays} rays, {off:.3} off; adaptive {adaptive_rays} rays, {adaptively_off:.3} off"
    );
    assert!(off > 0.1, "the truth is not told from {off}");
    assert!(adaptively_off < off, "{adaptively_off} steps off, {off} without");
    assert!(adaptive_rays * 3 < uniform_rays * 2, "{adaptive_rays} rays, {uniform_rays} without");
}

/// Where there is nothing to see, a pixel gets no more rays than it must.
#[test]
fn an_even_picture_needs_no_more_rays() {
    let model = Model::of_depth(&torus(0.15, 24, 12).mesh(), 5);
    let camera = Camera {
        eye: [0.5, 9.0, 0.5].into(),
        target: [0.5, 99.0, 0.6].into(),
        ..Camera::framing(&model.octree, 1.0, 30.0)
    };
    let scene = Scene {
        background: octvox_raytracer::scene::Background::uniform(glam::Vec3::splat(0.5)),
        ..Scene::of_model(&model.octree, &camera)
    };
    let quality = Quality { most_samples: 64, ..Quality::of_samples(2) };
    let options = RenderOptions { size: [64, 64], quality, ..RenderOptions::default() };
    let (_, report) = render_scene(&scene, &camera, &Lens::default(), &options, |_| {}).unwrap();
    assert_eq!(report.rays.total(), 2 * 64 * 64);
}

/// What the first ray of each pixel met is kept when some pixels get more rays later.
#[test]
fn more_rays_change_no_first_hit() {
    let model = Model::of_depth(&torus(0.15, 48, 24).mesh(), 6);
    let camera = Camera::framing(&model.octree, 1.0, DEFAULT_FOV);
    let scene = Scene::of_model(&model.octree, &camera);
    let first_hits = |most_samples: u32| {
        let quality = Quality { lod_pixels: 0.0, most_samples, ..Quality::of_samples(1) };
        let options = RenderOptions { size: [70, 70], quality, first_hits: true, ..RenderOptions::default() };
        let (frame, report) = render_scene(&scene, &camera, &Lens::default(), &options, |_| {}).unwrap();
        (frame.first_hits.unwrap(), report.rays.primary)
    };
    let ((alone, few), (adaptive, more)) = (first_hits(1), first_hits(16));
    assert!(more > few, "no pixel got more rays");
    assert!(alone.iter().any(|hit| hit.distance.is_finite()));
    assert_eq!(alone, adaptive);
}
