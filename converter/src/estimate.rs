//! How many voxels there will be, before there are any.

use crate::mesh::Mesh;
use crate::options::{FileFormat, Options};
use octvox_cli::grouped;
use octvox_format::WorldTransform;
use rayon::prelude::*;
use serde::Serialize;
use std::fmt;

/// What a conversion will probably make, and take. Parts of the surface that lie in one voxel are counted several times.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Estimate {
    /// Filled cells of the surface at the finest level; what is inside is not counted.
    pub leaf_voxels: u64,
    /// Length of the file, in bytes.
    pub file_bytes: u64,
    /// What voxels take that wait for the next stage, in memory or, beyond the memory bound, in a temporary file, in
    /// bytes.
    pub waiting_bytes: u64,
}

/// Measured on scanned and modelled surfaces: leaves have 0.47 nodes above them each. Version 4 stores 4 bytes for each of
/// the eight children of a node.
const BYTES_PER_LEAF_4: u64 = 15;
/// Version 5, uncompressed: normals and masks, and indices where there are several colours.
const BYTES_PER_LEAF_5: u64 = 5;
/// A leaf with colour and normal as scanned, or as part of a tree, in memory.
const WAITING_BYTES_PER_LEAF: u64 = 8;

impl fmt::Display for Estimate {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { leaf_voxels, file_bytes, waiting_bytes } = *self;
        let [file, waiting] = [file_bytes, waiting_bytes].map(|bytes| grouped(bytes.div_ceil(1 << 20)));
        let leaf_voxels = grouped(leaf_voxels);
        write!(formatter, "about {leaf_voxels} leaf voxels, {file} MiB of file, {waiting} MiB meanwhile")
    }
}

impl Estimate {
    pub(crate) fn new(mesh: &Mesh, world: WorldTransform, options: &Options) -> Self {
        let voxels = |triangle: usize| {
            let corners = mesh.corners(triangle).map(|position| world.to_cells(position));
            if options.conservative { touched(corners) } else { thin(corners) }
        };
        // Sums of fixed runs, added up in order: the same for every number of threads.
        let count = mesh.triangles().len();
        let runs: Vec<f64> = (0..count.div_ceil(4096))
            .into_par_iter()
            .map(|run| (run * 4096..count.min((run + 1) * 4096)).map(voxels).sum())
            .collect();
        let cells = f64::from(options.resolution()).powi(3);
        // Every part has a voxel at least.
        let leaf_voxels = runs.iter().sum::<f64>().min(cells).max(1.0) as u64;
        let per_leaf = match options.format {
            FileFormat::Version4 => BYTES_PER_LEAF_4,
            FileFormat::Version5 { .. } => BYTES_PER_LEAF_5,
        };
        Self {
            leaf_voxels,
            file_bytes: leaf_voxels.saturating_mul(per_leaf),
            waiting_bytes: leaf_voxels.saturating_mul(WAITING_BYTES_PER_LEAF),
        }
    }
}

/// A plane with the unit normal n fills the voxels whose centres are no farther from it than max |nᵢ| / 2, which is the
/// largest of the three projections of each unit of its area. Corners are in cells.
fn thin(corners: [[f64; 3]; 3]) -> f64 {
    projections(corners).into_iter().fold(0.0, f64::max)
}

/// The mean number of cells of a lattice that a convex body meets: the volume of its Minkowski sum with a cell, which is
/// the sum of its projections onto faces, edges and corners of the cell.
fn touched(corners: [[f64; 3]; 3]) -> f64 {
    let extents: f64 = (0..3)
        .map(|axis| {
            let [a, b, c] = corners.map(|corner| corner[axis]);
            a.max(b).max(c) - a.min(b).min(c)
        })
        .sum();
    projections(corners).into_iter().sum::<f64>() + extents + 1.0
}

/// Areas of the projections along the three axes.
fn projections([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    [[1, 2], [2, 0], [0, 1]].map(|[u, v]| {
        let cross = (b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u]);
        cross.abs() / 2.0
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use octvox_cli::Progress;

    #[test]
    fn large_triangles_are_estimated_well() {
        let positions = vec![[0.1, 0.2, 0.3], [9.0, 1.0, 2.0], [3.0, 8.0, 5.0], [2.0, 4.0, 9.5]];
        let mesh = Mesh::new(positions, vec![[0, 1, 2], [0, 3, 1], [1, 3, 2], [0, 2, 3]]).unwrap();
        for conservative in [false, true] {
            let options = Options { depth: 9, conservative, ..Options::default() };
            let report = crate::convert(&mesh, &options, &Progress::hidden(), &mut Vec::new()).unwrap();
            let ratio = report.estimate.leaf_voxels as f64 / report.leaf_voxels as f64;
            assert!((0.98..1.02).contains(&ratio), "{ratio}");
        }
    }

    #[test]
    fn no_number_is_too_large() {
        let mesh = Mesh::new(vec![[-1e150; 3], [1e150; 3], [1e150, -1e150, 0.0]], vec![[0, 1, 2]]).unwrap();
        let world = WorldTransform { origin: [0.0; 3], voxel_size: 1.0 };
        let estimate = Estimate::new(&mesh, world, &Options { depth: 14, ..Options::default() });
        assert_eq!(estimate.leaf_voxels, 1 << 42);
    }
}
