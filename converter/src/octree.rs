//! The octree: a subtree for each block, and the top of the tree above them.

use crate::ConvertError;
use crate::block::BlockGrid;
use crate::block_tree::{BlockTree, BuiltBlock, planes};
use crate::coloring::Coloring;
use crate::extent::Extent;
use crate::lod::{Lod, Normals};
use crate::lod_color::Light;
use crate::output::encode;
use crate::prune::{prune, retain};
use crate::solid::{Inside, insert};
use crate::storage::{Storage, Stored};
use crate::structure::Structure;
use crate::subtree::Subtree;
use crate::voxel::Voxel;
use octvox_cli::Progress;
use octvox_format::NormalCode;
use octvox_format::v5::{LevelDefect, Levels};
use rayon::prelude::*;

/// The normal of the inside, which has none of its own.
const INSIDE_NORMAL: [f32; 3] = [0.0, 0.0, 1.0];

/// A complete octree with levels of detail.
pub(crate) struct Octree {
    /// The subtrees of the blocks, in Morton order.
    pub blocks: Vec<Block>,
    top: Structure,
    top_lod: Lod,
    pub grid: BlockGrid,
    pub normal_code: NormalCode,
    /// Filled cells of the finest level.
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
    /// Of the surface in it, for the levels above.
    surface: (Normals, Light),
    before_pruning: Extent,
    pub tree: Stored<BlockTree>,
}

/// What the octree is built with.
pub(crate) struct Build<'a> {
    pub coloring: Coloring<'a>,
    /// What is to be filled besides the surface.
    pub inside: Inside,
    pub grid: BlockGrid,
    /// How normals are stored.
    pub normal_code: NormalCode,
    pub prune: bool,
}

impl Octree {
    /// Builds the levels above the leaves, fills the inside, and prunes the levels if asked to.
    ///
    /// # Errors
    /// [`ConvertError::TemporaryFile`].
    pub(crate) fn build(
        subtrees: Vec<Subtree>,
        build: &Build<'_>,
        storage: &Storage,
        progress: &Progress,
    ) -> Result<Self, ConvertError> {
        progress.stage("build", subtrees.len() as u64);
        let (grid, inside, normal_code) = (build.grid, &build.inside, build.normal_code);
        let filling =
            Voxel { palette_index: build.coloring.inside(), normal: normal_code.encode(INSIDE_NORMAL) };
        let mut blocks = subtrees
            .into_par_iter()
            .enumerate()
            .map(|(index, subtree)| {
                progress.add(1);
                let leaves = storage.take(subtree.leaves)?;
                let cells = inside.of_block(index, &leaves.structure, grid);
                Block::new(subtree.code, BuiltBlock::new(leaves, build, cells.as_deref(), filling), storage)
            })
            .collect::<Result<Vec<Block>, ConvertError>>()?;
        for (code, cells) in &inside.part_blocks {
            blocks.push(Block::new(*code, BuiltBlock::inside(cells, build, filling), storage)?);
        }
        blocks.sort_by_key(|block| block.code);
        let codes: Vec<u32> = blocks.iter().map(|block| block.code).collect();

        let mut top = Structure::from_codes(&codes, grid.top_depth());
        let (indices, _) =
            build.coloring.filter(&top, |block| (blocks[block].surface.1, blocks[block].root.palette_index));
        let normals = |block: usize| blocks[block].surface.0;
        let (mut top_lod, _) = Lod::new(&top, normal_code, normals, |level, node| indices.get(level, node));
        if !inside.whole_blocks.is_empty() {
            blocks = insert_whole_blocks(&mut top, &mut top_lod, blocks, build, filling, storage)?;
        }
        let mut before_pruning = Extent::of_nodes(&top, grid.depth as usize);
        blocks.iter().for_each(|block| before_pruning.add(block.before_pruning));
        if build.prune {
            let kept = prune(&mut top, &mut top_lod, |block| (blocks[block].root, blocks[block].is_leaf));
            if let Some(kept) = kept {
                retain(&mut blocks, &kept);
            }
        }
        let nodes = top.nodes_with_children() + blocks.iter().map(|block| block.nodes).sum::<u64>();
        let Extent { leaf_voxels, nodes: unpruned_nodes } = before_pruning;
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

/// Adds the blocks that are wholly inside to the top of the tree, and returns all blocks.
fn insert_whole_blocks(
    top: &mut Structure,
    top_lod: &mut Lod,
    blocks: Vec<Block>,
    build: &Build<'_>,
    filling: Voxel,
    storage: &Storage,
) -> Result<Vec<Block>, ConvertError> {
    let mut whole = vec![0u64; (1usize << (3 * build.grid.top_depth())).div_ceil(64)];
    for &code in &build.inside.whole_blocks {
        whole[code as usize / 64] |= 1 << (code % 64);
    }
    let mut old = blocks.into_iter();
    let mut all = Vec::with_capacity(old.len());
    insert(top, top_lod, true, &whole, filling, |code, block| {
        // The old ones come in their order.
        let block = block.and_then(|_| old.next());
        all.push(
            block
                .map_or_else(|| Block::new(code as u32, BuiltBlock::whole(build.grid, filling), storage), Ok),
        );
    });
    all.into_iter().collect()
}

impl Block {
    /// # Errors
    /// [`ConvertError::TemporaryFile`].
    fn new(code: u32, built: BuiltBlock, storage: &Storage) -> Result<Self, ConvertError> {
        let BuiltBlock { tree, surface, before_pruning } = built;
        Ok(Self {
            code,
            root: tree.root(),
            is_leaf: tree.is_leaf(),
            nodes: tree.nodes(),
            filled_voxels: tree.filled_voxels() as u64,
            surface,
            before_pruning,
            tree: storage.put(tree)?,
        })
    }
}
