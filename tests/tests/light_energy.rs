//! Light is neither made nor lost: white furnaces, boxes of mirrors, panes of glass.

use glam::{DVec3, Vec3};
use octvox_raytracer::scene::{Ambient, Background, Scene, SurfaceMaterial};
use octvox_raytracer::{Camera, Lens, Octree, Projection, Quality};
use octvox_tests::meshes::sphere;
use octvox_tests::models::Model;
use octvox_tests::pictures::framing;
use octvox_tests::stage::{alone, exact, glass, glowing, light, mirror, pixel_ray, voxels};

const SIZE: [u32; 2] = [64, 64];

/// Sums of a few products of shares in single precision are off by no more.
const ROUNDING: f32 = 1e-5;

/// The least and the most light of a picture.
fn range(pixels: &[Vec3]) -> [f32; 2] {
    let least = pixels.iter().fold(f32::INFINITY, |least, pixel| least.min(pixel.min_element()));
    [least, pixels.iter().fold(0.0, |most, pixel| pixel.max_element().max(most))]
}

/// A sphere where the same light comes from everywhere: what takes none away cannot be seen.
fn furnace(octree: &Octree, surface: SurfaceMaterial, occlusion: Option<f32>, quality: Quality) -> Vec<Vec3> {
    let scene = Scene {
        ambient: Ambient { color: Vec3::ONE, occlusion, glow: false },
        background: Background::uniform(Vec3::ONE),
        ..alone(octree, &[surface])
    };
    light(&scene, &(framing(octree, SIZE), Lens::default()), SIZE, quality)
}

#[test]
fn a_white_sphere_vanishes_in_a_white_world() {
    let octree = Model::of_depth(&sphere(4).mesh(), 5).octree;
    let white = SurfaceMaterial::matte(Vec3::ONE);
    assert_eq!(range(&furnace(&octree, white, None, exact())), [1.0; 2]);
    // Sixteen rays bring a sixteenth each, without rounding. Nothing on a sphere is in the way of another part of it.
    let quality = Quality { ambient_samples: 16, ..exact() };
    assert_eq!(range(&furnace(&octree, white, Some(f32::INFINITY), quality)), [1.0; 2]);
    assert_eq!(range(&furnace(&octree, white, Some(0.1), quality)), [1.0; 2]);
}

/// A sphere does not mirror itself, so one bounce is all of it.
#[test]
fn a_mirror_vanishes_in_a_white_world() {
    for depth in [5, 6, 7] {
        let octree = Model::of_depth(&sphere(5).mesh(), depth).octree;
        for reflectivity in [0.3, 1.0] {
            for bounces in [0, 1, 64] {
                let quality = Quality { bounces, ..exact() };
                let [least, most] = range(&furnace(&octree, mirror(reflectivity), None, quality));
                let is_right = least > 1.0 - ROUNDING && most < 1.0 + ROUNDING;
                assert!(is_right, "depth {depth}, {reflectivity}, {bounces} bounces: {least} to {most}");
            }
        }
    }
}

/// Glass takes nothing away either, if light is followed to the end. A bound on bounces costs light: a smooth sphere keeps
/// a share R of what comes in at each meeting with its surface, so after `n` bounces (1 − R) Rⁿ⁻¹ is lost, at the most 1/(e n)
/// and next to nothing but where R is close to 1, at the silhouette. There, neighbouring voxels face a little differently,
/// so that some rays are held by total reflection for long: up to four fifths of the light of a pixel for eight bounces, and
/// of the whole picture no more than a tenth of one over `n`.
#[test]
fn glass_vanishes_in_a_white_world() {
    for depth in [5, 6, 7] {
        let octree = Model::of_depth(&sphere(5).mesh(), depth).octree;
        for bounces in [8u32, 32, 256] {
            let quality = Quality { bounces, ..exact() };
            let found = furnace(&octree, glass(1.5), None, quality);
            let [least, most] = range(&found);
            let lost = found.iter().map(|pixel| 1.0 - pixel.x).sum::<f32>() / found.len() as f32;
            println!("glass, depth {depth}, {bounces} bounces: {least} to {most}, {lost} lost in the mean");
            assert!(most < 1.0 + ROUNDING, "depth {depth}, {bounces} bounces: {most}");
            assert!(lost < 0.1 / bounces as f32, "depth {depth}, {bounces} bounces: {lost} lost");
            assert!(
                bounces < 256 || least > 1.0 - ROUNDING,
                "depth {depth}: {least} in spite of 256 bounces"
            );
            // Glass that does not bend light does not mirror it: in and out, at a silhouette past a step of it, too.
            let straight = range(&furnace(&octree, glass(1.0), None, quality));
            assert_eq!(straight, [1.0; 2], "depth {depth}, {bounces} bounces");
        }
    }
}

