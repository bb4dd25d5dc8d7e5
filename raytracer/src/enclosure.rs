//! Which empty cells a surface encloses.
//!
//! A flood over the octree's empty cubes, from face to face, beginning outside. What it does not reach is inside a
//! 6-separating surface: no ray gets out of there unseen.

use crate::octree::{Location, Octree};

/// The empty cells that can be reached from outside.
#[derive(Debug)]
pub(crate) struct Enclosure {
    /// Reached cells of each node; an empty byte is marked by its first cell.
    reached: Vec<u64>,
}

/// An empty aligned cube, by its lowest finest cell.
#[derive(Debug, Clone, Copy)]
struct Cube {
    corner: [u32; 3],
    size_log2: u32,
}

impl Enclosure {
    /// Floods `octree` from outside.
    pub fn new(octree: &Octree) -> Self {
        let mut flood = Self { reached: vec![0; octree.nodes.len()] };
        let mut waiting = Vec::new();
        let size_log2 = u32::from(octree.depth());
        for axis in 0..3 {
            for upper in [false, true] {
                let corner: [u32; 3] = [0; 3];
                flood.reach_face(octree, Cube { corner, size_log2 }, axis, upper, &mut waiting);
            }
        }
        while let Some(cube) = waiting.pop() {
            for axis in 0..3 {
                let size = 1 << cube.size_log2;
                let mut neighbor = cube;
                if cube.corner[axis] >= size {
                    neighbor.corner[axis] = cube.corner[axis] - size;
                    flood.reach_face(octree, neighbor, axis, true, &mut waiting);
                }
                if cube.corner[axis] + size < octree.resolution() {
                    neighbor.corner[axis] = cube.corner[axis] + size;
                    flood.reach_face(octree, neighbor, axis, false, &mut waiting);
                }
            }
        }
        flood
    }

    /// Whether a finest cell is empty and cannot be reached from outside.
    pub fn is_inside(&self, octree: &Octree, cell: [u32; 3]) -> bool {
        match octree.locate(cell) {
            Location::Voxel { .. } => false,
            Location::Empty { node, place, .. } => {
                self.reached.get(node as usize).is_some_and(|reached| reached >> place & 1 == 0)
            }
        }
    }

    /// Reaches the empty cubes that touch the lower or upper face of `cube` along `axis` from within.
    fn reach_face(&mut self, octree: &Octree, cube: Cube, axis: usize, upper: bool, waiting: &mut Vec<Cube>) {
        let mut corner = cube.corner;
        if upper {
            corner[axis] += (1 << cube.size_log2) - 1;
        }
        let within_face = [(axis + 1) % 3, (axis + 2) % 3];
        let mut parts = vec![(corner, cube.size_log2)];
        while let Some((part, size_log2)) = parts.pop() {
            match octree.locate(part) {
                Location::Empty { size_log2: found, node, place } if found >= size_log2 => {
                    let Some(reached) = self.reached.get_mut(node as usize) else { return };
                    if *reached >> place & 1 == 0 {
                        *reached |= 1 << place;
                        let corner = part.map(|coordinate| coordinate >> found << found);
                        waiting.push(Cube { corner, size_log2: found });
                    }
                }
                _ if size_log2 > 0 => {
                    let half = 1 << (size_log2 - 1);
                    for quarter in 0..4 {
                        let mut part = part;
                        part[within_face[0]] += half * (quarter & 1);
                        part[within_face[1]] += half * (quarter >> 1);
                        parts.push((part, size_log2 - 1));
                    }
                }
                _ => {}
            }
        }
    }
}
