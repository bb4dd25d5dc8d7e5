//! The uniform grid through which rays enter the octree.
//!
//! Bohnen 2009, section 3.5.5, starts each search at one of 64³ pointers into level seven instead of at the root.
//! Here a cell holds what a ray reads of the deepest node that covers it, so that the node itself need not be looked up, or the
//! size of the empty cube around the cell.

use crate::node::Node;
use crate::octree::{MANTISSA_BITS, Octree, cell_of_morton, finest_exponent, root_exponent};

/// Nodes, one for each cell of a cube of `1 << level` cells per axis, x fastest.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Grid {
    level: u8,
    /// Cells per axis that were asked for, as far as the octree has them; 0 for the root.
    size: u32,
    /// Exponent of the cells of the nodes that the grid points to.
    node_exponent: u32,
    cells: Vec<Entry>,
}

/// The first three words of a node and its index; or of a node in which nothing is, and [`EMPTY`] with the exponent of the
/// empty cube's size.
pub(crate) type Entry = [u32; 4];

/// Marks a grid cell that nothing fills, in its last word.
pub(crate) const EMPTY: u32 = 1 << 31;

/// What an empty cube of size `1 << exponent` is entered as.
fn empty(exponent: u32) -> Entry {
    [0, 0, 0, EMPTY | exponent]
}

impl Grid {
    /// 64³ cells.
    pub const DEFAULT_LEVEL: u8 = 6;

    /// 256³ cells.
    pub const MAX_LEVEL: u8 = 8;

    /// A grid without a cell: of an octree that is not complete yet.
    pub const fn none() -> Self {
        Self { level: 0, size: 0, node_exponent: 0, cells: Vec::new() }
    }

    /// The grid of `1 << level` cells per axis over `octree`; level 0 has one cell, the root, or if that covers one level
    /// only, the eight cells of that.
    pub fn new(octree: &Octree, level: u8) -> Self {
        let level = level.min(octree.depth());
        let size = if level == 0 { 0 } else { 1 << level };
        let level = if octree.depth().is_multiple_of(2) { level } else { level.max(1) };
        let root_exponent = root_exponent(octree.depth());
        // The lowest nodes that are no smaller than a grid cell.
        let mut node_exponent = root_exponent;
        while node_exponent >= MANTISSA_BITS - u32::from(level)
            && node_exponent >= finest_exponent(octree.depth()) + 2
        {
            node_exponent -= 2;
        }
        let cells = vec![empty(MANTISSA_BITS); 1 << (3 * level)];
        let mut grid = Self { level, size, node_exponent, cells };
        if let Some(root) = octree.nodes.get(octree.root as usize) {
            grid.enter(octree, octree.root, root, [0; 3], root_exponent);
        }
        grid
    }

    /// Cells per axis; 0 if rays start at the root.
    pub fn size(&self) -> u32 {
        self.size
    }

    /// The octree level of the grid's cells.
    pub fn level(&self) -> u32 {
        u32::from(self.level)
    }

    /// Exponent of the cells of the nodes that the grid points to.
    pub fn node_exponent(&self) -> u32 {
        self.node_exponent
    }

    /// What each cell holds.
    pub fn cells(&self) -> &[Entry] {
        &self.cells
    }

    /// The cells in which something is.
    pub fn filled_cells(&self) -> impl Iterator<Item = [usize; 3]> {
        let size = 1usize << self.level;
        let filled = self.cells.iter().enumerate().filter(|(_, entry)| entry[3] & EMPTY == 0);
        filled.map(move |(index, _)| [index % size, index / size % size, index / size / size])
    }

    /// Bytes in memory.
    pub fn bytes(&self) -> usize {
        size_of_val(self.cells.as_slice())
    }

    /// Exponent of a grid cell's size.
    fn exponent(&self) -> u32 {
        MANTISSA_BITS - u32::from(self.level)
    }

    /// Writes what `node`, whose cells are of size `1 << exponent` and which begins at `corner`, means for the
    /// grid cells it covers. Corners are in units of the mantissa.
    fn enter(&mut self, octree: &Octree, index: u32, node: &Node, corner: [u32; 3], exponent: u32) {
        if exponent == self.node_exponent || node.is_leaf() {
            // A leaf above the grid's nodes is uniform: wherever a ray enters it, it hits.
            let [low, high, contents, _] = bytemuck::cast(*node);
            self.write(corner, exponent + 2, [low, high, contents, index]);
            return;
        }
        let cells = node.cells();
        // Where the root covers one level, only its first byte is in the cube.
        let in_cube = if exponent + 2 > MANTISSA_BITS { 8 } else { 64 };
        for place in 0..in_cube {
            let offset = cell_of_morton(place);
            let low = std::array::from_fn(|axis| corner[axis] + (offset[axis] << exponent));
            if cells >> place & 1 == 1 {
                let child = node.index_of(place);
                self.enter(octree, child, &octree.nodes[child as usize], low, exponent - 2);
            } else if cells >> (place & !7) & 0xFF == 0 {
                // The whole byte is empty: the cube to step over is twice the cell.
                self.write(low, exponent, empty(exponent + 1));
            } else {
                self.write(low, exponent, empty(exponent));
            }
        }
    }

    /// Writes `entry` to all grid cells in the cube at `corner` of size `1 << exponent`.
    fn write(&mut self, corner: [u32; 3], exponent: u32, entry: Entry) {
        let exponent = exponent.min(MANTISSA_BITS);
        let [x, y, z] = corner.map(|coordinate| (coordinate >> self.exponent()) as usize);
        let side = 1usize << exponent.saturating_sub(self.exponent());
        for z in z..z + side {
            for y in y..y + side {
                let row = (z << self.level | y) << self.level;
                self.cells[row + x..row + x + side].fill(entry);
            }
        }
    }
}
