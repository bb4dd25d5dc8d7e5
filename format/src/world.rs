//! Where in the world the cube of voxels lies.

use serde::Serialize;

/// Leads from voxels back to the world: a point at cell coordinates `c` lies at `origin + voxel_size · c`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct WorldTransform {
    /// World position of the cube's minimum corner.
    pub origin: [f64; 3],
    /// Length of the edge of a cell of the finest level, in world units.
    pub voxel_size: f64,
}

impl WorldTransform {
    /// Whether all numbers are finite and the voxels have a size.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        let is_finite = self.origin.iter().all(|coordinate| coordinate.is_finite());
        is_finite && self.voxel_size.is_finite() && self.voxel_size > 0.0
    }

    /// Cell coordinates of a world position: 0 to the resolution along each axis.
    #[must_use]
    pub fn to_cells(&self, position: [f64; 3]) -> [f64; 3] {
        // Dividing (and not multiplying by a reciprocal) maps the far end of the longest axis exactly.
        [0, 1, 2].map(|axis| (position[axis] - self.origin[axis]) / self.voxel_size)
    }
}
