//! Pictures held against one another: every width, with beams and without, sees the same in each pixel.

use crate::arithmetic::Arithmetic;
use crate::camera::Camera;
use crate::octree::Octree;
use crate::random::Random;
use crate::visibility::{Visibility, VisibilityOptions};
use crate::width::Width;
use glam::DVec3;

/// The largest picture, in pixels along its side.
const LARGEST: u64 = 256;

/// Footprints at which rays end, in turn.
const LOD_PIXELS: [f64; 4] = [0.0, 1.0, 0.0, 3.0];

/// What was found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct PictureFindings {
    /// Rays through pixels.
    pub rays: u64,
    /// Rays of which distance or voxel are not the same, to the last bit, in every setting.
    pub differences: u64,
}

/// Traces pictures of random cameras, of at least so many rays in all. `progress` is told of the rays done.
pub(crate) fn check_pictures(
    octree: &Octree,
    rays: u64,
    seed: u64,
    arithmetic: Arithmetic,
    widths: &[Width],
    progress: impl Fn(u64),
) -> PictureFindings {
    let side = (1..=LARGEST).find(|side| side * side >= rays).unwrap_or(LARGEST);
    let size = [side as u32; 2];
    let mut findings = PictureFindings::default();
    let mut number = 0;
    while findings.rays < rays {
        let camera = random_camera(&mut Random::stream(seed, number));
        let lod_pixels = LOD_PIXELS[number as usize % LOD_PIXELS.len()];
        let mut pictures = widths.iter().flat_map(|&width| [false, true].map(|beams| (width, beams))).map(
            |(width, beams)| {
                let mut seen = Visibility::default();
                let options = VisibilityOptions { arithmetic, width, lod_pixels, beams, count_steps: false };
                let traced = seen.trace(octree, &camera, size, &options);
                traced.expect("random cameras look somewhere");
                seen.by_pixel(arithmetic, width, size)
            },
        );
        let mut differs = vec![false; (side * side) as usize];
        if let Some(first) = pictures.next() {
            for other in pictures {
                for (differs, (first, other)) in differs.iter_mut().zip(first.iter().zip(&other)) {
                    *differs |= first != other;
                }
            }
        }
        let done = findings.rays;
        findings.rays += side * side;
        findings.differences += differs.iter().filter(|&&differs| differs).count() as u64;
        number += 1;
        progress((side * side).min(rays - done));
    }
    findings
}

/// From about the cube or within it to somewhere in the cube. One in four looks along an axis, one in eight is far away.
fn random_camera(random: &mut Random) -> Camera {
    const STEPS: i32 = 1 << 20;
    let mut point = |low: f64, high: f64| {
        DVec3::from_array([(); 3].map(|()| {
            let part = f64::from(random.between(0, STEPS)) / f64::from(STEPS);
            low + (high - low) * part
        }))
    };
    let [eye, target, shape] = [point(-1.0, 2.0), point(0.1, 0.9), point(0.0, 1.0)];
    let vertical_fov = 5.0 + 100.0 * shape.x;
    if shape.y < 0.25 {
        let axis = [DVec3::X, DVec3::NEG_Y, DVec3::NEG_Z][(shape.z * 3.0) as usize];
        return Camera { eye, target: eye + axis, up: DVec3::new(axis.y, axis.z, axis.x), vertical_fov };
    }
    if shape.y > 0.875 {
        let away = eye - target;
        let eye = target + away * 1000.0;
        return Camera { eye, target, up: upright(away), vertical_fov: vertical_fov / 1000.0 };
    }
    Camera { eye, target, up: upright(target - eye), vertical_fov }
}

/// A direction that is not along another.
fn upright(direction: DVec3) -> DVec3 {
    if direction.cross(DVec3::Y).length() > 1e-3 { DVec3::Y } else { DVec3::X }
}
