//! A part of the cube.

use super::cell_of_code;

/// A box of cells of the finest level: `low` inclusive, `high` exclusive, per axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Region {
    /// The smallest coordinates.
    pub low: [u32; 3],
    /// One more than the largest coordinates.
    pub high: [u32; 3],
}

impl Region {
    /// Whether a cell of a level has a part in the region, in an octree of `depth` levels below its root. The cell is
    /// given by its Morton code.
    #[must_use]
    pub fn meets(&self, code: u64, level: u8, depth: u8) -> bool {
        let shift = u32::from(depth.saturating_sub(level)).min(32);
        let cell = cell_of_code(code);
        (0..3).all(|axis| {
            let low = u64::from(cell[axis]) << shift;
            let high = (u64::from(cell[axis]) + 1) << shift;
            low < u64::from(self.high[axis])
                && high > u64::from(self.low[axis])
                && self.low[axis] < self.high[axis]
        })
    }
}
