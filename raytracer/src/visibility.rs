//! Primary visibility: distance and voxel for each ray of a picture, without shading.

use crate::bundle::Workspace;
use crate::camera::{Camera, CameraError, View};
use crate::lanes::{Lanes, MAX_LANES};
use crate::octree::Octree;
use crate::primary::{Primary, Seeds};
use crate::tile::{TILE_PIXELS, Tile, tiles};
use crate::traversal::Scene;
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
        let primary = Primary {
            scene: Scene {
                octree,
                grid: octree.entrance(footprint * view.nearest()),
                footprint: footprint as f32,
            },
            view,
            beams: options.beams,
        };
        let trace_tile = |(tile, room): (Tile, Room<'_>)| {
            let lod = options.lod_pixels > 0.0;
            with_lanes!(options.width, L => match (lod, options.count_steps) {
                (false, false) => trace_tile::<L, false, false>(&primary, tile, room),
                (false, true) => trace_tile::<L, false, true>(&primary, tile, room),
                (true, false) => trace_tile::<L, true, false>(&primary, tile, room),
                (true, true) => trace_tile::<L, true, true>(&primary, tile, room),
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

fn trace_tile<L: Lanes, const LOD: bool, const COUNT: bool>(
    primary: &Primary<'_>,
    tile: Tile,
    room: Room<'_>,
) -> Counts {
    let Room { distance, node, part } = room;
    let mut counts = Counts::default();
    let mut at = 0;
    let mut workspace = Workspace::new();
    let seeds = primary.seeds::<L>(&tile, &mut workspace);
    if seeds.as_ref().is_some_and(Seeds::is_empty) {
        see_nothing(distance, node, part);
        counts.rays += u64::from(tile.width) * u64::from(tile.height);
        return counts;
    }
    primary.trace::<L, LOD, COUNT>(&tile, seeds.as_ref(), [0.5, 0.5], &mut workspace, |seen| {
        let hits = seen.hits;
        counts.rays += u64::from(L::bitmask(seen.block.active).count_ones());
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
    see_nothing(&mut distance[at..], &mut node[at..], &mut part[at..]);
    counts
}

fn see_nothing(distance: &mut [f32], node: &mut [u32], part: &mut [u32]) {
    distance.fill(f32::INFINITY);
    node.fill(0);
    part.fill(0);
}
