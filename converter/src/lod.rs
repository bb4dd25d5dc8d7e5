//! Levels of detail: what a node looks like from far away.

use crate::structure::Structure;
use crate::voxel::Voxel;
use octvox_format::NormalCode;

/// The voxels of all nodes, level by level as in [`Structure`], from the root's level down to the one above the finest.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Lod {
    pub levels: Vec<Vec<Voxel>>,
}

/// The normals of some voxels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Normals {
    /// The sum of the unit vectors of all leaf voxels, so that voxels count equally on all levels above.
    pub sum: [f32; 3],
    /// Its direction as the file stores it.
    pub stored: [u8; 2],
}

impl Normals {
    /// That of a leaf.
    #[inline]
    pub(crate) fn of(stored: [u8; 2], code: NormalCode) -> Self {
        Self { sum: code.decode(stored), stored }
    }
}

impl Lod {
    /// Filters the normals of the leaves upwards: each node has the mean of all leaf voxels below it. If they cancel out, it
    /// has the normal of its first child. `leaf(k)` is that of the k-th leaf in Morton order, and `index(level, k)` the
    /// palette index of the k-th node of a level. Normals are stored in `code`.
    ///
    /// Returns the normals of everything too.
    pub(crate) fn new(
        structure: &Structure,
        code: NormalCode,
        leaf: impl Fn(usize) -> Normals,
        index: impl Fn(usize, usize) -> u16,
    ) -> (Self, Normals) {
        let mut levels: Vec<Vec<Voxel>> = structure.levels.iter().map(|_| Vec::new()).collect();
        let mut below: Vec<Normals> = Vec::new();
        for (level, masks) in structure.levels.iter().enumerate().rev() {
            below = if level + 1 == structure.levels.len() {
                filter_level(masks, code, &leaf)
            } else {
                filter_level(masks, code, |child| below[child])
            };
            let voxel = |(node, normals): (usize, &Normals)| Voxel {
                palette_index: index(level, node),
                normal: normals.stored,
            };
            levels[level] = below.iter().enumerate().map(voxel).collect();
        }
        let normals = below.first().copied().unwrap_or_else(|| leaf(0));
        (Self { levels }, normals)
    }

    /// Number of voxels.
    pub(crate) fn voxel_count(&self) -> usize {
        self.levels.iter().map(Vec::len).sum()
    }
}

fn filter_level(masks: &[u8], code: NormalCode, child: impl Fn(usize) -> Normals) -> Vec<Normals> {
    let mut next = 0;
    masks
        .iter()
        .map(|mask| {
            let first = child(next);
            let children = next + 1..next + mask.count_ones() as usize;
            next = children.end;
            let mut sum = first.sum;
            let mut same = true;
            for number in children {
                let other = child(number);
                for (total, component) in sum.iter_mut().zip(other.sum) {
                    *total += component;
                }
                same &= other.stored == first.stored;
            }
            // Unit vectors that cancel out leave what rounding leaves.
            let cancelled = sum.iter().all(|component| component.abs() < 1e-5);
            let stored = if same || cancelled { first.stored } else { code.encode(sum) };
            Normals { sum, stored }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const CODES: [NormalCode; 2] = [NormalCode::Spherical, NormalCode::Octahedral];

    /// The normals of the nodes above leaves with these, which lie side by side from the first octant on.
    fn root(leaves: &[[f32; 3]], code: NormalCode) -> [u8; 2] {
        let codes: Vec<u32> = (0..leaves.len() as u32).collect();
        let structure = Structure::from_codes(&codes, 1);
        let leaf = |k: usize| Normals::of(code.encode(leaves[k]), code);
        let (lod, normals) = Lod::new(&structure, code, leaf, |_, _| 1);
        assert_eq!(lod.levels, [[Voxel { palette_index: 1, normal: normals.stored }]]);
        normals.stored
    }

    #[test]
    fn normals_are_averaged() {
        let (x, y) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
        for code in CODES {
            assert_eq!(root(&[x, y], code), code.encode([1.0, 1.0, 0.0]));
            assert_eq!(root(&[x, y, x], code), code.encode([2.0, 1.0, 0.0]));
            assert_eq!(root(&[x, x], code), code.encode(x));
        }
    }

    #[test]
    fn every_leaf_voxel_counts_the_same() {
        // Eight along x in one child, one along y in the other.
        let codes: Vec<u32> = (0..9).collect();
        let structure = Structure::from_codes(&codes, 2);
        let code = NormalCode::Octahedral;
        let leaf =
            |k: usize| Normals::of(code.encode(if k < 8 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] }), code);
        let (_, normals) = Lod::new(&structure, code, leaf, |_, _| 1);
        assert_eq!(normals.stored, code.encode([8.0, 1.0, 0.0]));
    }

    #[test]
    fn normals_that_cancel_out_leave_the_first() {
        let (up, down) = ([0.0, 1.0, 0.0], [0.0, -1.0, 0.0]);
        for code in CODES {
            assert_eq!(root(&[up, down], code), code.encode(up));
            assert_eq!(root(&[down, up], code), code.encode(down));
        }
    }
}
