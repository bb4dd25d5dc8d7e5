//! What is in a file, counted in one pass.

use crate::validation::Validator;
use crate::{Defect, FormatError, Limits, Reader, Record};
use std::io::Read;

/// Counts over a whole file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Summary {
    /// Level of the deepest record.
    pub depth: u8,
    /// Number of records, filled and empty.
    pub stored_voxels: u64,
    /// Number of records with children.
    pub nodes: u64,
    /// Filled cells at the finest level. A filled leaf above it counts as all the cells that it covers.
    /// (At depth 22 and 23 there can be more than a `u64` holds.)
    pub leaf_voxels: u128,
    /// Number of filled records on each level, from the root to `depth`.
    pub levels: Vec<u64>,
    /// Number of records with each palette index, from 0, the empty ones, to the length of the palette.
    pub palette_uses: Vec<u64>,
    /// Length of the file, in bytes.
    pub file_bytes: u64,
    /// Number of nodes that make no sense.
    pub defects: u64,
    /// The first of them.
    pub first_defect: Option<Defect>,
}

impl Summary {
    /// Cells along each axis at the finest level.
    #[must_use]
    pub fn resolution(&self) -> u32 {
        1 << self.depth
    }

    /// Whether the octree makes sense: a node is filled if and only if one of its children is, and has children only
    /// if one of them is filled.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.defects == 0
    }
}

/// Reads a file to its end and counts.
///
/// # Errors
/// The first error of the reader.
pub fn summarize<R: Read>(reader: Reader<R>) -> Result<Summary, FormatError> {
    summarize_with(reader, |_| {})
}

/// As [`summarize`], and shows every record to `inspect` on the way.
///
/// # Errors
/// As [`summarize`].
pub fn summarize_with<R: Read>(
    mut reader: Reader<R>,
    mut inspect: impl FnMut(&Record),
) -> Result<Summary, FormatError> {
    const LEVELS: usize = Limits::MAX_DEPTH as usize + 1;
    let mut depth = 0;
    let mut stored_voxels = 0;
    let mut nodes = 0;
    let mut filled = [0_u64; LEVELS];
    let mut filled_leaves = [0_u64; LEVELS];
    let mut palette_uses = vec![0; reader.palette().len() + 1];
    let mut validator = Validator::default();

    let mut offset = reader.offset();
    while let Some(record) = reader.next() {
        let record = record?;
        inspect(&record);
        validator.add(record, offset);
        offset = reader.offset();

        let level = usize::from(record.level);
        let is_filled = !record.voxel.is_empty();
        depth = depth.max(record.level);
        stored_voxels += 1;
        nodes += u64::from(record.has_children);
        filled[level] += u64::from(is_filled);
        filled_leaves[level] += u64::from(is_filled && !record.has_children);
        palette_uses[usize::from(record.voxel.palette_index)] += 1;
    }

    let leaf_voxels =
        (0..=depth).map(|level| u128::from(filled_leaves[usize::from(level)]) << (3 * (depth - level))).sum();
    Ok(Summary {
        depth,
        stored_voxels,
        nodes,
        leaf_voxels,
        levels: filled[..=usize::from(depth)].to_vec(),
        palette_uses,
        file_bytes: offset,
        defects: validator.defects,
        first_defect: validator.first,
    })
}
