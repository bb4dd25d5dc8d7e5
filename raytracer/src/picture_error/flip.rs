//! The difference that an observer notices who alternates between two pictures: LDR-FLIP (P. Andersson, J. Nilsson, T.
//! Akenine-Möller, M. Oskarsson, K. Åström, M. D. Fairchild, "FLIP: A Difference Evaluator for Alternating Images", 2020).
//!
//! Two ways lead to it. Colours are blurred as far as the eye does not tell them apart at that distance, and compared in a
//! space in which distances are what one sees. Edges and points of the pictures as they are, are compared apart, and make
//! the difference of colours larger.
//!
//! All filters are Gaussian curves or derivatives of them, so they are applied to rows and columns in turn.

use super::are_of_size;
use super::convolution::{filter_of, filtered, normalized};
use glam::{DMat3, DVec3};
use rayon::prelude::*;
use std::f64::consts::PI;

/// How many pixels an observer sees in a degree: a display 0.7 m wide with 3840 pixels, from 0.7 m away.
pub const PIXELS_PER_DEGREE: f64 = 3840.0 * PI / 180.0;

/// The differences of two pictures.
#[derive(Debug, Clone, PartialEq)]
pub struct FlipMap {
    /// Of each pixel, from 0 to 1.
    pub per_pixel: Vec<f32>,
    /// Their mean.
    pub mean: f64,
}

/// The difference that is noticed between two pictures of `size` columns and rows, seen at [`PIXELS_PER_DEGREE`].
///
/// Nothing for each pixel, and a mean that is not a number, if the pictures are not of that size or have no pixels.
#[must_use]
pub fn flip(a: &[[u8; 4]], b: &[[u8; 4]], size: [u32; 2]) -> FlipMap {
    if !are_of_size(a, b, size) || a.is_empty() {
        return FlipMap { per_pixel: Vec::new(), mean: f64::NAN };
    }
    let width = size[0] as usize;
    let space = Space::new();
    let [a, b] = [a, b].map(|picture| Seen::new(picture, width, &space));
    let largest = hyab(space.hunt(DVec3::Y), space.hunt(DVec3::Z)).powf(COLOR_EXPONENT);
    let differences = (0..a.colors.len()).into_par_iter().map(|place| {
        let color = redistributed(hyab(a.colors[place], b.colors[place]).powf(COLOR_EXPONENT), largest);
        let edge = (a.edges[place] - b.edges[place]).abs();
        let point = (a.points[place] - b.points[place]).abs();
        let feature = (edge.max(point) / 2f64.sqrt()).powf(FEATURE_EXPONENT);
        color.powf(1.0 - feature) as f32
    });
    let per_pixel: Vec<f32> = differences.collect();
    let mean = per_pixel.iter().copied().map(f64::from).sum::<f64>() / per_pixel.len() as f64;
    FlipMap { per_pixel, mean }
}

/// Exponent of differences of colours (q_c), and of features (q_f).
const COLOR_EXPONENT: f64 = 0.7;
const FEATURE_EXPONENT: f64 = 0.5;

/// Up to this share of the largest difference of colours (p_c), differences are stretched to this share of the range (p_t).
const USUAL: f64 = 0.4;
const STRETCHED: f64 = 0.95;

/// Width of the filter that finds edges and points, in degrees (w): that to which the eye is most sensitive.
const FEATURE_WIDTH: f64 = 0.082;

/// A contrast sensitivity: a sum of terms `a exp(−b f²)` over the frequency `f` in cycles per degree, given as `[a, b]`.
type Sensitivity = &'static [[f64; 2]];

/// Of brightness, red to green, and blue to yellow (G. M. Johnson, M. D. Fairchild, 2001, as fitted by the authors).
const SENSITIVITIES: [Sensitivity; 3] = [&[[1.0, 0.0047]], &[[1.0, 0.0053]], &[[34.1, 0.04], [13.5, 0.025]]];

/// The largest `b` of them, by which all filters are cut off.
const WIDEST: f64 = 0.04;

/// A picture, made ready to be compared.
struct Seen {
    /// Blurred as by the eye, in Hunt-adjusted CIELAB.
    colors: Vec<DVec3>,
    /// How strong the edges and the points are.
    edges: Vec<f64>,
    points: Vec<f64>,
}

