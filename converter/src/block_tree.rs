//! The subtree of a block: its leaves, and the levels of detail above them.

use crate::block::BlockGrid;
use crate::coloring::Indices;
use crate::extent::Extent;
use crate::lod::{Lod, Normals};
use crate::lod_color::Light;
use crate::octree::Build;
use crate::output::{append_leaves, encode};
use crate::prune::{prune, retain};
use crate::solid::insert;
use crate::storage::{Spill, append_list, take_list};
use crate::structure::Structure;
use crate::voxel::Voxel;
use crate::voxel_filter::Leaves;
use octvox_format::v5::Planes;

/// The octree of a block.
#[derive(Debug)]
pub(crate) struct BlockTree {
    structure: Structure,
    lod: Lod,
    normals: Vec<[u8; 2]>,
    indices: Indices,
}

/// The octree of a block, and what the levels above have to know of it.
pub(crate) struct BuiltBlock {
    pub tree: BlockTree,
    /// Of the surface in it.
    pub surface: (Normals, Light),
    pub before_pruning: Extent,
}

impl BuiltBlock {
    /// The octree of a block with voxels. `inside` are cells in Morton order that are filled with `filling`.
    pub(crate) fn new(leaves: Leaves, build: &Build<'_>, inside: Option<&[u64]>, filling: Voxel) -> Self {
        let indices = build.coloring.leaves(&leaves);
        let (node_indices, light) = build.coloring.nodes(&leaves, &indices);
        let leaf_normals = |leaf: usize| Normals::of(leaves.normals[leaf], build.normal_code);
        let index = |level, node| node_indices.get(level, node);
        let (lod, normals) = Lod::new(&leaves.structure, build.normal_code, leaf_normals, index);
        let mut tree = BlockTree { structure: leaves.structure, lod, normals: leaves.normals, indices };
        if let Some(inside) = inside {
            tree.insert(true, inside, filling);
        }
        Self::finish(tree, (normals, light), build)
    }

    /// A block without a surface, of which cells in Morton order are inside.
    pub(crate) fn inside(inside: &[u64], build: &Build<'_>, filling: Voxel) -> Self {
        let mut tree = BlockTree::empty(build.grid, filling);
        tree.insert(false, inside, filling);
        Self::finish(tree, without_surface(filling), build)
    }

    /// A block that is wholly inside.
    pub(crate) fn whole(grid: BlockGrid, filling: Voxel) -> Self {
        let mut tree = BlockTree::empty(grid, filling);
        match (tree.structure.levels.first_mut(), tree.lod.levels.first_mut()) {
            (Some(masks), Some(voxels)) => {
                masks.push(0);
                voxels.push(filling);
            }
            _ => tree.normals.push(filling.normal),
        }
        let before_pruning = Extent::of_cube(grid.block_depth as usize);
        Self { tree, surface: without_surface(filling), before_pruning }
    }

    /// Counts what there is, and prunes it if asked to.
    fn finish(mut tree: BlockTree, surface: (Normals, Light), build: &Build<'_>) -> Self {
        let mut before_pruning = Extent::of_nodes(&tree.structure, build.grid.block_depth as usize);
        before_pruning.leaf_voxels += tree.normals.len() as u64;
        if build.prune {
            tree.prune();
        }
        Self { tree, surface, before_pruning }
    }
}

fn without_surface(filling: Voxel) -> (Normals, Light) {
    (Normals { sum: [0.0; 3], stored: filling.normal }, Light::default())
}

impl BlockTree {
    fn empty(grid: BlockGrid, filling: Voxel) -> Self {
        let depth = grid.block_depth as usize;
        Self {
            structure: Structure { levels: vec![Vec::new(); depth] },
            lod: Lod { levels: vec![Vec::new(); depth] },
            normals: Vec::new(),
            indices: Indices::Same(filling.palette_index),
        }
    }

    fn insert(&mut self, has_surface: bool, inside: &[u64], filling: Voxel) {
        let (mut structure, mut lod) = (std::mem::take(&mut self.structure), std::mem::take(&mut self.lod));
        let same = matches!(self.indices, Indices::Same(index) if index == filling.palette_index);
        let (mut normals, mut indices) = (Vec::with_capacity(self.normals.len()), Vec::new());
        insert(&mut structure, &mut lod, has_surface, inside, filling, |_, leaf| {
            let voxel = leaf.map_or(filling, |leaf| self.leaf(leaf));
            normals.push(voxel.normal);
            if !same {
                indices.push(voxel.palette_index);
            }
        });
        (self.structure, self.lod, self.normals) = (structure, lod, normals);
        if !same {
            self.indices = Indices::Each(indices);
        }
    }

