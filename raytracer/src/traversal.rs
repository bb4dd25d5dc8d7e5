//! The walk of a packet through the octree, written once for every number of lanes.
//!
//! **Integers decide where, floats only decide how far.** A cell is kept as the bits of its low corner, three floats in
//! [1, 2), so that its coordinates are runs of mantissa bits. All that is ever asked of a ray is the *distance to a plane*
//!
//! ```text
//! T(axis, plane) = (plane − origin) / −slope
//! ```
//!
//! and the ray crosses the planes of all axes in the order of (T, axis). How T is rounded is [`crate::Arithmetic`]: twice in
//! single precision, as a product with a reciprocal, or once in double. Rounding keeps the order of the planes of one
//! axis, so this alone defines a walk from cell to cell through faces; no point on the ray is ever computed. It follows
//! that
//!
//! - a box of cells is visited if and only if the last of the planes by which it is entered comes before the first of those
//!   by which it is left: whatever is skipped on the way (empty cells of any size, a grid, a start further on), the
//!   same cells are visited, and the result is the same to the last bit;
//! - a ray cannot slip through a 6-separating surface, it cannot stand still, and its way is bounded by the resolution.
//!
//! Exactly which cells a ray visits, ties included, is defined in [`crate::oracle`]. With double precision they are the same on
//! a lattice.
//!
//! In the mirrored space of [`Packet`] every coordinate falls along the ray, and a cell is left through its low
//! faces.

use crate::camera::View;
use crate::grid::{self, Grid};
use crate::lanes::{Lanes, each};
use crate::lod::{LevelOfDetail, size_of_cells};
use crate::node::{LEAF, Node, UNIFORM};
use crate::octree::{MANTISSA_BITS, Octree, finest_exponent, root_exponent};
use crate::ray::Packet;

/// What the rays of a packet met.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Hits<L: Lanes> {
    /// Lanes whose ray met a filled cell.
    pub hit: L::Mask,
    /// Distance to the point where the ray enters that cell, in the packet's units.
    pub distance: L::Float,
    /// Index of the node that holds the cell.
    pub node: L::Word,
    /// Which part of the node: see [`part`].
    pub part: L::Word,
    /// The cell is of size `1 << exponent` in units of the mantissa.
    pub exponent: L::Word,
    /// Cells that the ray has visited, or nodes where it went on from filled cell to filled cell, if they were counted.
    pub steps: L::Word,
    /// How often some ray of the packet has visited a cell, if that was counted.
    pub packet_steps: u32,
    /// Lanes that were stopped by the bound on the number of steps. There are none.
    pub guarded: L::Mask,
}

/// What [`Hits::part`] says: a cell of the node, one of its octree cells of the level between, or itself.
pub(crate) mod part {
    /// Cells `0..64`, in Morton order.
    pub const CELLS: u32 = 64;
    /// Bytes of the mask follow: `64..72`.
    pub const NODE: u32 = CELLS + 8;
}

/// Bits of the float 1: the lower end of the cube.
const ONE_BITS: u32 = 0x3F80_0000;

/// Nodes of the packet's lanes, their words read.
#[derive(Clone, Copy)]
struct Current<L: Lanes> {
    index: L::Word,
    low: L::Word,
    high: L::Word,
    contents: L::Word,
    /// Exponent of the size of the node's cells.
    exponent: L::Word,
}

/// The sizes of cells, which levels of detail are decided by: in single precision whatever the arithmetic.
type Size<L> = <<L as Lanes>::Rough as Lanes>::Float;

/// Levels of nodes, one for each two bits of the mantissa.
pub(crate) const PATH_LEVELS: usize = 12;

/// The nodes that the rays of a packet have come down through, by half their exponent: room for a traversal, to be
/// used for one packet after the other.
pub(crate) struct Path<L: Lanes> {
    nodes: [Current<L>; PATH_LEVELS],
}

impl<L: Lanes> Path<L> {
    pub fn new() -> Self {
        Self { nodes: [Current::none(); PATH_LEVELS] }
    }
}

