//! Levels of detail: what a node looks like from far away.

use crate::structure::Structure;
use crate::voxel::Voxel;
use octvox_format::NormalCode;

/// The voxels of all nodes, level by level as in [`Structure`], from the root's level down to the one above the finest.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Lod {
    pub levels: Vec<Vec<Voxel>>,
}

impl Lod {
    /// Filters the leaves upwards. `leaf(k)` is the k-th leaf in Morton order; normals are in `code`.
    pub(crate) fn new(structure: &Structure, code: NormalCode, leaf: impl Fn(usize) -> Voxel) -> Self {
        let mut levels: Vec<Vec<Voxel>> = structure.levels.iter().map(|_| Vec::new()).collect();
        for level in (0..levels.len()).rev() {
            let (upper, lower) = levels.split_at_mut(level + 1);
            upper[level] = match lower.first() {
                Some(children) => filter_level(&structure.levels[level], code, |child| children[child]),
                None => filter_level(&structure.levels[level], code, &leaf),
            };
        }
        Self { levels }
    }

    /// Number of voxels.
    pub(crate) fn voxel_count(&self) -> usize {
        self.levels.iter().map(Vec::len).sum()
    }

    /// The voxel of the root; that of the only leaf if there is no other level.
    pub(crate) fn root(&self, leaf: impl Fn(usize) -> Voxel) -> Voxel {
        self.levels.first().map_or_else(|| leaf(0), |level| level[0])
    }
}

fn filter_level(masks: &[u8], code: NormalCode, child: impl Fn(usize) -> Voxel) -> Vec<Voxel> {
    let mut first = 0;
    masks
        .iter()
        .map(|mask| {
            let count = mask.count_ones() as usize;
            let mut children = [Voxel::EMPTY; 8];
            for (index, slot) in children[..count].iter_mut().enumerate() {
                *slot = child(first + index);
            }
            first += count;
            parent(&children[..count], code)
        })
        .collect()
}

/// A voxel for one to eight filled children in the order of their octants: the palette index that most of them have (of
/// several, the one that comes first), and the mean of their normals (Bohnen 2009, section 3.1.4). If the normals cancel
/// out, the first child's.
pub(crate) fn parent(children: &[Voxel], code: NormalCode) -> Voxel {
    let first = children[0];
    if children.iter().all(|child| *child == first) {
        return first;
    }
    let mut sum = [0.0f32; 3];
    for child in children {
        for (total, component) in sum.iter_mut().zip(code.decode(child.normal)) {
            *total += component;
        }
    }
    // Unit vectors that cancel out leave what rounding leaves.
    let cancelled = sum.iter().all(|component| component.abs() < 1e-5);
    let normal = if cancelled { first.normal } else { code.encode(sum) };
    Voxel { palette_index: majority(children), normal }
}

fn majority(children: &[Voxel]) -> u16 {
    let first = children[0].palette_index;
    if children.iter().all(|child| child.palette_index == first) {
        return first;
    }
    let votes = |index: u16| children.iter().filter(|child| child.palette_index == index).count();
    children.iter().map(|child| child.palette_index).rev().max_by_key(|&index| votes(index)).unwrap_or(first)
}

#[cfg(test)]
mod tests {
    use super::*;

    const CODES: [NormalCode; 2] = [NormalCode::Spherical, NormalCode::Octahedral];

    fn voxel(palette_index: u16, normal: [f32; 3], code: NormalCode) -> Voxel {
        Voxel { palette_index, normal: code.encode(normal) }
    }

    #[test]
    fn most_children_win_and_of_several_the_first() {
        let code = NormalCode::Spherical;
        let index = |indices: &[u16]| {
            let children: Vec<Voxel> =
                indices.iter().map(|&index| voxel(index, [1.0, 0.0, 0.0], code)).collect();
            parent(&children, code).palette_index
        };
        assert_eq!(index(&[7]), 7);
        assert_eq!(index(&[7, 3, 3]), 3);
        assert_eq!(index(&[7, 3, 3, 7]), 7);
        assert_eq!(index(&[9, 7, 3, 3, 7]), 7);
        assert_eq!(index(&[1, 2, 3, 4, 5, 6, 7, 8]), 1);
    }

    #[test]
    fn normals_are_averaged() {
        for code in CODES {
            let (x, y) = (voxel(1, [1.0, 0.0, 0.0], code), voxel(1, [0.0, 1.0, 0.0], code));
            assert_eq!(parent(&[x, y], code).normal, code.encode([1.0, 1.0, 0.0]));
            assert_eq!(parent(&[x, y, x], code).normal, code.encode([2.0, 1.0, 0.0]));
            assert_eq!(parent(&[x, x], code), x);
        }
    }

    #[test]
    fn normals_that_cancel_out_leave_the_first() {
        for code in CODES {
            let (up, down) = (voxel(1, [0.0, 1.0, 0.0], code), voxel(2, [0.0, -1.0, 0.0], code));
            assert_eq!(parent(&[up, down], code).normal, up.normal);
            assert_eq!(parent(&[down, up], code).normal, down.normal);
        }
    }
}
