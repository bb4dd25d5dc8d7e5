//! Beams: the pyramid of all rays through a block of pixels, held against the cells of a node at once.
//!
//! The rays of a block see much the same part of the octree. So the way down to the nodes that they meet is walked once
//! for all of them ([`crate::bundle`]); a beam says which cells of a node are worth opening. A cell is dropped only if it
//! lies wholly beyond one side of the pyramid, by more than the rounding errors of that test: nothing is skipped that
//! a ray could hit. That is reckoned in single precision, whatever the arithmetic of the rays: the test allows for its own
//! rounding of the pyramid, and for rays that lie beside the pyramid by as much as directions in single precision do. Those in
//! double precision are within it but for 2⁻⁵⁰, so they need less of that room. (The beams of Laine and Karras, "Efficient sparse voxel octrees", 2010, section 4.3, are rays through
//! the corners of a block; a cell's corner can reach in between them.)

use crate::camera::View;
use crate::lanes::{Lanes, Real, Single, prefetch};
use crate::lod::size_of_cells;
use crate::node::{CELLS, Node};
use crate::octree::{MANTISSA, MANTISSA_BITS, Octree, cell_of_morton, root_exponent};
use crate::ray::in_traversal_space;
use crate::traversal::Target;
use glam::{DVec3, Vec3};

/// Pixels along the side of a block.
pub(crate) const BEAM_SIZE: u32 = 8;

/// Cells no wider than this many pixels are not opened on behalf of all beams of a tile.
const SEED_PIXELS: f32 = 16.0;

/// What rounding may move a cell by, in unit space, with room to spare: coordinates and distances are below 8, so an
/// operation on them errs by at most 2⁻²², and a test has fewer than a dozen.
const ROUNDING: f32 = 1.0 / (1 << 18) as f32;

const SIDES: usize = 4;

/// A pyramid from the eye, in the traversal's space, not mirrored.
pub(crate) struct Beam {
    eye: Vec3,
    /// The eye in unit space.
    eye_in_unit: DVec3,
    /// Inward normals of the four sides.
    sides: [Vec3; SIDES],
    /// What rounding may add to the distance from a side, times the length of its normal.
    margin: f32,
    /// Direction in which distance is measured.
    forward: Vec3,
    /// For each side, how far inside it the innermost corner of each cell is, for a node at the eye of unit cells.
    innermost: [[f32; CELLS]; SIDES],
    /// Axes along which no ray runs towards smaller coordinates, if the others are those along which none runs towards
    /// larger ones.
    mirrored: Option<[bool; 3]>,
    /// Size of a pixel at distance one.
    pixel: f32,
}

impl Beam {
    /// The beam of the square of `size` pixels whose upper left corner is `low`, and of `margin` pixels around it.
    pub fn new<L: Lanes>(view: &View, low: [u32; 2], size: u32, margin: f64) -> Self {
        let [left, top] = low.map(|low| f64::from(low) - margin);
        let [right, bottom] = low.map(|low| f64::from(low + size) + margin);
        let [of_left, of_top] = view.column_and_row_normals([left, top]);
        let [of_right, of_bottom] = view.column_and_row_normals([right, bottom]);
        let normals = [of_left, -of_right, of_top, -of_bottom];
        let longest = normals.iter().map(|normal| normal.length_squared()).fold(1.0, f64::max);
        let sides = normals.map(|normal| normal.as_vec3());

        let corners = [[left, top], [right, top], [left, bottom], [right, bottom]];
        let corners = corners.map(|[x, y]| view.direction(x, y));
        let upwards = |axis: usize| corners.iter().all(|corner| corner[axis] >= 0.0);
        let downwards = |axis: usize| corners.iter().all(|corner| corner[axis] <= 0.0);
        let is_one_way = (0..3).all(|axis| upwards(axis) || downwards(axis));
        let forward = view.forward().as_vec3();
        Self {
            eye: view.eye().as_vec3() + 1.0,
            eye_in_unit: view.eye(),
            sides,
            // The square of what is at least 1 is no less than it.
            margin: ROUNDING * longest as f32,
            forward,
            innermost: innermost_corners::<L>(&sides),
            mirrored: is_one_way.then(|| [upwards(0), upwards(1), upwards(2)]),
            pixel: view.pixel_size() as f32,
        }
    }

    /// Axes along which no ray runs towards smaller coordinates, if the others are those along which none runs towards
    /// larger ones.
    pub fn mirrored(&self) -> Option<[bool; 3]> {
        self.mirrored
    }