impl<L: Lanes> Current<L> {
    fn none() -> Self {
        let zero = L::word(0);
        Self { index: zero, low: zero, high: zero, contents: zero, exponent: zero }
    }

    /// Takes the nodes of `other` where the mask is true, but for their exponents.
    #[inline(always)]
    fn replace(&mut self, other: &Self, mask: L::Mask) {
        self.index = L::select_word(mask, other.index, self.index);
        self.low = L::select_word(mask, other.low, self.low);
        self.high = L::select_word(mask, other.high, self.high);
        self.contents = L::select_word(mask, other.contents, self.contents);
    }

    /// Goes to other nodes where the mask is true.
    ///
    /// # Safety
    /// In each lane where the mask is true, `index` is the index of a node in `nodes`, which are some.
    #[inline(always)]
    unsafe fn go(&mut self, nodes: &[Node], index: L::Word, exponent: L::Word, mask: L::Mask) {
        self.index = L::select_word(mask, index, self.index);
        self.exponent = L::select_word(mask, exponent, self.exponent);
        let rows: &[[u32; 4]] = bytemuck::cast_slice(nodes);
        // SAFETY: a node is a row, and the caller promises that it is there.
        let [low, high, contents, _] =
            unsafe { L::gather_rows(rows, index, mask, [self.low, self.high, self.contents, index]) };
        [self.low, self.high, self.contents] = [low, high, contents];
    }

    /// Whether rays end in the node's cells, or in those `levels` above, if cells up to a size are small enough. In a node
    /// of one voxel they end anyway.
    #[inline(always)]
    fn ends(&self, levels: u32, largest: Size<L>) -> L::Mask {
        let size = size_of_cells::<L::Rough>(L::add(self.exponent, L::word(levels)));
        L::Rough::at_most(size, largest) & !L::test(self.contents, L::word(UNIFORM))
    }

    /// Makes a node that has just been come to into a leaf, where cells up to a size are small enough for it: one of its
    /// cells, or one of its blocks of eight, which are filled wholly then.
    #[inline(always)]
    fn end_early(&mut self, largest: Size<L>, lanes: L::Mask) {
        let by_cell = lanes & self.ends(0, largest);
        if !L::any(by_cell) {
            return;
        }
        self.contents = L::select_word(by_cell, L::word(LEAF), self.contents);
        let by_block = lanes & self.ends(1, largest);
        if L::any(by_block) {
            self.low = L::select_word(by_block, fill_bytes::<L>(self.low), self.low);
            self.high = L::select_word(by_block, fill_bytes::<L>(self.high), self.high);
        }
    }
}

/// All bits of those bytes of which one is set.
#[inline(always)]
pub(crate) fn fill_bytes<L: Lanes>(word: L::Word) -> L::Word {
    let below_top = L::word(0x7F7F_7F7F);
    let top = (L::add(word & below_top, below_top) | word) & L::word(0x8080_8080);
    top | L::sub(top, L::shift_right(top, L::word(7)))
}

/// An octree, and how rays see it.
#[derive(Clone, Copy)]
pub(crate) struct Target<'a> {
    pub octree: &'a Octree,
    /// The cells in which rays start, one of the octree's grids.
    pub grid: &'a Grid,
    /// Where rays end above the finest cells.
    pub lod: LevelOfDetail,
}

impl<'a> Target<'a> {
    /// An octree as a camera in its unit space sees it, with rays that end at cells that look no larger than `lod_pixels`.
    pub fn new(octree: &'a Octree, view: &View, lod_pixels: f64) -> Self {
        let lod = LevelOfDetail::new(view, octree.depth(), lod_pixels);
        let grid = octree.entrance(f64::from(lod.footprint()) * view.nearest());
        Self { octree, grid, lod }
    }
}

