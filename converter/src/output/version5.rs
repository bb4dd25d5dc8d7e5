//! Files of version 5: neighbouring blocks together as subtrees.

use super::{Counted, Part, for_each_encoded};
use crate::block_tree::BlockTree;
use crate::octree::{Block, Octree};
use crate::storage::Storage;
use crate::{ConvertError, WorldTransform};
use octvox_cli::Progress;
use octvox_format::v5::{Compression, Header, LevelDefect, Levels, Planes, Subtree, Writer};
use octvox_format::{FormatError, Material, MaterialPalette};
use std::io::Write;

/// The header of a file whose subtrees are made of some blocks each.
pub(super) fn header(octree: &Octree, compression: Compression, world: WorldTransform) -> Header {
    Header {
        normal_code: octree.normal_code,
        compression,
        world: Some(world),
        writer: concat!("obj2vox ", env!("CARGO_PKG_VERSION")).to_owned(),
        ..Header::new(octree.grid.depth as u8)
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
    let (top, parts) = cut(octree, header.cut_level).map_err(damaged)?;
    for_each_encoded(
        &parts,
        progress,
        |part| {
            let blocks = part
                .blocks
                .iter()
                .map(|block| {
                    let planes = storage.with(&block.tree, BlockTree::planes)?;
                    Ok(Levels::subtree(octree.grid.top_depth() as u8, header.depth, planes)
                        .map_err(damaged)?)
                })
                .collect::<Result<Vec<_>, ConvertError>>()?;
            let upper = part.upper.clone();
            let levels = Levels::join(header.cut_level, header.depth, upper, &blocks).map_err(damaged)?;
            Ok::<_, ConvertError>(encoder.encode(&Subtree { code: part.code, levels })?)
        },
        |subtree| Ok::<_, ConvertError>(writer.subtree(&subtree?)?),
    )?;
    writer.finish(&top)?;
    Ok(())
}

/// A subtree of the file.
struct SubtreeParts<'a> {
    /// Morton code of its cell.
    code: u64,
    /// Its levels above the blocks.
    upper: Planes,
    blocks: &'a [Block],
}

impl Part for SubtreeParts<'_> {
    fn filled_voxels(&self) -> u64 {
        self.blocks.iter().map(|block| block.filled_voxels).sum()
    }

    fn blocks(&self) -> u64 {
        self.blocks.len() as u64
    }
}

/// Cuts an octree at a level above that of the blocks, or at the root: into what is above, and the subtrees.
fn cut(octree: &Octree, cut_level: u8) -> Result<(Levels, Vec<SubtreeParts<'_>>), LevelDefect> {
    let above_blocks = octree.top_levels()?;
    let block_level = above_blocks.level_count();
    let end_of_top = above_blocks.range(cut_level).start;
    let codes = match cut_level.checked_sub(1) {
        Some(level) => above_blocks.child_codes(0, level),
        None => vec![0; usize::from(!octree.blocks.is_empty())],
    };
    // The next voxel of each level between cut and blocks.
    let mut next: Vec<usize> =
        (cut_level..block_level).map(|level| above_blocks.range(level).start).collect();
    let mut next_block = 0;
    let parts = codes.into_iter().map(|code| {
        let mut upper = Planes::default();
        let mut count = 1;
        for next in &mut next {
            let range = *next..*next + count;
            *next = range.end;
            let masks = &above_blocks.masks()[range.clone()];
            count = masks.iter().map(|mask| mask.count_ones() as usize).sum();
            upper.masks.extend_from_slice(masks);
            upper.palette_indices.extend_from_slice(&above_blocks.palette_indices()[range.clone()]);
            upper.normals.extend_from_slice(&above_blocks.normals()[range]);
        }
        let blocks = next_block..next_block + count;
        next_block = blocks.end;
        SubtreeParts { code, upper, blocks: &octree.blocks[blocks] }
    });
    let parts = parts.collect();
    let Planes { mut masks, mut palette_indices, mut normals } = above_blocks.into_planes();
    masks.truncate(end_of_top);
    palette_indices.truncate(end_of_top);
    normals.truncate(end_of_top);
    Ok((Levels::top(cut_level, Planes { masks, palette_indices, normals })?, parts))
}

/// Cannot happen: levels and blocks are those of a tree.
fn damaged(defect: LevelDefect) -> FormatError {
    FormatError::DamagedLevels { offset: 0, section: "subtree", defect }
}
