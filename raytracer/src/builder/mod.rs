//! From a file to an octree of nodes of two levels.
//!
//! ```text
//!  version_4.rs ── preorder.rs ─┐                      ┌─ pieces.rs: subtrees, each on its own, in parallel
//!                               ├─ Cells ─ assembly.rs ┤
//!  version_5.rs ── levels.rs ───┘                      └─ the octree above them, into which the pieces are put
//! ```
//!
//! In the end, `level_order.rs` moves the few nodes above the lowest level behind the others.
//!
//! The order of a file is Morton order, and so is the order of cells in a node: voxels arrive in the order in which
//! they are kept. So a piece is put in as it is but for the place where its lists begin, and the octree depends
//! neither on where it was cut nor on the version of the file.

mod assembly;
mod bounds;
#[cfg(test)]
mod by_record;
mod level_order;
mod levels;
mod pieces;
mod preorder;
#[cfg(test)]
mod tests;
mod version_4;
mod version_5;

use crate::grid::Grid;
use crate::node::Node;
use crate::octree::{Bounds, MAX_DEPTH};
use crate::{LoadError, Octree};
use assembly::{Assembly, Lists};
use octvox_format::v5::{self, Source};
use octvox_format::{FormatError, MaterialPalette, NormalCode, WorldTransform};

/// Loads a file of any version, on the current thread pool.
pub(crate) fn load(source: impl Source + Sync) -> Result<Octree, LoadError> {
    match version_4::load(&source) {
        Err(LoadError::Format(FormatError::UnsupportedVersion { version: v5::VERSION })) => {
            version_5::load(source)
        }
        result => result,
    }
}

/// A single position bit stays free in the deepest octree that can be traced.
fn check_depth(depth: u8) -> Result<(), LoadError> {
    if depth > MAX_DEPTH { Err(LoadError::TooDeep { depth, limit: MAX_DEPTH }) } else { Ok(()) }
}

/// What a file holds.
struct Loaded {
    /// The finest level of the file.
    depth: u8,
    materials: MaterialPalette,
    normal_code: NormalCode,
    world: Option<WorldTransform>,
    assembly: Assembly,
    root: Option<Node>,
}

impl Loaded {
    fn octree(self) -> Result<Octree, LoadError> {
        // A single voxel is traced as eight finer ones.
        let depth = self.depth.max(1);
        let Assembly { lists: Lists { mut nodes, mut voxels, mut lod }, leaf_voxels, .. } = self.assembly;
        let empty = Bounds { low: [0; 3], high: [0; 3] };
        let bounds = self.root.as_ref().map_or(empty, |root| bounds::bounds(&nodes, root, depth));
        let root = self.root.map_or(0, |root| level_order::sort(&mut nodes, root, depth)) as u32;
        nodes.shrink_to_fit();
        voxels.shrink_to_fit();
        lod.shrink_to_fit();
        let mut octree = Octree {
            depth,
            materials: self.materials,
            normal_code: self.normal_code,
            world: self.world,
            nodes,
            root,
            voxels,
            lod,
            leaf_voxels,
            bounds,
            grid: Grid::none(),
            root_entrance: Grid::none(),
        };
        octree.root_entrance = Grid::new(&octree, 0);
        octree.set_grid(Grid::DEFAULT_LEVEL);
        Ok(octree)
    }
}
