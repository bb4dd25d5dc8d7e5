//! The octahedral normal code: two bytes for a direction, spread more evenly than angles.

/// A direction as a point on an octahedron that has been unfolded into a square (Meyer et al. 2010, "On floating-point
/// normal vectors"; Cigolle et al. 2014, "A survey of efficient representations for independent unit vectors").
///
/// It stands for the direction of the vector `(u, v, 127 − |u| − |v|)`, in which, if the last component is negative,
/// `u` and `v` are replaced by `±(127 − |v|)` and `±(127 − |u|)`, with the signs of `u` and `v`. All axes have codes
/// of their own. −128 means the same as −127 and is not written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[repr(C)]
pub struct OctahedralNormal {
    /// Place along x, in units of 1/127 of the half axis.
    pub u: i8,
    /// Place along y, in units of 1/127 of the half axis.
    pub v: i8,
}

/// Steps from the middle of the square to its edge.
const STEPS: i32 = 127;

impl OctahedralNormal {
    /// The largest angle in degrees between a direction and its code, rounded up.
    ///
    /// The codes are sparsest in the middle of an octant, where the octahedron is nearest to the centre. The direction
    /// (1, 1, 1) there is as far from (43, 42, 42), (42, 43, 42) and (42, 42, 43): atan √2/127.
    pub const WORST_ANGLE_DEGREES: f32 = 0.6380;

    /// The code nearest to a direction of any length.
    ///
    /// A vector that has no direction (zero, infinite or not a number) gets the code of the z axis.
    #[must_use]
    pub fn encode(normal: [f32; 3]) -> Self {
        let vector = normal.map(f64::from);
        let [x, y, z] = vector;
        let sum = x.abs() + y.abs() + z.abs();
        if !(sum > 0.0 && sum < f64::INFINITY) {
            return Self::default();
        }
        let (x, y) = (x / sum, y / sum);
        let [u, v] =
            if z < 0.0 { [(1.0 - y.abs()).copysign(x), (1.0 - x.abs()).copysign(y)] } else { [x, y] };
        // The nearest code is one of the four around the place in the square, not always the nearest in the square.
        let low = [u, v].map(|coordinate| (coordinate * f64::from(STEPS)).floor() as i32);
        let corners = [[0, 0], [1, 0], [0, 1], [1, 1]]
            .map(|[right, up]: [i32; 2]| [(low[0] + right).min(STEPS), (low[1] + up).min(STEPS)]);
        let mut best = corners[0];
        let mut best_square = 0.0;
        for corner in corners {
            let square = squared_cosine(vector, unfold(corner));
            if square > best_square {
                (best, best_square) = (corner, square);
            }
        }
        Self::canonical(best)
    }

    /// The unit vector of the code.
    #[must_use]
    #[inline]
    pub fn decode(self) -> [f32; 3] {
        let place = [self.u, self.v].map(|coordinate| i32::from(coordinate).max(-STEPS));
        let vector = unfold(place).map(|component| component as f32);
        let [x, y, z] = vector;
        // Whole numbers up to 3 · 127², so nothing is rounded before the root.
        let length = (x * x + y * y + z * z).sqrt();
        vector.map(|component| component / length)
    }

    /// The code as in the file: u, then v.
    #[must_use]
    #[inline]
    pub const fn to_bytes(self) -> [u8; 2] {
        [self.u as u8, self.v as u8]
    }

    /// The code from the file: u, then v.
    #[must_use]
    #[inline]
    pub const fn from_bytes([u, v]: [u8; 2]) -> Self {
        Self { u: u as i8, v: v as i8 }
    }

    /// On the edges of the square two places are one direction, at its corners all four. One of them stands for all.
    fn canonical([u, v]: [i32; 2]) -> Self {
        let v = if u.abs() == STEPS { v.abs() } else { v };
        let u = if v.abs() == STEPS { u.abs() } else { u };
        Self { u: u as i8, v: v as i8 }
    }
}

/// The point of the octahedron |x| + |y| + |z| = 127 at a place in the square.
#[inline]
fn unfold([u, v]: [i32; 2]) -> [i32; 3] {
    let z = STEPS - u.abs() - v.abs();
    // Where z is negative, neither u nor v is zero.
    let [x, y] =
        if z < 0 { [(STEPS - v.abs()) * u.signum(), (STEPS - u.abs()) * v.signum()] } else { [u, v] };
    [x, y, z]
}

