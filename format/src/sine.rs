//! Sines of fixed angles, computed by the compiler.
//!
//! The functions of the standard library may differ from platform to platform in the last bit. Sums and products
//! do not, so a file is written and read with the same numbers everywhere.

use std::f64::consts::FRAC_PI_2;

/// Sine of `numerator / denominator` quarter turns, at most one, to within 3·10⁻¹⁶.
pub(crate) const fn sine(numerator: u32, denominator: u32) -> f64 {
    assert!(numerator <= denominator);
    // The series converge fast up to an eighth turn; beyond that, the complement is less.
    if 2 * numerator <= denominator {
        let angle = FRAC_PI_2 * numerator as f64 / denominator as f64;
        angle * series(angle * angle, 3)
    } else {
        let complement = FRAC_PI_2 * (denominator - numerator) as f64 / denominator as f64;
        series(complement * complement, 2)
    }
}

/// Cosine of `numerator / denominator` quarter turns, at most one.
pub(crate) const fn cosine(numerator: u32, denominator: u32) -> f64 {
    sine(denominator - numerator, denominator)
}

/// The Taylor series `1 − x²/(f(f−1)) (1 − x²/((f+2)(f+1)) (1 − …))`: with `f` = 2 that of `cos x`,
/// with `f` = 3 that of `sin x / x`.
const fn series(square: f64, first: u32) -> f64 {
    // The first term left out is less than (π/4)²⁰/20! < 10⁻²⁰.
    const TERMS: u32 = 9;
    let mut sum = 1.0;
    let mut term = TERMS;
    while term > 0 {
        term -= 1;
        let factor = first + 2 * term;
        sum = 1.0 - square / (factor * (factor - 1)) as f64 * sum;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_the_standard_library() {
        for numerator in 0..=1024 {
            let angle = FRAC_PI_2 * f64::from(numerator) / 1024.0;
            assert!((sine(numerator, 1024) - angle.sin()).abs() < 3e-16, "{numerator}");
            assert!((cosine(numerator, 1024) - angle.cos()).abs() < 3e-16, "{numerator}");
        }
    }

    #[test]
    fn the_ends_are_exact() {
        assert_eq!([sine(0, 7), sine(7, 7), cosine(0, 7), cosine(7, 7)], [0.0, 1.0, 1.0, 0.0]);
    }
}
