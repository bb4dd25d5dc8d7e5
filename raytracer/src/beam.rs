//! Beams: how far all rays through a block of pixels can go at least before any of them can hit something.
//!
//! A beam is the pyramid from the eye through a block of pixels. It descends the octree front to back, all 64 cells of
//! a node at once, and keeps the cells that reach into the pyramid, down to cells about as wide as the beam itself;
//! the nearest corner of those gives the distance at which the rays of the block begin. A block whose beam meets
//! nothing needs no rays at all.
//!
//! Nothing is skipped that a ray could hit: a cell is dropped only if it lies wholly beyond one side of the pyramid, by
//! more than the rounding errors of that test, and the distance is that of the corner nearest to the eye, less the
//! rounding errors. (The beams of Laine and Karras, "Efficient sparse voxel octrees", 2010, section 4.3, are rays through
//! the corners of a block; a cell's corner can reach in between them.)

use crate::camera::View;
use crate::lanes::Lanes;
use crate::node::CELLS;
use crate::octree::{MANTISSA_BITS, Octree, cell_of_morton, root_exponent};
use glam::{DVec3, Vec3};

/// Pixels along the side of a block.
pub(crate) const BEAM_SIZE: u32 = 8;

/// Cells no wider than this many pixels are not opened.
const FINEST_PIXELS: f32 = 4.0;

/// Cells no wider than this many pixels are not opened on behalf of all beams of a tile.
const SEED_PIXELS: f32 = 16.0;

/// What rounding may move a cell by, in unit space, with room to spare: coordinates and distances are below 8, so an
/// operation on them errs by at most 2⁻²², and a test has fewer than a dozen.
const ROUNDING: f32 = 1.0 / (1 << 18) as f32;

/// Four sides of the pyramid, and the direction of distance.
const FORMS: usize = 5;
const DISTANCE: usize = 4;

/// A pyramid from the eye, in the traversal's space.
pub(crate) struct Beam {
    eye: Vec3,
    /// Inward unit normals of the four sides, and the direction in which distance is measured.
    forms: [Vec3; FORMS],
    /// For a side, what a cell's innermost corner adds per size; for the distance, what its nearest corner adds.
    corner: [f32; FORMS],
    flip: u32,
    /// Size of a pixel at distance one.
    pixel: f32,
}

/// A node, and where it is.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Seed {
    node: u32,
    /// Low corner of the node.
    corner: Vec3,
    /// Exponent of the size of its cells.
    exponent: u32,
}

/// A node whose cells wait to be opened.
#[derive(Clone, Copy)]
struct Waiting {
    seed: Seed,
    /// Cells not yet opened, their order turned so that the lowest bit is the nearest to the eye.
    cells: u64,
}

/// As deep as nodes can be below each other.
const LEVELS: usize = 12;

impl Beam {
    /// The beam of the pixels from `low` to `high`, columns and rows of their corners.
    pub fn new(view: &View, low: [u32; 2], high: [u32; 2]) -> Self {
        let through = |x: u32, y: u32| view.direction(f64::from(x), f64::from(y));
        let corners = [
            through(low[0], low[1]),
            through(high[0], low[1]),
            through(high[0], high[1]),
            through(low[0], high[1]),
        ];
        let middle: DVec3 = corners.iter().sum();
        let side = |number: usize| {
            let normal = corners[number].cross(corners[(number + 1) % 4]).normalize();
            (if normal.dot(middle) < 0.0 { -normal } else { normal }).as_vec3()
        };
        let forms = [side(0), side(1), side(2), side(3), view.forward().as_vec3()];
        let innermost = |form: Vec3| form.max(Vec3::ZERO).element_sum();
        let nearest = |form: Vec3| form.min(Vec3::ZERO).element_sum();
        let corner = std::array::from_fn(|number| {
            if number == DISTANCE { nearest(forms[number]) } else { innermost(forms[number]) }
        });
        // Bits of a cell's place to flip so that the place of what is nearer to the eye is lower.
        let axis = |axis: usize| if forms[DISTANCE][axis] < 0.0 { 0b1001 << axis } else { 0 };
        let flip = axis(0) | axis(1) | axis(2);
        Self { eye: view.eye().as_vec3() + 1.0, forms, corner, flip, pixel: view.pixel_size() as f32 }
    }

