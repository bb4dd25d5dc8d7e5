//! Bytes as levels of voxels. What they mean is described in `encoding.rs`.

use super::encoding::{LARGEST_TABLE, add};
use super::levels::{Bottom, count_children};
use super::prediction::{expand, unfold_sign};
use super::raw_bytes::RawBytes;
use super::section::{Head, Kind, Section};
use super::{LevelDefect, Levels, Planes};
use crate::{FormatError, Limits};
use std::ops::Range;

/// The levels of a section, which holds those of `stored` and begins `offset` bytes after the beginning of the file.
/// Only the first `wanted` of them are decoded.
pub(crate) fn decode(
    section: &Section<'_>,
    offset: u64,
    stored: Range<u8>,
    wanted: u8,
    limits: Limits,
) -> Result<Levels, FormatError> {
    let name = section.head.kind.name();
    let damaged = |defect| FormatError::DamagedLevels { offset, section: name, defect };
    let count = stored.end - stored.start;
    // Levels with masks in the section, and in the result.
    let (bottom, masked) = match section.head.kind {
        Kind::Top => (Bottom::Cut, count),
        _ => (Bottom::Finest, count.saturating_sub(1)),
    };
    let is_whole = wanted >= count;
    let (wanted, bottom, kept) =
        if is_whole { (count, bottom, masked) } else { (wanted, Bottom::Finest, wanted.saturating_sub(1)) };

    let mut decoder = LevelDecoder::new(section, offset, is_whole, limits)?;
    for (number, level) in (0..wanted).zip(stored.start..) {
        decoder.check_room(level, number < masked).map_err(damaged)?;
        if number < masked {
            decoder.read_masks(number < kept)?;
        }
        decoder.read_voxels()?;
    }
    if is_whole {
        decoder.check_end(stored.end.saturating_sub(1)).map_err(damaged)?;
    }
    Levels::new(stored.start, wanted, bottom, decoder.planes).map_err(damaged)
}

/// Levels on their way out of a section.
struct LevelDecoder<'a> {
    raw: RawBytes<'a>,
    head: Head,
    /// Palette indices by entry; 0 beyond the end of the table.
    table: [u16; LARGEST_TABLE],
    /// What has been decoded.
    planes: Planes,
    /// The voxels of the level above.
    parents: Range<usize>,
    /// Number of voxels of this level.
    count: usize,
    /// Number of voxels of the next level, if the masks of this one have been read.
    next_count: usize,
    /// The table's entry of each parent, if there is a table.
    entries: Vec<u8>,
    expanded_entries: Vec<u8>,
    expanded_indices: Vec<u16>,
    expanded_normals: Vec<[u8; 2]>,
}

impl<'a> LevelDecoder<'a> {
    fn new(
        section: &'a Section<'_>,
        offset: u64,
        is_whole: bool,
        limits: Limits,
    ) -> Result<Self, FormatError> {
        let head = section.head;
        if usize::from(head.table) > LARGEST_TABLE {
            let (value, limit) = (u64::from(head.table), LARGEST_TABLE as u64);
            let field = "length of a table of palette indices";
            return Err(FormatError::FieldOutOfRange { offset: offset + 24, field, value, limit });
        }
        let index_bytes = match head.table {
            0 => 2,
            1 => 0,
            _ => 1,
        };
        let length =
            2 * u64::from(head.table) + u64::from(head.masks) + u64::from(head.items) * (2 + index_bytes);
        let mut raw = RawBytes::new(section, offset, length, limits)?;
        let mut table = [0; LARGEST_TABLE];
        let indices = raw.take(2 * usize::from(head.table))?.as_chunks().0;
        table.iter_mut().zip(indices).for_each(|(entry, bytes)| *entry = u16::from_le_bytes(*bytes));
        let mut planes = Planes::default();
        if is_whole {
            // The section can have that length, and this is at most twice as much.
            planes.masks.reserve_exact(head.masks as usize);
            planes.palette_indices.reserve_exact(head.items as usize);
            planes.normals.reserve_exact(head.items as usize);
        }
        Ok(Self {
            raw,
            head,
            table,
            planes,
            parents: 0..0,
            count: head.items.min(1) as usize,
            next_count: 0,
            entries: Vec::new(),
            expanded_entries: Vec::new(),
            expanded_indices: Vec::new(),
            expanded_normals: Vec::new(),
        })
    }

