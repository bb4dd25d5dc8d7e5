//! Filling the inside.
//!
//! ```text
//!  blocks with voxels ▶ rows ▶ empty_regions ▶ flood ─────────────────────▶ Inside ▶ insertion into each block's octree
//!  mesh ▶ open_edges ▶ winding_number ▶ open_mesh (only if there are holes) ──┘
//! ```
//!
//! A cell is inside if it cannot be reached from outside the cube by a walk through faces of empty cells ([`flood`]). The
//! surface is closed to such walks where the mesh is, so nothing else is asked for a closed mesh, whatever its orientation.
//! A mesh with holes is also filled where it winds around a cell by one half or more ([`open_mesh`]).
//!
//! What is inside is kept as the largest cubes that fit, so a solid model needs little more than its surface.

mod empty_regions;
mod filled_blocks;
mod flood;
mod insertion;
mod open_edges;
mod open_mesh;
mod rows;
mod winding_number;

pub(crate) use insertion::insert;

use crate::ConvertError;
use crate::block::BlockGrid;
use crate::fixed_point::{GridPoint, SUBVOXELS};
use crate::storage::Storage;
use crate::structure::Structure;
use crate::subtree::Subtree;
use crate::surface::Surface;
use empty_regions::EmptyRegions;
use filled_blocks::FilledBlocks;
use flood::Flood;
use open_edges::OpenEdges;
use open_mesh::{Found, OpenMesh};
use rayon::prelude::*;
use rows::Rows;

/// More open edges than this are no mesh with holes.
const MAX_OPEN_EDGES: u64 = 100_000;

/// What is inside a model.
#[derive(Debug, Default)]
pub(crate) struct Inside {
    /// For each block with voxels.
    of_blocks: Vec<BlockInside>,
    /// Blocks without voxels that are wholly inside, as Morton codes in ascending order.
    pub whole_blocks: Vec<u32>,
    /// Blocks without voxels that are inside in part: Morton code and cells in Morton order.
    pub part_blocks: Vec<(u32, Vec<u64>)>,
    /// What the user should know.
    pub warning: Option<String>,
}

/// What is inside in a block with voxels.
#[derive(Debug)]
enum BlockInside {
    Nothing,
    /// Some of its empty regions. Finding them again takes less than keeping their cells.
    Regions(Vec<bool>),
    Cells(Rows),
}

/// Coordinates of the sub-voxel grid in cells.
fn in_cells(point: GridPoint) -> [f64; 3] {
    point.map(|coordinate| f64::from(coordinate) / f64::from(SUBVOXELS))
}

impl Inside {
    /// Finds what the voxels enclose, and what the surface does if it has holes.
    ///
    /// # Errors
    /// [`ConvertError::OpenMesh`] if the mesh has open edges and no inside can be told; [`ConvertError::TemporaryFile`].
    pub(crate) fn find(
        subtrees: &[Subtree],
        surface: &Surface<'_>,
        grid: BlockGrid,
        storage: &Storage,
    ) -> Result<Self, ConvertError> {
        let blocks = FilledBlocks { subtrees, storage, grid };
        let flood = Flood::new(blocks)?;
        let mut inside = Self {
            of_blocks: flood.enclosed_regions.into_iter().map(BlockInside::of_regions).collect(),
            whole_blocks: flood.enclosed_blocks,
            ..Self::default()
        };
        let open = OpenEdges::find(surface);
        if open.count == 0 {
            return Ok(inside);
        }
        let enclosed = inside.cells(blocks)?;
        let leaf_voxels: u64 = subtrees.iter().map(|subtree| subtree.leaf_voxels).sum();
        // Voxels of an open surface may happen to enclose a few cells.
        if enclosed >= leaf_voxels {
            return Ok(inside);
        }
        let open_edges = open.count;
        if open_edges <= MAX_OPEN_EDGES {
            let triangles = (0..surface.triangles.len())
                .map(|triangle| surface.corners(triangle).map(in_cells))
                .collect();
            let mesh = OpenMesh::new(triangles, open.boundary);
            let (filled, found) = inside.filled_up(&mesh, blocks)?;
            if found.cells > 2 * found.doubtful {
                return Ok(filled);
            }
        }
        if enclosed == 0 {
            return Err(ConvertError::OpenMesh { open_edges });
        }
        inside.warning = Some(format!(
            "the mesh has {open_edges} open edges; only what its voxels enclose without gaps has been filled: close the \
             holes of the mesh to fill the rest"
        ));
        Ok(inside)
    }

