//! Rays of a beam that part: from nodes that they share, each goes down its own way.
//!
//! A ray that comes to a node finds out at once which cells of it it crosses ([`crate::crossing`]) and visits the filled ones front to
//! back: in a leaf the first one is its end, in an inner node each is a node again. No cell is stepped over, so what a ray costs are
//! the nodes that it comes to and not the empty cells between them. All lanes do the same in each step, whichever level they are
//! on, and the nodes that a beam shares are to them one level more: a lane is idle only when its ray is at its end.
//!
//! A step begins with reading a node and ends with asking for the next one. Meanwhile other packets make theirs.

use crate::beam::{LOWER_BITS, PlacedNode, mirrored_places};
use crate::crossing::Crossing;
use crate::lanes::{Lanes, Real, each};
use crate::lod::size_of_cells;
use crate::node::{LEAF, UNIFORM, extent};
use crate::octree::{MANTISSA_BITS, finest_exponent};
use crate::ray::Packet;
use crate::traversal::{Hits, PATH_LEVELS, Target, fill_bytes, part};
use std::ops::Range;

/// How many nodes are shared at a time, one bit of a word for each. The rays end at the first few in most cases: with 32 of them a
/// picture takes up to a quarter longer.
const MOST_SHARED: usize = 16;

const MANTISSA: u32 = (1 << MANTISSA_BITS) - 1;

/// Nodes, front to back, from which rays go on alone.
pub(crate) struct Shared<R> {
    /// Their low corners in mirrored space, of the first of whose coordinates only the mantissa is kept, below the exponent of the
    /// node's cells; and their indices.
    rows: Vec<[u32; 4]>,
    /// For each, from the eye to the planes about those of its cells that rays may come to: per axis the high and the low one.
    about: Vec<[[R; 2]; 3]>,
    /// The largest exponent.
    coarsest: u32,
    /// Whether rays may end above the finest cells in some of them.
    ends_early: bool,
}

impl<R: Real> Shared<R> {
    pub fn new() -> Self {
        Self { rows: Vec::new(), about: Vec::new(), coarsest: 0, ends_early: false }
    }

    pub fn clear(&mut self) {
        self.rows.clear();
        self.about.clear();
        self.coarsest = 0;
        self.ends_early = false;
    }

    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    pub fn ends_early(&self) -> bool {
        self.ends_early
    }

    pub fn is_full(&self) -> bool {
        self.rows.len() == MOST_SHARED
    }

    /// Adds a node in mirrored space, behind all others. Of its cells, in the order of mirrored space, rays may come to some; there
    /// is one. `ends_early` says whether they may end above the finest ones.
    pub fn push(&mut self, node: &PlacedNode, cells: u64, eye: [R; 3], ends_early: bool) {
        debug_assert!(!self.is_full());
        let [x, y, z] = node.corner;
        self.rows.push([x & MANTISSA | node.exponent << MANTISSA_BITS, y, z, node.index]);
        let extent = extent(cells);
        self.about.push(each(|axis| {
            let [low, high] = extent[axis].map(|plane| {
                R::from(f32::from_bits(node.corner[axis] + (plane << node.exponent))) - eye[axis]
            });
            [high, low]
        }));
        self.coarsest = self.coarsest.max(node.exponent);
        self.ends_early |= ends_early;
    }

    /// For each ray the nodes to whose cells it may come; the first one is the highest bit.
    #[inline(always)]
    fn entered<L: Lanes<Real = R>>(&self, packet: &Packet<L>) -> L::Word {
        let mut entered = L::word(0);
        let mut bit = 1 << (MOST_SHARED - 1);
        for about in &self.about {
            let plane =
                |axis: usize, side: usize| L::quotient(L::real(about[axis][side]), packet.divisor[axis]);
            let enter = L::max(L::max(plane(0, 0), plane(1, 0)), L::max(plane(2, 0), packet.start));
            let leave = L::min(L::min(plane(0, 1), plane(1, 1)), plane(2, 1));
            entered = L::select_word(L::at_most(enter, leave), entered | L::word(bit), entered);
            bit >>= 1;
        }
        entered
    }
}

/// Inner nodes of the packet's lanes, and which of their filled cells are still to be visited.
#[derive(Clone, Copy)]
struct Inner<L: Lanes> {
    waiting: [L::Word; 2],
    mask: [L::Word; 2],
    first_child: L::Word,
}

