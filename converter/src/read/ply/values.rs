//! The values of a PLY file, one after the other.

use super::header::{Element, Encoding, Header, Kind, Scalar};
use crate::ConvertError;
use crate::read::number::parse_number;
use std::path::Path;

/// Reads numbers, in whichever way they are written. Every type of number is exact as a double.
pub(super) struct Values<'a> {
    path: &'a Path,
    encoding: Encoding,
    rest: &'a [u8],
    /// Where the rest begins, in bytes.
    offset: usize,
    /// Line of the last value from 0, in a text.
    line: usize,
}

impl<'a> Values<'a> {
    /// The values behind a header.
    pub(super) fn new(path: &'a Path, bytes: &'a [u8], header: &Header) -> Self {
        Self {
            path,
            encoding: header.encoding,
            rest: &bytes[header.length..],
            offset: header.length,
            line: header.lines,
        }
    }

    /// How many of an element there are; an error if the rest of the file is too short for them.
    pub(super) fn check_count(&self, element: &Element) -> Result<usize, ConvertError> {
        let min_size: usize = element
            .properties
            .iter()
            // In a text at least a digit and a blank, which the last one need not have.
            .map(|property| if self.encoding == Encoding::Text { 2 } else { property.kind.min_size() })
            .sum();
        let available = self.rest.len() + 1;
        if element.count.checked_mul(min_size as u64).is_none_or(|needed| needed > available as u64) {
            return Err(self.wrong(format!(
                "{} of `{}` do not fit into the remaining {} bytes; the file is incomplete",
                element.count,
                element.name,
                self.rest.len()
            )));
        }
        // Without properties there is nothing to be read, however many there are.
        Ok(if min_size == 0 { 0 } else { element.count as usize })
    }

    /// An error at the current place: the line in a text, the byte in a binary file.
    pub(super) fn wrong(&self, problem: String) -> ConvertError {
        let path = self.path.to_owned();
        match self.encoding {
            Encoding::Text => ConvertError::Statement { path, line: self.line + 1, problem },
            _ => ConvertError::Bytes { path, offset: self.offset, problem },
        }
    }

    /// The next number.
    pub(super) fn next(&mut self, scalar: Scalar) -> Result<f64, ConvertError> {
        match self.encoding {
            Encoding::Text => self.next_in_text(),
            Encoding::LittleEndian | Encoding::BigEndian => self.next_in_bytes(scalar),
        }
    }

    fn next_in_text(&mut self) -> Result<f64, ConvertError> {
        let mut start = 0;
        while let Some(byte) = self.rest.get(start).filter(|byte| byte.is_ascii_whitespace()) {
            self.line += usize::from(*byte == b'\n');
            start += 1;
        }
        let length = self.rest[start..].iter().position(u8::is_ascii_whitespace);
        let end = length.map_or(self.rest.len(), |length| start + length);
        let word = &self.rest[start..end];
        if word.is_empty() {
            return Err(self.ended());
        }
        let Some(number) = parse_number(word) else {
            let word = String::from_utf8_lossy(word);
            return Err(self.wrong(format!("`{}` is no number", word.escape_debug())));
        };
        self.advance(end);
        Ok(number)
    }

    fn next_in_bytes(&mut self, scalar: Scalar) -> Result<f64, ConvertError> {
        Ok(match scalar {
            Scalar::Char => f64::from(i8::from_le_bytes(self.take()?)),
            Scalar::UChar => f64::from(u8::from_le_bytes(self.take()?)),
            Scalar::Short => f64::from(i16::from_le_bytes(self.take()?)),
            Scalar::UShort => f64::from(u16::from_le_bytes(self.take()?)),
            Scalar::Int => f64::from(i32::from_le_bytes(self.take()?)),
            Scalar::UInt => f64::from(u32::from_le_bytes(self.take()?)),
            Scalar::Float => f64::from(f32::from_le_bytes(self.take()?)),
            Scalar::Double => f64::from_le_bytes(self.take()?),
        })
    }

    /// The next bytes, in little-endian order.
    fn take<const N: usize>(&mut self) -> Result<[u8; N], ConvertError> {
        let Some(&bytes) = self.rest.first_chunk::<N>() else { return Err(self.ended()) };
        self.advance(N);
        let mut bytes = bytes;
        if self.encoding == Encoding::BigEndian {
            bytes.reverse();
        }
        Ok(bytes)
    }

    fn advance(&mut self, length: usize) {
        self.rest = &self.rest[length..];
        self.offset += length;
    }

    fn ended(&self) -> ConvertError {
        self.wrong("the file ends before its last element; it is incomplete".to_owned())
    }

    /// One element: a number for each property, lists are passed over.
    pub(super) fn read_row(&mut self, element: &Element, row: &mut [f64]) -> Result<(), ConvertError> {
        for (value, property) in row.iter_mut().zip(&element.properties) {
            match property.kind {
                Kind::Scalar(scalar) => *value = self.next(scalar)?,
                Kind::List { .. } => self.skip(property.kind)?,
            }
        }
        Ok(())
    }

    /// The items of a list, in place of those that stand in `items`.
    pub(super) fn read_list(&mut self, kind: Kind, items: &mut Vec<f64>) -> Result<(), ConvertError> {
        items.clear();
        self.each_item(kind, |item| items.push(item))
    }

    /// Passes over a number or a list.
    pub(super) fn skip(&mut self, kind: Kind) -> Result<(), ConvertError> {
        match kind {
            Kind::Scalar(scalar) => self.next(scalar).map(drop),
            Kind::List { .. } => self.each_item(kind, drop),
        }
    }

    fn each_item(&mut self, kind: Kind, mut each: impl FnMut(f64)) -> Result<(), ConvertError> {
        let Kind::List { count, item } = kind else { return Ok(()) };
        let length = self.next(count)?;
        if !(length >= 0.0 && length.fract() == 0.0) {
            return Err(self.wrong(format!("a list of {length} items; expected a whole number of them")));
        }
        let mut read = 0.0;
        while read < length {
            each(self.next(item)?);
            read += 1.0;
        }
        Ok(())
    }
}
