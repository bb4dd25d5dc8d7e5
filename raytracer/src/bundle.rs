//! The rays of a beam through the octree, together.
//!
//! Rays that are close to each other go the same way at first, so one walk serves all of them: nodes are visited front to
//! back, and a beam leaves out what no ray can meet. How it ends depends on the size of the cells at which rays stop:
//!
//! - **larger than a pixel**: the walk goes on to their nodes. Which cell of a node each ray enters first is decided for all
//!   rays at once, from the distances to the node's fifteen inner and outer planes, without a step from cell to cell.
//! - **smaller**: few rays meet the same node, so the rays part. The walk ends at nodes of cells some pixels wide; from these on
//!   each ray goes down its own way ([`crate::pursuit`]).
//!
//! Whether a ray visits a cell depends on nothing but the order of the planes by which it enters and leaves it (see
//! [`crate::traversal`]). So the result is the same to the last bit as that of a walk by each ray alone.

use crate::beam::{Beam, Descent, PlacedNode, flipped, mirrored_places};
use crate::camera::{PixelBlock, View};
use crate::crossing::Crossing;
use crate::lanes::{Lanes, Real, Single, each};
use crate::node::Node;
use crate::octree::cell_of_morton;
use crate::parted::Parted;
use crate::pursuit::Parting;
use crate::ray::Packet;
use crate::shared::Shared;
use crate::traversal::{Hits, Path, Target, Visit, part};

/// Rays stay together down to the cells in which they end, if those are wider than this many pixels. Else few rays meet the
/// same node, and each is better off alone.
const TOGETHER_PIXELS: f32 = 1.0;

/// Cells no wider than this many pixels are not opened for all rays together, if these part anyway.
const FINEST_PIXELS: f32 = 3.0;

/// Of nodes with cells wider than this many pixels, it pays to leave out those that are not in the beam before rays are held
/// against them.
const WIDE_PIXELS: f32 = 2.0;

/// A packet on its way, and what its rays have met.
pub(crate) struct Traveller<L: Lanes> {
    pub packet: Packet<L>,
    /// Lanes whose ray has met nothing yet.
    pub pending: L::Mask,
    pub hits: Hits<L>,
    /// Places in the cells that were met; of some lanes, the low corner of the node. In mirrored space.
    place: [L::Word; 3],
    at_node: L::Mask,
}

impl<L: Lanes> Traveller<L> {
    #[inline(always)]
    fn new(packet: Packet<L>) -> Self {
        let (nowhere, none) = ([L::word(0); 3], L::first(0));
        Self { packet, pending: packet.active, hits: Hits::none(), place: nowhere, at_node: none }
    }

    /// Whether all rays run towards larger coordinates on just these axes.
    fn goes(&self, way: [bool; 3]) -> bool {
        let active = L::bitmask(self.packet.active);
        self.packet
            .mirrored()
            .iter()
            .zip(way)
            .all(|(&lanes, mirrored)| L::bitmask(lanes) & active == if mirrored { active } else { 0 })
    }
}

/// What to do at a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Plan {
    /// Go on to the nodes in its cells.
    Open,
    /// All rays end in its filled cells.
    MeetCells,
    /// All rays end in its filled blocks of eight cells.
    MeetBlocks,
    /// From its filled cells on, each ray for itself.
    Part,
    /// From its filled blocks of eight cells on, each ray for itself.
    PartAtBlocks,
    /// All rays end at the node, each for itself.
    Stop,
    /// Each ray for itself from the beginning.
    Alone,
}

/// Room for following one beam after the other.
pub(crate) struct Workspace<L: Lanes> {
    /// The packets of the last beam, one for each block of pixels; none if none of its rays has gone with others.
    pub travellers: Vec<Traveller<L>>,
    pub descent: Descent,
    pub path: Path<L>,
    shared: Shared<L::Real>,
    parted: Parted<L>,
}

impl<L: Lanes> Workspace<L> {
    pub fn new() -> Self {
        Self {
            travellers: Vec::new(),
            descent: Descent::default(),
            path: Path::new(),
            shared: Shared::new(),
            parted: Parted::new(),
        }
    }
}

