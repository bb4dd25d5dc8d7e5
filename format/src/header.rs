//! What stands before the voxels: magic, version, palette, separator.

use crate::{FormatError, Palette};
use byteorder::{ByteOrder, LittleEndian, WriteBytesExt};
use std::io::{self, ErrorKind, Read, Write};

pub(crate) const MAGIC: [u8; 2] = *b"MB";
/// The version of the format that is read and written.
pub const VERSION: u16 = 4;
/// Bytes 2 and 3 of a MagicaVoxel file, which begins with `VOX `.
const MAGICA_VOXEL: [[u8; 2]; 2] = [*b"VO", *b"X "];
/// Stands between palette and voxels. Its value means nothing to a reader.
pub(crate) const SEPARATOR: [u8; 2] = [0x7C, 0x7C];

/// Length of a header with this palette, in bytes: where the voxels begin.
pub(crate) fn length(palette: &Palette) -> u64 {
    8 + 3 * u64::from(palette.last_index())
}

/// Reads a header to its end.
pub(crate) fn read(input: &mut impl Read) -> Result<Palette, FormatError> {
    let mut input = Fields { input, offset: 0 };
    let mut bytes = [0; 2];

    input.read("magic number", &mut bytes)?;
    if bytes != MAGIC {
        return Err(foreign(&mut input, bytes));
    }
    input.read("version", &mut bytes)?;
    let version = LittleEndian::read_u16(&bytes);
    if version != VERSION {
        return Err(FormatError::UnsupportedVersion { version });
    }
    input.read("palette size", &mut bytes)?;
    let size = LittleEndian::read_u16(&bytes);
    // Before anything is allocated.
    if usize::from(size) > Palette::MAX_COLORS {
        return Err(FormatError::PaletteSizeOutOfRange { size });
    }
    let mut colors = vec![[0; 3]; usize::from(size)];
    input.read("palette", colors.as_flattened_mut())?;
    input.read("separator", &mut bytes)?;
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
fn foreign(input: &mut Fields<'_, impl Read>, found: [u8; 2]) -> FormatError {
    let mut next = [0; 2];
    match input.read("magic number", &mut next) {
        Ok(()) if [found, next] == MAGICA_VOXEL => FormatError::MagicaVoxel,
        _ => FormatError::WrongMagic { found },
    }
}

/// Input that knows how far it has been read.
struct Fields<'a, R> {
    input: &'a mut R,
    offset: u64,
}

impl<R: Read> Fields<'_, R> {
    /// Fills `bytes`, or says what is cut off, and where.
    fn read(&mut self, field: &'static str, bytes: &mut [u8]) -> Result<(), FormatError> {
        let mut filled = 0;
        while filled < bytes.len() {
            match self.input.read(&mut bytes[filled..]) {
                Ok(0) => {
                    let missing = (bytes.len() - filled) as u64;
                    return Err(FormatError::TruncatedHeader { field, offset: self.offset, missing });
                }
                Ok(count) => {
                    filled += count;
                    self.offset += count as u64;
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(source) => return Err(FormatError::Read { offset: self.offset, source }),
            }
        }
        Ok(())
    }
}
