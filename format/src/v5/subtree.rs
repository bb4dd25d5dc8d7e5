//! A subtree, and the section of the file that holds it.

use super::compression::DEFAULT_LEVEL;
use super::decoding::decode;
use super::encoding::encode;
use super::section::{Head, Kind, Section};
use super::{Compression, Header, LevelCount, LevelDefect, Levels};
use crate::{FormatError, Limits};
use std::ops::Range;

/// The part of an octree in one cell of the level at which it is cut.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Subtree {
    /// Morton code of the cell.
    pub code: u64,
    /// Its voxels, from that of the cell itself down to the finest.
    pub levels: Levels,
}

/// A subtree as it is written into a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EncodedSubtree {
    pub(crate) section: Section<'static>,
    /// The levels that it has.
    pub(crate) first_level: u8,
    /// Voxels of each level.
    pub(crate) counts: Vec<LevelCount>,
    pub(crate) largest_index: u16,
}

impl EncodedSubtree {
    /// Morton code of the subtree's cell.
    #[must_use]
    pub fn code(&self) -> u64 {
        self.section.head.code
    }

    /// Length in the file, in bytes.
    #[must_use]
    pub fn byte_length(&self) -> u64 {
        self.section.length()
    }
}

/// Turns subtrees into sections of a file. It may be used by several threads at once.
#[derive(Debug, Clone, Copy)]
pub struct Encoder {
    compression: Compression,
    level: i32,
}

impl Encoder {
    /// For files with this header.
    #[must_use]
    pub fn new(header: &Header) -> Self {
        Self { compression: header.compression, level: DEFAULT_LEVEL }
    }

    /// With another level of compression than 3: from 1, the fastest, to 19, the shortest.
    #[must_use]
    pub fn with_level(self, level: i32) -> Self {
        Self { level: level.clamp(1, 19), ..self }
    }

    /// Encodes a subtree. The result does not depend on what else is encoded, when, or where.
    ///
    /// # Errors
    /// [`FormatError::SectionTooLarge`] if it holds more than 1 GiB; [`FormatError::Compression`] if there is too little
    /// memory to compress it.
    pub fn encode(&self, subtree: &Subtree) -> Result<EncodedSubtree, FormatError> {
        let levels = &subtree.levels;
        Ok(EncodedSubtree {
            section: self.section(Kind::Subtree, subtree.code, levels)?,
            first_level: levels.first_level(),
            counts: LevelCount::of(levels),
            largest_index: levels.largest_index(),
        })
    }

    /// A section of levels.
    pub(crate) fn section(
        &self,
        kind: Kind,
        code: u64,
        levels: &Levels,
    ) -> Result<Section<'static>, FormatError> {
        let (raw, table) = encode(levels);
        // More do not fit into a section; that is an error below.
        let [masks, items] = [levels.masks().len(), levels.voxel_count()]
            .map(|count| u32::try_from(count).unwrap_or(u32::MAX));
        let head = Head { code, masks, table, ..Head::new(kind, items) };
        self.store(head, raw)
    }

    /// A section of other bytes.
    pub(crate) fn store(&self, head: Head, raw: Vec<u8>) -> Result<Section<'static>, FormatError> {
        Section::new(head, raw, self.compression, self.level)
    }
}

/// A subtree as it stands in a file, undamaged but not yet looked into.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StoredSubtree<'a> {
    pub(crate) section: Section<'a>,
    /// Where it begins in the file.
    pub(crate) offset: u64,
}

impl StoredSubtree<'_> {
    /// Morton code of the subtree's cell.
    #[must_use]
    pub fn code(&self) -> u64 {
        self.section.head.code
    }

    /// Where the section begins in the file, in bytes.
    #[must_use]
    pub fn offset(&self) -> u64 {
        self.offset
    }

    /// Length in the file, in bytes.
    #[must_use]
    pub fn byte_length(&self) -> u64 {
        self.section.length()
    }
}

/// Turns sections of a file into subtrees. It may be used by several threads at once.
#[derive(Debug, Clone, Copy)]
pub struct Decoder {
    depth: u8,
    cut_level: u8,
    materials: u16,
    limits: Limits,
}

impl Decoder {
    pub(crate) fn new(header: &Header, materials: u16, limits: Limits) -> Self {
        Self { depth: header.depth, cut_level: header.cut_level, materials, limits }
    }

    /// Decodes a subtree.
    ///
    /// # Errors
    /// A [`FormatError`] if the section holds something else than levels of a tree.
    pub fn decode(&self, subtree: &StoredSubtree<'_>) -> Result<Subtree, FormatError> {
        self.decode_down_to(subtree, self.depth)
    }

    /// Decodes the levels of a subtree down to `level`, but its root's at least: what it would be in an octree of that
    /// depth.
    ///
    /// # Errors
    /// As [`Decoder::decode`]. What is below `level` is not checked.
    pub fn decode_down_to(&self, subtree: &StoredSubtree<'_>, level: u8) -> Result<Subtree, FormatError> {
        let depth = level.clamp(self.cut_level, self.depth);
        let wanted = depth - self.cut_level + 1;
        let levels =
            self.decode_section(&subtree.section, subtree.offset, self.cut_level..self.depth + 1, wanted)?;
        Ok(Subtree { code: subtree.section.head.code, levels })
    }

    /// Decodes the top of the tree.
    pub(crate) fn decode_top(&self, section: &Section<'_>, offset: u64) -> Result<Levels, FormatError> {
        self.decode_section(section, offset, 0..self.cut_level, self.cut_level)
    }

    /// The first `wanted` levels of a section that has those of `stored`.
    fn decode_section(
        &self,
        section: &Section<'_>,
        offset: u64,
        stored: Range<u8>,
        wanted: u8,
    ) -> Result<Levels, FormatError> {
        let damaged =
            |defect| FormatError::DamagedLevels { offset, section: section.head.kind.name(), defect };
        let levels = decode(section, offset, stored, wanted, self.limits)?;
        match levels.largest_index() {
            0 if section.head.kind == Kind::Subtree => Err(damaged(LevelDefect::NoVoxels)),
            index if index > self.materials => {
                Err(damaged(LevelDefect::PaletteIndex { index, materials: self.materials }))
            }
            _ => Ok(levels),
        }
    }
}
