//! Thin, closed surfaces of voxels.
//!
//! A voxel is marked if and only if the triangle meets one of the three axis-parallel *centre segments* of the voxel: the
//! parts inside it of the lines through its centre (Laine 2013, "A Topological Approach to Voxelization"). Each axis is
//! handled by projecting the triangle along it: the centre of every column that it covers is looked up in the plane, and
//! the voxel of that depth is marked. Segments are half-open, so that a depth on a face belongs to the upper voxel, except
//! at the far end of the cube.
//!
//! **Why the surface is 6-separating.** Move all voxel centres by the same infinitesimal (ε_x, ε_y, ε_z) that the fill rule
//! of [`crate::edge_function`] uses. The moved centres, joined by axis-parallel edges from voxel to neighbour, form a
//! lattice in general position: no edge of it meets an edge or a vertex of the mesh, nor lies in a triangle. A walk
//! through faces of voxels is a walk along this lattice. If it leads from one side of a closed mesh to the other, some
//! edge of the lattice crosses a triangle, that is, a column's centre is covered in the projection along that axis, and
//! the depth lies between the centres of the two neighbours. The voxel marked for it is one of the two, so the walk enters
//! a marked voxel. The converse, that nothing is marked without need, is the definition.
//!
//! Triangles that are seen edge-on in a projection are never crossed by the moved lattice and contribute nothing there.
//! Every decision is an integer predicate of one triangle, symmetric in its vertices; so neither the order of triangles,
//! nor their orientation, nor the cut into blocks changes which voxels are marked.

use crate::block::Block;
use crate::column_depth::ColumnDepth;
use crate::edge_function::EdgeFunction;
use crate::fixed_point::{GridPoint, HALF_VOXEL, SUBVOXEL_BITS, SUBVOXELS};
use crate::interpolation::{Interpolation, rounded};
use crate::morton::spread_in_block;
use crate::texture::Coordinates;

/// What a triangle contributes to a voxel: its values where it was sampled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Sample<const N: usize> {
    /// Morton code of the voxel in its block.
    pub cell: u32,
    /// Number of the finish.
    pub finish: u16,
    /// Normal and, if `N` is 6, colour.
    pub values: [i16; N],
}

/// A triangle on the sub-voxel grid with values, and texture coordinates if it has any, at its corners.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct GridTriangle<const N: usize, T = ()> {
    corners: [GridPoint; 3],
    values: [[i16; N]; 3],
    coordinates: [T; 3],
    finish: u16,
}

impl<const N: usize> GridTriangle<N> {
    /// A triangle without textures.
    #[inline]
    pub(crate) fn new(corners: [GridPoint; 3], values: [[i16; N]; 3], finish: u16) -> Self {
        Self::with_texture(corners, values, [(); 3], finish)
    }
}

impl<const N: usize, T: Coordinates> GridTriangle<N, T> {
    /// The corners are put into an order that depends only on what they are, so that everything that is computed from
    /// them is the same for every order in which they are given.
    #[inline]
    pub(crate) fn with_texture(
        corners: [GridPoint; 3],
        values: [[i16; N]; 3],
        coordinates: [T; 3],
        finish: u16,
    ) -> Self {
        let mut triangle = Self { corners, values, coordinates, finish };
        triangle.sort_pair(0, 1);
        triangle.sort_pair(1, 2);
        triangle.sort_pair(0, 1);
        triangle
    }

    #[inline]
    fn sort_pair(&mut self, a: usize, b: usize) {
        let corner = |k: usize| (self.corners[k], self.values[k], self.coordinates[k]);
        if corner(a) > corner(b) {
            self.corners.swap(a, b);
            self.values.swap(a, b);
            self.coordinates.swap(a, b);
        }
    }

    pub(crate) fn corners(&self) -> &[GridPoint; 3] {
        &self.corners
    }

    pub(crate) fn values(&self) -> &[[i16; N]; 3] {
        &self.values
    }

    pub(crate) fn coordinates(&self) -> &[T; 3] {
        &self.coordinates
    }

    pub(crate) fn finish(&self) -> u16 {
        self.finish
    }

