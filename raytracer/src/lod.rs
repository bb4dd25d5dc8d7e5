//! Levels of detail: where rays end above the finest cells, because those would look smaller than asked for.
//!
//! The decision belongs to a node, not to a ray: all rays that come to a node end in its cells, in its blocks of eight
//! cells, or go on below; or at the node itself, if it is one of those to which the grid points. So rays that go together
//! stay together, and a ray knows it when it comes to a node and not at every cell.

use crate::camera::View;
use crate::lanes::Lanes;
use crate::octree::{MANTISSA, MANTISSA_BITS};

/// How large the cells may be in which rays end.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LevelOfDetail {
    /// In the traversal's space, not mirrored.
    eye: [f32; 3],
    /// Direction in which distance is measured, a unit vector.
    forward: [f32; 3],
    /// The largest cell in which a ray may end, in unit space, at distance one.
    footprint: f32,
}

impl LevelOfDetail {
    /// Rays end at the finest cells.
    pub const EXACT: Self = Self { eye: [0.0; 3], forward: [0.0; 3], footprint: 0.0 };

    /// Rays end at cells of an octree of so many levels that look no larger than `pixels`. If only the finest ones ever do,
    /// that is [`LevelOfDetail::EXACT`].
    pub fn new(view: &View, depth: u8, pixels: f64) -> Self {
        let footprint = pixels * view.pixel_size();
        let (eye, forward) = (view.eye(), view.forward());
        // To the corner of the cube that is farthest, and what single precision may add to that.
        let farthest = (-forward * eye).max(forward * (1.0 - eye)).element_sum();
        let error = 1e-6 * (forward.abs() * (eye.abs() + 2.0)).element_sum();
        let coarser_than_finest = 2.0 / f64::from(1u32 << depth);
        if footprint * (farthest + error) < coarser_than_finest {
            return Self::EXACT;
        }
        Self {
            eye: (eye + 1.0).as_vec3().to_array(),
            forward: forward.as_vec3().to_array(),
            footprint: footprint as f32,
        }
    }

    /// Whether rays end at the finest cells only.
    pub fn is_exact(&self) -> bool {
        self.footprint == 0.0
    }

    /// The largest cell in which a ray may end at distance one.
    pub fn footprint(&self) -> f32 {
        self.footprint
    }

    /// Whether rays may end above the finest cells, those of an octree of so many levels, in nodes whose points are all within a
    /// distance.
    pub fn may_end_early(&self, depth: u8, distance: f32) -> bool {
        // More than what rounding adds to the distance of a node's middle, which is about 2⁻²⁰.
        let farthest = distance + distance.abs() / 1024.0 + 1.0 / 65536.0;
        self.footprint * farthest >= 2.0 / (1u32 << depth) as f32
    }

    /// The largest cell in which rays may end in the node that holds a cell, in unit space: the footprint at the distance
    /// of the node's middle. Not above zero behind the eye.
    ///
    /// `corner` is the cell, bits of floats in [1, 2) that are mirrored where `mirror` is all ones; the node's cells are of
    /// size `1 << exponent`. Of a root of one level, only the part in the cube counts.
    #[inline(always)]
    pub fn largest_cell<L: Lanes>(
        &self,
        corner: [L::Word; 3],
        mirror: [L::Word; 3],
        exponent: L::Word,
    ) -> L::Float {
        let beyond_cube = L::greater(exponent, L::word(MANTISSA_BITS - 2));
        let exponent = L::select_word(beyond_cube, L::word(MANTISSA_BITS - 2), exponent);
        let half = L::shift_left(L::word(2), exponent);
        let within = L::sub(L::add(half, half), L::word(1));
        let along = |axis: usize| {
            let mantissa = (corner[axis] ^ mirror[axis]) & L::word(MANTISSA);
            let low = (mantissa | within) ^ within;
            let middle = L::from_bits(low | half | L::word(1f32.to_bits()));
            (middle - L::float(self.eye[axis])) * L::float(self.forward[axis])
        };
        (along(0) + along(1) + along(2)) * L::float(self.footprint)
    }
}

