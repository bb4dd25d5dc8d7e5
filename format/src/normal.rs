//! The spherical normal code: two bytes for a direction.

use crate::sine::{cosine, sine};
use std::f64::consts::FRAC_PI_4;

/// A direction as polar angle and azimuth of eight bits each (Bohnen 2009, section 3.5.1).
///
/// It stands for the unit vector `(sin θ cos φ, sin θ sin φ, cos θ)` with `θ = theta/256 · π` and
/// `φ = phi/128 · π`. The z axis is the one with `theta` 0, the negative z axis has no code of its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[repr(C)]
pub struct SphericalNormal {
    /// Angle to the z axis, in units of π/256.
    pub theta: u8,
    /// Angle about the z axis, from x towards y, in units of π/128.
    pub phi: i8,
}

impl SphericalNormal {
    /// The largest angle in degrees between a direction and its code, rounded up.
    ///
    /// The codes are sparsest at the equator, π/128 apart along it and π/256 across. Farthest from all of them is the
    /// middle between four, in the direction (1, tan π/256, tan π/512), whose angle `a` to the code of the x axis has
    /// tan² `a` = tan² π/256 + tan² π/512. (The negative pole is closer to its nearest codes: π/256.)
    pub const WORST_ANGLE_DEGREES: f32 = 0.7862;

    /// The code nearest to a direction of any length.
    ///
    /// A vector that has no direction (zero, infinite or not a number) gets the code of the z axis.
    #[must_use]
    pub fn encode(normal: [f32; 3]) -> Self {
        let [x, y, z] = normal.map(f64::from);
        if !(x.is_finite() && y.is_finite() && z.is_finite()) {
            return Self::default();
        }
        let (abs_x, abs_y) = (x.abs(), y.abs());
        // The nearest meridian is the same for every θ.
        let quadrant_phi = nearest_step(abs_y, abs_x, &PHI_BOUNDS);
        // On it, the nearest θ is that of the direction projected into the meridian's plane.
        let across = abs_x * PHI_COSINES[quadrant_phi] + abs_y * PHI_COSINES[64 - quadrant_phi];
        let quadrant_theta = nearest_step(across, z.abs(), &THETA_BOUNDS);

        let theta = if z < 0.0 { 256 - quadrant_theta } else { quadrant_theta };
        let half_phi = if x < 0.0 { 128 - quadrant_phi } else { quadrant_phi } as u8;
        let phi = if y < 0.0 { half_phi.wrapping_neg() } else { half_phi };
        // At the pole every φ is the same direction, so one of them stands for all.
        if theta == 0 { Self::default() } else { Self { theta: theta.min(255) as u8, phi: phi as i8 } }
    }

    /// The unit vector of the code.
    #[must_use]
    #[inline]
    pub fn decode(self) -> [f32; 3] {
        let [sin_theta, cos_theta] = THETA[usize::from(self.theta)];
        let [sin_phi, cos_phi] = PHI[usize::from(self.phi as u8)];
        [sin_theta * cos_phi, sin_theta * sin_phi, cos_theta]
    }

    /// The code as in the file: θ, then φ.
    #[must_use]
    #[inline]
    pub const fn to_bytes(self) -> [u8; 2] {
        [self.theta, self.phi as u8]
    }

    /// The code from the file: θ, then φ.
    #[must_use]
    #[inline]
    pub const fn from_bytes([theta, phi]: [u8; 2]) -> Self {
        Self { theta, phi: phi as i8 }
    }
}

/// Sine and cosine of every θ.
static THETA: [[f32; 2]; 256] = {
    let mut table = [[0.0; 2]; 256];
    let mut theta = 0;
    while theta < 256 {
        table[theta as usize] = sine_cosine(theta);
        theta += 1;
    }
    table
};

/// Sine and cosine of every φ, by its bits as an unsigned number.
static PHI: [[f32; 2]; 256] = {
    let mut table = [[0.0; 2]; 256];
    let mut phi = 0;
    while phi < 256 {
        table[phi as usize] = sine_cosine(2 * phi);
        phi += 1;
    }
    table
};

