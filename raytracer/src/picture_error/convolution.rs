//! Separable filters. Beyond the edges of a picture the outermost pixels go on.

use rayon::prelude::*;

/// A plane of numbers, row by row, filtered with `across` along its rows and `down` along its columns. Filters have an odd
/// number of weights, the middle one for the pixel itself; `width` is not zero.
pub(super) fn filtered(plane: &[f64], width: usize, across: &[f64], down: &[f64]) -> Vec<f64> {
    let height = plane.len() / width;
    let mut rows = vec![0.0; plane.len()];
    rows.par_chunks_mut(width).zip(plane.par_chunks(width)).for_each(|(out, row)| {
        let reach = across.len() / 2;
        let mut padded = vec![row[0]; reach];
        padded.extend_from_slice(row);
        padded.resize(width + 2 * reach, row[width - 1]);
        for (shift, weight) in across.iter().enumerate() {
            add_weighted(out, &padded[shift..], *weight);
        }
    });
    let mut columns = vec![0.0; plane.len()];
    columns.par_chunks_mut(width).enumerate().for_each(|(y, out)| {
        let reach = down.len() / 2;
        for (shift, weight) in down.iter().enumerate() {
            let row = (y + shift).saturating_sub(reach).min(height - 1);
            add_weighted(out, &rows[row * width..], *weight);
        }
    });
    columns
}

fn add_weighted(sums: &mut [f64], values: &[f64], weight: f64) {
    for (sum, value) in sums.iter_mut().zip(values) {
        *sum += weight * value;
    }
}

/// A filter of a function of the distance from the pixel, up to `reach` pixels on each side.
pub(super) fn filter_of(reach: usize, weight: impl Fn(f64) -> f64) -> Vec<f64> {
    (0..=2 * reach).map(|place| weight(place as f64 - reach as f64)).collect()
}

/// A filter of which the weights sum up to 1.
pub(super) fn normalized(filter: &[f64]) -> Vec<f64> {
    let sum: f64 = filter.iter().sum();
    filter.iter().map(|weight| weight / sum).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_and_columns_are_filtered_up_to_the_edges() {
        // An impulse spreads as the filter does, turned around.
        let mut plane = vec![0.0; 7 * 5];
        plane[2 * 7 + 3] = 1.0;
        let out = filtered(&plane, 7, &[1.0, 2.0, 3.0], &[10.0, 20.0, 30.0]);
        assert_eq!(&out[7..14], [0.0, 0.0, 90.0, 60.0, 30.0, 0.0, 0.0]);
        assert_eq!(out[2 * 7 + 3], 40.0);
        assert_eq!(&out[..7], [0.0; 7]);
        // A picture of one colour stays so, also where the filter is larger than the picture.
        let gaussian = normalized(&filter_of(9, |x| (-x * x / 8.0).exp()));
        for (width, height) in [(1, 1), (3, 2), (1, 30)] {
            let out = filtered(&vec![2.5; width * height], width, &gaussian, &gaussian);
            assert!(out.iter().all(|value| (value - 2.5).abs() < 1e-12), "{width} {height}");
        }
    }
}