/// Follows each ray of the packet to the first filled cell; also gives a place in each cell that was met: the bits of a
/// mirrored float in [1, 2) per axis.
///
/// With `LOD`, a ray stops at the first filled cell that is no larger than the target's level of detail allows in its node,
/// and no larger than the nodes to which the grid points. With `COUNT`, it counts the cells that each ray visits.
#[inline(never)]
pub(crate) fn trace<L: Lanes, const LOD: bool, const COUNT: bool>(
    target: &Target<'_>,
    packet: &Packet<L>,
    path: &mut Path<L>,
) -> (Hits<L>, [L::Word; 3]) {
    walk::<L, LOD, COUNT, false>(target, packet, path)
}

/// As [`trace`], for rays that end somewhere.
#[inline(never)]
pub(crate) fn trace_to_end<L: Lanes, const LOD: bool, const COUNT: bool>(
    target: &Target<'_>,
    packet: &Packet<L>,
    path: &mut Path<L>,
) -> (Hits<L>, [L::Word; 3]) {
    walk::<L, LOD, COUNT, true>(target, packet, path)
}

/// The walk itself. With `ANY`, rays stop at their end too.
#[inline(always)]
fn walk<L: Lanes, const LOD: bool, const COUNT: bool, const ANY: bool>(
    target: &Target<'_>,
    packet: &Packet<L>,
    path: &mut Path<L>,
) -> (Hits<L>, [L::Word; 3]) {
    let Target { octree, grid, lod } = target;
    if octree.nodes.is_empty() {
        return (Hits::none(), [L::word(0); 3]);
    }
    // Cells above the finest reach beyond the box around those.
    let [low, high] = if LOD { [[1.0; 3], [2.0; 3]] } else { octree.bounds.corners(octree.depth) };
    let mirrored = packet.mirrored();
    let near = each(|axis| L::select(mirrored[axis], L::float(3.0 - low[axis]), L::float(high[axis])));
    let far = each(|axis| L::select(mirrored[axis], L::float(3.0 - high[axis]), L::float(low[axis])));
    let to = |planes: [L::Float; 3]| each(|axis| packet.distance_to(axis, planes[axis]));
    let visit = Visit::new(packet, to(near), to(far));
    let zero = L::word(0);
    let one = L::word(1);
    let mut hits = Hits::none();
    let mut place = [zero; 3];
    let grid_level = grid.level();
    let grid_exponent = MANTISSA_BITS - grid_level;
    let grid_mask = L::word((1 << grid_level) - 1);
    let root_exponent = root_exponent(octree.depth);
    // The lower bit of each pair that selects a cell of some node. Bit 0 is there so that a word is never zero.
    let digits = L::word(if root_exponent % 2 == 1 { 0x00AA_AAAB } else { 0x0055_5555 });
    // Morton order of the cells in mirrored space to that of the cells in the node.
    let mirror = packet.mirror;
    let mirrored_cell = (mirror[0] & L::word(0b00_1001))
        | (mirror[1] & L::word(0b01_0010))
        | (mirror[2] & L::word(0b10_0100));

    let mut active = visit.visits & packet.active;
    if ANY {
        active = active & L::less(visit.distance, packet.lines.end);
    }
    let Visit { mut distance, mut reached, .. } = visit;
    let mut corner = visit.find_cell(packet, near, far, grid_exponent);
    let mut current = Current::none();
    let node_exponent = grid.node_exponent();
    let leaving_grid_cell = L::word(1 << grid_exponent);
    // Where the root covers one level, and is the only node, no more than that is in the cube.
    let node_levels = L::word(if octree.depth == 1 { 1 } else { 2 });
    // Only the nodes on the way from the entrance to the finest are returned to.
    let path_levels = (finest_exponent(octree.depth) >> 1) + 1..(node_exponent >> 1) + 1;
    let mut fresh = active;
    // Each step leaves a cell for good, and a ray crosses at most this many.
    let mut steps_left = 3u32 << octree.depth;

    while L::any(active) {
        if L::any(fresh) {
            let coordinate: [L::Word; 3] =
                each(|axis| L::shift_right(corner[axis] ^ mirror[axis], L::word(grid_exponent)) & grid_mask);
            let cell = coordinate[0]
                | L::shift_left(coordinate[1], L::word(grid_level))
                | L::shift_left(coordinate[2], L::word(2 * grid_level));
            let kept = [current.low, current.high, current.contents, current.index];
            // SAFETY: each coordinate is below the grid's size, so the index is below its cube, the length of
            // the table.
            let entry = unsafe { L::gather_rows(grid.cells(), cell, fresh, kept) };
            [current.low, current.high, current.contents, current.index] = entry;
            let empty = L::test(current.index, L::word(grid::EMPTY)) & fresh;
            let found = fresh & !empty;
            // As in a node of that size in which nothing is.
            let cells_of_empty = L::sub(current.index & L::word(!grid::EMPTY), L::word(2));
            let exponent = L::select_word(empty, cells_of_empty, L::word(node_exponent));
            current.exponent = L::select_word(fresh, exponent, current.exponent);
            if LOD {
                let largest = lod.largest_cell::<L::Rough>(corner, mirror, current.exponent);
                let whole = found & current.ends(2, largest);
                hits.record(whole, distance, &current, L::word(part::NODE), L::word(2));
                settle::<L>(&mut place, corner, whole);
                active = active & !whole;
                current.end_early(largest, found);
            }
            for bit in (node_exponent..grid_exponent).rev() {
                refine(packet, &mut corner, L::word(1 << bit), reached, found);
            }
        }

        // Down to the first empty cell on the way, or to a filled one at which the ray ends.
        let mut digit: [L::Word; 3];
        let mut cell;
        let mut half;
        loop {
            digit = each(|axis| L::shift_right(corner[axis], current.exponent));
            cell = (L::spread::<0>(digit[0]) | L::spread::<1>(digit[1]) | L::spread::<2>(digit[2]))
                ^ mirrored_cell;
            let upper = L::test(cell, L::word(32));
            half = L::select_word(upper, current.high, current.low);
            let bit = L::bit(cell);
            let filled = L::test(half, bit) & active;
            let leaf = L::test(current.contents, L::word(LEAF));
            let stop = filled & leaf;
            if L::any(stop) {
                // Where all cells are one voxel, the first stands for it.
                let uniform = L::test(current.contents, L::word(UNIFORM));
                let mut part = L::select_word(uniform, zero, cell);
                let mut levels_up = zero;
                if LOD {
                    let blocks =
                        current.ends(1, lod.largest_cell::<L::Rough>(corner, mirror, current.exponent));
                    let block = L::add(L::shift_right(cell, L::word(3)), L::word(part::CELLS));
                    part = L::select_word(blocks, block, part);
                    levels_up = L::select_word(blocks, one, zero);
                }
                hits.record(stop, distance, &current, part, levels_up);
                settle::<L>(&mut place, corner, stop);
                active = active & !stop;
            }
            let descend = filled & active;
            if !L::any(descend) {
                break;
            }
            let level = L::shift_right(current.exponent, one);
            L::for_each_level(path_levels.clone(), level, descend, |level, mask| {
                path.nodes[level].replace(&current, mask);
            });
            let before = L::count_ones(half & L::sub(bit, one));
            let before = L::select_word(upper, L::add(before, L::count_ones(current.low)), before);
            let child = L::add(current.contents, before);
            let exponent = L::sub(current.exponent, L::word(2));
            // SAFETY: the node is an inner one, so its contents are the index of its first child, and the cell is
            // filled, so its child is there.
            unsafe { current.go(&octree.nodes, child, exponent, descend) };
            refine_twice(packet, &mut corner, L::bit(exponent), reached, descend);
            if LOD {
                let largest = lod.largest_cell::<L::Rough>(corner, mirror, current.exponent);
                current.end_early(largest, descend);
            }
        }
        if !L::any(active) {
            break;
        }

        // Out of the empty cell, or of the eight if they are all empty, or of the node if nothing in it is ahead.
        let byte = L::shift_right(half, cell & L::word(24));
        let eight = !L::test(byte, L::word(0xFF));
        let [ahead_low, ahead_high] = L::cells_ahead(digit, mirror);
        let ahead = (current.low & ahead_low) | (current.high & ahead_high);
        let whole = !L::test(ahead, L::word(u32::MAX));
        let size_exponent = L::select_word(eight, L::add(current.exponent, one), current.exponent);
        let size_exponent = L::select_word(whole, L::add(current.exponent, node_levels), size_exponent);
        let within = L::sub(L::bit(size_exponent), one);
        let low: [L::Word; 3] = each(|axis| (corner[axis] | within) ^ within);
        let plane: [L::Float; 3] = each(|axis| packet.distance_to(axis, L::from_bits(low[axis])));
        // Zeros of either sign become +0.
        distance = L::abs(L::min(L::min(plane[0], plane[1]), plane[2]));
        let [later_x, later_y] = [0, 1].map(|axis| L::less(distance, plane[axis]));
        let through_x = L::same(plane[0], distance);
        let through_y = L::same(plane[1], distance) & later_x;
        let through_z = later_x & later_y;
        let through = [through_x, through_y, through_z];
        // At this very distance, planes of an earlier axis have been crossed already.
        let above = L::next_up(distance);
        let first_reached = reached;
        reached = [L::select(through_x, distance, above), L::select(through_z, above, distance), distance];
        if L::any(L::same(distance, packet.lines.start)) {
            // Mirrored planes at the very start have been crossed there, whatever their axis.
            reached = each(|axis| L::max(reached[axis], first_reached[axis]));
        }
        if COUNT {
            hits.steps = L::select_word(active, L::add(hits.steps, one), hits.steps);
            hits.packet_steps += 1;
        }
        if ANY {
            active = active & L::less(distance, packet.lines.end);
        }

        // The lowest node that holds both cells is found in the bits that changed: all up to some place.
        let left = L::select_word(through_x, low[0], L::select_word(through_y, low[1], low[2]));
        active = active & !L::same_word(left, L::word(ONE_BITS));
        let changed = left ^ L::sub(left, one);
        fresh = L::test(changed, leaving_grid_cell) & active;
        let ancestor = L::highest_bit(changed & digits);
        let leaves = L::greater(ancestor, current.exponent);
        let ascend = leaves & active & !fresh;
        let beyond: [L::Word; 3] =
            each(|axis| L::select_word(through[axis], L::sub(low[axis], one), low[axis]));
        // Within the node, the next cell is one of eight again.
        let stay = eight & !leaves & !fresh;
        let cell_size = L::bit(current.exponent);
        let within = L::sub(cell_size, one);
        let upper: [L::Word; 3] = each(|axis| ((beyond[axis] | within) ^ within) | cell_size);
        let is_upper: [L::Mask; 3] = each(|axis| stay & packet.is_ahead(axis, upper[axis], &reached));
        if L::any(ascend) {
            L::for_each_level(path_levels.clone(), L::shift_right(ancestor, one), ascend, |level, mask| {
                current.replace(&path.nodes[level], mask);
            });
            current.exponent = L::select_word(ascend, ancestor, current.exponent);
        }
        let exponent = L::select_word(fresh, L::word(grid_exponent), current.exponent);
        let within = L::sub(L::bit(exponent), one);
        corner = each(|axis| L::select_word(is_upper[axis], upper[axis], (beyond[axis] | within) ^ within));
        if L::any(fresh) {
            // Out of an empty cell that may be larger than those of the grid.
            let size = L::bit(size_exponent);
            let from_afar = fresh & L::greater(size_exponent, L::word(grid_exponent));
            if L::any(from_afar) {
                corner = each(|axis| {
                    let highest = L::add(low[axis], L::sub(size, one));
                    let range = [L::from_bits(low[axis]), L::from_bits(highest)];
                    let coordinate = locate(packet, axis, distance, reached[axis], range, grid_exponent);
                    L::select_word(from_afar & !through[axis], coordinate, corner[axis])
                });
            }
        }

        steps_left -= 1;
        if steps_left == 0 {
            hits.guarded = active;
            break;
        }
    }
    (hits, place)
}

