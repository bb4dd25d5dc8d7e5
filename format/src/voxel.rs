//! A voxel, and its place in the file.

use crate::SphericalNormal;

/// Length of a voxel in the file, in bytes.
pub(crate) const VOXEL_BYTES: u64 = 4;

/// What a cell of the octree looks like: its colour and the direction its surface faces.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Voxel {
    /// Index into the [`Palette`](crate::Palette), counted from 1; 0 if the cell is empty.
    pub palette_index: u16,
    /// The surface's normal; without meaning if the cell is empty.
    pub normal: SphericalNormal,
}

impl Voxel {
    /// A cell without anything in it.
    pub const EMPTY: Self = Self { palette_index: 0, normal: SphericalNormal { theta: 0, phi: 0 } };

    /// Whether there is nothing in the cell.
    #[must_use]
    #[inline]
    pub const fn is_empty(self) -> bool {
        self.palette_index == 0
    }

    /// The voxel and its children flag as four bytes of the file.
    #[must_use]
    #[inline]
    pub fn to_word(self, has_children: bool) -> [u8; 4] {
        let [low, high] = (self.palette_index << 1 | u16::from(has_children)).to_le_bytes();
        let [theta, phi] = self.normal.to_bytes();
        [low, high, theta, phi]
    }

    /// The voxel and its children flag from four bytes of the file.
    #[must_use]
    #[inline]
    pub fn from_word([low, high, theta, phi]: [u8; 4]) -> (Self, bool) {
        let flagged_index = u16::from_le_bytes([low, high]);
        let voxel =
            Self { palette_index: flagged_index >> 1, normal: SphericalNormal::from_bytes([theta, phi]) };
        (voxel, flagged_index & 1 == 1)
    }
}

/// The children flag alone.
#[inline]
pub(crate) fn has_children(word: [u8; 4]) -> bool {
    word[0] & 1 == 1
}

/// A voxel and where it stands in the octree.
///
/// Records come in preorder: a voxel, then its eight children by ascending octant, each with its whole subtree.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Record {
    /// Levels below the root, which has 0.
    pub level: u8,
    /// Which eighth of its parent the voxel is: 1 is set in the upper half of x, 2 of y, 4 of z. 0 for the root.
    pub octant: u8,
    /// What is there.
    pub voxel: Voxel,
    /// Whether the next eight records of the level below are the voxel's children.
    pub has_children: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_word_is_index_flag_theta_phi() {
        let voxel = Voxel { palette_index: 0x4321, normal: SphericalNormal { theta: 0xA1, phi: -2 } };
        assert_eq!(voxel.to_word(true), [0x43, 0x86, 0xA1, 0xFE]);
        assert_eq!(voxel.to_word(false), [0x42, 0x86, 0xA1, 0xFE]);
        assert_eq!(Voxel::EMPTY.to_word(false), [0; 4]);
    }

    #[test]
    fn every_flagged_index_comes_back() {
        for flagged_index in 0..=u16::MAX {
            let [low, high] = flagged_index.to_le_bytes();
            let word = [low, high, 200, 100];
            let (voxel, has_children) = Voxel::from_word(word);
            assert_eq!(voxel.to_word(has_children), word);
            assert_eq!(super::has_children(word), has_children);
            assert_eq!(voxel.is_empty(), flagged_index < 2);
        }
    }
}
