//! Levels of detail: where rays end above the finest cells, because those would look smaller than asked for.
//!
//! The decision belongs to a node, not to a ray: all rays that come to a node end in its cells, in its blocks of eight
//! cells, or go on below; or at the node itself, if it is one of those to which the grid points. So rays that go together
//! stay together, and a ray knows it when it comes to a node and not at every cell.

use crate::camera::View;
use crate::lanes::Lanes;
use crate::octree::MANTISSA_BITS;

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

    /// Rays end at cells that look no larger than `pixels`.
    pub fn new(view: &View, pixels: f64) -> Self {
        Self {
            eye: (view.eye() + 1.0).as_vec3().to_array(),
            forward: view.forward().as_vec3().to_array(),
            footprint: (pixels * view.pixel_size()) as f32,
        }
    }

    /// The largest cell in which a ray may end at distance one.
    pub fn footprint(&self) -> f32 {
        self.footprint
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
            let mantissa = (corner[axis] ^ mirror[axis]) & L::word((1 << MANTISSA_BITS) - 1);
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
