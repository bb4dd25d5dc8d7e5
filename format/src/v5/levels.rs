//! The voxels of some consecutive levels below one cell, checked.

use crate::Limits;
use std::ops::Range;

/// What the voxels of some levels are made of, as parallel lists.
///
/// The voxels stand level by level from the root downwards, and within a level in Morton order. (Preorder meets the
/// voxels of each level in the same order.) Only filled cells have voxels.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Planes {
    /// For each voxel above the finest level, which of its children are filled: bit k for octant k. 0 for a voxel
    /// without children, which is the same throughout.
    pub masks: Vec<u8>,
    /// For each voxel its material, counted from 1.
    pub palette_indices: Vec<u16>,
    /// For each voxel its normal in the code of the file.
    pub normals: Vec<[u8; 2]>,
}

/// The voxels of some consecutive levels below one cell.
///
/// A value of this type is one complete tree: each voxel but the root is named by exactly one bit of one mask, every
/// palette index is at least 1, and the parallel lists fit together. So an algorithm that counts the bits of the masks
/// cannot leave the lists.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Levels {
    first_level: u8,
    bottom: Bottom,
    /// Where each level begins in the lists of voxels, and their length at the end.
    starts: Vec<usize>,
    planes: Planes,
    largest_index: u16,
}

/// What is below the last of some levels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Bottom {
    /// Nothing: the last level has no masks.
    Finest,
    /// Other levels, kept elsewhere: the masks of the last level name their roots.
    Cut,
}

/// One of the [`Levels`]: its voxels in Morton order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Level<'a> {
    /// The child mask of each voxel; empty on the finest level.
    pub masks: &'a [u8],
    /// The material of each voxel, counted from 1.
    pub palette_indices: &'a [u16],
    /// The normal of each voxel in the code of the file.
    pub normals: &'a [[u8; 2]],
}

/// Why some lists are not the levels of a tree.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum LevelDefect {
    /// There are no such levels in an octree.
    #[error("an octree has levels 0 to 23, not levels {first} to {last}")]
    Range {
        /// The first level.
        first: u8,
        /// The last level.
        last: u8,
    },
    /// A subtree is without voxels; it should not be there.
    #[error("the subtree has no voxels")]
    NoVoxels,
    /// The masks name more or fewer voxels than there are.
    #[error("the child masks down to level {level} name {named} voxels, of which there are {found}")]
    VoxelCount {
        /// The level at which this shows.
        level: u8,
        /// Voxels on this level and above according to the masks.
        named: u64,
        /// Voxels in the lists.
        found: u64,
    },
    /// There are more or fewer masks than voxels above the finest level.
    #[error("{voxels} voxels should have child masks, but there are {found} masks")]
    MaskCount {
        /// Voxels that need a mask.
        voxels: u64,
        /// Number of masks.
        found: u64,
    },
    /// The lists of voxels are not equally long.
    #[error("there are {indices} palette indices but {normals} normals")]
    UnequalPlanes {
        /// Number of palette indices.
        indices: u64,
        /// Number of normals.
        normals: u64,
    },
    /// A palette index is 0.
    #[error("a voxel has palette index 0 or none of its table, as if it were empty")]
    EmptyVoxel,
    /// A palette index is beyond the palette.
    #[error("a voxel has palette index {index}, but the palette has {materials} materials")]
    PaletteIndex {
        /// The palette index, which counts from 1.
        index: u16,
        /// Number of materials.
        materials: u16,
    },
}

impl Levels {
    /// The top of an octree that is cut at `cut_level`: the levels above it, from the root's.
    ///
    /// The masks of the last level name the cells at the cut that have subtrees. An octree that is cut at its root, or
    /// is empty, has a top without voxels.
    ///
    /// # Errors
    /// A [`LevelDefect`] if the planes are not those of a tree.
    pub fn top(cut_level: u8, planes: Planes) -> Result<Self, LevelDefect> {
        if cut_level > Limits::MAX_DEPTH {
            return Err(LevelDefect::Range { first: 0, last: cut_level - 1 });
        }
        Self::new(0, cut_level, Bottom::Cut, planes)
    }

    /// A subtree with its root on level `cut_level` in an octree of `depth` levels below its root.
    ///
    /// # Errors
    /// A [`LevelDefect`] if the planes are not those of a tree, or there is no voxel.
    pub fn subtree(cut_level: u8, depth: u8, planes: Planes) -> Result<Self, LevelDefect> {
        if cut_level > depth || depth > Limits::MAX_DEPTH {
            return Err(LevelDefect::Range { first: cut_level, last: depth });
        }
        if planes.palette_indices.is_empty() {
            return Err(LevelDefect::NoVoxels);
        }
        Self::new(cut_level, depth - cut_level + 1, Bottom::Finest, planes)
    }

