//! Connected parts of the mesh that are too small to mark a voxel.

use crate::disjoint_sets::DisjointSets;
use crate::surface::Surface;

/// Finds the parts of the mesh none of whose triangles marks a voxel, and gives one triangle of each: that with the first
/// vertex, in the order of grid coordinates, so that the order of the triangles does not matter.
///
/// `marks[t]` tells whether triangle t marks a voxel. Triangles are connected where they share a vertex.
pub(crate) fn parts_without_voxel(surface: &Surface<'_>, marks: &[bool]) -> Vec<usize> {
    // Triangles that do mark a voxel need not be joined: it is enough to know their vertices.
    let mut sets = DisjointSets::new(surface.vertices.len());
    let mut reached = vec![false; surface.vertices.len()];
    for (triangle, &[a, b, c]) in surface.triangles.iter().enumerate() {
        if marks[triangle] {
            for vertex in [a, b, c] {
                reached[vertex as usize] = true;
            }
        } else {
            sets.join(a, b);
            sets.join(a, c);
        }
    }
    let mut has_voxel = vec![false; surface.vertices.len()];
    for vertex in 0..surface.vertices.len() {
        if reached[vertex] {
            has_voxel[sets.find(vertex as u32) as usize] = true;
        }
    }
    // The first triangle of each part, by the vertex that stands for the part.
    let mut first = std::collections::BTreeMap::new();
    for triangle in (0..surface.triangles.len()).filter(|&triangle| !marks[triangle]) {
        let part = sets.find(surface.triangles[triangle][0]);
        if has_voxel[part as usize] {
            continue;
        }
        let candidate = (surface.with_texture_coordinates(triangle), surface.material(triangle));
        let best = first.entry(part).or_insert((candidate, triangle));
        if candidate < best.0 {
            *best = (candidate, triangle);
        }
    }
    first.into_values().map(|(_, triangle)| triangle).collect()
}