/// How rays come into a box.
pub(crate) struct Visit<L: Lanes> {
    /// Lanes whose ray does.
    pub visits: L::Mask,
    /// Distance at which it does, or at which it begins.
    pub distance: L::Float,
    /// Per axis, planes within the box that are nearer than this have been crossed when the ray comes in.
    pub reached: [L::Float; 3],
    /// Axes through whose high plane it comes in.
    through: [L::Mask; 3],
}

impl<L: Lanes> Visit<L> {
    /// For a box whose high planes are at the distances `enter` and whose low ones are at `leave`.
    #[inline(always)]
    pub fn new(packet: &Packet<L>, enter: [L::Float; 3], leave: [L::Float; 3]) -> Self {
        let start = packet.lines.start;
        let mirrored = packet.mirrored();
        // Zeros of either sign become +0.
        let distance = L::abs(L::max(L::max(enter[0], enter[1]), L::max(enter[2], start)));
        let last = L::min(L::min(leave[0], leave[1]), leave[2]);
        // Of the cells about its origin a ray begins in the upper ones. So where it begins on a high face of the box, it
        // comes in through that face, if it goes down; and where it begins on a low one, it is inside.
        let at_start = !L::less(start, distance);
        let through = each(|axis| L::same(enter[axis], distance) & !(at_start & mirrored[axis]));

        let mut visits = L::less(distance, last);
        let touching = L::same(distance, last);
        if L::any(touching) {
            // A single point of the box: the ray is in it if it comes in before it goes out, and does not begin beyond.
            let out: [L::Mask; 3] = each(|axis| L::same(leave[axis], last));
            let leaves_first = (out[0] & (through[1] | through[2])) | (out[1] & through[2]);
            let begins_beyond =
                at_start & ((out[0] & mirrored[0]) | (out[1] & mirrored[1]) | (out[2] & mirrored[2]));
            visits = visits | (touching & !leaves_first & !begins_beyond);
        }

        // At the very distance, a plane has been crossed if its axis comes before the last one through which the ray
        // comes in. Where the ray begins, it is in the upper cell, and above a mirrored plane is below it.
        let crossed = [through[1] | through[2], through[2], L::first(0)];
        let reached = each(|axis| {
            let crossed = (crossed[axis] & !through[axis]) | (at_start & mirrored[axis]);
            L::select(crossed, L::next_up(distance), distance)
        });
        Self { visits, distance, reached, through }
    }