    /// The origin of all rays, in mirrored space, as packets have it.
    pub fn mirrored_eye<R: Real>(&self, mirrored: [bool; 3]) -> [R; 3] {
        let origin = in_traversal_space(self.eye_in_unit);
        std::array::from_fn(|axis| {
            let [plain, reflected] = origin[axis];
            if mirrored[axis] { reflected } else { plain }
        })
    }

    /// Which of some cells of a node may reach into the pyramid: bit `c` is cell `c`.
    #[inline(always)]
    pub fn cells_within<L: Lanes>(&self, node: &PlacedNode, cells: u64) -> u64 {
        let offset = node.low_corner() - self.eye;
        // Sizes are powers of two, so nothing is lost by measuring in cells.
        let per_size = 1.0 / node.cell_size();
        let mut least = [0.0; SIDES];
        for (least, side) in least.iter_mut().zip(&self.sides) {
            *least = (-self.margin - side.dot(offset)) * per_size;
        }
        let mut within = 0;
        for first in (0..CELLS).step_by(L::COUNT) {
            let inside =
                |side: usize| L::at_most(L::float(least[side]), L::load(&self.innermost[side][first..]));
            let mask = inside(0) & inside(1) & inside(2) & inside(3);
            within |= u64::from(L::bitmask(mask)) << first;
        }
        within & cells & node.in_cube()
    }

    /// Whether a node may reach into the pyramid.
    #[inline(always)]
    pub fn meets(&self, node: &PlacedNode) -> bool {
        let offset = node.low_corner() - self.eye;
        let size = 4.0 * node.cell_size();
        self.sides
            .iter()
            .all(|side| side.dot(offset) + side.max(Vec3::ZERO).element_sum() * size >= -self.margin)
    }

    /// The largest distance of a point in a node, by less than the rounding error too much.
    #[inline(always)]
    pub fn farthest(&self, node: &PlacedNode) -> f32 {
        let offset = node.low_corner() - self.eye;
        let size = 4.0 * node.cell_size();
        self.forward.dot(offset) + self.forward.max(Vec3::ZERO).element_sum() * size + ROUNDING
    }

    /// The size of a pixel at some distance.
    pub fn pixel_at(&self, distance: f32) -> f32 {
        self.pixel * distance
    }

    /// The nodes that reach into the pyramid and have cells of at most [`SEED_PIXELS`], front to back: where the beams
    /// of a tile begin, instead of at the root. Only the root, if the beams of the tile do not go the same way.
    pub fn seeds<L: Lanes>(&self, target: &Target<'_>, descent: &mut Descent) -> Vec<PlacedNode> {
        let nodes = &target.octree.nodes;
        let mut seeds = Vec::new();
        if nodes.is_empty() {
            return seeds;
        }
        let root = PlacedNode::root(target.octree);
        let Some(mirrored) = self.mirrored else { return vec![root] };
        // Cells four times as large as those at which rays stop: no ray stops at what is opened.
        let coarsest = (SEED_PIXELS * self.pixel).max(4.0 * target.lod.footprint());
        descent.begin(mirrored);
        let mut next = Some(root);
        while let Some(node) = next {
            let content = &nodes[node.index as usize];
            let cells = self.cells_within::<L>(&node, content.cells());
            if content.is_leaf() || node.cell_size() <= coarsest * self.farthest(&node) {
                if cells != 0 {
                    seeds.push(node);
                }
            } else {
                descent.push(node, cells);
            }
            next = descent.next(nodes);
        }
        seeds
    }
}

/// For each side, how far inside it the innermost corner of each cell is, for a node at the origin of unit cells.
#[inline(always)]
fn innermost_corners<L: Lanes>(sides: &[Vec3; SIDES]) -> [[f32; CELLS]; SIDES] {
    let of = |side: Vec3| form_of_cells::<L>(side, side.max(Vec3::ZERO).element_sum());
    [of(sides[0]), of(sides[1]), of(sides[2]), of(sides[3])]
}

/// A linear form at the low corner of each cell of a node at the origin of unit cells, and a constant.
#[inline(always)]
fn form_of_cells<L: Lanes>(form: Vec3, constant: f32) -> [f32; CELLS] {
    let mut values = [0.0; CELLS];
    for first in (0..CELLS).step_by(L::COUNT) {
        let along = |axis: usize| L::load(&COORDINATES[axis][first..]) * L::float(form[axis]);
        L::store(along(0) + along(1) + (along(2) + L::float(constant)), &mut values[first..]);
    }
    values
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

/// A node, and where it is.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PlacedNode {
    /// Index of the node.
    pub index: u32,
    /// Its low corner: the bits of a float in [1, 2) per axis.
    pub corner: [u32; 3],
    /// Its cells are of size `1 << exponent` in units of the mantissa.
    pub exponent: u32,
}

