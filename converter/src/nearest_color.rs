//! The nearest of many colours, for millions of questions.
//!
//! Oklab is cut into cells. For each cell that is asked about, once, the colours that are nearest to any place in it are
//! listed: those no farther from the cell's nearest place than some other colour is from its farthest. A question then
//! compares the few colours on the list. The answer is exact. Where there are too few questions for lists to pay, each is
//! answered by a search.

use crate::kd_tree::{KdTree, Point};
use std::sync::OnceLock;

/// Where the displayed colours lie in Oklab, with a little room.
const MIN: [f32; 3] = [0.0, -0.24, -0.32];
const MAX: [f32; 3] = [1.0, 0.28, 0.20];
/// Outweighs the rounding of distances, of at most 2 with 24 bits.
const ROUNDING: f32 = 1e-6;
/// As many questions for each colour make up for the lists: to find one takes about eight searches.
const QUESTIONS_PER_COLOR: usize = 8;

/// Colours, by their distance in Oklab.
pub(crate) struct NearestColor {
    tree: KdTree,
    /// None if every question is searched for.
    cells: Vec<OnceLock<Box<[Candidate]>>>,
    cells_per_axis: [usize; 3],
    cells_per_unit: f32,
}

/// A colour that may be the nearest.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Candidate {
    oklab: [f32; 3],
    number: u32,
}

impl NearestColor {
    /// From colours in Oklab, at least one; they are numbered from 0. About so many questions will be asked.
    pub(crate) fn new(colors: &[[f32; 3]], questions: usize) -> Self {
        // So many cells that there are about a dozen colours on a list, and no more of them than pays.
        let cells_per_unit = (4.0 * (colors.len() as f32).cbrt()).ceil().min(128.0);
        let cells_per_axis = [0, 1, 2].map(|axis| ((MAX[axis] - MIN[axis]) * cells_per_unit) as usize + 1);
        let points = colors.iter().enumerate();
        let points = points.map(|(number, &position)| Point { position, weight: 0.0, number }).collect();
        let mut cells = Vec::new();
        if questions / QUESTIONS_PER_COLOR >= colors.len() {
            cells.resize_with(cells_per_axis.iter().product(), OnceLock::new);
        }
        Self { tree: KdTree::new(points), cells, cells_per_axis, cells_per_unit }
    }

    /// The number of the colour nearest to one in Oklab; of several, the smallest number.
    #[inline]
    pub(crate) fn nearest(&self, oklab: [f32; 3]) -> usize {
        if self.cells.is_empty() {
            return self.search(oklab);
        }
        // Negative and too large coordinates belong to the cells at the border.
        let cell = [0, 1, 2].map(|axis| {
            (((oklab[axis] - MIN[axis]) * self.cells_per_unit) as usize).min(self.cells_per_axis[axis] - 1)
        });
        let index = (cell[0] * self.cells_per_axis[1] + cell[1]) * self.cells_per_axis[2] + cell[2];
        let candidates = self.cells[index].get_or_init(|| self.candidates(cell));
        let mut best = (f32::MAX, 0);
        for candidate in candidates {
            let square = square_distance(candidate.oklab, oklab);
            if square < best.0 {
                best = (square, candidate.number);
            }
        }
        best.1 as usize
    }

    fn search(&self, oklab: [f32; 3]) -> usize {
        let mut best = (f32::MAX, usize::MAX);
        self.tree.visit_near(oklab, |point, square| {
            // A region's distance is rounded, too.
            let Some(point) = point else { return square <= best.0 + ROUNDING };
            let square = square_distance(point.position, oklab);
            if square < best.0 || square == best.0 && point.number < best.1 {
                best = (square, point.number);
            }
            true
        });
        best.1
    }

    fn candidates(&self, cell: [usize; 3]) -> Box<[Candidate]> {
        let size = 1.0 / self.cells_per_unit;
        let low = [0, 1, 2].map(|axis| MIN[axis] + cell[axis] as f32 * size);
        let high = low.map(|coordinate| coordinate + size);
        let center = low.map(|coordinate| coordinate + size / 2.0);
        let radius = size * (3.0f32.sqrt() / 2.0);
        // From the colour that is best for the centre, no place in the cell is farther than this.
        let mut nearest = f32::MAX;
        self.tree.visit_near(center, |point, square| {
            if point.is_some() {
                nearest = nearest.min(square);
            }
            square <= nearest
        });
        let mut bound = nearest.sqrt() + radius + ROUNDING;
        let mut candidates = Vec::new();
        self.tree.visit_near(center, |point, square| {
            let reach = bound + radius;
            let Some(point) = point else { return square <= reach * reach };
            let axes = [0, 1, 2].map(|axis| {
                let (below, above) = (low[axis] - point.position[axis], point.position[axis] - high[axis]);
                (below.max(above).max(0.0), (size + below).max(size + above))
            });
            let farthest = axes.iter().map(|axis| axis.1 * axis.1).sum::<f32>().sqrt();
            let closest = axes.iter().map(|axis| axis.0 * axis.0).sum::<f32>().sqrt();
            bound = bound.min(farthest + ROUNDING);
            if closest <= bound {
                let candidate = Candidate { oklab: point.position, number: point.number as u32 };
                candidates.push((closest, candidate));
            }
            true
        });
        candidates.retain(|(closest, _)| *closest <= bound);
        candidates.sort_unstable_by_key(|(_, candidate)| candidate.number);
        candidates.into_iter().map(|(_, candidate)| candidate).collect()
    }
}

fn square_distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    let [l, m, n] = [0, 1, 2].map(|axis| a[axis] - b[axis]);
    l * l + m * m + n * n
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color_space::to_oklab;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn finds_what_comparing_all_finds(
            colors in prop::collection::vec(any::<[u8; 3]>(), 1..300),
            // Few values, so that distances are equal now and then.
            grey in prop::collection::vec((0u8..16).prop_map(|value| [value * 17; 3]), 0..20),
            asked in prop::collection::vec(any::<[u8; 3]>(), 50),
        ) {
            let colors: Vec<[f32; 3]> = colors.into_iter().chain(grey.iter().copied()).map(to_oklab).collect();
            let by_lists = NearestColor::new(&colors, usize::MAX);
            let by_search = NearestColor::new(&colors, 0);
            for color in asked.into_iter().chain(grey).map(to_oklab) {
                let distance = |k: &usize| square_distance(colors[*k], color);
                let expected = (0..colors.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
                prop_assert_eq!(Some(by_lists.nearest(color)), expected);
                prop_assert_eq!(Some(by_search.nearest(color)), expected);
            }
        }
    }

    #[test]
    fn every_displayed_color_has_a_cell_of_its_own_region() {
        for corner in 0..8u8 {
            let color = to_oklab([0, 1, 2].map(|channel| if corner >> channel & 1 == 1 { 255 } else { 0 }));
            assert!((0..3).all(|axis| (MIN[axis]..=MAX[axis]).contains(&color[axis])), "{color:?}");
        }
    }
}
