//! Rays that part: from nodes that a beam or crowd shares, each goes down its own way.
//!
//! A ray that comes to a node finds out at once which cells of it it crosses ([`crate::crossing`]) and visits the filled ones front to
//! back: in a leaf the first one is its end, in an inner node each is a node again. No cell is stepped over, so what a ray costs are
//! the nodes that it comes to and not the empty cells between them. All lanes do the same in each step, whichever level they are
//! on, and the nodes that are shared are to them one level more: a lane is idle only when its ray is at its end.
//!
//! A step begins with reading a node and ends with asking for the next one. Meanwhile other packets make theirs ([`crate::parted`]).

use crate::beam::{LOWER_BITS, mirrored_places};
use crate::crossing::Crossing;
use crate::ends::{Ending, Ends, RAY_NUMBERS};
use crate::lanes::{Lanes, MAX_LANES, Real, each};
use crate::lod::size_of_cells;
use crate::node::{LEAF, UNIFORM};
use crate::octree::finest_exponent;
use crate::passing::{Passes, ask};
use crate::ray::Lines;
use crate::shared::{MOST_SHARED, Place, Shared};
use crate::traversal::{PATH_LEVELS, Target, fill_bytes, part};
use std::ops::Range;

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

impl<R: Real> Parting<'_, R> {
    /// Half the exponents of the nodes above which rays may be, but below a shared one.
    pub fn levels(&self) -> Range<u32> {
        (finest_exponent(self.target.octree.depth) >> 1) + 2..(self.shared.coarsest() >> 1) + 1
    }
}

/// Where some rays of a beam or crowd are, below shared nodes.
pub(crate) struct Pursuit<L: Lanes> {
    rays: Lines<L>,
    /// The number of each ray in its beam or crowd.
    number: L::Word,
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
    /// For some rays of which none comes to anything yet.
    pub fn new(rays: Lines<L>) -> Self {
        let zero = L::word(0);
        Self {
            rays,
            number: zero,
            coming: Place { index: zero, corner: [zero; 3], exponent: zero },
            active: L::first(0),
            inner: Inner::none(),
            inner_exponent: zero,
            open: zero,
            above: [Inner::none(); PATH_LEVELS],
            left: zero,
        }
    }

    /// Makes the rays of some lanes of a packet ready, whose first one is number `first` of its beam; returns whether they come to
    /// anything.
    #[inline(always)]
    pub fn begin(
        &mut self,
        parting: &Parting<'_, L::Real>,
        rays: &Lines<L>,
        lanes: L::Mask,
        first: usize,
    ) -> bool {
        let zero = L::word(0);
        self.left = parting.shared.entered(rays) & L::select_word(lanes, L::word(u32::MAX), zero);
        let begins = L::test(self.left, L::word(u32::MAX));
        if !L::any(begins) {
            return false;
        }
        self.rays = *rays;
        self.number = L::load_words(&RAY_NUMBERS[first..]);
        self.active = L::first(0);
        self.inner = Inner::none();
        self.open = zero;
        self.come_to_shared(parting, begins);
        self.ask_for_nodes(parting);
        true
    }

    /// Lanes whose rays are not at their end: bit `i` is lane `i`.
    #[inline(always)]
    pub fn running(&self) -> u32 {
        L::bitmask(self.active)
    }

    /// Lets `other` go on with rays of this one: as many as have room in lanes that are idle there. All inner nodes above that are
    /// not done yet are on `levels`.
    pub fn hand_over(&mut self, other: &mut Self, levels: Range<u32>) {
        let (mut given, mut taken) = (0, 0);
        let mut from = [0; MAX_LANES];
        let (mut giving, mut idle) = (self.running(), L::bitmask(!other.active));
        while giving != 0 && idle != 0 {
            from[idle.trailing_zeros() as usize] = giving.trailing_zeros();
            given |= giving & giving.wrapping_neg();
            taken |= idle & idle.wrapping_neg();
            giving &= giving - 1;
            idle &= idle - 1;
        }
        let from = L::load_words(&from);
        let (given, taken) = (L::from_bitmask(given), L::from_bitmask(taken));
        let float =
            |to: &mut L::Float, value: L::Float| *to = L::select(taken, L::permuted(value, from), *to);
        let word = |to: &mut L::Word, value: L::Word| {
            *to = L::select_word(taken, L::permuted_word(value, from), *to);
        };
        let inner = |to: &mut Inner<L>, value: &Inner<L>| {
            for half in 0..2 {
                word(&mut to.waiting[half], value.waiting[half]);
                word(&mut to.mask[half], value.mask[half]);
            }
            word(&mut to.first_child, value.first_child);
        };
        for axis in 0..3 {
            float(&mut other.rays.origin[axis], self.rays.origin[axis]);
            float(&mut other.rays.divisor[axis], self.rays.divisor[axis]);
            word(&mut other.coming.corner[axis], self.coming.corner[axis]);
        }
        float(&mut other.rays.start, self.rays.start);
        float(&mut other.rays.end, self.rays.end);
        word(&mut other.number, self.number);
        word(&mut other.coming.index, self.coming.index);
        word(&mut other.coming.exponent, self.coming.exponent);
        inner(&mut other.inner, &self.inner);
        word(&mut other.inner_exponent, self.inner_exponent);
        word(&mut other.open, self.open);
        if L::any(taken & L::test(other.open, L::word(u32::MAX))) {
            for level in levels {
                inner(&mut other.above[level as usize], &self.above[level as usize]);
            }
        }
        word(&mut other.left, self.left);
        other.active = other.active | taken;
        self.active = self.active & !given;
    }