impl PlacedNode {
    /// The root of an octree that is not empty.
    pub fn root(octree: &Octree) -> Self {
        const LOWEST: u32 = 1.0f32.to_bits();
        Self { index: octree.root, corner: [LOWEST; 3], exponent: root_exponent(octree.depth()) }
    }

    /// The size of its cells, in unit space.
    pub fn cell_size(&self) -> f32 {
        size_of_cells::<Single>(self.exponent)
    }

    /// Whether it is a root of one level, of which only the first byte is in the cube.
    pub fn is_half(&self) -> bool {
        self.exponent + 2 > MANTISSA_BITS
    }

    /// The cells that are in the cube.
    pub fn in_cube(&self) -> u64 {
        if self.is_half() { 0xFF } else { u64::MAX }
    }

    /// Where it is in mirrored space.
    #[inline(always)]
    pub fn mirrored(&self, mirrored: [bool; 3]) -> Self {
        let within = (4 << self.exponent) - 1;
        let corner = std::array::from_fn(|axis| {
            let corner = self.corner[axis];
            if mirrored[axis] { (corner ^ MANTISSA) & !within } else { corner }
        });
        Self { corner, ..*self }
    }

    fn low_corner(&self) -> Vec3 {
        Vec3::from_array(self.corner.map(f32::from_bits))
    }

    /// The child node in filled cell `place`.
    fn child(&self, nodes: &[Node], place: u32) -> Self {
        let offset = cell_of_morton(place);
        Self {
            index: nodes[self.index as usize].index_of(place),
            corner: std::array::from_fn(|axis| self.corner[axis] + (offset[axis] << self.exponent)),
            exponent: self.exponent - 2,
        }
    }
}

/// The way down from node to node, front to back for rays that go one way.
#[derive(Default)]
pub(crate) struct Descent {
    flip: u32,
    /// Nodes whose cells are visited one after the other, and those not yet visited, in the order of mirrored space.
    waiting: Vec<(PlacedNode, u64)>,
}

impl Descent {
    /// Begins anew, for rays that run towards larger coordinates on the mirrored axes.
    pub fn begin(&mut self, mirrored: [bool; 3]) {
        self.flip = mirrored_places(mirrored);
        self.waiting.clear();
    }

    /// What to flip in the place of a cell to get its place in mirrored space.
    pub fn flip(&self) -> u32 {
        self.flip
    }

    /// Opens some of the filled cells of an inner node, before those that wait already.
    #[inline(always)]
    pub fn push(&mut self, node: PlacedNode, cells: u64) {
        if cells != 0 {
            self.waiting.push((node, flipped(cells, self.flip)));
        }
    }

    /// The next node on the way.
    #[inline(always)]
    pub fn next(&mut self, nodes: &[Node]) -> Option<PlacedNode> {
        let (node, cells) = self.waiting.last_mut()?;
        // In mirrored space coordinates fall along every ray, so cells are met from the last one on.
        let last = cells.ilog2();
        *cells ^= 1 << last;
        let child = node.child(nodes, last ^ self.flip);
        if *cells == 0 {
            self.waiting.pop();
        } else {
            let next = cells.ilog2() ^ self.flip;
            prefetch(nodes, nodes[node.index as usize].index_of(next));
        }
        Some(child)
    }
}

/// What to flip in the place of a cell to get its place in mirrored space.
pub(crate) fn mirrored_places(mirrored: [bool; 3]) -> u32 {
    (0..3).filter(|&axis| mirrored[axis]).map(|axis| 0b1001 << axis).sum()
}

/// For each bit of a place, the places in which it is 0.
pub(crate) const LOWER_BITS: [u64; 6] = [
    0x5555_5555_5555_5555,
    0x3333_3333_3333_3333,
    0x0F0F_0F0F_0F0F_0F0F,
    0x00FF_00FF_00FF_00FF,
    0x0000_FFFF_0000_FFFF,
    0x0000_0000_FFFF_FFFF,
];

/// Moves bit `place` to `place ^ flip`.
pub(crate) fn flipped(mut cells: u64, flip: u32) -> u64 {
    for (bit, lower) in LOWER_BITS.into_iter().enumerate() {
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
        let node = |exponent| PlacedNode { index: 0, corner: [0; 3], exponent };
        assert_eq!(node(MANTISSA_BITS).cell_size(), 1.0);
        assert_eq!(node(MANTISSA_BITS - 10).cell_size(), 1.0 / 1024.0);
    }
}