    fn prune(&mut self) {
        let (mut structure, mut lod) = (std::mem::take(&mut self.structure), std::mem::take(&mut self.lod));
        let kept = prune(&mut structure, &mut lod, |leaf| (self.leaf(leaf), true));
        (self.structure, self.lod) = (structure, lod);
        if let Some(kept) = kept {
            retain(&mut self.normals, &kept);
            if let Indices::Each(indices) = &mut self.indices {
                retain(indices, &kept);
            }
        }
    }

    #[inline]
    fn leaf(&self, leaf: usize) -> Voxel {
        Voxel { palette_index: self.indices.get(leaf), normal: self.normals[leaf] }
    }

    /// The voxel of the root.
    pub(crate) fn root(&self) -> Voxel {
        self.lod.levels.first().map_or_else(|| self.leaf(0), |level| level[0])
    }

    /// Whether nothing is below the root, for the block is a single cell or has been pruned to its root.
    pub(crate) fn is_leaf(&self) -> bool {
        self.structure.levels.first().is_none_or(|level| level[0] == 0)
    }

    /// Nodes with children.
    pub(crate) fn nodes(&self) -> u64 {
        self.structure.nodes_with_children()
    }

    /// Filled voxels on all levels.
    pub(crate) fn filled_voxels(&self) -> usize {
        self.lod.voxel_count() + self.normals.len()
    }

    /// As version 4 stores it.
    pub(crate) fn encode(&self) -> Vec<u8> {
        if self.structure.levels.is_empty() {
            return self.leaf(0).to_word(false).to_vec();
        }
        match &self.indices {
            // Telling the cases apart once keeps the inner loop short.
            Indices::Same(palette_index) => encode(&self.structure, &self.lod, |mask, first, bytes| {
                let leaf = |k: usize| Voxel { palette_index: *palette_index, normal: self.normals[k] };
                append_leaves(mask, first, leaf, bytes);
            }),
            Indices::Each(_) => encode(&self.structure, &self.lod, |mask, first, bytes| {
                append_leaves(mask, first, |leaf| self.leaf(leaf), bytes);
            }),
        }
    }

    /// As version 5 stores it.
    pub(crate) fn planes(&self) -> Planes {
        let mut planes = planes(&self.structure, &self.lod, self.normals.len());
        planes.normals.extend_from_slice(&self.normals);
        match &self.indices {
            Indices::Same(index) => planes.palette_indices.resize(planes.normals.len(), *index),
            Indices::Each(indices) => planes.palette_indices.extend_from_slice(indices),
        }
        planes
    }
}

/// The voxels above the finest level as version 5 stores them, with room for `leaves` more.
pub(crate) fn planes(structure: &Structure, lod: &Lod, leaves: usize) -> Planes {
    let voxels = lod.voxel_count() + leaves;
    let mut planes = Planes {
        masks: structure.levels.concat(),
        palette_indices: Vec::with_capacity(voxels),
        normals: Vec::with_capacity(voxels),
    };
    let nodes = || lod.levels.iter().flatten();
    planes.palette_indices.extend(nodes().map(|voxel| voxel.palette_index));
    planes.normals.extend(nodes().map(|voxel| voxel.normal));
    planes
}

impl Spill for BlockTree {
    fn memory_bytes(&self) -> usize {
        let indices = match &self.indices {
            Indices::Same(_) => 0,
            Indices::Each(indices) => size_of_val(&indices[..]),
        };
        let levels = self.structure.levels.memory_bytes() + self.lod.levels.memory_bytes();
        size_of::<Self>() + levels + size_of_val(&self.normals[..]) + indices
    }

    fn append_to(&self, bytes: &mut Vec<u8>) {
        self.structure.levels.append_to(bytes);
        self.lod.levels.append_to(bytes);
        append_list(&self.normals, bytes);
        match &self.indices {
            Indices::Same(index) => append_list(&[*index], bytes),
            Indices::Each(indices) => append_list(indices, bytes),
        }
    }

    fn from_bytes(bytes: &mut &[u8]) -> Option<Self> {
        let structure = Structure { levels: Spill::from_bytes(bytes)? };
        let lod = Lod { levels: Spill::from_bytes(bytes)? };
        let (normals, indices) = (take_list::<[u8; 2]>(bytes)?, take_list(bytes)?);
        // A single index is that of all leaves, however many there are.
        let indices = if let [index] = indices[..] { Indices::Same(index) } else { Indices::Each(indices) };
        Some(Self { structure, lod, normals, indices })
    }
}