    /// Visits a node in each lane and finds the next; returns the lanes that are not at their end, as [`Pursuit::running`]. With
    /// `LOD` and `COUNT` as in [`crate::traversal::trace`], but that nodes are counted instead of cells. With `ENDS`, rays go no
    /// further than to their ends, what they meet may be beyond, and they go past what `passes` tells.
    #[inline(never)]
    pub fn step<const LOD: bool, const COUNT: bool, const ENDS: bool>(
        &mut self,
        parting: &Parting<'_, L::Real>,
        ends: &mut Ends,
        passes: Option<&mut Passes<'_>>,
    ) -> u32 {
        if COUNT {
            ends.count_step::<L>(self.number, self.running());
        }
        let place = self.coming;
        let node = self.read::<LOD>(parting);
        let (crossed, distance) = parting.crossing.cells(&self.rays, place.corner, place.exponent);
        let mut found = each_half(|half| node.mask[half] & crossed[half]);
        if ENDS {
            // What a ray does not cross is nowhere on its way.
            let beyond = self.active & is_any::<L>(crossed) & !L::less(distance, self.rays.end);
            if L::any(beyond) {
                self.go_no_further(beyond);
                found = found.map(|half| L::select_word(beyond, L::word(0), half));
            }
        }
        let is_met = is_any::<L>(found) & self.active;
        let is_leaf = L::test(node.contents, L::word(LEAF));
        let ended = is_met & is_leaf;
        let entered = is_met & !is_leaf;
        let inner = Inner { waiting: found, mask: node.mask, first_child: node.contents };
        self.go_in(parting, &inner, place.exponent, entered);
        self.come_back(parting, !ended);

        let waiting = each_half(|half| L::select_word(ended, found[half], self.inner.waiting[half]));
        let first = First::of(parting, waiting);
        let mut passing = L::first(0);
        if L::any(ended) {
            let ending = ending_of::<L, LOD>(&place, &node, &first);
            if ENDS && let Some(passes) = passes {
                passing = self.go_past(parting, &ending, &node, ended, passes);
            }
            let ended = ended & !passing;
            ends.end_rays::<L>(self.number, ended, &ending);
            self.go_no_further(ended);
        }
        self.active = is_any::<L>(self.inner.waiting) & !passing;
        self.go_down(&place, &first);
        self.active = self.active | passing;
        let ahead = L::test(self.left, L::word(u32::MAX)) & !self.active;
        if L::any(ahead) {
            self.come_to_shared(parting, ahead);
        }
        self.ask_for_nodes(parting);
        self.running()
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

    /// Asks which of the rays that have met something in some lanes go past it. They come to the node once more, and begin just
    /// behind what they have met.
    #[inline(never)]
    fn go_past(
        &mut self,
        parting: &Parting<'_, L::Real>,
        ending: &Ending<L>,
        node: &Content<L>,
        met: L::Mask,
        passes: &mut Passes<'_>,
    ) -> L::Mask {
        // Where all cells are one voxel, that is met.
        let whole = L::select_word(L::test(node.contents, L::word(UNIFORM)), L::word(2), L::word(0));
        let size = L::bit(L::add(ending.exponent, whole));
        let within = L::sub(size, L::word(1));
        let low = each(|axis| (L::sub(ending.entry[axis], L::word(1)) | within) ^ within);
        let [low, high] = [low, low.map(|low| L::add(low, size))].map(|corner| corner.map(L::from_bits));
        let reflected = |plane: L::Float| L::float(3.0) - plane;
        let mirrored = parting.crossing.mirrored();
        let plain = |corner: &[L::Float; 3], opposite: &[L::Float; 3]| -> [[f32; MAX_LANES]; 3] {
            each(|axis| L::floats(if mirrored[axis] { reflected(opposite[axis]) } else { corner[axis] }))
        };
        let voxels = [plain(&low, &high), plain(&high, &low)];
        let distance = self.rays.entry(ending.entry.map(L::from_bits));
        let names = [ending.node, ending.part];
        let passing = ask::<L>(parting.target.octree, met, self.number, names, &voxels, distance, passes);
        self.rays.start = L::select(passing, self.rays.behind(low), self.rays.start);
        passing
    }

    /// Forgets what the rays of some lanes might come to.
    #[inline(always)]
    fn go_no_further(&mut self, lanes: L::Mask) {
        for waiting in [&mut self.left, &mut self.open].into_iter().chain(&mut self.inner.waiting) {
            *waiting = L::select_word(lanes, L::word(0), *waiting);
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
        // SAFETY: a bit is set only for a node that is there.
        self.coming = unsafe { parting.shared.nodes(number, lanes, &self.coming) };
        self.active = self.active | lanes;
    }

    #[inline(always)]
    fn ask_for_nodes(&self, parting: &Parting<'_, L::Real>) {
        L::prefetch_rows(bytemuck::cast_slice(&parting.target.octree.nodes), self.coming.index);
    }
}

/// What rays meet in the first cell of nodes that they have come to.
#[inline(always)]
fn ending_of<L: Lanes, const LOD: bool>(place: &Place<L>, node: &Content<L>, first: &First<L>) -> Ending<L> {
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
    let size = L::bit(place.exponent);
    let entry = each(|axis| {
        let offset = L::shift_left(first.coordinate[axis], place.exponent);
        L::add(L::add(place.corner[axis], offset), size)
    });
    Ending { node: place.index, part, exponent: L::add(place.exponent, node.levels_up), entry }
}

impl<L: Lanes> First<L> {
    /// The first of some cells that each ray comes to. Where there are none, any.
    #[inline(always)]
    fn of<R: Real>(parting: &Parting<'_, R>, cells: [L::Word; 2]) -> Self {
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
