//! The colours of the voxels into a palette.

use crate::ConvertError;
use crate::color_census::ColorCensus;
use crate::color_space::to_oklab;
use crate::palette_merge::merge_colors;
use octvox_cli::Progress;
use octvox_format::Palette;
use rayon::prelude::*;

/// A palette, and the way to it from the colours of the voxels.
pub(crate) struct PaletteMap {
    palette: Palette,
    /// For each colour of the census, its index in the palette.
    indices: Vec<u16>,
    error: f64,
}

impl PaletteMap {
    /// Every colour gets its own entry if there are no more than `size`; else the most similar ones are merged.
    pub(crate) fn new(census: &ColorCensus, size: usize, progress: &Progress) -> Result<Self, ConvertError> {
        let (colors, entries) = if census.colors.len() <= size {
            (census.colors.clone(), (0..census.colors.len()).collect())
        } else {
            merge_colors(&census.colors, &census.counts, size, progress)
        };
        let error = root_mean_square(census, |color| colors[entries[color]]);
        // Entries count from 0, indices from 1; the palette has at most 32,767.
        let indices = entries.iter().map(|&entry| entry as u16 + 1).collect();
        Ok(Self { palette: Palette::new(colors)?, indices, error })
    }

    pub(crate) fn palette(&self) -> &Palette {
        &self.palette
    }

    /// Palette index of a colour that is in the census.
    #[inline]
    pub(crate) fn index(&self, census: &ColorCensus, color: [u8; 3]) -> u16 {
        self.indices[census.set.number(color)]
    }

    /// Root of the mean square distance in Oklab, over all leaf voxels.
    pub(crate) fn error(&self) -> f64 {
        self.error
    }
}

/// `entry(k)` is the palette entry for the k-th colour of the census.
fn root_mean_square(census: &ColorCensus, entry: impl Fn(usize) -> [u8; 3] + Sync) -> f64 {
    let square = |index: usize| {
        let (original, found) = (census.colors[index], entry(index));
        if found == original {
            return 0.0;
        }
        let (a, b) = (to_oklab(original), to_oklab(found));
        let square: f64 = (0..3).map(|axis| f64::from(a[axis] - b[axis]).powi(2)).sum();
        square * census.counts[index] as f64
    };
    // Sums of fixed runs, added up in order: the same for every number of threads.
    let runs: Vec<f64> = (0..census.colors.len().div_ceil(4096))
        .into_par_iter()
        .map(|run| (run * 4096..census.colors.len().min((run + 1) * 4096)).map(square).sum())
        .collect();
    let voxels = census.counts.iter().sum::<u64>().max(1);
    (runs.iter().sum::<f64>() / voxels as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(colors: &[([u8; 3], u64)], size: usize) -> (ColorCensus, PaletteMap) {
        let census = ColorCensus::of(colors);
        let map = PaletteMap::new(&census, size, &Progress::hidden()).unwrap();
        (census, map)
    }

    /// Colours that fill the cube of RGB, each used once to seven times.
    fn lattice(step: usize) -> Vec<([u8; 3], u64)> {
        let channel = || (0..=u8::MAX).step_by(step);
        let colors = channel().flat_map(|r| channel().flat_map(move |g| channel().map(move |b| [r, g, b])));
        colors.enumerate().map(|(index, color)| (color, index as u64 * 5 % 7 + 1)).collect()
    }

    #[test]
    fn exact_as_long_as_there_is_room() {
        let colors = lattice(64);
        for size in [colors.len(), 32_767] {
            let (census, map) = map(&colors, size);
            assert_eq!(map.palette().len(), colors.len());
            assert_eq!(map.error(), 0.0);
            for &(color, _) in &colors {
                assert_eq!(map.palette().color(map.index(&census, color)), Some(color));
            }
        }
    }

    #[test]
    fn one_color_too_many_merges_the_two_most_similar() {
        let colors = [([0, 0, 0], 9), ([100, 0, 0], 3), ([102, 0, 0], 1), ([0, 200, 0], 9), ([255; 3], 9)];
        let (census, map) = map(&colors, 4);
        let entry = |color| map.palette().color(map.index(&census, color)).unwrap();
        for kept in [0, 3, 4] {
            assert_eq!(entry(colors[kept].0), colors[kept].0);
        }
        // Three of four voxels have 100.
        assert_eq!(entry([100, 0, 0]), entry([102, 0, 0]));
        assert!((100..102).contains(&entry([100, 0, 0])[0]), "{:?}", entry([100, 0, 0]));
        assert!(map.error() > 0.0);
    }

    #[test]
    fn more_entries_make_a_smaller_error() {
        let colors = lattice(15);
        let errors = [1, 2, 16, 256, 2048, 5000].map(|size| {
            let (census, map) = map(&colors, size);
            assert!(map.palette().len() <= size && map.palette().len() * 10 > size * 9, "{size}");
            for &(color, _) in &colors {
                assert!(map.palette().color(map.index(&census, color)).is_some());
            }
            map.error()
        });
        assert!(errors.windows(2).all(|pair| pair[1] < pair[0] * 0.9), "{errors:?}");
        // 256 entries for all colours: an eye sees differences of about 0.02.
        assert!(errors[3] < 0.04, "{errors:?}");
    }

    #[test]
    fn every_color_there_is_becomes_a_palette() {
        // Many more than are merged one by one.
        let colors = lattice(2);
        assert!(colors.len() > 2_000_000);
        let (_, map) = map(&colors, 32_767);
        assert!((30_000..=32_767).contains(&map.palette().len()), "{}", map.palette().len());
        assert!(map.error() < 0.01, "{}", map.error());
    }
}