impl Seen {
    fn new(picture: &[[u8; 4]], width: usize, space: &Space) -> Self {
        let linear: [f64; 256] = std::array::from_fn(|value| f64::from(crate::to_linear(value as u8)));
        let opponent: Vec<DVec3> = picture
            .par_iter()
            .map(|[red, green, blue, _]| {
                space.opponent(DVec3::from_array([red, green, blue].map(|value| linear[usize::from(*value)])))
            })
            .collect();
        let plane = |axis: usize| opponent.iter().map(|color| color[axis]).collect::<Vec<_>>();

        let [y, x, z] = [0, 1, 2].map(|axis| blurred(&plane(axis), width, SENSITIVITIES[axis]));
        let color = |place: usize| space.hunt(space.light(DVec3::new(y[place], x[place], z[place])));
        let colors = (0..picture.len()).into_par_iter().map(color).collect();

        let brightness: Vec<f64> = opponent.iter().map(|color| (color.x + 16.0) / 116.0).collect();
        let [edges, points] = features(&brightness, width);
        Self { colors, edges, points }
    }
}

/// A plane as the eye sees it: convolved with the Fourier transform of its sensitivity, `Σ a √(π/b) exp(−π² r²/b)`, at `r`
/// degrees.
fn blurred(plane: &[f64], width: usize, sensitivity: Sensitivity) -> Vec<f64> {
    // Three standard deviations of the widest.
    let reach = (3.0 * (WIDEST / (2.0 * PI * PI)).sqrt() * PIXELS_PER_DEGREE).ceil() as usize;
    let terms: Vec<(f64, Vec<f64>)> = sensitivity
        .iter()
        .map(|&[a, b]| {
            let filter = filter_of(reach, |x| (-(PI * x / PIXELS_PER_DEGREE).powi(2) / b).exp());
            // A sum over both axes is the square of one.
            let sum: f64 = filter.iter().sum();
            (a * (PI / b).sqrt() * sum * sum, normalized(&filter))
        })
        .collect();
    let whole: f64 = terms.iter().map(|(weight, _)| weight).sum();
    let mut sums = vec![0.0; plane.len()];
    for (weight, filter) in &terms {
        let part = filtered(plane, width, filter, filter);
        sums.iter_mut().zip(part).for_each(|(sum, value)| *sum += weight / whole * value);
    }
    sums
}

/// How strong edges and points are: lengths of the first and of the second derivatives of the blurred plane.
fn features(plane: &[f64], width: usize) -> [Vec<f64>; 2] {
    let deviation = 0.5 * FEATURE_WIDTH * PIXELS_PER_DEGREE;
    let reach = (3.0 * deviation).ceil() as usize;
    let gaussian = |x: f64| (-x * x / (2.0 * deviation * deviation)).exp();
    let smooth = normalized(&filter_of(reach, gaussian));
    let first = balanced(&filter_of(reach, |x| -x * gaussian(x)));
    let second = balanced(&filter_of(reach, |x| (x * x / (deviation * deviation) - 1.0) * gaussian(x)));
    [first, second].map(|derivative| {
        let across = filtered(plane, width, &derivative, &smooth);
        let down = filtered(plane, width, &smooth, &derivative);
        across.iter().zip(&down).map(|(across, down)| across.hypot(*down)).collect()
    })
}

/// A filter of which the positive weights sum up to 1 and the negative ones to −1.
fn balanced(filter: &[f64]) -> Vec<f64> {
    let above: f64 = filter.iter().filter(|weight| **weight > 0.0).sum();
    let below: f64 = -filter.iter().filter(|weight| **weight < 0.0).sum::<f64>();
    filter.iter().map(|&weight| if weight > 0.0 { weight / above } else { weight / below }).collect()
}

/// Small differences of colours take the larger part of the range.
fn redistributed(difference: f64, largest: f64) -> f64 {
    let usual = USUAL * largest;
    if difference < usual {
        STRETCHED * difference / usual
    } else {
        STRETCHED + (1.0 - STRETCHED) * (difference - usual) / (largest - usual)
    }
}

/// Distance of two colours in CIELAB: that of lightness and that of chromaticity, added (S. Abasi, M. A. Tehran, M. D.
/// Fairchild, "Distance metrics for very large color differences", 2020).
fn hyab(a: DVec3, b: DVec3) -> f64 {
    let difference = a - b;
    difference.x.abs() + difference.y.hypot(difference.z)
}

/// The spaces of colours, all relative to the white of the display.
struct Space {
    /// From linear red, green and blue to X, Y, Z over those of white, and back.
    to_xyz: DMat3,
    to_light: DMat3,
}

impl Space {
    fn new() -> Self {
        // Of the primaries and the white point of sRGB (IEC 61966-2-1); a column is a primary.
        let primaries = DMat3::from_cols(
            DVec3::new(0.412_390_8, 0.212_639_0, 0.019_330_8),
            DVec3::new(0.357_584_3, 0.715_168_7, 0.119_194_8),
            DVec3::new(0.180_480_8, 0.072_192_3, 0.950_532_2),
        );
        let to_xyz = DMat3::from_diagonal((primaries * DVec3::ONE).recip()) * primaries;
        Self { to_xyz, to_light: to_xyz.inverse() }
    }

