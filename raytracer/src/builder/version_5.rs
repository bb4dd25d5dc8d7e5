//! Files of version 5, whose subtrees are decoded and made into pieces in parallel.

use super::assembly::{Assembler, Below};
use super::levels::LevelCells;
use super::pieces::Pieces;
use super::{Loaded, check_depth};
use crate::node::MAX_INDEX;
use crate::{LoadError, Octree};
use octvox_format::Limits;
use octvox_format::v5::{Archive, Levels, Planes, Source};

/// A piece is at least one node: the two levels below the cut.
const LEAST_LEVELS_BELOW_CUT: u8 = 2;

/// Loads a file of version 5.
pub(crate) fn load(source: impl Source + Sync) -> Result<Octree, LoadError> {
    let archive = Archive::with_limits(source, Limits::default())?;
    let header = archive.header();
    let (depth, cut_level) = (header.depth, header.cut_level);
    check_depth(depth)?;
    let (limit, found) = (MAX_INDEX as u64, archive.index().voxels());
    if found > limit {
        return Err(LoadError::TooLarge { what: "voxels", found, limit });
    }

    let palette_size = archive.materials().len();
    let (lists, root) = if cut_level == 0 || depth - cut_level < LEAST_LEVELS_BELOW_CUT {
        let whole = join(&archive)?;
        Assembler::new(depth, palette_size, LevelCells::new(&whole), Below::Cells).octree()?
    } else {
        let subtrees = &archive.index().subtrees;
        let sizes: Vec<u64> = subtrees.iter().map(|entry| entry.voxels.into()).collect();
        let mut pieces = Pieces::new(&sizes, |number| {
            let subtree = archive.subtree(number)?;
            let cells = LevelCells::new(&subtree.levels);
            Assembler::new(depth, palette_size, cells, Below::Cells).piece(cut_level)
        });
        let mut next_piece = || pieces.next();
        let below = Below::Pieces(cut_level, &mut next_piece);
        Assembler::new(depth, palette_size, LevelCells::new(archive.top()), below).octree()?
    };
    let (materials, normal_code, world) = (archive.materials().clone(), header.normal_code, header.world);
    Loaded { depth, materials, normal_code, world, lists, root }.octree()
}

/// All levels of an octree whose subtrees are too small to be pieces.
fn join(archive: &Archive<impl Source>) -> Result<Levels, LoadError> {
    let header = archive.header();
    let top = archive.top();
    let mut planes = Planes {
        masks: top.masks().to_vec(),
        palette_indices: top.palette_indices().to_vec(),
        normals: top.normals().to_vec(),
    };
    let subtrees: Vec<_> =
        (0..archive.subtree_count()).map(|number| archive.subtree(number)).collect::<Result<_, _>>()?;
    if subtrees.is_empty() {
        return Ok(Levels::top(0, Planes::default()).map_err(octvox_format::FormatError::from)?);
    }
    for level in header.cut_level..=header.depth {
        for subtree in &subtrees {
            let voxels = subtree.levels.level(level);
            planes.masks.extend_from_slice(voxels.masks);
            planes.palette_indices.extend_from_slice(voxels.palette_indices);
            planes.normals.extend_from_slice(voxels.normals);
        }
    }
    Ok(Levels::subtree(0, header.depth, planes).map_err(octvox_format::FormatError::from)?)
}
