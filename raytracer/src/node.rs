//! A node of the octree in memory.

use crate::octree::cell_of_morton;
use bytemuck::{Pod, Zeroable};
use std::ops::Range;
use wide::u64x4;

/// Two levels of the octree at once: 4×4×4 cells in Morton order, as one mask and one index.
///
/// Bit `c` of the mask says whether cell `c` is filled, `c = x₀ + 2y₀ + 4z₀ + 8x₁ + 16y₁ + 32z₁` for the two low
/// bits of each coordinate. A byte of the mask is thus an octree cell of the level between, and the order of
/// the cells is the order of the file. What belongs to the filled cells stands side by side; the place of cell
/// `c` is the number of filled cells before it.
///
/// ```text
///  word 0, 1   mask        low half first
///  word 2      contents    bit 31: leaf, its cells are voxels
///                          bit 30: uniform, all its voxels are one (only of a leaf whose cells are all filled)
///                          bits 29..0: inner node: index of the first child node
///                                      leaf: index of the first voxel in the leaf payload, see `Node::first`
///  word 3      lod         index of the payload of the node itself and, behind it, of its filled bytes
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct Node {
    /// Filled cells; low half first, so that the layout is the same for either byte order.
    pub mask: [u32; 2],
    contents: u32,
    /// Index into the level-of-detail payload.
    pub lod: u32,
}

/// Cells of a [`Node`].
pub const CELLS: usize = 64;

/// Bit of word 2 that marks a leaf.
pub const LEAF: u32 = 1 << 31;

/// Bit of word 2 that marks a leaf whose voxels are all one.
pub const UNIFORM: u32 = 1 << 30;

/// The largest index a node can hold.
pub const MAX_INDEX: usize = (1 << 30) - 1;

/// Bits of word 2 that are an index.
pub const INDEX_MASK: u32 = MAX_INDEX as u32;

/// A place in each of the lists of an octree, or how far elements have moved in each.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    /// Index of a node.
    pub nodes: u32,
    /// Index of a voxel.
    pub voxels: u32,
    /// Index of a level of detail.
    pub lod: u32,
}

impl Place {
    /// Before the first element of each list.
    pub const START: Self = Self { nodes: 0, voxels: 0, lod: 0 };

    /// How far it is from a place that is not behind this one.
    #[must_use]
    pub fn minus(self, from: Self) -> Self {
        Self { nodes: self.nodes - from.nodes, voxels: self.voxels - from.voxels, lod: self.lod - from.lod }
    }
}

impl Node {
    /// An inner node whose filled cells are the nodes from `first_child` on.
    #[must_use]
    pub fn inner(mask: u64, first_child: u32, lod: u32) -> Self {
        debug_assert!(first_child as usize <= MAX_INDEX);
        Self { mask: halves(mask), contents: first_child, lod }
    }

    /// A node whose filled cells are the voxels from `first` on.
    #[must_use]
    pub fn leaf(mask: u64, first: u32, lod: u32) -> Self {
        debug_assert!(first as usize <= MAX_INDEX);
        Self { mask: halves(mask), contents: LEAF | first, lod }
    }

    /// A filled node all of whose voxels are the one at `first`.
    #[must_use]
    pub fn uniform(first: u32, lod: u32) -> Self {
        debug_assert!(first as usize <= MAX_INDEX);
        Self { mask: [u32::MAX; 2], contents: LEAF | UNIFORM | first, lod }
    }

    /// The same node when what it refers to has moved so far.
    #[must_use]
    pub fn moved(&self, by: Place) -> Self {
        let first = if self.is_leaf() { by.voxels } else { by.nodes };
        // Lists have no more than `MAX_INDEX` elements, so this leaves the flags alone.
        Self { contents: self.contents + first, lod: self.lod + by.lod, ..*self }
    }

    /// Bit `c` is cell `c`.
    #[must_use]
    pub fn cells(&self) -> u64 {
        u64::from(self.mask[0]) | u64::from(self.mask[1]) << 32
    }

    /// Whether the filled cells are voxels.
    #[must_use]
    pub fn is_leaf(&self) -> bool {
        self.contents & LEAF != 0
    }

    /// Whether all voxels of this leaf are one.
    #[must_use]
    pub fn is_uniform(&self) -> bool {
        self.contents & UNIFORM != 0
    }

    /// Index of the first child node, or of the first voxel.
    #[must_use]
    pub fn first(&self) -> u32 {
        self.contents & INDEX_MASK
    }

    /// Indices of the child nodes, if it has any.
    #[must_use]
    pub fn children(&self) -> Option<Range<usize>> {
        let first = self.first() as usize;
        (!self.is_leaf()).then(|| first..first + self.cells().count_ones() as usize)
    }

