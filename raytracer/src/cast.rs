//! Any rays, one by one or many: what they hit.

use crate::arithmetic::Arithmetic;
use crate::lanes::{Lanes, MAX_LANES};
use crate::lod::LevelOfDetail;
use crate::octree::{MANTISSA, MANTISSA_BITS, Octree, finest_exponent};
use crate::payload::{Payload, PayloadList};
use crate::ray::{Lines, Packet, Placement, Ray};
use crate::traversal::{Hits, Path, Target, part, trace, trace_to_end};
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
        self.hits_with(rays, Arithmetic::Single, width)
    }

    /// As [`Octree::hits`], in an arithmetic.
    #[must_use]
    pub fn hits_with(&self, rays: &[Ray], arithmetic: Arithmetic, width: Width) -> Vec<Option<Hit>> {
        let mut found = Vec::with_capacity(rays.len());
        with_lanes!(arithmetic, width, L => cast::<L, false>(self, rays, |hit, _| found.push(hit)));
        found
    }

    /// Whether anything is on the way of each ray before a distance in units of its direction's length, `width` rays at a
    /// time: sooner known than what it is. Nothing is before a distance that is NaN. The result is the same for every width.
    #[must_use]
    pub fn blocked(&self, rays: &[(Ray, f64)], width: Width) -> Vec<bool> {
        self.blocked_with(rays, Arithmetic::Single, width)
    }

    /// As [`Octree::blocked`], in an arithmetic.
    #[must_use]
    pub fn blocked_with(&self, rays: &[(Ray, f64)], arithmetic: Arithmetic, width: Width) -> Vec<bool> {
        let mut found = Vec::with_capacity(rays.len());
        with_lanes!(arithmetic, width, L => cast_any::<L>(self, rays, |blocked| found.push(blocked)));
        found
    }

    /// What a shader needs to know of a hit.
    pub(crate) fn payload_of(&self, node: u32, hit_part: u32) -> Payload {
        let (list, index) = self.place_of_payload(node, hit_part);
        Payload::new(list.get(index), self.normal_code)
    }

    /// Asks for that to be brought near. Where many hits are looked at one after the other, waiting for memory is shared.
    pub(crate) fn ask_for_payload(&self, node: u32, hit_part: u32) {
        let (list, index) = self.place_of_payload(node, hit_part);
        list.ask_for(index);
    }

    #[inline(always)]
    fn place_of_payload(&self, node: u32, hit_part: u32) -> (&PayloadList, u32) {
        let node = &self.nodes[node as usize];
        match hit_part {
            part::NODE => (&self.lod, node.lod),
            part::CELLS.. => (&self.lod, node.lod_index_of(hit_part - part::CELLS)),
            cell if node.is_leaf() => (&self.voxels, node.index_of(cell)),
            cell => (&self.lod, self.nodes[node.index_of(cell) as usize].lod),
        }
    }
}

/// Follows `rays` and gives `report` each one's hit and, with `COUNT`, effort.
pub(crate) fn cast<L: Lanes, const COUNT: bool>(
    octree: &Octree,
    rays: &[Ray],
    mut report: impl FnMut(Option<Hit>, Effort),
) {
    let mut path = Path::new();
    let target = Target { octree, grid: &octree.grid, lod: LevelOfDetail::EXACT };
    for rays in rays.chunks(L::COUNT) {
        let (packet, placements) = Packet::<L>::from_rays(rays.iter().copied());
        let (hits, place) = trace::<L, false, COUNT>(&target, &packet, &mut path);
        let lanes = Unpacked::<L>::new(&packet, &hits, place);
        for lane in 0..rays.len() {
            report(lanes.hit(octree, lane, &placements[lane]), lanes.effort(lane));
        }
    }
}

/// Follows `rays` up to some distance each and tells `report` of each one whether it met anything.
fn cast_any<L: Lanes>(octree: &Octree, rays: &[(Ray, f64)], mut report: impl FnMut(bool)) {
    let mut path = Path::new();
    let target = Target { octree, grid: &octree.grid, lod: LevelOfDetail::EXACT };
    for rays in rays.chunks(L::COUNT) {
        let (packet, placements) = Packet::<L>::from_rays(rays.iter().map(|(ray, _)| *ray));
        let mut ends = [L::Real::default(); MAX_LANES];
        for ((end, (_, distance)), placement) in ends.iter_mut().zip(rays).zip(&placements) {
            *end = placement.traversed(*distance);
        }
        let lines = Lines { end: L::load_reals(&ends), ..packet.lines };
        let packet = Packet { lines, ..packet };
        let (hits, _) = trace_to_end::<L, false, false>(&target, &packet, &mut path);
        let blocked = L::bitmask(hits.hit);
        (0..rays.len()).for_each(|lane| report(blocked >> lane & 1 == 1));
    }
}

