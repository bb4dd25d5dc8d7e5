//! Scan conversion against exact predicates that are derived in another way.

mod support;

use octvox_converter::{Mesh, Options};
use proptest::prelude::*;
use std::collections::BTreeSet;
use support::{Cell, cuboid, unit_voxels, voxels};

/// Sub-voxel steps of a voxel: vertices at their multiples are not moved by the conversion.
const STEPS: i128 = 1024;

type Point = [i128; 3];

/// The filled cells of one triangle whose corners are given in sub-voxel steps.
fn converted(corners: [Point; 3], depth: u8, conservative: bool) -> BTreeSet<Cell> {
    let positions = corners.map(|corner| corner.map(|coordinate| coordinate as f64 / STEPS as f64)).to_vec();
    let mesh = Mesh::new(positions, vec![[0, 1, 2]]).unwrap();
    voxels(&mesh, &Options { conservative, ..unit_voxels(depth) }).into_keys().collect()
}

fn cells(depth: u8) -> impl Iterator<Item = Cell> {
    let side = 1 << depth;
    (0..side).flat_map(move |x| (0..side).flat_map(move |y| (0..side).map(move |z| [x, y, z])))
}

/// The thin surface by its definition: a voxel is filled if the triangle meets one of its three centre segments.
mod centre_segments {
    use super::*;

    fn determinant([a, b, c]: [Point; 3]) -> i128 {
        a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
    }

    fn minus(a: Point, b: Point) -> Point {
        [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
    }

    fn axis_vector(axis: usize) -> Point {
        let mut vector = [0; 3];
        vector[axis] = 1;
        vector
    }

    /// On which side of a line the edge from p to q passes: the sign of the Plücker product of both.
    ///
    /// The line goes through `a + (ε, ε², ε³)` along `axis`, ε infinitesimal. The product det[p − a, q − a, d] is affine
    /// in a, so each power of ε has the coefficient −det[e, q, d] − det[p, e, d] (with p, q relative to a), and the first
    /// that is not zero decides.
    fn side(a: Point, axis: usize, p: Point, q: Point) -> i128 {
        let d = axis_vector(axis);
        let (p, q) = (minus(p, a), minus(q, a));
        let epsilon = |k: usize| -determinant([axis_vector(k), q, d]) - determinant([p, axis_vector(k), d]);
        [determinant([p, q, d]), epsilon(0), epsilon(1), epsilon(2)]
            .into_iter()
            .find(|&coefficient| coefficient != 0)
            .map_or(0, i128::signum)
    }

    fn meets(corners: [Point; 3], cell: Cell, axis: usize, side_of_cube: u32) -> bool {
        let low = cell.map(|c| i128::from(c) * STEPS);
        let a = low.map(|coordinate| coordinate + STEPS / 2);
        let [p, q, r] = corners;
        let sides = [side(a, axis, p, q), side(a, axis, q, r), side(a, axis, r, p)];
        if sides != [1; 3] && sides != [-1; 3] {
            return false;
        }
        // Where the line meets the plane: a + t · d with t = numerator / denominator.
        let (e, f) = (minus(q, p), minus(r, p));
        let denominator = determinant([axis_vector(axis), e, f]);
        let numerator = determinant([minus(p, a), e, f]) * denominator.signum();
        let denominator = denominator.abs();
        // From −1/2 voxel to below +1/2; the last cell includes the far face of the cube.
        let is_last = cell[axis] + 1 == side_of_cube;
        let end = STEPS / 2 * denominator;
        numerator >= -end && (numerator < end || (is_last && numerator == end))
    }

    pub fn filled(corners: [Point; 3], depth: u8) -> BTreeSet<Cell> {
        cells(depth).filter(|&cell| (0..3).any(|axis| meets(corners, cell, axis, 1 << depth))).collect()
    }
}

/// What a triangle touches, by cutting off what lies outside of each closed voxel, in rational numbers.
mod clipping {
    use super::*;

    #[derive(Debug, Clone, Copy)]
    struct Ratio(i128, i128);

    impl Ratio {
        fn new(numerator: i128, denominator: i128) -> Self {
            let (mut a, mut b) = (numerator.abs(), denominator.abs());
            while b != 0 {
                (a, b) = (b, a % b);
            }
            let scale = a.max(1) * denominator.signum();
            Self(numerator / scale, denominator / scale)
        }

        /// The sign of self − limit.
        fn compare(self, limit: i128) -> i128 {
            (self.0 - limit * self.1).signum()
        }

