//! Reproducible randomness: an integer hash, and smooth noise built on it.

use glam::DVec3;

/// A well mixed 32-bit value for each input (the finaliser of MurmurHash3, Appleby 2011).
pub fn hash(value: u32) -> u32 {
    let mut bits = value.wrapping_add(0x9e37_79b9);
    bits = (bits ^ bits >> 16).wrapping_mul(0x85eb_ca6b);
    bits = (bits ^ bits >> 13).wrapping_mul(0xc2b2_ae35);
    bits ^ bits >> 16
}

/// A random number in [0, 1) for each pair of a seed and an index.
pub fn random(seed: u32, index: u32) -> f64 {
    f64::from(hash(hash(seed) ^ index)) / 4_294_967_296.0
}

/// A random number between `low` and `high` for each pair of a seed and an index.
pub fn random_between(seed: u32, index: u32, low: f64, high: f64) -> f64 {
    low + (high - low) * random(seed, index)
}

/// Smooth noise in [-1, 1]: random values at the integer points, blended between them with continuous curvature
/// (the quintic of Perlin 2002).
pub fn noise(seed: u32, point: DVec3) -> f64 {
    let base = point.floor();
    let t = point - base;
    let blend = t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let at = |dx: i32, dy: i32, dz: i32| {
        let [x, y, z] = base.to_array().map(|coordinate| coordinate as i32);
        let lattice = [x.wrapping_add(dx), y.wrapping_add(dy), z.wrapping_add(dz)];
        let mixed = lattice.iter().fold(hash(seed), |mixed, &coordinate| hash(mixed ^ coordinate as u32));
        f64::from(mixed) / f64::from(u32::MAX) * 2.0 - 1.0
    };
    let along_x = |dy, dz| lerp(at(0, dy, dz), at(1, dy, dz), blend.x);
    let along_y = |dz| lerp(along_x(0, dz), along_x(1, dz), blend.y);
    lerp(along_y(0), along_y(1), blend.z)
}

/// Layers of [`noise`], each of twice the frequency and half the height of the one before; within [-1, 1].
pub fn layered_noise(seed: u32, point: DVec3, layers: u32) -> f64 {
    let (mut sum, mut total) = (0.0, 0.0);
    let (mut frequency, mut height) = (1.0, 1.0);
    for layer in 0..layers {
        sum += height * noise(seed.wrapping_add(layer), point * frequency);
        total += height;
        // Not exactly 2, so that the lattices of the layers do not line up.
        frequency *= 2.03;
        height *= 0.5;
    }
    sum / total
}

fn lerp(first: f64, second: f64, amount: f64) -> f64 {
    first + (second - first) * amount
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_stays_in_range_and_is_continuous() {
        let mut lowest = f64::INFINITY;
        let mut highest = f64::NEG_INFINITY;
        for index in 0..20_000 {
            let point = DVec3::new(random(1, index), random(2, index), random(3, index)) * 40.0 - 20.0;
            let here = layered_noise(7, point, 4);
            let beside = layered_noise(7, point + DVec3::splat(1e-7), 4);
            assert!((here - beside).abs() < 1e-4, "{point}");
            lowest = lowest.min(here);
            highest = highest.max(here);
        }
        assert!((-1.0..-0.3).contains(&lowest) && (0.3..=1.0).contains(&highest), "{lowest} {highest}");
    }

    #[test]
    fn random_numbers_fill_their_range_evenly() {
        let mut bins = [0; 10];
        for index in 0..10_000 {
            bins[(random(5, index) * 10.0) as usize] += 1;
        }
        assert!(bins.iter().all(|count| (850..1150).contains(count)), "{bins:?}");
    }
}