/// The size of cells of size `1 << exponent`, in unit space.
#[inline(always)]
pub(crate) fn size_of_cells<L: Lanes>(exponent: L::Word) -> L::Float {
    let biased = L::add(exponent, L::word(127 - MANTISSA_BITS));
    L::from_bits(L::shift_left(biased, L::word(MANTISSA_BITS)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::Camera;
    use crate::lanes::Single;
    use crate::random::Random;
    use glam::DVec3;

    /// No node within a distance in which rays cannot end early has cells above the finest that are small enough; and where they can,
    /// a node a little farther away has.
    #[test]
    fn rays_end_early_only_where_they_may() {
        let random = &mut Random::stream(13, 0);
        let mut number =
            |low: f64, high: f64| low + (high - low) * (random.next() >> 11) as f64 / 2f64.powi(53);
        let (mut never, mut sometimes) = (0, 0);
        for _ in 0..3000 {
            let depth = number(4.0, 12.0) as u8;
            let mut point = |far: f64| DVec3::from_array([0; 3].map(|_| number(-far, far + 1.0)));
            let (eye, target, low) = (point(1.0), point(0.0), point(0.0));
            let camera = Camera { eye, target, up: DVec3::new(0.1, 1.0, 0.2), vertical_fov: 40.0 };
            let view = View::new(&camera, [DVec3::ZERO, DVec3::ONE], 64, 64).unwrap();
            let lod = LevelOfDetail {
                eye: (view.eye() + 1.0).as_vec3().to_array(),
                forward: view.forward().as_vec3().to_array(),
                footprint: (2f64.powf(number(-2.0, 2.0)) / f64::from(1u32 << depth)) as f32,
            };
            // A lowest node.
            let exponent = MANTISSA_BITS - u32::from(depth);
            let size = 4.0 / f64::from(1u32 << depth);
            let low = (low.min(DVec3::splat(0.999)) / size).floor() * size;
            let corner = low.to_array().map(|at| (1.0 + at as f32).to_bits());
            let largest = lod.largest_cell::<Single>(corner, [0; 3], exponent);
            let ends = 2.0 / (1u32 << depth) as f32 <= largest;
            let of = |corner: DVec3| (corner - view.eye()).dot(view.forward());
            let corners = (0..8).map(|corner| {
                low + size * DVec3::from_array([0, 1, 2].map(|axis| f64::from(corner >> axis & 1)))
            });
            let farthest = corners.map(of).fold(f64::NEG_INFINITY, f64::max) as f32;
            if lod.may_end_early(depth, farthest) {
                sometimes += u32::from(!ends);
                let beyond = 2.0 * size as f32 + 0.01 * farthest.abs() + 0.001;
                assert!(lod.footprint * (farthest + beyond) >= 2.0 / (1u32 << depth) as f32);
            } else {
                never += 1;
                assert!(!ends, "{camera:?}, {corner:x?}, {depth}: {largest}");
            }
        }
        assert!(never > 500 && sometimes > 0, "{never}, {sometimes}");
    }

    /// Where cells above the finest are never small enough, nobody asks. If `new` says so, no node is an exception; and else
    /// there nearly is one.
    #[test]
    fn exact_is_where_no_node_is_left_early() {
        let random = &mut Random::stream(8, 0);
        let mut number =
            |low: f64, high: f64| low + (high - low) * (random.next() >> 11) as f64 / 2f64.powi(53);
        let mut exact = 0;
        for depth in [2u8, 5, 9] {
            let coarser_than_finest = 2.0 / f32::from(1u16 << depth);
            for _ in 0..300 {
                let mut point = |far: f64| DVec3::from_array([0; 3].map(|_| number(-far, far + 1.0)));
                let (eye, target) = (point(1.5), point(0.0));
                let camera = Camera { eye, target, up: DVec3::new(0.1, 1.0, 0.2), vertical_fov: 40.0 };
                let view = View::new(&camera, [DVec3::ZERO, DVec3::ONE], 64, 64).unwrap();
                let pixels = 2f64.powf(number(-6.0, 3.0)) * 64.0 / f64::from(1u32 << depth);
                let lod = LevelOfDetail::new(&view, depth, pixels);
                let forced = LevelOfDetail {
                    eye: (view.eye() + 1.0).as_vec3().to_array(),
                    forward: view.forward().as_vec3().to_array(),
                    footprint: (pixels * view.pixel_size()) as f32,
                };
                let exponent = MANTISSA_BITS - u32::from(depth);
                let corners = (0..8u32).map(|corner| {
                    let end = |axis: u32| 1f32.to_bits() + MANTISSA * (corner >> axis & 1);
                    forced.largest_cell::<Single>([end(0), end(1), end(2)], [0; 3], exponent)
                });
                let largest = corners.fold(f32::NEG_INFINITY, f32::max);
                if lod.is_exact() {
                    exact += 1;
                    assert!(largest < coarser_than_finest, "{camera:?}, {pixels} pixels: {largest}");
                } else {
                    // The corner of the cube is farther than the middle of the node there.
                    let node = 4.0 / f32::from(1u16 << depth);
                    let beyond = 2.0 * node * forced.footprint;
                    assert!(
                        largest + beyond >= coarser_than_finest,
                        "{camera:?}, {pixels} pixels: {largest}"
                    );
                }
            }
        }
        assert!((100..800).contains(&exact), "{exact} of 900");
    }
}
