//! Vertex normals: those of the file, and smooth ones where it has none.

use crate::vector::{cross, dot, unit};
use crate::{Mesh, WorldTransform};
use rayon::prelude::*;

/// Length of a normal in fixed point: leaves room for what interpolation rounds up.
pub(crate) const NORMAL_UNIT: f64 = 16_384.0;

/// A normal in fixed point, of length [`NORMAL_UNIT`].
pub(crate) type FixedNormal = [i16; 3];

/// A vertex with more faces than this is smoothed over all of them: comparing each with each takes time that grows with
/// the square of their number, and the tip of so fine a cone has no creases.
const MAX_COMPARED_FACES: usize = 256;

/// Normals of faces are summed up in integers of this scale, so that the order of the faces does not matter.
const SUM_SCALE: f64 = (1u64 << 28) as f64;

/// The normals at the three corners of each triangle, of unit length in fixed point.
///
/// Where the mesh has none, a corner gets the mean normal of the faces around its vertex, weighted by their angles there
/// (Thürmer and Wüthrich 1998), of those faces that meet its own at no more than `crease_degrees`.
/// A corner whose faces have no area gets the mean of all faces around it, and the z axis if that is nothing.
pub(crate) fn corner_normals(
    mesh: &Mesh,
    world: WorldTransform,
    crease_degrees: f64,
) -> Vec<[FixedNormal; 3]> {
    let given = |triangle: usize| mesh.normals(triangle).map(unit_f32);
    let triangles = 0..mesh.triangles.len();
    if triangles.clone().into_par_iter().all(|triangle| given(triangle).iter().all(Option::is_some)) {
        return triangles
            .into_par_iter()
            .map(|triangle| given(triangle).map(|normal| to_fixed(normal.unwrap_or(Z_AXIS))))
            .collect();
    }
    let faces = Faces::new(mesh, world);
    let crease = Crease::new(crease_degrees);
    let vertices: Vec<Option<[f64; 3]>> =
        (0..mesh.positions.len()).into_par_iter().map(|vertex| faces.common_normal(vertex, crease)).collect();
    triangles
        .into_par_iter()
        .map(|triangle| {
            let given = given(triangle);
            [0, 1, 2].map(|corner| {
                let vertex = mesh.triangles[triangle][corner] as usize;
                let normal = given[corner].or(vertices[vertex]);
                to_fixed(normal.or_else(|| faces.smooth(vertex, triangle, crease)).unwrap_or(Z_AXIS))
            })
        })
        .collect()
}

/// The largest angle between faces that are smoothed over.
#[derive(Debug, Clone, Copy)]
struct Crease {
    /// Its cosine, a little smaller: angles that rounding makes larger must still count as equal.
    cosine: f64,
    /// The cosine of half of it, a little larger: two faces that are nearer than this to a direction are smoothed.
    half_cosine: f64,
}

impl Crease {
    fn new(degrees: f64) -> Self {
        let radians = degrees.to_radians();
        Self { cosine: radians.cos() - 1e-9, half_cosine: (radians / 2.0).cos() + 1e-6 }
    }
}

const Z_AXIS: [f64; 3] = [0.0, 0.0, 1.0];

/// What the smooth normals are computed from.
struct Faces {
    /// Unit normal of each triangle, zero if it has no area.
    normals: Vec<[f64; 3]>,
    /// Angles at the corners of each triangle, in radians.
    angles: Vec<[f32; 3]>,
    /// The corners around vertex v, as triangle · 3 + corner, are `around[first[v]..first[v + 1]]`.
    first: Vec<u32>,
    around: Vec<u32>,
}

impl Faces {
    fn new(mesh: &Mesh, world: WorldTransform) -> Self {
        // In cells: model space may be so large or so small that products of its lengths are no numbers.
        let corners = |triangle| mesh.corners(triangle).map(|position| world.to_cells(position));
        let (normals, angles) = (0..mesh.triangles.len())
            .into_par_iter()
            .map(|triangle| normal_and_angles(corners(triangle)))
            .unzip();

        let mut first = vec![0u32; mesh.positions.len() + 1];
        for &vertex in mesh.triangles.as_flattened() {
            first[vertex as usize + 1] += 1;
        }
        for vertex in 1..first.len() {
            first[vertex] += first[vertex - 1];
        }
        let mut next = first.clone();
        let mut around = vec![0; mesh.triangles.len() * 3];
        for (corner, &vertex) in mesh.triangles.as_flattened().iter().enumerate() {
            around[next[vertex as usize] as usize] = corner as u32;
            next[vertex as usize] += 1;
        }
        Self { normals, angles, first, around }
    }