    /// The same inner node when its children have moved.
    #[must_use]
    pub fn with_first_child(&self, first: usize) -> Self {
        debug_assert!(!self.is_leaf() && first <= MAX_INDEX);
        Self { contents: first as u32, ..*self }
    }

    /// Index of the child node, or of the voxel, of filled cell `cell`.
    #[must_use]
    pub fn index_of(&self, cell: u32) -> u32 {
        if self.is_uniform() {
            return self.first();
        }
        let before = self.cells() & ((1u64 << cell) - 1);
        self.first() + before.count_ones()
    }

    /// Index of the level-of-detail payload of the octree cell that covers the eight cells of byte `byte`.
    #[must_use]
    pub fn lod_index_of(&self, byte: u32) -> u32 {
        if self.is_uniform() {
            return self.lod;
        }
        self.lod + 1 + filled_bytes(self.cells() & ((1u64 << (8 * byte)) - 1))
    }
}

/// How many bytes of `cells` are not zero: the filled octree cells of the level between.
#[must_use]
pub fn filled_bytes(cells: u64) -> u32 {
    cells.to_le_bytes().iter().filter(|&&byte| byte != 0).count() as u32
}

/// Per axis, the planes below and above some cells, `0..=4`; there is one.
#[must_use]
pub fn extent(cells: u64) -> [[u32; 2]; 3] {
    SLABS.map(|slabs| {
        let empty = (u64x4::splat(cells) & u64x4::new(slabs)).simd_eq(u64x4::splat(0)).to_bitmask();
        let filled = !empty & 0xF;
        [filled.trailing_zeros(), u32::BITS - filled.leading_zeros()]
    })
}

/// Per axis, the cells that have each coordinate.
const SLABS: [[u64; 4]; 3] = {
    let mut slabs = [[0; 4]; 3];
    let mut cell = 0;
    while cell < CELLS {
        let place = cell_of_morton(cell as u32);
        let mut axis = 0;
        while axis < 3 {
            slabs[axis][place[axis] as usize] |= 1 << cell;
            axis += 1;
        }
        cell += 1;
    }
    slabs
};

fn halves(mask: u64) -> [u32; 2] {
    [mask as u32, (mask >> 32) as u32]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    #[test]
    fn places_count_the_filled_cells_before() {
        let mask = 1u64 << 3 | 1 << 9 | 1 << 40 | 1 << 63;
        let node = Node::inner(mask, 100, 7);
        assert_eq!([3, 9, 40, 63].map(|cell| node.index_of(cell)), [100, 101, 102, 103]);
        assert_eq!([0, 1, 5, 7].map(|byte| node.lod_index_of(byte)), [8, 9, 10, 11]);
        assert!(!node.is_leaf());
        assert_eq!(node.cells(), mask);
    }

    #[test]
    fn a_uniform_leaf_has_one_voxel() {
        let node = Node::uniform(5, 9);
        assert!(node.is_leaf() && node.is_uniform());
        assert!((0..64).all(|cell| node.index_of(cell) == 5));
        assert!((0..8).all(|byte| node.lod_index_of(byte) == 9));
    }

    #[test]
    fn an_extent_is_the_least_box_about_its_cells() {
        let random = &mut Random::stream(11, 0);
        for _ in 0..5000 {
            // Few cells and many.
            let sparse = (0..random.between(0, 6)).fold(u64::MAX, |cells, _| cells & random.next());
            let cells = sparse | 1 << random.between(0, 64);
            let places = (0..64).filter(|cell| cells >> cell & 1 == 1).map(cell_of_morton);
            let expected = places.fold([[4, 0]; 3], |[x, y, z], place| {
                let grown = |[low, high]: [u32; 2], at: u32| [low.min(at), high.max(at + 1)];
                [grown(x, place[0]), grown(y, place[1]), grown(z, place[2])]
            });
            assert_eq!(extent(cells), expected, "{cells:#x}");
        }
    }

    #[test]
    fn moving_adds_to_the_index_of_its_list() {
        let place = Place { nodes: 100, voxels: 1000, lod: 10_000 };
        assert_eq!(Node::inner(9, 1, 2).moved(place), Node::inner(9, 101, 10_002));
        assert_eq!(Node::leaf(9, 1, 2).moved(place), Node::leaf(9, 1001, 10_002));
        assert_eq!(Node::uniform(1, 2).moved(place), Node::uniform(1001, 10_002));
    }

    #[test]
    fn a_node_is_four_words() {
        assert_eq!(size_of::<Node>(), size_of::<[u32; 4]>());
        let words: [u32; 4] = bytemuck::cast(Node::leaf(0x1_0000_0002, 3, 4));
        assert_eq!(words, [2, 1, LEAF | 3, 4]);
    }
}