    /// A tree of an octree of `depth` levels: its upper levels, from `first_level` on, and what is below them: a subtree
    /// for each voxel that the masks of the last upper level name, in Morton order.
    ///
    /// # Errors
    /// A [`LevelDefect`] if these do not fit together, or there is no voxel.
    pub fn join(first_level: u8, depth: u8, upper: Planes, subtrees: &[Self]) -> Result<Self, LevelDefect> {
        let mut planes = upper;
        let from = subtrees.first().map_or(depth, Self::first_level);
        for level in from..=depth {
            for subtree in subtrees {
                let voxels = subtree.level(level);
                planes.masks.extend_from_slice(voxels.masks);
                planes.palette_indices.extend_from_slice(voxels.palette_indices);
                planes.normals.extend_from_slice(voxels.normals);
            }
        }
        Self::subtree(first_level, depth, planes)
    }

    /// `level_count` levels from `first_level` on, which an octree can have.
    pub(crate) fn new(
        first_level: u8,
        level_count: u8,
        bottom: Bottom,
        planes: Planes,
    ) -> Result<Self, LevelDefect> {
        let voxels = planes.palette_indices.len();
        if planes.normals.len() != voxels {
            let [indices, normals] = [voxels, planes.normals.len()].map(|count| count as u64);
            return Err(LevelDefect::UnequalPlanes { indices, normals });
        }
        let mut starts = vec![0];
        let (mut end, mut next) = (0, voxels.min(1));
        let mut masked = 0;
        for (index, level) in (0..level_count).zip(first_level..) {
            let range = end..end + next;
            if range.end > voxels {
                let [named, found] = [range.end, voxels].map(|count| count as u64);
                return Err(LevelDefect::VoxelCount { level, named, found });
            }
            end = range.end;
            starts.push(end);
            if bottom == Bottom::Cut || index + 1 < level_count {
                let Some(masks) = planes.masks.get(range) else {
                    let [voxels, found] = [end, planes.masks.len()].map(|count| count as u64);
                    return Err(LevelDefect::MaskCount { voxels, found });
                };
                masked = end;
                next = count_children(masks);
            }
        }
        if end != voxels {
            let level = (first_level + level_count).saturating_sub(1);
            return Err(LevelDefect::VoxelCount { level, named: end as u64, found: voxels as u64 });
        }
        if masked != planes.masks.len() {
            return Err(LevelDefect::MaskCount { voxels: masked as u64, found: planes.masks.len() as u64 });
        }
        let extremes =
            |(smallest, largest): (u16, u16), index: &u16| (smallest.min(*index), largest.max(*index));
        let (smallest_index, largest_index) = planes.palette_indices.iter().fold((u16::MAX, 0), extremes);
        if smallest_index == 0 {
            return Err(LevelDefect::EmptyVoxel);
        }
        Ok(Self { first_level, bottom, starts, planes, largest_index })
    }

    /// The level of the root, counted from that of the whole octree, which is 0.
    #[must_use]
    pub fn first_level(&self) -> u8 {
        self.first_level
    }

    /// Number of levels. The lower ones may be without voxels.
    #[must_use]
    pub fn level_count(&self) -> u8 {
        // At most 24.
        (self.starts.len() - 1) as u8
    }

