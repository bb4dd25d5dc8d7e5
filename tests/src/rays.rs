//! Kinds of rays.

use crate::random::Random;
use glam::DVec3;
use octvox_raytracer::oracle::{LATTICE_BITS, LatticeRay};
use octvox_raytracer::{Hit, Octree, Ray, Width};

/// Lattice units of the cube's side.
pub const UNIT: i32 = 1 << LATTICE_BITS;

/// The directions of the three axes, the six diagonals of faces and the four of the cube, each both ways: 26.
pub fn axes_and_diagonals() -> impl Iterator<Item = [i32; 3]> {
    (0..27)
        .map(|code| [code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1])
        .filter(|direction| *direction != [0; 3])
}

/// A ray on which single precision loses nothing in an octree of at most ten levels: it begins about the cube on
/// multiples of 2⁻¹⁰, and each component of its direction is zero or plus or minus a power of two from 2⁻³ to 2³.
pub fn exact_in_single_precision(random: &mut Random) -> LatticeRay {
    let step = UNIT >> 10;
    // Half of the origins are on coarse planes, where edges and corners are.
    let coarse = step << random.choose(&[0, 3, 5, 7]);
    let origin = [(); 3].map(|()| random.between(-UNIT / coarse, 2 * UNIT / coarse) * coarse);
    let component = |random: &mut Random| match random.between(0, 4) {
        0 => 0,
        _ => random.choose(&[-1, 1]) << (LATTICE_BITS as i32 + random.between(-3, 3)),
    };
    loop {
        let direction = [(); 3].map(|()| component(random));
        if direction != [0; 3] {
            return LatticeRay { origin, direction };
        }
    }
}

/// A ray from a point about the cube to a point in it, both anywhere on the lattice.
pub fn on_the_lattice(random: &mut Random) -> LatticeRay {
    let origin = [(); 3].map(|()| random.between(-UNIT / 2, 3 * UNIT / 2));
    let target = [(); 3].map(|()| random.between(0, UNIT));
    LatticeRay { origin, direction: std::array::from_fn(|axis| target[axis] - origin[axis]) }
}

/// A ray of which single components are as small as the lattice has them, from afar.
pub fn nearly_parallel(random: &mut Random) -> LatticeRay {
    let component = |random: &mut Random| match random.between(0, 3) {
        0 => random.between(-3, 3),
        1 => 0,
        _ => random.between(-2 * UNIT, 2 * UNIT),
    };
    let origin = [(); 3].map(|()| random.between(-3 * UNIT, 4 * UNIT));
    let snapped = origin.map(|part| part >> 16 << 16);
    let origin = if random.chance(0.5) { snapped } else { origin };
    loop {
        let direction = [(); 3].map(|()| component(random));
        if direction != [0; 3] {
            return LatticeRay { origin, direction };
        }
    }
}

/// A ray from a point about the cube through a corner of cells of a level: where two planes are at one distance, roundings
/// decide which comes first.
pub fn through_a_corner(random: &mut Random, level: u8) -> LatticeRay {
    let origin = [(); 3].map(|()| random.between(-UNIT / 2, 3 * UNIT / 2));
    let corner = [(); 3].map(|()| random.between(0, 1 << level) * (UNIT >> level));
    LatticeRay { origin, direction: std::array::from_fn(|axis| corner[axis] - origin[axis]) }
}

/// A ray from one point to another, which is at distance 1.
#[must_use]
pub fn between(origin: DVec3, target: DVec3) -> Ray {
    Ray { origin, direction: target - origin }
}

/// What rays hit, the same for every width.
///
/// # Panics
/// If two widths differ in a bit of a hit.
#[must_use]
pub fn hits_of_every_width(octree: &Octree, rays: &[Ray]) -> Vec<Option<Hit>> {
    let hits = octree.hits(rays, Width::One);
    for width in Width::ALL {
        let others = octree.hits(rays, width);
        assert_eq!(others.len(), rays.len());
        for ((ray, hit), other) in rays.iter().zip(&hits).zip(&others) {
            assert!(same_bits(hit, other), "{ray:?}: one lane {hit:?}, {width:?} {other:?}");
        }
    }
    hits
}

/// Whether two hits are the same to the bit; distances that are not numbers are compared as bits too.
#[must_use]
pub fn same_bits(a: &Option<Hit>, b: &Option<Hit>) -> bool {
    let bits = |hit: &Hit| (hit.distance.to_bits(), hit.cell, hit.size_log2, hit.payload);
    a.as_ref().map(bits) == b.as_ref().map(bits)
}

/// Whether a finest cell is the one that was hit, or one of those that it stands for.
#[must_use]
pub fn is_of_hit(hit: &Hit, cell: [u32; 3]) -> bool {
    (0..3).all(|axis| cell[axis] >> hit.size_log2 == hit.cell[axis] >> hit.size_log2)
}