/// Sine and cosine of `steps` · π/256, at most a full turn.
const fn sine_cosine(steps: u32) -> [f32; 2] {
    let within = steps % 128;
    let (sine, cosine) = (sine(within, 128), cosine(within, 128));
    let [sine, cosine] = match steps / 128 {
        0 => [sine, cosine],
        1 => [cosine, -sine],
        2 => [-sine, -cosine],
        _ => [-cosine, sine],
    };
    [sine as f32, cosine as f32]
}

/// Cosines of the φ of the first quadrant; backwards, their sines.
static PHI_COSINES: [f64; 65] = {
    let mut table = [0.0; 65];
    let mut phi = 0;
    while phi < 65 {
        table[phi as usize] = cosine(phi, 64);
        phi += 1;
    }
    table
};

static PHI_BOUNDS: [f64; 34] = bounds();
static THETA_BOUNDS: [f64; 66] = bounds();

/// Tangents of the angles half way between neighbouring steps from 0 to π/4, of which there are `LENGTH - 1`.
/// Entry `k` lies below step `k`; below the first and above the last step there is no bound.
const fn bounds<const LENGTH: usize>() -> [f64; LENGTH] {
    let steps = LENGTH - 2;
    let mut table = [f64::INFINITY; LENGTH];
    table[0] = f64::NEG_INFINITY;
    let mut step = 1;
    while step <= steps {
        let (numerator, denominator) = (2 * step as u32 - 1, 4 * steps as u32);
        table[step] = sine(numerator, denominator) / cosine(numerator, denominator);
        step += 1;
    }
    table
}

