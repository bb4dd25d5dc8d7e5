//! Rays that go past some of what they meet, such as voxels of the surface that they leave ([`crate::surface::Tangent`]).
//!
//! Such a ray begins anew just behind the voxel, on the line that it is on: nothing on its way changes by that but where it
//! begins. Rays that are followed together do so in their lanes, without the way down again ([`crate::pursuit`]).

use crate::bits::ones;
use crate::departure::{Departures, Voxels};
use crate::ends::RAY_NUMBERS;
use crate::lanes::{Lanes, each};
use crate::octree::Octree;
use crate::ray::Packet;
use crate::traversal::{Hits, Path, Target, trace_to_end};
use glam::Vec3;

/// A voxel that a ray has met, in the traversal's space, not mirrored.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Met {
    /// The number of the ray among those that are followed together.
    pub ray: usize,
    /// With `part`, names the voxel in the octree.
    pub node: u32,
    pub part: u32,
    /// Low and high corner of the voxel.
    pub voxel: [Vec3; 2],
    /// Distance along the ray at which it comes into the voxel.
    pub distance: f32,
}

/// Tells whether a ray goes past what it has met. The answer depends on nothing but these two, and how often the ray has been
/// asked about.
pub(crate) type Passes<'p> = dyn FnMut(&Met) -> bool + 'p;

/// Asks about what rays have met in some lanes; returns those lanes whose rays go past it. `number` and `distance` are the rays',
/// `node` and `part` name the voxels.
#[inline(always)]
pub(crate) fn ask<L: Lanes>(
    octree: &Octree,
    lanes: L::Mask,
    number: L::Word,
    [node, part]: [L::Word; 2],
    voxels: &Voxels,
    distance: L::Float,
    passes: &mut Passes<'_>,
) -> L::Mask {
    let lanes = L::bitmask(lanes);
    let [number, node, part] = [number, node, part].map(L::words);
    let distance = L::floats(distance);
    for lane in ones(lanes).map(|lane| lane as usize) {
        octree.ask_for_payload(node[lane], part[lane]);
    }
    let mut passing = 0;
    for lane in ones(lanes).map(|lane| lane as usize) {
        let met = Met {
            ray: number[lane] as usize,
            node: node[lane],
            part: part[lane],
            voxel: voxels.each_ref().map(|corner| Vec3::from_array(corner.map(|of_lanes| of_lanes[lane]))),
            distance: distance[lane],
        };
        passing |= u32::from(passes(&met)) << lane;
    }
    L::from_bitmask(passing)
}

/// As [`trace_to_end`] without counting, for rays that go past some of what they meet. The first one is number `first` of
/// those that are followed together.
pub(crate) fn trace_past<L: Lanes, const LOD: bool>(
    target: &Target<'_>,
    packet: &Packet<L>,
    path: &mut Path<L>,
    first: usize,
    passes: &mut Passes<'_>,
) -> (Hits<L>, [L::Word; 3]) {
    let (mut hits, mut place) = trace_to_end::<L, LOD, false>(target, packet, path);
    let number = L::load_words(&RAY_NUMBERS[first..]);
    let mut rest = *packet;
    // What has been met last, and how far from where the ray began last.
    let (mut met, mut distance) = (hits.hit, hits.distance);
    while L::any(met) {
        let voxels = Departures::new(target.octree, packet, &Hits { hit: met, ..hits }, place).voxel;
        let names = [hits.node, hits.part];
        let passing = ask::<L>(target.octree, met, number, names, &voxels, distance, passes);
        if !L::any(passing) {
            break;
        }
        let voxels = voxels.each_ref().map(|corner| corner.each_ref().map(|of_lanes| L::load(of_lanes)));
        rest.active = passing;
        rest.lines.start = L::select(passing, rest.behind(voxels), rest.lines.start);
        let (found, at) = trace_to_end::<L, LOD, false>(target, &rest, path);
        hits = Hits::chosen(passing, &found, &hits);
        place = each(|axis| L::select_word(passing, at[axis], place[axis]));
        (met, distance) = (found.hit, found.distance);
        // Where a cell is entered does not depend on where its ray began anew.
        let size = L::bit(hits.exponent);
        let within = L::sub(size, L::word(1));
        let upper = each(|axis| L::from_bits(L::add((place[axis] | within) ^ within, size)));
        hits.distance = L::select(met, packet.lines.entry(upper), hits.distance);
    }
    (hits, place)
}