impl<L: Lanes> Inner<L> {
    fn none() -> Self {
        let zero = L::word(0);
        Self { waiting: [zero; 2], mask: [zero; 2], first_child: zero }
    }

    #[inline(always)]
    fn replace(&mut self, other: &Self, lanes: L::Mask) {
        for half in 0..2 {
            self.waiting[half] = L::select_word(lanes, other.waiting[half], self.waiting[half]);
            self.mask[half] = L::select_word(lanes, other.mask[half], self.mask[half]);
        }
        self.first_child = L::select_word(lanes, other.first_child, self.first_child);
    }
}

/// Lanes of which a bit is set in one of two halves.
#[inline(always)]
fn is_any<L: Lanes>(cells: [L::Word; 2]) -> L::Mask {
    L::test(cells[0] | cells[1], L::word(u32::MAX))
}

/// What rays part from.
pub(crate) struct Parting<'a, R> {
    pub target: &'a Target<'a>,
    pub crossing: Crossing,
    pub shared: &'a Shared<R>,
}

impl<R> Parting<'_, R> {
    /// Half the exponents of the nodes above which rays may be, but below a shared one.
    fn levels(&self) -> Range<u32> {
        (finest_exponent(self.target.octree.depth) >> 1) + 2..(self.shared.coarsest >> 1) + 1
    }
}

/// Where the rays of a packet are, below shared nodes.
pub(crate) struct Pursuit<L: Lanes> {
    /// The nodes that they come to next.
    coming: Place<L>,
    /// Lanes that come to one.
    active: L::Mask,
    /// The lowest inner nodes about them, and the exponents of those nodes' cells.
    inner: Inner<L>,
    inner_exponent: L::Word,
    /// The inner nodes above that are not done yet: bits for half their exponents, and what is on the level of each.
    open: L::Word,
    above: [Inner<L>; PATH_LEVELS],
    /// Shared nodes that are still to be visited.
    left: L::Word,
    hits: Hits<L>,
    /// For rays that have ended, where the planes meet through which their cells are entered.
    entry: [L::Word; 3],
}

/// Nodes, and where they are in mirrored space.
#[derive(Clone, Copy)]
struct Place<L: Lanes> {
    index: L::Word,
    /// Their low corners: the bits of floats in [1, 2).
    corner: [L::Word; 3],
    /// Their cells are of size `1 << exponent`.
    exponent: L::Word,
}

/// Nodes that have been read.
struct Content<L: Lanes> {
    mask: [L::Word; 2],
    contents: L::Word,
    /// By how many levels the cells in which rays end are above the node's cells, which are all filled in them then.
    levels_up: L::Word,
}

/// The first cell of some in a node.
struct First<L: Lanes> {
    /// Its place in its half of the node, and lanes in which that is the high one.
    cell: L::Word,
    is_upper: L::Mask,
    /// Its coordinates in mirrored space: `0..4`.
    coordinate: [L::Word; 3],
}

impl<L: Lanes> Pursuit<L> {
    pub fn new() -> Self {
        let zero = L::word(0);
        Self {
            coming: Place { index: zero, corner: [zero; 3], exponent: zero },
            active: L::first(0),
            inner: Inner::none(),
            inner_exponent: zero,
            open: zero,
            above: [Inner::none(); PATH_LEVELS],
            left: zero,
            hits: Hits::none(),
            entry: [zero; 3],
        }
    }

    /// Makes the rays of some lanes ready; returns whether they come to anything.
    #[inline(always)]
    pub fn begin(&mut self, parting: &Parting<'_, L::Real>, packet: &Packet<L>, lanes: L::Mask) -> bool {
        let zero = L::word(0);
        self.active = L::first(0);
        self.inner = Inner::none();
        self.open = zero;
        self.left = parting.shared.entered(packet) & L::select_word(lanes, L::word(u32::MAX), zero);
        self.hits = Hits::none();
        self.come_to_shared(parting, L::test(self.left, L::word(u32::MAX)));
        self.ask_for_nodes(parting);
        L::any(self.active)
    }

