//! Inside cells into an octree that has the surface.

use crate::lod::Lod;
use crate::structure::{Structure, filled_bytes};
use crate::voxel::Voxel;

/// Adds cells of the finest level, and the largest cubes that consist of nothing else as leaves of higher levels. All look
/// like `voxel`. Levels of detail remain what they are: what is inside does not show.
///
/// `inside` has a bit for each cell of the finest level in Morton order, none of which is filled so far. `has_surface`
/// tells whether there is any voxel yet. `leaf` is called for each leaf of the finest level, in Morton order: with its
/// code, and its number before or `None` if it is new.
pub(crate) fn insert(
    structure: &mut Structure,
    lod: &mut Lod,
    has_surface: bool,
    inside: &[u64],
    voxel: Voxel,
    leaf: impl FnMut(usize, Option<usize>),
) {
    let depth = structure.levels.len();
    let mut insertion = Insertion {
        old: std::mem::take(structure),
        old_lod: std::mem::take(lod),
        pyramid: Pyramid::new(inside, depth),
        new: Structure { levels: vec![Vec::new(); depth] },
        new_lod: Lod { levels: vec![Vec::new(); depth] },
        next: vec![0; depth + 1],
        voxel,
        leaf,
    };
    insertion.visit(0, 0, has_surface);
    (*structure, *lod) = (insertion.new, insertion.new_lod);
}

/// For each level, from the root's to the finest, whether a cell is inside in part, or wholly.
struct Pyramid {
    any: Vec<Vec<u64>>,
    all: Vec<Vec<u64>>,
}

impl Pyramid {
    fn new(inside: &[u64], depth: usize) -> Self {
        let mut any = vec![inside.to_vec()];
        let mut outside = vec![complement(inside)];
        for _ in 0..depth {
            for levels in [&mut any, &mut outside] {
                let coarse = coarser(&levels[levels.len() - 1]);
                levels.push(coarse);
            }
        }
        any.reverse();
        let all = outside.iter().rev().map(|bits| complement(bits)).collect();
        Self { any, all }
    }
}

fn complement(bits: &[u64]) -> Vec<u64> {
    bits.iter().map(|word| !word).collect()
}

/// A bit for each eight bits: whether one of them is set.
fn coarser(bits: &[u64]) -> Vec<u64> {
    bits.chunks(8)
        .map(|words| {
            words
                .iter()
                .enumerate()
                .fold(0, |bits, (k, &word)| bits | u64::from(filled_bytes(word)) << (8 * k))
        })
        .collect()
}

fn is_set(bits: &[u64], index: usize) -> bool {
    bits[index / 64] >> (index % 64) & 1 == 1
}

struct Insertion<F> {
    old: Structure,
    old_lod: Lod,
    pyramid: Pyramid,
    new: Structure,
    new_lod: Lod,
    /// The next voxel of each level of the old structure.
    next: Vec<usize>,
    voxel: Voxel,
    leaf: F,
}

impl<F: FnMut(usize, Option<usize>)> Insertion<F> {
    /// Adds a cell that is filled, and what is in it. `was_filled` tells whether it is in the old structure.
    fn visit(&mut self, level: usize, code: usize, was_filled: bool) {
        let old = was_filled.then(|| {
            self.next[level] += 1;
            self.next[level] - 1
        });
        if level == self.new.levels.len() {
            return (self.leaf)(code, old);
        }
        let voxel = old.map_or(self.voxel, |old| self.old_lod.levels[level][old]);
        self.new_lod.levels[level].push(voxel);
        if !was_filled && is_set(&self.pyramid.all[level], code) {
            self.new.levels[level].push(0);
            return;
        }
        let old_mask = old.map_or(0, |old| self.old.levels[level][old]);
        let inside = (self.pyramid.any[level + 1][code / 8] >> (code % 8 * 8)) as u8;
        self.new.levels[level].push(old_mask | inside);
        for octant in 0..8 {
            if (old_mask | inside) >> octant & 1 == 1 {
                self.visit(level + 1, code << 3 | octant, old_mask >> octant & 1 == 1);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn voxel(palette_index: u16) -> Voxel {
        Voxel { palette_index, normal: [0; 2] }
    }

    proptest! {
        #[test]
        fn all_cells_are_there_and_nothing_else(
            depth in 0u32..4,
            kinds in prop::collection::vec(0u8..3, 1..16),
            shift in 0u32..7,
        ) {
            // Runs of cells that are empty, surface or inside.
            let cells = 1usize << (3 * depth);
            let kind = |cell: usize| kinds[(cell >> shift) % kinds.len()];
            let bits = |wanted: u8| {
                let mut bits = vec![0u64; cells.div_ceil(64)];
                (0..cells).filter(|&cell| kind(cell) == wanted).for_each(|cell| bits[cell / 64] |= 1 << (cell % 64));
                bits
            };
            let [surface, inside] = [bits(1), bits(2)];
            prop_assume!((0..cells).any(|cell| kind(cell) != 0));
            let has_surface = surface.iter().any(|word| *word != 0);
            let mut structure = if has_surface {
                Structure::from_occupancy(&surface, depth)
            } else {
                Structure { levels: vec![Vec::new(); depth as usize] }
            };
            let mut lod = Lod { levels: structure.levels.iter().map(|level| vec![voxel(1); level.len()]).collect() };
            let mut leaves = Vec::new();
            insert(&mut structure, &mut lod, has_surface, &inside, voxel(2), |code, leaf| leaves.push((code, leaf)));

            // Walk down, and write the kind of each leaf into the cells that it covers.
            let mut found = vec![0u8; cells];
            let mut next = vec![0; depth as usize + 1];
            let mut waiting = vec![(0usize, 0usize)];
            while let Some((level, code)) = waiting.pop() {
                let index = next[level];
                next[level] += 1;
                if level == depth as usize {
                    prop_assert_eq!(leaves[index].0, code);
                    found[code] = if leaves[index].1.is_some() { 1 } else { 2 };
                    continue;
                }
                let below = 3 * (depth as usize - level);
                match structure.levels[level][index] {
                    0 => {
                        prop_assert_eq!(lod.levels[level][index], voxel(2));
                        found[code << below..(code + 1) << below].fill(2);
                    }
                    mask => waiting.extend(
                        (0..8).rev().filter(|octant| mask >> octant & 1 == 1).map(|octant| (level + 1, code << 3 | octant)),
                    ),
                }
            }
            prop_assert_eq!(found, (0..cells).map(kind).collect::<Vec<_>>());
            prop_assert!(leaves.iter().filter_map(|leaf| leaf.1).eq(0..leaves.iter().filter_map(|leaf| leaf.1).count()));
        }
    }
}
