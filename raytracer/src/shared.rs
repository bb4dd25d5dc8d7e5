//! Nodes that the rays of a beam share, before each goes on alone from them ([`crate::pursuit`]).

use crate::beam::PlacedNode;
use crate::lanes::{Lanes, Real, each};
use crate::node::extent;
use crate::octree::{MANTISSA, MANTISSA_BITS};
use crate::ray::Lines;

/// How many nodes are shared at a time, one bit of a word for each. The rays end at the first few in most cases: with many more of
/// them each packet asks about nodes in vain, with fewer its lanes wait for each other.
pub(crate) const MOST_SHARED: usize = 12;

/// Nodes, front to back, from which rays go on alone.
pub(crate) struct Shared<R> {
    /// Their low corners in mirrored space, of the first of whose coordinates only the mantissa is kept, below the exponent of the
    /// node's cells; and their indices.
    rows: Vec<[u32; 4]>,
    /// For each, from the eye to the planes about those of its cells that rays may come to: per axis the high and the low one.
    /// None, if any ray may come to any of them.
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

    /// The largest exponent of the cells of a node.
    pub fn coarsest(&self) -> u32 {
        self.coarsest
    }

    /// Whether rays may end above the finest cells in some of them.
    pub fn ends_early(&self) -> bool {
        self.ends_early
    }

    pub fn is_full(&self) -> bool {
        self.rows.len() == MOST_SHARED
    }

    /// Adds a node in mirrored space, behind all others. Of its cells, in the order of mirrored space, rays may come to some; there
    /// is one. `ends_early` says whether they may end above the finest ones.
    pub fn push(&mut self, node: &PlacedNode, cells: u64, eye: [R; 3], ends_early: bool) {
        self.push_for_all(node);
        let extent = extent(cells);
        self.about.push(each(|axis| {
            let [low, high] = extent[axis].map(|plane| {
                R::from(f32::from_bits(node.corner[axis] + (plane << node.exponent))) - eye[axis]
            });
            [high, low]
        }));
        self.ends_early |= ends_early;
    }

    /// As [`Shared::push`], for rays from anywhere: they find out there whether they come to it. With such nodes there are no others.
    pub fn push_for_all(&mut self, node: &PlacedNode) {
        debug_assert!(!self.is_full());
        let [x, y, z] = node.corner;
        self.rows.push([x & MANTISSA | node.exponent << MANTISSA_BITS, y, z, node.index]);
        self.coarsest = self.coarsest.max(node.exponent);
    }

    /// For each ray the nodes to whose cells it may come; the first one is the highest bit.
    #[inline(always)]
    pub fn entered<L: Lanes<Real = R>>(&self, rays: &Lines<L>) -> L::Word {
        if self.about.is_empty() {
            return L::word(((1 << self.rows.len()) - 1) << (MOST_SHARED - self.rows.len()));
        }
        let mut entered = L::word(0);
        let mut bit = 1 << (MOST_SHARED - 1);
        for about in &self.about {
            let plane =
                |axis: usize, side: usize| L::quotient(L::real(about[axis][side]), rays.divisor[axis]);
            let enter = L::max(L::max(plane(0, 0), plane(1, 0)), L::max(plane(2, 0), rays.start));
            let leave = L::min(L::min(plane(0, 1), plane(1, 1)), plane(2, 1));
            entered = L::select_word(L::at_most(enter, leave), entered | L::word(bit), entered);
            bit >>= 1;
        }
        entered
    }

    /// In some lanes the nodes of some numbers, elsewhere others.
    ///
    /// # Safety
    /// In each of these lanes `number` is that of a node: the place, from the highest of [`MOST_SHARED`] bits, of a bit of
    /// [`Shared::entered`].
    #[inline(always)]
    pub unsafe fn nodes<L: Lanes>(&self, number: L::Word, lanes: L::Mask, others: &Place<L>) -> Place<L> {
        let Place { index, corner: [x, y, z], exponent } = *others;
        // SAFETY: the caller promises that the rows are there.
        let [x, y, z, index] = unsafe { L::gather_rows(&self.rows, number, lanes, [x, y, z, index]) };
        let corner = (x & L::word(MANTISSA)) | L::word(1f32.to_bits());
        Place {
            index,
            corner: [L::select_word(lanes, corner, x), y, z],
            exponent: L::select_word(lanes, L::shift_right(x, L::word(MANTISSA_BITS)), exponent),
        }
    }
}

/// Nodes, and where they are in mirrored space.
#[derive(Clone, Copy)]
pub(crate) struct Place<L: Lanes> {
    pub index: L::Word,
    /// Their low corners: the bits of floats in [1, 2).
    pub corner: [L::Word; 3],
    /// Their cells are of size `1 << exponent`.
    pub exponent: L::Word,
}
