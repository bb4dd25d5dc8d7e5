//! Which column centres lie on which side of a triangle's edge.
//!
//! For an edge from P to Q of a projected triangle, `E(p) = (Q − P) × (p − P)` is positive on the inner side (Pineda 1988).
//! At the centre of column (i, j) it is `A·i + B·j + C` times the sub-voxel steps of a voxel, plus a constant, all integers.
//!
//! **Fill rule.** A centre may lie exactly on an edge, or on a vertex. All centres are taken to be moved by the same
//! infinitesimal amounts ε_x ≫ ε_y ≫ ε_z > 0. Then none lies on an edge, so of the two triangles at an edge exactly one
//! covers the centre if they lie on different sides of it, and both or none if they lie on the same. Where E is zero, the
//! sign is that of `A·ε_u + B·ε_v`: that of A, and that of B if A is zero, since u comes before v in x, y, z.
//! No triangle's order of vertices, and no order of triangles, enters into this.

use crate::fixed_point::{HALF_VOXEL, SUBVOXEL_BITS};

/// The inner side of an edge, on the lattice of column centres: `a·i + b·j + c ≥ 0`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EdgeFunction {
    /// At most 24 bits, as `b`.
    pub a: i64,
    pub b: i64,
    /// At most 40 bits.
    c: i64,
}

impl EdgeFunction {
    /// The edge from `p` to `q` of a triangle that turns counterclockwise, or clockwise if `flipped`.
    /// Coordinates are sub-voxel steps along (u, v).
    pub(crate) fn new(p: [i64; 2], q: [i64; 2], flipped: bool) -> Self {
        let (p, q) = if flipped { (q, p) } else { (p, q) };
        let (a, b) = (p[1] - q[1], q[0] - p[0]);
        let half = i64::from(HALF_VOXEL);
        let at_first_center = a * (half - p[0]) + b * (half - p[1]);
        // Inside is E > 0, or E = 0 and the infinitesimal part positive: E ≥ 1 or E ≥ 0.
        let zero_is_inside = a > 0 || (a == 0 && b > 0);
        // a·i + b·j is an integer, so dividing by the steps of a voxel may round down.
        Self { a, b, c: (at_first_center - i64::from(!zero_is_inside)) >> SUBVOXEL_BITS }
    }

    /// Whether the centre of a column lies inside.
    #[cfg(test)]
    pub(crate) fn contains(&self, column: [i64; 2]) -> bool {
        self.a * column[0] + self.b * column[1] + self.c >= 0
    }

    /// Walks along the edge, beginning with the row `v` of columns.
    #[inline]
    pub(crate) fn walk(&self, v: i64) -> EdgeWalk {
        let value = self.b * v + self.c;
        if self.a == 0 {
            return EdgeWalk {
                side: Side::Rows,
                bound: value,
                step: self.b,
                rest: 0,
                rest_step: 0,
                divisor: 1,
            };
        }
        let divisor = self.a.abs();
        EdgeWalk {
            side: if self.a > 0 { Side::Left } else { Side::Right },
            bound: value.div_euclid(divisor),
            step: self.b.div_euclid(divisor),
            rest: value.rem_euclid(divisor),
            rest_step: self.b.rem_euclid(divisor),
            divisor,
        }
    }
}

/// What an edge bounds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    /// Columns are inside from a first one on.
    Left,
    /// Columns are inside up to a last one.
    Right,
    /// The edge is parallel to u: whole rows are inside.
    Rows,
}

/// The bound that an edge sets to each row of columns, row by row, by exact integer division: the quotient `bound` and the
/// remainder `rest` of the edge function's value in the first column are kept up to date by additions.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EdgeWalk {
    side: Side,
    bound: i64,
    step: i64,
    rest: i64,
    rest_step: i64,
    divisor: i64,
}

impl EdgeWalk {
    /// Narrows the columns `span[0]..=span[1]` of the row to those inside.
    #[inline]
    pub(crate) fn clip(&self, span: &mut [i64; 2]) {
        match self.side {
            Side::Left => span[0] = span[0].max(-self.bound),
            Side::Right => span[1] = span[1].min(self.bound),
            Side::Rows if self.bound < 0 => span[1] = i64::MIN,
            Side::Rows => {}
        }
    }

    /// Goes to the next row.
    #[inline]
    pub(crate) fn advance(&mut self) {
        self.bound += self.step;
        self.rest += self.rest_step;
        if self.rest >= self.divisor {
            self.rest -= self.divisor;
            self.bound += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn of_both_triangles_at_an_edge_one_covers_a_centre_on_it(
            p in prop::array::uniform2(-20i64..20), q in prop::array::uniform2(-20i64..20),
        ) {
            prop_assume!(p != q);
            // Vertices at column centres, so that many centres lie on the edge.
            let at = |column: [i64; 2]| column.map(|c| c * 1024 + 512);
            let (edge, back) = (EdgeFunction::new(at(p), at(q), false), EdgeFunction::new(at(q), at(p), false));
            let flipped = EdgeFunction::new(at(q), at(p), true);
            for i in -20..20 {
                for j in -20..20 {
                    prop_assert_ne!(edge.contains([i, j]), back.contains([i, j]));
                    prop_assert_eq!(edge.contains([i, j]), flipped.contains([i, j]));
                }
            }
        }

        #[test]
        fn the_walk_bounds_what_the_function_contains(
            p in prop::array::uniform2(-9000i64..9000), q in prop::array::uniform2(-9000i64..9000), start in -9i64..9,
        ) {
            let edge = EdgeFunction::new(p, q, false);
            let mut walk = edge.walk(start);
            for v in start..start + 12 {
                let mut span = [-12, 12];
                walk.clip(&mut span);
                for u in -12..=12 {
                    prop_assert_eq!(edge.contains([u, v]), span[0] <= u && u <= span[1], "{} {} {:?}", u, v, edge);
                }
                walk.advance();
            }
        }
    }
}
