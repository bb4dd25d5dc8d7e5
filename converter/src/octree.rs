//! The octree: a subtree for each block, and the top of the tree above them.

use crate::ConvertError;
use crate::block::BlockGrid;
use crate::block_tree::{BlockTree, Indices, planes};
use crate::lod::Lod;
use crate::output::encode;
use crate::prune::{prune, retain};
use crate::storage::{Storage, Stored};
use crate::structure::Structure;
use crate::subtree::Subtree;
use crate::voxel::Voxel;
use crate::voxel_filter::Leaves;
use octvox_cli::Progress;
use octvox_format::NormalCode;
use octvox_format::v5::{LevelDefect, Levels};
use rayon::prelude::*;

/// A complete octree with levels of detail.
pub(crate) struct Octree {
    /// The subtrees of the blocks, in Morton order.
    pub blocks: Vec<Block>,
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

/// The subtree of a block, and what has to be known of it when it is out of memory.
pub(crate) struct Block {
    /// Morton code of the block.
    pub code: u32,
    root: Voxel,
    is_leaf: bool,
    nodes: u64,
    /// Filled voxels on all levels.
    pub filled_voxels: u64,
    pub tree: Stored<BlockTree>,
}

impl Octree {
    /// Builds the levels above the leaves, and prunes them if asked to. `indices` gives the palette indices of the leaves.
    ///
    /// # Errors
    /// [`ConvertError::TemporaryFile`].
    pub(crate) fn build(
        subtrees: Vec<Subtree>,
        indices: impl Fn(&Leaves) -> Indices + Sync,
        grid: BlockGrid,
        normal_code: NormalCode,
        pruning: bool,
        storage: &Storage,
        progress: &Progress,
    ) -> Result<Self, ConvertError> {
        progress.stage("build", subtrees.len() as u64);
        let codes: Vec<u32> = subtrees.iter().map(|subtree| subtree.code).collect();
        let leaf_voxels = subtrees.iter().map(|subtree| subtree.leaf_voxels).sum();
        let mut top = Structure::from_codes(&codes, grid.top_depth());
        let unpruned_nodes = top.nodes() + subtrees.iter().map(|subtree| subtree.nodes).sum::<u64>();

        let mut blocks = subtrees
            .into_par_iter()
            .map(|subtree| {
                progress.add(1);
                let leaves = storage.take(subtree.leaves)?;
                let indices = indices(&leaves);
                let tree = BlockTree::build(leaves, indices, normal_code, pruning);
                Ok(Block {
                    code: subtree.code,
                    root: tree.root(),
                    is_leaf: tree.is_leaf(),
                    nodes: tree.nodes(),
                    filled_voxels: tree.filled_voxels() as u64,
                    tree: storage.put(tree)?,
                })
            })
            .collect::<Result<Vec<Block>, ConvertError>>()?;
        let mut top_lod = Lod::new(&top, normal_code, |block| blocks[block].root);
        if pruning {
            let kept = prune(&mut top, &mut top_lod, |block| (blocks[block].root, blocks[block].is_leaf));
            if let Some(kept) = kept {
                retain(&mut blocks, &kept);
            }
        }
        let nodes = top.nodes_with_children() + blocks.iter().map(|block| block.nodes).sum::<u64>();
        Ok(Self { blocks, top, top_lod, grid, normal_code, leaf_voxels, unpruned_nodes, nodes })
    }

    /// Filled voxels on all levels.
    pub(crate) fn filled_voxels(&self) -> u64 {
        self.top_lod.voxel_count() as u64 + self.blocks.iter().map(|block| block.filled_voxels).sum::<u64>()
    }

    /// The top of the tree as bytes of a file of version 4, and where in them the subtrees of the blocks go, in their
    /// order.
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

    /// The levels above the blocks as version 5 stores them.
    pub(crate) fn top_levels(&self) -> Result<Levels, LevelDefect> {
        Levels::top(self.grid.top_depth() as u8, planes(&self.top, &self.top_lod, 0))
    }
}
