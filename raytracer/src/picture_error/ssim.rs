//! Structural similarity (Z. Wang, A. C. Bovik, H. R. Sheikh, E. P. Simoncelli, "Image quality assessment: from error
//! visibility to structural similarity", 2004).

use super::are_of_size;
use super::convolution::{filter_of, filtered, normalized};

/// Pixels on each side of a window's middle, and the standard deviation of its weights.
const REACH: usize = 5;
const DEVIATION: f64 = 1.5;

/// Keep quotients of small numbers in bounds: (K₁ L)² and (K₂ L)², where L is the largest value.
const C1: f64 = (0.01 * 255.0) * (0.01 * 255.0);
const C2: f64 = (0.03 * 255.0) * (0.03 * 255.0);

/// The mean structural similarity of the luma of two pictures: 1 if they are equal, 0 if they have nothing in common, down
/// to −1. `size` is columns and rows.
///
/// Windows are of 11 × 11 pixels, weighted by a Gaussian curve, and the mean is that of all windows that lie in the
/// picture. Along an axis on which the picture is smaller, the windows are those about all of its pixels, and the outermost
/// ones go on beyond its edges.
///
/// Not a number if the pictures are not of that size, or have no pixels.
#[must_use]
pub fn ssim(a: &[[u8; 4]], b: &[[u8; 4]], size: [u32; 2]) -> f64 {
    if !are_of_size(a, b, size) || a.is_empty() {
        return f64::NAN;
    }
    let width = size[0] as usize;
    let window = normalized(&filter_of(REACH, |x| (-x * x / (2.0 * DEVIATION * DEVIATION)).exp()));
    let mean = |plane: &[f64]| filtered(plane, width, &window, &window);
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).collect::<Vec<_>>();
    let [a, b] = [a, b].map(|picture| picture.iter().map(luma).collect::<Vec<_>>());
    let (mean_a, mean_b) = (mean(&a), mean(&b));
    let (squares_a, squares_b, products) =
        (mean(&product(&a, &a)), mean(&product(&b, &b)), mean(&product(&a, &b)));

    let at = |place: usize| {
        let (a, b) = (mean_a[place], mean_b[place]);
        let (variance_a, variance_b) = (squares_a[place] - a * a, squares_b[place] - b * b);
        let covariance = products[place] - a * b;
        (2.0 * a * b + C1) * (2.0 * covariance + C2) / ((a * a + b * b + C1) * (variance_a + variance_b + C2))
    };
    let [columns, rows] = size.map(|size| {
        let size = size as usize;
        if size > 2 * REACH { REACH..size - REACH } else { 0..size }
    });
    let count = columns.len() * rows.len();
    let sum: f64 = rows.flat_map(|y| columns.clone().map(move |x| y * width + x)).map(at).sum();
    sum / count as f64
}

/// Brightness of a displayed colour (luma of ITU-R BT.601, as the authors' own program takes it).
fn luma([red, green, blue, _]: &[u8; 4]) -> f64 {
    0.299 * f64::from(*red) + 0.587 * f64::from(*green) + 0.114 * f64::from(*blue)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture_error::test_pictures::{SIZE, checkers, gradients, moved, noisy};

    #[test]
    fn equal_pictures_are_alike() {
        for picture in [gradients(), checkers()] {
            assert!((ssim(&picture, &picture, SIZE) - 1.0).abs() < 1e-9);
        }
        assert!(ssim(&gradients(), &checkers(), [64, 47]).is_nan());
    }

    /// Of pictures of one colour the variances vanish, and what is left is a quotient of means.
    #[test]
    fn uniform_pictures_of_any_size() {
        let expected = (2.0 * 50.0 * 200.0 + C1) / (50.0 * 50.0 + 200.0 * 200.0 + C1);
        for size in [[1, 1], [3, 20], [40, 11], [10, 10]] {
            let area = (size[0] * size[1]) as usize;
            let found = ssim(&vec![[50, 50, 50, 255]; area], &vec![[200, 200, 200, 255]; area], size);
            assert!((found - expected).abs() < 1e-9, "{found} of {size:?}");
        }
    }

    /// By scikit-image 0.26, of the same pictures and the same luma: `structural_similarity(a, b, gaussian_weights=True,
    /// sigma=1.5, use_sample_covariance=False, data_range=255)`.
    #[test]
    fn agrees_with_scikit_image() {
        for (a, b, expected) in [
            (gradients(), moved(), 0.827_459_111_6),
            (checkers(), noisy(), 0.982_767_946_8),
            (gradients(), checkers(), 0.025_731_805_4),
        ] {
            let found = ssim(&a, &b, SIZE);
            assert!((found - expected).abs() < 1e-6, "{found} instead of {expected}");
            assert!((ssim(&b, &a, SIZE) - found).abs() < 1e-12);
        }
    }
}