/// A box of 16³ cells, its normals inwards; but for those of the wall at the far end of z, that have no code.
fn mirror_box() -> Octree {
    voxels(4, |cell| {
        let axis = (0..3).rfind(|&axis| [0, 15].contains(&cell[axis]))?;
        let inwards = if cell[axis] == 0 || axis == 2 { 1.0 } else { -1.0 };
        Some((1, DVec3::AXES[axis] * inwards))
    })
}

#[test]
fn mirrors_face_to_face_show_a_geometric_series() {
    let octree = mirror_box();
    let eye = DVec3::splat(0.5);
    let camera = Camera { eye, target: eye + DVec3::Z, up: DVec3::Y, vertical_fov: 40.0 };
    let lens = Lens { projection: Projection::Orthographic { height: 0.8 }, ..Lens::default() };
    for reflectivity in [0.25f32, 0.9, 1.0] {
        let surface = SurfaceMaterial { reflectivity: Vec3::splat(reflectivity), ..glowing(0.7) };
        let scene = alone(&octree, &[surface]);
        for bounces in [0, 1, 2, 7, 40] {
            let found = range(&light(&scene, &(camera, lens), SIZE, Quality { bounces, ..exact() }));
            let expected: f32 = (0..=bounces as i32).map(|bounce| 0.7 * reflectivity.powi(bounce)).sum();
            // A product and a sum at each bounce, each rounded.
            let rounding = (bounces + 1) as f32 * f32::EPSILON * expected;
            let is_right = found.iter().all(|light| (light - expected).abs() <= rounding);
            assert!(is_right, "{reflectivity}, {bounces} bounces: {found:?} instead of {expected}");
        }
    }
}

/// The same in all directions: what a ray meets is followed from wall to wall in double precision.
#[test]
fn a_box_of_mirrors_shows_what_unfolding_tells() {
    const REFLECTIVITY: f64 = 0.8;
    const BOUNCES: u32 = 12;
    let octree = mirror_box();
    let surface = SurfaceMaterial { reflectivity: Vec3::splat(REFLECTIVITY as f32), ..glowing(1.0) };
    let eye = DVec3::new(0.4, 0.55, 0.3);
    let camera = Camera { eye, target: eye + DVec3::new(0.2, 0.1, 1.0), up: DVec3::Y, vertical_fov: 60.0 };
    let quality = Quality { bounces: BOUNCES, ..exact() };
    let found = light(&alone(&octree, &[surface]), &(camera, Lens::default()), SIZE, quality);
    let mut worst = 0f64;
    for (place, pixel) in (0..).zip(&found) {
        let mut ray = pixel_ray(&camera, SIZE, [place % SIZE[0], place / SIZE[0]]);
        let (mut expected, mut share) = (0.0, 1.0);
        for _ in 0..=BOUNCES {
            let walls =
                DVec3::select(ray.direction.cmpgt(DVec3::ZERO), DVec3::splat(15.0), DVec3::ONE) / 16.0;
            let distances = (walls - ray.origin) / ray.direction;
            let axis = distances.min_position();
            ray.origin += ray.direction * distances[axis];
            ray.origin[axis] = walls[axis];
            expected += share;
            // Schlick: from the side all is mirrored.
            let rest = 1.0 - ray.direction[axis].abs();
            share *= REFLECTIVITY + (1.0 - REFLECTIVITY) * rest.powi(5);
            ray.direction[axis] *= -1.0;
        }
        worst = worst.max((f64::from(pixel.x) / expected - 1.0).abs());
    }
    println!("mirror box: off by a share of {worst}");
    // Each of twelve directions is rounded, and with it the share that is mirrored.
    assert!(worst < 12.0 * f64::from(ROUNDING), "off by a share of {worst}");
}

/// A pane of glass: two layers of voxels that face outwards, and below it what `below` says.
fn pane(layers: [u32; 2], below: impl Fn([u32; 3]) -> Option<(u16, DVec3)>) -> Octree {
    voxels(5, |cell| match cell[1] {
        y if y == layers[1] => Some((1, DVec3::Y)),
        y if y == layers[0] => Some((1, -DVec3::Y)),
        _ => below(cell),
    })
}

