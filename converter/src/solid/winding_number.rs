//! How often a surface winds around a point, open surfaces included.
//!
//! The generalised winding number (Jacobson et al. 2013) is the sum of the solid angles of all triangles, over 4π: inside
//! a closed surface 1, outside 0, and where there are holes something between that changes smoothly. Far triangles count
//! as one dipole per group (Barill et al. 2018, "Fast winding numbers for soups and clouds", of first order).

use crate::vector::{cross, difference, dot};
use std::f64::consts::PI;

/// Triangles of a leaf of the tree.
const LEAF_TRIANGLES: usize = 8;
/// A group counts as a dipole from so many of its radii on.
const FAR: f64 = 3.0;

type Point = [f64; 3];

/// Triangles, grouped by place.
#[derive(Debug)]
pub(crate) struct WindingNumber {
    /// The children of a node stand behind it; the last one is the root's.
    nodes: Vec<Node>,
    triangles: Vec<[Point; 3]>,
}

#[derive(Debug, Clone, Copy)]
struct Node {
    /// Mean place of the area.
    center: Point,
    /// Sum of the triangles' normals, each as long as its area.
    area: Point,
    /// Farthest corner from the centre.
    radius: f64,
    /// Triangles of the node.
    first: u32,
    count: u32,
    /// The upper child; the lower one is the next node. 0 in a leaf.
    upper: u32,
}

impl WindingNumber {
    /// Triangles with corners in any unit.
    pub(crate) fn new(triangles: Vec<[Point; 3]>) -> Self {
        let mut tree = Self { nodes: Vec::new(), triangles };
        tree.build(0, tree.triangles.len());
        tree
    }

    fn build(&mut self, first: usize, end: usize) -> u32 {
        let index = self.nodes.len();
        let triangles = &mut self.triangles[first..end];
        let mut node = Node::new(triangles, first);
        self.nodes.push(node);
        if triangles.len() > LEAF_TRIANGLES {
            let axis = widest_axis(triangles);
            let middle = triangles.len() / 2;
            let place = |triangle: &[Point; 3]| triangle[0][axis] + triangle[1][axis] + triangle[2][axis];
            triangles.select_nth_unstable_by(middle, |a, b| place(a).total_cmp(&place(b)));
            self.build(first, first + middle);
            node.upper = self.build(first + middle, end);
            self.nodes[index] = node;
        }
        index as u32
    }

    /// The winding number around a point.
    pub(crate) fn at(&self, point: Point) -> f64 {
        let mut solid_angle = 0.0;
        let mut waiting = vec![0u32];
        while let Some(index) = waiting.pop() {
            let Some(node) = self.nodes.get(index as usize) else { break };
            let offset = difference(node.center, point);
            let square = dot(offset, offset);
            if square > (FAR * node.radius).powi(2) {
                solid_angle += dot(offset, node.area) / (square * square.sqrt());
            } else if node.upper == 0 {
                let triangles = &self.triangles[node.first as usize..(node.first + node.count) as usize];
                solid_angle += triangles.iter().map(|triangle| solid_angle_of(triangle, point)).sum::<f64>();
            } else {
                waiting.extend([index + 1, node.upper]);
            }
        }
        solid_angle / (4.0 * PI)
    }
}

impl Node {
    fn new(triangles: &[[Point; 3]], first: usize) -> Self {
        let mut area = [0.0; 3];
        let mut weighted = [0.0; 3];
        let mut plain = [0.0; 3];
        let mut weight = 0.0;
        for [a, b, c] in triangles {
            let normal = cross(difference(*b, *a), difference(*c, *a)).map(|component| component / 2.0);
            let size = dot(normal, normal).sqrt();
            weight += size;
            for axis in 0..3 {
                area[axis] += normal[axis];
                let middle = (a[axis] + b[axis] + c[axis]) / 3.0;
                weighted[axis] += middle * size;
                plain[axis] += middle;
            }
        }
        let center = if weight > 0.0 {
            weighted.map(|sum| sum / weight)
        } else {
            plain.map(|sum| sum / triangles.len().max(1) as f64)
        };
        let square = triangles.iter().flatten().map(|corner| {
            let offset = difference(*corner, center);
            dot(offset, offset)
        });
        let radius = square.fold(0.0, f64::max).sqrt();
        Self { center, area, radius, first: first as u32, count: triangles.len() as u32, upper: 0 }
    }
}

