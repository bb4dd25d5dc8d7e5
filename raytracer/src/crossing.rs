//! Which cells of a node rays cross: all 64 at once, as a mask like the node's.
//!
//! A cell is what three slabs have in common, one for each axis. A ray is within a slab from its entry plane to its exit plane, and
//! three intervals on a line have a place in common if every two of them do (Helly's theorem). So a ray crosses a cell if
//! and only if it enters each of the cell's slabs before it leaves each of the others: nothing but the order of planes decides,
//! as everywhere ([`crate::traversal`]), and it is asked for nine pairs of inner planes of each two axes, instead of for cell after
//! cell. The node as a whole is one interval more, in which its cells are crossed.

use crate::lanes::{Choice, Lanes, each};
use crate::lod::size_of_cells;
use crate::node::CELLS;
use crate::octree::cell_of_morton;
use crate::ray::Lines;

/// A set of cells of a node, in two halves.
type Cells = [u32; 2];

/// Sets of cells that what is known of the order of planes leaves, for rays that are mirrored along some axes.
///
/// *Slab* `n` of an axis is between the planes `n` and `n + 1`, counted in mirrored space, where rays go from slab 3 to slab 0.
/// What does not depend on z is the same for both halves.
struct Sets {
    /// For each inner plane of x, by how many of y are crossed after it.
    x_and_y: [Choice; 3],
    x_and_z: [[Choice; 2]; 3],
    y_and_z: [[Choice; 2]; 3],
    /// For each axis but z, by how many inner planes have been crossed when the node is entered, and when it is left.
    entered: [Choice; 2],
    left: [Choice; 2],
    entered_along_z: [Choice; 2],
    left_along_z: [Choice; 2],
}

/// Which slab of an axis a cell is in.
const fn slab(cell: usize, axis: usize, mirrored: bool) -> usize {
    let coordinate = cell_of_morton(cell as u32)[axis] as usize;
    if mirrored { 3 - coordinate } else { coordinate }
}

impl Sets {
    const fn new(mirrored: [bool; 3]) -> Self {
        let mut pairs = [[[[0; 2]; 4]; 3]; 3];
        let mut entered = [[[0; 2]; 4]; 3];
        let mut left = [[[0; 2]; 4]; 3];
        let mut cell = 0;
        while cell < CELLS {
            let (half, bit) = (cell / 32, 1 << (cell % 32));
            let mut pair = 0;
            while pair < 3 {
                let (first, second) = [(0, 1), (0, 2), (1, 2)][pair];
                let (one, other) = (slab(cell, first, mirrored[first]), slab(cell, second, mirrored[second]));
                let mut plane = 1;
                while plane < 4 {
                    let mut later = 0;
                    while later < 4 {
                        // Planes up to `later` of the second axis are crossed after the first axis's plane, those beyond before.
                        let is_out = (one >= plane && other < later) || (one < plane && other > later);
                        if !is_out {
                            pairs[pair][plane - 1][later][half] |= bit;
                        }
                        later += 1;
                    }
                    plane += 1;
                }
                let place = slab(cell, pair, mirrored[pair]);
                let mut crossed = 0;
                while crossed < 4 {
                    if place + crossed <= 3 {
                        entered[pair][crossed][half] |= bit;
                    }
                    if place + crossed >= 3 {
                        left[pair][crossed][half] |= bit;
                    }
                    crossed += 1;
                }
                pair += 1;
            }
            cell += 1;
        }
        let [x_and_y, x_and_z, y_and_z] = pairs;
        Self {
            x_and_y: [halves(x_and_y[0])[0], halves(x_and_y[1])[0], halves(x_and_y[2])[0]],
            x_and_z: [halves(x_and_z[0]), halves(x_and_z[1]), halves(x_and_z[2])],
            y_and_z: [halves(y_and_z[0]), halves(y_and_z[1]), halves(y_and_z[2])],
            entered: [halves(entered[0])[0], halves(entered[1])[0]],
            left: [halves(left[0])[0], halves(left[1])[0]],
            entered_along_z: halves(entered[2]),
            left_along_z: halves(left[2]),
        }
    }
}

const fn halves([none, one, two, three]: [Cells; 4]) -> [Choice; 2] {
    [Choice::new([none[0], one[0], two[0], three[0]]), Choice::new([none[1], one[1], two[1], three[1]])]
}

/// By the axes that are mirrored, x being worth 1, y 2 and z 4.
static SETS: [Sets; 8] = {
    const fn of(axes: usize) -> Sets {
        Sets::new([axes & 1 != 0, axes & 2 != 0, axes & 4 != 0])
    }
    [of(0), of(1), of(2), of(3), of(4), of(5), of(6), of(7)]
};

