//! Files of version 5, whose subtrees are decoded and made into pieces in parallel.

use super::assembly::{Assembler, Assembly, Below, Capacity, Lists};
use super::levels::LevelCells;
use super::pieces::{Pieces, with_pieces};
use super::{Loaded, check_depth};
use crate::node::MAX_INDEX;
use crate::{LoadError, Octree};
use octvox_format::v5::{Archive, IndexEntry, Levels, Planes, Source};
use octvox_format::{FormatError, Limits};
use std::ops::Range;

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
    let (assembly, root) = if cut_level == 0 || depth - cut_level < LEAST_LEVELS_BELOW_CUT {
        let whole = join(&archive)?;
        let mut assembly = Assembly::new(Lists::new(palette_size));
        let root = Assembler::new(depth, &mut assembly, LevelCells::new(&whole), Below::Cells).root()?;
        (assembly, root)
    } else {
        let capacity = Capacity::of_levels(depth, &archive.index().levels);
        let mut assembly = Assembly::new(Lists::with_capacity(palette_size, capacity));
        let runs = runs(&archive.index().subtrees);
        let sizes: Vec<u64> = runs.iter().map(|run| run.voxels).collect();
        let make = |number: usize, pieces: &mut Pieces| {
            archive.subtrees(runs[number].numbers.clone())?.try_for_each(|subtree| {
                let levels = subtree?.levels;
                pieces.add(depth, cut_level, LevelCells::new(&levels))
            })
        };
        let root = with_pieces(palette_size, &sizes, make, |put_piece| {
            let below = Below::Pieces(cut_level, put_piece);
            Assembler::new(depth, &mut assembly, LevelCells::new(archive.top()), below).root()
        })?;
        (assembly, root)
    };
    let (materials, normal_code, world) = (archive.materials().clone(), header.normal_code, header.world);
    Loaded { depth, materials, normal_code, world, assembly, root }.octree()
}

/// Voxels of which pieces are made at once: enough that threads need not often wait for one another or for the system, few
/// enough to stay in the second-level cache.
const RUN_VOXELS: u64 = 1 << 16;

/// Consecutive subtrees that are read at once.
struct Run {
    numbers: Range<usize>,
    voxels: u64,
}

/// All subtrees, some at a time.
fn runs(subtrees: &[IndexEntry]) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for (number, entry) in subtrees.iter().enumerate() {
        let voxels = u64::from(entry.voxels);
        match runs.last_mut() {
            Some(run) if run.voxels + voxels <= RUN_VOXELS => {
                run.numbers.end = number + 1;
                run.voxels += voxels;
            }
            _ => runs.push(Run { numbers: number..number + 1, voxels }),
        }
    }
    runs
}

/// All levels of an octree whose subtrees are too small to be pieces.
fn join(archive: &Archive<impl Source>) -> Result<Levels, LoadError> {
    let header = archive.header();
    let mut subtrees = archive
        .subtrees(0..archive.subtree_count())?
        .map(|subtree| Ok(subtree?.levels))
        .collect::<Result<Vec<_>, FormatError>>()?;
    if subtrees.is_empty() {
        return Ok(Levels::top(0, Planes::default()).map_err(FormatError::from)?);
    }
    if header.cut_level == 0 {
        return Ok(subtrees.swap_remove(0));
    }
    let planes = archive.top().clone().into_planes();
    Ok(Levels::join(0, header.depth, planes, &subtrees).map_err(FormatError::from)?)
}
