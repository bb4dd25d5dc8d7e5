//! The 48 symmetries of the cube.

use crate::tree::Tree;
use glam::DVec3;

/// A permutation of the axes, after which some of them are reversed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Symmetry {
    /// Axis `k` of the image is axis `axes[k]` of the original.
    axes: [usize; 3],
    /// Axes of the image that run the other way.
    reversed: [bool; 3],
}

impl Symmetry {
    /// All of them; the first changes nothing.
    pub fn all() -> impl Iterator<Item = Self> {
        let permutations = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [1, 0, 2], [2, 1, 0]];
        permutations.into_iter().flat_map(|axes| {
            (0..8).map(move |bits| Self { axes, reversed: [0, 1, 2].map(|axis| bits >> axis & 1 == 1) })
        })
    }

    /// The image of a cell in a cube of `1 << depth` cells per axis.
    #[must_use]
    pub fn cell(&self, cell: [u32; 3], depth: u8) -> [u32; 3] {
        let last = (1u32 << depth) - 1;
        self.each(|axis, reversed| if reversed { last - cell[axis] } else { cell[axis] })
    }

    /// The image of a point, the cube being [0, 1]³.
    #[must_use]
    pub fn point(&self, point: DVec3) -> DVec3 {
        DVec3::from_array(self.each(|axis, reversed| if reversed { 1.0 - point[axis] } else { point[axis] }))
    }

    /// The image of a direction.
    #[must_use]
    pub fn vector(&self, vector: DVec3) -> DVec3 {
        DVec3::from_array(self.each(|axis, reversed| if reversed { -vector[axis] } else { vector[axis] }))
    }

    /// The image of a tree. Voxels keep their normals.
    #[must_use]
    pub fn tree(&self, tree: &Tree) -> Tree {
        let mut image = tree.clone();
        for (octant, child) in tree.children.iter().enumerate() {
            let [x, y, z] = self.cell([0, 1, 2].map(|axis| (octant >> axis & 1) as u32), 1);
            image.children[(x + 2 * y + 4 * z) as usize] = self.tree(child);
        }
        image
    }

    fn each<T>(&self, of: impl Fn(usize, bool) -> T) -> [T; 3] {
        [0, 1, 2].map(|axis| of(self.axes[axis], self.reversed[axis]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn there_are_48_different_ones() {
        let images: Vec<_> = Symmetry::all().map(|symmetry| symmetry.cell([0, 1, 2], 3)).collect();
        assert_eq!(images.len(), 48);
        assert!(images.iter().enumerate().all(|(k, image)| !images[..k].contains(image)));
    }

    #[test]
    fn trees_and_cells_have_the_same_image() {
        let random = &mut Random::new(1);
        let tree = Tree::random(random, 3, 0.3, 0.1);
        for symmetry in Symmetry::all() {
            let image = symmetry.tree(&tree);
            for code in 0..512 {
                let cell = [code % 8, code / 8 % 8, code / 64];
                assert_eq!(image.voxel_at(symmetry.cell(cell, 3), 3), tree.voxel_at(cell, 3));
            }
        }
    }
}