/// Light straight through a pane: a share F = ((n − 1)/(n + 1))² is mirrored at each surface, inside again and again.
///
/// Rays meet the upper face of a lower voxel after d = N cells, and are mirrored to the lower face of an upper one after
/// N − 1. With t = exp(−a N) and u = exp(−a (N − 1)), a per cell, what passes is (1 − F)² t Σ (F u)²ᵏ, and what comes back
/// F + (1 − F)² F t u Σ (F u)²ᵏ. Without absorption that is (1 − F)/(1 + F) and 2F/(1 + F).
#[test]
fn a_pane_passes_and_mirrors_what_fresnel_says() {
    let octree = pane([9, 21], |_| None);
    let eye = DVec3::new(0.5, 1.5, 0.5);
    let camera = Camera { eye, target: eye - DVec3::Y, up: DVec3::X, vertical_fov: 40.0 };
    let lens = Lens { projection: Projection::Orthographic { height: 0.5 }, ..Lens::default() };
    let quality = Quality { bounces: 40, ..exact() };
    for index in [1.0f64, 1.33, 1.5, 2.4] {
        for absorption in [0.0, 0.7, 5.0f64] {
            let surface =
                SurfaceMaterial { absorption: Vec3::splat(absorption as f32), ..glass(index as f32) };
            let mirrored = ((index - 1.0) / (index + 1.0)).powi(2);
            let [first, later] = [12.0, 11.0].map(|cells| (-absorption * cells / 32.0).exp());
            let series = (1.0 - mirrored).powi(2) * first / (1.0 - (mirrored * later).powi(2));
            let expected = [series, mirrored + series * mirrored * later];
            if absorption == 0.0 {
                let [passed, back] = [(1.0 - mirrored) / (1.0 + mirrored), 2.0 * mirrored / (1.0 + mirrored)];
                assert!((expected[0] - passed).abs() < 1e-12 && (expected[1] - back).abs() < 1e-12);
            }
            for (is_above, expected) in [false, true].into_iter().zip(expected) {
                let [bottom, top] =
                    [!is_above, is_above].map(|is_lit| Vec3::splat(f32::from(u8::from(is_lit))));
                let background = Background::Gradient { bottom, top };
                let scene = Scene { background, ..alone(&octree, &[surface]) };
                let found = range(&light(&scene, &(camera, lens), SIZE, quality));
                let is_right = found.iter().all(|light| (f64::from(*light) - expected).abs() < 1e-6);
                assert!(is_right, "index {index}, absorption {absorption}: {found:?}, not {expected}");
            }
        }
    }
}

/// A slanted ray leaves a pane of thickness d beside where it would have gone: by d sin t (1 − cos t / (n cos t′)). An edge
/// behind the pane is seen there, to a pixel of an eighth of a voxel.
#[test]
fn a_pane_moves_what_is_behind_it() {
    const PIXELS: u32 = 8;
    let edge = |[x, y, _]: [u32; 3]| (y == 4).then_some((if x < 24 { 2 } else { 3 }, DVec3::Y));
    let octree = pane([16, 24], edge);
    let size = [32 * PIXELS, 2];
    for degrees in [0.0f64, 20.0, 40.0] {
        let angle = degrees.to_radians();
        let (sin, cos) = angle.sin_cos();
        // What is seen in the middle of the picture without glass: where the edge is, on the upper faces.
        let target = DVec3::new(24.0, 5.0, 16.0) / 32.0;
        let eye = target - DVec3::new(sin, -cos, 0.0);
        let camera = Camera { eye, target, up: -DVec3::Z, vertical_fov: 40.0 };
        let height = f64::from(size[1]) / f64::from(PIXELS) / 32.0;
        let lens = Lens { projection: Projection::Orthographic { height }, ..Lens::default() };
        for index in [1.0f64, 1.5, 2.0] {
            let surfaces = [glass(index as f32), glowing(1.0), SurfaceMaterial::matte(Vec3::ZERO)];
            let pixels =
                light(&alone(&octree, &surfaces), &(camera, lens), size, Quality { bounces: 30, ..exact() });
            // From there on to the right it is dark, but for what is mirrored inside.
            let middle = size[0] / 2;
            let lit = (middle - 4 * PIXELS..middle + 6 * PIXELS).take_while(|&x| pixels[x as usize].x > 0.5);
            let found = f64::from(lit.last().unwrap() + 1) - f64::from(middle);
            let cos_inside = (1.0 - (sin / index).powi(2)).sqrt();
            let expected = 8.0 * sin * (1.0 - cos / (index * cos_inside)) * f64::from(PIXELS);
            println!("{degrees} degrees, index {index}: edge at {found} pixels, expected {expected}");
            assert!((found - expected).abs() <= 1.0, "{degrees}°, {index}: {found} instead of {expected}");
        }
    }
}
