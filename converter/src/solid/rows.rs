//! Cells of a block as rows of bits along x.

use crate::block::BlockGrid;
use crate::morton;
use crate::structure::Structure;

/// A bit for each cell of a cube of at most 64 cells per axis: the cells of a row along x are the bits of a word, and the
/// row at (y, z) is word y + size · z.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Rows {
    /// Cells per axis.
    pub size: usize,
    pub words: Vec<u64>,
}

/// For four cells along x, their bits in a word of 4×4×4 cells in Morton order.
const SPREAD: [u64; 16] = {
    let mut table = [0; 16];
    let mut bits = 0;
    while bits < 16 {
        table[bits] = (bits & 1 | (bits & 2) | (bits & 4) << 6 | (bits & 8) << 6) as u64;
        bits += 1;
    }
    table
};

impl Rows {
    /// No cells of a cube of `size` cells per axis.
    pub(crate) fn empty(size: usize) -> Self {
        Self { size, words: vec![0; size * size] }
    }

    /// The filled cells of the finest level.
    pub(crate) fn of_structure(structure: &Structure, grid: BlockGrid) -> Self {
        let mut rows = Self::empty(1 << grid.block_depth);
        structure.for_each_leaf(|code| rows.insert(morton::decode(code)));
        rows
    }

    /// A row of which all cells are set.
    pub(crate) fn full_row(&self) -> u64 {
        u64::MAX >> (64 - self.size)
    }

    pub(crate) fn insert(&mut self, [x, y, z]: [u32; 3]) {
        self.words[y as usize + self.size * z as usize] |= 1 << x;
    }

    pub(crate) fn contains(&self, [x, y, z]: [u32; 3]) -> bool {
        self.words[y as usize + self.size * z as usize] >> x & 1 == 1
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.words.iter().all(|word| *word == 0)
    }

    /// Number of cells that are set.
    pub(crate) fn count(&self) -> u64 {
        self.words.iter().map(|word| u64::from(word.count_ones())).sum()
    }

    /// The cells that are not set.
    pub(crate) fn complement(&self) -> Self {
        let full = self.full_row();
        Self { size: self.size, words: self.words.iter().map(|word| !word & full).collect() }
    }

    /// Sets the cells of a smaller cube whose lowest cell is `offset`.
    pub(crate) fn add(&mut self, part: &Self, offset: [u32; 3]) {
        let [x, y, z] = offset;
        for (row, word) in part.words.iter().enumerate() {
            let (part_y, part_z) = (row % part.size, row / part.size);
            self.words[y as usize + part_y + self.size * (z as usize + part_z)] |= word << x;
        }
    }

    /// One of the eight cubes of half the size, and its lowest cell. There must be more than one cell.
    pub(crate) fn octant(&self, octant: u32) -> (Self, [u32; 3]) {
        let size = self.size / 2;
        let offset = [octant & 1, octant >> 1 & 1, octant >> 2].map(|upper| upper * size as u32);
        let mut part = Self::empty(size);
        let full = part.full_row();
        for (row, word) in part.words.iter_mut().enumerate() {
            let (y, z) = (row % size + offset[1] as usize, row / size + offset[2] as usize);
            *word = self.words[y + self.size * z] >> offset[0] & full;
        }
        (part, offset)
    }

    /// A bit for each cell in Morton order.
    pub(crate) fn to_morton(&self) -> Vec<u64> {
        let mut bits = vec![0; (self.size.pow(3)).div_ceil(64)];
        for z in 0..self.size {
            for y in 0..self.size {
                let mut row = self.words[y + self.size * z];
                let within = (y & 1) << 1 | (y & 2) << 3 | (z & 1) << 2 | (z & 2) << 4;
                let mut x = 0;
                while row != 0 {
                    let code = morton::encode([x, y as u32 >> 2, z as u32 >> 2]) as usize;
                    bits[code] |= SPREAD[row as usize & 15] << within;
                    row >>= 4;
                    x += 1;
                }
            }
        }
        bits
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn rows_and_codes_hold_the_same_cells(depth in 0u32..=6, picks in prop::collection::vec(any::<u32>(), 1..200)) {
            let cells = 1u32 << (3 * depth);
            let codes: std::collections::BTreeSet<u32> = picks.iter().map(|pick| pick % cells).collect();
            let mut occupied = vec![0u64; (cells as usize).div_ceil(64)];
            for &code in &codes {
                occupied[code as usize / 64] |= 1 << (code % 64);
            }
            let grid = BlockGrid::with_block_depth(6, depth);
            let rows = Rows::of_structure(&Structure::from_occupancy(&occupied, depth), grid);
            prop_assert_eq!(rows.count(), codes.len() as u64);
            prop_assert!(codes.iter().all(|&code| rows.contains(morton::decode(code))));
            prop_assert_eq!(rows.to_morton(), occupied);
            prop_assert_eq!(rows.complement().count(), u64::from(cells) - rows.count());
            if depth > 0 {
                let mut whole = Rows::empty(rows.size);
                for octant in 0..8 {
                    let (part, offset) = rows.octant(octant);
                    whole.add(&part, offset);
                }
                prop_assert_eq!(whole, rows);
            }
        }
    }
}
