//! The inside of a mesh with holes: where the surface winds around a cell by one half or more.
//!
//! Cells are not asked one by one. Along a way from cell to cell that crosses no surface, the winding number changes only
//! as the solid angle of the boundary does, whose gradient is that of a magnetic field (Biot and Savart): an edge of
//! length l at distance d contributes at most l/(4π d²). So one cell decides for a whole connected region of a cube, unless
//! its winding number is nearer to one half than the boundary can change it within the cube; then the cube is cut in eight.
//! Only at the holes this goes down to single cells.

use super::empty_regions::EmptyRegions;
use super::open_edges::BoundaryEdge;
use super::rows::Rows;
use super::winding_number::WindingNumber;
use crate::block::BlockGrid;
use crate::morton;
use crate::vector::{difference, dot};
use rayon::prelude::*;
use std::f64::consts::PI;

/// The winding number that separates inside and outside.
const THRESHOLD: f64 = 0.5;
/// Below this an inside cell is in doubt.
const CERTAIN: f64 = 0.75;
/// The largest error of [`WindingNumber::at`].
const ERROR: f64 = 0.02;

/// Decides where the inside is.
pub(crate) struct OpenMesh {
    winding: WindingNumber,
    boundary: Vec<BoundaryEdge>,
}

/// Cells found inside.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Found {
    pub cells: u64,
    /// Those of them that are in doubt.
    pub doubtful: u64,
}

impl Found {
    pub(crate) fn and(self, other: Self) -> Self {
        Self { cells: self.cells + other.cells, doubtful: self.doubtful + other.doubtful }
    }
}

enum Decision {
    Inside { certain: bool },
    Outside,
    Unknown,
}

impl OpenMesh {
    /// Triangles and the boundary of their surface, in cells.
    pub(crate) fn new(triangles: Vec<[[f64; 3]; 3]>, boundary: Vec<BoundaryEdge>) -> Self {
        Self { winding: WindingNumber::new(triangles), boundary }
    }

    /// Adds to `inside` what is inside among the cells `asked` of a cube whose lowest cell is `origin`.
    pub(crate) fn decide(&self, asked: &Rows, origin: [u32; 3], inside: &mut Rows) -> Found {
        self.decide_part(asked, origin, [0; 3], inside)
    }

    /// `part` is where the cube `asked` lies in that of `inside`, which begins at `origin`.
    fn decide_part(&self, asked: &Rows, origin: [u32; 3], part: [u32; 3], inside: &mut Rows) -> Found {
        let mut found = Found::default();
        let regions = EmptyRegions::new(&asked.complement());
        for (region, cell) in regions.first_cells().into_iter().enumerate() {
            let cells = regions.cells_of(|other| other as usize == region);
            let at = [0, 1, 2].map(|axis| origin[axis] + part[axis] + cell[axis]);
            let reach = f64::from(asked.size as u32 - 1) * 3.0f64.sqrt();
            match self.decide_around(at, reach) {
                Decision::Outside => {}
                Decision::Inside { certain } => {
                    inside.add(&cells, part);
                    let cells = cells.count();
                    found = found.and(Found { cells, doubtful: if certain { 0 } else { cells } });
                }
                Decision::Unknown => {
                    for octant in 0..8 {
                        let (octant_cells, offset) = cells.octant(octant);
                        if !octant_cells.is_empty() {
                            let part = [0, 1, 2].map(|axis| part[axis] + offset[axis]);
                            found = found.and(self.decide_part(&octant_cells, origin, part, inside));
                        }
                    }
                }
            }
        }
        found
    }

    /// Decides for a cell, and for all that a way without surface connects with it within `reach` cells.
    fn decide_around(&self, cell: [u32; 3], reach: f64) -> Decision {
        let center = cell.map(|coordinate| f64::from(coordinate) + 0.5);
        let winding = self.winding.at(center).abs();
        let margin = (winding - THRESHOLD).abs() - ERROR;
        if reach > 0.0 && !(margin > 0.0 && self.changes_less(center, reach, margin)) {
            return Decision::Unknown;
        }
        if winding < THRESHOLD { Decision::Outside } else { Decision::Inside { certain: winding >= CERTAIN } }
    }

