//! The walk of a packet through the octree, written once for every number of lanes.
//!
//! **Integers decide where, floats only decide how far.** A position is kept as the bits of three floats in [1, 2),
//! so that a cell's coordinate is a run of mantissa bits. After leaving a cell through a face, the coordinate on
//! that axis is set to the cell beyond it, and the other two are held within the cell that was left: whatever the
//! rounding, the walk goes from a cell to one that shares a face with it. So it cannot slip through a 6-separating
//! surface, it cannot stand still, and its length is bounded by the resolution.
//!
//! Which cells a ray visits is defined in [`crate::oracle`], ties included. Boxes and levels only serve to skip empty
//! cells: where single precision loses nothing, the result does not depend on them.
//!
//! In the mirrored space of [`Packet`] every coordinate falls along the ray, and a cell is left through its low
//! faces.

use crate::grid::{self, Grid};
use crate::lanes::Lanes;
use crate::node::{LEAF, NODE_WORDS, Node};
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
    /// Mirrored position on entry: the bits of a float in [1, 2) per axis.
    pub position: [L::Word; 3],
    /// Cells that the ray has visited, if they were counted.
    pub steps: L::Word,
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

/// For each axis.
#[inline(always)]
fn each<T>(mut of: impl FnMut(usize) -> T) -> [T; 3] {
    [of(0), of(1), of(2)]
}

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

/// Levels of nodes, one for each two bits of the mantissa.
const PATH_LEVELS: usize = 12;

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
    /// In each lane where the mask is true, `index` is the index of a node in `table`.
    #[inline(always)]
    unsafe fn go(&mut self, table: &[u32], index: L::Word, exponent: L::Word, mask: L::Mask) {
        self.index = L::select_word(mask, index, self.index);
        self.exponent = L::select_word(mask, exponent, self.exponent);
        let word = L::shift_left(index, L::word(NODE_WORDS.ilog2()));
        // SAFETY: a node's words are at four times its index, and the caller promises that the node is there.
        unsafe {
            self.low = L::gather(table, word, mask, self.low);
            self.high = L::gather(table, L::add(word, L::word(1)), mask, self.high);
            self.contents = L::gather(table, L::add(word, L::word(2)), mask, self.contents);
        }
    }
}