/// The lanes of [`Hits`], in arrays.
struct Unpacked<L: Lanes> {
    hit: u32,
    guarded: u32,
    distance: [L::Real; MAX_LANES],
    node: [u32; MAX_LANES],
    part: [u32; MAX_LANES],
    exponent: [u32; MAX_LANES],
    steps: [u32; MAX_LANES],
    /// Not mirrored.
    position: [[u32; MAX_LANES]; 3],
}

impl<L: Lanes> Unpacked<L> {
    fn new(packet: &Packet<L>, hits: &Hits<L>, place: [L::Word; 3]) -> Self {
        Self {
            hit: L::bitmask(hits.hit),
            guarded: L::bitmask(hits.guarded),
            distance: L::reals(hits.distance),
            node: L::words(hits.node),
            part: L::words(hits.part),
            exponent: L::words(hits.exponent),
            steps: L::words(hits.steps),
            position: std::array::from_fn(|axis| L::words(place[axis] ^ packet.mirror[axis])),
        }
    }

    fn hit(&self, octree: &Octree, lane: usize, placement: &Placement) -> Option<Hit> {
        let finest = finest_exponent(octree.depth());
        // A root that covers one level has cells of twice the cube above it.
        let exponent = self.exponent[lane].min(MANTISSA_BITS);
        let corner = |axis: usize| {
            let mantissa = self.position[axis][lane] & MANTISSA;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use glam::DVec3;
    use octvox_format::{Palette, SphericalNormal, Voxel, Writer};

    /// One corner of the cube is filled.
    fn corner() -> Octree {
        let mut writer = Writer::new(Vec::new(), &Palette::new(vec![[9, 9, 9]]).unwrap()).unwrap();
        let voxel = Voxel { palette_index: 1, normal: SphericalNormal { theta: 0, phi: 0 } };
        for level in 0..4 {
            for _ in 0..if level == 0 { 0 } else { 7 } {
                writer.leaf(Voxel::EMPTY).unwrap();
            }
            if level == 3 { writer.leaf(voxel).unwrap() } else { writer.node(voxel).unwrap() }
        }
        Octree::from_bytes(&writer.finish().unwrap()).unwrap()
    }

    #[test]
    fn a_ray_is_blocked_by_what_it_hits_before_its_end() {
        let octree = corner();
        let random = &mut Random::stream(3, 0);
        let mut part = || f64::from(random.between(0, 1 << 20)) / f64::from(1 << 20);
        let rays: Vec<(Ray, f64)> = (0..4000)
            .map(|number| {
                let target = DVec3::new(0.875 + part() / 8.0, 0.875 + part() / 8.0, 0.8 + part() / 4.0);
                let far = if number % 2 == 0 { 1.0 } else { 1000.0 };
                let origin = DVec3::new(part() - 2.0, part() * 2.0, part() - 1.0) * far;
                (Ray { origin, direction: (target - origin) * 0.01 }, part() * 200.0)
            })
            .collect();
        let without_ends: Vec<Ray> = rays.iter().map(|(ray, _)| *ray).collect();
        let expected: Vec<bool> = octree
            .hits(&without_ends, Width::One)
            .iter()
            .zip(&rays)
            .map(|(hit, (_, end))| hit.is_some_and(|hit| hit.distance < *end))
            .collect();
        assert!(expected.iter().filter(|&&blocked| blocked).count() > 500);
        assert!(expected.iter().filter(|&&blocked| !blocked).count() > 500);
        for width in Width::ALL {
            assert_eq!(octree.blocked(&rays, width), expected, "{width:?}");
        }
        // Just at a hit, and the next number behind it.
        let hits = octree.hits(&without_ends, Width::One);
        for (ray, hit) in without_ends.iter().zip(&hits).filter_map(|(ray, hit)| Some((ray, hit.as_ref()?))) {
            let ends = [hit.distance, hit.distance.next_up(), f64::NAN].map(|end| (*ray, end));
            assert_eq!(octree.blocked(&ends, Width::Four), [false, true, false], "{ray:?}");
        }
        let endless: Vec<(Ray, f64)> = without_ends.iter().map(|ray| (*ray, f64::INFINITY)).collect();
        assert!(octree.blocked(&endless, Width::Eight).iter().zip(hits).all(|(a, b)| *a == b.is_some()));
    }
    #[test]
    fn directions_that_are_hardly_there_are_blocked_too() {
        let octree = corner();
        let direction = DVec3::splat(f64::from_bits(1));
        for (origin, end) in [(0.9, 1.0), (0.9, f64::INFINITY), (0.5, f64::INFINITY)] {
            let ray = Ray { origin: DVec3::splat(origin), direction };
            assert!(octree.hit(&ray).is_some());
            assert_eq!(octree.blocked(&[(ray, end)], Width::One), [true]);
        }
    }
}
