//! The bytes of a file, from the front: numbers, texts, dictionaries, chunks.

use super::super::ExchangeError;
use std::collections::BTreeMap;

/// What a chunk or node says about itself, by name.
pub(super) type Dictionary = BTreeMap<String, String>;

/// Bytes that are taken from the front, and where in the file they are.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bytes<'a> {
    bytes: &'a [u8],
    /// Where the next one is.
    pub offset: u64,
}

/// A part of the file: its kind, what is in it, and where that begins.
#[derive(Debug, Clone, Copy)]
pub(super) struct Chunk<'a> {
    pub kind: [u8; 4],
    pub content: Bytes<'a>,
    pub children: Bytes<'a>,
}

impl<'a> Bytes<'a> {
    /// The bytes of a file.
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, offset: 0 }
    }

    pub fn is_empty(self) -> bool {
        self.bytes.is_empty()
    }

    /// The next `count` bytes.
    pub fn take(&mut self, count: usize, part: &'static str) -> Result<&'a [u8], ExchangeError> {
        let offset = self.offset;
        let (taken, rest) =
            self.bytes.split_at_checked(count).ok_or(ExchangeError::Truncated { offset, part })?;
        self.bytes = rest;
        self.offset += count as u64;
        Ok(taken)
    }

    /// The next number.
    pub fn number(&mut self, part: &'static str) -> Result<u32, ExchangeError> {
        let bytes = self.take(4, part)?;
        Ok(bytes.iter().rev().fold(0, |number, byte| number << 8 | u32::from(*byte)))
    }

    /// How many things follow, each of at least `least` bytes; as many must be there.
    pub fn count(&mut self, least: usize, part: &'static str) -> Result<usize, ExchangeError> {
        let count = self.number(part)? as usize;
        match count.checked_mul(least) {
            Some(length) if length <= self.bytes.len() => Ok(count),
            _ => Err(ExchangeError::Truncated { offset: self.offset + self.bytes.len() as u64, part }),
        }
    }

    /// The next dictionary.
    pub fn dictionary(&mut self, part: &'static str) -> Result<Dictionary, ExchangeError> {
        let count = self.count(8, part)?;
        (0..count).map(|_| Ok((self.text(part)?, self.text(part)?))).collect()
    }

    /// The next text. Bytes that are not UTF-8 are replaced: no key or number that means something has such.
    fn text(&mut self, part: &'static str) -> Result<String, ExchangeError> {
        let length = self.count(1, part)?;
        Ok(String::from_utf8_lossy(self.take(length, part)?).into_owned())
    }

    /// The next chunk.
    pub fn chunk(&mut self) -> Result<Chunk<'a>, ExchangeError> {
        const PART: &str = "chunk";
        let kind = self.take(4, PART)?;
        let [content, children] = [self.number(PART)?, self.number(PART)?];
        let offset = self.offset;
        let content = Self { bytes: self.take(content as usize, PART)?, offset };
        let offset = self.offset;
        let children = Self { bytes: self.take(children as usize, PART)?, offset };
        Ok(Chunk { kind: [kind[0], kind[1], kind[2], kind[3]], content, children })
    }
}

/// A chunk without children.
pub(super) fn chunk(kind: &[u8; 4], content: &[u8]) -> Vec<u8> {
    // A model has at most 2²⁴ voxels.
    [&kind[..], &(content.len() as u32).to_le_bytes(), &[0; 4], content].concat()
}

/// A dictionary.
pub(super) fn dictionary(entries: &[(&str, String)]) -> Vec<u8> {
    let mut bytes = (entries.len() as u32).to_le_bytes().to_vec();
    for text in entries.iter().flat_map(|(key, value)| [*key, value]) {
        bytes.extend((text.len() as u32).to_le_bytes());
        bytes.extend(text.as_bytes());
    }
    bytes
}
