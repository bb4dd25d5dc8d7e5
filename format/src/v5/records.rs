//! An archive as a stream of records in preorder, like a file of version 4.

use super::{Archive, Levels, Source, Subtree};
use crate::normal_code::Recoding;
use crate::{FormatError, Limits, NormalCode, Record, SphericalNormal, Voxel};

/// The records of an archive in preorder.
///
/// They are those that a file of version 4 would have: empty children are among them, and normals are in the spherical
/// code, to which those of another code are converted. Palette indices may be larger than version 4 allows. A
/// subtree is read when its turn comes. The iterator ends after the first error.
#[derive(Debug)]
pub struct Records<'a, S> {
    archive: &'a Archive<S>,
    preorder: Preorder,
}

impl<'a, S: Source> Records<'a, S> {
    pub(crate) fn new(archive: &'a Archive<S>, depth: u8) -> Self {
        Self { archive, preorder: Preorder::new(archive, depth, NormalCode::Spherical) }
    }
}

impl<S: Source> Iterator for Records<'_, S> {
    type Item = Result<Record, FormatError>;

    #[inline]
    fn next(&mut self) -> Option<Self::Item> {
        self.preorder.next_record(self.archive)
    }
}

impl<S: Source> std::iter::FusedIterator for Records<'_, S> {}

/// How far the records of an archive have come, in whose voxels the normals are in a code of the caller's choice.
#[derive(Debug)]
pub(crate) struct Preorder {
    recoding: Recoding,
    /// The last level that is shown.
    depth: u8,
    /// The next voxel of each level in the lists of the top, or of the subtree.
    next: [usize; Limits::MAX_DEPTH as usize + 1],
    /// The subtree that is being read.
    subtree: Option<Subtree>,
    /// Number of the subtree that comes next.
    next_subtree: usize,
    /// For each level down to that of the record before, which children are filled, and the octant of the next one.
    open: Vec<(u8, u8)>,
    has_begun: bool,
    /// Why no record comes any more, until that has been said.
    error: Option<FormatError>,
    has_ended: bool,
}

impl Preorder {
    pub fn new<S: Source>(archive: &Archive<S>, depth: u8, normal_code: NormalCode) -> Self {
        let mut next = [0; Limits::MAX_DEPTH as usize + 1];
        for (level, next) in (0..archive.header().cut_level).zip(&mut next) {
            *next = archive.top().range(level).start;
        }
        Self {
            recoding: Recoding::new(archive.header().normal_code, normal_code),
            depth,
            next,
            subtree: None,
            next_subtree: 0,
            open: Vec::new(),
            has_begun: false,
            error: None,
            has_ended: false,
        }
    }

    /// The level and octant of the next record, and whether it is filled.
    #[inline]
    fn advance<S: Source>(&mut self, archive: &Archive<S>) -> Option<(u8, u8, bool)> {
        if !self.has_begun {
            self.has_begun = true;
            return Some((0, 0, archive.top().voxel_count() > 0 || archive.subtree_count() > 0));
        }
        // At most 23 levels are open.
        while let (level, Some((mask, next_octant))) = (self.open.len() as u8, self.open.last_mut()) {
            if *next_octant < 8 {
                let octant = *next_octant;
                *next_octant += 1;
                return Some((level, octant, *mask >> octant & 1 == 1));
            }
            self.open.pop();
        }
        None
    }

    /// Begins the next subtree. If it cannot be read, no record comes any more.
    #[cold]
    fn enter_subtree<S: Source>(&mut self, archive: &Archive<S>) {
        match archive.subtree_down_to(self.next_subtree, self.depth) {
            Ok(subtree) => {
                self.next_subtree += 1;
                for level in archive.header().cut_level..=archive.header().depth {
                    self.next[usize::from(level)] = subtree.levels.range(level).start;
                }
                self.subtree = Some(subtree);
            }
            Err(error) => {
                self.error = Some(error);
                self.has_ended = true;
            }
        }
    }

    /// The next record, or `None` with the reason in `self.error`. (An `Option<Record>` stays in a register, see
    /// [`Reader`](crate::Reader).)
    #[inline]
    fn next_if_readable<S: Source>(&mut self, archive: &Archive<S>) -> Option<Record> {
        let (level, octant, is_filled) = self.advance(archive)?;
        if !is_filled {
            return Some(Record { level, octant, voxel: Voxel::EMPTY, has_children: false });
        }
        let cut_level = archive.header().cut_level;
        if level == cut_level {
            self.enter_subtree(archive);
            if self.has_ended {
                return None;
            }
        }
        let levels: &Levels = match &self.subtree {
            Some(subtree) if level >= cut_level => &subtree.levels,
            _ => archive.top(),
        };
        let place = &mut self.next[usize::from(level)];
        let voxel = Voxel {
            palette_index: levels.palette_indices()[*place],
            normal: SphericalNormal::from_bytes(self.recoding.apply(levels.normals()[*place])),
        };
        let mask = if level < self.depth { levels.masks().get(*place).copied().unwrap_or(0) } else { 0 };
        *place += 1;
        if mask != 0 {
            self.open.push((mask, 0));
        }
        Some(Record { level, octant, voxel, has_children: mask != 0 })
    }

    /// The next record. The archive must be the same every time.
    #[inline]
    pub fn next_record<S: Source>(&mut self, archive: &Archive<S>) -> Option<Result<Record, FormatError>> {
        if self.has_ended {
            return None;
        }
        match self.next_if_readable(archive) {
            Some(record) => Some(Ok(record)),
            None => self.error.take().map(Err),
        }
    }
}
