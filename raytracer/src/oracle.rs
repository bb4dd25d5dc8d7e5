//! The exact walk: what a ray hits, in integers, without a rounding anywhere.
//!
//! Space is an endless lattice of finest cells, each with its low faces and without its high ones. A ray begins in the
//! cell that holds its origin and crosses planes in the order of their distance, at equal distance x before y before z,
//! and a plane that it runs parallel to never. The first filled cell on that way is what it hits, also where the visit
//! is a single point. So a result does not depend on which empty cells are stored together.
//!
//! Slow, and written without regard to the traversal, so that one can be held against the other.
//!
//! Where the octree is empty, many planes are crossed at once: the cell after a crossing follows from the ray's
//! equation by one exact division per axis.
//!
//! Numbers are fractions with whole numbers of 128 bits. With `f` bits behind the point, origins up to `a` from the cube and
//! directions up to `d`, the products that a crossing takes are below (a + 2) · d · 2²ᶠ⁺¹: for a and d of 2, `f` may be 60.
//! Rays of pictures have 44 ([`crate::Visibility::trace_exact`]).

use crate::octree::{Location, Octree};
use crate::ray::Ray;
use glam::DVec3;

/// Bits of a lattice coordinate's fraction.
pub const LATTICE_BITS: u32 = 20;

/// Bits of the fraction that the walk calculates with: enough for the planes of the deepest octree.
const FRACTION_BITS: u32 = 24;

/// Bits of the fraction of rays that stand on no lattice. Near the cube, coordinates of so many bits fit double precision, so
/// a distance is rounded once.
pub(crate) const FINE_BITS: u32 = 44;

/// A ray whose origin and direction are whole multiples of 2⁻²⁰ in unit space.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LatticeRay {
    /// Origin, in units of 2⁻²⁰.
    pub origin: [i32; 3],
    /// Direction, in units of 2⁻²⁰.
    pub direction: [i32; 3],
}

/// Where an exact ray ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExactHit {
    /// Coordinates of the finest cell.
    pub cell: [u32; 3],
    /// Distance in units of the direction's length, rounded once.
    pub distance: f64,
}

/// A crossing: the distance, as a fraction with a positive denominator, and the axis of the plane.
#[derive(Debug, Clone, Copy)]
struct Crossing {
    numerator: i128,
    denominator: i128,
    axis: usize,
}

impl Crossing {
    /// Order of (distance, axis).
    fn comes_before(&self, other: &Self) -> bool {
        let (a, b) = (self.numerator * other.denominator, other.numerator * self.denominator);
        a < b || a == b && self.axis < other.axis
    }

    fn distance(&self) -> f64 {
        self.numerator as f64 / self.denominator as f64
    }
}

impl LatticeRay {
    /// The same ray in floating point, exactly.
    #[must_use]
    pub fn to_ray(&self) -> Ray {
        let unit = f64::from(1u32 << LATTICE_BITS);
        let float = |parts: [i32; 3]| DVec3::from_array(parts.map(|part| f64::from(part) / unit));
        Ray { origin: float(self.origin), direction: float(self.direction) }
    }
}

/// The walk of one ray, all in units of the last bit of the fraction.
pub(crate) struct Walk {
    origin: [i128; 3],
    direction: [i128; 3],
    /// Side of a finest cell.
    cell_size: i128,
    start: [i128; 3],
}

impl Walk {
    /// For an octree of a depth; origin and direction have so many bits behind the point, no fewer than the depth.
    pub fn new(origin: [i128; 3], direction: [i128; 3], fraction_bits: u32, depth: u8) -> Self {
        let cell_size = 1i128 << (fraction_bits - u32::from(depth));
        Self { origin, direction, cell_size, start: origin.map(|part| part.div_euclid(cell_size)) }
    }

    /// The crossing of the plane before cell `plane` of an axis along which the ray moves.
    fn crossing(&self, axis: usize, plane: i128) -> Crossing {
        let numerator = plane * self.cell_size - self.origin[axis];
        let direction = self.direction[axis];
        let sign = direction.signum();
        Crossing { numerator: numerator * sign, denominator: direction * sign, axis }
    }