    /// Low corner of the cell of size `1 << exponent` in which a ray comes into the box between the planes `near` and
    /// `far`.
    #[inline(always)]
    fn find_cell(
        &self,
        packet: &Packet<L>,
        near: [L::Float; 3],
        far: [L::Float; 3],
        exponent: u32,
    ) -> [L::Word; 3] {
        let within = L::word((1 << exponent) - 1);
        each(|axis| {
            let last = L::sub(L::to_bits(near[axis]), L::word(1));
            let range = [far[axis], L::from_bits(last)];
            let corner = locate(packet, axis, self.distance, self.reached[axis], range, exponent);
            L::select_word(self.through[axis], (last | within) ^ within, corner)
        })
    }
}

/// The low coordinate of the cell of size `1 << exponent` in which a ray is at a distance, if it is in a range.
///
/// The size is far above the rounding error of a coordinate: a point on the ray tells the cell but for one more or less,
/// and distances to planes tell that.
#[inline(always)]
fn locate<L: Lanes>(
    packet: &Packet<L>,
    axis: usize,
    distance: L::Float,
    reached: L::Float,
    [lowest, highest]: [L::Float; 2],
    exponent: u32,
) -> L::Word {
    let size = L::word(1 << exponent);
    let within = L::word((1 << exponent) - 1);
    let point = packet.lines.origin[axis] - packet.slope[axis] * distance;
    let point = L::to_bits(L::max(L::min(point, highest), lowest));
    let corner = (point | within) ^ within;
    let above = L::add(corner, size);
    let crossed = |plane: L::Word| L::less(packet.distance_to(axis, L::from_bits(plane)), reached);
    let lower = L::select_word(crossed(corner), L::sub(corner, size), corner);
    L::select_word(crossed(above), lower, above)
}