    /// The nodes that reach into the pyramid and have cells of at most [`SEED_PIXELS`], front to back: where the beams
    /// of a tile begin, instead of at the root.
    pub fn seeds<L: Lanes>(&self, octree: &Octree, lod_pixels: f64) -> Vec<Seed> {
        let coarsest = self.pixel * SEED_PIXELS.max(16.0 * lod_pixels as f32);
        let mut seeds = Vec::new();
        let root = Seed { node: octree.root, corner: Vec3::ONE, exponent: root_exponent(octree.depth()) };
        if octree.nodes.is_empty() {
            return seeds;
        }
        let mut no_limit = f32::INFINITY;
        self.descend::<L>(octree, root, &mut no_limit, |seed, group, _, _| {
            let stop =
                octree.nodes[seed.node as usize].is_leaf() || group.size <= coarsest * self.farthest(group);
            if stop {
                seeds.push(*seed);
            }
            stop
        });
        seeds
    }

    /// A distance before which no ray of the beam that may stop at cells of `lod_pixels` hits anything; infinite if
    /// none ever does.
    pub fn start<L: Lanes>(&self, octree: &Octree, seeds: &[Seed], lod_pixels: f64) -> f32 {
        // Four times the cells at which rays stop: whatever is opened is then larger than such cells, and so are the
        // node and the bytes that an opened cell holds.
        let finest = self.pixel * FINEST_PIXELS.max(4.0 * lod_pixels as f32);
        let mut nearest = f32::INFINITY;
        for seed in seeds {
            self.descend::<L>(octree, *seed, &mut nearest, |seed, group, cells, nearest| {
                let stop =
                    octree.nodes[seed.node as usize].is_leaf() || group.size <= finest * self.farthest(group);
                if stop {
                    // A root that is not opened may itself be where a ray stops.
                    let is_root = seed.node == octree.root;
                    *nearest = if is_root { 0.0 } else { nearest.min(self.nearest::<L>(group, cells)) };
                }
                stop
            });
        }
        if nearest == f32::INFINITY { nearest } else { (nearest - ROUNDING - nearest * ROUNDING).max(0.0) }
    }

    /// Visits the nodes below `seed`, and itself, that reach into the pyramid nearer than `limit`, front to back.
    ///
    /// `stop` gets the node, its cells in space, those that reach in, and the limit, which it may lower; the node is
    /// opened unless it says so.
    #[inline(always)]
    fn descend<L: Lanes>(
        &self,
        octree: &Octree,
        seed: Seed,
        limit: &mut f32,
        mut stop: impl FnMut(&Seed, &Group, u64, &mut f32) -> bool,
    ) {
        let mut stack: [Waiting; LEVELS] = [Waiting { seed, cells: 0 }; LEVELS];
        let mut depth = 0;
        let mut next = seed;
        loop {
            let group = Group { corner: next.corner, size: cell_size(next.exponent) };
            if self.value(DISTANCE, group.corner, 4.0 * group.size) < *limit {
                // Where the root covers one level, seven of its bytes are repetitions beyond the cube.
                let in_cube = if next.exponent + 2 > MANTISSA_BITS { 0xFF } else { u64::MAX };
                let candidates = octree.nodes[next.node as usize].cells() & in_cube;
                let cells = self.cells_within::<L>(&group, candidates, *limit);
                if cells != 0 && !stop(&next, &group, cells, limit) {
                    stack[depth] = Waiting { seed: next, cells: flipped(cells, self.flip) };
                    depth += 1;
                }
            }
            while depth > 0 && stack[depth - 1].cells == 0 {
                depth -= 1;
            }
            if depth == 0 {
                return;
            }
            let Waiting { seed, cells } = &mut stack[depth - 1];
            let place = cells.trailing_zeros() ^ self.flip;
            *cells &= *cells - 1;
            let offset = Vec3::from_array(COORDINATES.map(|axis| axis[place as usize]));
            next = Seed {
                node: octree.nodes[seed.node as usize].index_of(place),
                corner: seed.corner + offset * cell_size(seed.exponent),
                exponent: seed.exponent - 2,
            };
        }
    }

