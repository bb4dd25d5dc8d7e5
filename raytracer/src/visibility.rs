//! Primary visibility: distance and voxel for each ray of a picture, without shading.

use crate::arithmetic::Arithmetic;
use crate::bundle::Workspace;
use crate::camera::{Camera, CameraError, View};
use crate::lanes::Lanes;
use crate::octree::Octree;
use crate::primary::{Primary, Seeds};
use crate::tile::{TILE_PIXELS, Tile, tiles};
use crate::width::{Width, with_lanes};
use rayon::prelude::*;

/// What each ray of a picture met: each primary ray, in the order in which packets trace them, tile by tile; or each
/// secondary ray, see [`crate::SecondaryRays::trace`].
#[derive(Debug, Clone, Default)]
pub struct Visibility {
    /// Distance along the direction of the middle of the picture, of a secondary ray along itself; infinite where nothing
    /// was met. Rounded to single precision, whatever the arithmetic.
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
    /// Cells that the rays visited, or nodes where they went on from filled cell to filled cell; 0 if they were not counted.
    pub steps: u64,
    /// Lanes of packets of which some ray visited a cell, each time; 0 if they were not counted. `steps` is how many of
    /// them had something to do.
    pub lane_steps: u64,
}

/// How to trace.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VisibilityOptions {
    /// How precisely rays are followed.
    pub arithmetic: Arithmetic,
    /// Rays that go together; with [`Arithmetic::Double`] always eight.
    pub width: Width,
    /// A ray ends at a cell that looks no larger than this many pixels; 0 for the finest cells.
    pub lod_pixels: f64,
    /// Whether beams find out where rays begin.
    pub beams: bool,
    /// Whether to count the cells and nodes visited, which takes time.
    pub count_steps: bool,
}

impl Default for VisibilityOptions {
    /// To the finest cells, with beams, as fast as it goes.
    fn default() -> Self {
        Self {
            arithmetic: Arithmetic::Single,
            width: Width::FASTEST,
            lod_pixels: 0.0,
            beams: true,
            count_steps: false,
        }
    }
}

/// Room for the results of one tile.
pub(crate) struct Room<'a> {
    pub distance: &'a mut [f32],
    pub node: &'a mut [u32],
    pub part: &'a mut [u32],
}

impl<'a> Room<'a> {
    /// Cuts off the first places.
    fn split_off_first(&mut self, count: usize) -> Self {
        fn first<'a, T>(list: &mut &'a mut [T], count: usize) -> &'a mut [T] {
            list.split_off_mut(..count).unwrap_or_default()
        }
        Room {
            distance: first(&mut self.distance, count),
            node: first(&mut self.node, count),
            part: first(&mut self.part, count),
        }
    }
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
        let view = View::of_octree(camera, octree, [width, height])?;
        let tiles = tiles(width, height);
        // A whole tile has room also where the picture ends within it.
        let rooms = self.rooms(tiles.iter().map(|_| TILE_PIXELS));
        let primary = Primary::new(octree, view, options.lod_pixels, options.beams);
        let exact = primary.target.lod.is_exact();
        Ok(with_lanes!(options.arithmetic, options.width, L => match (exact, options.count_steps) {
            (true, false) => trace_tiles::<L, false, false>(&primary, tiles, rooms),
            (true, true) => trace_tiles::<L, false, true>(&primary, tiles, rooms),
            (false, false) => trace_tiles::<L, true, false>(&primary, tiles, rooms),
            (false, true) => trace_tiles::<L, true, true>(&primary, tiles, rooms),
        }))
    }

    /// Distance, node and part of each pixel of a picture that was traced with some width, as bits, row by row.
    #[must_use]
    pub fn by_pixel(&self, arithmetic: Arithmetic, width: Width, size: [u32; 2]) -> Vec<[u32; 3]> {
        with_lanes!(arithmetic, width, L => self.by_pixel_of_lanes::<L>(size))
    }

    fn by_pixel_of_lanes<L: Lanes>(&self, [width, height]: [u32; 2]) -> Vec<[u32; 3]> {
        let mut pixels = vec![[0; 3]; width as usize * height as usize];
        for (number, tile) in tiles(width, height).iter().enumerate() {
            let mut at = number * TILE_PIXELS;
            tile.for_each_square(|corner| {
                tile.for_each_block::<L>(corner, [0.5; 2], |block| {
                    let active = L::bitmask(block.active);
                    for lane in (0..L::COUNT).filter(|lane| active >> lane & 1 == 1) {
                        let [x, y] = block.pixel(lane);
                        let place = at + lane;
                        let found = [self.distance[place].to_bits(), self.node[place], self.part[place]];
                        pixels[(y * width + x) as usize] = found;
                    }
                    at += L::COUNT;
                });
            });
        }
        pixels
    }

    /// Makes room for the results of tiles of some sizes.
    pub(crate) fn rooms(&mut self, sizes: impl Iterator<Item = usize> + Clone) -> Vec<Room<'_>> {
        let room = sizes.clone().sum();
        self.distance.resize(room, 0.0);
        self.node.resize(room, 0);
        self.part.resize(room, 0);
        let mut rest = Room { distance: &mut self.distance, node: &mut self.node, part: &mut self.part };
        sizes.map(|size| rest.split_off_first(size)).collect()
    }
}

