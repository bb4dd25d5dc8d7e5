//! Between displayed colours (sRGB) and light, and a space in which distances are what an eye sees.

use std::sync::LazyLock;

/// Linear light for each of the 256 values of a displayed channel, scaled to 16 bits.
static LINEAR: LazyLock<[u16; 256]> = LazyLock::new(|| {
    std::array::from_fn(|value| (linear_light(value as f64 / 255.0) * 65_535.0).round() as u16)
});

/// The displayed value for each linear light of 16 bits.
static DISPLAYED: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let mut table = Vec::with_capacity(1 << 16);
    for value in 0..=u8::MAX {
        // A value is displayed up to the light half way to the next one.
        let end = (linear_light((f64::from(value) + 0.5) / 255.0) * 65_535.0).min(65_535.0) as usize;
        table.resize(end + 1, value);
    }
    table
});

/// The inverse of the sRGB transfer function (IEC 61966-2-1), for a displayed value of 0 to 1.
fn linear_light(displayed: f64) -> f64 {
    if displayed <= 0.04045 { displayed / 12.92 } else { ((displayed + 0.055) / 1.055).powf(2.4) }
}

/// A displayed colour as 16-bit linear light. Each displayed colour has its own.
pub(crate) fn to_linear(color: [u8; 3]) -> [u16; 3] {
    color.map(|channel| LINEAR[usize::from(channel)])
}

/// The displayed colour nearest to a 16-bit linear light.
pub(crate) fn to_displayed(light: [u16; 3]) -> [u8; 3] {
    light.map(|channel| DISPLAYED[usize::from(channel)])
}

/// A colour given as fractions of 1 in the displayed space, rounded to 8 bits.
pub(crate) fn to_bytes(color: [f64; 3]) -> [u8; 3] {
    // The conversion to an integer saturates, and takes NaN to 0.
    color.map(|channel| (255.0 * channel).round() as u8)
}

/// Oklab coordinates of a displayed colour.
pub(crate) fn to_oklab(color: [u8; 3]) -> [f32; 3] {
    light_to_oklab(to_linear(color).map(|channel| f32::from(channel) / 65_535.0))
}

/// Oklab coordinates of linear light of 0 to 1 (Ottosson 2020): lightness, green to red, blue to yellow.
pub(crate) fn light_to_oklab([red, green, blue]: [f32; 3]) -> [f32; 3] {
    let long = cube_root(0.412_221_47 * red + 0.536_332_54 * green + 0.051_445_995 * blue);
    let medium = cube_root(0.211_903_5 * red + 0.680_699_5 * green + 0.107_396_96 * blue);
    let short = cube_root(0.088_302_46 * red + 0.281_718_85 * green + 0.629_978_7 * blue);
    [
        0.210_454_26 * long + 0.793_617_8 * medium - 0.004_072_047 * short,
        1.977_998_5 * long - 2.428_592_2 * medium + 0.450_593_7 * short,
        0.025_904_037 * long + 0.782_771_77 * medium - 0.808_675_77 * short,
    ]
}

/// The displayed colour for Oklab coordinates, with the channels that cannot be displayed cut off.
pub(crate) fn oklab_to_displayed([lightness, a, b]: [f32; 3]) -> [u8; 3] {
    let [long, medium, short] = [
        lightness + 0.396_337_78 * a + 0.215_803_76 * b,
        lightness - 0.105_561_346 * a - 0.063_854_17 * b,
        lightness - 0.089_484_18 * a - 1.291_485_5 * b,
    ]
    .map(|root| root * root * root);
    let light = [
        4.076_741_7 * long - 3.307_711_6 * medium + 0.230_969_94 * short,
        -1.268_438 * long + 2.609_757_4 * medium - 0.341_319_38 * short,
        -0.004_196_086_3 * long - 0.703_418_6 * medium + 1.707_614_7 * short,
    ];
    // The conversion to an integer saturates.
    to_displayed(light.map(|channel| (channel * 65_535.0).round() as u16))
}

/// The cube root of a number that is not negative, the same on every machine.
fn cube_root(x: f32) -> f32 {
    // A third of the exponent is a guess within 4 %; each step of Halley's method triples the digits that are
    // right, so that two leave an error of 10^-13.
    let guess = f32::from_bits(x.to_bits() / 3 + 0x2a51_37a0);
    let halley = |root: f64| {
        let (cube, x) = (root * root * root, f64::from(x));
        root * (cube + 2.0 * x) / (2.0 * cube + x)
    };
    halley(halley(f64::from(guess))) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_displayed_value_survives_the_way_through_light() {
        for value in 0..=255 {
            assert_eq!(to_displayed(to_linear([value; 3])), [value; 3]);
        }
        assert_eq!(DISPLAYED.len(), 1 << 16);
    }

    #[test]
    fn the_mean_of_black_and_white_is_half_the_light() {
        // 50 % of the light is displayed as 188, not as 128.
        assert_eq!(to_displayed([32_768; 3]), [188; 3]);
    }

    #[test]
    fn oklab_of_known_colors() {
        // Values published with the definition of the space, to three digits.
        let close = |color, expected: [f32; 3]| {
            let oklab = to_oklab(color);
            assert!((0..3).all(|k| (oklab[k] - expected[k]).abs() < 1e-3), "{color:?}: {oklab:?}");
        };
        close([255, 255, 255], [1.0, 0.0, 0.0]);
        close([255, 0, 0], [0.628, 0.225, 0.126]);
        close([0, 255, 0], [0.866, -0.234, 0.179]);
        close([0, 0, 255], [0.452, -0.032, -0.312]);
    }

    #[test]
    fn displayed_colors_survive_the_way_through_oklab() {
        for k in 0..(1u32 << 24) / 997 {
            let code = k * 997;
            let color = [code >> 16, code >> 8, code].map(|channel| channel as u8);
            assert_eq!(oklab_to_displayed(to_oklab(color)), color);
        }
    }

    #[test]
    fn cube_roots_are_rounded_right() {
        for k in 0..=10_000u16 {
            let root = f32::from(k) / 10_000.0;
            let found = cube_root(root * root * root);
            assert!((found - root).abs() <= 2.0 * f32::EPSILON * root.max(1e-6), "{found} {root}");
        }
    }

    #[test]
    fn fractions_are_rounded_and_clamped() {
        assert_eq!(to_bytes([0.5, -1.0, 2.0]), [128, 0, 255]);
        assert_eq!(to_bytes([f64::NAN, 0.1, 1.0]), [0, 26, 255]);
    }
}
