//! The outline of a file of version 4: where its subtrees are, without looking into them.

use crate::preorder::Cursor;
use crate::voxel::{VOXEL_BYTES, has_children};
use crate::{FormatError, Limits, Palette, header};
use std::io::{ErrorKind, Read};
use std::ops::Range;

/// Bytes that are read at once; the block stays in the second-level cache.
const BLOCK_BYTES: usize = 1 << 18;

/// Records of siblings, which stand side by side if none of them has children.
const SIBLINGS: usize = 8;

/// Where the subtrees of a file of version 4 are, so that several threads can read it.
///
/// To find out takes one pass in constant memory, in which of each record nothing is looked at but whether it has
/// children: several times as fast as [`Reader`](crate::Reader). So the file is known to be complete, but its palette
/// indices are not checked.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Outline {
    /// The colours of the file.
    pub palette: Palette,
    /// Level of the deepest record.
    pub depth: u8,
    /// The level at which the octree is cut.
    pub cut_level: u8,
    /// Number of records, filled and empty.
    pub stored_voxels: u64,
    /// Number of records with children.
    pub nodes: u64,
    /// The records down to the cut in preorder, as they stand in the file. At the cut, those with children have a subtree.
    pub top: Vec<[u8; 4]>,
    /// Where in the file the subtrees are, in bytes and in preorder. A subtree begins with the record of its cell at the
    /// cut, which has children.
    pub subtrees: Vec<Range<u64>>,
}

impl Outline {
    /// Reads `input`, which need not be buffered, from the beginning of the file to its end. The octree is cut at
    /// `cut_level`; if it is not deeper, there are no subtrees and all records are in [`Outline::top`].
    ///
    /// # Errors
    /// A [`FormatError`] if the file is of another kind or version, if it ends too early or too late, if it is deeper than
    /// [`Limits::MAX_DEPTH`], or if it cannot be read.
    pub fn read(mut input: impl Read, cut_level: u8) -> Result<Self, FormatError> {
        let palette = header::read(&mut input)?;
        let mut skimmer = Skimmer::new(header::length(&palette), cut_level);
        let mut block = vec![0; BLOCK_BYTES];
        // Bytes of a record that did not end with the block before.
        let mut carried = 0;
        loop {
            let offset = skimmer.offset() + carried as u64;
            let count = match input.read(&mut block[carried..]) {
                Ok(0) => break,
                Ok(count) => count,
                Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                Err(source) => return Err(FormatError::Read { offset, source }),
            };
            let filled = carried + count;
            let (records, rest) = block[..filled].as_chunks();
            carried = rest.len();
            skimmer.add(records)?;
            if skimmer.cursor.is_complete() && carried > 0 {
                return Err(FormatError::TrailingBytes { offset: skimmer.offset() });
            }
            block.copy_within(filled - carried..filled, 0);
        }
        if !skimmer.cursor.is_complete() {
            let (offset, missing) = (skimmer.offset() + carried as u64, skimmer.cursor.missing());
            return Err(FormatError::TruncatedVoxels { offset, missing });
        }
        Ok(Self {
            palette,
            depth: skimmer.depth,
            cut_level,
            stored_voxels: skimmer.records,
            nodes: skimmer.nodes,
            top: skimmer.top,
            subtrees: skimmer.subtrees,
        })
    }
}

/// Follows the records, looking only at whether they have children.
struct Skimmer {
    cursor: Cursor,
    /// Where the first record is in the file.
    start: u64,
    cut_level: u8,
    depth: u8,
    /// Records so far.
    records: u64,
    nodes: u64,
    top: Vec<[u8; 4]>,
    /// The end of the last is not known before the next record of the top.
    subtrees: Vec<Range<u64>>,
    in_subtree: bool,
}

impl Skimmer {
    fn new(start: u64, cut_level: u8) -> Self {
        Self {
            cursor: Cursor::new(),
            start,
            cut_level,
            depth: 0,
            records: 0,
            nodes: 0,
            top: Vec::new(),
            subtrees: Vec::new(),
            in_subtree: false,
        }
    }

    /// Bytes from the beginning of the file to the next record.
    fn offset(&self) -> u64 {
        self.start + VOXEL_BYTES * self.records
    }

    /// Takes the next records of the file.
    fn add(&mut self, mut records: &[[u8; 4]]) -> Result<(), FormatError> {
        while let Some((record, later)) = records.split_first() {
            if self.cursor.is_complete() {
                return Err(FormatError::TrailingBytes { offset: self.offset() });
            }
            if self.cursor.octant() == 0
                && self.cursor.level() > self.cut_level
                && let Some((siblings, later)) = records.split_first_chunk::<SIBLINGS>()
                && !any_has_children(siblings)
            {
                self.records += SIBLINGS as u64;
                self.cursor.skip_siblings();
                records = later;
            } else {
                self.add_one(*record)?;
                records = later;
            }
            if self.in_subtree && (self.cursor.level() <= self.cut_level || self.cursor.is_complete()) {
                self.end_subtree();
            }
        }
        Ok(())
    }