        /// The value at which a coordinate that goes from `from` to `to` is at `limit`, for one that goes from self to
        /// `other` at the same time.
        fn mix(self, other: Self, from: Self, to: Self, limit: i128) -> Self {
            let t = Self::new((limit * from.1 - from.0) * to.1, to.0 * from.1 - from.0 * to.1);
            let difference = Self::new(other.0 * self.1 - self.0 * other.1, self.1 * other.1);
            let product = Self::new(difference.0 * t.0, difference.1 * t.1);
            Self::new(self.0 * product.1 + product.0 * self.1, self.1 * product.1)
        }
    }

    /// What of a convex polygon lies at `limit` or beyond it along an axis, in the direction of `sign`.
    fn clip(polygon: &[[Ratio; 3]], axis: usize, limit: i128, sign: i128) -> Vec<[Ratio; 3]> {
        let mut kept = Vec::new();
        for (index, from) in polygon.iter().enumerate() {
            let to = &polygon[(index + 1) % polygon.len()];
            let (from_side, to_side) = (from[axis].compare(limit) * sign, to[axis].compare(limit) * sign);
            if from_side >= 0 {
                kept.push(*from);
            }
            if from_side * to_side < 0 {
                kept.push([0, 1, 2].map(|k| from[k].mix(to[k], from[axis], to[axis], limit)));
            }
        }
        kept
    }

    pub fn filled(corners: [Point; 3], depth: u8) -> BTreeSet<Cell> {
        let touches = |cell: &Cell| {
            let polygon = corners.map(|corner| corner.map(|coordinate| Ratio::new(coordinate, 1))).to_vec();
            let rest = (0..3).fold(polygon, |polygon, axis| {
                let low = i128::from(cell[axis]) * STEPS;
                clip(&clip(&polygon, axis, low, 1), axis, low + STEPS, -1)
            });
            !rest.is_empty()
        };
        cells(depth).filter(touches).collect()
    }
}

/// The cell of the first corner, which stands for a triangle that marks none.
fn first_cell(corners: [Point; 3], depth: u8) -> Cell {
    let last = (1 << depth) - 1;
    corners.into_iter().min().unwrap().map(|coordinate| ((coordinate / STEPS) as u32).min(last))
}

fn check(corners: [Point; 3], depth: u8) {
    let mut expected = centre_segments::filled(corners, depth);
    if expected.is_empty() {
        expected.insert(first_cell(corners, depth));
    }
    assert_eq!(converted(corners, depth, false), expected, "thin {corners:?}");
    assert_eq!(converted(corners, depth, true), clipping::filled(corners, depth), "touched {corners:?}");
}

/// Corners on a lattice: at voxel corners, edges, faces and centres if the steps are coarse.
fn corners(depth: u8, lattice: i128) -> impl Strategy<Value = [Point; 3]> {
    let end = (STEPS << depth) / lattice;
    prop::array::uniform3(prop::array::uniform3(0..=end))
        .prop_map(move |corners| corners.map(|corner| corner.map(|coordinate| coordinate * lattice)))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(600))]

    #[test]
    fn triangles_with_corners_at_centres_and_faces(corners in corners(2, STEPS / 2)) {
        check(corners, 2);
    }

    #[test]
    fn triangles_on_a_fine_lattice(corners in corners(2, 64)) {
        check(corners, 2);
    }

    #[test]
    fn triangles_anywhere(corners in corners(3, 1)) {
        let mut expected = centre_segments::filled(corners, 3);
        if expected.is_empty() {
            expected.insert(first_cell(corners, 3));
        }
        prop_assert_eq!(converted(corners, 3, false), expected);
    }

    #[test]
    fn small_triangles(origin in prop::array::uniform3(0i128..7000), corners in prop::array::uniform3(prop::array::uniform3(0i128..1100))) {
        let corners = corners.map(|corner| [0, 1, 2].map(|axis| origin[axis] + corner[axis]));
        let mut expected = centre_segments::filled(corners, 3);
        if expected.is_empty() {
            expected.insert(first_cell(corners, 3));
        }
        prop_assert_eq!(converted(corners, 3, false), expected);
    }

    #[test]
    fn slivers(a in prop::array::uniform3(0i128..=4096), b in prop::array::uniform3(0i128..=4096), nudge in prop::array::uniform3(-1i128..=1)) {
        // The third corner lies beside the middle of the first two.
        let c = [0, 1, 2].map(|axis| ((a[axis] + b[axis]) / 2 + nudge[axis]).clamp(0, 4096));
        let mut expected = centre_segments::filled([a, b, c], 2);
        if expected.is_empty() {
            expected.insert(first_cell([a, b, c], 2));
        }
        prop_assert_eq!(converted([a, b, c], 2, false), expected);
    }
}

