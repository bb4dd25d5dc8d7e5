//! How often each colour occurs among the voxels, with each finish.

use crate::ConvertError;
use crate::color_set::{ColorSet, SharedColorSet};
use crate::lod_color::Light;
use crate::storage::Storage;
use crate::subtree::Subtree;
use crate::voxel_filter::Leaves;
use rayon::prelude::*;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};

/// The colours in use.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct ColorCensus {
    /// By finish; `None` for one that no voxel has.
    pub finishes: Vec<Option<FinishColors>>,
}

/// The colours of the voxels that have the same finish.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct FinishColors {
    pub set: ColorSet,
    /// The colours in the order of their numbers in the set.
    pub colors: Vec<[u8; 3]>,
    /// For each of them, the number of leaf voxels that have it.
    pub counts: Vec<u64>,
}

/// A finish and a colour, with a number of voxels.
type Run = (u16, [u8; 3], u64);

impl ColorCensus {
    /// Counts the colours of the leaves; finishes are numbered from 0 and less than `finishes`.
    ///
    /// # Errors
    /// [`ConvertError::TemporaryFile`].
    pub(crate) fn take(
        subtrees: &[Subtree],
        finishes: usize,
        storage: &Storage,
    ) -> Result<Self, ConvertError> {
        Self::count(subtrees, finishes, |subtree, visit| {
            storage.with(&subtree.leaves, |leaves| for_each_run(leaves, visit))
        })
    }

    /// Counts what `for_each` finds in the items.
    fn count<T: Sync>(
        items: &[T],
        finishes: usize,
        for_each: impl Fn(&T, &mut dyn FnMut(Run)) -> Result<(), ConvertError> + Sync,
    ) -> Result<Self, ConvertError> {
        let mut sets: Vec<OnceLock<SharedColorSet>> = Vec::new();
        sets.resize_with(finishes, OnceLock::new);
        items.par_iter().try_for_each(|item| {
            for_each(item, &mut |(finish, color, _)| {
                sets[usize::from(finish)].get_or_init(SharedColorSet::new).insert(color);
            })
        })?;
        let sets: Vec<Option<ColorSet>> =
            sets.into_iter().map(|set| set.into_inner().map(SharedColorSet::finish)).collect();

        let counts: Vec<Vec<AtomicU64>> = sets
            .iter()
            .map(|set| (0..set.as_ref().map_or(0, ColorSet::len)).map(|_| AtomicU64::new(0)).collect())
            .collect();
        items.par_iter().try_for_each(|item| {
            for_each(item, &mut |(finish, color, voxels)| {
                let finish = usize::from(finish);
                if let Some(set) = &sets[finish] {
                    counts[finish][set.number(color)].fetch_add(voxels, Ordering::Relaxed);
                }
            })
        })?;
        let finishes = sets.into_iter().zip(counts).map(|(set, counts)| {
            let counts = counts.into_iter().map(AtomicU64::into_inner).collect();
            set.map(|set| FinishColors { colors: set.colors(), counts, set })
        });
        Ok(Self { finishes: finishes.collect() })
    }

    /// Number of different colours, each counted once for each finish that it occurs with.
    pub(crate) fn len(&self) -> usize {
        self.finishes.iter().flatten().map(|finish| finish.colors.len()).sum()
    }

    /// The light of all voxels.
    pub(crate) fn light(&self) -> Light {
        let mut all = Light::default();
        let mut most = 0;
        for (finish, colors) in self.finishes.iter().enumerate() {
            let Some(FinishColors { colors, counts, .. }) = colors else { continue };
            for (&color, &voxels) in colors.iter().zip(counts) {
                all.add(&Light::of((finish as u16, color), voxels));
            }
            let voxels = counts.iter().sum::<u64>();
            if voxels > most {
                (most, all.finish) = (voxels, finish as u16);
            }
        }
        all
    }

    /// A census with this result, in any order.
    #[cfg(test)]
    pub(crate) fn of(runs: &[Run]) -> Self {
        let finishes = runs.iter().map(|run| usize::from(run.0) + 1).max().unwrap_or(0);
        let visit_one = |&run: &Run, visit: &mut dyn FnMut(Run)| {
            visit(run);
            Ok(())
        };
        Self::count(runs, finishes, visit_one).unwrap()
    }
}

/// Calls `visit` with each run of leaves that look alike.
fn for_each_run(leaves: &Leaves, visit: &mut dyn FnMut(Run)) {
    let count = leaves.normals.len();
    let mut start = 0;
    while start < count {
        let look = leaves.look(start);
        let end = if leaves.is_uniform() {
            count
        } else {
            (start + 1..count).find(|&leaf| leaves.look(leaf) != look).unwrap_or(count)
        };
        visit((look.0, look.1, (end - start) as u64));
        start = end;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_are_sorted_and_counted_for_each_finish() {
        let white = [255; 3];
        let census = ColorCensus::of(&[
            (0, white, 2),
            (0, [0, 0, 1], 5),
            (2, white, 7),
            (0, white, 1),
            (0, [0, 1, 0], 4),
            (0, [0; 3], 9),
        ]);
        let [Some(first), None, Some(last)] = &census.finishes[..] else { panic!("{census:?}") };
        assert_eq!(first.colors, [[0, 0, 0], [0, 0, 1], [0, 1, 0], white]);
        assert_eq!(first.counts, [9, 5, 4, 3]);
        assert_eq!((&last.colors[..], &last.counts[..]), (&[white][..], &[7][..]));
        assert_eq!(census.len(), 5);
        assert_eq!(census.light().finish, 0);
    }
}
