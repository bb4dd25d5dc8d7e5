//! Levels of voxels as bytes.
//!
//! ```text
//!  table    2t  palette indices, ascending       only if the head of the section says t > 0
//!  then for each level from the root's on, with n voxels:
//!  masks    n   child mask of each voxel         not on the finest level
//!  indices  0   if t = 1: all voxels have the table's only index
//!           n   if t > 1: entry of the table, counted from 0, less that of the parent, modulo 256
//!           2n  if t = 0: n low bytes, n high bytes of d ≥ 0 ? 2d : −2d − 1, where d is the palette index less that of
//!               the parent, modulo 65,536, from −32,768 to 32,767
//!  normals  2n  n first bytes, n second bytes of the normal less that of the parent, each modulo 256
//! ```
//!
//! The voxels of a level stand in Morton order, so the children of a level's first voxel begin the next level. The root
//! has no parent; the differences there are from 0.

use super::Levels;
use super::prediction::{expand, fold_sign};

/// Longer tables would need longer entries.
pub(crate) const LARGEST_TABLE: usize = 256;

/// The bytes of some levels, and the length of their table.
pub(crate) fn encode(levels: &Levels) -> (Vec<u8>, u16) {
    let indices = levels.palette_indices();
    let table = distinct(indices).unwrap_or_default();
    let mut raw = Vec::with_capacity(2 * table.len() + levels.masks().len() + 4 * indices.len());
    raw.extend(table.iter().flat_map(|index| index.to_le_bytes()));
    let entries = entries(&table, indices);

    let mut parents = 0..0;
    let mut above: &[u8] = &[];
    let mut expanded_normals = Vec::new();
    let mut expanded_indices = Vec::new();
    let mut expanded_entries = Vec::new();
    for number in 0..levels.level_count() {
        let level = levels.first_level() + number;
        let range = levels.range(level);
        let voxels = levels.level(level);
        raw.extend_from_slice(voxels.masks);
        match table.len() {
            1 => {}
            0 => {
                expand(&indices[parents.clone()], above, range.len(), &mut expanded_indices);
                let folded =
                    |(index, parent): (&u16, &u16)| fold_sign(index.wrapping_sub(*parent)).to_le_bytes();
                let differences = voxels.palette_indices.iter().zip(&expanded_indices).map(folded);
                extend_apart(&mut raw, differences);
            }
            _ => {
                expand(&entries[parents.clone()], above, range.len(), &mut expanded_entries);
                let pairs = entries[range.clone()].iter().zip(&expanded_entries);
                raw.extend(pairs.map(|(entry, parent)| entry.wrapping_sub(*parent)));
            }
        }
        expand(&levels.normals()[parents.clone()], above, range.len(), &mut expanded_normals);
        let pairs = voxels.normals.iter().zip(&expanded_normals);
        extend_apart(&mut raw, pairs.map(|(normal, parent)| add(*normal, parent.map(u8::wrapping_neg))));
        (parents, above) = (range, voxels.masks);
    }
    // At most 256.
    (raw, table.len() as u16)
}

/// The palette indices in use, ascending; `None` if they are too many for a table.
fn distinct(indices: &[u16]) -> Option<Vec<u16>> {
    let (lowest, highest) = (indices.iter().copied().min()?, indices.iter().copied().max()?);
    let mut is_used = vec![false; usize::from(highest - lowest) + 1];
    indices.iter().for_each(|index| is_used[usize::from(index - lowest)] = true);
    let used = (lowest..=highest).zip(is_used).filter(|(_, is_used)| *is_used).map(|(index, _)| index);
    let table: Vec<u16> = used.take(LARGEST_TABLE + 1).collect();
    (table.len() <= LARGEST_TABLE).then_some(table)
}

/// The place of each palette index in the table; nothing if there is none, or a single one.
fn entries(table: &[u16], indices: &[u16]) -> Vec<u8> {
    if table.len() < 2 {
        return Vec::new();
    }
    let (lowest, highest) = (table[0], table[table.len() - 1]);
    let mut places = vec![0; usize::from(highest - lowest) + 1];
    for (place, index) in (0..=u8::MAX).zip(table) {
        places[usize::from(index - lowest)] = place;
    }
    indices.iter().map(|index| places[usize::from(index - lowest)]).collect()
}

/// Appends all first bytes, then all second bytes.
fn extend_apart(raw: &mut Vec<u8>, pairs: impl Iterator<Item = [u8; 2]> + Clone) {
    raw.extend(pairs.clone().map(|[first, _]| first));
    raw.extend(pairs.map(|[_, second]| second));
}

pub(crate) fn add(a: [u8; 2], b: [u8; 2]) -> [u8; 2] {
    [a[0].wrapping_add(b[0]), a[1].wrapping_add(b[1])]
}
