//! The filled cells of a volume in the order of a file.

use super::{ExchangeError, Leaf, Volume};
use crate::FormatError;
use rayon::prelude::*;

/// In which order the cells of a volume stand in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Order {
    /// Neighbours along z stand side by side: the order of an array `[x][y][z]` in C.
    Xyz,
    /// Neighbours along x stand side by side: the order in which volume viewers read raw files.
    Zyx,
    /// Neighbours along y stand side by side: the order of binvox.
    Xzy,
}

impl Order {
    /// The axes, from the one whose coordinate changes least often to the one along which neighbours stand side by side.
    fn axes(self) -> [usize; 3] {
        match self {
            Self::Xyz => [0, 1, 2],
            Self::Zyx => [2, 1, 0],
            Self::Xzy => [0, 2, 1],
        }
    }
}

/// Filled cells of one material that stand side by side.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Run {
    /// Cells of the volume before the first one.
    pub start: u64,
    /// Number of cells.
    pub length: u32,
    /// Their palette index.
    pub palette_index: u16,
}

/// The filled cells of a volume, in the order of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Runs {
    depth: u8,
    runs: Vec<Run>,
}

/// The finest volume: its cells can be numbered with 63 bits.
const MAX_DEPTH: u8 = 21;

impl Runs {
    /// The filled cells of a volume.
    pub fn new(
        volume: Volume<impl Iterator<Item = Result<Leaf, FormatError>>>,
        order: Order,
    ) -> Result<Self, FormatError> {
        let Volume { leaves, depth, max_bytes } = volume;
        let too_large =
            |bytes| ExchangeError::VolumeTooLarge { resolution: 1 << depth.min(63), bytes, limit: max_bytes };
        if depth > MAX_DEPTH {
            return Err(too_large(1 << (3 * depth.min(40))).into());
        }
        let mut runs = Vec::new();
        for leaf in leaves {
            let leaf = leaf?;
            if leaf.level > depth {
                return Err(FormatError::TooDeep { offset: 0, max_depth: depth });
            }
            let (corner, side) = leaf.cube(depth);
            let bytes = (runs.len() as u128 + u128::from(side).pow(2)) * size_of::<Run>() as u128;
            if bytes > u128::from(max_bytes) {
                return Err(too_large(bytes).into());
            }
            let [slow, middle, fast] = order.axes().map(|axis| u64::from(corner[axis]));
            for slow in slow..slow + u64::from(side) {
                for middle in middle..middle + u64::from(side) {
                    let start = ((slow << depth | middle) << depth) | fast;
                    runs.push(Run { start, length: side, palette_index: leaf.voxel.palette_index });
                }
            }
        }
        runs.par_sort_unstable_by_key(|run| run.start);
        Ok(Self { depth, runs })
    }

    /// Cells along each axis.
    pub fn resolution(&self) -> u64 {
        1 << self.depth
    }

    /// The runs, ascending by their start. They do not overlap.
    pub fn runs(&self) -> &[Run] {
        &self.runs
    }

    /// Number of cells of the volume.
    pub fn cell_count(&self) -> u64 {
        1 << (3 * self.depth)
    }
}
