//! From one version to the other.

use crate::normal_code::Recoding;
use crate::v5::{self, Archive, Encoder, Header, Source, Splitter, Subtree};
use crate::{FormatError, MaterialPalette, NormalCode, Reader, Writer, summarize};
use rayon::prelude::*;
use std::io::{Read, Seek, Write};

/// Voxels that are encoded at once, by all threads.
const BATCH_VOXELS: usize = 1 << 21;

/// Converts a file of version 4 into one of version 5, and returns the output.
///
/// The input is read twice, the first time to find its depth and whether it makes sense. From the depth `header` makes the
/// new header, for instance with [`Header::new`]. Colours become [matte](crate::Material::matte) materials; normals are
/// converted to the code that the header names. Subtrees are encoded on the current thread pool. In memory are a few million
/// voxels at a time, and those above the cut.
///
/// # Errors
/// A [`FormatError`] of the input; [`FormatError::Senseless`] if a node is empty but has a filled child, or has only empty
/// ones; [`FormatError::TooDeep`] if the header says less than the depth of the input; [`FormatError::Write`].
pub fn to_version_5<R: Read + Seek, W: Write>(
    mut input: R,
    output: W,
    header: impl FnOnce(u8) -> Header,
) -> Result<W, FormatError> {
    let start = input.stream_position().map_err(|source| FormatError::Read { offset: 0, source })?;
    let summary = summarize(Reader::new(&mut input)?)?;
    if let Some(defect) = summary.first_defect {
        return Err(defect.into());
    }
    let header = header(summary.depth);
    if header.depth < summary.depth {
        return Err(FormatError::TooDeep { offset: 4, max_depth: header.depth });
    }
    input.seek(std::io::SeekFrom::Start(start)).map_err(|source| FormatError::Read { offset: 0, source })?;

    let mut reader = Reader::new(input)?;
    let mut writer = v5::Writer::new(output, &header, &MaterialPalette::from(reader.palette()))?;
    let recoding = Recoding::new(NormalCode::Spherical, header.normal_code);
    let mut splitter = Splitter::new(&header);
    let mut batch = Vec::new();
    let mut voxels = 0;
    while let Some(record) = reader.next() {
        let record = record?;
        // The file may have changed since it was read the first time.
        if record.level > header.depth {
            return Err(FormatError::TooDeep { offset: reader.offset(), max_depth: header.depth });
        }
        let normal = recoding.apply(record.voxel.normal.to_bytes());
        if let Some(subtree) = splitter.add(&record, normal)? {
            voxels += subtree.levels.voxel_count();
            batch.push(subtree);
        }
        if voxels >= BATCH_VOXELS {
            write_batch(&mut writer, &std::mem::take(&mut batch))?;
            voxels = 0;
        }
    }
    let (last, top) = splitter.finish()?;
    batch.extend(last);
    write_batch(&mut writer, &batch)?;
    writer.finish(&top)
}

fn write_batch<W: Write>(writer: &mut v5::Writer<W>, batch: &[Subtree]) -> Result<(), FormatError> {
    let encoder: Encoder = writer.encoder();
    let encoded: Vec<_> = batch.par_iter().map(|subtree| encoder.encode(subtree)).collect();
    encoded.into_iter().try_for_each(|subtree| writer.subtree(&subtree?))
}

/// Converts a file of version 5 into one of version 4, and returns the output.
///
/// Of the materials the diffuse colours remain, normals are converted to the spherical code, and the place in the world
/// is lost. What a file of version 4 has comes back from version 5 byte by byte, if its normals have stayed in their code.
///
/// # Errors
/// A [`FormatError`] of the archive; [`FormatError::TooManyMaterials`] if it has more than 32,767;
/// [`FormatError::Write`].
pub fn to_version_4<S: Source, W: Write>(archive: &Archive<S>, output: W) -> Result<W, FormatError> {
    let mut writer = Writer::new(output, &archive.materials().to_palette()?)?;
    for record in archive.records() {
        let record = record?;
        if record.has_children {
            writer.node(record.voxel)?;
        } else {
            writer.leaf(record.voxel)?;
        }
    }
    writer.finish()
}
