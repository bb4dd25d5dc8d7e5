//! Sample points that are spread well: (0, 2)-sequences of Sobol', scrambled as Owen does it.
//!
//! Any 2ᵏ points that follow each other at a multiple of 2ᵏ are stratified in all ways, in every pixel differently, so
//! that what error is left looks like fine noise. (B. Burley, "Practical hash-based Owen scrambling", 2020.)

use glam::Vec2;

/// Point number `index` of the sequence that belongs to `seed`, in [0, 1)².
pub(crate) fn sample_2d(index: u32, seed: u32) -> Vec2 {
    // The order of the points is scrambled, too, so that sequences of different seeds can be used together.
    let index = scrambled(index, seed);
    let x = scrambled(index.reverse_bits(), hashed(seed, 1));
    let y = scrambled(second_dimension(index), hashed(seed, 2));
    Vec2::new(unit(x), unit(y))
}

/// A seed for a purpose, from one for something wider.
pub(crate) fn hashed(seed: u32, purpose: u32) -> u32 {
    // Of the family of integer hashes found by C. Wellons' search, "lowbias32".
    let mut mixed = seed ^ purpose.wrapping_mul(0x9E37_79B9);
    mixed = (mixed ^ mixed >> 16).wrapping_mul(0x7FEB_352D);
    mixed = (mixed ^ mixed >> 15).wrapping_mul(0x846C_A68B);
    mixed ^ mixed >> 16
}

/// The bits as a number in [0, 1).
fn unit(bits: u32) -> f32 {
    (bits >> 8) as f32 / (1 << 24) as f32
}

/// The second dimension of Sobol's sequence: its direction numbers are the rows of Pascal's triangle modulo 2.
fn second_dimension(mut index: u32) -> u32 {
    let (mut bits, mut direction) = (0, 1u32 << 31);
    while index != 0 {
        if index & 1 == 1 {
            bits ^= direction;
        }
        index >>= 1;
        direction ^= direction >> 1;
    }
    bits
}

/// Each bit flipped or not, depending on the seed and the bits above it: Owen's scrambling (the hash of Laine and Karras,
/// "Stratified sampling for stochastic transparency", 2011, with Burley's constants).
fn scrambled(bits: u32, seed: u32) -> u32 {
    let mut mixed = bits.reverse_bits();
    mixed = mixed.wrapping_add(seed);
    mixed ^= mixed.wrapping_mul(0x6C50_B47C);
    mixed ^= mixed.wrapping_mul(0xB82F_1E52);
    mixed ^= mixed.wrapping_mul(0xC7AF_E638);
    mixed ^= mixed.wrapping_mul(0x8D22_F6E6);
    mixed.reverse_bits()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of 16 points, one is in each cell of every grid of 16 cells: 1×16, 2×8, 4×4, 8×2 and 16×1.
    #[test]
    fn points_are_stratified_in_all_ways() {
        for seed in 0..50 {
            let seed = hashed(seed, 0);
            for first in [0, 16, 112] {
                for columns in [1, 2, 4, 8, 16] {
                    let mut cells = [0; 16];
                    for index in first..first + 16 {
                        let point = sample_2d(index, seed);
                        let (x, y) = ((point.x * columns as f32) as usize, point.y * (16 / columns) as f32);
                        cells[y as usize * columns + x] += 1;
                    }
                    assert_eq!(cells, [1; 16], "seed {seed}, {columns} columns");
                }
            }
        }
    }

    #[test]
    fn pixels_have_points_of_their_own() {
        let points: Vec<Vec2> = (0..1000).map(|pixel| sample_2d(0, hashed(pixel, 7))).collect();
        let mean = points.iter().copied().sum::<Vec2>() / points.len() as f32;
        assert!((mean - Vec2::splat(0.5)).abs().max_element() < 0.05, "{mean}");
        assert!(points.windows(2).all(|pair| pair[0] != pair[1]));
    }
}
