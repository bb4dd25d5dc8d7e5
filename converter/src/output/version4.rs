//! Files of version 4: the voxels in preorder.

use super::{Counted, for_each_encoded};
use crate::ConvertError;
use crate::block_tree::BlockTree;
use crate::octree::Octree;
use crate::storage::Storage;
use crate::voxel::Voxel;
use octvox_cli::Progress;
use octvox_format::{FormatError, Material, Palette, Writer};
use std::io::Write;

/// Writes the file and returns its length in bytes.
pub(super) fn write_file(
    palette: &[Material],
    octree: &Octree,
    storage: &Storage,
    progress: &Progress,
    out: &mut impl Write,
) -> Result<u64, ConvertError> {
    let mut output = Counted { out, length: 0 };
    let colors = Palette::new(palette.iter().map(|entry| entry.diffuse).collect())?;
    output.put(&header(&colors)?)?;
    let (top, places) = octree.encode_top();
    let mut written_top = 0;
    let mut places = places.into_iter();
    for_each_encoded(
        &octree.blocks,
        progress,
        |block| storage.with(&block.tree, BlockTree::encode),
        |bytes| {
            let place = places.next().unwrap_or(top.len());
            output.put(&top[written_top..place])?;
            written_top = place;
            output.put(&bytes?)
        },
    )?;
    output.put(&top[written_top..])?;
    output.flush().map_err(ConvertError::Write)?;
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
