//! From subtrees to a file, from its beginning to its end.

use super::index::{Index, IndexEntry};
use super::levels::count_children;
use super::section::{Head, Kind, Section};
use super::trailer::Trailer;
use super::{EncodedSubtree, Encoder, Header, LevelCount, Levels};
use crate::{FormatError, MaterialPalette};
use std::io::{BufWriter, Write};

/// Writes a file subtree by subtree, in Morton order, without going back.
///
/// The subtrees are encoded by an [`Encoder`], by as many threads as there are. In memory stays only an entry of 32 bytes
/// for each. The file is complete only after [`finish`](Writer::finish).
#[derive(Debug)]
#[must_use = "a file is complete only after `finish`"]
pub struct Writer<W: Write> {
    output: BufWriter<W>,
    /// Bytes handed to the output.
    offset: u64,
    header: Header,
    encoder: Encoder,
    /// The largest palette index.
    last_index: u16,
    index: Index,
}

impl<W: Write> Writer<W> {
    /// Begins a file. `output` need not be buffered.
    ///
    /// # Errors
    /// A [`FormatError`] if a field of the header has a value that it cannot have, or if the output fails.
    pub fn new(output: W, header: &Header, materials: &MaterialPalette) -> Result<Self, FormatError> {
        header.check()?;
        let encoder = Encoder::new(header);
        let levels = vec![LevelCount::default(); usize::from(header.depth) + 1];
        let mut writer = Self {
            output: BufWriter::new(output),
            offset: 0,
            header: header.clone(),
            encoder,
            last_index: materials.last_index(),
            index: Index { levels, subtrees: Vec::new() },
        };
        writer.write(&header.to_bytes(materials.last_index()))?;
        let head = Head::new(Kind::Materials, u32::from(materials.last_index()));
        writer.write_section(&encoder.store(head, materials.to_bytes())?)?;
        Ok(writer)
    }

    /// What encodes subtrees for this file.
    #[must_use]
    pub fn encoder(&self) -> Encoder {
        self.encoder
    }

    /// Adds a subtree whose Morton code is larger than that of the one before.
    ///
    /// # Errors
    /// [`FormatError::SubtreeOrder`], [`FormatError::SubtreeCode`], [`FormatError::SubtreeLevels`] or
    /// [`FormatError::DamagedLevels`] if it does not fit into the file, which is left as it was;
    /// [`FormatError::Write`] if the output fails.
    pub fn subtree(&mut self, subtree: &EncodedSubtree) -> Result<(), FormatError> {
        let (offset, head) = (self.offset, &subtree.section.head);
        check_order(offset, self.index.subtrees.last(), head.code, self.header.cut_level)?;
        let levels = self.header.depth - self.header.cut_level + 1;
        if subtree.first_level != self.header.cut_level || subtree.counts.len() != usize::from(levels) {
            return Err(FormatError::SubtreeLevels {
                first: subtree.first_level,
                count: subtree.counts.len() as u8,
                expected_first: self.header.cut_level,
                expected_count: levels,
            });
        }
        check_index(offset, subtree.section.head.kind, subtree.largest_index, self.last_index)?;
        self.write_section(&subtree.section)?;
        self.index.count(subtree.first_level, &subtree.counts);
        self.index.subtrees.push(IndexEntry::new(head, offset));
        Ok(())
    }

    /// Number of bytes written so far.
    #[must_use]
    pub fn offset(&self) -> u64 {
        self.offset
    }

    /// Ends the file with the levels above the subtrees, and returns the output, to which everything has been written.
    ///
    /// # Errors
    /// [`FormatError::TopLevels`], [`FormatError::TopSubtrees`] or [`FormatError::DamagedLevels`] if these levels are not
    /// those above the subtrees; [`FormatError::Write`] if the output fails.
    pub fn finish(mut self, top: &Levels) -> Result<W, FormatError> {
        let top_offset = self.offset;
        check_top(top_offset, top, self.header.cut_level, &self.index)?;
        check_index(top_offset, Kind::Top, top.largest_index(), self.last_index)?;
        self.index.count(0, &LevelCount::of(top));
        let section = self.encoder.section(Kind::Top, 0, top)?;
        self.write_section(&section)?;

        let index_offset = self.offset;
        let (head, raw) = self.index.encode()?;
        let section = self.encoder.store(head, raw)?;
        self.write_section(&section)?;

        let trailer = Trailer {
            subtrees: head.items,
            top: top_offset,
            index: index_offset,
            voxels: self.index.voxels(),
        };
        self.write(&trailer.to_bytes())?;
        let offset = self.offset;
        self.output.flush().map_err(|source| FormatError::Write { offset, source })?;
        self.output
            .into_inner()
            .map_err(|failure| FormatError::Write { offset, source: failure.into_error() })
    }

    fn write_section(&mut self, section: &Section<'_>) -> Result<(), FormatError> {
        self.write(&section.head.to_bytes())?;
        self.write(&section.stored)
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), FormatError> {
        let offset = self.offset;
        self.output.write_all(bytes).map_err(|source| FormatError::Write { offset, source })?;
        self.offset += bytes.len() as u64;
        Ok(())
    }
}

/// Whether a subtree can follow the last one, in a file that is cut at a level.
pub(crate) fn check_order(
    offset: u64,
    last: Option<&IndexEntry>,
    code: u64,
    cut_level: u8,
) -> Result<(), FormatError> {
    if code >> (3 * cut_level) != 0 {
        return Err(FormatError::SubtreeCode { offset, code, cut_level });
    }
    match last {
        Some(last) if last.code >= code => {
            Err(FormatError::SubtreeOrder { offset, code, previous: last.code })
        }
        _ => Ok(()),
    }
}

/// Whether a top has the levels above the cut, and names the subtrees of the index.
pub(crate) fn check_top(offset: u64, top: &Levels, cut_level: u8, index: &Index) -> Result<(), FormatError> {
    if top.first_level() != 0 || top.level_count() != cut_level || !top.is_top() {
        let (first, count) = (top.first_level(), top.level_count());
        return Err(FormatError::TopLevels { first, count, expected_count: cut_level });
    }
    let found = index.subtrees.len();
    let (named, place) = match cut_level.checked_sub(1) {
        // Nothing is above, so the root itself may be the only subtree.
        None => (found.min(1), found.min(1)),
        Some(level) => {
            let named = count_children(top.level(level).masks);
            // Before memory is taken for so many codes.
            let codes = if named == found { top.child_codes(0, level) } else { Vec::new() };
            let pairs = codes.iter().zip(&index.subtrees);
            (named, pairs.take_while(|(code, entry)| **code == entry.code).count())
        }
    };
    if named != found || place != found {
        let [named, found, place] = [named, found, place].map(|count| count as u64);
        return Err(FormatError::TopSubtrees { offset, named, found, place });
    }
    Ok(())
}

/// Whether the largest palette index of some levels is in the palette.
fn check_index(offset: u64, kind: Kind, index: u16, materials: u16) -> Result<(), FormatError> {
    if index > materials {
        let defect = super::LevelDefect::PaletteIndex { index, materials };
        return Err(FormatError::DamagedLevels { offset, section: kind.name(), defect });
    }
    Ok(())
}
