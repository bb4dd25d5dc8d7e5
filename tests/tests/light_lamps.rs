//! What lamps bring to a floor of voxels, against formulas in double precision.

use glam::{DVec3, Vec3};
use octvox_raytracer::Quality;
use octvox_raytracer::scene::{Light, Scene, Source, SurfaceMaterial};
use octvox_tests::stage::{alone, exact, floor, from_above, light};

/// A pixel for each voxel.
const SIZE: [u32; 2] = [64, 64];
const DEPTH: u8 = 6;

/// Share that the floor scatters.
const DIFFUSE: f32 = 0.5;

/// Places and lengths are single floats of about one, off by 2⁻²⁴ each; the cosine and the square of the distance take
/// some ten of them.
const ROUNDING: f64 = 2e-6;

/// The light of each pixel under one lamp, with the place on the floor that it shows.
fn lit_by(source: Source, quality: Quality) -> Vec<(DVec3, f64)> {
    let octree = floor(DEPTH);
    let lamp = Light { source, color: Vec3::new(2.0, 1.0, 4.0), shadow: true };
    let scene =
        Scene { lights: vec![lamp], ..alone(&octree, &[SurfaceMaterial::matte(Vec3::splat(DIFFUSE))]) };
    let pixels = light(&scene, &from_above(), SIZE, quality);
    let place = |number: u32| {
        let [x, y] = [number % SIZE[0], number / SIZE[0]].map(|at| (f64::from(at) + 0.5) / 64.0);
        DVec3::new(x, 1.0 / 64.0, y)
    };
    let check = |(number, pixel): (u32, Vec3)| {
        assert_eq!([pixel.x, pixel.z], [pixel.y * 2.0, pixel.y * 4.0], "colours are as those of the lamp");
        (place(number), f64::from(pixel.y / DIFFUSE))
    };
    (0..).zip(pixels).map(check).collect()
}

/// What a point of a lamp brings to a place on the floor.
fn from_point(lamp: DVec3, place: DVec3) -> f64 {
    let offset = lamp - place;
    offset.y / offset.length().powi(3)
}

#[test]
fn a_point_falls_off_with_the_square_of_the_distance() {
    for height in [0.1, 0.5, 2.0, 30.0] {
        let position = DVec3::new(0.3, height, 0.6);
        let mut worst = 0f64;
        for (place, found) in lit_by(Source::Point { position: position.as_vec3(), radius: 0.0 }, exact()) {
            worst = worst.max((found / from_point(position, place) - 1.0).abs());
        }
        println!("point at height {height}: off by a share of {worst:e}");
        // The lamp's own height above the floor is rounded: a share of that.
        let rounding = ROUNDING + 2f64.powi(-24) * (1.0 / (height - 1.0 / 64.0)) * 3.0;
        assert!(worst < rounding, "height {height}: off by a share of {worst:e}");
    }
}

#[test]
fn a_spot_lights_its_cone() {
    let position = DVec3::new(0.5, 1.0, 0.5);
    let towards = DVec3::new(0.2, -1.0, 0.1).normalize();
    let [all, none] = [12f64, 24.0].map(f64::to_radians);
    let cone = [all, none].map(|angle| angle.cos() as f32);
    let source = Source::Spot { position: position.as_vec3(), radius: 0.0, towards: towards.as_vec3(), cone };
    let mut counts = [0; 3];
    let mut between = Vec::new();
    for (place, found) in lit_by(source, exact()) {
        let angle = (place - position).angle_between(towards);
        let share = found / from_point(position, place);
        // At the borders the share is even, so what is rounded there does not show.
        if angle <= all {
            assert!((share - 1.0).abs() < 1e-4, "{share} at {}°", angle.to_degrees());
            counts[0] += 1;
        } else if angle >= none {
            assert!(share < 1e-4, "{share} at {}°", angle.to_degrees());
            counts[1] += 1;
        } else {
            between.push((angle, share));
            counts[2] += 1;
        }
    }
    assert!(counts.iter().all(|count| *count > 300), "{counts:?}");
    between.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert!(between.windows(2).all(|pair| pair[1].1 < pair[0].1 + 1e-4), "less and less outwards");
    // Half of the light where the cosine is half way.
    let middle = ((all.cos() + none.cos()) / 2.0).acos();
    let (_, half) =
        between.iter().min_by(|a, b| (a.0 - middle).abs().total_cmp(&(b.0 - middle).abs())).unwrap();
    assert!((half - 0.5).abs() < 0.02, "{half}");
}

#[test]
fn an_area_brings_the_integral_over_it() {
    const STEPS: i32 = 64;
    let (middle, right, up) =
        (DVec3::new(0.4, 0.6, 0.5), DVec3::new(0.25, 0.1, 0.0), DVec3::new(0.0, 0.0, 0.3));
    let facing = right.cross(up).normalize();
    assert!(facing.y < 0.0, "it shines down");
    let [m, r, u] = [middle, right, up].map(|vector| vector.as_vec3());
    let quality = Quality { light_samples: 256, ..exact() };
    let pixels = lit_by(Source::Area { position: m, right: r, up: u }, quality);
    let (mut sums, mut worst) = ([0.0; 2], 0f64);
    for (place, found) in pixels {
        let mut expected = 0.0;
        for step in 0..STEPS * STEPS {
            let [x, y] =
                [step % STEPS, step / STEPS].map(|k| (f64::from(2 * k + 1) / f64::from(STEPS)) - 1.0);
            let lamp = middle + right * x + up * y;
            let cosine = ((place - lamp).normalize().dot(facing)).max(0.0);
            expected += from_point(lamp, place) * cosine / f64::from(STEPS * STEPS);
        }
        worst = worst.max((found / expected - 1.0).abs());
        sums = [sums[0] + found, sums[1] + expected];
    }
    println!("area: off by a share of {worst:e}, in all by {:e}", sums[0] / sums[1] - 1.0);
    // 256 points, one in each cell of every grid of so many, of an integrand that changes by a factor of some ten over the
    // lamp: each pixel is off by about 256^(-3/4) of it, differently, and the sum over 4096 of them by a 64th of that.
    assert!(worst < 0.01, "off by a share of {worst:e}");
    assert!((sums[0] / sums[1] - 1.0).abs() < 2e-4, "the sum is off by {:e}", sums[0] / sums[1] - 1.0);
}

#[test]
fn a_directional_lamp_brings_its_cosine() {
    for degrees in [0.0f64, 30.0, 60.0, 85.0, 89.5, 90.5, 120.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let towards = DVec3::new(sin * 0.6, cos, -sin * 0.8).as_vec3();
        for (place, found) in lit_by(Source::Directional { towards, radius: 0.0 }, exact()) {
            let expected = f64::from(towards.y).max(0.0);
            assert!((found - expected).abs() < ROUNDING, "{degrees}° at {place}: {found}");
        }
    }
}

/// The sun's disk is seen whole from everywhere: its mean brings what its middle does, but for the square of its radius.
#[test]
fn a_disk_in_the_sky_brings_what_its_middle_does() {
    let radius = 1f64.to_radians();
    let towards = DVec3::new(0.6, 0.8, 0.0).as_vec3();
    let quality = Quality { light_samples: 64, ..exact() };
    let pixels = lit_by(Source::Directional { towards, radius: radius as f32 }, quality);
    let mean = pixels.iter().map(|(_, found)| found).sum::<f64>() / pixels.len() as f64;
    assert!((mean / 0.8 - 1.0).abs() < radius.powi(2), "{mean}");
}
