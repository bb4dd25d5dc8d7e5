//! Pictures held against one another: every width, with beams and without, sees the same in each pixel.

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
                let options = VisibilityOptions { width, lod_pixels, beams, count_steps: false };
                let traced = seen.trace(octree, &camera, size, &options);
                traced.map(|_| seen.by_pixel(width, size)).unwrap_or_default()
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
        findings.rays += side * side;
        findings.differences += differs.iter().filter(|&&differs| differs).count() as u64;
        number += 1;
        progress(side * side);
    }
    findings
}

/// From about the cube or within it to somewhere in the cube; every fourth looks along an axis.
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
    let up = if (target - eye).cross(DVec3::Y).length() > 1e-3 { DVec3::Y } else { DVec3::X };
    Camera { eye, target, up, vertical_fov }
}
