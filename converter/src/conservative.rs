//! Every voxel that a triangle touches.
//!
//! Voxels are closed here: a triangle that lies in the face between two voxels, or ends at a corner of eight, touches them
//! all. The voxels are then 26-separating: a walk through faces, edges and corners of voxels from one side of a closed
//! surface to the other crosses the surface at a point, in a voxel, or in a face, edge or corner common to the voxels it
//! leaves and enters; both touch the surface there.
//!
//! Two convex bodies are apart if and only if an axis among the normals of their faces and the products of their edges
//! separates their projections (Akenine-Möller 2001, "Fast 3D Triangle-Box Overlap Testing"); here all in integers. That
//! holds for triangles collapsed to a line or a point as well, whose remaining axes are those of a segment and a box.

use crate::block::Block;
use crate::fixed_point::{GridPoint, HALF_VOXEL, SUBVOXEL_BITS, SUBVOXELS};
use crate::morton::spread_in_block;
use crate::scan_conversion::{ACROSS, GridTriangle, Sample, extent};
use crate::texture::Coordinates;

impl<const N: usize, T: Coordinates> GridTriangle<N, T> {
    /// Marks the voxels of a block that the triangle touches, each once, with its values near their centres.
    ///
    /// `look` is as for [`GridTriangle::scan`].
    pub(crate) fn scan_touched(
        &self,
        block: &Block,
        look: &mut impl FnMut([i16; N], T::Point) -> Option<[i16; N]>,
        samples: &mut Vec<Sample<N>>,
    ) {
        let ranges = [0, 1, 2].map(|axis| {
            let [low, high] = extent(self.corners(), axis);
            // A face between two cells belongs to both.
            let first = ((low - 1) >> SUBVOXEL_BITS).max(block.first[axis]);
            let last = (high >> SUBVOXEL_BITS).min(block.first[axis] + block.size - 1);
            [first, last]
        });
        if ranges.iter().any(|[first, last]| first > last) {
            return;
        }
        let overlap = Overlap::new(self.corners());
        let [u, v] = ACROSS[overlap.along];
        let weights = Weights::new(self.corners(), overlap.along);
        for cell_u in ranges[u][0]..=ranges[u][1] {
            for cell_v in ranges[v][0]..=ranges[v][1] {
                let [first, last] = overlap.depth_range(cell_u, cell_v);
                let (first, last) = (first.max(ranges[overlap.along][0]), last.min(ranges[overlap.along][1]));
                for cell_w in first..=last {
                    let mut cell = [0; 3];
                    (cell[u], cell[v], cell[overlap.along]) = (cell_u, cell_v, cell_w);
                    if !overlap.touches(cell) {
                        continue;
                    }
                    let near = weights.near([cell_u, cell_v]);
                    let point = T::mean(self.coordinates(), near);
                    if let Some(values) = look(mean(self.values(), near), point) {
                        let code =
                            [0, 1, 2].map(|axis| spread_in_block((cell[axis] - block.first[axis]).into()));
                        let cell = code[0] | code[1] << 1 | code[2] << 2;
                        samples.push(Sample { cell, finish: self.finish(), values });
                    }
                }
            }
        }
    }
}

/// The separating axes of a triangle and a voxel.
struct Overlap {
    corners: [[i64; 3]; 3],
    normal: [i64; 3],
    /// The axis along which the triangle is steepest seen from, that is, the largest component of its normal.
    along: usize,
}

impl Overlap {
    fn new(corners: &[GridPoint; 3]) -> Self {
        let corners = corners.map(|corner| corner.map(i64::from));
        let [a, b, c] = corners;
        let normal = cross(difference(b, a), difference(c, a));
        let along =
            (0..3).fold(0, |best, axis| if normal[axis].abs() > normal[best].abs() { axis } else { best });
        Self { corners, normal, along }
    }

