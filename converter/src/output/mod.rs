//! The octree into a file.

mod preorder;
mod version4;
mod version5;

pub(crate) use preorder::{append_leaves, encode};

use crate::octree::{Block, Octree};
use crate::options::FileFormat;
use crate::storage::Storage;
use crate::{ConvertError, WorldTransform};
use octvox_cli::Progress;
use octvox_format::Material;
use rayon::prelude::*;
use std::io::{self, Write};
use std::ops::Range;

/// Voxels whose blocks are encoded while those before them are written.
const BATCH_VOXELS: u64 = 1 << 20;

/// Writes the file and returns its length in bytes.
///
/// Blocks are encoded in parallel, batch by batch, so that only two batches are in memory.
pub(crate) fn write_file(
    format: FileFormat,
    palette: &[Material],
    octree: &Octree,
    world: WorldTransform,
    storage: &Storage,
    progress: &Progress,
    out: &mut impl Write,
) -> Result<u64, ConvertError> {
    progress.stage("write", octree.blocks.len() as u64);
    match format {
        FileFormat::Version4 => version4::write_file(palette, octree, storage, progress, out),
        FileFormat::Version5 { compression } => {
            let header = version5::header(octree, compression, world);
            version5::write_file(&header, palette, octree, storage, progress, out)
        }
    }
}

/// A part of the octree that is encoded on its own.
trait Part: Sync {
    /// How much work there is, in voxels.
    fn filled_voxels(&self) -> u64;

    /// How many blocks are in it.
    fn blocks(&self) -> u64;
}

impl Part for Block {
    fn filled_voxels(&self) -> u64 {
        self.filled_voxels
    }

    fn blocks(&self) -> u64 {
        1
    }
}

/// Encodes all parts, on all threads, and hands them to `write` in order.
fn for_each_encoded<P: Part, T: Send, E>(
    parts: &[P],
    progress: &Progress,
    encode: impl Fn(&P) -> T + Sync,
    mut write: impl FnMut(T) -> Result<(), E>,
) -> Result<(), E> {
    let encode_batch = |batch: Range<usize>| -> Vec<T> {
        let encode = |part: &P| {
            let encoded = encode(part);
            progress.add(part.blocks());
            encoded
        };
        parts[batch].par_iter().map(encode).collect()
    };
    let mut batches = batches(parts).into_iter();
    let mut encoded = batches.next().map(encode_batch);
    while let Some(batch) = encoded.take() {
        let next = batches.next();
        // The pool encodes the next batch while this thread writes.
        let result = rayon::in_place_scope(|scope| {
            scope.spawn(|_| encoded = next.map(encode_batch));
            batch.into_iter().try_for_each(&mut write)
        });
        result?;
    }
    Ok(())
}

/// Cuts the parts into runs of about [`BATCH_VOXELS`].
fn batches(parts: &[impl Part]) -> Vec<Range<usize>> {
    let mut batches = Vec::new();
    let (mut start, mut voxels) = (0, 0);
    for (index, part) in parts.iter().enumerate() {
        voxels += part.filled_voxels();
        if voxels >= BATCH_VOXELS {
            batches.push(start..index + 1);
            (start, voxels) = (index + 1, 0);
        }
    }
    batches.push(start..parts.len());
    batches
}

/// Counts the bytes on their way.
struct Counted<'a, W> {
    out: &'a mut W,
    length: u64,
}

impl<W: Write> Counted<'_, W> {
    fn put(&mut self, bytes: &[u8]) -> Result<(), ConvertError> {
        self.write_all(bytes).map_err(ConvertError::Write)
    }
}

impl<W: Write> Write for Counted<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.out.write(bytes)?;
        self.length += count as u64;
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}
