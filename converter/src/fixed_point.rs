//! The sub-voxel grid on which all decisions are made in integers.
//!
//! Vertices are rounded once to multiples of 1/1024 voxel. From then on every question (which side of an edge? which cell
//! along a column?) is answered by integers, so that neighbouring triangles, which share the rounded vertices, always
//! agree.

use crate::{Mesh, Options, WorldTransform};
use rayon::prelude::*;

/// Sub-voxel steps per voxel, as a power of two.
pub(crate) const SUBVOXEL_BITS: u32 = 10;
/// Sub-voxel steps per voxel.
pub(crate) const SUBVOXELS: i32 = 1 << SUBVOXEL_BITS;
/// Sub-voxel steps from a voxel's face to its centre.
pub(crate) const HALF_VOXEL: i32 = SUBVOXELS / 2;

/// Bits of the largest coordinate. Products of two differences then have 48 bits, and with a third factor 72.
pub(crate) const COORDINATE_BITS: u32 = Options::MAX_DEPTH as u32 + SUBVOXEL_BITS;
const _: () = assert!(COORDINATE_BITS == 24);

/// A point on the sub-voxel grid: 0 to 2^(depth + 10) along each axis, both ends included.
pub(crate) type GridPoint = [i32; 3];

/// Rounds all vertices to the grid.
pub(crate) fn snap_vertices(mesh: &Mesh, world: WorldTransform, depth: u8) -> Vec<GridPoint> {
    let end = f64::from(1u32 << (u32::from(depth) + SUBVOXEL_BITS));
    let snap = |position: &[f64; 3]| {
        // Vertices that no triangle uses may lie anywhere, even at NaN; the conversion to an integer is defined for all.
        world
            .to_cells(*position)
            .map(|coordinate| (coordinate * f64::from(SUBVOXELS) + 0.5).floor().clamp(0.0, end) as i32)
    };
    mesh.positions.par_iter().map(snap).collect()
}