/// Follows the rays of a beam, those through `blocks`, and leaves what they meet in the workspace: no packets if none of the rays
/// has come to a node.
///
/// `mirrored` is the beam's. `seeds` are nodes, front to back, outside of which the rays meet nothing. With `LOD` and `COUNT` as in
/// [`crate::traversal::trace`]. Returns whether that could be done: not, if some rays are mirrored along other axes after all.
pub(crate) fn trace_together<L: Lanes, const LOD: bool, const COUNT: bool>(
    target: &Target<'_>,
    view: &View,
    beam: &Beam,
    mirrored: [bool; 3],
    seeds: &[PlacedNode],
    blocks: &[PixelBlock<L>],
    workspace: &mut Workspace<L>,
) -> bool {
    let Workspace { travellers, descent, shared, parted, .. } = workspace;
    travellers.clear();
    shared.clear();
    let nodes = &target.octree.nodes;
    let eye = beam.mirrored_eye::<L::Real>(mirrored);
    let crossing = Crossing::new(mirrored);
    descent.begin(mirrored);
    let mut seeds = seeds.iter().filter(|seed| beam.meets(seed));
    loop {
        let next = descent.next(nodes).or_else(|| seeds.next().copied());
        if shared.is_full() || (next.is_none() && !shared.is_empty()) {
            if travellers.is_empty() && !depart(travellers, view, blocks, mirrored) {
                return false;
            }
            parted.follow::<LOD, COUNT>(&Parting { target, crossing, shared }, travellers);
            if !are_pending(travellers) {
                return true;
            }
            shared.clear();
        }
        let Some(node) = next else { return true };
        let farthest = beam.farthest(&node);
        let content = &nodes[node.index as usize];
        match plan::<LOD>(target, beam, &node, content, farthest) {
            Plan::Open => {
                descent.push(node, beam.cells_within::<L::Rough>(&node, content.cells()));
            }
            Plan::Alone => return false,
            plan @ (Plan::MeetCells | Plan::MeetBlocks) if shared.is_empty() => {
                if travellers.is_empty() && !depart(travellers, view, blocks, mirrored) {
                    return false;
                }
                if !meet_node::<L, COUNT>(travellers, beam, mirrored, &node, content, plan) {
                    return true;
                }
            }
            // What comes after the first of these is met by each ray for itself as well.
            plan => {
                let cells = match plan {
                    Plan::MeetBlocks | Plan::PartAtBlocks => whole_blocks(content.cells()),
                    Plan::Stop => u64::MAX,
                    _ => content.cells(),
                };
                let ends_early = LOD && target.lod.may_end_early(target.octree.depth(), farthest);
                let node = node.mirrored(mirrored);
                shared.push(&node, flipped(cells, descent.flip()), eye, ends_early);
            }
        }
    }
}

/// Whether some rays have met nothing yet.
fn are_pending<L: Lanes>(travellers: &[Traveller<L>]) -> bool {
    travellers.iter().any(|traveller| L::any(traveller.pending))
}

/// Makes the rays through some blocks ready; returns whether all of them run towards larger coordinates on just the
/// mirrored axes.
fn depart<L: Lanes>(
    travellers: &mut Vec<Traveller<L>>,
    view: &View,
    blocks: &[PixelBlock<L>],
    mirrored: [bool; 3],
) -> bool {
    // Beams are only of eyes that are near. A loop, for a map is a call and its results are copied.
    for block in blocks {
        travellers.push(Traveller::new(view.near_packet(block)));
    }
    let goes = travellers.iter().all(|traveller| traveller.goes(mirrored));
    if !goes {
        travellers.clear();
    }
    goes
}

