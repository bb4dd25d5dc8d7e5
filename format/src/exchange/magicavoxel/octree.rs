//! From filled cells to an octree with levels of detail.

use super::normals::mean;
use crate::v5::Planes;

/// The voxels of all levels above filled cells, and these, in the order of [`Planes`]. The cells are named by their Morton
/// codes, ascending; there is at least one.
///
/// A node has the palette index that most of its children have (of several, that of the child that comes first) and the mean
/// of their normals.
pub(super) fn build(codes: &[u64], palette_indices: Vec<u16>, normals: Vec<[u8; 2]>, depth: u8) -> Planes {
    let mut levels = vec![Level { codes: codes.to_vec(), masks: Vec::new(), palette_indices, normals }];
    for level in 0..usize::from(depth) {
        levels.push(levels[level].parents());
    }
    let mut planes = Planes::default();
    for level in levels.into_iter().rev() {
        planes.masks.extend(level.masks);
        planes.palette_indices.extend(level.palette_indices);
        planes.normals.extend(level.normals);
    }
    planes
}

struct Level {
    codes: Vec<u64>,
    masks: Vec<u8>,
    palette_indices: Vec<u16>,
    normals: Vec<[u8; 2]>,
}

impl Level {
    fn parents(&self) -> Self {
        let mut parents =
            Self { codes: Vec::new(), masks: Vec::new(), palette_indices: Vec::new(), normals: Vec::new() };
        let mut start = 0;
        for children in self.codes.chunk_by(|a, b| a >> 3 == b >> 3) {
            let range = start..start + children.len();
            parents.codes.push(children[0] >> 3);
            parents.masks.push(children.iter().fold(0, |mask, code| mask | 1 << (code & 7)));
            parents.palette_indices.push(majority(&self.palette_indices[range.clone()]));
            parents.normals.push(mean(&self.normals[range]));
            start += children.len();
        }
        parents
    }
}

/// The most frequent of up to eight indices, and of several the one that comes first.
fn majority(indices: &[u16]) -> u16 {
    let votes = |index: &u16| indices.iter().filter(|other| *other == index).count();
    indices.iter().rev().max_by_key(|index| votes(index)).copied().unwrap_or(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::v5::Levels;

    #[test]
    fn most_children_win() {
        assert_eq!(majority(&[3, 4, 4]), 4);
        assert_eq!(majority(&[3, 4, 4, 3]), 3);
    }

    #[test]
    fn levels_stand_one_below_the_other() {
        let planes = build(&[0o03, 0o70, 0o77], vec![5, 6, 6], vec![[1, 2]; 3], 2);
        assert_eq!(planes.masks, [0b1000_0001, 0b1000, 0b1000_0001]);
        assert_eq!(planes.palette_indices, [5, 5, 6, 5, 6, 6]);
        assert_eq!(Levels::subtree(0, 2, planes).unwrap().child_codes(0, 1), [0o03, 0o70, 0o77]);
    }
}
