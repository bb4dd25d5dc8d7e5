//! What can be reached from outside the cube without entering a filled cell, from face to face.
//!
//! Blocks without any voxel are cells of a coarse grid; the others are cut into their connected empty regions. Both are
//! joined with what they touch, and with the outside at the faces of the cube. Blocks are taken in layers, so that the
//! faces of a layer and the one before are in memory, and no more.

use super::empty_regions::{Contact, EmptyRegions};
use super::filled_blocks::FilledBlocks;
use super::rows::Rows;
use crate::ConvertError;
use crate::disjoint_sets::DisjointSets;
use crate::morton;
use rayon::prelude::*;

/// The empty space of the cube, sorted into outside and enclosed regions.
#[derive(Debug)]
pub(crate) struct Flood {
    /// For each block with voxels, whether each of its empty regions is enclosed.
    pub enclosed_regions: Vec<Vec<bool>>,
    /// The blocks without voxels that are enclosed, as Morton codes in ascending order.
    pub enclosed_blocks: Vec<u32>,
}

/// Number of the set of everything outside.
const OUTSIDE: u32 = 0;

/// What stands at a place of the grid of blocks.
#[derive(Debug, Clone, Copy)]
enum Place {
    /// No voxel; the set of the block.
    Empty(u32),
    /// The index of the block among those with voxels.
    Filled(u32),
}

/// How the empty regions of a block touch its faces.
struct Touching {
    index: u32,
    regions: u32,
    /// By axis: the lower and the upper face.
    faces: [[Vec<Contact>; 2]; 3],
}

impl Flood {
    /// # Errors
    /// [`ConvertError::TemporaryFile`].
    pub(crate) fn new(blocks: FilledBlocks<'_>) -> Result<Self, ConvertError> {
        let per_axis = blocks.grid.blocks_per_axis() as usize;
        let mut flooding = Flooding::new(blocks, per_axis);
        // Blocks by layer; within a layer by their number.
        let mut layers: Vec<Vec<u32>> = vec![Vec::new(); per_axis];
        for (index, code) in blocks.codes().enumerate() {
            layers[morton::decode(code)[2] as usize].push(index as u32);
        }
        let mut below: Vec<Touching> = Vec::new();
        for (z, layer) in layers.iter().enumerate() {
            let touching = layer
                .par_iter()
                .map(|&index| Ok(Touching::new(index, &blocks.rows(index as usize)?)))
                .collect::<Result<Vec<Touching>, ConvertError>>()?;
            flooding.join_layer(z, &touching, &below);
            below = touching;
        }
        Ok(flooding.finish())
    }
}

impl Touching {
    fn new(index: u32, filled: &Rows) -> Self {
        let regions = EmptyRegions::new(filled);
        let faces = [0, 1, 2].map(|axis| [false, true].map(|upper| regions.contacts(axis, upper)));
        Self { index, regions: regions.count, faces }
    }
}

struct Flooding {
    per_axis: usize,
    /// By x + y · n + z · n².
    places: Vec<Place>,
    sets: DisjointSets,
    /// For each block with voxels, the set of its first region; the others follow.
    first_regions: Vec<u32>,
    regions: Vec<u32>,
    /// For each block with voxels, where in the list of its layer it stands.
    in_layer: Vec<u32>,
}

impl Flooding {
    fn new(blocks: FilledBlocks<'_>, per_axis: usize) -> Self {
        let mut places = vec![Place::Empty(OUTSIDE); per_axis.pow(3)];
        let mut sets = DisjointSets::new(1);
        for (index, code) in blocks.codes().enumerate() {
            let [x, y, z] = morton::decode(code).map(|number| number as usize);
            places[x + per_axis * (y + per_axis * z)] = Place::Filled(index as u32);
        }
        for place in &mut places {
            if let Place::Empty(set) = place {
                *set = sets.add();
            }
        }
        let count = blocks.len();
        Self {
            per_axis,
            places,
            sets,
            first_regions: vec![0; count],
            regions: vec![0; count],
            in_layer: vec![0; count],
        }
    }

    /// Joins what lies in a layer with its neighbours in it and in the layer below.
    fn join_layer(&mut self, z: usize, layer: &[Touching], below: &[Touching]) {
        for (number, block) in layer.iter().enumerate() {
            let index = block.index as usize;
            self.in_layer[index] = number as u32;
            self.first_regions[index] = self.sets.len() as u32;
            self.regions[index] = block.regions;
            for _ in 0..block.regions {
                self.sets.add();
            }
        }
        let n = self.per_axis;
        for y in 0..n {
            for x in 0..n {
                let at = x + n * (y + n * z);
                for (axis, (number, step)) in [(x, 1), (y, n), (z, n * n)].into_iter().enumerate() {
                    let before = if axis == 2 { below } else { layer };
                    if number == 0 {
                        self.join_outside(self.places[at], axis, false, layer);
                    } else {
                        self.join(self.places[at - step], self.places[at], axis, before, layer);
                    }
                    if number + 1 == n {
                        self.join_outside(self.places[at], axis, true, layer);
                    }
                }
            }
        }
    }

    fn join_outside(&mut self, place: Place, axis: usize, upper: bool, layer: &[Touching]) {
        self.join_with_set(OUTSIDE, place, axis, upper, layer);
    }

    /// Joins two neighbours along an axis.
    fn join(
        &mut self,
        lower: Place,
        upper: Place,
        axis: usize,
        lower_layer: &[Touching],
        upper_layer: &[Touching],
    ) {
        match (lower, upper) {
            (Place::Empty(set), place) => self.join_with_set(set, place, axis, false, upper_layer),
            (place, Place::Empty(set)) => self.join_with_set(set, place, axis, true, lower_layer),
            (Place::Filled(a), Place::Filled(b)) => {
                let [of_a, of_b] = [(a, lower_layer), (b, upper_layer)]
                    .map(|(block, layer)| &layer[self.in_layer[block as usize] as usize]);
                for contact in &of_a.faces[axis][1] {
                    for other in &of_b.faces[axis][0] {
                        if contact.cells.iter().zip(&other.cells).any(|(a, b)| a & b != 0) {
                            let sets = [(a, contact), (b, other)]
                                .map(|(block, contact)| self.first_regions[block as usize] + contact.region);
                            self.sets.join(sets[0], sets[1]);
                        }
                    }
                }
            }
        }
    }

    /// Joins a set with all that touches one face of a place.
    fn join_with_set(&mut self, set: u32, place: Place, axis: usize, upper: bool, layer: &[Touching]) {
        match place {
            Place::Empty(other) => self.sets.join(set, other),
            Place::Filled(block) => {
                let first = self.first_regions[block as usize];
                let touching = &layer[self.in_layer[block as usize] as usize];
                for contact in &touching.faces[axis][usize::from(upper)] {
                    self.sets.join(set, first + contact.region);
                }
            }
        }
    }

    fn finish(mut self) -> Flood {
        let enclosed_regions = (0..self.regions.len())
            .map(|index| {
                let first = self.first_regions[index];
                (first..first + self.regions[index]).map(|set| self.sets.find(set) != OUTSIDE).collect()
            })
            .collect();
        let enclosed_blocks = (0..self.places.len() as u32)
            .filter(|&code| {
                let [x, y, z] = morton::decode(code).map(|number| number as usize);
                match self.places[x + self.per_axis * (y + self.per_axis * z)] {
                    Place::Empty(set) => self.sets.find(set) != OUTSIDE,
                    Place::Filled(_) => false,
                }
            })
            .collect();
        Flood { enclosed_regions, enclosed_blocks }
    }
}
