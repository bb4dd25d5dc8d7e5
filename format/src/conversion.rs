//! From one version to the other, and to fewer levels, another cut, another code of normals.

use crate::normal_code::Recoding;
use crate::v5::{self, Archive, Encoder, Header, Preorder, Source, Splitter, Subtree};
use crate::{FormatError, MaterialPalette, NormalCode, Palette, Reader, Record, Writer, summarize};
use rayon::prelude::*;
use std::io::{Read, Seek, SeekFrom, Write};

/// Voxels that are encoded at once, by all threads.
const BATCH_VOXELS: usize = 1 << 21;

/// Converts a file of version 4 into one of version 5, and returns the output.
///
/// The input is read twice, the first time to find its depth and whether it makes sense. From the depth `header` makes the
/// new header, for instance with [`Header::new`]. If that has a lesser depth, the levels below are left out: nodes stand
/// for what is in them. Colours become [matte](crate::Material::matte) materials; normals are converted to the code that the
/// header names. Subtrees are encoded on the current thread pool. In memory are a few million voxels at a time, and those
/// above the cut.
///
/// # Errors
/// A [`FormatError`] of the input; [`FormatError::Senseless`] if a node is empty but has a filled child, or has only empty
/// ones; [`FormatError::Write`].
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
    input.seek(SeekFrom::Start(start)).map_err(|source| FormatError::Read { offset: 0, source })?;
    let reader = Reader::new(input)?;
    let materials = MaterialPalette::from(reader.palette());
    let recoding = Recoding::new(NormalCode::Spherical, header.normal_code);
    let records = down_to(reader, header.depth).map(|record| {
        let record = record?;
        Ok((record, recoding.apply(record.voxel.normal.to_bytes())))
    });
    write_version_5(records, output, &header, &materials)
}

/// Writes the octree of a file of version 5 again, with another header, and returns the output.
///
/// The header may name another cut, compression, normal code, place in the world and writer. If it has a lesser depth, the
/// levels below are left out: nodes stand for what is in them ([`Header::down_to`] makes such a header).
///
/// # Errors
/// A [`FormatError`] of the archive or of the header; [`FormatError::Write`].
pub fn rewrite_version_5<S: Source, W: Write>(
    archive: &Archive<S>,
    output: W,
    header: &Header,
) -> Result<W, FormatError> {
    let mut preorder = Preorder::new(archive, header.depth, header.normal_code);
    let records = std::iter::from_fn(|| preorder.next_record(archive))
        .map(|record| record.map(|record| (record, record.voxel.normal.to_bytes())));
    write_version_5(records, output, header, archive.materials())
}

/// Converts a file of version 5 into one of version 4, and returns the output.
///
/// Of the materials the diffuse colours remain, normals are converted to the spherical code, and the place in the world
/// is lost. What a file of version 4 has comes back from version 5 byte by byte, if its normals have stayed in their code.
///
/// # Errors
/// As [`write_version_4`], and [`FormatError::TooManyMaterials`] if the archive has more than 32,767.
pub fn to_version_4<S: Source, W: Write>(archive: &Archive<S>, output: W) -> Result<W, FormatError> {
    write_version_4(archive.records(), &archive.materials().to_palette()?, output)
}

/// Writes records, which are in preorder, into a file of version 4, and returns the output.
///
/// # Errors
/// The first error of the records; another [`FormatError`] if they are not those of one octree with colours of the palette;
/// [`FormatError::Write`].
pub fn write_version_4<W: Write>(
    records: impl IntoIterator<Item = Result<Record, FormatError>>,
    palette: &Palette,
    output: W,
) -> Result<W, FormatError> {
    let mut writer = Writer::new(output, palette)?;
    for record in records {
        let Record { voxel, has_children, .. } = record?;
        if has_children { writer.node(voxel) } else { writer.leaf(voxel) }?;
    }
    writer.finish()
}

/// The records of an octree down to `level`: those of the octree of that depth.
pub(crate) fn down_to(
    records: impl Iterator<Item = Result<Record, FormatError>>,
    level: u8,
) -> impl Iterator<Item = Result<Record, FormatError>> {
    records.filter(move |record| record.as_ref().map_or(true, |record| record.level <= level)).map(
        move |record| {
            record
                .map(|record| Record { has_children: record.has_children && record.level < level, ..record })
        },
    )
}

/// Writes records and their normals in the code of the header. They are those of an octree that makes sense and is no deeper
/// than the header says.
fn write_version_5<W: Write>(
    records: impl Iterator<Item = Result<(Record, [u8; 2]), FormatError>>,
    output: W,
    header: &Header,
    materials: &MaterialPalette,
) -> Result<W, FormatError> {
    let mut writer = v5::Writer::new(output, header, materials)?;
    let mut splitter = Splitter::new(header);
    let mut batch = Vec::new();
    let mut voxels = 0;
    for record in records {
        let (record, normal) = record?;
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