    /// Visits a node in each lane and finds the next; returns whether there is any. With `LOD` and `COUNT` as in
    /// [`crate::traversal::trace`], but that nodes are counted instead of cells.
    #[inline(never)]
    pub fn step<const LOD: bool, const COUNT: bool>(
        &mut self,
        parting: &Parting<'_, L::Real>,
        packet: &Packet<L>,
    ) -> bool {
        if COUNT {
            let steps = L::add(self.hits.steps, L::word(1));
            self.hits.steps = L::select_word(self.active, steps, self.hits.steps);
            self.hits.packet_steps += 1;
        }
        let place = self.coming;
        let node = self.read::<LOD>(parting);
        let crossed = parting.crossing.cells(packet, place.corner, place.exponent);
        let found = each_half(|half| node.mask[half] & crossed[half]);
        let is_met = is_any::<L>(found) & self.active;
        let is_leaf = L::test(node.contents, L::word(LEAF));
        let ended = is_met & is_leaf;
        let entered = is_met & !is_leaf;
        let inner = Inner { waiting: found, mask: node.mask, first_child: node.contents };
        self.go_in(parting, &inner, place.exponent, entered);
        self.come_back(parting, !ended);

        let waiting = each_half(|half| L::select_word(ended, found[half], self.inner.waiting[half]));
        let first = First::of(parting, waiting);
        if L::any(ended) {
            self.end_rays::<LOD>(&place, &node, &first, ended);
        }
        self.active = is_any::<L>(self.inner.waiting);
        self.go_down(&place, &first);
        let ahead = L::test(self.left, L::word(u32::MAX)) & !self.active;
        if L::any(ahead) {
            self.come_to_shared(parting, ahead);
        }
        self.ask_for_nodes(parting);
        L::any(self.active)
    }

    /// What the rays have met.
    #[inline(always)]
    pub fn hits(&self, packet: &Packet<L>) -> Hits<L> {
        let enter: [L::Float; 3] = each(|axis| packet.distance_to(axis, L::from_bits(self.entry[axis])));
        // Zeros of either sign become +0.
        let distance = L::abs(L::max(L::max(enter[0], enter[1]), L::max(enter[2], packet.start)));
        Hits { distance: L::select(self.hits.hit, distance, self.hits.distance), ..self.hits }
    }

    /// Reads the nodes that rays have come to; with `LOD`, as they see them.
    #[inline(always)]
    fn read<const LOD: bool>(&self, parting: &Parting<'_, L::Real>) -> Content<L> {
        let Target { octree, grid, lod } = parting.target;
        let Place { index, corner, exponent } = self.coming;
        let (zero, all) = (L::word(0), L::word(u32::MAX));
        let rows: &[[u32; 4]] = bytemuck::cast_slice(&octree.nodes);
        // SAFETY: shared nodes are nodes of the octree, and so are the children in the filled cells of its inner nodes.
        let [low, high, contents, _] = unsafe { L::gather_rows(rows, index, self.active, [zero; 4]) };
        let mut node = Content { mask: [low, high], contents, levels_up: zero };
        if !LOD {
            return node;
        }
        let mirror = parting.crossing.mirrored().map(|mirrored| if mirrored { all } else { zero });
        let largest = lod.largest_cell::<L::Rough>(corner, mirror, exponent);
        let ends = |levels: u32| {
            let size = size_of_cells::<L::Rough>(L::add(exponent, L::word(levels)));
            L::Rough::at_most(size, largest) & !L::test(contents, L::word(UNIFORM))
        };
        let of_grid = L::word(grid.node_exponent());
        let by_cell = ends(0) & !L::greater(exponent, of_grid);
        if L::any(by_cell) {
            let by_block = by_cell & ends(1);
            // Below the grid's nodes it is the node above that decides whether a whole one is an end.
            let by_node = by_cell & ends(2) & L::same_word(exponent, of_grid);
            node.contents = L::select_word(by_cell, L::word(LEAF), contents);
            node.mask = node.mask.map(|half| {
                let blocks = L::select_word(by_block, fill_bytes::<L>(half), half);
                L::select_word(by_node, all, blocks)
            });
            let blocks = L::select_word(by_block, L::word(1), zero);
            node.levels_up = L::select_word(by_node, L::word(2), blocks);
        }
        node
    }