    /// Cells along [`Overlap::along`] which the triangle's plane touches over the column of cells (u, v), and perhaps
    /// one more at each end; all if the triangle has no area.
    fn depth_range(&self, cell_u: i32, cell_v: i32) -> [i32; 2] {
        let normal = self.normal.map(i128::from);
        let [u, v] = ACROSS[self.along];
        if normal[self.along] == 0 {
            return [i32::MIN, i32::MAX];
        }
        let center = |cell: i32| i128::from(cell) * i128::from(SUBVOXELS) + i128::from(HALF_VOXEL);
        let corner = self.corners[0].map(i128::from);
        let rise = normal[u] * (corner[u] - center(cell_u)) + normal[v] * (corner[v] - center(cell_v));
        let half_height = i128::from(HALF_VOXEL) * (normal[u].abs() + normal[v].abs());
        let (steep, sign) = (normal[self.along].abs(), normal[self.along].signum());
        let depth = |rise: i128| ((rise * sign).div_euclid(steep) + corner[self.along]) as i64;
        // The largest component bounds the slope by 1 for each axis, so depths stay within 26 bits.
        let (low, high) = (depth(rise - sign * half_height), depth(rise + sign * half_height));
        [((low - 1) >> SUBVOXEL_BITS) as i32, ((high + 1) >> SUBVOXEL_BITS) as i32]
    }

    /// Whether triangle and closed voxel have a point in common.
    fn touches(&self, cell: [i32; 3]) -> bool {
        let half = i64::from(HALF_VOXEL);
        let center = cell.map(|c| i64::from(c) * i64::from(SUBVOXELS) + half);
        let corners = self.corners.map(|corner| difference(corner, center));
        let faces = (0..3).all(|axis| {
            let [a, b, c] = corners.map(|corner| corner[axis]);
            a.min(b).min(c) <= half && a.max(b).max(c) >= -half
        });
        faces && self.plane_touches(corners[0]) && edges_touch(corners)
    }

    fn plane_touches(&self, corner: [i64; 3]) -> bool {
        let distance: i128 =
            (0..3).map(|axis| i128::from(self.normal[axis]) * i128::from(corner[axis])).sum();
        let reach: i128 = self.normal.iter().map(|component| i128::from(component.abs())).sum();
        distance.abs() <= reach * i128::from(HALF_VOXEL)
    }
}

/// Whether no product of an edge of the triangle and an axis separates it from the voxel around the origin.
fn edges_touch(corners: [[i64; 3]; 3]) -> bool {
    let half = i64::from(HALF_VOXEL);
    [[0, 1, 2], [1, 2, 0], [2, 0, 1]].into_iter().all(|[from, to, other]| {
        let edge = difference(corners[to], corners[from]);
        (0..3).all(|axis| {
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            // Both ends of the edge have the same place on this axis.
            let place = |corner: [i64; 3]| edge[u] * corner[v] - edge[v] * corner[u];
            let (a, b) = (place(corners[from]), place(corners[other]));
            let reach = half * (edge[u].abs() + edge[v].abs());
            a.min(b) <= reach && a.max(b) >= -reach
        })
    })
}

/// Mixes the values of the corners for a voxel.
struct Weights {
    /// Edge functions (a, b, c) in the projection, that of the edge opposite to each corner, as sub-voxel floats.
    edges: [[f64; 3]; 3],
}

impl Weights {
    fn new(corners: &[GridPoint; 3], along: usize) -> Self {
        let [u, v] = ACROSS[along];
        let flat = corners.map(|corner| [f64::from(corner[u]), f64::from(corner[v])]);
        let edges = [[1, 2], [2, 0], [0, 1]].map(|[from, to]| {
            let (p, q) = (flat[from], flat[to]);
            let (a, b) = (p[1] - q[1], q[0] - p[0]);
            [a, b, -(a * p[0] + b * p[1])]
        });
        let [a, b, c] = edges[0];
        let area = a * flat[0][0] + b * flat[0][1] + c;
        Self { edges: edges.map(|edge| edge.map(|value| value * area.signum())) }
    }

    /// The weights of the corners where the centre line of the voxel meets the triangle, or at a near point of its edge.
    /// Their sum is 1.
    fn near(&self, cell: [i32; 2]) -> [f64; 3] {
        let [u, v] = cell.map(|c| f64::from(c) * f64::from(SUBVOXELS) + f64::from(HALF_VOXEL));
        let mut weights = self.edges.map(|[a, b, c]| (a * u + b * v + c).max(0.0));
        let mut total: f64 = weights.iter().sum();
        if total <= 0.0 {
            (weights, total) = ([1.0; 3], 3.0);
        }
        weights.map(|weight| weight / total)
    }
}

fn mean<const N: usize>(values: &[[i16; N]; 3], weights: [f64; 3]) -> [i16; N] {
    std::array::from_fn(|k| {
        let sum: f64 = (0..3).map(|corner| weights[corner] * f64::from(values[corner][k])).sum();
        sum.round() as i16
    })
}

fn difference(a: [i64; 3], b: [i64; 3]) -> [i64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn cross(a: [i64; 3], b: [i64; 3]) -> [i64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
