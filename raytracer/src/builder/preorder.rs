//! The cells of a file of version 4: eight records for each that has children.

use super::assembly::{Cell, Cells};
use crate::LoadError;
use crate::payload::PayloadWord;
use octvox_format::Voxel;

/// Records of a file, or of a part of it.
pub(crate) struct Preorder<'a> {
    records: &'a [[u8; 4]],
    /// The largest palette index so far.
    largest_index: u16,
}

impl<'a> Preorder<'a> {
    pub fn new(records: &'a [[u8; 4]]) -> Self {
        Self { records, largest_index: 0 }
    }

    /// Whether all records have been used, and the palette has their colours.
    pub fn is_used_up(&self, palette_size: usize) -> bool {
        self.records.is_empty() && usize::from(self.largest_index) <= palette_size
    }
}

impl Cells for &mut Preorder<'_> {
    type Children = ();

    fn root(&mut self) -> Result<Cell<()>, LoadError> {
        self.next(())
    }

    /// Empty cells have records too.
    #[inline]
    fn octants(_siblings: ()) -> u8 {
        0xFF
    }

    #[inline]
    fn next(&mut self, _siblings: ()) -> Result<Cell<()>, LoadError> {
        let Some((record, later)) = self.records.split_first() else { return Err(LoadError::Changed) };
        self.records = later;
        let (voxel, has_children) = Voxel::from_word(*record);
        self.largest_index = self.largest_index.max(voxel.palette_index);
        let word = PayloadWord::from(voxel);
        Ok(match (has_children, voxel.is_empty()) {
            (true, _) => Cell::Node(word, ()),
            (false, true) => Cell::Empty,
            (false, false) => Cell::Voxel(word),
        })
    }

    #[inline]
    fn finest(&mut self, _siblings: (), voxels: &mut Vec<PayloadWord>) -> Result<u8, LoadError> {
        let Some((records, later)) = self.records.split_first_chunk::<8>() else {
            return Err(LoadError::Changed);
        };
        self.records = later;
        let mut filled = [PayloadWord::EMPTY; 8];
        let (mut count, mut mask, mut any_has_children) = (0, 0, false);
        for (octant, record) in records.iter().enumerate() {
            let (voxel, has_children) = Voxel::from_word(*record);
            any_has_children |= has_children;
            self.largest_index = self.largest_index.max(voxel.palette_index);
            // Empty ones are overwritten by the next.
            filled[count] = PayloadWord::from(voxel);
            count += usize::from(!voxel.is_empty());
            mask |= u8::from(!voxel.is_empty()) << octant;
        }
        if any_has_children {
            return Err(LoadError::Changed);
        }
        voxels.extend_from_slice(&filled[..count]);
        Ok(mask)
    }
}
