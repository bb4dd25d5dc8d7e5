//! Merging similar colours until they fit a palette (Bohnen 2009, section 3.1.2).
//!
//! Again and again the two most similar colours become one, their mean weighted by use. Similarity is the distance in
//! Oklab (Bohnen: in RGB), times the sum of both *drift counters*: from how many original colours each has come. So colours
//! that have drifted far are picked less often. Means are taken of linear light.
//!
//! The two most similar colours are found exactly, without comparing all pairs: every colour keeps its nearest one, as of
//! when it was looked up, in a priority queue. Since a pair's second member found its nearest when the first was there
//! already, the most similar pair is always in the queue; an entry whose nearest colour has been merged meanwhile is a lower
//! bound and is looked up again when its turn comes. Looking up is done in a k-d tree and a short list of the colours that
//! are newer than it; it is built anew when the list is full.
//!
//! Of more than [`MAX_COLORS`] colours those that differ only in the lowest bits are merged beforehand. At least half of
//! [`MAX_COLORS`] remain, which is twice as many as the largest palette holds.

use crate::color_set::ColorSet;
use crate::color_space::{light_to_oklab, to_displayed, to_linear};
use crate::kd_tree::{KdTree, Point};
use rayon::prelude::*;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// More colours than this are merged coarsely first.
const MAX_COLORS: usize = 1 << 17;
/// So many merged colours are compared one by one.
const MAX_RECENT: usize = 64;

/// Merges `colors` (ascending, each used `counts` times) until there are no more than `size`.
///
/// Returns the palette, ascending, and for each colour its place in it.
pub(crate) fn merge_colors(colors: &[[u8; 3]], counts: &[u64], size: usize) -> (Vec<[u8; 3]>, Vec<usize>) {
    let (group_of, groups) = group(colors);
    let mut merging = Merging::new(groups, size);
    for ((&color, &count), &group) in colors.iter().zip(counts).zip(&group_of) {
        merging.mixtures[group].add(color, count);
    }
    merging.run(size);

    let mut palette: Vec<[u8; 3]> =
        merging.mixtures.iter().filter(|mixture| mixture.is_alive()).map(Mixture::displayed).collect();
    palette.sort_unstable();
    palette.dedup();
    let entries: Vec<usize> = (0..groups)
        .map(|group| {
            let color = merging.mixtures[merging.last(group)].displayed();
            palette.partition_point(|entry| *entry < color)
        })
        .collect();
    (palette, group_of.into_iter().map(|group| entries[group]).collect())
}

/// Numbers the colours' groups: the group of each colour, and how many there are.
fn group(colors: &[[u8; 3]]) -> (Vec<usize>, usize) {
    let mut bits = [0; 3];
    // A bit of blue goes, which an eye resolves least, then one of red, then one of green, and so on. Each step leaves at
    // least half of the colours.
    let mut channels = [2, 0, 1].into_iter().cycle();
    loop {
        let coarse = |color: [u8; 3]| [0, 1, 2].map(|channel| color[channel] >> bits[channel]);
        let set = ColorSet::of(colors.iter().map(|&color| coarse(color)));
        match channels.next() {
            Some(channel) if set.len() > MAX_COLORS => bits[channel] += 1,
            _ => return (colors.iter().map(|&color| set.number(coarse(color))).collect(), set.len()),
        }
    }
}

/// A colour that others may have been merged into.
#[derive(Debug, Clone, Default)]
struct Mixture {
    /// Sums over the voxels that have this colour.
    light: [u64; 3],
    voxels: u64,
    /// From how many colours it has come.
    drift: u64,
    oklab: [f32; 3],
    /// What it has been merged into.
    merged: Option<usize>,
}

impl Mixture {
    fn add(&mut self, color: [u8; 3], count: u64) {
        for (sum, channel) in self.light.iter_mut().zip(to_linear(color)) {
            *sum += u64::from(channel) * count;
        }
        self.voxels += count;
        self.drift += 1;
    }

    fn join(a: &Self, b: &Self) -> Self {
        let light = [0, 1, 2].map(|channel| a.light[channel] + b.light[channel]);
        let mut mixture =
            Self { light, voxels: a.voxels + b.voxels, drift: a.drift + b.drift, ..Self::default() };
        mixture.place();
        mixture
    }

