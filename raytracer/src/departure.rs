//! From what rays met to rays that leave it: shadows, reflections, light from all around.
//!
//! A ray that leaves a surface must not meet the voxel it comes from, whatever was rounded. So not a point above the surface
//! is chosen, by a distance that is never right for all: the voxel itself is known, and the walk begins behind the plane
//! through which the ray leaves it ([`Packet::leaving`]).

use crate::lanes::{Lanes, MAX_LANES, each};
use crate::octree::{MANTISSA_BITS, Octree};
use crate::ray::Packet;
use crate::traversal::Hits;
use glam::Vec3;

/// A point on a voxel, in the traversal's space, not mirrored: a place to leave from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Departure {
    /// A point in the voxel, where a ray came in.
    pub point: Vec3,
    /// Low and high corner of the voxel.
    pub voxel: [Vec3; 2],
}

impl Departure {
    /// The middle of the voxel.
    pub fn middle(&self) -> Vec3 {
        (self.voxel[0] + self.voxel[1]) * 0.5
    }

    /// Where a ray from the point in a direction leaves the voxel.
    pub fn exit(&self, direction: Vec3) -> Vec3 {
        let distance = |axis: usize| {
            let ahead = self.voxel[usize::from(direction[axis] > 0.0)][axis];
            (ahead - self.point[axis]) / direction[axis]
        };
        let crossed = (0..3).filter(|&axis| direction[axis] != 0.0);
        self.point + direction * crossed.map(distance).fold(f32::INFINITY, f32::min)
    }

    /// The voxel's edge.
    pub fn size(&self) -> f32 {
        self.voxel[1].x - self.voxel[0].x
    }
}

/// Low and high corners of voxels, one in each lane, in the traversal's space, not mirrored.
pub(crate) type Voxels = [[[f32; MAX_LANES]; 3]; 2];

/// Where the rays of a packet met something: points on voxels, in the traversal's space, not mirrored.
pub(crate) struct Departures {
    /// A point in the voxel, where the ray came in.
    pub point: [[f32; MAX_LANES]; 3],
    pub voxel: Voxels,
}

impl Departures {
    /// For what `packet` met, with a place in each cell that was met: see [`crate::traversal::trace`].
    pub fn new<L: Lanes>(octree: &Octree, packet: &Packet<L>, hits: &Hits<L>, place: [L::Word; 3]) -> Self {
        let mut departures = Self { point: [[0.0; MAX_LANES]; 3], voxel: [[[0.0; MAX_LANES]; 3]; 2] };
        let size = L::load_words(&sizes(octree, packet, hits, place));
        let within = L::sub(size, L::word(1));
        let mirrored = packet.mirrored();
        let reflected = |plane: L::Float| L::float(3.0) - plane;
        for axis in 0..3 {
            let corner = (place[axis] | within) ^ within;
            let (low, high) = (L::from_bits(corner), L::from_bits(L::add(corner, size)));
            let point = packet.lines.origin[axis] - packet.slope[axis] * hits.distance;
            let point = L::max(L::min(point, high), low);
            let plain = |value, other| L::select(mirrored[axis], reflected(other), value);
            L::store(plain(point, point), &mut departures.point[axis]);
            L::store(plain(low, high), &mut departures.voxel[0][axis]);
            L::store(plain(high, low), &mut departures.voxel[1][axis]);
        }
        departures
    }

    /// Where the ray of `lane` met something.
    pub fn of_lane(&self, lane: usize) -> Departure {
        let of_lane = |values: &[[f32; MAX_LANES]; 3]| Vec3::from_array(values.map(|values| values[lane]));
        Departure { point: of_lane(&self.point), voxel: [of_lane(&self.voxel[0]), of_lane(&self.voxel[1])] }
    }
}

/// The sizes of what was met, in units of the mantissa. A node of one voxel is one, however its cells were met.
fn sizes<L: Lanes>(
    octree: &Octree,
    packet: &Packet<L>,
    hits: &Hits<L>,
    place: [L::Word; 3],
) -> [u32; MAX_LANES] {
    let (node, exponent) = (L::words(hits.node), L::words(hits.exponent));
    let position: [_; 3] = std::array::from_fn(|axis| L::words(place[axis] ^ packet.mirror[axis]));
    let mut sizes = [1; MAX_LANES];
    for lane in (0..L::COUNT).filter(|lane| L::bitmask(hits.hit) >> lane & 1 == 1) {
        let exponent = if octree.nodes[node[lane] as usize].is_uniform() {
            octree.leaf_exponent(position.map(|words| words[lane])) + 2
        } else {
            exponent[lane]
        };
        sizes[lane] = 1 << exponent.min(MANTISSA_BITS);
    }
    sizes
}

/// A ray that leaves a voxel, in the traversal's space, not mirrored.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LeavingRay {
    /// The voxel that it leaves, and where from.
    pub from: Departure,
    /// A unit vector.
    pub direction: Vec3,
    /// Distance at which it ends.
    pub end: f32,
}

/// Rays that leave voxels, in the order in which they are to be traced: those of neighbouring pixels together.
///
/// Only rays that are needed are in the list, so that no lane of a packet is idle but at its end.
#[derive(Debug, Clone, Default)]
pub(crate) struct RayList {
    /// Number of rays; what stands behind them only fills packets of any width.
    length: usize,
    origin: [Vec<f32>; 3],
    direction: [Vec<f32>; 3],
    voxel: [[Vec<f32>; 3]; 2],
    end: Vec<f32>,
}

impl RayList {
    /// A list of these.
    pub fn new(rays: &[LeavingRay]) -> Self {
        let room = rays.len().next_multiple_of(MAX_LANES);
        let column = |of: &dyn Fn(&LeavingRay) -> f32| {
            let mut values: Vec<f32> = rays.iter().map(of).collect();
            values.resize(room, 1.0);
            values
        };
        let columns = |of: &dyn Fn(&LeavingRay) -> Vec3| -> [Vec<f32>; 3] {
            std::array::from_fn(|axis| column(&|ray| of(ray)[axis]))
        };
        Self {
            length: rays.len(),
            origin: columns(&|ray| ray.from.point),
            direction: columns(&|ray| ray.direction),
            voxel: [columns(&|ray| ray.from.voxel[0]), columns(&|ray| ray.from.voxel[1])],
            end: column(&|ray| ray.end),
        }
    }

    /// Number of rays.
    pub fn len(&self) -> usize {
        self.length
    }

    /// Places for the results of all packets, of any width.
    pub fn room(&self) -> usize {
        self.end.len()
    }

    /// The rays from number `first` on.
    #[inline(always)]
    pub fn packet<L: Lanes>(&self, first: usize) -> Packet<L> {
        let load = |values: &[Vec<f32>; 3]| -> [L::Float; 3] { each(|axis| L::load(&values[axis][first..])) };
        let active = L::first(L::COUNT.min(self.length - first));
        let voxel = [load(&self.voxel[0]), load(&self.voxel[1])];
        let mut packet = Packet::leaving(load(&self.origin), load(&self.direction), voxel, active);
        packet.lines.end = L::load(&self.end[first..]);
        packet
    }
}