    /// Whether the voxels of this level, and their masks, are in the section.
    fn check_room(&self, level: u8, has_masks: bool) -> Result<(), LevelDefect> {
        let end = (self.parents.end + self.count) as u64;
        let [voxels, masks] = [self.head.items, self.head.masks].map(u64::from);
        if end > voxels {
            return Err(LevelDefect::VoxelCount { level, named: end, found: voxels });
        }
        if has_masks && end > masks {
            return Err(LevelDefect::MaskCount { voxels: end, found: masks });
        }
        Ok(())
    }

    /// Whether the section has been used up with this level, the last.
    fn check_end(&self, level: u8) -> Result<(), LevelDefect> {
        let [voxels, masks] = [self.head.items, self.head.masks].map(u64::from);
        let (named, masked) = (self.planes.normals.len() as u64, self.planes.masks.len() as u64);
        if named != voxels {
            return Err(LevelDefect::VoxelCount { level, named, found: voxels });
        }
        if masked != masks {
            return Err(LevelDefect::MaskCount { voxels: masked, found: masks });
        }
        Ok(())
    }

    /// Decodes the masks of this level. Those of the last wanted level are not kept, as they name voxels that are not.
    fn read_masks(&mut self, is_kept: bool) -> Result<(), FormatError> {
        let masks = self.raw.take(self.count)?;
        self.next_count = count_children(masks);
        if is_kept {
            self.planes.masks.extend_from_slice(masks);
        }
        Ok(())
    }

    /// Decodes the indices and normals of this level, and goes to the next.
    fn read_voxels(&mut self) -> Result<(), FormatError> {
        let count = self.count;
        match self.head.table {
            0 => self.read_indices()?,
            1 => self.planes.palette_indices.extend(std::iter::repeat_n(self.table[0], count)),
            _ => self.read_entries()?,
        }

        let above = &self.planes.masks[self.parents.clone()];
        let normals = &mut self.planes.normals;
        expand(&normals[self.parents.clone()], above, count, &mut self.expanded_normals);
        let (first, second) = self.raw.take(2 * count)?.split_at(count);
        let differences = first.iter().zip(second).map(|(first, second)| [*first, *second]);
        normals.extend(
            differences.zip(&self.expanded_normals).map(|(difference, parent)| add(*parent, difference)),
        );

        self.parents = self.parents.end..self.parents.end + count;
        self.count = self.next_count;
        Ok(())
    }

    /// The indices of this level as differences from those of the parents.
    fn read_indices(&mut self) -> Result<(), FormatError> {
        let above = &self.planes.masks[self.parents.clone()];
        let indices = &mut self.planes.palette_indices;
        expand(&indices[self.parents.clone()], above, self.count, &mut self.expanded_indices);
        let (low, high) = self.raw.take(2 * self.count)?.split_at(self.count);
        let differences =
            low.iter().zip(high).map(|(low, high)| unfold_sign(u16::from_le_bytes([*low, *high])));
        indices.extend(
            differences
                .zip(&self.expanded_indices)
                .map(|(difference, parent)| parent.wrapping_add(difference)),
        );
        Ok(())
    }

    /// The indices of this level as differences of entries of the table.
    fn read_entries(&mut self) -> Result<(), FormatError> {
        let above = &self.planes.masks[self.parents.clone()];
        expand(&self.entries, above, self.count, &mut self.expanded_entries);
        let differences = self.raw.take(self.count)?.iter().zip(&self.expanded_entries);
        self.entries.clear();
        self.entries.extend(differences.map(|(difference, parent)| parent.wrapping_add(*difference)));
        let indices = self.entries.iter().map(|entry| self.table[usize::from(*entry)]);
        self.planes.palette_indices.extend(indices);
        Ok(())
    }
}
