//! What a ray hits, from the definition: plane by plane, in fractions of whole numbers.
//!
//! Space is an endless lattice of finest cells, each with its low faces and without its high ones. A ray begins in the
//! cell that holds its origin. It crosses planes in the order of their distance, at equal distance x before y before
//! z, and a plane it runs parallel to never. It hits the first filled cell on that way.
//!
//! No octree, no skipping, no division: slow, and easy to believe.

use octvox_raytracer::oracle::{LATTICE_BITS, LatticeRay};
use std::cmp::Ordering;

/// A fraction with a positive denominator.
#[derive(Debug, Clone, Copy)]
pub struct Fraction {
    numerator: i128,
    denominator: i128,
}

impl Fraction {
    fn new(numerator: i128, denominator: i128) -> Self {
        let sign = denominator.signum();
        Self { numerator: numerator * sign, denominator: denominator * sign }
    }

    fn compare(&self, other: &Self) -> Ordering {
        (self.numerator * other.denominator).cmp(&(other.numerator * self.denominator))
    }

    /// The nearest number in double precision, if numerator and denominator fit one exactly.
    #[must_use]
    pub fn to_f64(self) -> f64 {
        self.numerator as f64 / self.denominator as f64
    }
}

/// Where a ray ends.
#[derive(Debug, Clone, Copy)]
pub struct NaiveHit {
    /// Coordinates of the finest cell.
    pub cell: [u32; 3],
    /// Distance to the face through which the ray comes in, in units of the direction's length.
    pub distance: Fraction,
}

/// The way of a ray.
#[derive(Debug, Clone, Copy)]
pub struct Walk {
    /// The first filled cell, if there is one.
    pub hit: Option<NaiveHit>,
    /// Whether the ray began on no plane of the lattice, and met no edge and no corner of it on its way, so that neither
    /// half-open cells nor the order of axes mattered.
    pub in_general_position: bool,
}

/// Follows a ray through a cube of `1 << depth` cells per axis.
///
/// # Panics
/// If the cells are smaller than the ray's lattice.
#[must_use]
pub fn walk(depth: u8, ray: &LatticeRay, is_filled: impl Fn([u32; 3]) -> bool) -> Walk {
    let size = 1i128 << depth;
    let cell_size =
        1i128 << LATTICE_BITS.checked_sub(u32::from(depth)).expect("cells are whole lattice units");
    let origin = ray.origin.map(i128::from);
    let direction = ray.direction.map(i128::from);
    let mut cell = origin.map(|part| part.div_euclid(cell_size));
    let mut distance = Fraction::new(0, 1);
    let mut in_general_position = origin.iter().all(|part| part.rem_euclid(cell_size) != 0);
    loop {
        let is_inside = cell.iter().all(|coordinate| (0..size).contains(coordinate));
        if is_inside && direction != [0; 3] && is_filled(cell.map(|coordinate| coordinate as u32)) {
            let cell = cell.map(|coordinate| coordinate as u32);
            return Walk { hit: Some(NaiveHit { cell, distance }), in_general_position };
        }
        let never_comes_in = |axis: usize| {
            cell[axis] < 0 && direction[axis] <= 0 || cell[axis] >= size && direction[axis] >= 0
        };
        if direction == [0; 3] || (0..3).any(never_comes_in) {
            return Walk { hit: None, in_general_position };
        }
        let crossing = |axis: usize| {
            let plane = if direction[axis] > 0 { cell[axis] + 1 } else { cell[axis] };
            (axis, Fraction::new(plane * cell_size - origin[axis], direction[axis]))
        };
        let moving = (0..3).filter(|&axis| direction[axis] != 0);
        // Of equal distances, the first is the minimum.
        let nearest = moving.clone().map(crossing).min_by(|(_, a), (_, b)| a.compare(b));
        let Some((axis, crossed)) = nearest else { return Walk { hit: None, in_general_position } };
        in_general_position &=
            moving.map(crossing).filter(|(_, other)| other.compare(&crossed).is_eq()).count() == 1;
        distance = crossed;
        cell[axis] += direction[axis].signum();
    }
}
