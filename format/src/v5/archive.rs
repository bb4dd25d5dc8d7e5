//! A file that can be searched: any subtree, at any time, down to any level.

use super::header::HEADER_BYTES;
use super::index::{Index, IndexEntry};
use super::reader::decode_materials;
use super::section::{HEAD_BYTES, Head, Kind, Section};
use super::trailer::{TRAILER_BYTES, Trailer};
use super::writer::{check_order, check_top};
use super::{Decoder, Header, Levels, Records, Region, Seekable, Source, StoredSubtree, Subtree};
use crate::input::Input;
use crate::{FormatError, Limits, MaterialPalette};
use std::borrow::Cow;
use std::io::{Read, Seek};
use std::ops::Range;

/// A file that is read in any order, by several threads at once.
#[derive(Debug)]
pub struct Archive<S> {
    source: S,
    header: Header,
    materials: MaterialPalette,
    limits: Limits,
    top: Levels,
    index: Index,
    file_bytes: u64,
}

impl<R: Read + Seek> Archive<Seekable<R>> {
    /// Reads what is at the beginning and at the end of a file. `input` need not be buffered.
    ///
    /// # Errors
    /// As [`Archive::with_limits`].
    pub fn open(input: R) -> Result<Self, FormatError> {
        Self::with_limits(Seekable::new(input), Limits::default())
    }
}

impl<'a> Archive<&'a [u8]> {
    /// Reads what is at the beginning and at the end of a file in memory, or mapped into it.
    ///
    /// # Errors
    /// As [`Archive::with_limits`].
    pub fn of_bytes(bytes: &'a [u8]) -> Result<Self, FormatError> {
        Self::with_limits(bytes, Limits::default())
    }
}

impl<S: Source> Archive<S> {
    /// Reads header, materials, index and top of the tree, with bounds on what the file may hold.
    ///
    /// # Errors
    /// A [`FormatError`] if the file is of another kind or version, or if one of these is damaged.
    pub fn with_limits(source: S, limits: Limits) -> Result<Self, FormatError> {
        let file_bytes = source.byte_length().map_err(|source| FormatError::Read { offset: 0, source })?;
        let file = Bytes { source: &source, start: 0, end: file_bytes };
        let beginning = file.read("header", 0, (HEADER_BYTES as u64).min(file_bytes))?;
        let (header, materials) = Header::read(&mut Input::new(&*beginning), limits)?;
        let first = HEADER_BYTES as u64;
        let section = file.section(first, Kind::Materials)?;
        let materials = decode_materials(&section, first, materials, limits)?;
        let first_subtree = first + section.length();

        let end = file_bytes.saturating_sub(TRAILER_BYTES as u64);
        let trailer = Trailer::from_bytes(&file.read_array("trailer", end)?, end)?;
        let index_section = file.section(trailer.index, Kind::Index)?;
        let index = Index::decode(&index_section, trailer.index, header.depth, limits)?;
        trailer.check(end, trailer.top, trailer.index, &index)?;
        if trailer.voxels > limits.max_records {
            return Err(FormatError::TooManyRecords { offset: end, max_records: limits.max_records });
        }
        let top_section = file.section(trailer.top, Kind::Top)?;
        let decoder = Decoder::new(&header, materials.last_index(), limits);
        let top = decoder.decode_top(&top_section, trailer.top)?;

        check_places(&index, first_subtree, trailer.top, header.cut_level)?;
        check_place(trailer.index, trailer.top + top_section.length())?;
        check_place(end, trailer.index + index_section.length())?;
        check_top(trailer.top, &top, header.cut_level, &index)?;
        Ok(Self { header, materials, limits, top, index, file_bytes, source })
    }

    /// What is said of the file before its voxels.
    #[must_use]
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// The materials of the file.
    #[must_use]
    pub fn materials(&self) -> &MaterialPalette {
        &self.materials
    }

    /// What subtrees there are, in Morton order, and how many voxels on each level.
    #[must_use]
    pub fn index(&self) -> &Index {
        &self.index
    }

    /// The levels above the subtrees.
    #[must_use]
    pub fn top(&self) -> &Levels {
        &self.top
    }

    /// Length of the file, in bytes.
    #[must_use]
    pub fn file_bytes(&self) -> u64 {
        self.file_bytes
    }

    /// Number of subtrees.
    #[must_use]
    pub fn subtree_count(&self) -> usize {
        self.index.subtrees.len()
    }

    /// The subtree with this number, counted from 0 in Morton order.
    ///
    /// # Errors
    /// [`FormatError::NoSubtree`] if there is none; another [`FormatError`] if it is damaged or cannot be read.
    pub fn subtree(&self, number: usize) -> Result<Subtree, FormatError> {
        self.subtree_down_to(number, self.header.depth)
    }

    /// The subtree with this number down to `level`, but its root's at least: what it would be in an octree of that
    /// depth. The whole section is read and checked, but takes no more memory than what is returned.
    ///
    /// # Errors
    /// As [`Archive::subtree`].
    pub fn subtree_down_to(&self, number: usize, level: u8) -> Result<Subtree, FormatError> {
        let decoder = Decoder::new(&self.header, self.materials.last_index(), self.limits);
        decoder.decode_down_to(&self.stored_subtree(number)?, level)
    }