/// The solid angle of a triangle as seen from a point, positive from behind (van Oosterom and Strackee 1983).
fn solid_angle_of(triangle: &[Point; 3], point: Point) -> f64 {
    let [a, b, c] = triangle.map(|corner| difference(corner, point));
    let [la, lb, lc] = [a, b, c].map(|vector| dot(vector, vector).sqrt());
    let volume = dot(a, cross(b, c));
    let denominator = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
    2.0 * libm::atan2(volume, denominator)
}

fn widest_axis(triangles: &[[Point; 3]]) -> usize {
    let width = |axis: usize| {
        let places = triangles.iter().map(|triangle| triangle[0][axis]);
        places.clone().fold(f64::MIN, f64::max) - places.fold(f64::MAX, f64::min)
    };
    (1..3).fold(0, |best, axis| if width(axis) > width(best) { axis } else { best })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A sphere of radius 1 of triangles, without those whose middle is above `top`.
    fn sphere(steps: u32, top: f64) -> Vec<[Point; 3]> {
        let at = |i: u32, j: u32| {
            let (theta, phi) = (PI * f64::from(i) / f64::from(steps), PI * f64::from(j) / f64::from(steps));
            [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()]
        };
        let mut triangles = Vec::new();
        for i in 0..steps {
            for j in 0..2 * steps {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        triangles.retain(|triangle| triangle.iter().map(|corner| corner[2]).sum::<f64>() / 3.0 <= top);
        triangles
    }

    #[test]
    fn inside_is_one_and_outside_zero() {
        let winding = WindingNumber::new(sphere(40, 1.0));
        for k in 0..200 {
            let direction = [f64::from(k).sin(), f64::from(k * k).cos(), f64::from(k * 3 + 1).cos()];
            let length = dot(direction, direction).sqrt();
            for (radius, expected) in [(0.0, 1.0), (0.5, 1.0), (0.95, 1.0), (1.05, 0.0), (3.0, 0.0)] {
                let found = winding.at(direction.map(|component| component / length * radius));
                assert!((found - expected).abs() < 0.02, "{radius}: {found}");
            }
        }
    }

    #[test]
    fn a_cap_that_is_missing_is_missing_by_its_solid_angle() {
        // Seen from the centre, the part above z = h is a share (1 − h)/2 of the sphere.
        for top in [0.9, 0.5, 0.0] {
            let found = WindingNumber::new(sphere(200, top)).at([0.0; 3]);
            assert!((found - (1.0 + top) / 2.0).abs() < 0.01, "{top}: {found}");
        }
    }

    #[test]
    fn groups_add_up_to_their_triangles() {
        let triangles = sphere(30, 0.7);
        let winding = WindingNumber::new(triangles.clone());
        for k in 0..100 {
            let point =
                [f64::from(k).sin() * 1.5, f64::from(k * 7).cos() * 1.5, f64::from(k * 5).sin() * 1.5];
            let exact =
                triangles.iter().map(|triangle| solid_angle_of(triangle, point)).sum::<f64>() / (4.0 * PI);
            assert!((winding.at(point) - exact).abs() < 0.01, "{point:?}");
        }
    }

    #[test]
    fn nothing_and_points_have_no_inside() {
        assert_eq!(WindingNumber::new(Vec::new()).at([0.0; 3]), 0.0);
        assert_eq!(WindingNumber::new(vec![[[1.0; 3]; 3]; 20]).at([0.0; 3]), 0.0);
    }
}