    /// Makes other nodes the lowest about the rays of some lanes.
    #[inline(always)]
    fn go_in(
        &mut self,
        parting: &Parting<'_, L::Real>,
        node: &Inner<L>,
        exponent: L::Word,
        entered: L::Mask,
    ) {
        let keep = entered & is_any::<L>(self.inner.waiting);
        if L::any(keep) {
            let level = L::shift_right(self.inner_exponent, L::word(1));
            L::for_each_level(parting.levels(), level, keep, |level, mask| {
                self.above[level].replace(&self.inner, mask);
            });
            self.open = L::select_word(keep, self.open | L::bit(level), self.open);
        }
        self.inner.replace(node, entered);
        self.inner_exponent = L::select_word(entered, exponent, self.inner_exponent);
    }

    /// In those of some lanes in which the lowest inner node is done, makes it the next one above that is not.
    #[inline(always)]
    fn come_back(&mut self, parting: &Parting<'_, L::Real>, lanes: L::Mask) {
        let back = lanes & L::test(self.open, L::word(u32::MAX)) & !is_any::<L>(self.inner.waiting);
        if !L::any(back) {
            return;
        }
        let lowest = self.open & L::sub(L::word(0), self.open);
        let level = L::highest_bit(lowest);
        L::for_each_level(parting.levels(), level, back, |level, mask| {
            self.inner.replace(&self.above[level], mask);
        });
        self.open = L::select_word(back, self.open ^ lowest, self.open);
        let odd = finest_exponent(parting.target.octree.depth) & 1;
        let exponent = L::add(L::add(level, level), L::word(odd));
        self.inner_exponent = L::select_word(back, exponent, self.inner_exponent);
    }

    /// Ends the rays of some lanes in a cell of the node that they have come to.
    #[inline(always)]
    fn end_rays<const LOD: bool>(
        &mut self,
        place: &Place<L>,
        node: &Content<L>,
        first: &First<L>,
        ended: L::Mask,
    ) {
        let zero = L::word(0);
        let cell = first.cell | L::select_word(first.is_upper, L::word(32), zero);
        // Where all cells are one voxel, the first stands for it.
        let mut part = L::select_word(L::test(node.contents, L::word(UNIFORM)), zero, cell);
        if LOD {
            let block = L::add(L::shift_right(cell, L::word(3)), L::word(part::CELLS));
            let is_end = |levels: u32| L::same_word(node.levels_up, L::word(levels));
            part = L::select_word(is_end(1), block, part);
            part = L::select_word(is_end(2), L::word(part::NODE), part);
        }
        let hits = &mut self.hits;
        hits.hit = hits.hit | ended;
        hits.node = L::select_word(ended, place.index, hits.node);
        hits.part = L::select_word(ended, part, hits.part);
        let exponent = L::add(place.exponent, node.levels_up);
        hits.exponent = L::select_word(ended, exponent, hits.exponent);
        let size = L::bit(place.exponent);
        self.entry = each(|axis| {
            let offset = L::shift_left(first.coordinate[axis], place.exponent);
            let high = L::add(L::add(place.corner[axis], offset), size);
            L::select_word(ended, high, self.entry[axis])
        });
        for waiting in [&mut self.left, &mut self.open].into_iter().chain(&mut self.inner.waiting) {
            *waiting = L::select_word(ended, zero, *waiting);
        }
    }

    /// To the node in the first cell of the lowest inner node, in active lanes. `place` is anywhere in that.
    #[inline(always)]
    fn go_down(&mut self, place: &Place<L>, first: &First<L>) {
        let Self { inner, inner_exponent, active, coming, .. } = self;
        let (zero, one) = (L::word(0), L::word(1));
        let bit = L::bit(first.cell);
        let visited = L::select_word(*active, bit, zero);
        inner.waiting[0] = inner.waiting[0] ^ L::select_word(first.is_upper, zero, visited);
        inner.waiting[1] = inner.waiting[1] ^ L::select_word(first.is_upper, visited, zero);
        let [low, high] = inner.mask;
        let before = L::count_ones(L::select_word(first.is_upper, high, low) & L::sub(bit, one));
        let before = L::add(before, L::count_ones(L::select_word(first.is_upper, low, zero)));
        coming.index = L::select_word(*active, L::add(inner.first_child, before), place.index);
        let within = L::sub(L::shift_left(L::word(4), *inner_exponent), one);
        coming.corner = each(|axis| {
            let low = (place.corner[axis] | within) ^ within;
            let child = L::add(low, L::shift_left(first.coordinate[axis], *inner_exponent));
            L::select_word(*active, child, place.corner[axis])
        });
        let exponent = L::sub(*inner_exponent, L::word(2));
        coming.exponent = L::select_word(*active, exponent, place.exponent);
    }