    /// Some consecutive subtrees by their numbers, in Morton order, which are read from the file at once.
    ///
    /// # Errors
    /// [`FormatError::NoSubtree`] if one of them is not there; another [`FormatError`] if they cannot be read, or, instead
    /// of a subtree, if that is damaged.
    pub fn subtrees(
        &self,
        numbers: Range<usize>,
    ) -> Result<impl Iterator<Item = Result<Subtree, FormatError>> + use<'_, S>, FormatError> {
        let entries = self.index.subtrees.get(numbers.clone()).ok_or(FormatError::NoSubtree {
            number: numbers.end.saturating_sub(1) as u64,
            count: self.index.subtrees.len() as u64,
        })?;
        let start = entries.first().map_or(0, |entry| entry.offset);
        let end = entries.last().map_or(start, IndexEntry::end);
        let bytes = self.file().read(Kind::Subtree.name(), start, end - start)?;
        let decoder = Decoder::new(&self.header, self.materials.last_index(), self.limits);
        Ok(entries.iter().zip(numbers).map(move |(entry, number)| {
            let part = Bytes { source: &&*bytes, start, end };
            decoder.decode_down_to(&part.subtree(entry, number)?, self.header.depth)
        }))
    }

    /// The numbers of the subtrees that have a part in a region.
    pub fn subtrees_in(&self, region: Region) -> impl Iterator<Item = usize> {
        let (depth, cut_level) = (self.header.depth, self.header.cut_level);
        let meets = move |entry: &IndexEntry| region.meets(entry.code, cut_level, depth);
        self.index
            .subtrees
            .iter()
            .enumerate()
            .filter(move |(_, entry)| meets(entry))
            .map(|(number, _)| number)
    }

    /// All records in preorder, as a reader of version 4 would return them.
    pub fn records(&self) -> Records<'_, S> {
        self.records_down_to(self.header.depth)
    }

    /// The records of the octree down to `level`: those of the octree of that depth.
    pub fn records_down_to(&self, level: u8) -> Records<'_, S> {
        Records::new(self, level)
    }

    /// The section of a subtree, undamaged and as the index says.
    fn stored_subtree(&self, number: usize) -> Result<StoredSubtree<'_>, FormatError> {
        let count = self.index.subtrees.len() as u64;
        let Some(entry) = self.index.subtrees.get(number) else {
            return Err(FormatError::NoSubtree { number: number as u64, count });
        };
        self.file().subtree(entry, number)
    }

    fn file(&self) -> Bytes<'_, S> {
        Bytes { source: &self.source, start: 0, end: self.file_bytes }
    }
}

/// Whether the subtrees are in order, and one behind the other from `first` to `end`.
fn check_places(index: &Index, first: u64, end: u64, cut_level: u8) -> Result<(), FormatError> {
    let mut last: Option<&IndexEntry> = None;
    for entry in &index.subtrees {
        check_place(entry.offset, last.map_or(first, IndexEntry::end))?;
        check_order(entry.offset, last, entry.code, cut_level)?;
        last = Some(entry);
    }
    check_place(end, last.map_or(first, IndexEntry::end))
}

/// Whether a section begins where the one before it ends.
fn check_place(told: u64, found: u64) -> Result<(), FormatError> {
    if told == found { Ok(()) } else { Err(FormatError::Gap { offset: found, next: told }) }
}

/// A file that knows its length, or a part of one.
struct Bytes<'a, S> {
    source: &'a S,
    /// Where the source begins and ends in the file.
    start: u64,
    end: u64,
}

impl<'a, S: Source> Bytes<'a, S> {
    /// So many bytes of a section, if the file is that long.
    fn read(&self, section: &'static str, offset: u64, length: u64) -> Result<Cow<'a, [u8]>, FormatError> {
        let start = offset.checked_sub(self.start);
        let end = offset.checked_add(length).filter(|end| *end <= self.end);
        let (Some(start), Some(_), Ok(byte_count)) = (start, end, usize::try_from(length)) else {
            let missing = length.saturating_sub(self.end.saturating_sub(offset));
            return Err(FormatError::TruncatedSection { section, offset: self.end, missing });
        };
        self.source.bytes_at(start, byte_count).map_err(|source| FormatError::Read { offset, source })
    }

    fn read_array<const N: usize>(&self, section: &'static str, offset: u64) -> Result<[u8; N], FormatError> {
        let mut array = [0; N];
        // As long as it was asked for.
        array.copy_from_slice(&self.read(section, offset, N as u64)?);
        Ok(array)
    }

    /// The section that begins at `offset`.
    fn section(&self, offset: u64, expected: Kind) -> Result<Section<'a>, FormatError> {
        let head = Head::from_bytes(&self.read_array(expected.name(), offset)?, offset)?;
        let stored = self.read(expected.name(), offset + HEAD_BYTES as u64, u64::from(head.length))?;
        let section = Section { head, stored };
        section.check(offset, expected)?;
        Ok(section)
    }
    /// The section of a subtree, undamaged and as the index says.
    fn subtree(&self, entry: &IndexEntry, number: usize) -> Result<StoredSubtree<'a>, FormatError> {
        let section = self.section(entry.offset, Kind::Subtree)?;
        if IndexEntry::new(&section.head, entry.offset) != *entry {
            return Err(FormatError::WrongIndex { offset: entry.offset, place: number as u64 });
        }
        Ok(StoredSubtree { section, offset: entry.offset })
    }
}
