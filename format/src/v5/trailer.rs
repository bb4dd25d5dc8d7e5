//! What stands at the end of a file, so that a reader that can seek finds everything else.

use super::index::Index;
use super::section::crc32;
use crate::FormatError;
use byteorder::{ByteOrder, LittleEndian};

/// Length of the trailer, in bytes.
pub(crate) const TRAILER_BYTES: usize = 36;

const TAG: [u8; 4] = *b"END ";
const CHECKED: usize = 32;

/// The end of a file.
///
/// ```text
///  offset  bytes  field
///  0       4      kind          "END "
///  4       4      subtrees      their number
///  8       8      top           where the section "TOP " begins in the file
///  16      8      index         where the section "INDX" begins in the file
///  24      8      voxels        on all levels
///  32      4      checksum      CRC-32 of bytes 0 to 31
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Trailer {
    pub subtrees: u32,
    pub top: u64,
    pub index: u64,
    pub voxels: u64,
}

impl Trailer {
    pub fn to_bytes(self) -> [u8; TRAILER_BYTES] {
        let mut bytes = [0; TRAILER_BYTES];
        bytes[0..4].copy_from_slice(&TAG);
        LittleEndian::write_u32(&mut bytes[4..8], self.subtrees);
        LittleEndian::write_u64_into(&[self.top, self.index, self.voxels], &mut bytes[8..32]);
        let checksum = crc32(&[&bytes[..CHECKED]]);
        LittleEndian::write_u32(&mut bytes[CHECKED..], checksum);
        bytes
    }

    /// The trailer that begins `offset` bytes after the beginning of the file.
    pub fn from_bytes(bytes: &[u8; TRAILER_BYTES], offset: u64) -> Result<Self, FormatError> {
        if bytes[0..4] != TAG {
            return Err(FormatError::NoTrailer { offset });
        }
        let (stored, computed) = (LittleEndian::read_u32(&bytes[CHECKED..]), crc32(&[&bytes[..CHECKED]]));
        if stored != computed {
            return Err(FormatError::ChecksumMismatch { offset, section: "trailer", stored, computed });
        }
        let long = |offset: usize| LittleEndian::read_u64(&bytes[offset..offset + 8]);
        Ok(Self {
            subtrees: LittleEndian::read_u32(&bytes[4..8]),
            top: long(8),
            index: long(16),
            voxels: long(24),
        })
    }

    /// Whether this is the end of a file with these sections. It begins itself at `offset`.
    pub fn check(self, offset: u64, top: u64, index_offset: u64, index: &Index) -> Result<(), FormatError> {
        let subtrees = index.subtrees.len() as u64;
        let comparisons = [
            ("number of subtrees", 4, u64::from(self.subtrees), subtrees),
            ("place of the top of the tree", 8, self.top, top),
            ("place of the index", 16, self.index, index_offset),
            ("number of voxels", 24, self.voxels, index.voxels()),
        ];
        match comparisons.into_iter().find(|(_, _, told, found)| told != found) {
            Some((field, place, told, found)) => {
                Err(FormatError::WrongTrailer { offset: offset + place, field, told, found })
            }
            None => Ok(()),
        }
    }
}
