//! Where in the octree the next record of a preorder sequence stands.

use crate::Limits;

/// The place of the next record, kept as one octant for each level: constant memory, no recursion.
#[derive(Debug, Clone)]
pub(crate) struct Cursor {
    /// The octant of the next record and of each of its ancestors, by level.
    octants: [u8; Limits::MAX_DEPTH as usize + 1],
    level: u8,
    complete: bool,
}

impl Cursor {
    /// Before the root.
    pub fn new() -> Self {
        Self { octants: [0; Limits::MAX_DEPTH as usize + 1], level: 0, complete: false }
    }

    /// Whether the octree has all its records, so that there is no next one.
    #[inline]
    pub fn is_complete(&self) -> bool {
        self.complete
    }

    /// Level of the next record.
    #[inline]
    pub fn level(&self) -> u8 {
        self.level
    }

    /// Octant of the next record; 0 for the root.
    #[inline]
    pub fn octant(&self) -> u8 {
        self.octants[usize::from(self.level)]
    }

    /// Steps to the first child. The caller has checked that the level is less than [`Limits::MAX_DEPTH`].
    #[inline]
    pub fn descend(&mut self) {
        self.level += 1;
        self.octants[usize::from(self.level)] = 0;
    }

    /// Steps to the next sibling, or to that of the nearest ancestor which has one.
    #[inline]
    pub fn advance(&mut self) {
        while self.level > 0 {
            let octant = &mut self.octants[usize::from(self.level)];
            *octant += 1;
            if *octant < 8 {
                return;
            }
            self.level -= 1;
        }
        self.complete = true;
    }

    /// Steps over a first child and its seven siblings, none of which has children, to the sibling of their parent, or
    /// to that of the nearest ancestor which has one. The level is not 0.
    #[inline]
    pub fn skip_siblings(&mut self) {
        self.level -= 1;
        self.advance();
    }

    /// The least number of records that complete the octree.
    pub fn missing(&self) -> u64 {
        if self.complete {
            return 0;
        }
        let later_siblings = |octant: &u8| u64::from(7 - octant);
        1 + self.octants[1..=usize::from(self.level)].iter().map(later_siblings).sum::<u64>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lone_root_completes_the_octree() {
        let mut cursor = Cursor::new();
        assert_eq!((cursor.level(), cursor.octant(), cursor.missing()), (0, 0, 1));
        cursor.advance();
        assert!(cursor.is_complete());
        assert_eq!(cursor.missing(), 0);
    }

    #[test]
    fn siblings_follow_a_subtree() {
        let mut cursor = Cursor::new();
        cursor.descend();
        assert_eq!(cursor.missing(), 8);
        cursor.advance();
        cursor.descend();
        // Eight here, and six after the parent, which has octant 1.
        assert_eq!((cursor.level(), cursor.octant(), cursor.missing()), (2, 0, 14));
        let mut skipping = cursor.clone();
        skipping.skip_siblings();
        for _ in 0..8 {
            cursor.advance();
        }
        assert_eq!((skipping.level(), skipping.octant()), (cursor.level(), cursor.octant()));
        assert_eq!((cursor.level(), cursor.octant(), cursor.missing()), (1, 2, 6));
        for _ in 0..6 {
            cursor.advance();
        }
        assert!(cursor.is_complete());
    }

    #[test]
    fn the_last_voxel_of_the_deepest_octree_ends_it() {
        let mut cursor = Cursor::new();
        for _ in 0..Limits::MAX_DEPTH {
            cursor.descend();
            for _ in 0..7 {
                cursor.advance();
            }
        }
        assert_eq!((cursor.level(), cursor.octant(), cursor.missing()), (23, 7, 1));
        cursor.advance();
        assert!(cursor.is_complete());
    }
}
