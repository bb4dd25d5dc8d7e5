//! The size of an octree as if nothing were kept as a cube.

use crate::structure::Structure;

/// How much an octree, or a part of it, would hold if cubes of equal cells were not leaves.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Extent {
    /// Filled cells of the finest level.
    pub leaf_voxels: u64,
    /// Nodes with children.
    pub nodes: u64,
}

impl Extent {
    /// That of a cube with `depth` levels below it, filled throughout.
    pub(crate) fn of_cube(depth: usize) -> Self {
        let leaf_voxels = 1 << (3 * depth);
        Self { leaf_voxels, nodes: (leaf_voxels - 1) / 7 }
    }

    /// That of the nodes of a structure whose root has `depth` levels below it. Nodes without children are cubes.
    pub(crate) fn of_nodes(structure: &Structure, depth: usize) -> Self {
        let mut extent = Self::default();
        for (level, masks) in structure.levels.iter().enumerate() {
            for mask in masks {
                extent.add(if *mask == 0 {
                    Self::of_cube(depth - level)
                } else {
                    Self { leaf_voxels: 0, nodes: 1 }
                });
            }
        }
        extent
    }

    pub(crate) fn add(&mut self, other: Self) {
        self.leaf_voxels += other.leaf_voxels;
        self.nodes += other.nodes;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cube_counts_as_what_is_in_it() {
        // Seven cubes of eight cells each, and a node with one cell.
        let structure = Structure { levels: vec![vec![0xff], vec![0, 0, 0, 0, 0, 0, 0, 1]] };
        let extent = Extent::of_nodes(&structure, 2);
        // Cells of the finest level of a structure are counted by whoever has them.
        assert_eq!((extent.leaf_voxels, extent.nodes), (56, 9));
        let cube = Extent::of_cube(2);
        assert_eq!((cube.leaf_voxels, cube.nodes), (64, 9));
        let cell = Extent::of_cube(0);
        assert_eq!((cell.leaf_voxels, cell.nodes), (1, 0));
    }
}
