//! Files of version 4, which are read twice: for their outline, and then subtree by subtree.

use super::assembly::{Assembler, Assembly, Below, Lists};
use super::pieces::{Pieces, with_pieces};
use super::preorder::Preorder;
use super::{Loaded, check_depth};
use crate::node::MAX_INDEX;
use crate::{LoadError, Octree};
use octvox_format::v5::Source;
use octvox_format::{Limits, MaterialPalette, NormalCode, Outline, Reader, summarize};
use std::io::{self, Read};
use std::ops::Range;

/// The level at which the octree is cut: up to 4096 subtrees, of a surface some hundreds.
const CUT_LEVEL: u8 = 4;

/// A piece is at least one node, and a subtree of fewer levels is soon read.
const LEAST_LEVELS_BELOW_CUT: u8 = 3;

/// Loads a file of version 4.
pub(crate) fn load(source: &(impl Source + Sync)) -> Result<Octree, LoadError> {
    match load_undamaged(source) {
        // The outline made sense, but something in it does not; or the file is not the same any more.
        Err(LoadError::Changed) => Err(diagnose(source)),
        result => result,
    }
}

fn load_undamaged(source: &(impl Source + Sync)) -> Result<Octree, LoadError> {
    let mut outline = Outline::read(Sequential::new(source), CUT_LEVEL)?;
    if !outline.subtrees.is_empty() && outline.depth < CUT_LEVEL + LEAST_LEVELS_BELOW_CUT {
        outline = Outline::read(Sequential::new(source), Limits::MAX_DEPTH)?;
    }
    check_depth(outline.depth)?;
    let limit = MAX_INDEX as u64;
    for (what, found) in [("nodes", outline.nodes), ("stored voxels", outline.stored_voxels)] {
        if found / 8 > limit {
            return Err(LoadError::TooLarge { what, found, limit });
        }
    }

    let (depth, palette_size) = (outline.depth, outline.palette.len());
    let sizes: Vec<u64> = outline.subtrees.iter().map(|range| (range.end - range.start) / 4).collect();
    let mut top = Preorder::new(&outline.top);
    let make = |number: usize, pieces: &mut Pieces| {
        add_piece(source, outline.subtrees[number].clone(), depth, palette_size, pieces)
    };
    let mut assembly = Assembly::new(Lists::new(palette_size));
    let root = with_pieces(palette_size, &sizes, make, |put_piece| {
        let below = if sizes.is_empty() { Below::Cells } else { Below::Pieces(CUT_LEVEL, put_piece) };
        Assembler::new(depth, &mut assembly, &mut top, below).root()
    })?;
    if !top.is_used_up(palette_size) {
        return Err(LoadError::Changed);
    }
    let materials = MaterialPalette::from(&outline.palette);
    Loaded { depth, materials, normal_code: NormalCode::Spherical, world: None, assembly, root }.octree()
}

/// Adds the piece of the subtree that stands at `range` in the file.
fn add_piece(
    source: &impl Source,
    range: Range<u64>,
    depth: u8,
    palette_size: usize,
    pieces: &mut Pieces,
) -> Result<(), LoadError> {
    let length = usize::try_from(range.end - range.start).map_err(|_| LoadError::Changed)?;
    let bytes = source.bytes_at(range.start, length)?;
    let mut records = Preorder::new(bytes.as_chunks().0);
    pieces.add(depth, CUT_LEVEL, &mut records)?;
    if records.is_used_up(palette_size) { Ok(()) } else { Err(LoadError::Changed) }
}

/// What is wrong with a file, by a reader that looks at every record.
#[cold]
fn diagnose(source: &impl Source) -> LoadError {
    match Reader::new(Sequential::new(source)).and_then(summarize) {
        Ok(_) => LoadError::Changed,
        Err(error) => error.into(),
    }
}

/// Reads a source from its beginning to its end.
struct Sequential<'a, S> {
    source: &'a S,
    offset: u64,
}

impl<'a, S> Sequential<'a, S> {
    fn new(source: &'a S) -> Self {
        Self { source, offset: 0 }
    }
}

impl<S: Source> Read for Sequential<'_, S> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let rest = self.source.byte_length()?.saturating_sub(self.offset);
        let count = usize::try_from(rest).unwrap_or(usize::MAX).min(buffer.len());
        buffer[..count].copy_from_slice(&self.source.bytes_at(self.offset, count)?);
        self.offset += count as u64;
        Ok(count)
    }
}