/// What is needed to tell which cells are crossed by rays that are all mirrored along the same axes.
#[derive(Clone, Copy)]
pub(crate) struct Crossing {
    mirrored: [bool; 3],
    sets: &'static Sets,
}

impl Crossing {
    /// For rays that run towards larger coordinates along the mirrored axes, and towards smaller ones along the others.
    pub fn new(mirrored: [bool; 3]) -> Self {
        let axes = (0..3).map(|axis| usize::from(mirrored[axis]) << axis).sum::<usize>();
        Self { mirrored, sets: &SETS[axes] }
    }

    /// The axes along which rays are mirrored.
    pub fn mirrored(&self) -> [bool; 3] {
        self.mirrored
    }

    /// The cells of a node that each ray crosses, in the node's own order: low and high half; and the distance at which it comes
    /// into the node, if it does.
    ///
    /// The node's low corner is given by the bits of floats in mirrored space; its cells are of size `1 << exponent`, and it
    /// is in the cube.
    #[inline(always)]
    pub fn cells<L: Lanes>(
        &self,
        rays: &Lines<L>,
        corner: [L::Word; 3],
        exponent: L::Word,
    ) -> ([L::Word; 2], L::Float) {
        let size = size_of_cells::<L>(exponent);
        let twice = size + size;
        let steps = [L::float(0.0), size, twice, twice + size, twice + twice];
        let mut planes: [[L::Float; 5]; 3] = each(|axis| {
            let low = L::from_bits(corner[axis]);
            let plane = |number: usize| rays.distance_to(axis, low + steps[number]);
            [plane(0), plane(1), plane(2), plane(3), plane(4)]
        });
        let last = L::max(L::max(planes[0][4], planes[1][4]), planes[2][4]);
        if L::any(L::at_most(last, rays.start)) {
            // A copy of them is handed over, so that they need not be in memory where that is not called.
            let mut behind = planes;
            self.leave_behind::<L>(&mut behind, rays.start);
            planes = behind;
        }
        // Zeros of either sign become +0.
        let zero = L::float(0.0);
        let enter: [L::Float; 3] = each(|axis| planes[axis][4] + zero);
        let leave: [L::Float; 3] = each(|axis| planes[axis][0] + zero);
        // A plane has been crossed when the node is entered if it comes before one of the planes through which that is done: of two
        // at the same distance, the one of the earlier axis comes first.
        let reached = [
            L::max(L::next_up(L::max(enter[1], enter[2])), rays.start),
            L::max(L::max(L::next_up(enter[2]), enter[0]), rays.start),
            L::max(L::max(enter[0], enter[1]), rays.start),
        ];
        // And when the node is left, if it comes before all of those through which that is done.
        let end = [
            L::next_up(L::min(leave[1], leave[2])),
            L::min(L::next_up(leave[2]), leave[0]),
            L::min(leave[0], leave[1]),
        ];
        let visits = L::at_most(reached[0], leave[0])
            & L::at_most(reached[1], leave[1])
            & L::at_most(reached[2], leave[2]);

        let sets = self.sets;
        let [x, y, z] = planes;
        let mut cells = L::select_word(visits, L::word(u32::MAX), L::word(0));
        for plane in 0..3 {
            let before = |number: usize| L::at_most(x[plane + 1], y[number]);
            cells = cells & L::choose(&sets.x_and_y[plane], [before(1), before(2), before(3)]);
        }
        let crossed = |axis: usize, by: L::Float| [3, 2, 1].map(|plane| L::less(planes[axis][plane], by));
        for axis in 0..2 {
            cells = cells & L::choose(&sets.entered[axis], crossed(axis, reached[axis]));
            cells = cells & L::choose(&sets.left[axis], crossed(axis, end[axis]));
        }
        let mut halves = [cells, cells];
        let mut keep = |sets: &[Choice; 2], masks: [L::Mask; 3]| {
            halves[0] = halves[0] & L::choose(&sets[0], masks);
            halves[1] = halves[1] & L::choose(&sets[1], masks);
        };
        for plane in 0..3 {
            for (sets, of) in [(&sets.x_and_z, &x), (&sets.y_and_z, &y)] {
                let before = |number: usize| L::at_most(of[plane + 1], z[number]);
                keep(&sets[plane], [before(1), before(2), before(3)]);
            }
        }
        keep(&sets.entered_along_z, crossed(2, reached[2]));
        keep(&sets.left_along_z, crossed(2, end[2]));
        (halves, L::max(reached[2], enter[2]))
    }

