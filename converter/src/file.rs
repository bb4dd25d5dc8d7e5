//! The octree into a file.

use crate::ConvertError;
use crate::octree::Octree;
use octvox_cli::Progress;
use octvox_format::{FormatError, Palette, Voxel, Writer};
use rayon::prelude::*;
use std::io::Write;
use std::ops::Range;

/// Bytes that are encoded while those before them are written.
const BATCH_BYTES: usize = 16 << 20;

/// Writes the file and returns its length in bytes.
///
/// Blocks are encoded in parallel, batch by batch, so that only two batches are in memory.
pub(crate) fn write_file(
    palette: &Palette,
    octree: &Octree,
    progress: &Progress,
    out: &mut impl Write,
) -> Result<u64, ConvertError> {
    progress.stage("write", octree.block_count() as u64);
    let mut output = Counted { out, length: 0 };
    output.write(&header(palette)?)?;
    let (top, places) = octree.encode_top();
    let mut batches = batches(octree).into_iter();
    let mut encoded = batches.next().map(|batch| encode_batch(octree, batch));
    let mut written_top = 0;
    let mut places = places.into_iter();
    while let Some(blocks) = encoded.take() {
        let mut result = Ok(());
        let next = batches.next();
        // The pool encodes the next batch while this thread writes.
        rayon::in_place_scope(|scope| {
            scope.spawn(|_| encoded = next.map(|batch| encode_batch(octree, batch)));
            for (block, place) in blocks.iter().zip(&mut places) {
                result = output.write(&top[written_top..place]).and_then(|()| output.write(block));
                written_top = place;
                if result.is_err() {
                    break;
                }
            }
            progress.add(blocks.len() as u64);
        });
        result?;
    }
    output.write(&top[written_top..])?;
    output.out.flush().map_err(ConvertError::Write)?;
    Ok(output.length)
}

/// What stands before the voxels.
fn header(palette: &Palette) -> Result<Vec<u8>, FormatError> {
    // The file of an octree that is a single empty cell ends with that cell.
    let mut writer = Writer::new(Vec::new(), palette)?;
    writer.empty()?;
    let mut bytes = writer.finish()?;
    bytes.truncate(bytes.len() - Voxel::EMPTY.to_word(false).len());
    Ok(bytes)
}

/// Cuts the blocks into runs of about [`BATCH_BYTES`].
fn batches(octree: &Octree) -> Vec<Range<usize>> {
    let mut batches = Vec::new();
    let (mut start, mut bytes) = (0, 0);
    for block in 0..octree.block_count() {
        bytes += octree.block_bytes(block);
        if bytes >= BATCH_BYTES {
            batches.push(start..block + 1);
            (start, bytes) = (block + 1, 0);
        }
    }
    batches.push(start..octree.block_count());
    batches
}

fn encode_batch(octree: &Octree, blocks: Range<usize>) -> Vec<Vec<u8>> {
    blocks.into_par_iter().map(|block| octree.encode_block(block)).collect()
}

struct Counted<'a, W> {
    out: &'a mut W,
    length: u64,
}

impl<W: Write> Counted<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> Result<(), ConvertError> {
        self.out.write_all(bytes).map_err(ConvertError::Write)?;
        self.length += bytes.len() as u64;
        Ok(())
    }
}