/// Goes to one of the smaller cells in that at `corner`: per axis to the upper ones, `bit` further up, unless the plane
/// below them has been crossed.
#[inline(always)]
fn refine<L: Lanes>(
    packet: &Packet<L>,
    corner: &mut [L::Word; 3],
    bit: L::Word,
    reached: [L::Float; 3],
    lanes: L::Mask,
) {
    *corner = each(|axis| {
        let plane = corner[axis] | bit;
        L::select_word(lanes & packet.is_ahead(axis, plane, &reached), plane, corner[axis])
    });
}

/// As [`refine`] with twice `bit` and then with `bit`, without waiting for the one before the other: planes are crossed from
/// the upper ones to the lower ones.
#[inline(always)]
fn refine_twice<L: Lanes>(
    packet: &Packet<L>,
    corner: &mut [L::Word; 3],
    bit: L::Word,
    reached: [L::Float; 3],
    lanes: L::Mask,
) {
    let twice = L::add(bit, bit);
    *corner = each(|axis| {
        let lowest = corner[axis];
        let up = |by: L::Word, place: L::Word| {
            let plane = lowest | by;
            L::select_word(lanes & packet.is_ahead(axis, plane, &reached), plane, place)
        };
        up(twice | bit, up(twice, up(bit, lowest)))
    });
}

