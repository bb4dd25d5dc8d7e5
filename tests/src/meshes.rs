//! Closed meshes from formulas.

use glam::DVec3;
use octvox_converter::Mesh;
use std::collections::HashMap;
use std::f64::consts::TAU;
use std::fmt::Write;

/// Triangles that share vertices; closed, and all facing outwards.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Shape {
    /// Vertices.
    pub positions: Vec<DVec3>,
    /// Indices of vertices, from 0.
    pub triangles: Vec<[u32; 3]>,
}

impl Shape {
    /// A mesh in memory.
    #[must_use]
    pub fn mesh(&self) -> Mesh {
        let positions = self.positions.iter().map(|position| position.to_array()).collect();
        Mesh::new(positions, self.triangles.clone()).unwrap()
    }

    /// A mesh in memory whose colours change from vertex to vertex.
    #[must_use]
    pub fn colored_mesh(&self) -> Mesh {
        let [low, high] = self.bounds();
        let color =
            |vertex: u32| ((self.positions[vertex as usize] - low) / (high - low)).as_vec3().to_array();
        let colors = self.triangles.iter().map(|triangle| triangle.map(color)).collect();
        self.mesh().with_corner_colors(colors).unwrap()
    }

    /// The text of an OBJ file.
    #[must_use]
    pub fn obj(&self) -> String {
        let mut text = String::new();
        for DVec3 { x, y, z } in &self.positions {
            writeln!(text, "v {x} {y} {z}").unwrap();
        }
        for [a, b, c] in self.triangles.iter().map(|triangle| triangle.map(|vertex| vertex + 1)) {
            writeln!(text, "f {a} {b} {c}").unwrap();
        }
        text
    }

    /// Low and high corner of the box around the vertices.
    #[must_use]
    pub fn bounds(&self) -> [DVec3; 2] {
        let infinity = DVec3::splat(f64::INFINITY);
        self.positions
            .iter()
            .fold([infinity, -infinity], |[low, high], position| [low.min(*position), high.max(*position)])
    }
}

/// The cube [0, 1]³, each face in two triangles.
#[must_use]
pub fn cube() -> Shape {
    let corner = |code: usize| [0, 1, 2].map(|axis| (code >> axis & 1) as f64).into();
    let mut triangles = Vec::new();
    for axis in 0..3 {
        let (u, v) = (1u32 << ((axis + 1) % 3), 1u32 << ((axis + 2) % 3));
        for (low, u, v) in [(0, v, u), (1 << axis, u, v)] {
            triangles.extend([[low, low + u, low + u + v], [low, low + u + v, low + v]]);
        }
    }
    Shape { positions: (0..8).map(corner).collect(), triangles }
}

/// A sphere of radius one half about (½, ½, ½): an octahedron whose triangles are cut in four `refinements` times.
#[must_use]
pub fn sphere(refinements: u32) -> Shape {
    let mut positions: Vec<DVec3> = [DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X, -DVec3::Y, -DVec3::Z].into();
    let mut triangles: Vec<[u32; 3]> = (0..8)
        .map(|octant: u32| {
            let [a, b, c] = [0, 1, 2].map(|axis| axis + 3 * (octant >> axis & 1));
            if octant.count_ones().is_multiple_of(2) { [a, b, c] } else { [a, c, b] }
        })
        .collect();
    for _ in 0..refinements {
        let mut middles: HashMap<[u32; 2], u32> = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                positions.push((positions[a as usize] + positions[b as usize]).normalize());
                positions.len() as u32 - 1
            })
        };
        triangles = triangles
            .iter()
            .flat_map(|&[a, b, c]| {
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    let positions = positions.into_iter().map(|position| (position + 1.0) / 2.0).collect();
    Shape { positions, triangles }
}

/// A torus about the z axis through (½, ½, ½) that is one wide: a tube of the radius `tube` in `around` × `across`
/// quadrilaterals.
#[must_use]
pub fn torus(tube: f64, around: u32, across: u32) -> Shape {
    let ring = 0.5 - tube;
    let position = |i: u32, k: u32| {
        let [(sin_a, cos_a), (sin_b, cos_b)] = [(i, around), (k, across)]
            .map(|(step, steps)| (TAU * f64::from(step) / f64::from(steps)).sin_cos());
        let reach = ring + tube * cos_b;
        DVec3::new(0.5 + reach * cos_a, 0.5 + reach * sin_a, 0.5 + tube * sin_b)
    };
    let vertex = |i: u32, k: u32| i % around * across + k % across;
    let quadrilaterals = (0..around).flat_map(|i| (0..across).map(move |k| (i, k)));
    Shape {
        positions: quadrilaterals.clone().map(|(i, k)| position(i, k)).collect(),
        triangles: quadrilaterals
            .flat_map(|(i, k)| {
                let [a, b, c, d] = [vertex(i, k), vertex(i + 1, k), vertex(i + 1, k + 1), vertex(i, k + 1)];
                [[a, b, c], [a, c, d]]
            })
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    /// Every edge has one triangle on each side, and the enclosed volume is positive.
    #[test]
    fn shapes_are_closed_and_face_outwards() {
        for (shape, volume) in
            [(cube(), 1.0), (sphere(5), TAU / 12.0), (torus(0.15, 96, 48), TAU * TAU / 2.0 * 0.35 * 0.0225)]
        {
            let mut edges = HashSet::new();
            for &[a, b, c] in &shape.triangles {
                for edge in [[a, b], [b, c], [c, a]] {
                    assert!(edges.insert(edge), "two triangles on one side of {edge:?}");
                }
            }
            assert!(edges.iter().all(|&[a, b]| edges.contains(&[b, a])));
            let found: f64 = shape
                .triangles
                .iter()
                .map(|triangle| triangle.map(|vertex| shape.positions[vertex as usize]))
                .map(|[a, b, c]| a.dot(b.cross(c)) / 6.0)
                .sum();
            assert!((found / volume - 1.0).abs() < 0.01, "{found} instead of {volume}");
        }
    }
}
