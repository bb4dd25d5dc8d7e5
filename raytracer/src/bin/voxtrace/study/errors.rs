//! How far what a setting shows is from what it should show.

use super::measure::Shown;
use super::record::Errors;
use octvox_raytracer::picture_error::{FlipMap, depth_and_normal_errors, flip, rmse, ssim};

/// What pictures are compared with, and how.
pub struct Comparison {
    /// Columns and rows.
    pub size: [u32; 2],
    /// The size of a pixel at distance one.
    pub pixel_at_one: f64,
}

impl Comparison {
    /// How far a picture is from another; for pictures, also where, see [`flip`]. Nothing if they are not of one kind.
    pub fn between(&self, shown: &Shown, reference: &Shown) -> Option<(Errors, Option<FlipMap>)> {
        match (shown, reference) {
            (
                Shown::Picture { pixels, first_hits, voxel },
                Shown::Picture { pixels: expected, first_hits: expected_hits, .. },
            ) => {
                let geometry = depth_and_normal_errors(first_hits, expected_hits, self.pixel_at_one)?;
                let map = flip(pixels, expected, self.size);
                let errors = Errors {
                    depth_voxels: geometry.depth / voxel,
                    depth_pixels: geometry.depth_in_pixels,
                    normal_degrees: geometry.normal_degrees,
                    color: rmse(pixels, expected),
                    ssim: ssim(pixels, expected, self.size),
                    flip: map.mean,
                    silhouette: geometry.coverage_share,
                    other_voxels: None,
                };
                Some((errors, Some(map)))
            }
            (Shown::Rays { hits, voxel }, Shown::Rays { hits: expected, .. }) => {
                Some((of_rays(hits, expected, *voxel), None))
            }
            _ => None,
        }
    }
}

/// Differences of what single rays meet; there are no colours.
fn of_rays(hits: &[[u32; 3]], expected: &[[u32; 3]], voxel: f64) -> Errors {
    let (mut others, mut one_sided, mut same, mut squares) = (0u64, 0u64, 0u64, 0.0);
    for (hit, expected) in hits.iter().zip(expected) {
        let [distance, right] = [hit[0], expected[0]].map(|bits| f64::from(f32::from_bits(bits)));
        if hit[1..] != expected[1..] || distance.is_finite() != right.is_finite() {
            others += 1;
            one_sided += u64::from(distance.is_finite() != right.is_finite());
        } else if distance.is_finite() {
            same += 1;
            squares += (distance - right) * (distance - right);
        }
    }
    let share = |count: u64| count as f64 / hits.len().max(1) as f64;
    Errors {
        depth_voxels: (squares / same.max(1) as f64).sqrt() / voxel,
        depth_pixels: 0.0,
        normal_degrees: 0.0,
        color: 0.0,
        ssim: 1.0,
        flip: 0.0,
        silhouette: share(one_sided),
        other_voxels: Some(share(others)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_are_compared_by_voxel_and_distance() {
        let at = |distance: f32, node: u32| [distance.to_bits(), node, 0];
        let expected = [at(1.0, 1), at(2.0, 2), at(f32::INFINITY, 0), at(3.0, 3)];
        let hits = [at(1.5, 1), at(2.0, 9), at(4.0, 4), at(3.5, 3)];
        let errors = of_rays(&hits, &expected, 0.5);
        assert_eq!((errors.depth_voxels, errors.silhouette), (1.0, 0.25));
        assert_eq!(errors.other_voxels, Some(0.5));
        let same = of_rays(&expected, &expected, 0.5);
        assert_eq!((same.depth_voxels, same.silhouette, same.other_voxels), (0.0, 0.0, Some(0.0)));
    }
}