    /// Where rays begin in a node: mirrored planes at the very start have been crossed there, before all others.
    #[cold]
    #[inline(never)]
    fn leave_behind<L: Lanes>(&self, planes: &mut [[L::Float; 5]; 3], start: L::Float) {
        for axis in (0..3).filter(|&axis| self.mirrored[axis]) {
            for plane in &mut planes[axis] {
                *plane = L::select(L::at_most(*plane, start), L::float(-1.0), *plane);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{Doubles, Eight, Single, Sixteen};
    use crate::octree::MANTISSA_BITS;
    use crate::random::Random;
    use crate::ray::{Packet, Ray};
    use crate::traversal::Visit;
    use glam::DVec3;

    /// Cells that rays visit, one by one: by the planes of each cell alone.
    fn one_by_one<L: Lanes>(packet: &Packet<L>, corner: [u32; 3], exponent: u32) -> Vec<u64> {
        let mut visited = vec![0; L::COUNT];
        for cell in 0..64 {
            let place = cell_of_morton(cell);
            let planes = |by: u32| {
                each(|axis| {
                    let mirrored = L::bitmask(packet.mirrored()[axis]) & 1 == 1;
                    let slab = if mirrored { 3 - place[axis] } else { place[axis] };
                    let plane = f32::from_bits(corner[axis] + ((slab + by) << exponent));
                    packet.distance_to(axis, L::float(plane))
                })
            };
            let visits = L::bitmask(Visit::new(packet, planes(1), planes(0)).visits);
            for (lane, visited) in visited.iter_mut().enumerate() {
                *visited |= u64::from(visits >> lane & 1) << cell;
            }
        }
        visited
    }

    /// Rays that run along the same way, from near a node towards it, along lattices of several finenesses, so that they meet edges
    /// and corners and begin on planes and in cells; returns how many cells were crossed.
    fn crossed_as_visited<L: Lanes>(seed: u64) -> u32 {
        let random = &mut Random::stream(seed, 0);
        let mut count = 0;
        for round in 0..4000 {
            let exponent = random.between(2, 21) as u32;
            let cell = 1u32 << exponent;
            let mirrored: [bool; 3] = each(|_| random.next() & 1 == 1);
            let corner: [u32; 3] = each(|_| {
                let place = random.next() as u32 & ((1 << MANTISSA_BITS) - 1);
                1f32.to_bits() + (place & !(4 * cell - 1))
            });
            let fineness = [1, 2, 8, 1 << 12][round % 4];
            let size = f64::from(cell) / f64::from(1 << MANTISSA_BITS);
            let mut rays = Vec::new();
            for _ in 0..L::COUNT {
                let mut number = |low: i32, high: i32| {
                    f64::from(random.between(low * fineness, high * fineness)) / f64::from(fineness)
                };
                // In cells of the node, mirrored: from its upper side to its lower one.
                let from = DVec3::new(number(0, 9), number(0, 9), number(0, 9));
                let along = DVec3::new(number(0, 5), number(0, 5), number(0, 5));
                let low = DVec3::from_array(corner.map(|bits| f64::from(f32::from_bits(bits)) - 1.0));
                let in_mirrored = [low + from * size, -along];
                let axes = |vector: DVec3, mirror: f64| {
                    DVec3::from_array(each(
                        |axis| if mirrored[axis] { mirror - vector[axis] } else { vector[axis] },
                    ))
                };
                let mut direction = axes(in_mirrored[1], 0.0);
                if direction == DVec3::ZERO {
                    direction = axes(-DVec3::ONE, 0.0);
                }
                rays.push(Ray { origin: axes(in_mirrored[0], 1.0), direction });
            }
            // A direction of zero along an axis is not mirrored.
            let way_of = |ray: &Ray| each(|axis| ray.direction[axis] > 0.0);
            let rays: Vec<Ray> = rays.into_iter().filter(|ray| way_of(ray) == mirrored).collect();
            if rays.is_empty() {
                continue;
            }
            let lanes = rays.len();
            let filled = (0..L::COUNT).map(|lane| rays[lane % lanes]);
            let (packet, _) = Packet::<L>::from_rays(filled);
            let (halves, _) =
                Crossing::new(mirrored).cells(&packet.lines, corner.map(L::word), L::word(exponent));
            let [low, high] = halves.map(L::words);
            for (lane, expected) in one_by_one(&packet, corner, exponent).into_iter().enumerate() {
                let found = u64::from(low[lane]) | u64::from(high[lane]) << 32;
                assert_eq!(found, expected, "{:?} through {corner:x?}, {exponent}", rays[lane % lanes]);
                count += found.count_ones();
            }
        }
        count
    }

    #[test]
    fn all_at_once_are_the_same_as_one_by_one() {
        let counts = [
            crossed_as_visited::<Single>(1),
            crossed_as_visited::<Eight>(2),
            crossed_as_visited::<Sixteen>(3),
            crossed_as_visited::<Doubles>(4),
        ];
        assert!(counts.iter().all(|&count| count > 2000), "{counts:?}");
    }
}