    /// The corners around a vertex.
    fn around(&self, vertex: usize) -> &[u32] {
        &self.around[self.first[vertex] as usize..self.first[vertex + 1] as usize]
    }

    fn normal(&self, corner: u32) -> [f64; 3] {
        self.normals[corner as usize / 3]
    }

    /// The normal of all corners around a vertex, if all of their faces are smoothed; `None` if that is not certain.
    fn common_normal(&self, vertex: usize, crease: Crease) -> Option<[f64; 3]> {
        let around = self.around(vertex);
        let mean = unit(self.sum(around.iter().copied()))?;
        let is_near = |&corner: &u32| dot(self.normal(corner), mean) > crease.half_cosine;
        (around.len() > MAX_COMPARED_FACES || around.iter().all(is_near)).then_some(mean)
    }

    /// The smooth normal of a triangle's corner at a vertex; `None` if the faces cancel out.
    fn smooth(&self, vertex: usize, triangle: usize, crease: Crease) -> Option<[f64; 3]> {
        let around = self.around(vertex);
        let own = self.normals[triangle];
        if own == [0.0; 3] || around.len() > MAX_COMPARED_FACES {
            return unit(self.sum(around.iter().copied()));
        }
        let is_smoothed =
            |corner: u32| corner as usize / 3 == triangle || dot(own, self.normal(corner)) >= crease.cosine;
        unit(self.sum(around.iter().copied().filter(|&corner| is_smoothed(corner)))).or(Some(own))
    }

    /// The sum of the faces' normals at these corners, weighted by angle.
    fn sum(&self, corners: impl Iterator<Item = u32>) -> [f64; 3] {
        let mut sum = [0i64; 3];
        for corner in corners {
            let weight = f64::from(self.angles.as_flattened()[corner as usize]) * SUM_SCALE;
            for (total, component) in sum.iter_mut().zip(self.normal(corner)) {
                *total += (component * weight) as i64;
            }
        }
        sum.map(|component| component as f64)
    }
}

/// Unit normal and the three angles of a triangle; all zero if it has no area.
///
/// The result is the same to the last bit whichever corner comes first, and exactly opposite for the other orientation.
pub(crate) fn normal_and_angles(corners: [[f64; 3]; 3]) -> ([f64; 3], [f32; 3]) {
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| corners[a].partial_cmp(&corners[b]).unwrap_or(std::cmp::Ordering::Equal));
    let even = matches!(order, [0, 1, 2] | [1, 2, 0] | [2, 0, 1]);
    let [a, b, c] = order.map(|corner| corners[corner]);
    let edge = |from: [f64; 3], to: [f64; 3]| unit([to[0] - from[0], to[1] - from[1], to[2] - from[2]]);
    let (Some(ab), Some(bc), Some(ca)) = (edge(a, b), edge(b, c), edge(c, a)) else {
        return ([0.0; 3], [0.0; 3]);
    };
    // Unit edges: the product keeps its precision however small the triangle is.
    let Some(normal) = unit(cross(ab, ca)).map(|n| if even { n.map(|v| -v) } else { n }) else {
        return ([0.0; 3], [0.0; 3]);
    };
    let mut angles = [0.0; 3];
    for (corner, (to, from)) in order.into_iter().zip([(ab, ca), (bc, ab), (ca, bc)]) {
        angles[corner] = arc_cosine(-dot(to, from)) as f32;
    }
    (normal, angles)
}

/// Arc cosine to within 7e-5, the same on every machine (Abramowitz and Stegun 1964, formula 4.4.45).
fn arc_cosine(cosine: f64) -> f64 {
    let x = cosine.abs().min(1.0);
    let angle = (1.0 - x).sqrt() * (1.570_728_8 + x * (-0.212_114_4 + x * (0.074_261_0 + x * -0.018_729_3)));
    if cosine < 0.0 { std::f64::consts::PI - angle } else { angle }
}

fn unit_f32(vector: [f32; 3]) -> Option<[f64; 3]> {
    unit(vector.map(f64::from))
}

