//! Normals and colours between the corners of a triangle.

use crate::fixed_point::{HALF_VOXEL, SUBVOXEL_BITS, SUBVOXELS};

/// Binary places of an interpolated value behind the point.
const FRACTION_BITS: u32 = 15;

/// Steeper than this (in fixed point, per column) means that the triangle is a sliver much narrower than a column.
const STEEPEST: f64 = (1u64 << 36) as f64;

/// `N` values that vary linearly over a triangle, on the lattice of column centres.
///
/// Values are integers in fixed point, so what a sample gets does not depend on the way by which it was reached. They are
/// kept modulo 2^32: within the triangle they fit, and outside of it nobody asks.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Interpolation<const N: usize> {
    /// Column at which the values are `base`.
    column: [i64; 2],
    base: [i32; N],
    step_u: [i32; N],
    step_v: [i32; N],
}

impl<const N: usize> Interpolation<N> {
    /// The values at three corners, whose first two coordinates are those of the column in sub-voxel steps.
    /// `area` is twice the signed area of the projection, not zero.
    ///
    /// A sliver, over which a value would change by more than it can within a fraction of a column, gets the mean.
    pub(crate) fn new(corners: [[i64; 3]; 3], values: [[i16; N]; 3], area: i64) -> Self {
        let [p, q, r] = corners;
        let [at_p, at_q, at_r] = values.map(|corner| corner.map(i64::from));
        let scale = f64::from(SUBVOXELS) * f64::from(1 << FRACTION_BITS) / area as f64;
        let column = [p[0] >> SUBVOXEL_BITS, p[1] >> SUBVOXEL_BITS];
        let to_center = [0, 1].map(|axis| (column[axis] << SUBVOXEL_BITS) + i64::from(HALF_VOXEL) - p[axis]);
        let mut result = Self { column, base: [0; N], step_u: [0; N], step_v: [0; N] };
        for k in 0..N {
            // Integers of at most 43 bits, exact as floating point too.
            let (dq, dr) = (at_q[k] - at_p[k], at_r[k] - at_p[k]);
            let along_u = (dq * (r[1] - p[1]) - dr * (q[1] - p[1])) as f64 * scale;
            let along_v = (dr * (q[0] - p[0]) - dq * (r[0] - p[0])) as f64 * scale;
            if along_u.abs() < STEEPEST && along_v.abs() < STEEPEST {
                let (along_u, along_v) = (along_u as i64, along_v as i64);
                let offset = (along_u * to_center[0] + along_v * to_center[1]) >> SUBVOXEL_BITS;
                result.base[k] = ((at_p[k] << FRACTION_BITS) + offset) as i32;
                (result.step_u[k], result.step_v[k]) = (along_u as i32, along_v as i32);
            } else {
                result.base[k] = (((at_p[k] + at_q[k] + at_r[k]) << FRACTION_BITS) / 3) as i32;
            }
        }
        result
    }

    /// The values in the column (u, v), with their fraction.
    #[inline]
    pub(crate) fn at(&self, u: i64, v: i64) -> [i32; N] {
        let (du, dv) = ((u - self.column[0]) as i32, (v - self.column[1]) as i32);
        std::array::from_fn(|k| {
            let along = self.step_u[k].wrapping_mul(du).wrapping_add(self.step_v[k].wrapping_mul(dv));
            self.base[k].wrapping_add(along)
        })
    }

    /// Goes on to the next column along u.
    #[inline]
    pub(crate) fn advance(&self, values: &mut [i32; N]) {
        for (value, step) in values.iter_mut().zip(self.step_u) {
            *value = value.wrapping_add(step);
        }
    }
}

/// Values without their fraction, rounded.
#[inline]
pub(crate) fn rounded<const N: usize>(values: [i32; N]) -> [i16; N] {
    std::array::from_fn(|k| {
        let rounded = values[k].saturating_add(1 << (FRACTION_BITS - 1)) >> FRACTION_BITS;
        // Rounded steps may lead a little beyond the corners' values. Normals have room for it, light has not.
        if k < 3 { rounded as i16 } else { rounded.clamp(i16::MIN.into(), i16::MAX.into()) as i16 }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn agrees_with_barycentric_coordinates(
            corners in prop::array::uniform3(prop::array::uniform3(0i64..50_000)),
            values in prop::array::uniform3(prop::array::uniform4(-30_000i16..=30_000)),
        ) {
            let [p, q, r] = corners;
            let cross = |a: [i64; 3], b: [i64; 3], c: [i64; 2]| {
                ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) as f64
            };
            let area = cross(p, q, [r[0], r[1]]);
            prop_assume!(area.abs() > 1e6);
            let interpolation = Interpolation::new(corners, values, area as i64);
            for u in 0..50 {
                for v in 0..50 {
                    let center = [u * 1024 + 512, v * 1024 + 512];
                    let weights = [cross(q, r, center) / area, cross(r, p, center) / area, cross(p, q, center) / area];
                    if weights.iter().any(|&weight| weight < 0.0) {
                        continue;
                    }
                    let found = rounded(interpolation.at(u, v));
                    for k in 0..4 {
                        let expected: f64 = (0..3).map(|corner| weights[corner] * f64::from(values[corner][k])).sum();
                        prop_assert!((f64::from(found[k]) - expected).abs() <= 0.6, "{} {}", found[k], expected);
                    }
                }
            }
        }

        #[test]
        fn equal_corners_give_that_value_everywhere(
            corners in prop::array::uniform3(prop::array::uniform3(0i64..1 << 24)), value in prop::array::uniform4(-32_000i16..=32_000), column in prop::array::uniform2(0i64..16_384),
        ) {
            let [p, q, r] = corners;
            let area = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
            prop_assume!(area != 0);
            let interpolation = Interpolation::new(corners, [value; 3], area);
            prop_assert_eq!(rounded(interpolation.at(column[0], column[1])), value);
        }
    }
}
