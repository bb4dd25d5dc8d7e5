//! The octree: a subtree for each block, and the top of the tree above them.

use crate::block::BlockGrid;
use crate::lod::Lod;
use crate::output::{append_leaves, encode};
use crate::prune::{prune, retain};
use crate::structure::Structure;
use crate::subtree::Subtree;
use crate::voxel::Voxel;
use octvox_cli::Progress;
use octvox_format::NormalCode;
use octvox_format::v5::{LevelDefect, Levels, Planes, Subtree as StoredSubtree};
use rayon::prelude::*;

/// A complete octree with levels of detail.
pub(crate) struct Octree {
    /// The subtrees of the blocks, in Morton order.
    blocks: Vec<BlockTree>,
    top: Structure,
    top_lod: Lod,
    pub grid: BlockGrid,
    pub normal_code: NormalCode,
    pub leaf_voxels: u64,
    /// Nodes with children before pruning.
    pub unpruned_nodes: u64,
    /// Nodes with children.
    pub nodes: u64,
}

/// The subtree of a block.
struct BlockTree {
    /// Morton code of the block.
    code: u32,
    structure: Structure,
    lod: Lod,
    normals: Vec<[u8; 2]>,
    indices: Indices,
}

/// The palette indices of the leaves of a block.
pub(crate) enum Indices {
    /// All have the same.
    Same(u16),
    /// Each has its own.
    Each(Vec<u16>),
}

impl Octree {
    /// Builds the levels above the leaves, and prunes them if asked to. `indices` gives the palette indices of a subtree.
    pub(crate) fn build(
        subtrees: Vec<Subtree>,
        indices: impl Fn(&Subtree) -> Indices + Sync,
        grid: BlockGrid,
        normal_code: NormalCode,
        pruning: bool,
        progress: &Progress,
    ) -> Self {
        progress.stage("build", subtrees.len() as u64);
        let codes: Vec<u32> = subtrees.iter().map(|subtree| subtree.code).collect();
        let leaf_voxels = subtrees.iter().map(|subtree| subtree.leaves.normals.len() as u64).sum();
        let mut top = Structure::from_codes(&codes, grid.top_depth());
        let unpruned_nodes =
            top.nodes() + subtrees.iter().map(|subtree| subtree.leaves.structure.nodes()).sum::<u64>();

        let mut blocks: Vec<BlockTree> = subtrees
            .into_par_iter()
            .map(|subtree| {
                progress.add(1);
                let indices = indices(&subtree);
                BlockTree::build(subtree, indices, normal_code, pruning)
            })
            .collect();
        let mut top_lod = Lod::new(&top, normal_code, |block| blocks[block].root());
        if pruning {
            let kept = prune(&mut top, &mut top_lod, |block| (blocks[block].root(), blocks[block].is_leaf()));
            if let Some(kept) = kept {
                retain(&mut blocks, &kept);
            }
        }
        let nodes = count_nodes(&top) + blocks.iter().map(|block| count_nodes(&block.structure)).sum::<u64>();
        Self { blocks, top, top_lod, grid, normal_code, leaf_voxels, unpruned_nodes, nodes }
    }

    /// The top of the tree as bytes of the file, and where in them the subtrees of the blocks go, in their order.
    pub(crate) fn encode_top(&self) -> (Vec<u8>, Vec<usize>) {
        if self.top.levels.is_empty() {
            return (Vec::new(), vec![0]);
        }
        let mut places = Vec::with_capacity(self.blocks.len());
        let bytes = encode(&self.top, &self.top_lod, |mask, _, bytes| {
            for octant in 0..8 {
                if mask >> octant & 1 == 1 {
                    places.push(bytes.len());
                } else {
                    bytes.extend_from_slice(&Voxel::EMPTY.to_word(false));
                }
            }
        });
        (bytes, places)
    }

    /// The subtree of a block as bytes of the file.
    pub(crate) fn encode_block(&self, block: usize) -> Vec<u8> {
        self.blocks[block].encode()
    }

    /// The subtree of a block as version 5 stores it.
    pub(crate) fn stored_subtree(&self, block: usize) -> Result<StoredSubtree, LevelDefect> {
        let block = &self.blocks[block];
        let depth = self.grid.depth as u8;
        let levels = Levels::subtree(self.grid.top_depth() as u8, depth, block.planes())?;
        Ok(StoredSubtree { code: block.code.into(), levels })
    }

    /// The levels above the blocks as version 5 stores them.
    pub(crate) fn stored_top(&self) -> Result<Levels, LevelDefect> {
        Levels::top(self.grid.top_depth() as u8, planes(&self.top, &self.top_lod, 0))
    }

    /// Filled voxels on all levels.
    pub(crate) fn filled_voxels(&self) -> u64 {
        let blocks: usize = self.blocks.iter().map(BlockTree::filled_voxels).sum();
        self.top_lod.voxel_count() as u64 + blocks as u64
    }

    /// Filled voxels of a block, on all its levels.
    pub(crate) fn block_voxels(&self, block: usize) -> u64 {
        self.blocks[block].filled_voxels() as u64
    }

    /// Number of blocks.
    pub(crate) fn block_count(&self) -> usize {
        self.blocks.len()
    }
}

impl BlockTree {
    fn build(subtree: Subtree, indices: Indices, normal_code: NormalCode, pruning: bool) -> Self {
        let leaves = subtree.leaves;
        let mut tree = Self {
            code: subtree.code,
            structure: leaves.structure,
            lod: Lod::default(),
            normals: leaves.normals,
            indices,
        };
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

    fn root(&self) -> Voxel {
        self.lod.root(|leaf| self.leaf(leaf))
    }

    /// Whether nothing is below the root, for the block is a single cell or has been pruned to its root.
    fn is_leaf(&self) -> bool {
        self.structure.levels.first().is_none_or(|level| level[0] == 0)
    }

    fn filled_voxels(&self) -> usize {
        self.lod.voxel_count() + self.normals.len()
    }

    fn planes(&self) -> Planes {
        let mut planes = planes(&self.structure, &self.lod, self.normals.len());
        planes.normals.extend_from_slice(&self.normals);
        match &self.indices {
            Indices::Same(index) => planes.palette_indices.resize(planes.normals.len(), *index),
            Indices::Each(indices) => planes.palette_indices.extend_from_slice(indices),
        }
        planes
    }

    fn encode(&self) -> Vec<u8> {
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
}

/// The voxels above the finest level, with room for `leaves` more.
fn planes(structure: &Structure, lod: &Lod, leaves: usize) -> Planes {
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

/// Nodes that have children.
fn count_nodes(structure: &Structure) -> u64 {
    structure.levels.iter().flatten().filter(|mask| **mask != 0).count() as u64
}