/// The squared cosine of the angle between two directions, times the squared length of the first. They are less than
/// a quarter turn apart.
#[inline]
fn squared_cosine(vector: [f64; 3], point: [i32; 3]) -> f64 {
    let point = point.map(f64::from);
    let dot = vector[0] * point[0] + vector[1] * point[1] + vector[2] * point[2];
    dot * dot / (point[0] * point[0] + point[1] * point[1] + point[2] * point[2])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::angles::{angle, assert_nearest, unit};
    use proptest::prelude::*;
    use std::f64::consts::PI;

    fn codes() -> impl Iterator<Item = OctahedralNormal> {
        (0..=u16::MAX).map(|bits| OctahedralNormal::from_bytes(bits.to_le_bytes()))
    }

    /// The direction of a code by its definition.
    fn direction(code: OctahedralNormal) -> [f64; 3] {
        let [u, v] = [code.u, code.v].map(|coordinate| f64::from(coordinate.max(-127)) / 127.0);
        let z = 1.0 - u.abs() - v.abs();
        let [x, y] =
            if z < -1e-9 { [(1.0 - v.abs()) * u.signum(), (1.0 - u.abs()) * v.signum()] } else { [u, v] };
        let length = (x * x + y * y + z * z).sqrt();
        [x, y, z].map(|component| component / length)
    }

    fn directions() -> Vec<[f64; 3]> {
        codes().map(direction).collect()
    }

    fn assert_encoded_to_nearest(vector: [f64; 3], directions: &[[f64; 3]]) {
        let vector = vector.map(|component| component as f32);
        assert_nearest(vector, direction(OctahedralNormal::encode(vector)), directions);
    }

    #[test]
    fn decodes_to_the_definition() {
        for code in codes() {
            let decoded = code.decode();
            for (computed, expected) in decoded.iter().zip(direction(code)) {
                assert!((f64::from(*computed) - expected).abs() < 1.2e-7, "{code:?}: {decoded:?}");
            }
        }
    }

    #[test]
    fn axes_decode_exactly() {
        let decode = |u, v| OctahedralNormal { u, v }.decode();
        assert_eq!(decode(0, 0), [0.0, 0.0, 1.0]);
        assert_eq!(decode(127, 0), [1.0, 0.0, 0.0]);
        assert_eq!(decode(-127, 0), [-1.0, 0.0, 0.0]);
        assert_eq!(decode(0, 127), [0.0, 1.0, 0.0]);
        assert_eq!(decode(0, -127), [0.0, -1.0, 0.0]);
        for (u, v) in [(127, 127), (-127, 127), (127, -127), (-127, -127), (-128, -128)] {
            assert_eq!(decode(u, v), [0.0, 0.0, -1.0]);
        }
    }

    #[test]
    fn a_code_is_its_own_nearest() {
        let directions = directions();
        let mut canonical = 0;
        for code in codes() {
            let encoded = OctahedralNormal::encode(code.decode());
            let same =
                angle(direction(encoded), directions[usize::from(u16::from_le_bytes(code.to_bytes()))]);
            assert!(same < 1e-7, "{code:?} became {encoded:?}");
            assert_eq!(OctahedralNormal::encode(encoded.decode()), encoded);
            canonical += usize::from(encoded == code);
        }
        // All of 255 × 255, but of the pairs of places on the edges one each, and of the corners one.
        assert_eq!(canonical, 255 * 255 - 4 * 126 - 3);
    }

    #[test]
    fn what_has_no_direction_has_a_code() {
        let zero_or_worse = [0.0, -0.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
        for x in zero_or_worse {
            for y in zero_or_worse {
                for z in zero_or_worse {
                    let code = OctahedralNormal::encode([x, y, z]);
                    assert_eq!(code, OctahedralNormal::default(), "{x} {y} {z}");
                }
            }
        }
        assert_eq!(OctahedralNormal::encode([1.0, 0.0, f32::NAN]), OctahedralNormal::default());
    }

    #[test]
    fn between_codes_the_nearest_is_chosen() {
        let directions = directions();
        // Just beside the middle between neighbours, where rounding in the square would often be wrong; across the
        // equator and along the edges of the square too.
        let neighbours = [[1, 0], [0, 1], [1, 1], [1, -1]];
        for code in (0..255 * 255).step_by(331) {
            let [u, v] = [code % 255 - 127, code / 255 - 127];
            for [right, up] in neighbours {
                let other =
                    OctahedralNormal { u: (u + right).min(127) as i8, v: (v + up).clamp(-127, 127) as i8 };
                let [a, b] = [direction(OctahedralNormal { u: u as i8, v: v as i8 }), direction(other)];
                for share in [0.499, 0.501] {
                    let between = std::array::from_fn(|axis| a[axis] * share + b[axis] * (1.0 - share));
                    assert_encoded_to_nearest(between, &directions);
                }
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(500))]
        #[test]
        fn no_code_is_nearer(vector in prop::array::uniform3(-1.0_f64..1.0), scale in -120_i32..120) {
            prop_assume!(vector.iter().any(|&v| v.abs() > 1e-3));
            thread_local! {
                static DIRECTIONS: Vec<[f64; 3]> = directions();
            }
            let scale = 2.0_f64.powi(scale);
            DIRECTIONS.with(|directions| assert_encoded_to_nearest(vector.map(|v| v * scale), directions));
        }
    }

    #[test]
    fn the_worst_angle_is_reached_and_not_exceeded() {
        let worst = f64::from(OctahedralNormal::WORST_ANGLE_DEGREES);
        let error = |vector: [f64; 3]| {
            let vector = vector.map(|v| v as f32);
            let decoded = OctahedralNormal::encode(vector).decode();
            angle(unit(vector), unit(decoded)).to_degrees()
        };
        for sign in [1.0, -1.0] {
            let reached = error([sign, 1.0, -sign]);
            assert!(reached <= worst && reached > worst - 1e-4, "{reached}");
        }

        // A lattice that is finer than the codes by a factor that is no integer.
        let (rows, columns) = (1187, 1501);
        let mut largest = 0.0_f64;
        for row in 0..=rows {
            let theta = PI * f64::from(row) / f64::from(rows);
            for column in 0..columns {
                let phi = 2.0 * PI * f64::from(column) / f64::from(columns);
                largest = largest.max(error([theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()]));
            }
        }
        assert!(largest <= worst && largest > 0.98 * worst, "{largest}");
    }
}
