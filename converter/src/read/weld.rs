//! Vertices at the same place become one.

use crate::{ConvertError, Mesh};
use hashbrown::HashTable;
use rayon::prelude::*;
use std::hash::{BuildHasher, RandomState};
use std::sync::atomic::{AtomicU32, Ordering};

/// Parts of the vertices that are joined at the same time, as a power of two.
const PART_BITS: u32 = 5;

/// Joins positions with the same coordinates: keeps the first of each, in their order, and tells which of them every
/// position has become. Zero and minus zero are the same.
///
/// # Errors
/// [`ConvertError::TooLarge`] if there are more than 32 bits can number.
pub(super) fn weld(positions: &mut Vec<[f64; 3]>) -> Result<Vec<u32>, ConvertError> {
    let (count, max) = (positions.len(), u32::MAX as usize / 3);
    if count > max {
        return Err(ConvertError::TooLarge { kind: "vertices", count, max });
    }
    // Adding zero turns minus zero into zero.
    positions.par_iter_mut().for_each(|position| *position = position.map(|coordinate| coordinate + 0.0));
    let first = first_alike(positions);

    let mut kept = 0;
    let mut places = vec![0u32; count];
    for vertex in 0..count {
        places[vertex] = if first[vertex] as usize == vertex {
            positions[kept] = positions[vertex];
            kept += 1;
            kept as u32 - 1
        } else {
            // The first one has its place already.
            places[first[vertex] as usize]
        };
    }
    positions.truncate(kept);
    Ok(places)
}

/// Joins the vertices of a mesh that are at the same place.
///
/// # Errors
/// As [`weld`].
pub(super) fn weld_vertices(mesh: &mut Mesh) -> Result<(), ConvertError> {
    let places = weld(&mut mesh.positions)?;
    mesh.triangles
        .par_iter_mut()
        .for_each(|triangle| *triangle = triangle.map(|vertex| places[vertex as usize]));
    Ok(())
}

/// For each position the index of the first one with the same coordinates.
fn first_alike(positions: &[[f64; 3]]) -> Vec<u32> {
    let hasher = RandomState::new();
    let hash = |position: &[f64; 3]| hasher.hash_one(position.map(f64::to_bits));
    let hashes: Vec<u64> = positions.par_iter().map(hash).collect();
    let first: Vec<AtomicU32> = (0..positions.len()).map(|_| AtomicU32::new(0)).collect();
    // Each part goes over all hashes and takes those with its own lowest bits: cheaper than sorting them first.
    (0..1u64 << PART_BITS).into_par_iter().for_each(|part| {
        let mut table: HashTable<u32> = HashTable::new();
        for (vertex, &hash) in hashes.iter().enumerate() {
            if hash & ((1 << PART_BITS) - 1) != part {
                continue;
            }
            let bits = positions[vertex].map(f64::to_bits);
            let is_alike = |&other: &u32| positions[other as usize].map(f64::to_bits) == bits;
            let entry = table.entry(hash, is_alike, |&other| hashes[other as usize]);
            first[vertex].store(*entry.or_insert(vertex as u32).get(), Ordering::Relaxed);
        }
    });
    first.into_iter().map(AtomicU32::into_inner).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_of_each_place_is_kept() {
        let mut positions = vec![
            [1.0, 0.0, 0.0],
            [0.0, 0.0, 0.0],
            [1.0, -0.0, 0.0],
            [2.0, 0.0, f64::NAN],
            [-0.0, 0.0, -0.0],
            [2.0, 0.0, f64::NAN],
            [1.0, 0.0, f64::MIN_POSITIVE],
        ];
        assert_eq!(weld(&mut positions).unwrap(), [0, 1, 0, 2, 1, 2, 3]);
        assert_eq!(positions.len(), 4);
        assert_eq!(positions[..2], [[1.0, 0.0, 0.0], [0.0; 3]]);
        assert!(weld(&mut Vec::new()).unwrap().is_empty());
    }

    #[test]
    fn many_vertices_find_their_place() {
        let position = |k: u32| [f64::from(k % 10), f64::from(k / 10 % 10), f64::from(k / 100 % 10)];
        let all: Vec<_> = (0..5000).map(position).collect();
        let mut positions = all.clone();
        let places = weld(&mut positions).unwrap();
        assert_eq!(positions, all[..1000]);
        assert!((0..5000).all(|k| places[k] as usize == k % 1000));
    }
}