    /// No ray is farther than this in the cells of a group.
    fn farthest(&self, group: &Group) -> f32 {
        let forward = self.forms[DISTANCE];
        forward.dot(group.corner - self.eye) + 4.0 * group.size * forward.max(Vec3::ZERO).element_sum()
    }

    /// The value of a form at the corner that counts for it of a cube.
    fn value(&self, number: usize, corner: Vec3, size: f32) -> f32 {
        self.forms[number].dot(corner - self.eye) + self.corner[number] * size
    }

    /// The value of a form at the corner that counts for it of each of some cells, from number `first` on.
    #[inline(always)]
    fn values<L: Lanes>(&self, group: &Group, number: usize, first: usize) -> L::Float {
        let form = self.forms[number];
        let base = self.value(number, group.corner, group.size);
        let along = |axis: usize| L::load(&COORDINATES[axis][first..]) * L::float(form[axis] * group.size);
        along(0) + along(1) + (along(2) + L::float(base))
    }

    /// Of some cells of a group, those that reach into the pyramid at less than `limit`.
    fn cells_within<L: Lanes>(&self, group: &Group, cells: u64, limit: f32) -> u64 {
        let mut within = 0;
        for first in (0..CELLS).step_by(L::COUNT) {
            if cells >> first & (u64::MAX >> (CELLS - L::COUNT)) == 0 {
                continue;
            }
            let inside =
                |number: usize| L::at_most(L::float(-ROUNDING), self.values::<L>(group, number, first));
            let sides = inside(0) & inside(1) & inside(2) & inside(3);
            let mask = sides & L::less(self.values::<L>(group, DISTANCE, first), L::float(limit));
            within |= u64::from(L::bitmask(mask)) << first;
        }
        within & cells
    }

    /// The least distance of some cells of a group.
    fn nearest<L: Lanes>(&self, group: &Group, cells: u64) -> f32 {
        (0..CELLS).step_by(L::COUNT).fold(f32::INFINITY, |nearest, first| {
            let chosen = (cells >> first) as u32 & (u32::MAX >> (32 - L::COUNT));
            let distance = self.values::<L>(group, DISTANCE, first);
            nearest.min(if chosen == 0 { f32::INFINITY } else { L::least(distance, chosen) })
        })
    }
}

/// The 4×4×4 cells of a node in space.
struct Group {
    corner: Vec3,
    /// Size of a cell.
    size: f32,
}

/// For each axis, the coordinate of each cell's low corner in a node of unit cells.
static COORDINATES: [[f32; CELLS]; 3] = {
    let mut coordinates = [[0.0; CELLS]; 3];
    let mut place = 0;
    while place < CELLS {
        let [x, y, z] = cell_of_morton(place as u32);
        coordinates[0][place] = x as f32;
        coordinates[1][place] = y as f32;
        coordinates[2][place] = z as f32;
        place += 1;
    }
    coordinates
};

/// The size of cells of an exponent, in unit space.
fn cell_size(exponent: u32) -> f32 {
    f32::from_bits((127 - MANTISSA_BITS + exponent) << MANTISSA_BITS)
}

/// Moves bit `place` to `place ^ flip`.
fn flipped(mut cells: u64, flip: u32) -> u64 {
    const LOWER: [u64; 6] = [
        0x5555_5555_5555_5555,
        0x3333_3333_3333_3333,
        0x0F0F_0F0F_0F0F_0F0F,
        0x00FF_00FF_00FF_00FF,
        0x0000_FFFF_0000_FFFF,
        0x0000_0000_FFFF_FFFF,
    ];
    for (bit, lower) in LOWER.into_iter().enumerate() {
        if flip >> bit & 1 == 1 {
            cells = (cells & lower) << (1 << bit) | cells >> (1 << bit) & lower;
        }
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flipping_moves_each_bit() {
        for flip in 0..64 {
            for place in 0..64 {
                assert_eq!(flipped(1 << place, flip), 1 << (place ^ flip));
            }
        }
    }

    #[test]
    fn the_size_of_a_cell_is_a_power_of_two() {
        assert_eq!(cell_size(MANTISSA_BITS), 1.0);
        assert_eq!(cell_size(MANTISSA_BITS - 10), 1.0 / 1024.0);
    }
}