    /// Whether the winding number changes by less than `limit` from a point to any other within `reach`.
    fn changes_less(&self, point: [f64; 3], reach: f64, limit: f64) -> bool {
        let mut change = 0.0;
        self.boundary.iter().all(|edge| {
            let distance = edge.distance(point) - reach;
            change += edge.times * edge.length() * reach / (4.0 * PI * distance * distance);
            distance > 0.0 && change < limit
        })
    }

    /// Decides for the blocks without voxels; `filled` are the others, ascending. Blocks that are wholly inside, and parts
    /// of others.
    pub(crate) fn decide_empty_blocks(
        &self,
        filled: &[u32],
        grid: BlockGrid,
    ) -> (Vec<u32>, Vec<(u32, Rows)>, Found) {
        let mut cubes = vec![Cube { code: 0, level: 0 }];
        let (mut whole, mut parts, mut found) = (Vec::new(), Vec::new(), Found::default());
        while !cubes.is_empty() {
            let decided: Vec<Outcome> =
                cubes.into_par_iter().map(|cube| self.decide_cube(cube, filled, grid)).collect();
            cubes = Vec::new();
            for outcome in decided {
                match outcome {
                    Outcome::Whole(blocks, more) => {
                        whole.extend(blocks);
                        found = found.and(more);
                    }
                    Outcome::Part(code, cells, more) => {
                        parts.push((code, cells));
                        found = found.and(more);
                    }
                    Outcome::Cut(eight) => cubes.extend(eight),
                    Outcome::Nothing => {}
                }
            }
        }
        whole.sort_unstable();
        parts.sort_unstable_by_key(|(code, _)| *code);
        (whole, parts, found)
    }

    fn decide_cube(&self, cube: Cube, filled: &[u32], grid: BlockGrid) -> Outcome {
        let below = 3 * (grid.top_depth() - cube.level);
        let blocks = cube.code << below..(cube.code + 1) << below;
        let in_cube = &filled[filled.partition_point(|code| *code < blocks.start)..];
        if in_cube.first().is_none_or(|code| !blocks.contains(code)) {
            let size = 1u32 << (grid.depth - cube.level);
            let origin = morton::decode(cube.code).map(|coordinate| coordinate * size);
            match self
                .decide_around(origin.map(|first| first + size / 2), f64::from(size) / 2.0 * 3.0f64.sqrt())
            {
                Decision::Outside => return Outcome::Nothing,
                Decision::Inside { certain } => {
                    let cells = u64::from(size).pow(3);
                    let found = Found { cells, doubtful: if certain { 0 } else { cells } };
                    return Outcome::Whole(blocks, found);
                }
                Decision::Unknown if cube.level == grid.top_depth() => {
                    let mut inside = Rows::empty(size as usize);
                    let found = self.decide(&inside.complement(), origin, &mut inside);
                    return match found.cells {
                        0 => Outcome::Nothing,
                        cells if cells == u64::from(size).pow(3) => Outcome::Whole(blocks, found),
                        _ => Outcome::Part(cube.code, inside, found),
                    };
                }
                Decision::Unknown => {}
            }
        } else if cube.level == grid.top_depth() {
            return Outcome::Nothing;
        }
        Outcome::Cut(
            [0, 1, 2, 3, 4, 5, 6, 7]
                .map(|octant| Cube { code: cube.code << 3 | octant, level: cube.level + 1 }),
        )
    }
}

/// A cube of blocks.
#[derive(Debug, Clone, Copy)]
struct Cube {
    code: u32,
    level: u32,
}

enum Outcome {
    Nothing,
    /// Blocks from one Morton code to another.
    Whole(std::ops::Range<u32>, Found),
    Part(u32, Rows, Found),
    Cut([Cube; 8]),
}

impl BoundaryEdge {
    fn length(&self) -> f64 {
        length(difference(self.to, self.from))
    }

    fn distance(&self, point: [f64; 3]) -> f64 {
        let (along, offset) = (difference(self.to, self.from), difference(point, self.from));
        let share = (dot(offset, along) / dot(along, along)).clamp(0.0, 1.0);
        length([0, 1, 2].map(|axis| offset[axis] - share * along[axis]))
    }
}

fn length(vector: [f64; 3]) -> f64 {
    dot(vector, vector).sqrt()
}
