//! Where rays have ended that went alone: by their number in their beam or crowd, for they change places on the way.

use crate::beam::BEAM_SIZE;
use crate::bits::ones;
use crate::lanes::{Lanes, MAX_LANES, each};
use crate::ray::Lines;
use crate::traversal::Hits;

/// Rays of a beam, and the most of a crowd.
pub(crate) const RAYS: usize = (BEAM_SIZE * BEAM_SIZE) as usize;

/// All numbers of rays.
pub(crate) static RAY_NUMBERS: [u32; RAYS] = {
    let mut numbers = [0; RAYS];
    let mut number = 0;
    while number < RAYS {
        numbers[number] = number as u32;
        number += 1;
    }
    numbers
};

/// What the lanes of a packet have met: as in [`Hits`].
pub(crate) struct Ending<L: Lanes> {
    pub node: L::Word,
    pub part: L::Word,
    pub exponent: L::Word,
    /// Where the planes meet through which their cells are entered, in mirrored space.
    pub entry: [L::Word; 3],
}

/// Words of an ending.
const WORDS: usize = 6;

/// What the rays of a beam or of a crowd have met.
pub(crate) struct Ends {
    /// Bit `i` is ray `i`.
    hit: u64,
    words: [[u32; RAYS]; WORDS],
    steps: [u32; RAYS],
    packet_steps: u32,
    /// Room for the lanes of a packet.
    lanes: [[u32; MAX_LANES]; WORDS],
    numbers: [u32; MAX_LANES],
}

impl Ends {
    pub fn new() -> Self {
        Self {
            hit: 0,
            words: [[0; RAYS]; WORDS],
            steps: [0; RAYS],
            packet_steps: 0,
            lanes: [[0; MAX_LANES]; WORDS],
            numbers: [0; MAX_LANES],
        }
    }

    /// Forgets what has been met.
    pub fn clear<const COUNT: bool>(&mut self) {
        self.hit = 0;
        if COUNT {
            self.steps = [0; RAYS];
            self.packet_steps = 0;
        }
    }

    /// Takes what the rays of some lanes have met.
    #[inline(always)]
    pub fn end_rays<L: Lanes>(&mut self, number: L::Word, lanes: L::Mask, ending: &Ending<L>) {
        let Ending { node, part, exponent, entry: [x, y, z] } = *ending;
        for (word, lanes) in [node, part, exponent, x, y, z].into_iter().zip(&mut self.lanes) {
            L::store_words(word, lanes);
        }
        L::store_words(number, &mut self.numbers);
        for lane in ones(L::bitmask(lanes)) {
            let lane = lane as usize;
            let ray = self.numbers[lane] as usize % RAYS;
            self.hit |= 1 << ray;
            for (words, lanes) in self.words.iter_mut().zip(&self.lanes) {
                words[ray] = lanes[lane];
            }
        }
    }

    /// Counts a step of the rays in some lanes.
    pub fn count_step<L: Lanes>(&mut self, number: L::Word, lanes: u32) {
        let numbers = L::words(number);
        for lane in (0..L::COUNT).filter(|lane| lanes >> lane & 1 == 1) {
            self.steps[numbers[lane] as usize % RAYS] += 1;
        }
        self.packet_steps += 1;
    }

    /// Steps of packets that have been counted.
    pub fn packet_steps(&self) -> u32 {
        self.packet_steps
    }

    /// Places in the cells that the rays of a packet have met, the first of which is number `first` of all: the bits of mirrored
    /// floats in [1, 2) per axis.
    #[inline(always)]
    pub fn places<L: Lanes>(&self, first: usize) -> [L::Word; 3] {
        let [_, _, _, entry @ ..] = &self.words;
        each(|axis| L::sub(L::load_words(&entry[axis][first..]), L::word(1)))
    }

    /// What the rays of a packet have met, the first of which is number `first` of all.
    #[inline(always)]
    pub fn of_packet<L: Lanes>(&self, first: usize, rays: &Lines<L>) -> Hits<L> {
        let [node, part, exponent, entry @ ..] = &self.words;
        let load = |words: &[u32; RAYS]| L::load_words(&words[first..]);
        Hits {
            hit: L::from_bitmask((self.hit >> first) as u32),
            distance: rays.entry(each(|axis| L::from_bits(load(&entry[axis])))),
            node: load(node),
            part: load(part),
            exponent: load(exponent),
            steps: load(&self.steps),
            packet_steps: 0,
            guarded: L::first(0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::Eight;
    use crate::random::Random;

    /// What was met comes back in the order of rays, from whichever lanes it came.
    #[test]
    fn rays_end_by_their_number() {
        let random = &mut Random::stream(15, 0);
        let ends = &mut Ends::new();
        for _ in 0..200 {
            ends.clear::<true>();
            // In any order.
            let mut numbers = RAY_NUMBERS;
            for last in (1..RAYS).rev() {
                numbers.swap(last, random.between(0, last as i32 + 1) as usize);
            }
            let met = random.next();
            for numbers in numbers.chunks(Eight::COUNT) {
                let number = Eight::load_words(numbers);
                let word = |by: u32| Eight::add(number, Eight::word(by));
                let ending = Ending {
                    node: word(100),
                    part: word(200),
                    exponent: word(300),
                    entry: [word(1f32.to_bits()), word(2f32.to_bits()), word(0)],
                };
                let lanes = numbers.iter().enumerate();
                let lanes: u32 = lanes.map(|(lane, &number)| ((met >> number & 1) as u32) << lane).sum();
                ends.end_rays::<Eight>(number, Eight::from_bitmask(lanes), &ending);
                ends.count_step::<Eight>(number, lanes);
            }
            let one = Eight::float(1.0);
            let lines =
                Lines::<Eight> { origin: [one; 3], divisor: [one; 3], start: Eight::float(0.0), end: one };
            for first in (0..RAYS).step_by(Eight::COUNT) {
                let hits = ends.of_packet(first, &lines);
                let of_packet = (met >> first) as u32 & 0xFF;
                assert_eq!(Eight::bitmask(hits.hit), of_packet);
                for lane in (0..Eight::COUNT).filter(|lane| of_packet >> lane & 1 == 1) {
                    let number = (first + lane) as u32;
                    let found = [hits.node, hits.part, hits.exponent, hits.steps]
                        .map(|word| Eight::words(word)[lane]);
                    assert_eq!(found, [100 + number, 200 + number, 300 + number, 1]);
                    let farthest = f32::from_bits(2f32.to_bits() + number) - 1.0;
                    assert_eq!(Eight::floats(hits.distance)[lane], farthest);
                }
            }
            assert_eq!(ends.packet_steps(), 8);
        }
    }
}
