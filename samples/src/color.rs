//! Colours, their mixtures and gradients.

use glam::DVec3;

/// Red, green and blue as displayed (sRGB), each from 0 to 1.
pub type Color = DVec3;

/// The colour that leaves a material's own colour as it is.
pub const WHITE: Color = DVec3::ONE;

/// A colour written as on the web: `0xRRGGBB`.
pub fn hex(rgb: u32) -> Color {
    let channel = |shift: u32| f64::from(rgb >> shift & 0xff) / 255.0;
    DVec3::new(channel(16), channel(8), channel(0))
}

/// From `first` at 0 to `second` at 1, constant outside.
pub fn mix(first: Color, second: Color, amount: f64) -> Color {
    first.lerp(second, amount.clamp(0.0, 1.0))
}

/// The colour at `position` of a gradient through `stops`, each a position and a web colour, in rising order.
pub fn gradient(stops: &[(f64, u32)], position: f64) -> Color {
    let after = stops.partition_point(|stop| stop.0 <= position);
    match (after.checked_sub(1).and_then(|before| stops.get(before)), stops.get(after)) {
        (Some(before), Some(next)) => {
            mix(hex(before.1), hex(next.1), (position - before.0) / (next.0 - before.0))
        }
        (Some(only), None) | (None, Some(only)) => hex(only.1),
        (None, None) => WHITE,
    }
}

/// 0 up to `low`, 1 from `high` on, and a smooth curve between (3t² − 2t³).
pub fn smooth_step(low: f64, high: f64, position: f64) -> f64 {
    let t = ((position - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gradient_meets_its_stops_and_is_constant_outside() {
        let stops = [(0.0, 0x000000), (0.5, 0xff0000), (1.0, 0xffffff)];
        assert_eq!(gradient(&stops, -1.0), hex(0x000000));
        assert_eq!(gradient(&stops, 0.5), hex(0xff0000));
        assert_eq!(gradient(&stops, 0.25), DVec3::new(0.5, 0.0, 0.0));
        assert_eq!(gradient(&stops, 0.75), DVec3::new(1.0, 0.5, 0.5));
        assert_eq!(gradient(&stops, 7.0), WHITE);
    }
}