    /// The voxels of a level, which is counted from the root of the whole octree; none if it is not one of these.
    #[must_use]
    pub fn level(&self, level: u8) -> Level<'_> {
        let range = self.range(level);
        let masks = self.planes.masks.get(range.clone()).unwrap_or_default();
        Level {
            masks,
            palette_indices: &self.planes.palette_indices[range.clone()],
            normals: &self.planes.normals[range],
        }
    }

    /// The places of a level's voxels in the lists of all voxels.
    #[must_use]
    pub fn range(&self, level: u8) -> Range<usize> {
        let index = usize::from(level).checked_sub(usize::from(self.first_level));
        match index.and_then(|index| self.starts.get(index..index + 2)) {
            Some(&[start, end]) => start..end,
            _ => 0..0,
        }
    }

    /// Number of voxels on all levels.
    #[must_use]
    pub fn voxel_count(&self) -> usize {
        self.planes.palette_indices.len()
    }

    /// The child masks of all voxels that are not on the finest level.
    #[must_use]
    pub fn masks(&self) -> &[u8] {
        &self.planes.masks
    }

    /// The material of each voxel, counted from 1.
    #[must_use]
    pub fn palette_indices(&self) -> &[u16] {
        &self.planes.palette_indices
    }

    /// The normal of each voxel in the code of the file.
    #[must_use]
    pub fn normals(&self) -> &[[u8; 2]] {
        &self.planes.normals
    }

    /// These levels down to `level`, but the root's at least: what they would be in an octree of that depth, with
    /// levels of detail in place of what is below.
    #[must_use]
    pub fn down_to(&self, level: u8) -> Self {
        let wanted = level.saturating_sub(self.first_level).saturating_add(1).min(self.level_count());
        let end = self.first_level + self.level_count();
        // What is below a cut is one level more.
        if level.saturating_add(u8::from(!self.is_top())) >= end || wanted == 0 {
            return self.clone();
        }
        let masked = self.starts[usize::from(wanted) - 1];
        let voxels = self.starts[usize::from(wanted)];
        let palette_indices = self.planes.palette_indices[..voxels].to_vec();
        Self {
            first_level: self.first_level,
            bottom: Bottom::Finest,
            starts: self.starts[..=usize::from(wanted)].to_vec(),
            largest_index: palette_indices.iter().copied().max().unwrap_or(0),
            planes: Planes {
                masks: self.planes.masks[..masked].to_vec(),
                palette_indices,
                normals: self.planes.normals[..voxels].to_vec(),
            },
        }
    }

    /// The lists themselves.
    #[must_use]
    pub fn into_planes(self) -> Planes {
        self.planes
    }

    /// The largest palette index of a voxel; 0 if there is none.
    #[must_use]
    pub fn largest_index(&self) -> u16 {
        self.largest_index
    }

    /// Whether these are the levels above a cut, so that the masks of the last one name subtrees.
    #[must_use]
    pub fn is_top(&self) -> bool {
        self.bottom == Bottom::Cut
    }

    /// The Morton codes of the children of a level's voxels, ascending; those at the cut too. `root` is the Morton code
    /// of the root's cell. None if the level has no masks.
    #[must_use]
    pub fn child_codes(&self, root: u64, level: u8) -> Vec<u64> {
        let mut codes = vec![root];
        for level in self.first_level..=level.max(self.first_level) {
            let masks = self.level(level).masks;
            let octants = |mask: u8| (0..8).filter(move |octant| mask >> octant & 1 == 1);
            codes = codes
                .iter()
                .zip(masks)
                .flat_map(|(code, mask)| octants(*mask).map(move |octant| code << 3 | octant))
                .collect();
        }
        codes
    }
}

