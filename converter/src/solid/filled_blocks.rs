//! The blocks that have voxels, as the filled cells of each.

use super::rows::Rows;
use crate::ConvertError;
use crate::block::BlockGrid;
use crate::storage::Storage;
use crate::subtree::Subtree;

/// Blocks in Morton order, in memory or in a temporary file.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FilledBlocks<'a> {
    pub subtrees: &'a [Subtree],
    pub storage: &'a Storage,
    pub grid: BlockGrid,
}

impl FilledBlocks<'_> {
    /// Number of blocks.
    pub(crate) fn len(&self) -> usize {
        self.subtrees.len()
    }

    /// The Morton codes of the blocks, ascending.
    pub(crate) fn codes(&self) -> impl Iterator<Item = u32> {
        self.subtrees.iter().map(|subtree| subtree.code)
    }

    /// The filled cells of a block.
    ///
    /// # Errors
    /// [`ConvertError::TemporaryFile`].
    pub(crate) fn rows(&self, index: usize) -> Result<Rows, ConvertError> {
        self.storage
            .with(&self.subtrees[index].leaves, |leaves| Rows::of_structure(&leaves.structure, self.grid))
    }
}
