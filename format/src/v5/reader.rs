//! From a file, from its beginning to its end, to subtrees.

use super::header::HEADER_BYTES;
use super::index::{Index, IndexEntry};
use super::section::{HEAD_BYTES, Head, Kind, Section};
use super::trailer::{TRAILER_BYTES, Trailer};
use super::writer::{check_order, check_top};
use super::{Decoder, Header, Levels, StoredSubtree};
use crate::input::Input;
use crate::material::MATERIAL_BYTES;
use crate::{FormatError, Limits, MaterialPalette};
use std::io::{BufReader, Read};

/// Reads a file that need not be searchable, such as a pipe: first the subtrees, in Morton order, then the top of the tree.
///
/// What is handed out has been checked against its checksum. Subtrees are decoded by a [`Decoder`], by as many threads
/// as there are.
#[derive(Debug)]
pub struct Reader<R: Read> {
    input: Input<BufReader<R>>,
    header: Header,
    materials: MaterialPalette,
    limits: Limits,
    /// Where the first section behind the materials begins.
    first_subtree: u64,
    /// The subtrees so far.
    subtrees: Vec<IndexEntry>,
    voxels: u64,
    /// The section that follows the last subtree, and where it begins.
    top: Option<(Section<'static>, u64)>,
    /// An error has been returned.
    failed: bool,
}

/// What stands behind the subtrees.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Ending {
    /// The levels above the subtrees.
    pub top: Levels,
    /// What subtrees there are. It has been compared with those that were read.
    pub index: Index,
    /// Length of the file, in bytes.
    pub file_bytes: u64,
    /// Where these bytes are.
    pub parts: Parts,
}

/// Lengths of the parts of a file, in bytes. Their sum is that of the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Parts {
    /// What is said of the file before its voxels.
    pub header: u64,
    /// The section of the materials.
    pub materials: u64,
    /// The sections of all subtrees.
    pub subtrees: u64,
    /// The section of the levels above the subtrees.
    pub top: u64,
    /// The section of the index.
    pub index: u64,
    /// The end.
    pub trailer: u64,
}

impl<R: Read> Reader<R> {
    /// Reads and checks the header and the materials. `input` need not be buffered.
    ///
    /// # Errors
    /// A [`FormatError`] if the file is of another kind or version, is damaged, or ends.
    pub fn new(input: R) -> Result<Self, FormatError> {
        Self::with_limits(input, Limits::default())
    }

    /// As [`Reader::new`], with bounds on what the file may hold.
    ///
    /// # Errors
    /// As [`Reader::new`].
    pub fn with_limits(input: R, limits: Limits) -> Result<Self, FormatError> {
        let mut input = Input::new(BufReader::new(input));
        let (header, materials) = Header::read(&mut input, limits)?;
        let offset = input.offset();
        let section = read_section(&mut input, Kind::Materials)?;
        let materials = decode_materials(&section, offset, materials, limits)?;
        Ok(Self {
            first_subtree: input.offset(),
            input,
            header,
            materials,
            limits,
            subtrees: Vec::new(),
            voxels: 0,
            top: None,
            failed: false,
        })
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

    /// The bounds on what the file may hold.
    pub(crate) fn limits(&self) -> Limits {
        self.limits
    }

    /// The input, read so far or somewhat farther.
    pub fn into_inner(self) -> R {
        self.input.into_inner().into_inner()
    }

    /// What decodes the subtrees of this file.
    #[must_use]
    pub fn decoder(&self) -> Decoder {
        Decoder::new(&self.header, self.materials.last_index(), self.limits)
    }

    /// The next subtree; `None` after the last one, and after an error.
    ///
    /// # Errors
    /// A [`FormatError`] if the file is damaged, ends, or holds more than the limits allow.
    pub fn next_subtree(&mut self) -> Result<Option<StoredSubtree<'static>>, FormatError> {
        if self.failed || self.top.is_some() {
            return Ok(None);
        }
        let next = self.read_next();
        self.failed = next.is_err();
        next
    }

