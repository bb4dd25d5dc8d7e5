//! How often each colour occurs among the voxels.

use crate::ConvertError;
use crate::color_set::{ColorSet, WORDS, place};
use crate::storage::Storage;
use crate::subtree::Subtree;
use crate::voxel_filter::{LeafColors, Leaves};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};

/// The colours in use, each with the number of leaf voxels that have it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct ColorCensus {
    pub set: ColorSet,
    /// The colours in the order of their numbers in the set.
    pub colors: Vec<[u8; 3]>,
    pub counts: Vec<u64>,
}

impl ColorCensus {
    /// # Errors
    /// [`ConvertError::TemporaryFile`].
    pub(crate) fn take(subtrees: &[Subtree], storage: &Storage) -> Result<Self, ConvertError> {
        Self::count(subtrees, |subtree, visit| {
            storage.with(&subtree.leaves, |leaves| for_each_run(leaves, visit))
        })
    }

    /// Counts what `for_each` finds in the items: colours, each with a number of voxels.
    fn count<T: Sync>(
        items: &[T],
        for_each: impl Fn(&T, &mut dyn FnMut([u8; 3], u64)) -> Result<(), ConvertError> + Sync,
    ) -> Result<Self, ConvertError> {
        let members = atomics(WORDS);
        items.par_iter().try_for_each(|item| {
            for_each(item, &mut |color, _| {
                let (word, bit) = place(color);
                // Reading first spares the cache line if the bit is set already, as it mostly is.
                if members[word].load(Ordering::Relaxed) & bit == 0 {
                    members[word].fetch_or(bit, Ordering::Relaxed);
                }
            })
        })?;
        let set = ColorSet::new(values(members));

        let counts = atomics(set.len());
        items.par_iter().try_for_each(|item| {
            for_each(item, &mut |color, voxels| {
                counts[set.number(color)].fetch_add(voxels, Ordering::Relaxed);
            })
        })?;
        Ok(Self { colors: set.colors(), counts: values(counts), set })
    }

    /// A census with this result, in any order.
    #[cfg(test)]
    pub(crate) fn of(colors: &[([u8; 3], u64)]) -> Self {
        let visit_one = |&(color, voxels): &_, visit: &mut dyn FnMut(_, _)| {
            visit(color, voxels);
            Ok(())
        };
        Self::count(colors, visit_one).unwrap()
    }
}

fn atomics(count: usize) -> Vec<AtomicU64> {
    (0..count).map(|_| AtomicU64::new(0)).collect()
}

fn values(atomics: Vec<AtomicU64>) -> Vec<u64> {
    atomics.into_iter().map(AtomicU64::into_inner).collect()
}

/// Calls `visit` with each run of equal colours and its length.
fn for_each_run(leaves: &Leaves, visit: &mut dyn FnMut([u8; 3], u64)) {
    match &leaves.colors {
        LeafColors::Same(color) => visit(*color, leaves.normals.len() as u64),
        LeafColors::Each(colors) => {
            for run in colors.chunk_by(|a, b| a == b) {
                visit(run[0], run.len() as u64);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_are_sorted_and_counted() {
        let white = [255; 3];
        let census = ColorCensus::of(&[(white, 2), ([0, 0, 1], 5), (white, 1), ([0, 1, 0], 4), ([0; 3], 9)]);
        assert_eq!(census.colors, [[0, 0, 0], [0, 0, 1], [0, 1, 0], white]);
        assert_eq!(census.counts, [9, 5, 4, 3]);
    }
}
