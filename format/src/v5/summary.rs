//! What is in a file of version 5, counted in one pass.

use super::{Decoder, Ending, Index, LevelCount, Reader, StoredSubtree};
use crate::{FormatError, Summary};
use rayon::prelude::*;
use std::io::Read;

/// Stored bytes that are decoded at once, by all threads.
const BATCH_BYTES: u64 = 4 << 20;

/// Reads a file to its end, decodes all its subtrees on the current thread pool, compares everything that is said twice,
/// and counts. Voxels are the filled ones, as others are not stored.
///
/// # Errors
/// The first error of the file.
pub fn summarize<R: Read>(mut reader: Reader<R>) -> Result<(Summary, Ending), FormatError> {
    let mut counts = Counts {
        decoder: reader.decoder(),
        index: Index::default(),
        palette_uses: vec![0; reader.materials().len() + 1],
    };
    let depth = reader.header().depth;
    let mut batch = Vec::new();
    let mut bytes = 0;
    while let Some(subtree) = reader.next_subtree()? {
        bytes += subtree.byte_length();
        batch.push(subtree);
        if bytes >= BATCH_BYTES {
            counts.add_subtrees(&std::mem::take(&mut batch))?;
            bytes = 0;
        }
    }
    counts.add_subtrees(&batch)?;
    let ending = reader.finish()?;
    counts.add(&ending.top);
    counts.compare(&ending)?;
    Ok((counts.summary(depth, ending.file_bytes), ending))
}

/// What has been counted so far.
struct Counts {
    decoder: Decoder,
    index: Index,
    palette_uses: Vec<u64>,
}

impl Counts {
    fn add_subtrees(&mut self, stored: &[StoredSubtree<'_>]) -> Result<(), FormatError> {
        let decoder = self.decoder;
        let decoded: Vec<_> = stored.par_iter().map(|subtree| decoder.decode(subtree)).collect();
        // The first error is that of the first subtree, whichever thread came upon one first.
        decoded.into_iter().try_for_each(|subtree| {
            self.add(&subtree?.levels);
            Ok(())
        })
    }

    fn add(&mut self, levels: &super::Levels) {
        self.index.count(levels.first_level(), &LevelCount::of(levels));
        for index in levels.palette_indices() {
            self.palette_uses[usize::from(*index)] += 1;
        }
    }

    /// Whether the index has counted the same.
    fn compare(&mut self, ending: &Ending) -> Result<(), FormatError> {
        self.index.levels.resize(ending.index.levels.len(), LevelCount::default());
        for ((level, found), told) in (0..).zip(&self.index.levels).zip(&ending.index.levels) {
            if found != told {
                return Err(FormatError::WrongCount {
                    offset: ending.file_bytes,
                    level,
                    found: found.voxels,
                    found_nodes: found.nodes,
                    told: told.voxels,
                    told_nodes: told.nodes,
                });
            }
        }
        Ok(())
    }

    fn summary(self, depth: u8, file_bytes: u64) -> Summary {
        let levels = &self.index.levels;
        let leaves = |(level, count): (u8, &LevelCount)| {
            u128::from(count.voxels.saturating_sub(count.nodes)) << (3 * depth.saturating_sub(level))
        };
        Summary {
            depth,
            stored_voxels: self.index.voxels(),
            nodes: levels.iter().map(|count| count.nodes).sum(),
            leaf_voxels: (0..).zip(levels).map(leaves).sum(),
            levels: levels.iter().map(|count| count.voxels).collect(),
            palette_uses: self.palette_uses,
            file_bytes,
            defects: 0,
            first_defect: None,
        }
    }
}
