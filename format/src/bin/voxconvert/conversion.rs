//! From what is read to what is written.

use crate::arguments::{Arguments, Target, VoxKind};
use crate::input::{Input, InputKind};
use octvox_format::exchange::{Cells, Leaves, Volume, magicavoxel, write_binvox, write_npy, write_raw};
use octvox_format::v5::Header;
use octvox_format::{FormatError, Limits, NormalCode, rewrite_version_5, to_version_5, write_version_4};
use std::fs::File;

/// Writes the output, and returns its depth.
pub fn write(input: &Input, arguments: &Arguments, target: Target, file: &File) -> Result<u8, FormatError> {
    let level = arguments.level.unwrap_or(Limits::MAX_DEPTH);
    let depth = input.depth()?.min(level);
    match target {
        Target::Vox(VoxKind::Version4) => {
            let records = input.reader()?.records_down_to(level)?;
            write_version_4(records, &input.materials().to_palette()?, file)?;
        }
        Target::Vox(VoxKind::Version5) => write_version_5(input, arguments, depth, file)?,
        Target::Vox(VoxKind::MagicaVoxel) => {
            let leaves = Leaves::new(input.reader()?.records_down_to(level)?);
            magicavoxel::export(leaves, depth, input.materials(), file)?;
        }
        Target::Binvox | Target::Npy | Target::Raw => {
            let leaves = Leaves::new(input.reader()?.records_down_to(level)?);
            let volume = Volume { leaves, depth, max_bytes: arguments.max_bytes };
            let materials = input.materials();
            let cells = arguments.cells().unwrap_or(Cells::of_palette(materials));
            let world = input.header().and_then(|header| header.down_to(depth).world);
            match target {
                Target::Binvox => write_binvox(volume, world, file)?,
                Target::Npy => write_npy(volume, cells, materials, file)?,
                _ => write_raw(volume, cells, materials, file)?,
            };
        }
    }
    Ok(depth)
}

fn write_version_5(input: &Input, arguments: &Arguments, depth: u8, file: &File) -> Result<(), FormatError> {
    let new = Header::new(depth);
    let base = match input.header() {
        // The program that writes the file is this one.
        Some(old) if input.kind() == InputKind::Version5 => {
            Header { writer: new.writer, ..old.down_to(depth) }
        }
        Some(imported) => Header { world: imported.down_to(depth).world, ..new },
        // Nothing is lost.
        None => Header { normal_code: NormalCode::Spherical, ..new },
    };
    let header = Header {
        cut_level: arguments.cut_level.unwrap_or(base.cut_level),
        compression: arguments.compression().unwrap_or(base.compression),
        normal_code: arguments.normal_code().unwrap_or(base.normal_code),
        ..base
    };
    match input.kind() {
        InputKind::Version4 => to_version_5(input.bytes()?, file, |_| header)?,
        InputKind::Version5 | InputKind::MagicaVoxel => rewrite_version_5(&input.archive()?, file, &header)?,
    };
    Ok(())
}
