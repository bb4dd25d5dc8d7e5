//! Circular and exponential functions that round alike on every platform, unlike those of the system's library,
//! so that a generated file has the same bytes everywhere. Angles are in full turns.

use glam::DVec2;

/// Radians in a full turn.
pub const TURN: f64 = std::f64::consts::TAU;

/// Cosine (x) and sine (y) of an angle.
pub fn circle(turns: f64) -> DVec2 {
    let (sine, cosine) = libm::sincos(turns * TURN);
    DVec2::new(cosine, sine)
}

/// Sine of an angle.
pub fn sine(turns: f64) -> f64 {
    libm::sin(turns * TURN)
}

/// Cosine of an angle.
pub fn cosine(turns: f64) -> f64 {
    libm::cos(turns * TURN)
}

/// The angle of a vector in the plane, in `(-0.5, 0.5]` turns.
pub fn angle(vector: DVec2) -> f64 {
    libm::atan2(vector.y, vector.x) / TURN
}

/// `base` to the power of `exponent`, for a base of zero or more.
pub fn power(base: f64, exponent: f64) -> f64 {
    libm::pow(base, exponent)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_angle_survives_the_circle() {
        for step in -49..=50 {
            let turns = f64::from(step) / 100.0;
            assert!((angle(circle(turns)) - turns).abs() < 1e-12, "{turns}");
            assert!((sine(turns) - (turns * TURN).sin()).abs() < 1e-12);
            assert!((cosine(turns) - (turns * TURN).cos()).abs() < 1e-12);
        }
    }
}
