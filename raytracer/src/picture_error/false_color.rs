//! Differences made visible.

use std::f64::consts::TAU;

/// A picture of values from 0, black, to 1, white, over violet, red, orange and yellow: red, green, blue and opacity,
/// opaque. `size` is columns and rows; pixels that have no value are transparent.
///
/// The colours are on a helix around the diagonal of grey, so brightness grows as evenly as the values (D. A. Green, "A
/// colour scheme for the display of astronomical intensity images", 2011).
#[must_use]
pub fn difference_picture(per_pixel: &[f32], size: [u32; 2]) -> Vec<[u8; 4]> {
    let area = size[0] as usize * size[1] as usize;
    let color = |place: usize| per_pixel.get(place).map_or([0; 4], |value| helix(f64::from(*value)));
    (0..area).map(color).collect()
}

/// Where the helix begins, in thirds of a turn from blue over red to green, how far it turns, and how colourful it is.
const START: f64 = 0.35;
const TURNS: f64 = 0.75;
const SATURATION: f64 = 1.1;

fn helix(value: f64) -> [u8; 4] {
    let value = if value > 0.0 { value.min(1.0) } else { 0.0 };
    let (sine, cosine) = (TAU * (START / 3.0 + TURNS * value)).sin_cos();
    let reach = SATURATION * value * (1.0 - value) / 2.0;
    // Two directions across grey along which perceived brightness does not change.
    let [red, green, blue] = [(-0.14861, 1.78277), (-0.29227, -0.90649), (1.97294, 0.0)]
        .map(|(a, b)| value + reach * (a * cosine + b * sine))
        .map(|part| (part.clamp(0.0, 1.0) * 255.0).round() as u8);
    [red, green, blue, 255]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brighter_means_more() {
        let values: Vec<f32> = (0..=100).map(|step| step as f32 / 100.0).collect();
        let picture = difference_picture(&values, [101, 1]);
        assert_eq!((picture[0], picture[100]), ([0, 0, 0, 255], [255; 4]));
        // Luma, by the weights that the helix is made for.
        let luma = |[red, green, blue, _]: [u8; 4]| {
            0.30 * f64::from(red) + 0.59 * f64::from(green) + 0.11 * f64::from(blue)
        };
        for (step, pair) in picture.windows(2).enumerate() {
            let gain = luma(pair[1]) - luma(pair[0]);
            assert!((0.5..5.0).contains(&gain), "{gain} at {step}: {pair:?}");
        }
    }

    #[test]
    fn odd_values_and_sizes() {
        let picture = difference_picture(&[f32::NAN, -1.0, 7.0], [2, 2]);
        assert_eq!(picture, [[0, 0, 0, 255], [0, 0, 0, 255], [255; 4], [0; 4]]);
        assert_eq!(difference_picture(&[0.5; 5], [1, 2]).len(), 2);
    }
}
