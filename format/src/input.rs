//! Input that knows how far it has been read.

use crate::FormatError;
use std::io::{ErrorKind, Read};

/// What is being read, and how many bytes of it have been.
#[derive(Debug)]
pub(crate) struct Input<R> {
    input: R,
    offset: u64,
}

impl<R: Read> Input<R> {
    pub fn new(input: R) -> Self {
        Self { input, offset: 0 }
    }

    /// Bytes read so far.
    pub fn offset(&self) -> u64 {
        self.offset
    }

    pub fn into_inner(self) -> R {
        self.input
    }

    /// Fills `bytes` with a field of the header, or says which is cut off, and where.
    pub fn read_field(&mut self, field: &'static str, bytes: &mut [u8]) -> Result<(), FormatError> {
        match self.fill(bytes)? {
            0 => Ok(()),
            missing => Err(FormatError::TruncatedHeader { field, offset: self.offset, missing }),
        }
    }

    /// Fills `bytes` with a part of a section, or says which is cut off, and where.
    pub fn read_section(&mut self, section: &'static str, bytes: &mut [u8]) -> Result<(), FormatError> {
        match self.fill(bytes)? {
            0 => Ok(()),
            missing => Err(FormatError::TruncatedSection { section, offset: self.offset, missing }),
        }
    }

    /// So many bytes of a section. Memory is taken only as they come.
    pub fn read_vector(&mut self, section: &'static str, length: u64) -> Result<Vec<u8>, FormatError> {
        let mut bytes = Vec::new();
        let result = self.input.by_ref().take(length).read_to_end(&mut bytes);
        self.offset += bytes.len() as u64;
        let offset = self.offset;
        match result {
            Ok(count) if count as u64 == length => Ok(bytes),
            Ok(count) => {
                Err(FormatError::TruncatedSection { section, offset, missing: length - count as u64 })
            }
            Err(source) => Err(FormatError::Read { offset, source }),
        }
    }

    /// There must be no more bytes.
    pub fn expect_end(&mut self) -> Result<(), FormatError> {
        match self.fill(&mut [0])? {
            0 => Err(FormatError::TrailingBytes { offset: self.offset - 1 }),
            _ => Ok(()),
        }
    }

    /// Fills as much of `bytes` as there is, and says how many are missing.
    fn fill(&mut self, bytes: &mut [u8]) -> Result<u64, FormatError> {
        let mut filled = 0;
        while filled < bytes.len() {
            match self.input.read(&mut bytes[filled..]) {
                Ok(0) => break,
                Ok(count) => {
                    filled += count;
                    self.offset += count as u64;
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(source) => return Err(FormatError::Read { offset: self.offset, source }),
            }
        }
        Ok((bytes.len() - filled) as u64)
    }
}
