//! Nodes whose eight children are equal leaves become leaves.

use crate::lod::Lod;
use crate::structure::Structure;
use crate::voxel::Voxel;

/// Deletes the children of every node that has eight equal leaves as children, from the finest level upwards
/// (Bohnen 2009, section 3.1.4). The node, now a leaf with the mask 0, looks like them.
///
/// `leaf(k)` is the k-th voxel of the finest level, and whether it has no children elsewhere. The result tells which
/// voxels of that level remain; `None` if all do.
pub(crate) fn prune(
    structure: &mut Structure,
    lod: &mut Lod,
    leaf: impl Fn(usize) -> (Voxel, bool),
) -> Option<Vec<bool>> {
    let mut kept_leaves = None;
    for level in (0..structure.levels.len()).rev() {
        let (upper, lower) = structure.levels.split_at_mut(level + 1);
        let masks = &mut upper[level];
        let children = lower.first();
        let child = |child: usize| match children {
            Some(masks) => (lod.levels[level + 1][child], masks[child] == 0),
            None => leaf(child),
        };

        let mut first = 0;
        let mut deleted: Vec<usize> = Vec::new();
        for mask in masks.iter_mut() {
            let count = mask.count_ones() as usize;
            if *mask == 0xff
                && child(first).1
                && (first + 1..first + 8).all(|index| child(index) == child(first))
            {
                *mask = 0;
                deleted.push(first);
            }
            first += count;
        }
        if deleted.is_empty() {
            continue;
        }
        let mut kept = vec![true; first];
        for first in deleted {
            kept[first..first + 8].fill(false);
        }
        match lower.first_mut() {
            Some(child_masks) => {
                retain(child_masks, &kept);
                retain(&mut lod.levels[level + 1], &kept);
            }
            None => kept_leaves = Some(kept),
        }
    }
    kept_leaves
}

/// Keeps the items that are marked.
pub(crate) fn retain<T>(items: &mut Vec<T>, kept: &[bool]) {
    let mut kept = kept.iter();
    items.retain(|_| kept.next() == Some(&true));
}