    /// The cell that the ray is in just after a crossing.
    fn cell_after(&self, crossing: &Crossing) -> [i128; 3] {
        std::array::from_fn(|axis| {
            let (origin, direction) = (self.origin[axis], self.direction[axis]);
            // The coordinate is `numerator / denominator` cells.
            let numerator = origin * crossing.denominator + direction * crossing.numerator;
            let denominator = self.cell_size * crossing.denominator;
            let floor = numerator.div_euclid(denominator);
            let on_plane = numerator.rem_euclid(denominator) == 0;
            // A plane met at this very distance has been crossed if its axis does not come later.
            let crossed = axis <= crossing.axis;
            match direction.signum() {
                0 => self.start[axis],
                1 => (if on_plane && !crossed { floor - 1 } else { floor }).max(self.start[axis]),
                _ => (if on_plane && crossed { floor - 1 } else { floor }).min(self.start[axis]),
            }
        })
    }

    /// The crossing by which the ray comes into the cube, if it is outside and ever does.
    fn entry(&self, cell: [i128; 3], size: i128) -> Option<Crossing> {
        let mut last: Option<Crossing> = None;
        for axis in 0..3 {
            let direction = self.direction[axis].signum();
            let crossing = match cell[axis] {
                below if below < 0 && direction > 0 => self.crossing(axis, 0),
                above if above >= size && direction < 0 => self.crossing(axis, size),
                inside if (0..size).contains(&inside) => continue,
                _ => return None,
            };
            if last.is_none_or(|last| last.comes_before(&crossing)) {
                last = Some(crossing);
            }
        }
        last
    }

    /// The crossing by which the ray leaves the aligned cube of `1 << size_log2` cells around a cell.
    fn exit(&self, cell: [i128; 3], size_log2: u32) -> Option<Crossing> {
        let mut first: Option<Crossing> = None;
        for axis in 0..3 {
            let low = cell[axis] >> size_log2;
            let plane = match self.direction[axis].signum() {
                0 => continue,
                1 => (low + 1) << size_log2,
                _ => low << size_log2,
            };
            let crossing = self.crossing(axis, plane);
            if first.is_none_or(|first| crossing.comes_before(&first)) {
                first = Some(crossing);
            }
        }
        first
    }
}

/// The first filled cell on the way of a ray that `accept` does not pass over. A ray without a direction hits
/// nothing.
pub fn first_hit(
    octree: &Octree,
    ray: &LatticeRay,
    accept: impl FnMut(&ExactHit) -> bool,
) -> Option<ExactHit> {
    let scaled = |parts: [i32; 3]| parts.map(|part| i128::from(part) << (FRACTION_BITS - LATTICE_BITS));
    let walk = Walk::new(scaled(ray.origin), scaled(ray.direction), FRACTION_BITS, octree.depth());
    follow(octree, &walk, accept)
}

/// As [`first_hit`], for any walk.
pub(crate) fn follow(
    octree: &Octree,
    walk: &Walk,
    mut accept: impl FnMut(&ExactHit) -> bool,
) -> Option<ExactHit> {
    if walk.direction == [0; 3] {
        return None;
    }
    let size = i128::from(octree.resolution());
    let mut cell = walk.start;
    let mut distance = 0.0;
    if !cell.iter().all(|coordinate| (0..size).contains(coordinate)) {
        let entry = walk.entry(cell, size)?;
        cell = walk.cell_after(&entry);
        distance = entry.distance();
    }
    loop {
        if !cell.iter().all(|coordinate| (0..size).contains(coordinate)) {
            return None;
        }
        let found = cell.map(|coordinate| coordinate as u32);
        let size_log2 = match octree.locate(found) {
            Location::Voxel { .. } => {
                let hit = ExactHit { cell: found, distance };
                if accept(&hit) {
                    return Some(hit);
                }
                0
            }
            Location::Empty { size_log2, .. } => size_log2,
        };
        let exit = walk.exit(cell, size_log2)?;
        cell = walk.cell_after(&exit);
        distance = exit.distance();
    }
}
