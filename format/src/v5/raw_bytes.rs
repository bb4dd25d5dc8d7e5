//! The bytes of a section as they were before compression, taken from the front.

use super::section::{Raw, Section};
use crate::{FormatError, Limits};

/// The bytes of a section, and how many of them have been taken.
pub(crate) struct RawBytes<'a> {
    bytes: Raw<'a>,
    taken: usize,
    section: &'static str,
    offset: u64,
}

impl<'a> RawBytes<'a> {
    /// The bytes of a section that begins `offset` bytes after the beginning of the file; there must be `length`.
    pub fn new(
        section: &'a Section<'_>,
        offset: u64,
        length: u64,
        limits: Limits,
    ) -> Result<Self, FormatError> {
        let bytes = section.raw(offset, length, limits.max_section_bytes)?;
        Ok(Self { bytes, taken: 0, section: section.head.kind.name(), offset })
    }

    /// The next `count` bytes.
    pub fn take(&mut self, count: usize) -> Result<&[u8], FormatError> {
        let start = self.taken;
        self.taken = start.saturating_add(count);
        let (found, expected) = (self.bytes.len() as u64, self.taken as u64);
        let (offset, section) = (self.offset, self.section);
        self.bytes.get(start..self.taken).ok_or(FormatError::SectionLength {
            offset,
            section,
            found,
            expected,
        })
    }
}
