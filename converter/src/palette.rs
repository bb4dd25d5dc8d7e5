//! The finishes and colours of the voxels into a palette.

use crate::ConvertError;
use crate::color_census::{ColorCensus, FinishColors};
use crate::color_space::to_oklab;
use crate::nearest_color::NearestColor;
use crate::palette_reduction::{Family, Reduced, reduce};
use octvox_cli::Progress;
use octvox_format::Material;
use rayon::prelude::*;
use std::sync::OnceLock;

/// A palette, and the way to it from the finishes and colours of the voxels.
pub(crate) struct PaletteMap {
    /// By finish, and within a finish by colour.
    entries: Vec<Material>,
    /// By finish; `None` for one that no voxel has.
    finishes: Vec<Option<FinishMap>>,
    error: f64,
}

/// The entries of a finish.
struct FinishMap {
    /// Index of the first.
    first: u16,
    palette: Vec<[u8; 3]>,
    /// For each colour of the census, its place among them.
    places: Vec<u16>,
    /// The entries by their distance, as soon as somebody asks.
    nearest: OnceLock<NearestColor>,
}

impl PaletteMap {
    /// Every colour gets its own entry if there are no more than `size`; else similar ones share entries, though never with
    /// those of another finish. `finishes` are the materials of the census's finishes, whose colour does not matter.
    ///
    /// # Errors
    /// [`ConvertError::TooManyFinishes`] if not even each finish can have an entry.
    pub(crate) fn new(
        census: &ColorCensus,
        finishes: &[Material],
        size: usize,
        progress: &Progress,
    ) -> Result<Self, ConvertError> {
        let used: Vec<&FinishColors> = census.finishes.iter().flatten().collect();
        if used.len() > size {
            return Err(ConvertError::TooManyFinishes { finishes: used.len(), size });
        }
        let reduced = if census.len() <= size {
            used.iter().map(|finish| exact(finish)).collect()
        } else {
            let families: Vec<Family<'_>> =
                used.iter().map(|finish| Family { colors: &finish.colors, voxels: &finish.counts }).collect();
            reduce(&families, size, progress)
        };
        let error = root_mean_square(&used, &reduced);

        let mut reduced = reduced.into_iter();
        let mut entries = Vec::new();
        let mut maps = Vec::with_capacity(census.finishes.len());
        for (number, colors) in census.finishes.iter().enumerate() {
            let reduced = if colors.is_some() { reduced.next() } else { None };
            maps.push(reduced.map(|Reduced { palette, entries: places }| {
                // Indices count from 1; there are at most 65,535.
                let first = entries.len() as u16 + 1;
                let finish = finishes.get(number).copied().unwrap_or(Material::matte([0; 3]));
                entries.extend(palette.iter().map(|&diffuse| Material { diffuse, ..finish }));
                FinishMap { first, palette, places, nearest: OnceLock::new() }
            }));
        }
        Ok(Self { entries, finishes: maps, error })
    }

    /// The entries, of which the first has the index 1.
    pub(crate) fn entries(&self) -> &[Material] {
        &self.entries
    }

    /// Index of the entry for a finish and a colour that are in the census.
    #[inline]
    pub(crate) fn index(&self, census: &ColorCensus, (finish, color): (u16, [u8; 3])) -> u16 {
        let finish = usize::from(finish);
        match (&self.finishes[finish], &census.finishes[finish]) {
            (Some(map), Some(colors)) => map.first + map.places[colors.set.number(color)],
            _ => 1,
        }
    }

    /// Index of the entry of a finish in the census that is nearest to any colour, in Oklab.
    pub(crate) fn nearest_index(&self, census: &ColorCensus, (finish, color): (u16, [u8; 3])) -> u16 {
        let (Some(map), Some(colors)) =
            (&self.finishes[usize::from(finish)], &census.finishes[usize::from(finish)])
        else {
            return 1;
        };
        if colors.set.contains(color) {
            return self.index(census, (finish, color));
        }
        let nearest = map.nearest.get_or_init(|| {
            NearestColor::new(
                &map.palette.iter().map(|&color| to_oklab(color)).collect::<Vec<_>>(),
                usize::MAX,
            )
        });
        map.first + nearest.nearest(to_oklab(color)) as u16
    }

    /// Root of the mean square distance in Oklab, over all leaf voxels.
    pub(crate) fn error(&self) -> f64 {
        self.error
    }
}

/// An entry for each colour.
fn exact(colors: &FinishColors) -> Reduced {
    Reduced { palette: colors.colors.clone(), entries: (0..colors.colors.len()).map(|k| k as u16).collect() }
}