    #[inline]
    fn add_one(&mut self, record: [u8; 4]) -> Result<(), FormatError> {
        let level = self.cursor.level();
        let has_children = has_children(record);
        if level <= self.cut_level {
            self.top.push(record);
            if has_children && level == self.cut_level {
                let offset = self.offset();
                self.subtrees.push(offset..offset);
                self.in_subtree = true;
            }
        }
        if has_children {
            if level >= Limits::MAX_DEPTH {
                let (offset, max_depth) = (self.offset(), Limits::MAX_DEPTH);
                return Err(FormatError::TooDeep { offset, max_depth });
            }
            self.cursor.descend();
            self.depth = self.depth.max(level + 1);
            self.nodes += 1;
        } else {
            self.cursor.advance();
        }
        self.records += 1;
        Ok(())
    }

    #[cold]
    fn end_subtree(&mut self) {
        let end = self.offset();
        if let Some(last) = self.subtrees.last_mut() {
            last.end = end;
        }
        self.in_subtree = false;
    }
}

/// Whether one of these records has children.
#[inline]
fn any_has_children(records: &[[u8; 4]; SIBLINGS]) -> bool {
    let together = records.iter().fold(0, |bits, record| bits | u32::from_le_bytes(*record));
    has_children(together.to_le_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Reader, SphericalNormal, Voxel, Writer};
    use proptest::prelude::*;

    /// A file whose voxels have children where `branches` says so, as long as it says something.
    fn file(branches: &[bool], max_depth: u8) -> Vec<u8> {
        let palette = Palette::new(vec![[1, 2, 3]]).unwrap();
        let voxel = |place: usize| Voxel {
            palette_index: (place % 2) as u16,
            normal: SphericalNormal { theta: place as u8, phi: 3 },
        };
        let mut writer = Writer::new(Vec::new(), &palette).unwrap();
        let mut cursor = Cursor::new();
        let mut place = 0;
        while !cursor.is_complete() {
            let branches = branches.get(place).copied().unwrap_or(false) && cursor.level() < max_depth;
            if branches {
                writer.node(voxel(place)).unwrap();
                cursor.descend();
            } else {
                writer.leaf(voxel(place)).unwrap();
                cursor.advance();
            }
            place += 1;
        }
        writer.finish().unwrap()
    }

    /// A reader that returns few bytes at a time.
    struct Dripping<'a>(&'a [u8], usize);

    impl Read for Dripping<'_> {
        fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
            let count = self.1.min(buffer.len()).min(self.0.len());
            buffer[..count].copy_from_slice(&self.0[..count]);
            self.0 = &self.0[count..];
            Ok(count)
        }
    }

    proptest! {
        #[test]
        fn agrees_with_the_reader(
            branches in prop::collection::vec(prop::bool::weighted(0.3), 1..300),
            cut_level in 0_u8..6,
            drip in 1_usize..100,
        ) {
            let mut branches = branches;
            branches[0] = true;
            let file = file(&branches, 6);
            let outline = Outline::read(Dripping(&file, drip), cut_level).unwrap();

            let mut reader = Reader::new(&file[..]).unwrap();
            let (mut depth, mut nodes, mut top, mut starts) = (0, 0, Vec::new(), Vec::new());
            let mut offset = reader.offset();
            while let Some(record) = reader.next() {
                let record = record.unwrap();
                depth = depth.max(record.level);
                nodes += u64::from(record.has_children);
                if record.level <= cut_level {
                    let start = offset as usize;
                    top.push(<[u8; 4]>::try_from(&file[start..start + 4]).unwrap());
                    if record.level == cut_level && record.has_children {
                        starts.push(offset);
                    }
                }
                offset = reader.offset();
            }
            prop_assert_eq!((outline.depth, outline.nodes), (depth, nodes));
            prop_assert_eq!(outline.stored_voxels * 4 + header::length(&outline.palette), file.len() as u64);
            prop_assert_eq!(outline.top, top);
            prop_assert_eq!(outline.subtrees.iter().map(|range| range.start).collect::<Vec<_>>(), starts);

            // A subtree is a whole one: on its own it would be a file.
            for range in &outline.subtrees {
                let mut alone = file[..header::length(&outline.palette) as usize].to_vec();
                alone.extend_from_slice(&file[range.start as usize..range.end as usize]);
                prop_assert!(Reader::new(&alone[..]).unwrap().all(|record| record.is_ok()));
            }
        }

        #[test]
        fn damage_is_what_the_reader_says(
            branches in prop::collection::vec(prop::bool::weighted(0.3), 1..100),
            cut in any::<prop::sample::Index>(),
            more in 0_usize..9,
        ) {
            let whole = file(&branches, 6);
            let mut damaged = whole[..cut.index(whole.len())].to_vec();
            let error = |file: &[u8]| Outline::read(file, 2).unwrap_err().to_string();
            let by_reader = |file: &[u8]| match Reader::new(file) {
                Ok(mut reader) => reader.find_map(Result::err).unwrap().to_string(),
                Err(error) => error.to_string(),
            };
            prop_assert_eq!(error(&damaged), by_reader(&damaged));
            damaged = whole;
            damaged.extend(std::iter::repeat_n(7, more + 1));
            prop_assert_eq!(error(&damaged), by_reader(&damaged));
        }
    }

    #[test]
    fn too_deep_is_refused() {
        let mut deep = file(&[false], 6);
        deep.truncate(deep.len() - 4);
        // Records with children, and nothing else.
        deep.extend(std::iter::repeat_n([3, 0, 0, 0], 30).flatten());
        let error = Outline::read(&deep[..], 4).unwrap_err();
        assert!(matches!(error, FormatError::TooDeep { max_depth: 23, .. }), "{error}");
    }
}