#[test]
fn a_box_that_spans_the_cube_is_its_shell() {
    let mesh = cuboid([0.0; 3], [1.0; 3]);
    for conservative in [false, true] {
        let options = Options { depth: 3, conservative, ..Options::default() };
        let found = voxels(&mesh, &options);
        let expected: BTreeSet<Cell> = cells(3)
            .filter(|cell| cell.iter().any(|&coordinate| coordinate == 0 || coordinate == 7))
            .collect();
        assert_eq!(expected.len(), 8 * 8 * 8 - 6 * 6 * 6);
        assert_eq!(found.into_keys().collect::<BTreeSet<_>>(), expected);
    }
}

#[test]
fn the_shell_of_a_box_faces_outward() {
    let mesh = cuboid([0.0; 3], [1.0; 3]);
    for (cell, (color, normal)) in voxels(&mesh, &Options { depth: 3, ..Options::default() }) {
        let outward = cell.map(|c| if c == 0 { -1.0 } else { f32::from(u8::from(c == 7)) });
        let normal = normal.decode();
        let dot: f32 = (0..3).map(|axis| outward[axis] * normal[axis]).sum();
        let length = outward.iter().map(|component| component * component).sum::<f32>().sqrt();
        assert!(dot / length > 0.999, "{cell:?} {normal:?}");
        assert_eq!(color, [204; 3]);
    }
}

#[test]
fn a_mesh_without_extent_is_one_voxel() {
    for depth in 0..=4 {
        let found = voxels(
            &Mesh::new(vec![[7.5; 3]; 3], vec![[0, 1, 2]]).unwrap(),
            &Options { depth, ..Options::default() },
        );
        let center = (1 << depth) / 2;
        assert_eq!(found.into_keys().collect::<Vec<_>>(), [[center; 3]]);
    }
}

#[test]
fn every_part_leaves_a_voxel() {
    // Small triangles, a segment and a point in otherwise empty cells, beside a wall that many cells belong to.
    let mut positions = vec![[0.0, 0.0, 0.0], [0.0, 16.0, 0.0], [0.0, 0.0, 16.0]];
    let mut triangles = vec![[0, 1, 2]];
    let mut expected = Vec::new();
    for (index, cell) in [[5u32, 5, 5], [9, 2, 14], [15, 15, 15], [12, 0, 3]].into_iter().enumerate() {
        let first = positions.len() as u32;
        let at = |offset: [f64; 3]| [0, 1, 2].map(|axis| f64::from(cell[axis]) + offset[axis]);
        positions.extend([at([0.1, 0.1, 0.1]), at([0.3, 0.1, 0.2]), at([0.2, 0.25, 0.1])]);
        let [a, b, c] = [first, first + 1, first + 2];
        triangles.push(match index {
            0 | 1 => [a, b, c],
            2 => [a, b, b],
            _ => [c, c, c],
        });
        expected.push(cell);
    }
    // A second triangle of the first part, in the neighbouring cell, too small as well: one voxel is enough for both.
    positions.push([6.05, 5.1, 5.1]);
    triangles.push([4, 3, positions.len() as u32 - 1]);
    let mesh = Mesh::new(positions, triangles).unwrap();
    let (_, report) = support::convert_to_bytes(&mesh, &unit_voxels(4));
    assert_eq!(report.degenerate_triangles, 2);
    let found = voxels(&mesh, &unit_voxels(4));
    let parts: Vec<Cell> = found.into_keys().filter(|cell| cell[0] != 0).collect();
    expected.sort_unstable();
    assert_eq!(parts, expected);
}

#[test]
fn cells_beyond_the_first_block_are_the_same_as_in_it() {
    // The same triangle near the origin and far out, in a cube of many blocks.
    let corners = [[0.3, 0.2, 5.1], [70.0, 11.0, 0.7], [13.3, 90.0, 40.0]];
    let at =
        |offset: f64| Mesh::new(corners.map(|c| c.map(|v| v + offset)).to_vec(), vec![[0, 1, 2]]).unwrap();
    let options = unit_voxels(9);
    let near: Vec<Cell> = voxels(&at(0.0), &options).into_keys().collect();
    assert!(near.len() > 3000);
    for offset in [1u32, 63, 64, 300] {
        let far: Vec<Cell> = voxels(&at(f64::from(offset)), &options).into_keys().collect();
        assert_eq!(far, near.iter().map(|cell| cell.map(|c| c + offset)).collect::<Vec<_>>());
    }
}
