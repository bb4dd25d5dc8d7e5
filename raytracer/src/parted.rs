//! Rays that have parted, of a beam or of a crowd: packets that take turns, and close ranks when rays are at their end.
//!
//! Rays end after a step or after ten. Where the lanes of some packets are idle enough, the rays of one packet go on in those of the
//! others, so that a step serves nearly as many rays as there are lanes. What a ray meets does not depend on its lane.

use crate::bits::ones;
use crate::bundle::Traveller;
use crate::ends::Ends;
use crate::lanes::Lanes;
use crate::passing::Passes;
use crate::pursuit::{Parting, Pursuit};
use crate::ray::Lines;
use std::ops::Range;

/// Packets close ranks where they have room for the rays of one of them, and this many more: else several would have to take
/// some, and that costs more than a step of one.
const SPARE_LANES: u32 = 2;

/// Room for the rays of one beam or crowd after the other.
pub(crate) struct Parted<L: Lanes> {
    pursuits: Vec<Pursuit<L>>,
    ends: Ends,
}

impl<L: Lanes> Parted<L> {
    pub fn new() -> Self {
        Self { pursuits: Vec::new(), ends: Ends::new() }
    }

    /// Follows the rays of a beam that have met nothing yet from shared nodes on, each for itself. With `LOD` and `COUNT` as in
    /// [`crate::traversal::trace`].
    pub fn follow<const LOD: bool, const COUNT: bool>(
        &mut self,
        parting: &Parting<'_, L::Real>,
        travellers: &mut [Traveller<L>],
    ) {
        let pending = travellers.iter().map(|traveller| (&traveller.packet.lines, traveller.pending));
        self.forget::<COUNT>();
        let begun = if LOD && parting.shared.ends_early() {
            self.run::<true, COUNT, false>(parting, pending, None)
        } else {
            self.run::<false, COUNT, false>(parting, pending, None)
        };
        for number in ones(begun) {
            let number = number as usize;
            let traveller = &mut travellers[number];
            let hits = self.ends.of_packet(number * L::COUNT, &traveller.packet.lines);
            traveller.take::<COUNT>(&hits, self.ends.places::<L>(number * L::COUNT));
        }
        if COUNT && let Some(first) = travellers.first_mut() {
            first.hits.packet_steps += self.ends.packet_steps();
        }
    }

    /// Forgets what has been met.
    pub fn forget<const COUNT: bool>(&mut self) {
        self.ends.clear::<COUNT>();
    }

    /// What has been met.
    pub fn ends(&self) -> &Ends {
        &self.ends
    }

    /// Follows the rays of some lanes of packets, each for itself, from shared nodes on; returns the packets of which some came to
    /// anything. With `LOD`, `COUNT`, `ENDS` and `passes` as in [`Pursuit::step`].
    #[inline(always)]
    pub fn run<'p, const LOD: bool, const COUNT: bool, const ENDS: bool>(
        &mut self,
        parting: &Parting<'_, L::Real>,
        packets: impl Iterator<Item = (&'p Lines<L>, L::Mask)>,
        passes: Option<&mut Passes<'_>>,
    ) -> u64 {
        let Self { pursuits, ends } = self;
        let mut begun = 0u64;
        for (number, (rays, lanes)) in packets.enumerate() {
            if number == pursuits.len() {
                pursuits.push(Pursuit::new(*rays));
            }
            let begins = L::any(lanes) && pursuits[number].begin(parting, rays, lanes, number * L::COUNT);
            begun |= u64::from(begins) << number;
        }
        take_turns::<L, LOD, COUNT, ENDS>(parting, pursuits, ends, begun, passes);
        begun
    }
}

/// Lets some packets take turns, a step each, until all are at their end: what one asks memory for comes while others calculate.
fn take_turns<L: Lanes, const LOD: bool, const COUNT: bool, const ENDS: bool>(
    parting: &Parting<'_, L::Real>,
    pursuits: &mut [Pursuit<L>],
    ends: &mut Ends,
    mut running: u64,
    mut passes: Option<&mut Passes<'_>>,
) {
    while running != 0 {
        // Not at their end.
        let mut rays = 0;
        for number in ones(running) {
            let pursuit = &mut pursuits[number as usize];
            let still_running = pursuit.step::<LOD, COUNT, ENDS>(parting, ends, passes.as_deref_mut());
            if still_running == 0 {
                running ^= 1 << number;
            }
            rays += still_running.count_ones();
        }
        while rays != 0 && (running.count_ones() - 1) * L::COUNT as u32 >= rays + SPARE_LANES {
            running ^= 1 << close_ranks(pursuits, running, parting.levels());
        }
    }
}

/// Lets the packet that has the fewest rays give them to others, which have room for them; returns its number.
#[inline(never)]
fn close_ranks<L: Lanes>(pursuits: &mut [Pursuit<L>], running: u64, levels: Range<u32>) -> usize {
    let fewest = |pursuits: &[Pursuit<L>], packets: u64| {
        let numbers = ones(packets).map(|number| number as usize);
        numbers.min_by_key(|&number| pursuits[number].running().count_ones())
    };
    let giver = fewest(pursuits, running).unwrap_or(0);
    while pursuits[giver].running() != 0
        && let Some(taker) = fewest(pursuits, running ^ 1 << giver)
        && let Ok([giver, taker]) = pursuits.get_disjoint_mut([giver, taker])
    {
        giver.hand_over(taker, levels.clone());
    }
    debug_assert_eq!(pursuits[giver].running(), 0, "others have room");
    giver
}
