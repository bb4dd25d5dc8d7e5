//! Triangles cut into small pieces, so that neighbours still meet along whole edges.
//!
//! Every edge that is too long is cut in its middle, on both sides of it at once, again and again. Whether an edge is too
//! long is a question of its two ends alone, so triangles that share it agree; a surface without holes stays one.

use std::collections::HashMap;

/// A part of a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Piece {
    pub vertices: [u32; 3],
    /// Index of the triangle that it is part of.
    pub triangle: u32,
    /// Its corners as means of the corners of that triangle. Sums of powers of two, so exact.
    pub weights: [[f32; 3]; 3],
}

/// A mesh of pieces.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Subdivision {
    /// The vertices of the mesh, and after them those that cuts have added.
    pub positions: Vec<[f64; 3]>,
    pub pieces: Vec<Piece>,
    /// Length of the longest edge that is left of a triangle to be cut.
    pub longest: f64,
}

/// Cuts the triangles for which `is_cut` holds until no edge is longer than `longest`, or until the next cut could make more
/// than `max_pieces` pieces. Other triangles are cut only where they share an edge with those.
pub(crate) fn subdivide(
    positions: &[[f64; 3]],
    triangles: &[[u32; 3]],
    is_cut: impl Fn(u32) -> bool,
    longest: f64,
    max_pieces: usize,
) -> Subdivision {
    const CORNERS: [[f32; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let pieces =
        (0u32..).zip(triangles).map(|(triangle, &vertices)| Piece { vertices, triangle, weights: CORNERS });
    let mut result = Subdivision { positions: positions.to_vec(), pieces: pieces.collect(), longest: 0.0 };
    loop {
        let mut middles: HashMap<[u32; 2], u32> = HashMap::new();
        result.longest = 0.0;
        for piece in result.pieces.iter().filter(|piece| is_cut(piece.triangle)) {
            for edge in edges(piece.vertices) {
                let length = length(&result.positions, edge);
                result.longest = result.longest.max(length);
                if length > longest {
                    middles.entry(edge).or_default();
                }
            }
        }
        if middles.is_empty() || result.pieces.len().saturating_mul(4) > max_pieces {
            return result;
        }
        let mut cut = Vec::with_capacity(result.pieces.len() * 2);
        for piece in &result.pieces {
            let middles = edges(piece.vertices).map(|edge| {
                let middle = middles.get_mut(&edge)?;
                // No cut leads to vertex 0, so it stands for a middle that is not there yet.
                if *middle == 0 {
                    *middle = result.positions.len() as u32;
                    let [a, b] = edge.map(|vertex| result.positions[vertex as usize]);
                    result.positions.push([0, 1, 2].map(|axis| a[axis] / 2.0 + b[axis] / 2.0));
                }
                Some(*middle)
            });
            piece.cut(middles, &result.positions, &mut cut);
        }
        result.pieces = cut;
    }
}

/// The edges opposite to each corner, each from its lower vertex to its higher.
fn edges([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[b, c], [c, a], [a, b]].map(|[from, to]| [from.min(to), from.max(to)])
}

fn length(positions: &[[f64; 3]], edge: [u32; 2]) -> f64 {
    let [a, b] = edge.map(|vertex| positions[vertex as usize]);
    (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt()
}

impl Piece {
    /// Appends what a cut at the middles of edges makes of the piece; `middles` are opposite to its corners.
    fn cut(&self, middles: [Option<u32>; 3], positions: &[[f64; 3]], pieces: &mut Vec<Self>) {
        let corner = |k: usize| (self.vertices[k], self.weights[k]);
        let middle = |opposite: usize, vertex: u32| {
            let [a, b] = [(opposite + 1) % 3, (opposite + 2) % 3].map(|corner| self.weights[corner]);
            (vertex, [0, 1, 2].map(|k| (a[k] + b[k]) / 2.0))
        };
        let mut add = |corners: [(u32, [f32; 3]); 3]| {
            pieces.push(Self {
                vertices: corners.map(|(vertex, _)| vertex),
                triangle: self.triangle,
                weights: corners.map(|(_, weights)| weights),
            });
        };
        match middles {
            [None, None, None] => add([corner(0), corner(1), corner(2)]),
            [Some(p), Some(q), Some(r)] => {
                let (p, q, r) = (middle(0, p), middle(1, q), middle(2, r));
                add([corner(0), r, q]);
                add([r, corner(1), p]);
                add([q, p, corner(2)]);
                add([p, q, r]);
            }
            _ => {
                // Begin with a corner whose opposite edge is cut alone, or whole alone.
                let cuts = middles.iter().flatten().count();
                let first = (0..3).find(|&k| middles[k].is_some() == (cuts == 1)).unwrap_or(0);
                let [a, b, c] = [0, 1, 2].map(|k| (first + k) % 3);
                match (middles[a], middles[b], middles[c]) {
                    (Some(p), _, _) => {
                        let p = middle(a, p);
                        add([corner(a), corner(b), p]);
                        add([corner(a), p, corner(c)]);
                    }
                    (_, Some(q), Some(r)) => {
                        let (q, r) = (middle(b, q), middle(c, r));
                        add([corner(a), r, q]);
                        // Of the quadrilateral that is left, the shorter diagonal.
                        let diagonal = |from: (u32, [f32; 3]), to: (u32, [f32; 3])| {
                            (length(positions, [from.0, to.0]), positions[from.0 as usize])
                        };
                        if diagonal(corner(b), q) < diagonal(corner(c), r) {
                            add([r, corner(b), q]);
                            add([q, corner(b), corner(c)]);
                        } else {
                            add([r, corner(c), q]);
                            add([r, corner(b), corner(c)]);
                        }
                    }
                    _ => {}
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeMap;

    /// How often each directed edge occurs, less how often its reverse does.
    fn open_edges(pieces: &[Piece]) -> usize {
        let mut count: BTreeMap<[u32; 2], i32> = BTreeMap::new();
        for [a, b, c] in pieces.iter().map(|piece| piece.vertices) {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                *count.entry([from.min(to), from.max(to)]).or_default() += if from < to { 1 } else { -1 };
            }
        }
        count.values().filter(|&&count| count != 0).count()
    }

    fn area(positions: &[[f64; 3]], vertices: [u32; 3]) -> f64 {
        let [a, b, c] = vertices.map(|vertex| positions[vertex as usize]);
        let [e, f] = [b, c].map(|corner| [0, 1, 2].map(|axis| corner[axis] - a[axis]));
        let normal = crate::vector::cross(e, f);
        crate::vector::dot(normal, normal).sqrt() / 2.0
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(50))]

        #[test]
        fn a_closed_surface_stays_closed_and_keeps_its_area(
            corners in prop::array::uniform4(prop::array::uniform3(0.0f64..10.0)), longest in 0.6f64..5.0, cut in 0u32..16,
        ) {
            let triangles = [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]];
            let found = subdivide(&corners, &triangles, |triangle| cut >> triangle & 1 == 1, longest, 1 << 20);
            prop_assert_eq!(open_edges(&found.pieces), 0);
            let mut areas = [0.0; 4];
            for piece in &found.pieces {
                areas[piece.triangle as usize] += area(&found.positions, piece.vertices);
                let is_cut = cut >> piece.triangle & 1 == 1;
                for (corner, vertex) in piece.vertices.into_iter().enumerate() {
                    let expected = triangles[piece.triangle as usize].map(|vertex| corners[vertex as usize]);
                    let place: [f64; 3] = std::array::from_fn(|axis| (0..3).map(|k| f64::from(piece.weights[corner][k]) * expected[k][axis]).sum());
                    let position = found.positions[vertex as usize];
                    prop_assert!((0..3).all(|axis| (place[axis] - position[axis]).abs() < 1e-9));
                }
                for edge in edges(piece.vertices) {
                    prop_assert!(!is_cut || length(&found.positions, edge) <= longest);
                }
            }
            for (found, triangle) in areas.iter().zip(triangles) {
                prop_assert!((found - area(&corners, triangle)).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn cutting_ends_before_there_are_too_many_pieces() {
        let positions = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let found = subdivide(&positions, &[[0, 1, 2]], |_| true, 1e-9, 300);
        assert_eq!(found.pieces.len(), 256);
        assert!((found.longest - 2.0f64.sqrt() / 16.0).abs() < 1e-12);
    }
}
