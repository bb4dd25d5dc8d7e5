//! A better palette: every entry moves to the mean of the colours that are nearest to it (Lloyd 1982).

use crate::nearest_color::NearestColor;
use crate::palette_cut::WeightedColor;
use rayon::prelude::*;
use std::sync::atomic::{AtomicI64, Ordering};

/// Coordinates are summed up in units of 2^-20, so that the order of the threads does not matter. With up to 2^42 voxels
/// sums have less than 63 bits.
const UNITS: f64 = (1 << 20) as f64;

/// One pass over `count` colours, of which `color` gives each; the palette is in Oklab. An entry that is nearest to no
/// colour is left out.
pub(crate) fn refine(
    palette: &[[f32; 3]],
    count: usize,
    color: impl Fn(usize) -> WeightedColor + Sync,
) -> Vec<[f32; 3]> {
    if palette.is_empty() {
        return Vec::new();
    }
    let nearest = NearestColor::new(palette, count);
    // For each entry three coordinates and the number of voxels.
    let sums: Vec<[AtomicI64; 4]> = palette.iter().map(|_| [const { AtomicI64::new(0) }; 4]).collect();
    (0..count).into_par_iter().with_min_len(4096).for_each(|index| {
        let WeightedColor { oklab, voxels } = color(index);
        let sums = &sums[nearest.nearest(oklab)];
        let voxels = voxels as i64;
        for (sum, coordinate) in sums.iter().zip(oklab) {
            sum.fetch_add((f64::from(coordinate) * UNITS).round() as i64 * voxels, Ordering::Relaxed);
        }
        sums[3].fetch_add(voxels, Ordering::Relaxed);
    });
    let mean = |sums: &[AtomicI64; 4]| {
        let [l, a, b, voxels] = [0, 1, 2, 3].map(|index| sums[index].load(Ordering::Relaxed) as f64);
        (voxels > 0.0).then(|| [l, a, b].map(|sum| (sum / (voxels * UNITS)) as f32))
    };
    sums.iter().filter_map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_move_to_the_means_of_their_colors_and_unused_ones_go() {
        let colors = [([0.1, 0.0, 0.0], 3), ([0.2, 0.0, 0.0], 1), ([0.9, 0.1, 0.1], 5)];
        let palette = [[0.0, 0.0, 0.0], [0.3, 0.2, 0.2], [0.8, 0.0, 0.0]];
        let refined =
            refine(&palette, 3, |index| WeightedColor { oklab: colors[index].0, voxels: colors[index].1 });
        assert_eq!(refined.len(), 2);
        for (found, expected) in refined.iter().zip([[0.125, 0.0, 0.0], [0.9, 0.1, 0.1]]) {
            assert!((0..3).all(|axis| (found[axis] - expected[axis]).abs() < 1e-6), "{found:?}");
        }
    }
}
