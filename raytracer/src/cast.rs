//! Any rays, one by one or many: what they hit.

use crate::lanes::{Lanes, MAX_LANES};
use crate::octree::{MANTISSA_BITS, Octree, finest_exponent};
use crate::payload::Payload;
use crate::ray::{Packet, Placement, Ray};
use crate::traversal::{Hits, Path, Scene, part, trace_to_cell};
use crate::width::{Width, with_lanes};

/// What a ray hit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Distance to the face through which the ray enters the cell, in units of its direction's length.
    pub distance: f64,
    /// The cell's lowest finest cell.
    pub cell: [u32; 3],
    /// The cell is `1 << size_log2` finest cells wide: 0 except where like voxels are stored as one. How much of such a
    /// large voxel counts as the cell depends on the grid through which the ray came; distance and payload do not.
    pub size_log2: u32,
    /// What the cell looks like.
    pub payload: Payload,
}

/// What happened to a ray, besides its hit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Effort {
    /// Cells visited.
    pub steps: u32,
    /// Whether the bound on the number of steps stopped it.
    pub guarded: bool,
}

impl Octree {
    /// The first filled cell on the way of a ray, if any.
    ///
    /// A ray whose origin is in a filled cell hits it at distance 0. A ray that is not finite or has no direction
    /// hits nothing.
    #[must_use]
    pub fn hit(&self, ray: &Ray) -> Option<Hit> {
        self.hits(std::slice::from_ref(ray), Width::One)[0]
    }

    /// The first filled cell on the way of each ray, `width` rays at a time. The result is the same for every width.
    #[must_use]
    pub fn hits(&self, rays: &[Ray], width: Width) -> Vec<Option<Hit>> {
        let mut found = Vec::with_capacity(rays.len());
        with_lanes!(width, L => cast::<L, false>(self, rays, |hit, _| found.push(hit)));
        found
    }

    /// What a shader needs to know of a hit.
    pub(crate) fn payload_of(&self, node: u32, hit_part: u32) -> Payload {
        let node = &self.nodes[node as usize];
        let word = match hit_part {
            part::NODE => self.lod.get(node.lod),
            part::CELLS.. => self.lod.get(node.lod_index_of(hit_part - part::CELLS)),
            cell if node.is_leaf() => self.voxels.get(node.index_of(cell)),
            cell => self.lod.get(self.nodes[node.index_of(cell) as usize].lod),
        };
        Payload::new(word, self.normal_code)
    }
}

/// Follows `rays` and gives `report` each one's hit and, with `COUNT`, effort.
pub(crate) fn cast<L: Lanes, const COUNT: bool>(
    octree: &Octree,
    rays: &[Ray],
    mut report: impl FnMut(Option<Hit>, Effort),
) {
    let mut path = Path::new();
    let scene = Scene { octree, grid: &octree.grid, footprint: 0.0 };
    for rays in rays.chunks(L::COUNT) {
        let (packet, placements) = Packet::<L>::from_rays(rays);
        let (hits, place) = trace_to_cell::<L, false, COUNT>(&scene, &packet, &mut path);
        let lanes = Unpacked::new(&packet, &hits, place);
        for lane in 0..rays.len() {
            report(lanes.hit(octree, lane, &placements[lane]), lanes.effort(lane));
        }
    }
}

/// The lanes of [`Hits`], in arrays.
struct Unpacked {
    hit: u32,
    guarded: u32,
    distance: [f32; MAX_LANES],
    node: [u32; MAX_LANES],
    part: [u32; MAX_LANES],
    exponent: [u32; MAX_LANES],
    steps: [u32; MAX_LANES],
    /// Not mirrored.
    position: [[u32; MAX_LANES]; 3],
}

impl Unpacked {
    fn new<L: Lanes>(packet: &Packet<L>, hits: &Hits<L>, place: [L::Word; 3]) -> Self {
        let words = |value| {
            let mut words = [0; MAX_LANES];
            L::store_words(value, &mut words);
            words
        };
        let mut distance = [0.0; MAX_LANES];
        L::store(hits.distance, &mut distance);
        Self {
            hit: L::bitmask(hits.hit),
            guarded: L::bitmask(hits.guarded),
            distance,
            node: words(hits.node),
            part: words(hits.part),
            exponent: words(hits.exponent),
            steps: words(hits.steps),
            position: std::array::from_fn(|axis| words(place[axis] ^ packet.mirror[axis])),
        }
    }

    fn hit(&self, octree: &Octree, lane: usize, placement: &Placement) -> Option<Hit> {
        let finest = finest_exponent(octree.depth());
        // A root that covers one level has cells of twice the cube above it.
        let exponent = self.exponent[lane].min(MANTISSA_BITS);
        let corner = |axis: usize| {
            let mantissa = self.position[axis][lane] & ((1 << MANTISSA_BITS) - 1);
            mantissa >> exponent << exponent >> finest
        };
        (self.hit >> lane & 1 == 1).then(|| Hit {
            distance: placement.distance(self.distance[lane]),
            cell: [corner(0), corner(1), corner(2)],
            size_log2: exponent - finest,
            payload: octree.payload_of(self.node[lane], self.part[lane]),
        })
    }

    fn effort(&self, lane: usize) -> Effort {
        Effort { steps: self.steps[lane], guarded: self.guarded >> lane & 1 == 1 }
    }
}
