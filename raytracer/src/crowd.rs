//! Rays from anywhere, such as those that leave surfaces, a few packets at a time.
//!
//! Those that run the same way, towards larger coordinates along the same axes, are followed together from the root on, as the rays
//! of a beam are that have parted ([`crate::parted`]). Where they run many ways, each packet walks alone ([`crate::traversal`]): the
//! few rays of each way would have the whole way down for themselves. What a ray meets is the same.

use crate::beam::{Descent, PlacedNode};
use crate::crossing::Crossing;
use crate::ends::RAYS;
use crate::lanes::{Lanes, each};
use crate::parted::Parted;
use crate::passing::{Passes, trace_past};
use crate::pursuit::Parting;
use crate::ray::Packet;
use crate::shared::Shared;
use crate::traversal::{Hits, Path, Target, trace_to_end};

/// Rays that run more ways than this walk alone.
const MOST_WAYS: u32 = 2;

/// Room for one crowd after the other.
pub(crate) struct Crowd<L: Lanes> {
    parted: Parted<L>,
    shared: Shared<L::Real>,
    descent: Descent,
    path: Path<L>,
}

impl<L: Lanes> Crowd<L> {
    /// Packets at a time.
    pub const PACKETS: usize = RAYS / L::COUNT;

    pub fn new() -> Self {
        Self { parted: Parted::new(), shared: Shared::new(), descent: Descent::default(), path: Path::new() }
    }

    /// Finds what each ray of at most [`Crowd::PACKETS`] packets meets first before its end and does not go past, as `passes` tells;
    /// rays have numbers in the order of their packets' lanes. `take` gets the number of a packet, what was met, and a place in
    /// each cell that was, the bits of a mirrored float in [1, 2) per axis. With `LOD` and `COUNT` as in
    /// [`crate::traversal::trace`], but that of rays that are followed together the nodes are counted, not the cells.
    pub fn first_hits<const LOD: bool, const COUNT: bool>(
        &mut self,
        target: &Target<'_>,
        packets: &[Packet<L>],
        mut passes: Option<&mut Passes<'_>>,
        mut take: impl FnMut(usize, &Hits<L>, [L::Word; 3]),
    ) {
        assert!(packets.len() <= Self::PACKETS, "{} packets", packets.len());
        let mut ways = 0u32;
        for packet in packets {
            let (way, running) = (L::words(way_of(packet)), L::bitmask(packet.active));
            ways |= (0..L::COUNT)
                .filter(|lane| running >> lane & 1 == 1)
                .fold(0, |ways, lane| ways | 1 << way[lane]);
        }
        // Of a root of one level, not all planes are in the cube.
        if target.octree.depth() <= 1 || target.octree.nodes.is_empty() || ways.count_ones() > MOST_WAYS {
            for (number, packet) in packets.iter().enumerate() {
                let path = &mut self.path;
                let (hits, place) = match passes.as_deref_mut() {
                    Some(passes) => trace_past::<L, LOD>(target, packet, path, number * L::COUNT, passes),
                    None => trace_to_end::<L, LOD, COUNT>(target, packet, path),
                };
                take(number, &hits, place);
            }
            return;
        }
        self.parted.forget::<COUNT>();
        for way in (0..8).filter(|way| ways >> way & 1 == 1) {
            let mirrored = each(|axis| way >> axis & 1 == 1);
            self.share_root(target, mirrored);
            let parting = Parting { target, crossing: Crossing::new(mirrored), shared: &self.shared };
            let going = packets
                .iter()
                .map(|packet| (&packet.lines, packet.active & L::same_word(way_of(packet), L::word(way))));
            self.parted.run::<LOD, COUNT, true>(&parting, going, passes.as_deref_mut());
        }
        let ends = self.parted.ends();
        for (number, packet) in packets.iter().enumerate() {
            let first = number * L::COUNT;
            let mut hits = ends.of_packet(first, &packet.lines);
            hits.hit = hits.hit & L::less(hits.distance, packet.lines.end);
            if COUNT && number == 0 {
                hits.packet_steps = ends.packet_steps();
            }
            take(number, &hits, ends.places::<L>(first));
        }
    }

    /// Lets all rays that are mirrored along some axes begin at the root, or, if the cube is only a part of it, in that.
    fn share_root(&mut self, target: &Target<'_>, mirrored: [bool; 3]) {
        let Self { shared, descent, .. } = self;
        let nodes = &target.octree.nodes;
        let root = PlacedNode::root(target.octree);
        shared.clear();
        if !root.is_half() {
            return shared.push_for_all(&root.mirrored(mirrored));
        }
        descent.begin(mirrored);
        descent.push(root, nodes[root.index as usize].cells() & root.in_cube());
        while let Some(node) = descent.next(nodes) {
            shared.push_for_all(&node.mirrored(mirrored));
        }
    }
}

/// The axes along which each ray is mirrored, x being worth 1, y 2 and z 4.
#[inline(always)]
fn way_of<L: Lanes>(packet: &Packet<L>) -> L::Word {
    let along = |axis: usize| packet.mirror[axis] & L::word(1 << axis);
    along(0) | along(1) | along(2)
}