/// Ends rays in the cells of a node, or in its blocks of cells, as the plan says; returns whether some go on.
#[inline(never)]
fn meet_node<L: Lanes, const COUNT: bool>(
    travellers: &mut [Traveller<L>],
    beam: &Beam,
    mirrored: [bool; 3],
    node: &PlacedNode,
    content: &Node,
    plan: Plan,
) -> bool {
    let frame = Frame::new(node, content, mirrored, beam.mirrored_eye(mirrored));
    let flip = mirrored_places(mirrored);
    if plan == Plan::MeetBlocks {
        let flip = flip & 7;
        let blocks = flipped(filled_blocks(content.cells()), flip);
        for traveller in &mut *travellers {
            traveller.meet::<2, COUNT>(&frame, blocks, flip);
        }
    } else {
        let mut cells = content.cells();
        if node.cell_size() > WIDE_PIXELS * beam.pixel_at(beam.farthest(node)) {
            cells = beam.cells_within::<L::Rough>(node, cells);
        }
        let cells = flipped(cells, flip);
        for traveller in &mut *travellers {
            traveller.meet::<1, COUNT>(&frame, cells, flip);
        }
    }
    are_pending(travellers)
}

#[inline(always)]
fn plan<const LOD: bool>(
    target: &Target<'_>,
    beam: &Beam,
    node: &PlacedNode,
    content: &Node,
    farthest: f32,
) -> Plan {
    let size = node.cell_size();
    let pixel = beam.pixel_at(farthest);
    // No ray ends in a node above those to which the grid points, but in a voxel.
    let ends_early = LOD && node.exponent <= target.grid.node_exponent() && !content.is_uniform();
    let largest =
        if ends_early { target.lod.largest_cell::<Single>(node.corner, [0; 3], node.exponent) } else { 0.0 };
    if node.is_half() {
        // Its planes are not in the cube.
        if content.is_leaf() { Plan::Alone } else { Plan::Open }
    } else if LOD && node.exponent == target.grid.node_exponent() && 4.0 * size <= largest {
        Plan::Stop
    } else if LOD && 2.0 * size <= largest {
        if 2.0 * size > TOGETHER_PIXELS * pixel { Plan::MeetBlocks } else { Plan::PartAtBlocks }
    } else if content.is_leaf() || size <= largest {
        if size > TOGETHER_PIXELS * pixel { Plan::MeetCells } else { Plan::Part }
    } else if size > FINEST_PIXELS * pixel {
        Plan::Open
    } else {
        Plan::Part
    }
}

/// All cells of those blocks of eight of which some are filled.
fn whole_blocks(cells: u64) -> u64 {
    u64::from_le_bytes(cells.to_le_bytes().map(|byte| if byte == 0 { 0 } else { 0xFF }))
}

/// Which of the eight octree cells of a node are filled.
fn filled_blocks(cells: u64) -> u64 {
    cells.to_le_bytes().iter().enumerate().map(|(block, &byte)| u64::from(byte != 0) << block).sum()
}

/// A node in the mirrored space of a beam.
struct Frame<R> {
    /// The node in mirrored space.
    node: PlacedNode,
    /// Whether all its cells are one voxel.
    is_uniform: bool,
    /// From the eye to the planes between the node's cells: 0 is the lowest, the one through which rays leave the node.
    offset: [[R; 5]; 3],
}

impl<R: Real> Frame<R> {
    #[inline(always)]
    fn new(node: &PlacedNode, content: &Node, mirrored: [bool; 3], eye: [R; 3]) -> Self {
        let node = node.mirrored(mirrored);
        let plane =
            |axis: usize, number: u32| R::from(f32::from_bits(node.corner[axis] + (number << node.exponent)));
        Self {
            node,
            is_uniform: content.is_uniform(),
            offset: each(|axis| std::array::from_fn(|number| plane(axis, number as u32) - eye[axis])),
        }
    }

    /// Distance to a plane: see [`Packet::distance_to`].
    #[inline(always)]
    fn distance<L: Lanes<Real = R>>(&self, packet: &Packet<L>, axis: usize, number: usize) -> L::Float {
        L::quotient(L::real(self.offset[axis][number]), packet.lines.divisor[axis])
    }

