//! Octrees as plain recursive values: what a file is made from, and what is asked where a cell must be known.

use crate::random::Random;
use octvox_format::{Palette, SphericalNormal, Voxel, Writer};
use octvox_raytracer::Octree;
use std::io::Cursor;

/// Colours in the palette of the files that are written from trees.
pub const COLORS: u16 = 5;

/// A voxel and its children: none or eight.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Tree {
    /// What the cell looks like; for a cell with children, from afar.
    pub voxel: Voxel,
    /// In the order of octants x + 2y + 4z.
    pub children: Vec<Tree>,
}

impl Tree {
    /// A cell with nothing in it.
    #[must_use]
    pub fn empty() -> Self {
        Self::leaf(Voxel::EMPTY)
    }

    /// A cell without children.
    #[must_use]
    pub fn leaf(voxel: Voxel) -> Self {
        Self { voxel, children: Vec::new() }
    }

    /// A cell that looks like its first filled child.
    #[must_use]
    pub fn node(children: Vec<Self>) -> Self {
        assert_eq!(children.len(), 8);
        let filled = children.iter().find(|child| !child.voxel.is_empty());
        Self { voxel: filled.map_or(Voxel::EMPTY, |child| child.voxel), children }
    }

    /// A tree of at most `depth` levels below its root. A leaf is filled with the probability `fill`; a cell between
    /// the root and the finest level is a leaf with the probability `early`, as if it had been pruned.
    #[must_use]
    pub fn random(random: &mut Random, depth: u8, fill: f64, early: f64) -> Self {
        if depth == 0 {
            return if random.chance(fill) { Self::leaf(voxel(random)) } else { Self::empty() };
        }
        let mut child = || {
            let depth = if random.chance(early) { 0 } else { depth - 1 };
            Self::random(random, depth, fill, early)
        };
        Self::node((0..8).map(|_| child()).collect())
    }

    /// The tree in which only some finest cells are filled.
    #[must_use]
    pub fn of_cells(depth: u8, cells: &[([u32; 3], Voxel)]) -> Self {
        match cells {
            [] => Self::empty(),
            [(_, voxel), ..] if depth == 0 => Self::leaf(*voxel),
            _ => Self::node(
                (0..8)
                    .map(|octant| {
                        let half = 1u32 << (depth - 1);
                        let is_in =
                            |cell: &[u32; 3]| (0..3).all(|axis| (cell[axis] >= half) == upper(octant, axis));
                        let within = |cell: [u32; 3]| cell.map(|coordinate| coordinate % half);
                        let cells: Vec<_> = cells
                            .iter()
                            .filter(|(cell, _)| is_in(cell))
                            .map(|&(cell, voxel)| (within(cell), voxel))
                            .collect();
                        Self::of_cells(depth - 1, &cells)
                    })
                    .collect(),
            ),
        }
    }

    /// Levels below the root.
    #[must_use]
    pub fn depth(&self) -> u8 {
        self.children.iter().map(|child| child.depth() + 1).max().unwrap_or(0)
    }

    /// What is in a finest cell, of which there are `1 << depth` per axis.
    #[must_use]
    pub fn voxel_at(&self, cell: [u32; 3], depth: u8) -> Option<Voxel> {
        if self.children.is_empty() {
            return Some(self.voxel).filter(|voxel| !voxel.is_empty());
        }
        let half = 1u32 << (depth - 1);
        let octant = (0..3).map(|axis| usize::from(cell[axis] >= half) << axis).sum::<usize>();
        self.children[octant].voxel_at(cell.map(|coordinate| coordinate % half), depth - 1)
    }

    /// Number of filled cells, if there are `1 << depth` finest cells per axis.
    #[must_use]
    pub fn leaf_voxels(&self, depth: u8) -> u64 {
        match self.children.as_slice() {
            [] if self.voxel.is_empty() => 0,
            [] => 1 << (3 * depth),
            children => children.iter().map(|child| child.leaf_voxels(depth - 1)).sum(),
        }
    }

    /// The file of this tree.
    #[must_use]
    pub fn file(&self) -> Vec<u8> {
        fn write(tree: &Tree, writer: &mut Writer<Vec<u8>>) {
            if tree.children.is_empty() {
                writer.leaf(tree.voxel).unwrap();
            } else {
                writer.node(tree.voxel).unwrap();
                tree.children.iter().for_each(|child| write(child, writer));
            }
        }
        let mut writer = Writer::new(Vec::new(), &palette()).unwrap();
        write(self, &mut writer);
        writer.finish().unwrap()
    }

    /// The file of this tree, made ready for rays.
    #[must_use]
    pub fn octree(&self) -> Octree {
        Octree::read(Cursor::new(self.file())).unwrap()
    }
}

/// Whether an octant is the upper half of an axis.
fn upper(octant: usize, axis: usize) -> bool {
    octant >> axis & 1 == 1
}

/// The palette of the files that are written from trees.
#[must_use]
pub fn palette() -> Palette {
    Palette::new((0..COLORS as u8).map(|k| [40 * k, 255 - 40 * k, 130]).collect()).unwrap()
}

/// A filled voxel of any colour and normal.
pub fn voxel(random: &mut Random) -> Voxel {
    let palette_index = random.between(1, i32::from(COLORS)) as u16;
    let [theta, phi, ..] = random.bits().to_le_bytes();
    Voxel { palette_index, normal: SphericalNormal::from_bytes([theta, phi]) }
}
