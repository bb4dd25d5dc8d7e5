//! The colours of levels of detail.

use crate::color_space::{to_displayed, to_linear};
use crate::structure::Structure;
use std::cmp::Reverse;

/// How a node gets its colour from its children.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum LodColor {
    /// The mean of the light of all voxels below it, and of the palette the entry nearest to that.
    #[default]
    Mean,
    /// The palette entry that most of its children have; of several, the one that comes first (Bohnen 2009, section 3.1.4).
    Majority,
}

/// Light of many voxels.
///
/// What a pixel sees of a node from afar is the mean of the surface in it, and the number of leaf voxels is a measure of the
/// surface. So children count by their voxels, not equally, and the mean of a node is that of all voxels below it, on
/// whatever levels they are added up.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Light {
    /// 16-bit linear light of the voxels, added up.
    sum: [u64; 3],
    voxels: u64,
    /// The finish that most of them have. Finishes are not mixed.
    pub finish: u16,
}

impl Light {
    /// That of voxels of one finish and colour.
    #[inline]
    pub(crate) fn of((finish, color): (u16, [u8; 3]), voxels: u64) -> Self {
        Self { sum: to_linear(color).map(|channel| u64::from(channel) * voxels), voxels, finish }
    }

    /// That of one to eight children.
    fn of_children(children: &[Self]) -> Self {
        let mut light = Self { finish: finish_of_most(children), ..Self::default() };
        children.iter().for_each(|child| light.add(child));
        light
    }

    /// Adds light; the finish stays.
    #[inline]
    pub(crate) fn add(&mut self, other: &Self) {
        for (sum, more) in self.sum.iter_mut().zip(other.sum) {
            *sum += more;
        }
        self.voxels += other.voxels;
    }

    /// The mean as a displayed colour; `None` if there are no voxels.
    #[inline]
    pub(crate) fn mean(&self) -> Option<[u8; 3]> {
        let rounded = |sum: u64| ((sum + self.voxels / 2) / self.voxels) as u16;
        (self.voxels > 0).then(|| to_displayed(self.sum.map(rounded)))
    }
}

/// The finish of most voxels; of several, the lowest number.
#[inline]
fn finish_of_most(children: &[Light]) -> u16 {
    let first = children[0].finish;
    if children.iter().all(|child| child.finish == first) {
        return first;
    }
    let voxels = |finish: u16| -> u64 {
        children.iter().filter(|child| child.finish == finish).map(|child| child.voxels).sum()
    };
    let finishes = children.iter().map(|child| child.finish);
    finishes.max_by_key(|&finish| (voxels(finish), Reverse(finish))).unwrap_or(first)
}

/// The palette indices of all nodes, level by level as in [`Structure`], and the light of everything.
///
/// `leaf(k)` is the light and the palette index of the k-th leaf; `index` finds that of a finish and a mean colour.
pub(crate) fn mean_colors(
    structure: &Structure,
    leaf: impl Fn(usize) -> (Light, u16),
    index: impl Fn(u16, [u8; 3]) -> u16,
) -> (Vec<Vec<u16>>, Light) {
    let mut levels = vec![Vec::new(); structure.levels.len()];
    let mut below: Vec<(Light, u16)> = Vec::new();
    for (level, masks) in structure.levels.iter().enumerate().rev() {
        let is_finest = level + 1 == structure.levels.len();
        let child = |child: usize| if is_finest { leaf(child) } else { below[child] };
        let mut next = 0;
        let node = |mask: &u8| {
            let mut children = [Light::default(); 8];
            let count = mask.count_ones() as usize;
            let first = child(next).1;
            let mut same = true;
            for (number, light) in children[..count].iter_mut().enumerate() {
                let (child_light, index) = child(next + number);
                *light = child_light;
                same &= index == first;
            }
            next += count;
            let light = Light::of_children(&children[..count]);
            // Children with one entry are not looked up, though their mean may be a little nearer to another.
            let mean = if same { None } else { light.mean() };
            (light, mean.map_or(first, |color| index(light.finish, color)))
        };
        let nodes: Vec<(Light, u16)> = masks.iter().map(node).collect();
        levels[level] = nodes.iter().map(|(_, index)| *index).collect();
        below = nodes;
    }
    let light = below.first().map_or_else(|| leaf(0).0, |(light, _)| *light);
    (levels, light)
}