    #[inline(always)]
    fn distances<L: Lanes<Real = R>>(&self, packet: &Packet<L>) -> [[L::Float; 5]; 3] {
        each(|axis| {
            let distance = |number: usize| self.distance(packet, axis, number);
            [distance(0), distance(1), distance(2), distance(3), distance(4)]
        })
    }
}

/// For each cell of a node, the numbers of the planes below it.
static CELL_PLANES: [[u8; 4]; 64] = {
    let mut planes = [[0; 4]; 64];
    let mut cell = 0;
    while cell < 64 {
        let [x, y, z] = cell_of_morton(cell as u32);
        planes[cell] = [x as u8, y as u8, z as u8, 0];
        cell += 1;
    }
    planes
};

/// The planes below and above a cell that is `SPAN` planes wide.
#[inline(always)]
fn planes_about<const SPAN: usize>(cell: u32) -> [[usize; 2]; 3] {
    let [x, y, z, _] = CELL_PLANES[cell as usize % 64];
    // The remainders tell the compiler that there are such planes.
    [x, y, z].map(|plane| {
        let low = usize::from(plane) % (4 / SPAN) * SPAN;
        [low, low + SPAN]
    })
}

impl<L: Lanes> Traveller<L> {
    /// Ends rays in the first one that they visit of some cells of a node, `SPAN` planes wide each.
    ///
    /// `cells` are in the order of mirrored space, that of the node with `flip`.
    #[inline(always)]
    fn meet<const SPAN: usize, const COUNT: bool>(&mut self, frame: &Frame<L::Real>, cells: u64, flip: u32) {
        if !L::any(self.pending) {
            return;
        }
        let packet = &self.packet;
        let outer = |number: usize| each(|axis| frame.distance(packet, axis, number));
        let ([x_in, y_in, z_in], [x_out, y_out, z_out]) = (outer(4), outer(0));
        let enter = L::max(L::max(x_in, y_in), L::max(z_in, packet.lines.start));
        let leave = L::min(L::min(x_out, y_out), z_out);
        let tested = self.pending & L::at_most(enter, leave);
        if !L::any(tested) {
            return;
        }
        if COUNT {
            let steps = L::add(self.hits.steps, L::word(1));
            self.hits.steps = L::select_word(tested, steps, self.hits.steps);
            self.hits.packet_steps += 1;
        }
        let (rest, distance, cell) = first_visited::<L, SPAN>(frame, packet, cells, tested);
        let met = tested & !rest;
        let first_part = if SPAN == 1 { 0 } else { part::CELLS };
        // Where all cells are one voxel, the first stands for it.
        let cell = if SPAN == 1 && frame.is_uniform { L::word(0) } else { cell ^ L::word(flip) };
        let place = L::add(cell, L::word(first_part));
        let exponent = L::word(frame.node.exponent + SPAN.ilog2());
        let hits = &mut self.hits;
        hits.hit = hits.hit | met;
        hits.distance = L::select(met, distance, hits.distance);
        hits.part = L::select_word(met, place, hits.part);
        hits.node = L::select_word(met, L::word(frame.node.index), hits.node);
        hits.exponent = L::select_word(met, exponent, hits.exponent);
        self.pending = self.pending & !met;
        let corner = frame.node.corner;
        self.place = each(|axis| L::select_word(met, L::word(corner[axis]), self.place[axis]));
        self.at_node = self.at_node | met;
    }

    /// A place in each cell that was met: see [`crate::traversal::trace`].
    #[inline(always)]
    pub fn place(&self) -> [L::Word; 3] {
        let (zero, one) = (L::word(0), L::word(1));
        // Blocks are above the lower digits of their cells.
        let is_block = L::greater(self.hits.part, L::word(part::CELLS - 1));
        let levels = L::select_word(is_block, one, zero);
        let block = L::shift_left(L::sub(self.hits.part, L::word(part::CELLS)) & L::word(7), L::word(3));
        let cell = L::select_word(is_block, block, self.hits.part);
        let size = L::sub(self.hits.exponent, levels);
        each(|axis| {
            let digits = |shift: u32, digit: u32| L::shift_right(cell, L::word(shift)) & L::word(digit);
            let mirror = self.packet.mirror[axis] & L::word(3);
            let coordinate = (digits(axis as u32, 1) | digits(axis as u32 + 2, 2)) ^ mirror;
            let offset = L::select_word(self.at_node, L::shift_left(coordinate, size), zero);
            L::add(self.place[axis], offset)
        })
    }

