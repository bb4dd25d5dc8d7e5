//! Where a mesh is not closed.

use crate::surface::Surface;
use rayon::prelude::*;

/// The edges at which a surface ends.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct OpenEdges {
    /// Edges with an odd number of triangles: holes, and the rims of sheets.
    pub count: u64,
    /// The boundary of the surface as the winding number sees it: edges that triangles do not run along as often one way
    /// as the other. Both ends in cells, and how often they are missing.
    pub boundary: Vec<BoundaryEdge>,
}

/// An edge on the boundary.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct BoundaryEdge {
    pub from: [f64; 3],
    pub to: [f64; 3],
    pub times: f64,
}

impl OpenEdges {
    /// Edges are the same if their ends are at the same places on the sub-voxel grid.
    pub(crate) fn find(surface: &Surface<'_>) -> Self {
        let mut edges: Vec<([[i32; 3]; 2], i32)> = (0..surface.triangles.len())
            .into_par_iter()
            .flat_map_iter(|triangle| {
                let [a, b, c] = surface.corners(triangle);
                [[a, b], [b, c], [c, a]]
                    .into_iter()
                    .filter(|[from, to]| from != to)
                    .map(|[from, to]| if from < to { ([from, to], 1) } else { ([to, from], -1) })
            })
            .collect();
        edges.par_sort_unstable();
        let mut open = Self::default();
        for run in edges.chunk_by(|a, b| a.0 == b.0) {
            let [from, to] = run[0].0.map(super::in_cells);
            open.count += run.len() as u64 % 2;
            let times = run.iter().map(|(_, direction)| direction).sum::<i32>();
            if times != 0 {
                open.boundary.push(BoundaryEdge { from, to, times: f64::from(times.abs()) });
            }
        }
        open
    }
}
