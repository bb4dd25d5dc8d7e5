//! What the tests ask of a mesh.

use crate::mesh::Mesh;
use glam::DVec3;
use std::collections::HashMap;

/// The number of edges that are not shared by exactly two faces running along it in opposite directions.
pub fn open_edges(mesh: &Mesh) -> usize {
    let mut uses: HashMap<(usize, usize), (u32, u32)> = HashMap::new();
    for face in &mesh.faces {
        let next = face.corners.iter().cycle().skip(1);
        for (from, to) in face.corners.iter().zip(next).map(|(from, to)| (from.vertex, to.vertex)) {
            let edge = uses.entry((from.min(to), from.max(to))).or_default();
            if from < to {
                edge.0 += 1;
            } else {
                edge.1 += 1;
            }
        }
    }
    uses.values().filter(|directions| **directions != (1, 1)).count()
}

/// The volume a closed mesh encloses, negative if its faces look inward.
pub fn volume(mesh: &Mesh) -> f64 {
    let mut sum = 0.0;
    for face in &mesh.faces {
        let outline: Vec<DVec3> = mesh.outline(face).collect();
        for pair in outline[1..].windows(2) {
            sum += outline[0].dot(pair[0].cross(pair[1]));
        }
    }
    sum / 6.0
}
