//! Colours: displayed values and amounts of light.

use std::sync::LazyLock;

/// An amount of red, green and blue light; 1 is white on the display.
pub type Light3 = glam::Vec3;

/// The amount of light that a displayed value of the sRGB standard (IEC 61966-2-1) stands for.
#[must_use]
pub fn to_linear(displayed: u8) -> f32 {
    let value = f64::from(displayed) / 255.0;
    let linear = if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) };
    linear as f32
}

/// The sRGB value to display for an amount of light, rounded to the nearest; amounts beyond the display are clipped.
#[must_use]
pub fn to_displayed(linear: f32) -> u8 {
    if linear.is_nan() || linear <= 0.0 {
        return 0;
    }
    let linear = f64::from(linear.min(1.0));
    let value = if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    (value * 255.0 + 0.5) as u8
}

/// [`to_displayed`] by looking up the thresholds between neighbouring values.
#[derive(Debug, Clone)]
pub(crate) struct Display {
    /// The least amount of light that is displayed as each value.
    thresholds: [f32; 256],
    /// A value to begin at, for each of as many equal steps of light.
    starts: [u8; STARTS],
}

const STARTS: usize = 1 << 12;

impl Display {
    /// One for all: it takes longer to make than to use for a small picture.
    pub fn shared() -> &'static Self {
        static DISPLAY: LazyLock<Display> = LazyLock::new(Display::new);
        &DISPLAY
    }

    fn new() -> Self {
        let mut thresholds = [0.0; 256];
        for value in 1..=255u8 {
            // Halving an interval of positive floats by their bits ends at the first that reaches the value.
            let (mut below, mut reaches) = (0.0f32.to_bits(), 1.0f32.to_bits());
            while reaches - below > 1 {
                let middle = below + (reaches - below) / 2;
                if to_displayed(f32::from_bits(middle)) >= value { reaches = middle } else { below = middle }
            }
            thresholds[usize::from(value)] = f32::from_bits(reaches);
        }
        let starts = std::array::from_fn(|step| to_displayed(step as f32 / STARTS as f32));
        Self { thresholds, starts }
    }

    /// As [`to_displayed`].
    pub fn value(&self, linear: f32) -> u8 {
        if linear.is_nan() || linear <= 0.0 {
            return 0;
        }
        let step = ((linear.min(1.0) * STARTS as f32) as usize).min(STARTS - 1);
        let mut value = self.starts[step];
        while value < 255 && linear >= self.thresholds[usize::from(value) + 1] {
            value += 1;
        }
        value
    }

    /// A pixel, opaque.
    pub fn pixel(&self, light: Light3) -> [u8; 4] {
        [self.value(light.x), self.value(light.y), self.value(light.z), 255]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_comes_back() {
        for value in 0..=255 {
            assert_eq!(to_displayed(to_linear(value)), value);
        }
    }

    #[test]
    fn the_table_agrees_with_the_formula() {
        let display = Display::new();
        for step in -10..20_000 {
            let linear = step as f32 / 18_000.0;
            assert_eq!(display.value(linear), to_displayed(linear), "{linear}");
        }
        for odd in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -0.0, f32::MIN_POSITIVE] {
            assert_eq!(display.value(odd), to_displayed(odd), "{odd}");
        }
    }
}
