//! What a conversion tells about itself.

use crate::{Estimate, WorldTransform};
use serde::Serialize;

/// The outcome of a conversion.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// Triangles of the mesh.
    pub triangles: u64,
    /// Triangles without area among them.
    pub degenerate_triangles: u64,
    /// Cells per axis.
    pub resolution: u32,
    /// Version of the file's format.
    pub format: u16,
    /// Depth of the octree.
    pub depth: u8,
    /// Filled cells at the finest level, before pruning; with those inside if they are filled.
    pub leaf_voxels: u64,
    /// Nodes with children in the file.
    pub nodes: u64,
    /// Voxels in the file: filled and empty ones in version 4, filled ones in version 5.
    pub stored_voxels: u64,
    /// Voxels that the file would have without pruning: 1 + 8 · nodes. It is what tables of Bohnen 2009 print.
    pub thesis_voxels: u64,
    /// Different colours of the voxels; in version 5 each is counted once for every finish that it occurs with.
    pub colors_found: u64,
    /// Entries of the palette.
    pub palette_size: u64,
    /// Root of the mean square distance in Oklab between a leaf voxel's colour and its palette entry; 0 if all colours fit.
    pub palette_error: f64,
    /// Length of the file in bytes.
    pub file_bytes: u64,
    /// What was expected before the work began.
    pub estimate: Estimate,
    /// Bytes that had no room in memory and were in a temporary file.
    pub temporary_bytes: u64,
    /// The largest memory the process has used so far, in bytes; `None` where the system does not tell.
    pub peak_memory_bytes: Option<u64>,
    /// Time by stage.
    pub seconds: Seconds,
    /// What is odd about the mesh, or has been left out.
    pub warnings: Vec<String>,
    /// Leads from voxels back to the world.
    pub world: WorldTransform,
}

/// Seconds by stage.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Seconds {
    /// Reading the mesh; 0 unless the caller fills it in.
    pub read: f64,
    /// Counting and merging colours.
    pub palette: f64,
    /// Scan conversion.
    pub scan: f64,
    /// Levels of detail and pruning.
    pub build: f64,
    /// Encoding and writing.
    pub write: f64,
    /// All of it.
    pub total: f64,
}
