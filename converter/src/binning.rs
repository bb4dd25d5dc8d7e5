//! Which triangles lie in which blocks.

use crate::block::BlockGrid;
use crate::fixed_point::GridPoint;
use crate::morton;
use crate::scan_conversion::{ACROSS, centers_within, extent};
use rayon::prelude::*;

/// What it takes for a triangle to concern a block.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Contact {
    /// Centre lines of columns may be cut in it.
    CenterLines,
    /// The triangle may touch it, be it at a face or a corner.
    Touch,
}

/// Pairs of a block and a triangle that may mark voxels in it, in ascending order.
pub(crate) struct Bins {
    /// Block's Morton code in the upper half, triangle in the lower.
    pairs: Vec<u64>,
    /// Where each block's pairs begin, and the end.
    starts: Vec<usize>,
}

impl Bins {
    pub(crate) fn new(
        vertices: &[GridPoint],
        triangles: &[[u32; 3]],
        grid: BlockGrid,
        contact: Contact,
    ) -> Self {
        let mut pairs: Vec<u64> = triangles
            .par_chunks(4096)
            .enumerate()
            .flat_map_iter(|(chunk, triangles)| {
                let mut pairs = Vec::new();
                for (index, triangle) in triangles.iter().enumerate() {
                    let corners = triangle.map(|vertex| vertices[vertex as usize]);
                    let number = (chunk * 4096 + index) as u64;
                    visit_blocks(&corners, grid, contact, |block| {
                        pairs.push(u64::from(morton::encode(block)) << 32 | number);
                    });
                }
                pairs
            })
            .collect();
        pairs.par_sort_unstable();
        let mut starts: Vec<usize> =
            (0..pairs.len()).filter(|&k| k == 0 || pairs[k] >> 32 != pairs[k - 1] >> 32).collect();
        starts.push(pairs.len());
        Self { pairs, starts }
    }

    /// Number of blocks that triangles lie in.
    pub(crate) fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// The `index`-th block's Morton code, and its triangles.
    pub(crate) fn block(&self, index: usize) -> (u32, impl Iterator<Item = usize> + Clone) {
        let pairs = &self.pairs[self.starts[index]..self.starts[index + 1]];
        ((pairs[0] >> 32) as u32, pairs.iter().map(|&pair| (pair & u64::from(u32::MAX)) as usize))
    }
}

/// Calls `visit` with the block coordinates of every block that the triangle may concern, each once.
fn visit_blocks(
    corners: &[GridPoint; 3],
    grid: BlockGrid,
    contact: Contact,
    mut visit: impl FnMut([u32; 3]),
) {
    let extents = [0, 1, 2].map(|axis| extent(corners, axis));
    if contact == Contact::CenterLines {
        let has_columns = extents.map(|[low, high]| {
            let [first, last] = centers_within(low, high);
            first <= last
        });
        if ACROSS.iter().all(|&[u, v]| !(has_columns[u] && has_columns[v])) {
            return;
        }
    }
    // A touched block may end where the triangle begins.
    let reach = i32::from(contact == Contact::Touch);
    let blocks = extents.map(|[low, high]| [grid.number_of((low - reach).max(0)), grid.number_of(high)]);
    let counts = blocks.map(|[first, last]| i64::from(last - first) + 1);
    if counts[0] * counts[1] * counts[2] <= 2 {
        for_each_in(blocks, &mut visit);
        return;
    }

    let normal = normal(corners);
    let along =
        (0..3).fold(0, |best, axis| if normal[axis].abs() > normal[best].abs() { axis } else { best });
    if normal[along] == 0.0 {
        // No area. It concerns what it touches; its box is a good enough guess.
        if contact == Contact::Touch {
            for_each_in(blocks, &mut visit);
        }
        return;
    }
    let [u, v] = ACROSS[along];
    let half = f64::from(1 << (grid.shift() - 1));
    let edges = projected_edges(corners, u, v, normal[along]);
    // Half the height of the plane over a column of blocks. Two sub-voxel steps outweigh all rounding.
    let reach_along = half * (normal[u].abs() + normal[v].abs()) / normal[along].abs() + 2.0;
    for block_u in blocks[u][0]..=blocks[u][1] {
        for block_v in blocks[v][0]..=blocks[v][1] {
            let center = [block_u, block_v].map(|number| f64::from(number) * 2.0 * half + half);
            if edges
                .iter()
                .any(|&[a, b, c]| a * center[0] + b * center[1] + c < -(a.abs() + b.abs()) * (half + 2.0))
            {
                continue;
            }
            let origin = corners[0].map(f64::from);
            let depth = origin[along]
                - (normal[u] * (center[0] - origin[u]) + normal[v] * (center[1] - origin[v])) / normal[along];
            let [low, high] = extents[along].map(f64::from);
            let (low, high) = ((depth - reach_along).max(low), (depth + reach_along).min(high));
            if low > high {
                continue;
            }
            let first = grid.number_of((low as i32 - reach).max(0)).max(blocks[along][0]);
            let last = grid.number_of(high as i32).min(blocks[along][1]);
            for block_w in first..=last {
                let mut block = [0; 3];
                (block[u], block[v], block[along]) = (block_u as u32, block_v as u32, block_w as u32);
                visit(block);
            }
        }
    }
}

fn for_each_in(blocks: [[i32; 2]; 3], visit: &mut impl FnMut([u32; 3])) {
    for x in blocks[0][0]..=blocks[0][1] {
        for y in blocks[1][0]..=blocks[1][1] {
            for z in blocks[2][0]..=blocks[2][1] {
                visit([x as u32, y as u32, z as u32]);
            }
        }
    }
}

/// The triangle's normal, of any length.
fn normal(corners: &[GridPoint; 3]) -> [f64; 3] {
    let [a, b, c] = corners.map(|corner| corner.map(i64::from));
    let [e, f] = [b, c].map(|corner| [0, 1, 2].map(|axis| corner[axis] - a[axis]));
    // Exact: 49 bits.
    [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]]
        .map(|component| component as f64)
}

/// Edge functions (a, b, c) of the projection onto (u, v), not negative inside.
fn projected_edges(corners: &[GridPoint; 3], u: usize, v: usize, normal_along: f64) -> [[f64; 3]; 3] {
    // (u, v) of the middle axis is a left-handed pair.
    let sign = normal_along.signum() * if v - u == 2 { -1.0 } else { 1.0 };
    [[0, 1], [1, 2], [2, 0]].map(|pair| {
        let [p, q] = pair.map(|corner| [f64::from(corners[corner][u]), f64::from(corners[corner][v])]);
        let (a, b) = (sign * (p[1] - q[1]), sign * (q[0] - p[0]));
        [a, b, -(a * p[0] + b * p[1])]
    })
}