/// Keeps where some lanes are.
#[inline(always)]
fn settle<L: Lanes>(place: &mut [L::Word; 3], corner: [L::Word; 3], lanes: L::Mask) {
    *place = each(|axis| L::select_word(lanes, corner[axis], place[axis]));
}

impl<L: Lanes> Hits<L> {
    /// No ray met anything.
    #[inline(always)]
    pub fn none() -> Self {
        let (zero, nowhere) = (L::word(0), L::first(0));
        Self {
            hit: nowhere,
            distance: L::float(f32::INFINITY),
            node: zero,
            part: zero,
            exponent: zero,
            steps: zero,
            packet_steps: 0,
            guarded: nowhere,
        }
    }

    /// Those of some lanes in the one, of the rest in the other; steps of no packet.
    #[inline(always)]
    pub fn chosen(lanes: L::Mask, yes: &Self, no: &Self) -> Self {
        let mask = |yes: L::Mask, no: L::Mask| (yes & lanes) | (no & !lanes);
        let word = |yes: L::Word, no: L::Word| L::select_word(lanes, yes, no);
        Self {
            hit: mask(yes.hit, no.hit),
            distance: L::select(lanes, yes.distance, no.distance),
            node: word(yes.node, no.node),
            part: word(yes.part, no.part),
            exponent: word(yes.exponent, no.exponent),
            steps: word(yes.steps, no.steps),
            packet_steps: 0,
            guarded: mask(yes.guarded, no.guarded),
        }
    }

    /// Writes down where the rays of some lanes end.
    #[inline(always)]
    fn record(
        &mut self,
        mask: L::Mask,
        distance: L::Float,
        current: &Current<L>,
        part: L::Word,
        levels_up: L::Word,
    ) {
        self.hit = self.hit | mask;
        self.distance = L::select(mask, distance, self.distance);
        self.node = L::select_word(mask, current.index, self.node);
        self.part = L::select_word(mask, part, self.part);
        let exponent = L::add(current.exponent, levels_up);
        self.exponent = L::select_word(mask, exponent, self.exponent);
    }
}