/// The palette indices of all nodes, by the vote of their children. `leaf(k)` is that of the k-th leaf.
pub(crate) fn majority_colors(structure: &Structure, leaf: impl Fn(usize) -> u16) -> Vec<Vec<u16>> {
    let mut levels: Vec<Vec<u16>> = vec![Vec::new(); structure.levels.len()];
    for (level, masks) in structure.levels.iter().enumerate().rev() {
        let (upper, lower) = levels.split_at_mut(level + 1);
        let mut next = 0;
        upper[level] = masks
            .iter()
            .map(|mask| {
                let mut children = [0; 8];
                let count = mask.count_ones() as usize;
                for (number, child) in children[..count].iter_mut().enumerate() {
                    *child = lower.first().map_or_else(|| leaf(next + number), |level| level[next + number]);
                }
                next += count;
                majority(&children[..count])
            })
            .collect();
    }
    levels
}

fn majority(children: &[u16]) -> u16 {
    let first = children[0];
    if children.iter().all(|child| *child == first) {
        return first;
    }
    let votes = |index: u16| children.iter().filter(|child| **child == index).count();
    children.iter().copied().rev().max_by_key(|&index| votes(index)).unwrap_or(first)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn most_children_win_and_of_several_the_first() {
        assert_eq!(majority(&[7]), 7);
        assert_eq!(majority(&[7, 3, 3]), 3);
        assert_eq!(majority(&[7, 3, 3, 7]), 7);
        assert_eq!(majority(&[9, 7, 3, 3, 7]), 7);
        assert_eq!(majority(&[1, 2, 3, 4, 5, 6, 7, 8]), 1);
    }

    #[test]
    fn means_are_of_light_and_count_voxels_not_children() {
        // An upper child with eight white voxels, a lower one with one black voxel.
        let codes: Vec<u32> = std::iter::once(0).chain(8..16).collect();
        let structure = Structure::from_codes(&codes, 2);
        let leaf =
            |k: usize| if k == 0 { (Light::of((7, [0; 3]), 1), 1) } else { (Light::of((4, [255; 3]), 1), 2) };
        let asked = std::cell::RefCell::new(Vec::new());
        let (levels, light) = mean_colors(&structure, leaf, |finish, color| {
            asked.borrow_mut().push((finish, color));
            3
        });
        assert_eq!(levels, [vec![3], vec![1, 2]]);
        // 8/9 of the light: displayed as 255 · (1.055 · (8/9)^(1/2.4) − 0.055).
        assert_eq!(*asked.borrow(), [(4, [242; 3])]);
        assert_eq!(light.mean(), Some([242; 3]));
        assert_eq!(majority_colors(&structure, |k| leaf(k).1), [vec![1], vec![1, 2]]);
    }

    #[test]
    fn most_voxels_give_the_finish_and_of_several_the_lowest() {
        let finish = |children: &[(u16, u64)]| {
            let lights = children.iter().map(|&(finish, voxels)| Light::of((finish, [9; 3]), voxels));
            Light::of_children(&lights.collect::<Vec<_>>()).finish
        };
        assert_eq!(finish(&[(5, 1)]), 5);
        assert_eq!(finish(&[(5, 1), (2, 9), (5, 1)]), 2);
        assert_eq!(finish(&[(5, 6), (2, 9), (5, 6)]), 5);
        assert_eq!(finish(&[(5, 3), (2, 3)]), 2);
    }

    #[test]
    fn nothing_has_no_color() {
        assert_eq!(Light::default().mean(), None);
    }
}