    /// Brightness, red over green, blue over yellow (YyCxCz: T. W. Kolpatzik, C. A. Bouman, 1998) of linear red, green, blue.
    fn opponent(&self, light: DVec3) -> DVec3 {
        let DVec3 { x, y, z } = self.to_xyz * light;
        DVec3::new(116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z))
    }

    /// Linear red, green, blue that can be displayed, of [`Space::opponent`].
    fn light(&self, opponent: DVec3) -> DVec3 {
        let y = (opponent.x + 16.0) / 116.0;
        let xyz = DVec3::new(y + opponent.y / 500.0, y, y - opponent.z / 200.0);
        (self.to_light * xyz).clamp(DVec3::ZERO, DVec3::ONE)
    }

    /// CIELAB, with less chromaticity the darker a colour is (R. W. G. Hunt, 1952), of linear red, green, blue.
    fn hunt(&self, light: DVec3) -> DVec3 {
        const EDGE: f64 = 6.0 / 29.0;
        let root = |t: f64| {
            if t > EDGE * EDGE * EDGE { t.cbrt() } else { t / (3.0 * EDGE * EDGE) + 4.0 / 29.0 }
        };
        let [x, y, z] = (self.to_xyz * light).to_array().map(root);
        let lightness = 116.0 * y - 16.0;
        DVec3::new(lightness, 0.01 * lightness * 500.0 * (x - y), 0.01 * lightness * 200.0 * (y - z))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture_error::test_pictures::{SIZE, checkers, gradients, moved, noisy};

    fn uniform(color: [u8; 3]) -> Vec<[u8; 4]> {
        vec![[color[0], color[1], color[2], 255]; (SIZE[0] * SIZE[1]) as usize]
    }

    #[test]
    fn equal_pictures_do_not_differ() {
        for picture in [gradients(), noisy()] {
            let map = flip(&picture, &picture, SIZE);
            assert_eq!((map.mean, map.per_pixel.len()), (0.0, picture.len()));
        }
        assert!(flip(&noisy(), &noisy(), [64, 47]).mean.is_nan());
        assert!(flip(&[], &[], [0, 7]).mean.is_nan());
    }

    /// Without features, what is left is the distance of two colours. Of black and white it is 100, that of their lightness;
    /// blue and green are as far apart as two can be.
    #[test]
    fn uniform_pictures() {
        let [green, blue] = [[0, 255, 0], [0, 0, 255]];
        let mean = |a, b| flip(&uniform(a), &uniform(b), SIZE).mean;
        assert!((mean(green, blue) - 1.0).abs() < 1e-6);
        // Lightness, a and b of the two as tables have them (Lindbloom, D65), adjusted by hand.
        let lab = |[l, a, b]: [f64; 3]| DVec3::new(l, 0.01 * l * a, 0.01 * l * b);
        let [green, blue] = [lab([87.735, -86.183, 83.180]), lab([32.297, 79.188, -107.860])];
        let largest = ((green.x - blue.x).abs() + (green.y - blue.y).hypot(green.z - blue.z)).powf(0.7);
        let expected = 0.95 + 0.05 * (100f64.powf(0.7) - 0.4 * largest) / (0.6 * largest);
        let found = mean([0; 3], [255; 3]);
        assert!((found - expected).abs() < 1e-4, "{found} instead of {expected}");
    }

    /// By the authors' own program, flip-evaluator 1.7 from PyPI, of the same pictures as PNG: the mean, and the pixels of
    /// three places, given by column and row.
    #[test]
    fn agrees_with_the_authors_program() {
        for (a, b, mean, places) in [
            (gradients(), moved(), 0.254_963, [0.041_789, 0.986_245, 0.138_997]),
            (checkers(), noisy(), 0.223_338, [0.285_139, 0.198_922, 0.228_630]),
            (gradients(), checkers(), 0.819_723, [0.722_762, 0.596_447, 0.739_831]),
        ] {
            let map = flip(&a, &b, SIZE);
            assert!((map.mean - mean).abs() < 2e-4, "{} instead of {mean}", map.mean);
            for ([x, y], expected) in [[0, 0], [25, 17], [40, 31]].into_iter().zip(places) {
                let found = map.per_pixel[y * SIZE[0] as usize + x];
                assert!((f64::from(found) - expected).abs() < 1e-3, "{found} instead of {expected}");
            }
            let other = flip(&b, &a, SIZE);
            assert!((other.mean - map.mean).abs() < 1e-12);
        }
    }
}
