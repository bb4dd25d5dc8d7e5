//! Texture coordinates between the corners of a triangle.

use crate::fixed_point::{HALF_VOXEL, SUBVOXELS};
use std::cmp::Ordering;

/// What a triangle carries for its textures at each corner: a [`TexturePoint`], or nothing.
pub(crate) trait Coordinates: Copy + Ord {
    /// Coordinates somewhere on the triangle.
    type Point: Copy;
    /// Coordinates over a projection of the triangle.
    type Plane;

    /// For a projection whose corners have these first two coordinates, in sub-voxel steps. `area` is twice its signed
    /// area, not zero.
    fn plane(at_corners: [Self; 3], corners: [[i64; 3]; 3], area: i64) -> Self::Plane;

    /// At the centre of a column of the projection.
    fn at(plane: &Self::Plane, column: [i64; 2]) -> Self::Point;

    /// The mean of the corners with weights whose sum is 1.
    fn mean(at_corners: &[Self; 3], weights: [f64; 3]) -> Self::Point;
}

impl Coordinates for () {
    type Point = ();
    type Plane = ();

    #[inline]
    fn plane(_: [(); 3], _: [[i64; 3]; 3], _: i64) {}

    #[inline]
    fn at((): &(), _: [i64; 2]) {}

    #[inline]
    fn mean(_: &[(); 3], _: [f64; 3]) {}
}

/// Texture coordinates: u to the right, v up. Ordered by their bits, so that corners can be sorted.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TexturePoint(pub [f32; 2]);

impl Ord for TexturePoint {
    fn cmp(&self, other: &Self) -> Ordering {
        let [[u, v], [other_u, other_v]] = [self.0, other.0];
        u.total_cmp(&other_u).then(v.total_cmp(&other_v))
    }
}

impl PartialOrd for TexturePoint {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for TexturePoint {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for TexturePoint {}

/// Texture coordinates as linear functions of a projection.
///
/// Each column is computed from the corners, not from the column before, so it does not matter where a walk began.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TexturePlane {
    /// The corner from which places are measured, in sub-voxel steps.
    origin: [i64; 2],
    at_origin: [f64; 2],
    /// Change for each sub-voxel step along the two axes, of u and of v.
    slopes: [[f64; 2]; 2],
    /// Smallest and largest of the corners. A sliver is so steep that rounding would lead out of them.
    range: [[f64; 2]; 2],
}

impl Coordinates for TexturePoint {
    type Point = [f64; 2];
    type Plane = TexturePlane;

    fn plane(at_corners: [Self; 3], corners: [[i64; 3]; 3], area: i64) -> TexturePlane {
        let [p, q, r] = corners;
        let [at_p, at_q, at_r] = at_corners.map(|TexturePoint(point)| point.map(f64::from));
        let difference = |a: i64, b: i64| (a - b) as f64;
        let area = area as f64;
        let slopes = [0, 1].map(|k| {
            let (along_q, along_r) = (at_q[k] - at_p[k], at_r[k] - at_p[k]);
            [
                (along_q * difference(r[1], p[1]) - along_r * difference(q[1], p[1])) / area,
                (along_r * difference(q[0], p[0]) - along_q * difference(r[0], p[0])) / area,
            ]
        });
        let range = [0, 1].map(|k| {
            let [a, b, c] = [at_p[k], at_q[k], at_r[k]];
            [a.min(b).min(c), a.max(b).max(c)]
        });
        TexturePlane { origin: [p[0], p[1]], at_origin: at_p, slopes, range }
    }

    #[inline]
    fn at(plane: &TexturePlane, column: [i64; 2]) -> [f64; 2] {
        let [x, y] = [0, 1].map(|axis| {
            let center = column[axis] * i64::from(SUBVOXELS) + i64::from(HALF_VOXEL);
            (center - plane.origin[axis]) as f64
        });
        [0, 1].map(|k| {
            let [along_x, along_y] = plane.slopes[k];
            let [low, high] = plane.range[k];
            (plane.at_origin[k] + (along_x * x + along_y * y)).max(low).min(high)
        })
    }

    fn mean(at_corners: &[Self; 3], weights: [f64; 3]) -> [f64; 2] {
        [0, 1].map(|k| (0..3).map(|corner| weights[corner] * f64::from(at_corners[corner].0[k])).sum())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_linear_texture_is_found_again(
            corners in prop::array::uniform3(prop::array::uniform3(0i64..60_000)),
            slope in prop::array::uniform4(-100i64..100),
        ) {
            let [p, q, r] = corners;
            let area = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
            prop_assume!(area.abs() > 100_000);
            // Texture coordinates that single precision holds exactly.
            let texture = |x: i64, y: i64| [(slope[0] * x + slope[1] * y) as f64 / 16.0, (slope[2] * x + slope[3] * y) as f64 / 16.0];
            let at_corners = corners.map(|corner| TexturePoint(texture(corner[0], corner[1]).map(|value| value as f32)));
            let plane = TexturePoint::plane(at_corners, corners, area);
            let cross = |a: [i64; 3], b: [i64; 3], c: [i64; 2]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            for i in 0..58 {
                for j in 0..58 {
                    let center = [i * 1024 + 512, j * 1024 + 512];
                    if [cross(p, q, center), cross(q, r, center), cross(r, p, center)].iter().any(|&side| side * area.signum() < 0) {
                        continue;
                    }
                    let (found, expected) = (TexturePoint::at(&plane, [i, j]), texture(center[0], center[1]));
                    prop_assert!((0..2).all(|k| (found[k] - expected[k]).abs() < 1e-5), "{found:?} {expected:?}");
                }
            }
        }
    }
}
