//! What stands before the voxels of version 4: magic, version, palette, separator.

use crate::input::Input;
use crate::{FormatError, Palette};
use byteorder::{ByteOrder, LittleEndian, WriteBytesExt};
use std::io::{self, Read, Write};

pub(crate) const MAGIC: [u8; 2] = *b"MB";
/// The version of the format that [`Reader`](crate::Reader) and [`Writer`](crate::Writer) are for.
pub const VERSION: u16 = 4;
/// Bytes 2 and 3 of a MagicaVoxel file, which begins with `VOX `.
const MAGICA_VOXEL: [[u8; 2]; 2] = [*b"VO", *b"X "];
/// Stands between palette and voxels. Its value means nothing to a reader.
pub(crate) const SEPARATOR: [u8; 2] = [0x7C, 0x7C];

/// Length of a header with this palette, in bytes: where the voxels begin.
pub(crate) fn length(palette: &Palette) -> u64 {
    8 + 3 * u64::from(palette.last_index())
}

/// Reads the beginning that all versions have in common, and returns the version.
pub(crate) fn read_version(input: &mut Input<impl Read>) -> Result<u16, FormatError> {
    let mut bytes = [0; 2];
    input.read_field("magic number", &mut bytes)?;
    if bytes != MAGIC {
        return Err(foreign(input, bytes));
    }
    input.read_field("version", &mut bytes)?;
    Ok(LittleEndian::read_u16(&bytes))
}

/// Reads a header to its end.
pub(crate) fn read(input: impl Read) -> Result<Palette, FormatError> {
    let mut input = Input::new(input);
    let version = read_version(&mut input)?;
    if version != VERSION {
        return Err(FormatError::UnsupportedVersion { version });
    }
    let mut bytes = [0; 2];
    input.read_field("palette size", &mut bytes)?;
    let size = LittleEndian::read_u16(&bytes);
    // Before anything is allocated.
    if usize::from(size) > Palette::MAX_COLORS {
        return Err(FormatError::PaletteSizeOutOfRange { size });
    }
    let mut colors = vec![[0; 3]; usize::from(size)];
    input.read_field("palette", colors.as_flattened_mut())?;
    input.read_field("separator", &mut bytes)?;
    Palette::new(colors)
}

/// Writes a header.
pub(crate) fn write(output: &mut impl Write, palette: &Palette) -> io::Result<()> {
    output.write_all(&MAGIC)?;
    output.write_u16::<LittleEndian>(VERSION)?;
    output.write_u16::<LittleEndian>(palette.last_index())?;
    output.write_all(palette.colors().as_flattened())?;
    output.write_all(&SEPARATOR)
}

/// What a file is that does not begin with our magic number.
fn foreign(input: &mut Input<impl Read>, found: [u8; 2]) -> FormatError {
    let mut next = [0; 2];
    match input.read_field("magic number", &mut next) {
        Ok(()) if [found, next] == MAGICA_VOXEL => FormatError::MagicaVoxel,
        _ => FormatError::WrongMagic { found },
    }
}
