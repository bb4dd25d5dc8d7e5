//! The filled cells of an octree, from its records.

use crate::{FormatError, Limits, Record, Voxel};

/// A filled voxel without children: a cube of filled cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Leaf {
    /// Its level.
    pub level: u8,
    /// Its coordinates among the cells of that level.
    pub cell: [u32; 3],
    /// What it looks like.
    pub voxel: Voxel,
}

impl Leaf {
    /// The corner with the smallest coordinates, and the length of the edges, in cells of the level `depth`, which is not
    /// above that of the leaf and at most [`Limits::MAX_DEPTH`].
    #[must_use]
    pub fn cube(&self, depth: u8) -> ([u32; 3], u32) {
        let shift = depth.saturating_sub(self.level);
        (self.cell.map(|coordinate| coordinate << shift), 1 << shift)
    }
}

/// The filled voxels without children among records in preorder, and where they are.
#[derive(Debug, Clone)]
pub struct Leaves<I> {
    records: I,
    /// The cell of the last record of each level.
    cells: [[u32; 3]; Limits::MAX_DEPTH as usize + 1],
}

impl<I: Iterator<Item = Result<Record, FormatError>>> Leaves<I> {
    /// The leaves among `records`.
    pub fn new(records: I) -> Self {
        Self { records, cells: [[0; 3]; Limits::MAX_DEPTH as usize + 1] }
    }
}

impl<I: Iterator<Item = Result<Record, FormatError>>> Iterator for Leaves<I> {
    type Item = Result<Leaf, FormatError>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let Record { level, octant, voxel, has_children } = match self.records.next()? {
                Ok(record) => record,
                Err(error) => return Some(Err(error)),
            };
            let parent = usize::from(level).checked_sub(1).and_then(|above| self.cells.get(above)).copied();
            let parent = parent.unwrap_or_default();
            let cell = std::array::from_fn(|axis| parent[axis] << 1 | u32::from(octant >> axis & 1));
            if let Some(place) = self.cells.get_mut(usize::from(level)) {
                *place = cell;
            }
            if !has_children && !voxel.is_empty() {
                return Some(Ok(Leaf { level, cell, voxel }));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leaves_know_their_place() {
        let record = |level, octant, palette_index, has_children| {
            Ok(Record { level, octant, voxel: Voxel { palette_index, ..Voxel::EMPTY }, has_children })
        };
        // Of the root the octants 1, a leaf, and 6, a node with the octants 0 and 7.
        let mut records = vec![record(0, 0, 9, true), record(1, 0, 0, false), record(1, 1, 5, false)];
        records.extend((2..6).map(|octant| record(1, octant, 0, false)));
        records.push(record(1, 6, 9, true));
        records
            .extend((0..8).map(|octant| record(2, octant, [7, 0, 0, 0, 0, 0, 0, 8][octant as usize], false)));
        records.push(record(1, 7, 0, false));
        let leaves: Vec<Leaf> = Leaves::new(records.into_iter()).map(Result::unwrap).collect();
        let found: Vec<_> =
            leaves.iter().map(|leaf| (leaf.level, leaf.cell, leaf.voxel.palette_index)).collect();
        assert_eq!(found, [(1, [1, 0, 0], 5), (2, [0, 2, 2], 7), (2, [1, 3, 3], 8)]);
        assert_eq!(leaves[0].cube(4), ([8, 0, 0], 8));
        assert_eq!(leaves[2].cube(2), ([1, 3, 3], 1));
    }
}
