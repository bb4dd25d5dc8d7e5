//! The cells of a file of version 5: the filled ones, level by level.

use super::assembly::{Cell, Cells, Lists};
use crate::LoadError;
use crate::bits::ones;
use crate::node::Node;
use crate::payload::PayloadWord;
use octvox_format::Limits;
use octvox_format::v5::Levels;

/// Goes through levels in preorder. Preorder meets the voxels of each level in the order in which they stand there, so
/// all there is to know is the next of each level.
pub(crate) struct LevelCells<'a> {
    levels: &'a Levels,
    /// Place of the next voxel of each level in the lists of all voxels.
    next: [usize; Limits::MAX_DEPTH as usize + 2],
    /// The level below these. Its cells are elsewhere.
    end: u8,
}

/// The children of a cell.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Children {
    level: u8,
    /// Bit k: the child with octant k is filled.
    mask: u8,
}

impl<'a> LevelCells<'a> {
    pub fn new(levels: &'a Levels) -> Self {
        let end = levels.first_level() + levels.level_count();
        let mut next = [0; Limits::MAX_DEPTH as usize + 2];
        for level in levels.first_level()..end {
            next[usize::from(level)] = levels.range(level).start;
        }
        Self { levels, next, end }
    }

    /// The next cell of a level, which is filled.
    #[inline]
    fn take(&mut self, level: u8) -> Result<Cell<Children>, LoadError> {
        if level >= self.end {
            return Ok(Cell::Node(PayloadWord::EMPTY, Children { level, mask: 0 }));
        }
        let place = self.next[usize::from(level)];
        self.next[usize::from(level)] += 1;
        let indices = self.levels.palette_indices();
        let (Some(index), Some(normal)) = (indices.get(place), self.levels.normals().get(place)) else {
            return Err(LoadError::Changed);
        };
        let word = PayloadWord::new(*index, *normal);
        // Voxels on the finest level have no masks.
        Ok(match self.levels.masks().get(place).copied().unwrap_or(0) {
            0 => Cell::Voxel(word),
            mask => Cell::Node(word, Children { level: level + 1, mask }),
        })
    }
}

impl Cells for LevelCells<'_> {
    type Children = Children;

    fn root(&mut self) -> Result<Cell<Children>, LoadError> {
        if self.levels.voxel_count() == 0 { Ok(Cell::Empty) } else { self.take(self.levels.first_level()) }
    }

    #[inline]
    fn octants(siblings: Children) -> u8 {
        siblings.mask
    }

    #[inline]
    fn next(&mut self, siblings: Children) -> Result<Cell<Children>, LoadError> {
        self.take(siblings.level)
    }

    #[inline]
    fn finest(&mut self, siblings: Children, voxels: &mut Vec<PayloadWord>) -> Result<u8, LoadError> {
        let start = self.next[usize::from(siblings.level)];
        let range = start..start + siblings.mask.count_ones() as usize;
        self.next[usize::from(siblings.level)] = range.end;
        let indices = self.levels.palette_indices().get(range.clone());
        let (Some(indices), Some(normals)) = (indices, self.levels.normals().get(range)) else {
            return Err(LoadError::Changed);
        };
        let words = indices.iter().zip(normals).map(|(index, normal)| PayloadWord::new(*index, *normal));
        voxels.extend(words);
        Ok(siblings.mask)
    }

    /// What belongs to a leaf stands side by side in its levels, unless a byte of it is one voxel.
    #[inline]
    fn leaf(
        &mut self,
        own: PayloadWord,
        children: Children,
        lists: &mut Lists,
    ) -> Result<Option<Node>, LoadError> {
        let [bytes_level, voxels_level] = [0, 1].map(|below| usize::from(children.level + below));
        let start = self.next[bytes_level];
        let bytes = start..start + children.mask.count_ones() as usize;
        let Some(masks) = self.levels.masks().get(bytes.clone()) else { return Err(LoadError::Changed) };
        let mut mask = 0;
        for (byte, &byte_mask) in ones(children.mask).zip(masks) {
            if byte_mask == 0 {
                return Ok(None);
            }
            mask |= u64::from(byte_mask) << (8 * byte);
        }
        let start = self.next[voxels_level];
        let voxels = start..start + mask.count_ones() as usize;
        (self.next[bytes_level], self.next[voxels_level]) = (bytes.end, voxels.end);

        let node = lists.next_leaf(mask)?;
        let (indices, normals) = (self.levels.palette_indices(), self.levels.normals());
        let voxels_are_there = lists.voxels.extend_from_planes(indices, normals, voxels);
        lists.lod.extend(&[own]);
        let bytes_are_there = lists.lod.extend_from_planes(indices, normals, bytes);
        if voxels_are_there && bytes_are_there { Ok(Some(node)) } else { Err(LoadError::Changed) }
    }
}