/// The step nearest to the angle of a right triangle with these legs, in the steps of `bounds` and up to π/2;
/// 0 if both legs are 0. Without branches, as they could not be predicted.
#[inline]
fn nearest_step<const LENGTH: usize>(opposite: f64, adjacent: f64, bounds: &[f64; LENGTH]) -> usize {
    let steps = LENGTH - 2;
    let is_steep = opposite > adjacent;
    let (shorter, longer) = if is_steep { (adjacent, opposite) } else { (opposite, adjacent) };
    // Not a number if both are 0. That is cast to 0 below, and no comparison with it is true.
    let tangent = shorter / longer;
    // atan t ≈ t (π/4 + 0.273 (1 − t)) to within 0.004, less than half a step. The table corrects the rest.
    let angle = tangent * (FRAC_PI_4 + 0.273 * (1.0 - tangent));
    let estimate = (angle * (steps as f64 / FRAC_PI_4) + 0.5) as usize;
    let step =
        estimate - usize::from(tangent < bounds[estimate]) + usize::from(tangent > bounds[estimate + 1]);
    if is_steep { 2 * steps - step } else { step }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::angles::{self, angle, unit};
    use proptest::prelude::*;
    use std::f64::consts::PI;

    fn codes() -> impl Iterator<Item = SphericalNormal> {
        (0..=u16::MAX).map(|bits| SphericalNormal::from_bytes(bits.to_le_bytes()))
    }

    /// The direction of a code by its definition.
    fn direction(code: SphericalNormal) -> [f64; 3] {
        let theta = f64::from(code.theta) / 256.0 * PI;
        let phi = f64::from(code.phi) / 128.0 * PI;
        [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()]
    }

    fn assert_nearest(vector: [f32; 3], directions: &[[f64; 3]]) {
        angles::assert_nearest(vector, direction(SphericalNormal::encode(vector)), directions);
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
        let decode = |theta, phi| SphericalNormal { theta, phi }.decode();
        assert_eq!(decode(0, 0), [0.0, 0.0, 1.0]);
        assert_eq!(decode(128, 0), [1.0, 0.0, 0.0]);
        assert_eq!(decode(128, 64), [0.0, 1.0, 0.0]);
        assert_eq!(decode(128, -128), [-1.0, 0.0, 0.0]);
        assert_eq!(decode(128, -64), [0.0, -1.0, 0.0]);
    }

    #[test]
    fn a_code_is_its_own_nearest() {
        for code in codes() {
            // At the pole every φ is the same direction; the code of it is the one with φ = 0.
            let expected = if code.theta == 0 { SphericalNormal::default() } else { code };
            assert_eq!(SphericalNormal::encode(code.decode()), expected);
        }
    }

    #[test]
    fn the_poles_have_one_code_each() {
        let encode = |z| SphericalNormal::encode([0.0, -0.0, z]);
        assert_eq!(encode(1e-40), SphericalNormal { theta: 0, phi: 0 });
        assert_eq!(encode(-3e38), SphericalNormal { theta: 255, phi: 0 });
        // Less than half a step away from the pole, and more.
        assert_eq!(SphericalNormal::encode([0.0, -0.006, 1.0]), SphericalNormal { theta: 0, phi: 0 });
        assert_eq!(SphericalNormal::encode([0.0, -0.007, 1.0]), SphericalNormal { theta: 1, phi: -64 });
        // The negative pole is out of reach, so its surroundings keep their meridian.
        assert_eq!(SphericalNormal::encode([0.0, -1e-9, -1.0]), SphericalNormal { theta: 255, phi: -64 });
    }

    #[test]
    fn phi_wraps_around() {
        let encode = |y| SphericalNormal::encode([-1.0, y, 0.0]).phi;
        assert_eq!([encode(0.0), encode(-0.0), encode(0.012), encode(-0.012)], [-128; 4]);
        assert_eq!([encode(0.013), encode(-0.013)], [127, -127]);
    }

    #[test]
    fn what_has_no_direction_has_a_code() {
        let zero_or_worse = [0.0, -0.0, f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
        for x in zero_or_worse {
            for y in zero_or_worse {
                for z in zero_or_worse {
                    let code = SphericalNormal::encode([x, y, z]);
                    assert_eq!(code, SphericalNormal::default(), "{x} {y} {z}");
                }
            }
        }
        assert_eq!(SphericalNormal::encode([1.0, 0.0, f32::NAN]), SphericalNormal::default());
    }

    #[test]
    fn half_way_between_codes_the_nearest_is_chosen() {
        let directions: Vec<_> = codes().map(direction).collect();
        // Points just beside the bounds, where a wrong table entry would show.
        for theta in (1..512).step_by(31) {
            for phi in (1..512).step_by(47) {
                for nudge in [-1e-5, 1e-5] {
                    let theta = f64::from(theta) / 512.0 * PI + nudge;
                    let phi = f64::from(phi) / 256.0 * PI + nudge;
                    let vector = [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()];
                    assert_nearest(vector.map(|v| v as f32), &directions);
                }
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(500))]
        #[test]
        fn no_code_is_nearer(vector in prop::array::uniform3(-1.0_f32..1.0), scale in -120_i32..120) {
            prop_assume!(vector.iter().any(|&v| v.abs() > 1e-3));
            thread_local! {
                static DIRECTIONS: Vec<[f64; 3]> = codes().map(direction).collect();
            }
            let scale = 2.0_f32.powi(scale);
            DIRECTIONS.with(|directions| assert_nearest(vector.map(|v| v * scale), directions));
        }
    }

    #[test]
    fn the_worst_angle_is_reached_and_not_exceeded() {
        let worst = f64::from(SphericalNormal::WORST_ANGLE_DEGREES);
        let error = |vector: [f64; 3]| {
            let vector = vector.map(|v| v as f32);
            let decoded = SphericalNormal::encode(vector).decode();
            angle(unit(vector), unit(decoded)).to_degrees()
        };
        let reached = error([1.0, (PI / 256.0).tan(), (PI / 512.0).tan()]);
        assert!(reached <= worst && reached > worst - 1e-4, "{reached}");

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
        assert!(largest <= worst && largest > 0.99 * worst, "{largest}");
    }
}