impl Counts {
    /// Adds the steps of a packet's rays, and its own.
    pub(crate) fn add_steps<L: Lanes>(&mut self, steps: L::Word, packet_steps: u32) {
        self.steps += L::words(steps).iter().map(|&steps| u64::from(steps)).sum::<u64>();
        self.lane_steps += u64::from(packet_steps) * L::COUNT as u64;
    }

    pub(crate) fn plus(self, other: Self) -> Self {
        Self {
            rays: self.rays + other.rays,
            hits: self.hits + other.hits,
            steps: self.steps + other.steps,
            lane_steps: self.lane_steps + other.lane_steps,
        }
    }
}

/// Traces all tiles, on all threads of the current pool.
fn trace_tiles<L: Lanes, const LOD: bool, const COUNT: bool>(
    primary: &Primary<'_>,
    tiles: Vec<Tile>,
    rooms: Vec<Room<'_>>,
) -> Counts {
    let trace_tile = |workspace: &mut Workspace<L>, (tile, room): (Tile, Room<'_>)| {
        trace_tile::<L, LOD, COUNT>(primary, tile, room, workspace)
    };
    let tiles = tiles.into_par_iter().zip(rooms);
    tiles.map_init(Workspace::new, trace_tile).reduce(Counts::default, Counts::plus)
}

fn trace_tile<L: Lanes, const LOD: bool, const COUNT: bool>(
    primary: &Primary<'_>,
    tile: Tile,
    room: Room<'_>,
    workspace: &mut Workspace<L>,
) -> Counts {
    let Room { distance, node, part } = room;
    let mut counts = Counts::default();
    let mut at = 0;
    let seeds = primary.seeds::<L>(&tile, workspace);
    if seeds.as_ref().is_some_and(Seeds::is_empty) {
        see_nothing(distance, node, part);
        counts.rays += u64::from(tile.width) * u64::from(tile.height);
        return counts;
    }
    primary.trace::<L, LOD, COUNT>(&tile, seeds.as_ref(), [0.5, 0.5], workspace, |seen| {
        let hits = seen.hits;
        counts.rays += u64::from(L::bitmask(seen.block.active).count_ones());
        counts.hits += u64::from(L::bitmask(hits.hit).count_ones());
        L::store(hits.distance, &mut distance[at..at + L::COUNT]);
        L::store_words(hits.node, &mut node[at..at + L::COUNT]);
        L::store_words(hits.part, &mut part[at..at + L::COUNT]);
        if COUNT {
            counts.add_steps::<L>(hits.steps, hits.packet_steps);
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