    /// Takes what some lanes have met, with a place in each cell, and, with `COUNT`, the steps of all.
    #[inline(always)]
    pub fn take<const COUNT: bool>(&mut self, other: &Hits<L>, place: [L::Word; 3]) {
        let hits = &mut self.hits;
        let met = other.hit;
        hits.hit = hits.hit | met;
        hits.distance = L::select(met, other.distance, hits.distance);
        hits.node = L::select_word(met, other.node, hits.node);
        hits.part = L::select_word(met, other.part, hits.part);
        hits.exponent = L::select_word(met, other.exponent, hits.exponent);
        if COUNT {
            hits.steps = L::add(hits.steps, other.steps);
        }
        self.pending = self.pending & !met;
        self.place = each(|axis| L::select_word(met, place[axis], self.place[axis]));
    }
}

/// Of some cells of a node, the first one that each ray visits: rays that visit none, and the others' distance and cell.
#[inline(always)]
fn first_visited<L: Lanes, const SPAN: usize>(
    frame: &Frame<L::Real>,
    packet: &Packet<L>,
    mut cells: u64,
    lanes: L::Mask,
) -> (L::Mask, L::Float, L::Word) {
    let [x, y, mut z_in] = frame.distances(packet);
    let z_out = z_in;
    for z in &mut z_in {
        // Where a ray begins in a cell, it comes in there.
        *z = L::max(*z, packet.lines.start);
    }
    let all = cells;
    let mut rest = lanes;
    let mut touching = L::first(0);
    let mut distance = L::float(0.0);
    let mut found = L::word(0);
    // Coordinates fall along every ray, so the last cell is met first.
    while cells != 0 && L::any(rest) {
        let cell = cells.ilog2();
        cells ^= 1 << cell;
        let [[x_low, x_high], [y_low, y_high], [z_low, z_high]] = planes_about::<SPAN>(cell);
        let enter = L::max(L::max(x[x_high], y[y_high]), z_in[z_high]);
        let leave = L::min(L::min(x[x_low], y[y_low]), z_out[z_low]);
        let met = rest & L::less(enter, leave);
        touching = touching | (rest & L::same(enter, leave));
        distance = L::select(met, enter, distance);
        found = L::select_word(met, L::word(cell), found);
        rest = rest & !met;
    }
    if L::any(touching) {
        return first_visited_or_touched::<L, SPAN>(frame, packet, all, lanes);
    }
    (rest, distance, found)
}

/// As [`first_visited`], where a ray may meet an edge or a corner of a cell exactly.
#[cold]
#[inline(never)]
fn first_visited_or_touched<L: Lanes, const SPAN: usize>(
    frame: &Frame<L::Real>,
    packet: &Packet<L>,
    mut cells: u64,
    lanes: L::Mask,
) -> (L::Mask, L::Float, L::Word) {
    let [x, y, z] = frame.distances(packet);
    let mut rest = lanes;
    let mut distance = L::float(0.0);
    let mut found = L::word(0);
    while cells != 0 && L::any(rest) {
        let cell = cells.ilog2();
        cells ^= 1 << cell;
        let [[x_low, x_high], [y_low, y_high], [z_low, z_high]] = planes_about::<SPAN>(cell);
        let visit = Visit::new(packet, [x[x_high], y[y_high], z[z_high]], [x[x_low], y[y_low], z[z_low]]);
        let met = rest & visit.visits;
        distance = L::select(met, visit.distance, distance);
        found = L::select_word(met, L::word(cell), found);
        rest = rest & !met;
    }
    (rest, distance, found)
}