/// A unit vector in fixed point.
pub(crate) fn to_fixed(normal: [f64; 3]) -> FixedNormal {
    normal.map(|component| (component * NORMAL_UNIT).round() as i16)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Options, placement};

    fn normals(mesh: &Mesh, crease_degrees: f64) -> Vec<[[f64; 3]; 3]> {
        let world = placement::place(mesh, &Options::default()).unwrap();
        let fixed = corner_normals(mesh, world, crease_degrees);
        fixed.into_iter().map(|corners| corners.map(|n| n.map(|v| f64::from(v) / NORMAL_UNIT))).collect()
    }

    fn close(a: [f64; 3], b: [f64; 3]) -> bool {
        (0..3).all(|axis| (a[axis] - b[axis]).abs() < 2e-4)
    }

    /// Two squares of two triangles each that meet along the z axis at a right angle.
    fn corner_of_two_walls() -> Mesh {
        let positions = vec![
            [1.0, 0.0, 0.0],
            [1.0, 0.0, 1.0],
            [0.0, 0.0, 0.0],
            [0.0, 0.0, 1.0],
            [0.0, 1.0, 0.0],
            [0.0, 1.0, 1.0],
        ];
        Mesh::new(positions, vec![[0, 2, 3], [0, 3, 1], [2, 4, 5], [2, 5, 3]]).unwrap()
    }

    #[test]
    fn a_crease_separates_faces_at_a_larger_angle() {
        let mesh = corner_of_two_walls();
        let sharp = normals(&mesh, 89.0);
        assert!(sharp[..2].iter().flatten().all(|&n| close(n, sharp[0][0])), "{sharp:?}");
        assert!(sharp[2..].iter().flatten().all(|&n| close(n, sharp[2][0])), "{sharp:?}");
        assert!(sharp[0][0][1].abs() > 0.99 && sharp[2][0][0].abs() > 0.99);

        // At vertex 2 one triangle of each wall contributes 45°, at vertex 2 the other wall has both.
        let smooth = normals(&mesh, 90.0);
        assert!(smooth[0][1][0].abs() > 0.1 && smooth[0][1][1].abs() > 0.1, "{smooth:?}");
        assert!(close(smooth[0][1], smooth[2][0]));
    }

    #[test]
    fn weights_are_angles_so_triangulation_does_not_matter() {
        // The corner of a cube: however each face is cut in two, each contributes 90 degrees.
        let positions = vec![
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 1.0, 1.0],
            [0.0, 0.0, 1.0],
            [1.0, 0.0, 1.0],
        ];
        let triangles = vec![[0, 2, 1], [0, 3, 2], [0, 4, 3], [0, 5, 4], [0, 1, 5], [1, 6, 5]];
        let mesh = Mesh::new(positions, triangles).unwrap();
        let third = -(1.0f64 / 3.0).sqrt();
        assert!(close(normals(&mesh, 100.0)[0][0], [third; 3]));
    }

    #[test]
    fn given_normals_are_kept_and_useless_ones_are_computed() {
        let mesh = corner_of_two_walls();
        let zero = [0.0f32; 3];
        let given = vec![[[0.0, 0.0, 5.0], zero, [f32::NAN; 3]], [zero; 3], [zero; 3], [zero; 3]];
        let mesh = mesh.with_corner_normals(given).unwrap();
        let normals = normals(&mesh, 30.0);
        assert_eq!(normals[0][0], [0.0, 0.0, 1.0]);
        assert!(close(normals[0][1], normals[1][0]) && close(normals[0][2], normals[1][0]));
    }

    #[test]
    fn a_triangle_without_area_takes_the_normal_of_its_neighbours() {
        let mut mesh = corner_of_two_walls();
        mesh.triangles.push([0, 2, 2]);
        mesh.triangles.push([0, 1, 1]);
        let normals = normals(&mesh, 30.0);
        assert!(close(normals[5][0], normals[0][0]), "{normals:?}");
        // Alone in the world.
        let point = Mesh::new(vec![[1.0; 3]], vec![[0; 3]]).unwrap();
        assert_eq!(self::normals(&point, 60.0), [[[0.0, 0.0, 1.0]; 3]]);
    }

    #[test]
    fn orientation_turns_the_normal_exactly_and_rotation_leaves_it() {
        let corners = [[0.1, 0.2, 0.3], [0.9, 0.25, 0.1], [0.4, 0.8, 0.77]];
        let [a, b, c] = corners;
        let (normal, angles) = normal_and_angles([a, b, c]);
        assert_eq!(normal_and_angles([b, c, a]), (normal, [angles[1], angles[2], angles[0]]));
        let (opposite, _) = normal_and_angles([b, a, c]);
        assert_eq!(opposite, normal.map(|v| -v));
        let expected =
            unit(cross([b[0] - a[0], b[1] - a[1], b[2] - a[2]], [c[0] - a[0], c[1] - a[1], c[2] - a[2]]))
                .unwrap();
        assert!(close(normal, expected));
        assert!(
            (angles.iter().map(|&angle| f64::from(angle)).sum::<f64>() - std::f64::consts::PI).abs() < 3e-4
        );
    }
}
