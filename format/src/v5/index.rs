//! What subtrees a file has, where they are, and how many voxels there are on each level.

use super::Levels;
use super::section::{Head, Kind, Section};
use crate::{FormatError, Limits};
use byteorder::{ByteOrder, LittleEndian};

/// Length of the counts of a level, and of the entry of a subtree, in bytes.
const COUNT_BYTES: usize = 16;
const ENTRY_BYTES: usize = 32;

/// What subtrees a file has, and how many voxels there are on each level.
///
/// ```text
///  offset     bytes   field
///  0          16·l    counts     for each of l = depth + 1 levels, from the root's on
///  16·l       32·n    entries    for each of n subtrees, in the order of the file
///
///  count      0  8    voxels     on this level
///             8  8    nodes      voxels on this level that have children
///
///  entry      0  8    code       Morton code of the subtree's cell
///             8  8    offset     where its section begins in the file
///             16 4    length     of the stored bytes of the section
///             20 4    masks      number of child masks
///             24 4    voxels
///             28 4    checksum   that of the section
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Index {
    /// The voxels of each level, from the root's to the finest.
    pub levels: Vec<LevelCount>,
    /// The subtrees in Morton order.
    pub subtrees: Vec<IndexEntry>,
}

/// How many voxels there are on a level.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct LevelCount {
    /// All of them.
    pub voxels: u64,
    /// Those that have children.
    pub nodes: u64,
}

/// Where in the file a subtree is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct IndexEntry {
    /// Morton code of its cell, at the level at which the octree is cut.
    pub code: u64,
    /// Where its section begins, in bytes from the beginning of the file.
    pub offset: u64,
    /// Number of stored bytes in its section.
    pub length: u32,
    /// Number of child masks.
    pub masks: u32,
    /// Number of voxels.
    pub voxels: u32,
    /// Checksum of its section.
    pub checksum: u32,
}

impl LevelCount {
    /// The counts of some levels.
    pub(crate) fn of(levels: &Levels) -> Vec<Self> {
        let first = levels.first_level();
        let count = |level| {
            let masks = levels.level(level).masks;
            let nodes = masks.iter().filter(|mask| **mask != 0).count() as u64;
            Self { voxels: levels.range(level).len() as u64, nodes }
        };
        (first..first + levels.level_count()).map(count).collect()
    }
}

impl IndexEntry {
    /// The entry of a section that begins `offset` bytes after the beginning of the file.
    pub(crate) fn new(head: &Head, offset: u64) -> Self {
        Self {
            code: head.code,
            offset,
            length: head.length,
            masks: head.masks,
            voxels: head.items,
            checksum: head.checksum,
        }
    }

    /// Where the next section begins.
    #[must_use]
    pub fn end(&self) -> u64 {
        self.offset.saturating_add(super::section::HEAD_BYTES as u64 + u64::from(self.length))
    }

    fn to_bytes(self) -> [u8; ENTRY_BYTES] {
        let mut bytes = [0; ENTRY_BYTES];
        LittleEndian::write_u64_into(&[self.code, self.offset], &mut bytes[..16]);
        LittleEndian::write_u32_into(
            &[self.length, self.masks, self.voxels, self.checksum],
            &mut bytes[16..],
        );
        bytes
    }

    fn from_bytes(bytes: &[u8; ENTRY_BYTES]) -> Self {
        let long = |offset: usize| LittleEndian::read_u64(&bytes[offset..offset + 8]);
        let short = |offset: usize| LittleEndian::read_u32(&bytes[offset..offset + 4]);
        Self {
            code: long(0),
            offset: long(8),
            length: short(16),
            masks: short(20),
            voxels: short(24),
            checksum: short(28),
        }
    }
}

impl Index {
    /// Adds the voxels of some levels, of which the first is `first_level`.
    pub(crate) fn count(&mut self, first_level: u8, counts: &[LevelCount]) {
        for (level, count) in (usize::from(first_level)..).zip(counts) {
            if level >= self.levels.len() {
                self.levels.resize(level + 1, LevelCount::default());
            }
            self.levels[level].voxels += count.voxels;
            self.levels[level].nodes += count.nodes;
        }
    }

    /// Number of voxels on all levels.
    #[must_use]
    pub fn voxels(&self) -> u64 {
        self.levels.iter().fold(0, |sum, level| sum.saturating_add(level.voxels))
    }

    /// The raw bytes, and the head for a section of them.
    pub(crate) fn encode(&self) -> Result<(Head, Vec<u8>), FormatError> {
        let subtrees = u32::try_from(self.subtrees.len())
            .map_err(|_| FormatError::TooManySubtrees { count: self.subtrees.len() as u64 })?;
        let mut raw = Vec::with_capacity(COUNT_BYTES * self.levels.len() + ENTRY_BYTES * self.subtrees.len());
        for level in &self.levels {
            raw.extend(level.voxels.to_le_bytes());
            raw.extend(level.nodes.to_le_bytes());
        }
        self.subtrees.iter().for_each(|entry| raw.extend(entry.to_bytes()));
        Ok((Head::new(Kind::Index, subtrees), raw))
    }

    /// The index from its section.
    pub(crate) fn decode(
        section: &Section<'_>,
        offset: u64,
        depth: u8,
        limits: Limits,
    ) -> Result<Self, FormatError> {
        let levels = usize::from(depth) + 1;
        let length = (COUNT_BYTES * levels) as u64 + ENTRY_BYTES as u64 * u64::from(section.head.items);
        let raw = section.raw(offset, length, limits.max_section_bytes)?;
        let (counts, entries) = raw.split_at(COUNT_BYTES * levels);
        let count = |bytes: &[u8; COUNT_BYTES]| LevelCount {
            voxels: LittleEndian::read_u64(&bytes[..8]),
            nodes: LittleEndian::read_u64(&bytes[8..]),
        };
        Ok(Self {
            levels: counts.as_chunks().0.iter().map(count).collect(),
            subtrees: entries.as_chunks().0.iter().map(IndexEntry::from_bytes).collect(),
        })
    }
}