    /// To the next of the shared nodes, in some lanes in which there is one.
    #[inline(always)]
    fn come_to_shared(&mut self, parting: &Parting<'_, L::Real>, lanes: L::Mask) {
        let next = L::highest_bit_of_all(self.left);
        self.left = L::select_word(lanes, self.left ^ L::bit(next), self.left);
        let number = L::sub(L::word(MOST_SHARED as u32 - 1), next);
        let Place { index, corner: [x, y, z], exponent } = self.coming;
        // SAFETY: a bit is set only for a row that is there.
        let [x, y, z, index] =
            unsafe { L::gather_rows(&parting.shared.rows, number, lanes, [x, y, z, index]) };
        let corner = (x & L::word(MANTISSA)) | L::word(1f32.to_bits());
        self.coming = Place {
            index,
            corner: [L::select_word(lanes, corner, x), y, z],
            exponent: L::select_word(lanes, L::shift_right(x, L::word(MANTISSA_BITS)), exponent),
        };
        self.active = self.active | lanes;
    }

    #[inline(always)]
    fn ask_for_nodes(&self, parting: &Parting<'_, L::Real>) {
        L::prefetch_rows(bytemuck::cast_slice(&parting.target.octree.nodes), self.coming.index);
    }
}

impl<L: Lanes> First<L> {
    /// The first of some cells that each ray comes to. Where there are none, any.
    #[inline(always)]
    fn of<R>(parting: &Parting<'_, R>, cells: [L::Word; 2]) -> Self {
        let (zero, one, two) = (L::word(0), L::word(1), L::word(2));
        let [x, y, z] = parting.crossing.mirrored();
        let flip = mirrored_places([x, y, z]);
        // In mirrored space coordinates fall along every ray, so the first cell is the highest bit.
        let (near, far) = if z { (0, 1) } else { (1, 0) };
        let is_near = L::test(cells[near], L::word(u32::MAX));
        let half = L::select_word(is_near, cells[near], cells[far]);
        let in_half = L::highest_bit_of_all(flipped_half::<L>(half, flip));
        let cell = in_half | L::select_word(is_near, L::word(32), zero);
        let low_bit = |axis: u32| L::shift_right(cell, L::word(axis)) & one;
        let high_bit = |axis: u32| L::shift_right(cell, L::word(axis + 2)) & two;
        Self {
            cell: in_half ^ L::word(flip & 31),
            is_upper: if z { !is_near } else { is_near },
            coordinate: [0, 1, 2].map(|axis| low_bit(axis) | high_bit(axis)),
        }
    }
}

#[inline(always)]
fn each_half<T>(mut of: impl FnMut(usize) -> T) -> [T; 2] {
    [of(0), of(1)]
}

/// Moves bit `place` to `place ^ flip`, of which the five lowest bits count. See [`crate::beam::flipped`].
#[inline(always)]
fn flipped_half<L: Lanes>(mut cells: L::Word, flip: u32) -> L::Word {
    for (bit, lower) in LOWER_BITS.into_iter().take(5).enumerate() {
        if flip >> bit & 1 == 1 {
            let (lower, by) = (L::word(lower as u32), L::word(1 << bit));
            cells = L::shift_left(cells & lower, by) | (L::shift_right(cells, by) & lower);
        }
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::beam::flipped;
    use crate::lanes::Eight;
    use crate::random::Random;

    #[test]
    fn halves_are_flipped_as_nodes_are() {
        let random = &mut Random::stream(12, 0);
        for _ in 0..1000 {
            let (cells, flip) = (random.next() as u32, random.next() as u32 % 64);
            let found = Eight::words(flipped_half::<Eight>(Eight::word(cells), flip))[0];
            assert_eq!(u64::from(found), flipped(cells.into(), flip & 31), "{cells:#x}, {flip}");
        }
    }
}
