//! Where the voxels of an octree are.

use crate::bits::ones;
use crate::node::Node;
use crate::octree::{Bounds, cell_of_morton, finest_exponent, root_exponent};

/// The smallest box around the filled finest cells below a root; none if nothing is filled.
pub(super) fn bounds(nodes: &[Node], root: &Node, depth: u8) -> Bounds {
    let mut root = *root;
    if root_exponent(depth) == 22 {
        // The seven repetitions are not there.
        root.mask = [root.mask[0] & 0xFF, 0];
    }
    let cell_size = 1u32 << (root_exponent(depth) - finest_exponent(depth));
    let mut search = Search { nodes, found: Bounds { low: [u32::MAX; 3], high: [0; 3] } };
    search.visit(&root, [0; 3], cell_size);
    search.found
}

struct Search<'a> {
    nodes: &'a [Node],
    found: Bounds,
}

impl Search<'_> {
    /// `corner` is the node's lowest finest cell, `size` the side of its cells. Recursion is at most twelve deep.
    fn visit(&mut self, node: &Node, corner: [u32; 3], size: u32) {
        for place in ones(node.cells()) {
            let offset = cell_of_morton(place);
            let low: [u32; 3] = std::array::from_fn(|axis| corner[axis] + offset[axis] * size);
            if self.contains(low, size) {
                continue;
            }
            if node.is_leaf() {
                for axis in 0..3 {
                    self.found.low[axis] = self.found.low[axis].min(low[axis]);
                    self.found.high[axis] = self.found.high[axis].max(low[axis] + size);
                }
            } else {
                let child = self.nodes[node.index_of(place) as usize];
                self.visit(&child, low, size / 4);
            }
        }
    }

    /// Whether a cube adds nothing to the box found so far: true of nearly all.
    fn contains(&self, corner: [u32; 3], size: u32) -> bool {
        (0..3)
            .all(|axis| self.found.low[axis] <= corner[axis] && corner[axis] + size <= self.found.high[axis])
    }
}