    /// Computes where it lies in Oklab.
    fn place(&mut self) {
        let scale = 1.0 / (65_535.0 * self.voxels.max(1) as f64);
        self.oklab = light_to_oklab(self.light.map(|sum| (sum as f64 * scale) as f32));
    }

    fn displayed(&self) -> [u8; 3] {
        let voxels = self.voxels.max(1);
        to_displayed(self.light.map(|sum| ((sum + voxels / 2) / voxels) as u16))
    }

    fn is_alive(&self) -> bool {
        self.merged.is_none()
    }
}

/// A colour and the most similar one: the square of their distance times drift, as ordered bits; the colour; the other.
type Entry = Reverse<(u32, usize, usize)>;

struct Merging {
    mixtures: Vec<Mixture>,
    alive: usize,
    tree: KdTree,
    /// Colours that are newer than the tree.
    recent: Vec<Point>,
    queue: BinaryHeap<Entry>,
}

impl Merging {
    fn new(count: usize, size: usize) -> Self {
        let mut mixtures = Vec::with_capacity(2 * count - size.min(count));
        mixtures.resize(count, Mixture::default());
        Self { mixtures, alive: count, tree: KdTree::default(), recent: Vec::new(), queue: BinaryHeap::new() }
    }

    fn run(&mut self, size: usize) {
        self.mixtures.par_iter_mut().for_each(Mixture::place);
        self.build_tree();
        let entries: Vec<Entry> =
            (0..self.mixtures.len()).into_par_iter().filter_map(|mixture| self.nearest(mixture)).collect();
        self.queue = entries.into();
        while self.alive > size {
            let Some(Reverse((_, a, b))) = self.queue.pop() else { break };
            if !self.mixtures[a].is_alive() {
                continue;
            }
            if self.mixtures[b].is_alive() {
                self.merge(a, b);
            } else {
                self.queue.extend(self.nearest(a));
            }
        }
    }

    fn merge(&mut self, a: usize, b: usize) {
        let joined = self.mixtures.len();
        self.mixtures.push(Mixture::join(&self.mixtures[a], &self.mixtures[b]));
        self.mixtures[a].merged = Some(joined);
        self.mixtures[b].merged = Some(joined);
        self.alive -= 1;
        if self.recent.len() == MAX_RECENT {
            self.build_tree();
        } else {
            self.recent.push(self.point(joined));
        }
        self.queue.extend(self.nearest(joined));
    }

    fn build_tree(&mut self) {
        let points = (0..self.mixtures.len())
            .filter(|&mixture| self.mixtures[mixture].is_alive())
            .map(|mixture| self.point(mixture))
            .collect();
        self.recent.clear();
        self.tree = KdTree::new(points);
    }

    fn point(&self, mixture: usize) -> Point {
        let Mixture { oklab, drift, .. } = self.mixtures[mixture];
        Point { position: oklab, weight: drift as f32, number: mixture }
    }

    /// The queue's entry for a colour; `None` if it is the last.
    fn nearest(&self, mixture: usize) -> Option<Entry> {
        let Point { position, weight, .. } = self.point(mixture);
        // Distances are not negative, so their bits are ordered as they are.
        let cost = |square: f32, drift: f32| (square * (drift * drift)).to_bits();
        let consider = |best: &mut (u32, usize), other: &Point, square: f32| {
            let candidate = (cost(square, weight + other.weight), other.number);
            if candidate < *best && other.number != mixture && self.mixtures[other.number].is_alive() {
                *best = candidate;
            }
        };
        let mut best = (u32::MAX, usize::MAX);
        self.tree.visit_near(position, |other, square| {
            let Some(other) = other else {
                // No other colour has drifted less than once.
                return cost(square, weight + 1.0) <= best.0;
            };
            consider(&mut best, other, square);
            true
        });
        for other in &self.recent {
            let square = (0..3).map(|axis| (other.position[axis] - position[axis]).powi(2)).sum();
            consider(&mut best, other, square);
        }
        (best.1 != usize::MAX).then_some(Reverse((best.0, mixture, best.1)))
    }

    /// What a colour has become in the end.
    fn last(&self, mut mixture: usize) -> usize {
        while let Some(merged) = self.mixtures[mixture].merged {
            mixture = merged;
        }
        mixture
    }
}
