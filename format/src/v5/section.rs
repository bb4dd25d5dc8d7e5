//! The parts of a file behind its header: each says what it is, how long it is, and what its checksum is.

use super::Compression;
use super::compression::{compress, decompress};
use super::recycled::Recycled;
use crate::FormatError;
use byteorder::{ByteOrder, LittleEndian};
use std::borrow::Cow;
use std::ops::Deref;

/// Length of what stands before the stored bytes of a section.
pub(crate) const HEAD_BYTES: usize = 32;

/// No section holds more, uncompressed.
pub(crate) const MAX_SECTION_BYTES: u64 = 1 << 30;

/// What a section is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Materials,
    Subtree,
    Top,
    Index,
}

impl Kind {
    const ALL: [Self; 4] = [Self::Materials, Self::Subtree, Self::Top, Self::Index];

    const fn tag(self) -> [u8; 4] {
        match self {
            Self::Materials => *b"MATL",
            Self::Subtree => *b"TREE",
            Self::Top => *b"TOP ",
            Self::Index => *b"INDX",
        }
    }

    /// What people call it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Materials => "material palette",
            Self::Subtree => "subtree",
            Self::Top => "top of the tree",
            Self::Index => "subtree index",
        }
    }
}

/// What stands before the stored bytes of a section.
///
/// ```text
///  offset  bytes  field
///  0       4      kind          "MATL", "TREE", "TOP " or "INDX"
///  4       4      length        of the stored bytes that follow
///  8       8      code          TREE: Morton code of the subtree's cell; else 0
///  16      4      masks         TREE, TOP: number of child masks; else 0
///  20      4      items         TREE, TOP: voxels; MATL: materials; INDX: subtrees
///  24      2      table         TREE, TOP: length of the table of palette indices, at most 256; else 0
///  26      1      encoding      0 as it is, 1 Zstandard
///  27      1      reserved      zero
///  28      4      checksum      CRC-32 of bytes 0 to 27 and the stored bytes
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Head {
    pub kind: Kind,
    pub length: u32,
    pub code: u64,
    pub masks: u32,
    pub items: u32,
    pub table: u16,
    pub is_compressed: bool,
    pub checksum: u32,
}

impl Head {
    /// A head for what is about to be stored.
    pub fn new(kind: Kind, items: u32) -> Self {
        Self { kind, length: 0, code: 0, masks: 0, items, table: 0, is_compressed: false, checksum: 0 }
    }

    pub fn to_bytes(self) -> [u8; HEAD_BYTES] {
        let mut bytes = [0; HEAD_BYTES];
        bytes[0..4].copy_from_slice(&self.kind.tag());
        LittleEndian::write_u32(&mut bytes[4..8], self.length);
        LittleEndian::write_u64(&mut bytes[8..16], self.code);
        LittleEndian::write_u32(&mut bytes[16..20], self.masks);
        LittleEndian::write_u32(&mut bytes[20..24], self.items);
        LittleEndian::write_u16(&mut bytes[24..26], self.table);
        bytes[26] = u8::from(self.is_compressed);
        LittleEndian::write_u32(&mut bytes[28..32], self.checksum);
        bytes
    }

    /// The head that begins `offset` bytes after the beginning of the file.
    pub fn from_bytes(bytes: &[u8; HEAD_BYTES], offset: u64) -> Result<Self, FormatError> {
        let tag = [bytes[0], bytes[1], bytes[2], bytes[3]];
        let Some(kind) = Kind::ALL.into_iter().find(|kind| kind.tag() == tag) else {
            return Err(FormatError::UnknownSection { offset, found: tag });
        };
        for (place, limit, field) in [(26, 1, "encoding"), (27, 0, "reserved field")] {
            let value = u64::from(bytes[place]);
            if value > limit {
                return Err(FormatError::FieldOutOfRange {
                    offset: offset + place as u64,
                    field,
                    value,
                    limit,
                });
            }
        }
        Ok(Self {
            kind,
            length: LittleEndian::read_u32(&bytes[4..8]),
            code: LittleEndian::read_u64(&bytes[8..16]),
            masks: LittleEndian::read_u32(&bytes[16..20]),
            items: LittleEndian::read_u32(&bytes[20..24]),
            table: LittleEndian::read_u16(&bytes[24..26]),
            is_compressed: bytes[26] == 1,
            checksum: LittleEndian::read_u32(&bytes[28..32]),
        })
    }

