//! How many voxels an octree has, and where they are.

use crate::node::Node;
use crate::octree::{Bounds, Octree, cell_of_morton, finest_exponent, root_exponent};

impl Octree {
    /// Counts the finest cells and finds the box around them.
    pub(super) fn measure(&mut self) {
        let mut measure =
            Measure { nodes: &self.nodes, bounds: Bounds { low: [u32::MAX; 3], high: [0; 3] }, cells: 0 };
        let Some(root) = self.nodes.get(self.root as usize) else { return };
        let mut root = *root;
        if root_exponent(self.depth) == 22 {
            // The seven repetitions are not there.
            root.mask = [root.mask[0] & 0xFF, 0];
        }
        let cell_size = 1u32 << (root_exponent(self.depth) - finest_exponent(self.depth));
        measure.visit(&root, [0; 3], cell_size);
        (self.bounds, self.leaf_voxels) = (measure.bounds, measure.cells);
    }
}

struct Measure<'a> {
    nodes: &'a [Node],
    bounds: Bounds,
    cells: u64,
}

impl Measure<'_> {
    /// `corner` is the node's lowest finest cell, `size` the side of its cells. Recursion is at most twelve deep.
    fn visit(&mut self, node: &Node, corner: [u32; 3], size: u32) {
        let mut cells = node.cells();
        if node.is_leaf() {
            self.cells += u64::from(cells.count_ones()) * u64::from(size).pow(3);
            if self.contains(corner, 4 * size) {
                return;
            }
        }
        while cells != 0 {
            let place = cells.trailing_zeros();
            cells &= cells - 1;
            let offset = cell_of_morton(place);
            let low: [u32; 3] = std::array::from_fn(|axis| corner[axis] + offset[axis] * size);
            if node.is_leaf() {
                for axis in 0..3 {
                    self.bounds.low[axis] = self.bounds.low[axis].min(low[axis]);
                    self.bounds.high[axis] = self.bounds.high[axis].max(low[axis] + size);
                }
            } else {
                let child = self.nodes[node.index_of(place) as usize];
                self.visit(&child, low, size / 4);
            }
        }
    }

    /// Whether a cube adds nothing to the box found so far: true of nearly all.
    fn contains(&self, corner: [u32; 3], size: u32) -> bool {
        (0..3).all(|axis| {
            self.bounds.low[axis] <= corner[axis] && corner[axis] + size <= self.bounds.high[axis]
        })
    }
}
