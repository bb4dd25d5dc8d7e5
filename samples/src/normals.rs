//! Normals at the corners of faces: smooth over curved surfaces, sharp along creases.

use crate::mesh::Mesh;
use crate::trigonometry::{TURN, cosine};
use glam::DVec3;
use std::collections::HashMap;

/// Normals closer than this to each other are one: the grid of the written file, finer than any voxel's normal.
const GRID: f64 = 1000.0;

/// The normal of a polygon, as long as twice its area (Newell's method, so that it need not be quite flat).
pub fn of_polygon(outline: impl Iterator<Item = DVec3> + Clone) -> DVec3 {
    let next = outline.clone().skip(1).chain(outline.clone().take(1));
    outline.zip(next).map(|(from, to)| from.cross(to)).sum()
}

/// Gives each corner the mean normal of those faces around its vertex that are inclined to its own face by
/// less than the crease of both, weighted by their angles at the vertex (Thürmer and Wüthrich 1998).
pub fn compute(mesh: &mut Mesh) {
    let flat: Vec<DVec3> =
        mesh.faces.iter().map(|face| of_polygon(mesh.outline(face)).normalize_or_zero()).collect();
    let mut around = vec![Vec::new(); mesh.vertices.len()];
    for (index, face) in mesh.faces.iter().enumerate() {
        let outline: Vec<DVec3> = mesh.outline(face).collect();
        for (place, corner) in face.corners.iter().enumerate() {
            let before = outline[(place + outline.len() - 1) % outline.len()] - outline[place];
            let after = outline[(place + 1) % outline.len()] - outline[place];
            around[corner.vertex].push((index, angle_between(before, after)));
        }
    }
    let least_cosine: Vec<f64> = mesh.faces.iter().map(|face| cosine(face.crease) - 1e-9).collect();
    let mut known = HashMap::new();
    mesh.normals.clear();
    for (index, face) in mesh.faces.iter_mut().enumerate() {
        for corner in &mut face.corners {
            let sum: DVec3 = around[corner.vertex]
                .iter()
                .filter(|(other, _)| {
                    flat[*other].dot(flat[index]) >= least_cosine[*other].max(least_cosine[index])
                })
                .map(|&(other, angle)| flat[other] * angle)
                .sum();
            let normal = sum.try_normalize().unwrap_or(flat[index]);
            let key = (normal * GRID).round().as_i64vec3();
            corner.normal = Some(*known.entry(key).or_insert_with(|| {
                mesh.normals.push(normal);
                mesh.normals.len() - 1
            }));
        }
    }
}

/// The angle between two vectors in turns; 0 if one of them is zero.
fn angle_between(first: DVec3, second: DVec3) -> f64 {
    libm::atan2(first.cross(second).length(), first.dot(second)) / TURN
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primitives::{cuboid, ellipsoid};

    #[test]
    fn a_box_has_six_normals_and_keeps_its_eight_vertices() {
        let mut mesh = cuboid(DVec3::ONE);
        compute(&mut mesh);
        assert_eq!((mesh.vertices.len(), mesh.normals.len()), (8, 6));
        let mut mesh = mesh.smooth();
        compute(&mut mesh);
        assert_eq!(mesh.normals.len(), 8);
        for face in &mesh.faces {
            for corner in &face.corners {
                let outward = mesh.vertices[corner.vertex].position.normalize();
                assert!(mesh.normals[corner.normal.unwrap()].distance(outward) < 1e-9);
            }
        }
    }

    #[test]
    fn a_sphere_has_radial_normals() {
        let mut mesh = ellipsoid(DVec3::splat(3.0), 48, 24);
        compute(&mut mesh);
        for corner in mesh.faces.iter().flat_map(|face| &face.corners) {
            let outward = mesh.vertices[corner.vertex].position.normalize();
            assert!(mesh.normals[corner.normal.unwrap()].dot(outward) > 0.999);
        }
    }
}
