//! The subtree of a block: its leaves, and the levels of detail above them.

use crate::lod::Lod;
use crate::output::{append_leaves, encode};
use crate::prune::{prune, retain};
use crate::storage::{Spill, append_list, take_list};
use crate::structure::Structure;
use crate::voxel::Voxel;
use crate::voxel_filter::Leaves;
use octvox_format::NormalCode;
use octvox_format::v5::Planes;

/// The octree of a block.
#[derive(Debug)]
pub(crate) struct BlockTree {
    structure: Structure,
    lod: Lod,
    normals: Vec<[u8; 2]>,
    indices: Indices,
}

/// The palette indices of the leaves of a block.
#[derive(Debug)]
pub(crate) enum Indices {
    /// All have the same.
    Same(u16),
    /// Each has its own.
    Each(Vec<u16>),
}

impl BlockTree {
    /// Builds the levels above the leaves, and prunes them if asked to.
    pub(crate) fn build(leaves: Leaves, indices: Indices, normal_code: NormalCode, pruning: bool) -> Self {
        let mut tree =
            Self { structure: leaves.structure, lod: Lod::default(), normals: leaves.normals, indices };
        tree.lod = Lod::new(&tree.structure, normal_code, |leaf| tree.leaf(leaf));
        if pruning {
            let (mut structure, mut lod) =
                (std::mem::take(&mut tree.structure), std::mem::take(&mut tree.lod));
            let kept = prune(&mut structure, &mut lod, |leaf| (tree.leaf(leaf), true));
            (tree.structure, tree.lod) = (structure, lod);
            if let Some(kept) = kept {
                retain(&mut tree.normals, &kept);
                if let Indices::Each(indices) = &mut tree.indices {
                    retain(indices, &kept);
                }
            }
        }
        tree
    }

    #[inline]
    fn leaf(&self, leaf: usize) -> Voxel {
        let palette_index = match &self.indices {
            Indices::Same(index) => *index,
            Indices::Each(indices) => indices[leaf],
        };
        Voxel { palette_index, normal: self.normals[leaf] }
    }

    /// The voxel of the root.
    pub(crate) fn root(&self) -> Voxel {
        self.lod.root(|leaf| self.leaf(leaf))
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