    /// The checksum that these fields and stored bytes should have.
    fn computed_checksum(self, stored: &[u8]) -> u32 {
        crc32(&[&self.to_bytes()[..28], stored])
    }
}

/// A head and the stored bytes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Section<'a> {
    pub head: Head,
    pub stored: Cow<'a, [u8]>,
}

impl Section<'static> {
    /// Stores `raw`, compressed if that is wanted and makes it shorter.
    pub fn new(head: Head, raw: Vec<u8>, compression: Compression, level: i32) -> Result<Self, FormatError> {
        if raw.len() as u64 > MAX_SECTION_BYTES {
            let (section, bytes) = (head.kind.name(), raw.len() as u64);
            return Err(FormatError::SectionTooLarge { offset: 0, section, bytes, limit: MAX_SECTION_BYTES });
        }
        let compressed = match compression {
            Compression::None => None,
            Compression::Zstandard => {
                let compressed = compress(&raw, level).map_err(FormatError::Compression)?;
                Some(compressed).filter(|compressed| compressed.len() < raw.len())
            }
        };
        let is_compressed = compressed.is_some();
        let stored = compressed.unwrap_or(raw);
        let mut head = Head { length: stored.len() as u32, is_compressed, ..head };
        head.checksum = head.computed_checksum(&stored);
        Ok(Self { head, stored: stored.into() })
    }
}

impl Section<'_> {
    /// Length in the file, in bytes.
    pub fn length(&self) -> u64 {
        HEAD_BYTES as u64 + u64::from(self.head.length)
    }

    /// Whether this is what stands `offset` bytes after the beginning of the file, undamaged.
    pub fn check(&self, offset: u64, expected: Kind) -> Result<(), FormatError> {
        let (head, section) = (self.head, self.head.kind.name());
        if head.kind != expected {
            return Err(FormatError::UnexpectedSection { offset, found: section, expected: expected.name() });
        }
        let (stored, computed) = (head.checksum, head.computed_checksum(&self.stored));
        if stored != computed {
            return Err(FormatError::ChecksumMismatch { offset, section, stored, computed });
        }
        Ok(())
    }

    /// The bytes as they were before compression, of which there must be `length`. Nothing is allocated for more than
    /// that, or than the limit.
    pub fn raw(&self, offset: u64, length: u64, limit: u64) -> Result<Raw<'_>, FormatError> {
        let section = self.head.kind.name();
        let limit = limit.min(MAX_SECTION_BYTES);
        if length > limit {
            return Err(FormatError::SectionTooLarge { offset, section, bytes: length, limit });
        }
        if self.head.is_compressed {
            let raw = decompress(&self.stored, length as usize)
                .map_err(|source| FormatError::Decompression { offset, section, source })?;
            return Ok(Raw::Decompressed(raw));
        }
        let found = self.stored.len() as u64;
        if found != length {
            return Err(FormatError::SectionLength { offset, section, found, expected: length });
        }
        Ok(Raw::Stored(&self.stored))
    }
}

/// The bytes of a section as they were before compression.
#[derive(Debug)]
pub(crate) enum Raw<'a> {
    /// They have not been compressed.
    Stored(&'a [u8]),
    Decompressed(Recycled),
}

impl Deref for Raw<'_> {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        match self {
            Self::Stored(bytes) => bytes,
            Self::Decompressed(bytes) => bytes,
        }
    }
}

/// The CRC-32 of some bytes one after the other, as in PNG and zip.
pub(crate) fn crc32(parts: &[&[u8]]) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    parts.iter().for_each(|part| hasher.update(part));
    hasher.finalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_checksum_is_that_of_png_and_zip() {
        // The check value of CRC-32/ISO-HDLC.
        assert_eq!(crc32(&[b"12345", b"6789"]), 0xCBF4_3926);
    }
}