fn root_mean_square(finishes: &[&FinishColors], reduced: &[Reduced]) -> f64 {
    let mut sum = 0.0;
    let mut voxels = 0;
    for (finish, reduced) in finishes.iter().zip(reduced) {
        let square = |index: usize| {
            let original = finish.colors[index];
            let found = reduced.palette[usize::from(reduced.entries[index])];
            if found == original {
                return 0.0;
            }
            let (a, b) = (to_oklab(original), to_oklab(found));
            let square: f64 = (0..3).map(|axis| f64::from(a[axis] - b[axis]).powi(2)).sum();
            square * finish.counts[index] as f64
        };
        // Sums of fixed runs, added up in order: the same for every number of threads.
        let count = finish.colors.len();
        let runs: Vec<f64> = (0..count.div_ceil(4096))
            .into_par_iter()
            .map(|run| (run * 4096..count.min((run + 1) * 4096)).map(square).sum())
            .collect();
        sum += runs.iter().sum::<f64>();
        voxels += finish.counts.iter().sum::<u64>();
    }
    (sum / voxels.max(1) as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(colors: &[([u8; 3], u64)], size: usize) -> (ColorCensus, PaletteMap) {
        let runs: Vec<_> = colors.iter().map(|&(color, voxels)| (0, color, voxels)).collect();
        let census = ColorCensus::of(&runs);
        let map = PaletteMap::new(&census, &[], size, &Progress::hidden()).unwrap();
        (census, map)
    }

    fn color_of(map: &PaletteMap, index: u16) -> Option<[u8; 3]> {
        map.entries().get(usize::from(index).checked_sub(1)?).map(|entry| entry.diffuse)
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
            assert_eq!(map.entries().len(), colors.len());
            assert_eq!(map.error(), 0.0);
            for &(color, _) in &colors {
                assert_eq!(color_of(&map, map.index(&census, (0, color))), Some(color));
            }
        }
    }

    #[test]
    fn one_color_too_many_merges_the_two_most_similar() {
        let colors = [([0, 0, 0], 9), ([100, 0, 0], 3), ([102, 0, 0], 1), ([0, 200, 0], 9), ([255; 3], 9)];
        let (census, map) = map(&colors, 4);
        let entry = |color| color_of(&map, map.index(&census, (0, color))).unwrap();
        for kept in [0, 3, 4] {
            assert_eq!(entry(colors[kept].0), colors[kept].0);
        }
        // Three of four voxels have 100.
        assert_eq!(entry([100, 0, 0]), entry([102, 0, 0]));
        assert!((100..102).contains(&entry([100, 0, 0])[0]), "{:?}", entry([100, 0, 0]));
        assert!(map.error() > 0.0);
    }

    #[test]
    fn other_colors_get_the_nearest_entry() {
        let (census, map) = map(&[([0; 3], 1), ([200, 0, 0], 1), ([255; 3], 1)], 10);
        for (asked, expected) in [([9, 0, 3], [0; 3]), ([180, 10, 0], [200, 0, 0]), ([200; 3], [255; 3])] {
            assert_eq!(color_of(&map, map.nearest_index(&census, (0, asked))), Some(expected));
        }
    }

    #[test]
    fn finishes_do_not_share_entries() {
        let mirror = Material { reflectivity: 200, ..Material::matte([0; 3]) };
        let finishes = [Material::matte([0; 3]), Material::matte([9; 3]), mirror];
        // Red twice, once as a mirror, and so many greys that they have to share.
        let mut runs: Vec<_> = (0..200u8).map(|grey| (0, [grey; 3], 1)).collect();
        runs.extend([(0, [200, 0, 0], 1), (2, [200, 0, 0], 1), (2, [0, 0, 200], 1)]);
        let census = ColorCensus::of(&runs);
        for size in [300, 60] {
            let map = PaletteMap::new(&census, &finishes, size, &Progress::hidden()).unwrap();
            assert!(map.entries().len() <= size);
            let entry = |look| map.entries()[usize::from(map.index(&census, look)) - 1];
            assert_eq!(entry((2, [200, 0, 0])), Material { diffuse: [200, 0, 0], ..mirror });
            assert_eq!(entry((0, [200, 0, 0])), Material::matte([200, 0, 0]));
            assert!(runs.iter().all(|run| (entry((run.0, run.1)).reflectivity > 0) == (run.0 == 2)));
            // The nearest of the mirrors, though there are nearer ones among the others.
            let nearest = map.nearest_index(&census, (2, [20, 20, 20]));
            assert_eq!(map.entries()[usize::from(nearest) - 1].reflectivity, 200);
        }
        let error = PaletteMap::new(&census, &finishes, 1, &Progress::hidden()).err();
        assert!(matches!(error, Some(ConvertError::TooManyFinishes { finishes: 2, size: 1 })));
    }

    #[test]
    fn more_entries_make_a_smaller_error() {
        let colors = lattice(15);
        let errors = [1, 2, 16, 256, 2048, 5000].map(|size| {
            let (census, map) = map(&colors, size);
            assert!(map.entries().len() <= size && map.entries().len() * 10 > size * 9, "{size}");
            for &(color, _) in &colors {
                assert!(color_of(&map, map.index(&census, (0, color))).is_some());
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
        assert!((30_000..=32_767).contains(&map.entries().len()), "{}", map.entries().len());
        assert!(map.error() < 0.01, "{}", map.error());
    }
}