/// Follows each ray of the packet to the first filled cell.
///
/// Rays start in the cells of `grid`, one of the octree's. With `LOD`, a ray stops at the first filled cell that is no
/// larger than `footprint` times the distance to it, and no larger than a cell of the grid. With `COUNT`, it counts the
/// cells that each ray visits.
pub(crate) fn trace<L: Lanes, const LOD: bool, const COUNT: bool>(
    octree: &Octree,
    grid: &Grid,
    packet: &Packet<L>,
    footprint: f32,
    path: &mut Path<L>,
) -> Hits<L> {
    let zero = L::word(0);
    let one = L::word(1);
    let mut hits = Hits {
        hit: L::first(0),
        distance: L::float(f32::INFINITY),
        node: zero,
        part: zero,
        exponent: zero,
        position: [zero; 3],
        steps: zero,
        guarded: L::first(0),
    };
    if octree.nodes.is_empty() {
        return hits;
    }
    let table: &[u32] = bytemuck::cast_slice::<Node, u32>(&octree.nodes);
    let grid_level = grid.level();
    let grid_exponent = L::word(MANTISSA_BITS - grid_level);
    let grid_mask = L::word((1 << grid_level) - 1);
    let leaving_grid_cell = L::word(1 << (MANTISSA_BITS - grid_level));
    let root_exponent = root_exponent(octree.depth);
    // The lower bit of each pair that selects a cell of some node. Bit 0 is there so that a word is never zero.
    let digits = L::word(if root_exponent % 2 == 1 { 0x00AA_AAAB } else { 0x0055_5555 });

    let Packet { origin, slope, reciprocal, mirror, .. } = *packet;
    let (mut active, mut distance, mut position) = enter(octree, packet);
    // Morton order of the cells in mirrored space to that of the cells in the node.
    let mirrored_cell = (mirror[0] & L::word(0b00_1001))
        | (mirror[1] & L::word(0b01_0010))
        | (mirror[2] & L::word(0b10_0100));

    let mut current = Current::<L>::none();
    // Only nodes between the grid and the finest are returned to.
    let path_levels = (finest_exponent(octree.depth) >> 1) + 1..(grid.node_exponent() >> 1) + 1;
    let mut fresh = active;
    // Each step leaves a cell for good, and a ray crosses at most this many.
    let mut steps_left = 3u32 << octree.depth;

    while L::any(active) {
        if L::any(fresh) {
            let coordinate: [L::Word; 3] =
                each(|axis| L::shift_right(position[axis] ^ mirror[axis], grid_exponent) & grid_mask);
            let cell = coordinate[0]
                | L::shift_left(coordinate[1], L::word(grid_level))
                | L::shift_left(coordinate[2], L::word(2 * grid_level));
            // SAFETY: each coordinate is below the grid's size, so the index is below its cube, the length of
            // the table.
            let entry = unsafe { L::gather(grid.cells(), cell, fresh, zero) };
            let empty = L::test(entry, L::word(grid::EMPTY)) & fresh;
            let found = fresh & !empty;
            // SAFETY: a cell of the grid that is not empty holds the index of a node.
            unsafe { current.go(table, entry, L::word(grid.node_exponent()), found) };
            current.low = L::select_word(empty, zero, current.low);
            current.high = L::select_word(empty, zero, current.high);
            current.exponent = L::select_word(empty, entry & L::word(!grid::EMPTY), current.exponent);
            if LOD {
                let whole = found & small(&current, 2, distance, footprint);
                hits.record(whole, distance, &current, L::word(part::NODE), 2, position);
                active = active & !whole;
            }
        }

        // Down to the first empty cell on the way, or to a filled one at which the ray ends.
        let mut cell;
        let mut half;
        loop {
            let digit: [L::Word; 3] = each(|axis| L::shift_right(position[axis], current.exponent));
            cell = (L::spread::<0>(digit[0]) | L::spread::<1>(digit[1]) | L::spread::<2>(digit[2]))
                ^ mirrored_cell;
            let upper = L::test(cell, L::word(32));
            half = L::select_word(upper, current.high, current.low);
            let bit = L::bit(cell);
            let filled = L::test(half, bit) & active;
            let leaf = L::test(current.contents, L::word(LEAF));
            let mut stop = filled & leaf;
            if LOD {
                let byte = L::shift_right(half, cell & L::word(24));
                let block = L::test(byte, L::word(0xFF)) & active & small(&current, 1, distance, footprint);
                let part = L::add(L::shift_right(cell, L::word(3)), L::word(part::CELLS));
                hits.record(block, distance, &current, part, 1, position);
                active = active & !block;
                stop = filled & active & (leaf | small(&current, 0, distance, footprint));
            }
            if L::any(stop) {
                hits.record(stop, distance, &current, cell, 0, position);
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
            // SAFETY: the node is an inner one, so its contents are the index of its first child, and the cell is
            // filled, so its child is there.
            unsafe { current.go(table, child, L::sub(current.exponent, L::word(2)), descend) };
        }
        if !L::any(active) {
            break;
        }

        // Out of the empty cell, or of the eight if they are all empty.
        let byte = L::shift_right(half, cell & L::word(24));
        let some = L::test(byte, L::word(0xFF));
        let size_exponent = L::add(current.exponent, L::select_word(some, zero, one));
        let within = L::sub(L::bit(size_exponent), one);
        let corner: [L::Word; 3] = each(|axis| (position[axis] | within) ^ within);
        let plane: [L::Float; 3] =
            each(|axis| (L::from_bits(corner[axis]) - origin[axis]) * reciprocal[axis]);
        distance = L::min(L::min(plane[0], plane[1]), plane[2]);
        let through_x = L::same(plane[0], distance);
        let through_y = L::same(plane[1], distance) & !through_x;
        let through_z = !(through_x | through_y);
        let through = [through_x, through_y, through_z];
        // At this very distance, planes of an earlier axis have been crossed already.
        let crossed = [L::select_word(through_x, zero, one), L::select_word(through_z, one, zero), zero];
        position = each(|axis| {
            let point = L::to_bits(origin[axis] - slope[axis] * distance);
            let point = L::from_bits(L::sub(point, crossed[axis]));
            // Coordinates only fall. This also keeps a ray that begins on a plane on the side where it began.
            let point = L::max(L::min(point, L::from_bits(position[axis])), L::from_bits(corner[axis]));
            let point = L::to_bits(point);
            L::select_word(through[axis], L::sub(corner[axis], one), point)
        });
        if COUNT {
            hits.steps = L::select_word(active, L::add(hits.steps, one), hits.steps);
        }

        // The lowest node that holds both cells is found in the bits that changed: all up to some place.
        let left = L::select_word(through_x, corner[0], L::select_word(through_y, corner[1], corner[2]));
        active = active & !L::same_word(left, L::word(ONE_BITS));
        let changed = left ^ L::sub(left, one);
        fresh = L::test(changed, leaving_grid_cell) & active;
        let ancestor = L::highest_bit(changed & digits);
        let ascend = L::greater(ancestor, current.exponent) & active & !fresh;
        if L::any(ascend) {
            L::for_each_level(path_levels.clone(), L::shift_right(ancestor, one), ascend, |level, mask| {
                current.replace(&path.nodes[level], mask);
            });
            current.exponent = L::select_word(ascend, ancestor, current.exponent);
        }

        steps_left -= 1;
        if steps_left == 0 {
            hits.guarded = active;
            break;
        }
    }
    hits
}

/// Whether the cells of each lane's node, or those `levels` above, are no larger than the footprint of a ray.
#[inline(always)]
fn small<L: Lanes>(current: &Current<L>, levels: u32, distance: L::Float, footprint: f32) -> L::Mask {
    // 2^(exponent − 23) as a float: the size of the cell in unit space.
    let biased = L::add(current.exponent, L::word(127 - MANTISSA_BITS + levels));
    let size = L::from_bits(L::shift_left(biased, L::word(MANTISSA_BITS)));
    L::at_most(size, distance * L::float(footprint))
}

/// Where each ray enters the box around the filled cells: lanes that do, distance, position.
#[inline(always)]
fn enter<L: Lanes>(octree: &Octree, packet: &Packet<L>) -> (L::Mask, L::Float, [L::Word; 3]) {
    let one = L::word(1);
    let zero = L::word(0);
    let Packet { origin, slope, reciprocal, mirror, start, .. } = *packet;
    let [low, high] = octree.bounds.corners(octree.depth);
    let mirrored = mirror.map(|mask| L::test(mask, one));
    let near: [L::Float; 3] =
        each(|axis| L::select(mirrored[axis], L::float(3.0 - low[axis]), L::float(high[axis])));
    let far: [L::Float; 3] =
        each(|axis| L::select(mirrored[axis], L::float(3.0 - high[axis]), L::float(low[axis])));
    let entry: [L::Float; 3] = each(|axis| (near[axis] - origin[axis]) * reciprocal[axis]);
    let exit: [L::Float; 3] = each(|axis| (far[axis] - origin[axis]) * reciprocal[axis]);
    let distance = L::max(L::max(entry[0], entry[1]), L::max(entry[2], start));
    // Zeros of either sign become +0.
    let distance = distance + L::float(0.0);
    let leave = L::min(L::min(exit[0], exit[1]), exit[2]);
    // Of the cells about its origin a ray begins in the upper ones. So where it begins on a high face of the box, it
    // comes in through that face, if it goes down; and where it begins on a low one, it is inside.
    let at_start = !L::less(start, distance);
    let through: [L::Mask; 3] = each(|axis| L::same(entry[axis], distance) & !(at_start & mirrored[axis]));
    let from_outside = through[0] | through[1] | through[2];

    let mut active = packet.active & L::less(distance, leave);
    let touching = packet.active & L::same(distance, leave);
    if L::any(touching) {
        // A single point of the box: the ray is in it if it comes in before it goes out, and does not begin beyond.
        let out: [L::Mask; 3] = each(|axis| L::same(exit[axis], leave));
        let enters_first = !out[0] & !through[2] & (!out[1] | !through[1]);
        let begins_beyond =
            at_start & ((out[0] & mirrored[0]) | (out[1] & mirrored[1]) | (out[2] & mirrored[2]));
        active = active | (touching & !begins_beyond & (enters_first | !from_outside));
    }

    // On a plane, a point has crossed those of an earlier axis than that through which the ray comes in. Where the
    // ray begins, it is in the upper cell, and above a mirrored face is below it.
    let crossed_earlier = [through[1] | through[2], through[2], L::first(0)];
    let position = each(|axis| {
        let crossed = crossed_earlier[axis] | (at_start & mirrored[axis]);
        let last = L::sub(L::to_bits(near[axis]), one);
        let point = L::min(origin[axis] - slope[axis] * distance, L::from_bits(last));
        let point = L::sub(L::to_bits(point), L::select_word(crossed, one, zero));
        let point = L::max(L::from_bits(point), far[axis]);
        L::select_word(through[axis], last, L::to_bits(point))
    });
    (active, distance, position)
}

impl<L: Lanes> Hits<L> {
    /// Writes down where the rays of some lanes end.
    #[inline(always)]
    fn record(
        &mut self,
        mask: L::Mask,
        distance: L::Float,
        current: &Current<L>,
        part: L::Word,
        levels_up: u32,
        position: [L::Word; 3],
    ) {
        self.hit = self.hit | mask;
        self.distance = L::select(mask, distance, self.distance);
        self.node = L::select_word(mask, current.index, self.node);
        self.part = L::select_word(mask, part, self.part);
        let exponent = L::add(current.exponent, L::word(levels_up));
        self.exponent = L::select_word(mask, exponent, self.exponent);
        self.position = each(|axis| L::select_word(mask, position[axis], self.position[axis]));
    }
}
