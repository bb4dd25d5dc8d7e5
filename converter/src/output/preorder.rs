//! Voxels in the order of the file.

use crate::lod::Lod;
use crate::structure::Structure;
use crate::voxel::Voxel;

/// Bytes of a voxel in the file.
const VOXEL_BYTES: usize = 4;

/// The nodes of an octree in preorder, as bytes of the file: a node, then its eight children, each with its subtree; empty
/// ones too.
///
/// `finest(mask, k, bytes)` appends eight children of the finest level: those in the mask are the k-th and the following
/// ones in Morton order. Within every level, preorder comes across the voxels in Morton order, so each level is read from
/// its beginning to its end. The structure must have a level.
pub(crate) fn encode(
    structure: &Structure,
    lod: &Lod,
    finest: impl FnMut(u8, usize, &mut Vec<u8>),
) -> Vec<u8> {
    let nodes: usize = structure.levels.iter().map(Vec::len).sum();
    let mut encoder = Encoder {
        structure,
        lod,
        finest,
        next: vec![0; structure.levels.len() + 1],
        bytes: Vec::with_capacity(VOXEL_BYTES * (1 + 8 * nodes)),
    };
    encoder.voxel(0);
    encoder.bytes
}

struct Encoder<'a, F> {
    structure: &'a Structure,
    lod: &'a Lod,
    finest: F,
    /// The next voxel of each level.
    next: Vec<usize>,
    bytes: Vec<u8>,
}

impl<F: FnMut(u8, usize, &mut Vec<u8>)> Encoder<'_, F> {
    /// Appends the next voxel of a level, with its subtree.
    fn voxel(&mut self, level: usize) {
        let index = self.next[level];
        self.next[level] += 1;
        let mask = self.structure.levels[level][index];
        self.bytes.extend_from_slice(&self.lod.levels[level][index].to_word(mask != 0));
        if mask == 0 {
            return;
        }
        if level + 1 == self.structure.levels.len() {
            (self.finest)(mask, self.next[level + 1], &mut self.bytes);
            self.next[level + 1] += mask.count_ones() as usize;
            return;
        }
        for octant in 0..8 {
            if mask >> octant & 1 == 1 {
                self.voxel(level + 1);
            } else {
                self.bytes.extend_from_slice(&Voxel::EMPTY.to_word(false));
            }
        }
    }
}

/// Appends eight voxels without children: those in the mask are `leaf(first)` and the following ones.
#[inline]
pub(crate) fn append_leaves(mask: u8, first: usize, leaf: impl Fn(usize) -> Voxel, bytes: &mut Vec<u8>) {
    let mut children = [Voxel::EMPTY.to_word(false); 8];
    let (mut rest, mut index) = (mask, first);
    while rest != 0 {
        children[rest.trailing_zeros() as usize] = leaf(index).to_word(false);
        index += 1;
        rest &= rest - 1;
    }
    bytes.extend_from_slice(children.as_flattened());
}
