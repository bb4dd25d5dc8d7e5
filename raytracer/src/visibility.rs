//! Primary visibility: distance and voxel for each ray of a picture, without shading.

use crate::camera::{Camera, CameraError, View};
use crate::grid::Grid;
use crate::lanes::{Lanes, MAX_LANES};
use crate::octree::Octree;
use crate::tile::{AT_THE_EYE, TILE_PIXELS, Tile, tiles};
use crate::traversal::{Hits, Path, trace};
use crate::width::{Width, with_lanes};
use rayon::prelude::*;

/// What each ray of a picture met. Pixels are in the order in which packets trace them, tile by tile.
#[derive(Debug, Clone, Default)]
pub struct Visibility {
    /// Distance along the direction of the middle of the picture; infinite where nothing was met.
    pub distance: Vec<f32>,
    /// The node that was met.
    pub node: Vec<u32>,
    /// The part of the node that was met: with the node, it names a voxel.
    pub part: Vec<u32>,
}

/// What happened on the way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    /// Rays sent.
    pub rays: u64,
    /// Rays that met a voxel.
    pub hits: u64,
    /// Cells that the rays visited; 0 if they were not counted.
    pub steps: u64,
}

/// How to trace.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VisibilityOptions {
    /// Rays that go together.
    pub width: Width,
    /// A ray ends at a cell that looks no larger than this many pixels; 0 for the finest cells.
    pub lod_pixels: f64,
    /// Whether beams find out where rays begin.
    pub beams: bool,
    /// Whether to count the cells visited, which takes time.
    pub count_steps: bool,
}

/// Room of one tile in the result: a whole tile, also where the picture ends within it.
struct Room<'a> {
    distance: &'a mut [f32],
    node: &'a mut [u32],
    part: &'a mut [u32],
}

impl Visibility {
    /// Finds what each pixel's middle shows, on all threads of the current pool. Memory of earlier pictures is reused.
    ///
    /// # Errors
    /// If the camera sees nothing.
    pub fn trace(
        &mut self,
        octree: &Octree,
        camera: &Camera,
        [width, height]: [u32; 2],
        options: &VisibilityOptions,
    ) -> Result<Counts, CameraError> {
        let view = View::new(camera, octree, width, height)?;
        let tiles = tiles(width, height);
        let room = tiles.len() * TILE_PIXELS;
        self.distance.resize(room, 0.0);
        self.node.resize(room, 0);
        self.part.resize(room, 0);
        let distances = self.distance.par_chunks_mut(TILE_PIXELS);
        let nodes = self.node.par_chunks_mut(TILE_PIXELS);
        let parts = self.part.par_chunks_mut(TILE_PIXELS);
        let rooms = (distances, nodes, parts).into_par_iter().map(|(distance, node, part)| Room {
            distance,
            node,
            part,
        });
        let footprint = options.lod_pixels * view.pixel_size();
        let job = Job {
            octree,
            grid: octree.entrance(footprint * view.nearest()),
            view,
            footprint: footprint as f32,
            beams: options.beams.then_some(options.lod_pixels),
        };
        let trace_tile = |(tile, room): (Tile, Room<'_>)| {
            let lod = options.lod_pixels > 0.0;
            with_lanes!(options.width, L => match (lod, options.count_steps) {
                (false, false) => job.trace_tile::<L, false, false>(tile, room),
                (false, true) => job.trace_tile::<L, false, true>(tile, room),
                (true, false) => job.trace_tile::<L, true, false>(tile, room),
                (true, true) => job.trace_tile::<L, true, true>(tile, room),
            })
        };
        Ok(tiles.into_par_iter().zip(rooms).map(trace_tile).reduce(Counts::default, Counts::plus))
    }
}

impl Counts {
    pub(crate) fn plus(self, other: Self) -> Self {
        Self { rays: self.rays + other.rays, hits: self.hits + other.hits, steps: self.steps + other.steps }
    }
}

/// What all tiles of a picture share.
struct Job<'a> {
    octree: &'a Octree,
    grid: &'a Grid,
    view: View,
    footprint: f32,
    /// If beams are sent, the cells in pixels at which rays may stop.
    beams: Option<f64>,
}

impl Job<'_> {
    fn trace_tile<L: Lanes, const LOD: bool, const COUNT: bool>(&self, tile: Tile, room: Room<'_>) -> Counts {
        let Room { distance, node, part } = room;
        let mut counts = Counts::default();
        let mut at = 0;
        let mut path = Path::new();
        let starts = self.beams.map_or(AT_THE_EYE, |lod| tile.starts::<L>(self.octree, &self.view, lod));
        tile.for_each_block::<L>([0.5, 0.5], &starts, |block, _, _| {
            counts.rays += u64::from(L::bitmask(block.active).count_ones());
            if block.start == f32::INFINITY {
                distance[at..at + L::COUNT].fill(f32::INFINITY);
                node[at..at + L::COUNT].fill(0);
                part[at..at + L::COUNT].fill(0);
                at += L::COUNT;
                return;
            }
            let (packet, _) = self.view.packet(&block);
            let hits: Hits<L> =
                trace::<L, LOD, COUNT>(self.octree, self.grid, &packet, self.footprint, &mut path);
            counts.hits += u64::from(L::bitmask(hits.hit).count_ones());
            L::store(hits.distance, &mut distance[at..at + L::COUNT]);
            L::store_words(hits.node, &mut node[at..at + L::COUNT]);
            L::store_words(hits.part, &mut part[at..at + L::COUNT]);
            if COUNT {
                let mut steps = [0; MAX_LANES];
                L::store_words(hits.steps, &mut steps);
                counts.steps += steps.iter().map(|&steps| u64::from(steps)).sum::<u64>();
            }
            at += L::COUNT;
        });
        counts
    }
}