/// Number of children that some masks name.
pub(crate) fn count_children(masks: &[u8]) -> usize {
    masks.iter().map(|mask| mask.count_ones() as usize).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn planes(masks: &[u8], voxels: usize) -> Planes {
        let palette_indices = (1..).take(voxels).collect();
        let normals = (0..voxels).map(|voxel| [voxel as u8, 7]).collect();
        Planes { masks: masks.to_vec(), palette_indices, normals }
    }

    #[test]
    fn levels_are_found_in_the_lists() {
        // Two children, of which the second has three.
        let levels = Levels::subtree(4, 6, planes(&[0b1001, 0, 0b111], 6)).unwrap();
        assert_eq!((levels.first_level(), levels.level_count(), levels.voxel_count()), (4, 3, 6));
        assert_eq!([3, 4, 5, 6, 7].map(|level| levels.range(level)), [0..0, 0..1, 1..3, 3..6, 0..0]);
        assert_eq!(levels.level(5).masks, [0, 0b111]);
        assert_eq!(levels.level(6).masks, []);
        assert_eq!(levels.level(6).palette_indices, [4, 5, 6]);
        assert_eq!(levels.level(6).normals, [[3, 7], [4, 7], [5, 7]]);
        assert_eq!(levels.largest_index(), 6);
        assert!(!levels.is_top());
        assert_eq!(levels.clone().into_planes(), planes(&[0b1001, 0, 0b111], 6));
    }

    #[test]
    fn the_masks_of_a_top_name_what_is_below() {
        let top = Levels::top(2, planes(&[0b11, 0b1000_0001, 0b10], 3)).unwrap();
        assert!(top.is_top());
        assert_eq!(top.child_codes(0, 0), [0, 1]);
        assert_eq!(top.child_codes(0, 1), [0, 7, 9]);
        assert_eq!(top.level(1).masks, [0b1000_0001, 0b10]);
        assert_eq!(Levels::top(0, Planes::default()).unwrap().voxel_count(), 0);
        assert_eq!(Levels::top(5, Planes::default()).unwrap().level_count(), 5);
    }

    #[test]
    fn codes_begin_with_that_of_the_root() {
        let levels = Levels::subtree(1, 3, planes(&[0b1000_0000, 0b101], 4)).unwrap();
        assert_eq!(levels.child_codes(0o3, 1), [0o37]);
        assert_eq!(levels.child_codes(0o3, 2), [0o370, 0o372]);
        assert_eq!(levels.child_codes(0o3, 3), []);
    }

    #[test]
    fn subtrees_are_joined_below_their_parents() {
        let subtrees = [
            Levels::subtree(5, 6, planes(&[0b11], 3)).unwrap(),
            Levels::subtree(5, 6, planes(&[0], 1)).unwrap(),
            Levels::subtree(5, 6, planes(&[0b100], 2)).unwrap(),
        ];
        let joined = Levels::join(4, 6, planes(&[0b1000_0011], 1), &subtrees).unwrap();
        assert_eq!(joined.masks(), [0b1000_0011, 0b11, 0, 0b100]);
        assert_eq!(joined.palette_indices(), [1, 1, 1, 1, 2, 3, 2]);
        assert_eq!([4, 5, 6].map(|level| joined.range(level)), [0..1, 1..4, 4..7]);
        assert!(Levels::join(4, 6, planes(&[0b11], 1), &subtrees).is_err());
        let whole = Levels::join(5, 6, Planes::default(), &subtrees[..1]).unwrap();
        assert_eq!(whole, subtrees[0]);
        assert_eq!(Levels::join(4, 6, Planes::default(), &[]), Err(LevelDefect::NoVoxels));
    }

    #[test]
    fn fewer_levels_are_the_octree_of_that_depth() {
        let levels = Levels::subtree(4, 6, planes(&[0b1001, 0, 0b111], 6)).unwrap();
        assert_eq!(levels.down_to(5), Levels::subtree(4, 5, planes(&[0b1001], 3)).unwrap());
        assert_eq!(levels.down_to(4), Levels::subtree(4, 4, planes(&[], 1)).unwrap());
        assert_eq!(levels.down_to(0), levels.down_to(4));
        assert_eq!(levels.down_to(6), levels);
        assert_eq!(levels.down_to(u8::MAX), levels);
        let top = Levels::top(2, planes(&[0b11, 0b1000_0001, 0b10], 3)).unwrap();
        assert_eq!(top.down_to(2), top);
        assert_eq!(top.down_to(1), Levels::subtree(0, 1, planes(&[0b11], 3)).unwrap());
        assert_eq!(top.down_to(0), Levels::subtree(0, 0, planes(&[], 1)).unwrap());
        let none = Levels::top(0, Planes::default()).unwrap();
        assert_eq!(none.down_to(0), none);
    }

    #[test]
    fn lists_that_are_no_tree_are_refused() {
        let defect = |masks: &[u8], voxels| Levels::subtree(4, 6, planes(masks, voxels)).unwrap_err();
        assert_eq!(defect(&[], 0), LevelDefect::NoVoxels);
        assert_eq!(defect(&[0b11, 0, 0], 2), LevelDefect::VoxelCount { level: 5, named: 3, found: 2 });
        assert_eq!(defect(&[0b1, 0b11], 3), LevelDefect::VoxelCount { level: 6, named: 4, found: 3 });
        assert_eq!(defect(&[0b1, 0b11], 5), LevelDefect::VoxelCount { level: 6, named: 4, found: 5 });
        assert_eq!(defect(&[0b1], 2), LevelDefect::MaskCount { voxels: 2, found: 1 });
        assert_eq!(defect(&[0b1, 0, 0], 2), LevelDefect::MaskCount { voxels: 2, found: 3 });
        let unequal = Planes { normals: vec![[0; 2]; 3], ..planes(&[0], 1) };
        assert_eq!(
            Levels::subtree(4, 6, unequal),
            Err(LevelDefect::UnequalPlanes { indices: 1, normals: 3 })
        );
        let empty = Planes { palette_indices: vec![1, 0], ..planes(&[1, 0], 2) };
        assert_eq!(Levels::subtree(4, 6, empty), Err(LevelDefect::EmptyVoxel));
        assert!(Levels::top(0, planes(&[1], 1)).is_err());
    }

    #[test]
    fn levels_beyond_all_bounds_are_refused() {
        for cut_level in [24, 25, u8::MAX] {
            let range = LevelDefect::Range { first: 0, last: cut_level - 1 };
            assert_eq!(Levels::top(cut_level, planes(&[1], 1)), Err(range));
        }
        for (first, last) in [(0, 24), (0, u8::MAX), (u8::MAX, u8::MAX), (3, 2)] {
            assert_eq!(Levels::subtree(first, last, planes(&[], 1)), Err(LevelDefect::Range { first, last }));
        }
        let levels = Levels::subtree(23, 23, planes(&[], 1)).unwrap();
        assert_eq!(levels.level(u8::MAX).normals, <[[u8; 2]; 0]>::default());
    }
}
