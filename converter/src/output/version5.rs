//! Files of version 5: the blocks as subtrees.

use super::{Counted, for_each_encoded};
use crate::block_tree::BlockTree;
use crate::octree::Octree;
use crate::storage::Storage;
use crate::{ConvertError, WorldTransform};
use octvox_cli::Progress;
use octvox_format::v5::{Compression, Header, LevelDefect, Levels, Subtree, Writer};
use octvox_format::{FormatError, Material, MaterialPalette};
use std::io::Write;

/// The header of a file that is cut where the blocks are.
pub(super) fn header(octree: &Octree, compression: Compression, world: WorldTransform) -> Header {
    let depth = octree.grid.depth as u8;
    Header {
        cut_level: octree.grid.top_depth() as u8,
        normal_code: octree.normal_code,
        compression,
        world: Some(octvox_format::WorldTransform { origin: world.origin, voxel_size: world.voxel_size }),
        writer: concat!("obj2vox ", env!("CARGO_PKG_VERSION")).to_owned(),
        ..Header::new(depth)
    }
}

/// Writes the file and returns its length in bytes.
pub(super) fn write_file(
    header: &Header,
    palette: &[Material],
    octree: &Octree,
    storage: &Storage,
    progress: &Progress,
    out: &mut impl Write,
) -> Result<u64, ConvertError> {
    let mut counted = Counted { out, length: 0 };
    write_parts(header, palette, octree, storage, progress, &mut counted).map_err(|error| match error {
        ConvertError::Format(FormatError::Write { source, .. }) => ConvertError::Write(source),
        other => other,
    })?;
    Ok(counted.length)
}

fn write_parts(
    header: &Header,
    palette: &[Material],
    octree: &Octree,
    storage: &Storage,
    progress: &Progress,
    out: impl Write,
) -> Result<(), ConvertError> {
    let mut writer = Writer::new(out, header, &MaterialPalette::new(palette.to_vec())?)?;
    let encoder = writer.encoder();
    for_each_encoded(
        &octree.blocks,
        progress,
        |block| {
            let planes = storage.with(&block.tree, BlockTree::planes)?;
            let levels = Levels::subtree(header.cut_level, header.depth, planes).map_err(damaged)?;
            Ok::<_, ConvertError>(encoder.encode(&Subtree { code: block.code.into(), levels })?)
        },
        |subtree| Ok::<_, ConvertError>(writer.subtree(&subtree?)?),
    )?;
    writer.finish(&octree.top_levels().map_err(damaged)?)?;
    Ok(())
}

/// Cannot happen: levels and blocks are those of a tree.
fn damaged(defect: LevelDefect) -> FormatError {
    FormatError::DamagedLevels { offset: 0, section: "subtree", defect }
}
