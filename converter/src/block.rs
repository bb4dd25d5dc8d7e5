//! The cubes of voxels that are converted on their own.

use crate::fixed_point::{GridPoint, SUBVOXEL_BITS};
use crate::morton;

/// Blocks have 64 cells per axis: their working memory stays in a core's cache, and few triangles lie in several.
const BLOCK_BITS: u32 = 6;
const _: () = assert!(BLOCK_BITS <= morton::TABLE_BITS);

/// How the cube is cut into blocks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct BlockGrid {
    /// Depth of the whole octree.
    pub depth: u32,
    /// Depth of the subtree of a block: there are 2^`block_depth` cells along its edge.
    pub block_depth: u32,
}

impl BlockGrid {
    /// The cut of a cube of 2^`depth` cells per axis.
    pub(crate) fn new(depth: u8) -> Self {
        Self::with_block_depth(depth, BLOCK_BITS)
    }

    /// A cut into blocks of a chosen size, for tests that compare them.
    pub(crate) fn with_block_depth(depth: u8, block_depth: u32) -> Self {
        Self { depth: depth.into(), block_depth: block_depth.min(depth.into()) }
    }

    /// Levels above the blocks.
    pub(crate) fn top_depth(self) -> u32 {
        self.depth - self.block_depth
    }

    /// Blocks along an edge of the cube.
    pub(crate) fn blocks_per_axis(self) -> i32 {
        1 << self.top_depth()
    }

    /// Bits from a sub-voxel coordinate to the number of its block.
    pub(crate) fn shift(self) -> u32 {
        self.block_depth + SUBVOXEL_BITS
    }

    /// The block of a Morton code.
    pub(crate) fn block(self, code: u32) -> Block {
        let size = 1 << self.block_depth;
        let number = morton::decode(code).map(|number| number as i32);
        Block {
            first: number.map(|n| n * size),
            size,
            is_last: number.map(|n| n + 1 == self.blocks_per_axis()),
        }
    }

    /// The number of the block that a point belongs to, along an axis. The far faces of the cube belong to the last.
    pub(crate) fn number_of(self, coordinate: i32) -> i32 {
        (coordinate >> self.shift()).min(self.blocks_per_axis() - 1)
    }

    /// The block (as a Morton code) and the cell in it (likewise) that a point belongs to.
    pub(crate) fn locate(self, point: GridPoint) -> (u32, u32) {
        let last = (1 << self.depth) - 1;
        let cell = point.map(|coordinate| (coordinate >> SUBVOXEL_BITS).min(last) as u32);
        let mask = (1 << self.block_depth) - 1;
        (morton::encode(cell.map(|c| c >> self.block_depth)), morton::encode(cell.map(|c| c & mask)))
    }
}

/// A cube of voxels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Block {
    /// Its first cell.
    pub first: [i32; 3],
    /// Cells along an edge.
    pub size: i32,
    /// Whether it lies at the far end of the cube, along each axis.
    pub is_last: [bool; 3],
}