    /// The inside cells of a block with voxels, in Morton order; `None` if there are none.
    pub(crate) fn of_block(&self, index: usize, structure: &Structure, grid: BlockGrid) -> Option<Vec<u64>> {
        let rows = match self.of_blocks.get(index)? {
            BlockInside::Nothing => None,
            inside => inside.rows(&Rows::of_structure(structure, grid)),
        }?;
        (!rows.is_empty()).then(|| rows.to_morton())
    }

    /// Number of cells.
    fn cells(&self, blocks: FilledBlocks<'_>) -> Result<u64, ConvertError> {
        let in_block = |index: usize| match &self.of_blocks[index] {
            BlockInside::Nothing => Ok(0),
            inside => Ok(inside.rows(&blocks.rows(index)?).map_or(0, |rows| rows.count())),
        };
        let in_blocks = (0..blocks.len()).into_par_iter().map(in_block).sum::<Result<u64, ConvertError>>()?;
        Ok(in_blocks + ((self.whole_blocks.len() as u64) << (3 * blocks.grid.block_depth)))
    }

    /// The same and what an open mesh winds around.
    fn filled_up(&self, mesh: &OpenMesh, blocks: FilledBlocks<'_>) -> Result<(Self, Found), ConvertError> {
        let codes: Vec<u32> = blocks.codes().collect();
        let decided = (0..blocks.len())
            .into_par_iter()
            .map(|index| {
                let filled = blocks.rows(index)?;
                let mut inside = self.of_blocks[index].rows(&filled).unwrap_or(Rows::empty(filled.size));
                let mut closed = filled.clone();
                closed.add(&inside, [0; 3]);
                let origin = blocks.grid.block(codes[index]).first.map(|first| first as u32);
                let found = mesh.decide(&closed.complement(), origin, &mut inside);
                Ok((BlockInside::of_cells(inside, &filled), found))
            })
            .collect::<Result<Vec<(BlockInside, Found)>, ConvertError>>()?;
        let (mut whole_blocks, parts, found) = mesh.decide_empty_blocks(&codes, blocks.grid);
        whole_blocks.extend(&self.whole_blocks);
        whole_blocks.sort_unstable();
        whole_blocks.dedup();
        let parts = parts.into_iter().filter(|(code, _)| whole_blocks.binary_search(code).is_err());
        let part_blocks = parts.map(|(code, rows)| (code, rows.to_morton())).collect();
        let found = decided.iter().fold(found, |sum, (_, found)| sum.and(*found));
        let of_blocks = decided.into_iter().map(|(inside, _)| inside).collect();
        Ok((Self { of_blocks, whole_blocks, part_blocks, warning: None }, found))
    }
}

impl BlockInside {
    fn of_regions(enclosed: Vec<bool>) -> Self {
        if enclosed.contains(&true) { Self::Regions(enclosed) } else { Self::Nothing }
    }

    /// `filled` are the filled cells of the block.
    fn of_cells(inside: Rows, filled: &Rows) -> Self {
        if inside.is_empty() {
            return Self::Nothing;
        }
        // Mostly these are whole regions, which take less memory.
        let regions = EmptyRegions::new(filled);
        let whole: Vec<bool> = regions.first_cells().into_iter().map(|cell| inside.contains(cell)).collect();
        if regions.cells_of(|region| whole[region as usize]) == inside {
            Self::Regions(whole)
        } else {
            Self::Cells(inside)
        }
    }

    /// The inside cells of a block with these filled cells; `None` if there are none.
    fn rows(&self, filled: &Rows) -> Option<Rows> {
        match self {
            Self::Nothing => None,
            Self::Regions(marked) => {
                Some(EmptyRegions::new(filled).cells_of(|region| marked[region as usize]))
            }
            Self::Cells(rows) => Some(rows.clone()),
        }
    }
}
