//! A first palette: the colours, cut up again and again where they differ most.
//!
//! Every part is one entry. The part with the largest error is cut in two by a plane through its mean, across the axis of
//! Oklab along which it is spread most (Heckbert 1982 cuts at the median; Wu 1991 explains why the variance decides).

use std::collections::BinaryHeap;
use std::ops::Range;

/// A colour in Oklab and the number of voxels that have it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct WeightedColor {
    pub oklab: [f32; 3],
    pub voxels: u64,
}

/// Cuts each family of colours up until there are `size` parts in all, or nothing left to cut. The parts' means come
/// family by family. Families are ranges of `colors`, which is reordered within them.
pub(crate) fn cut(
    colors: &mut [WeightedColor],
    families: &[Range<usize>],
    size: usize,
) -> Vec<Vec<[f32; 3]>> {
    let mut parts: Vec<Part> = Vec::with_capacity(size);
    let mut queue = BinaryHeap::new();
    for (family, range) in families.iter().enumerate().filter(|(_, range)| !range.is_empty()) {
        let part = Part::new(colors, range.clone(), family);
        // Errors are not negative, so their bits are ordered as they are. Of equal ones the later part is first.
        queue.push((part.error.to_bits(), parts.len()));
        parts.push(part);
    }
    while parts.len() < size {
        let Some((_, index)) = queue.pop() else { break };
        if let Some([lower, upper]) = parts[index].halves(colors) {
            queue.push((lower.error.to_bits(), index));
            queue.push((upper.error.to_bits(), parts.len()));
            parts[index] = lower;
            parts.push(upper);
        }
    }
    let mut means = vec![Vec::new(); families.len()];
    for part in parts {
        means[part.family].push(part.mean.map(|coordinate| coordinate as f32));
    }
    means
}

/// Colours that will be one entry, unless they are cut.
struct Part {
    colors: Range<usize>,
    family: usize,
    mean: [f64; 3],
    /// The axis along which the colours are spread most.
    axis: usize,
    /// Sum of the squared distances from the mean, times the number of voxels.
    error: f64,
}

impl Part {
    fn new(all: &[WeightedColor], colors: Range<usize>, family: usize) -> Self {
        let (mut weight, mut sums, mut squares) = (0.0, [0.0; 3], [0.0; 3]);
        for color in &all[colors.clone()] {
            let voxels = color.voxels as f64;
            weight += voxels;
            for axis in 0..3 {
                let coordinate = f64::from(color.oklab[axis]);
                sums[axis] += coordinate * voxels;
                squares[axis] += coordinate * coordinate * voxels;
            }
        }
        let mean = sums.map(|sum| sum / weight);
        let spread = [0, 1, 2].map(|axis| (squares[axis] - sums[axis] * mean[axis]).max(0.0));
        let axis = (1..3).fold(0, |best, axis| if spread[axis] > spread[best] { axis } else { best });
        Self { colors, family, mean, axis, error: spread.iter().sum() }
    }

    /// Cuts it in two; `None` if all colours lie on the same side.
    fn halves(&self, all: &mut [WeightedColor]) -> Option<[Self; 2]> {
        let colors = &mut all[self.colors.clone()];
        let at = self.mean[self.axis] as f32;
        let mut lower = 0;
        for index in 0..colors.len() {
            if colors[index].oklab[self.axis] <= at {
                colors.swap(lower, index);
                lower += 1;
            }
        }
        let middle = self.colors.start + lower;
        (lower != 0 && middle != self.colors.end).then(|| {
            [self.colors.start..middle, middle..self.colors.end]
                .map(|range| Self::new(all, range, self.family))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn color(oklab: [f32; 3], voxels: u64) -> WeightedColor {
        WeightedColor { oklab, voxels }
    }

    #[test]
    fn clusters_become_entries() {
        let centers = [[0.1, 0.0, 0.0], [0.3, 0.0, 0.1], [0.6, 0.1, 0.0], [0.9, 0.0, 0.0]];
        let mut colors: Vec<WeightedColor> = (0..400u16)
            .map(|k| {
                let jitter = f32::from(k / 4) * 1e-4 - 0.005;
                color(centers[usize::from(k % 4)].map(|coordinate| coordinate + jitter), 1)
            })
            .collect();
        let all = 0..colors.len();
        let mut found = cut(&mut colors, &[all], 4).remove(0);
        found.sort_by(|a, b| a[0].total_cmp(&b[0]));
        for (found, expected) in found.iter().zip(centers) {
            assert!((0..3).all(|axis| (found[axis] - expected[axis]).abs() < 1e-3), "{found:?}");
        }
    }

    #[test]
    fn every_family_has_an_entry_and_the_most_varied_most_of_them() {
        let mut colors = vec![color([0.5; 3], 1_000_000)];
        colors.extend((0..100u8).map(|k| color([f32::from(k) / 100.0, 0.0, 0.0], 1)));
        let found = cut(&mut colors, &[0..1, 1..101, 101..101], 11);
        assert_eq!(found.iter().map(Vec::len).collect::<Vec<_>>(), [1, 10, 0]);
        assert_eq!(found[0][0], [0.5; 3]);
    }

    #[test]
    fn equal_colors_are_not_cut() {
        let mut colors = vec![color([0.3, 0.1, 0.1], 7); 5];
        assert_eq!(cut(&mut colors, std::slice::from_ref(&(0..5)), 4), [[[0.3, 0.1, 0.1]]]);
    }
}