    /// Marks the voxels of a block that belong to the triangle's thin surface, some of them more than once.
    ///
    /// `look` makes the values of a sample from those between the corners and the texture coordinates there; `None` leaves
    /// the sample out.
    pub(crate) fn scan(
        &self,
        block: &Block,
        look: &mut impl FnMut([i16; N], T::Point) -> Option<[i16; N]>,
        samples: &mut Vec<Sample<N>>,
    ) {
        let columns = [0, 1, 2].map(|axis| self.columns(block, axis));
        for (along, [u, v]) in ACROSS.into_iter().enumerate() {
            if let (Some(u_range), Some(v_range)) = (columns[u], columns[v]) {
                self.project([u, v, along], u_range, v_range, block, look, samples);
            }
        }
    }

    /// The first and the last of the block's cells, along an axis, whose centres lie within the triangle's extent.
    #[inline]
    fn columns(&self, block: &Block, axis: usize) -> Option<[i64; 2]> {
        let [low, high] = extent(&self.corners, axis);
        let [first, last] = centers_within(low, high);
        let (first, last) = (first.max(block.first[axis]), last.min(block.first[axis] + block.size - 1));
        (first <= last).then_some([i64::from(first), i64::from(last)])
    }

    /// Samples the projection along `axes[2]` at the centres of the columns `u` × `v`.
    fn project(
        &self,
        axes: [usize; 3],
        u_range: [i64; 2],
        v_range: [i64; 2],
        block: &Block,
        look: &mut impl FnMut([i16; N], T::Point) -> Option<[i16; N]>,
        samples: &mut Vec<Sample<N>>,
    ) {
        let [p, q, r] = self.corners.map(|corner| axes.map(|axis| i64::from(corner[axis])));
        let area = (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
        if area == 0 {
            return;
        }
        let [pu, qu, ru] = [p, q, r].map(|corner| [corner[0], corner[1]]);
        let flipped = area < 0;
        let mut edges = [(pu, qu), (qu, ru), (ru, pu)]
            .map(|(from, to)| EdgeFunction::new(from, to, flipped).walk(v_range[0]));
        let mut depth = ColumnDepth::new([p, q, r], area).walk(u_range[0], v_range[0]);
        let interpolation = Interpolation::new([p, q, r], self.values, area);
        let texture = T::plane(self.coordinates, [p, q, r], area);

        let first_cell = axes.map(|axis| i64::from(block.first[axis]));
        let size = i64::from(block.size);
        // The far face of the cube belongs to the last cell.
        let deepest = if block.is_last[axes[2]] { size } else { size - 1 };
        for v in v_range[0]..=v_range[1] {
            let mut span = u_range;
            for edge in &mut edges {
                edge.clip(&mut span);
                edge.advance();
            }
            if span[0] <= span[1] {
                depth.seek(span[0]);
                let row_code = spread_in_block(v - first_cell[1]) << axes[1];
                let mut column = depth;
                let mut values = interpolation.at(span[0], v);
                for u in span[0] - first_cell[0]..=span[1] - first_cell[0] {
                    let w = column.cell().wrapping_sub(first_cell[2]);
                    if (0..=deepest).contains(&w)
                        && let Some(values) = look(rounded(values), T::at(&texture, [u + first_cell[0], v]))
                    {
                        let cell = row_code
                            | spread_in_block(u) << axes[0]
                            | spread_in_block(w.min(size - 1)) << axes[2];
                        samples.push(Sample { cell, finish: self.finish, values });
                    }
                    column.advance();
                    interpolation.advance(&mut values);
                }
            }
            depth.advance_row();
        }
    }
}

/// The two axes across each axis, in the order of the fill rule.
pub(crate) const ACROSS: [[usize; 2]; 3] = [[1, 2], [0, 2], [0, 1]];

/// The smallest and the largest coordinate of a triangle along an axis.
#[inline]
pub(crate) fn extent(corners: &[GridPoint; 3], axis: usize) -> [i32; 2] {
    let [a, b, c] = corners.map(|corner| corner[axis]);
    [a.min(b).min(c), a.max(b).max(c)]
}

/// The first and the last cell whose centre lies in `low..=high`; the first is beyond the last if there is none.
#[inline]
pub(crate) fn centers_within(low: i32, high: i32) -> [i32; 2] {
    [(low + (SUBVOXELS - 1 - HALF_VOXEL)) >> SUBVOXEL_BITS, (high - HALF_VOXEL) >> SUBVOXEL_BITS]
}
