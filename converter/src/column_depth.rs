//! The cell in which a triangle cuts the centre line of a column.

use crate::fixed_point::{HALF_VOXEL, SUBVOXEL_BITS};

/// The plane of a triangle over the lattice of column centres: cell along the column = ⌊(a·i + b·j + c) / d⌋.
///
/// Exact: a and b have at most 50 bits, d (twice the projected area) 49, c 75.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ColumnDepth {
    a: i64,
    b: i64,
    c: i128,
    d: i64,
}

impl ColumnDepth {
    /// The plane through three corners (u, v, w) in sub-voxel steps, w along the column.
    /// `area` is twice the signed area of the projection, not zero.
    pub(crate) fn new(corners: [[i64; 3]; 3], area: i64) -> Self {
        let [p, q, r] = corners;
        let (qu, qv, qw) = (q[0] - p[0], q[1] - p[1], q[2] - p[2]);
        let (ru, rv, rw) = (r[0] - p[0], r[1] - p[1], r[2] - p[2]);
        let sign = area.signum();
        // w = w_p + (a (u − u_p) + b (v − v_p)) / d, by Cramer's rule.
        let (a, b, d) = (sign * (qw * rv - rw * qv), sign * (rw * qu - qw * ru), area.abs());
        let half = i64::from(HALF_VOXEL);
        let c = i128::from(p[2]) * i128::from(d)
            + i128::from(half - p[0]) * i128::from(a)
            + i128::from(half - p[1]) * i128::from(b);
        // What is rounded down here is divided by d afterwards, together with integers: the result is the same.
        Self { a, b, c: c >> SUBVOXEL_BITS, d }
    }

    /// Begins a walk over columns at (u, v).
    #[inline]
    pub(crate) fn walk(&self, u: i64, v: i64) -> DepthWalk {
        let value = i128::from(self.a) * i128::from(u) + i128::from(self.b) * i128::from(v) + self.c;
        let here = match i64::try_from(value) {
            Ok(value) => Division::new(value, self.d),
            // Outside of the triangle the quotient may be anything, even too large: it is kept modulo 2^64, and is right
            // again as soon as a column inside is reached.
            Err(_) => {
                let divisor = i128::from(self.d);
                Division {
                    quotient: value.div_euclid(divisor) as i64,
                    rest: value.rem_euclid(divisor) as i64,
                }
            }
        };
        DepthWalk {
            slope: self.a,
            divisor: self.d,
            step_u: Division::new(self.a, self.d),
            step_v: Division::new(self.b, self.d),
            u,
            here,
        }
    }
}

/// The cell along the column, from column to column: quotient and remainder are kept up to date by additions.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DepthWalk {
    slope: i64,
    divisor: i64,
    step_u: Division,
    step_v: Division,
    u: i64,
    here: Division,
}

impl DepthWalk {
    /// The cell along this column.
    #[inline]
    pub(crate) fn cell(&self) -> i64 {
        self.here.quotient
    }

    /// Goes to the next column along u.
    #[inline]
    pub(crate) fn advance(&mut self) {
        self.u += 1;
        self.here.add(self.step_u, self.divisor);
    }

    /// Goes to the next row, in the same column along u.
    #[inline]
    pub(crate) fn advance_row(&mut self) {
        self.here.add(self.step_v, self.divisor);
    }

    /// Goes to a column of this row that is fewer than 2^13 columns away.
    #[inline]
    pub(crate) fn seek(&mut self, u: i64) {
        // From row to row the first column moves little: a few steps cost less than a division.
        match u - self.u {
            0..=4 => {
                while self.u < u {
                    self.advance();
                }
            }
            -4..0 => {
                while self.u > u {
                    self.u -= 1;
                    self.here.subtract(self.step_u, self.divisor);
                }
            }
            columns => {
                let far = Division::new(self.here.rest + self.slope * columns, self.divisor);
                self.here =
                    Division { quotient: self.here.quotient.wrapping_add(far.quotient), rest: far.rest };
                self.u = u;
            }
        }
    }
}

/// A value divided by a positive number, rounded down, with what is left.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Division {
    quotient: i64,
    rest: i64,
}

impl Division {
    #[inline]
    fn new(value: i64, divisor: i64) -> Self {
        Self { quotient: value.div_euclid(divisor), rest: value.rem_euclid(divisor) }
    }

    #[inline]
    fn add(&mut self, other: Self, divisor: i64) {
        self.quotient = self.quotient.wrapping_add(other.quotient);
        self.rest += other.rest;
        if self.rest >= divisor {
            self.rest -= divisor;
            self.quotient = self.quotient.wrapping_add(1);
        }
    }

    #[inline]
    fn subtract(&mut self, other: Self, divisor: i64) {
        self.quotient = self.quotient.wrapping_sub(other.quotient);
        self.rest -= other.rest;
        if self.rest < 0 {
            self.rest += divisor;
            self.quotient = self.quotient.wrapping_sub(1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The same cell from the plane's normal, in rational arithmetic.
    fn cell_by_normal(corners: [[i64; 3]; 3], column: [i64; 2]) -> i128 {
        let wide = corners.map(|corner| corner.map(i128::from));
        let edge = |k: usize| [0, 1, 2].map(|axis| wide[k][axis] - wide[0][axis]);
        let (e, f) = (edge(1), edge(2));
        let normal = [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]];
        let center = column.map(|c| i128::from(c) * 1024 + 512);
        // n · (p − p0) = 0, solved for the third coordinate.
        let numerator = normal[2] * wide[0][2]
            - normal[0] * (center[0] - wide[0][0])
            - normal[1] * (center[1] - wide[0][1]);
        let (numerator, denominator) = (numerator * normal[2].signum(), normal[2].abs() * 1024);
        numerator.div_euclid(denominator)
    }

    proptest! {
        #[test]
        fn steps_and_jumps_agree_with_the_plane(
            corners in prop::array::uniform3(prop::array::uniform3(0i64..=1 << 24)), start in prop::array::uniform2(0i64..16_384),
            seeks in prop::array::uniform3(prop::array::uniform4(0i64..12)),
        ) {
            let [p, q, r] = corners;
            let area = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
            prop_assume!(area != 0);
            let [u, v] = start;
            let mut walk = ColumnDepth::new(corners, area).walk(u, v);
            for (dv, targets) in seeks.into_iter().enumerate() {
                for du in targets {
                    walk.seek(u + du);
                    prop_assert_eq!(walk.cell(), cell_by_normal(corners, [u + du, v + dv as i64]) as i64);
                }
                walk.advance_row();
            }
        }
    }
}