    fn read_next(&mut self) -> Result<Option<StoredSubtree<'static>>, FormatError> {
        let offset = self.input.offset();
        let head = read_head(&mut self.input)?;
        let expected = if head.kind == Kind::Top { Kind::Top } else { Kind::Subtree };
        let section = read_stored(&mut self.input, head, offset, expected)?;
        self.voxels = self.voxels.saturating_add(u64::from(head.items));
        if self.voxels > self.limits.max_records {
            return Err(FormatError::TooManyRecords { offset, max_records: self.limits.max_records });
        }
        if head.kind == Kind::Top {
            self.top = Some((section, offset));
            return Ok(None);
        }
        check_order(offset, self.subtrees.last(), head.code, self.header.cut_level)?;
        self.subtrees.push(IndexEntry::new(&head, offset));
        Ok(Some(StoredSubtree { section, offset }))
    }

    /// Reads what stands behind the subtrees, to the end of the file. Subtrees that have not been asked for are passed over.
    ///
    /// # Errors
    /// A [`FormatError`] if the file is damaged or ends, if it goes on behind its end, or if its index or the top of the
    /// tree do not fit the subtrees.
    pub fn finish(mut self) -> Result<Ending, FormatError> {
        while self.next_subtree()?.is_some() {}
        let Some((section, top_offset)) = self.top.take() else {
            return Err(FormatError::AfterError { offset: self.input.offset() });
        };
        let top = self.decoder().decode_top(&section, top_offset)?;

        let index_offset = self.input.offset();
        let section = read_section(&mut self.input, Kind::Index)?;
        let index = Index::decode(&section, index_offset, self.header.depth, self.limits)?;
        if index.subtrees != self.subtrees {
            let equal = self.subtrees.iter().zip(&index.subtrees).take_while(|(found, told)| found == told);
            let place = equal.count();
            return Err(FormatError::WrongIndex { offset: index_offset, place: place as u64 });
        }
        check_top(top_offset, &top, self.header.cut_level, &index)?;

        let offset = self.input.offset();
        let mut bytes = [0; TRAILER_BYTES];
        self.input.read_section("trailer", &mut bytes)?;
        let trailer = Trailer::from_bytes(&bytes, offset)?;
        trailer.check(offset, top_offset, index_offset, &index)?;
        self.input.expect_end()?;
        let parts = Parts {
            header: HEADER_BYTES as u64,
            materials: self.first_subtree - HEADER_BYTES as u64,
            subtrees: top_offset - self.first_subtree,
            top: index_offset - top_offset,
            index: offset - index_offset,
            trailer: TRAILER_BYTES as u64,
        };
        Ok(Ending { top, index, file_bytes: self.input.offset(), parts })
    }
}

fn read_section<R: Read>(input: &mut Input<R>, expected: Kind) -> Result<Section<'static>, FormatError> {
    let offset = input.offset();
    let head = read_head(input)?;
    read_stored(input, head, offset, expected)
}

fn read_head<R: Read>(input: &mut Input<R>) -> Result<Head, FormatError> {
    let offset = input.offset();
    let mut bytes = [0; HEAD_BYTES];
    input.read_section("head of a section", &mut bytes)?;
    Head::from_bytes(&bytes, offset)
}

/// The section behind its head, which begins at `offset`.
fn read_stored<R: Read>(
    input: &mut Input<R>,
    head: Head,
    offset: u64,
    expected: Kind,
) -> Result<Section<'static>, FormatError> {
    // Before megabytes of something else are read.
    if head.kind != expected {
        let (found, expected) = (head.kind.name(), expected.name());
        return Err(FormatError::UnexpectedSection { offset, found, expected });
    }
    let stored = input.read_vector(head.kind.name(), u64::from(head.length))?;
    let section = Section { head, stored: stored.into() };
    section.check(offset, expected)?;
    Ok(section)
}

/// The materials from their section, of which the header says that there are so many.
pub(crate) fn decode_materials(
    section: &Section<'_>,
    offset: u64,
    count: u16,
    limits: Limits,
) -> Result<MaterialPalette, FormatError> {
    if section.head.items != u32::from(count) {
        let (value, limit) = (u64::from(section.head.items), u64::from(count));
        return Err(FormatError::FieldOutOfRange {
            offset: offset + 20,
            field: "number of materials",
            value,
            limit,
        });
    }
    let length = MATERIAL_BYTES as u64 * u64::from(count);
    MaterialPalette::from_bytes(&section.raw(offset, length, limits.max_section_bytes)?)
}
