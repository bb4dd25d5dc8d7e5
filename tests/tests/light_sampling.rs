//! Rays where they are needed: as many as anywhere else, a picture is nearer to the truth.

use octvox_raytracer::scene::Scene;
use octvox_raytracer::{Camera, DEFAULT_FOV, FirstHit, Lens, Quality, RenderOptions, render_scene};
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

/// First hits are those of rays through the middles of pixels, whichever rays the picture is made of; and the picture does not
/// depend on whether they are asked for.
#[test]
fn first_hits_do_not_depend_on_samples() {
    let model = Model::of_depth(&torus(0.15, 48, 24).mesh(), 6);
    let camera = Camera::framing(&model.octree, 1.0, DEFAULT_FOV);
    let scene = Scene::of_model(&model.octree, &camera);
    let rendered = |lens: &Lens, samples: u32, most_samples: u32, first_hits: bool| {
        let quality = Quality { lod_pixels: 0.0, most_samples, ..Quality::of_samples(samples) };
        let options = RenderOptions { size: [70, 70], quality, first_hits, ..RenderOptions::default() };
        render_scene(&scene, &camera, lens, &options, |_| {}).unwrap()
    };
    let pinhole = Lens::default();
    let (alone, few) = rendered(&pinhole, 1, 1, true);
    let expected = alone.first_hits.unwrap();
    assert!(expected.iter().any(|hit| hit.distance.is_finite()));
    let open = Lens { aperture: 0.1, ..Lens::default() };
    for (lens, samples, most_samples) in [
        (&pinhole, 1, 16),
        (&pinhole, 4, 4),
        (&pinhole, 3, 8),
        (&pinhole, 2, 8),
        (&open, 1, 1),
        (&open, 2, 4),
    ] {
        let (frame, report) = rendered(lens, samples, most_samples, true);
        assert!(report.rays.primary > few.rays.primary);
        let hits = frame.first_hits.unwrap();
        let is_same = |(hit, expected): (&FirstHit, &FirstHit)| {
            // Cells are not counted through an opening, and rays are rounded in another way.
            let apart = (hit.distance - expected.distance).abs();
            hit.normal == expected.normal && (hit.distance == expected.distance || apart < 1e-5)
        };
        let others = hits.iter().zip(&expected).filter(|pair| !is_same(*pair)).count();
        let rounded = if lens.is_pinhole() { 0 } else { 4 };
        assert!(others <= rounded, "{others} hits of {samples} to {most_samples} rays");
        let (without, _) = rendered(lens, samples, most_samples, false);
        assert!(without.pixels == frame.pixels && without.hit_pixels == frame.hit_pixels);
    }
}
