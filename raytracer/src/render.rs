//! From a scene to a picture, tile by tile on all threads.

use crate::bundle::Workspace;
use crate::camera::{Camera, CameraError, View};
use crate::color::{Display, Light3, to_linear};
use crate::frame::{FirstHit, Frame};
use crate::lanes::{Lanes, MAX_LANES};
use crate::octree::{MANTISSA_BITS, Octree};
use crate::primary::{Primary, Seen};
use crate::quality::Quality;
use crate::shading::Lighting;
use crate::tile::{TILE_PIXELS, TILE_SIZE, Tile, tiles};
use crate::traversal::Hits;
use crate::visibility::Counts;
use crate::width::{Width, with_lanes};
use glam::Vec3;
use rayon::prelude::*;

/// How to render.
#[derive(Debug, Clone, PartialEq)]
pub struct RenderOptions {
    /// Columns and rows of the picture.
    pub size: [u32; 2],
    /// What may be approximated.
    pub quality: Quality,
    /// Rays that go together; the picture does not depend on it.
    pub width: Width,
    /// The light; by default three lamps about the camera.
    pub lighting: Option<Lighting>,
    /// Whether to keep what the first sample of each pixel met.
    pub first_hits: bool,
}

impl Default for RenderOptions {
    fn default() -> Self {
        Self {
            size: [1312, 640],
            quality: Quality::default(),
            width: Width::Sixteen,
            lighting: None,
            first_hits: false,
        }
    }
}

/// What all tiles of a picture share.
struct Job<'a> {
    primary: Primary<'a>,
    lighting: Lighting,
    quality: Quality,
    first_hits: bool,
    /// Amount of light that each palette index scatters.
    palette: Vec<Light3>,
    display: Display,
    picture_height: u32,
}

/// The pixels of a tile.
struct TilePixels {
    tile: Tile,
    pixels: Vec<[u8; 4]>,
    first_hits: Vec<FirstHit>,
    counts: Counts,
    hit_pixels: u64,
}

/// Renders a picture; `progress` is told of the pixels done. Also gives the number of rays.
///
/// # Errors
/// If the camera sees nothing.
pub fn render(
    octree: &Octree,
    camera: &Camera,
    options: &RenderOptions,
    progress: impl Fn(u64) + Sync,
) -> Result<(Frame, Counts), CameraError> {
    let [width, height] = options.size;
    let view = View::new(camera, octree, width, height)?;
    let linear = |color: &[u8; 3]| Vec3::from_array(color.map(to_linear));
    let job = Job {
        primary: Primary::new(octree, view, options.quality.lod_pixels, true),
        lighting: options.lighting.clone().unwrap_or_else(|| Lighting::studio(&view)),
        quality: options.quality,
        first_hits: options.first_hits,
        palette: std::iter::once(Vec3::ZERO).chain(octree.palette().colors().iter().map(linear)).collect(),
        display: Display::new(),
        picture_height: height,
    };
    let done: Vec<TilePixels> = tiles(width, height)
        .into_par_iter()
        .map(|tile| {
            let pixels = with_lanes!(options.width, L => job.render_tile::<L>(tile));
            progress(u64::from(tile.width) * u64::from(tile.height));
            pixels
        })
        .collect();

    let area = width as usize * height as usize;
    let pixels = vec![[0; 4]; area];
    let mut frame = Frame { width, height, pixels, light: None, hit_pixels: 0, first_hits: None };
    let mut first_hits = options.first_hits.then(|| vec![FirstHit::NONE; area]);
    let mut counts = Counts::default();
    for part in done {
        let Tile { x, y, width: columns, height: rows } = part.tile;
        counts = counts.plus(part.counts);
        frame.hit_pixels += part.hit_pixels;
        for row in 0..rows {
            let from = (row * TILE_SIZE) as usize;
            let to = (y + row) as usize * width as usize + x as usize;
            let columns = columns as usize;
            frame.pixels[to..to + columns].copy_from_slice(&part.pixels[from..from + columns]);
            if let Some(first_hits) = &mut first_hits {
                first_hits[to..to + columns].copy_from_slice(&part.first_hits[from..from + columns]);
            }
        }
    }
    frame.first_hits = first_hits;
    Ok((frame, counts))
}

impl Job<'_> {
    fn render_tile<L: Lanes>(&self, tile: Tile) -> TilePixels {
        let mut light = vec![Vec3::ZERO; TILE_PIXELS];
        let mut first_hits = if self.first_hits { vec![FirstHit::NONE; TILE_PIXELS] } else { Vec::new() };
        let mut counts = Counts::default();
        let mut is_hit = [false; TILE_PIXELS];
        let mut workspace = Workspace::new();
        let seeds = self.primary.seeds::<L>(&tile, &mut workspace);
        for sample in 0..self.quality.samples {
            let offset = Quality::sample_offset(sample);
            let see = |seen: &Seen<'_, L>| {
                counts.rays += u64::from(L::bitmask(seen.block.active).count_ones());
                counts.hits += u64::from(L::bitmask(seen.hits.hit).count_ones());
                self.shade(&tile, seen, |place, color, first_hit| {
                    light[place] += color;
                    is_hit[place] |= first_hit.distance.is_finite();
                    if sample == 0 && self.first_hits {
                        first_hits[place] = first_hit;
                    }
                });
            };
            let seeds = seeds.as_ref();
            match (self.quality.lod_pixels > 0.0, self.first_hits) {
                (false, false) => {
                    self.primary.trace::<L, false, false>(&tile, seeds, offset, &mut workspace, see);
                }
                (false, true) => {
                    self.primary.trace::<L, false, true>(&tile, seeds, offset, &mut workspace, see);
                }
                (true, false) => {
                    self.primary.trace::<L, true, false>(&tile, seeds, offset, &mut workspace, see);
                }
                (true, true) => {
                    self.primary.trace::<L, true, true>(&tile, seeds, offset, &mut workspace, see);
                }
            }
        }
        let hit_pixels = is_hit.iter().filter(|&&is_hit| is_hit).count() as u64;
        let share = 1.0 / self.quality.samples as f32;
        let pixels = light.iter().map(|&light| self.display.pixel(light * share)).collect();
        TilePixels { tile, pixels, first_hits, counts, hit_pixels }
    }

    /// Gives `see` the place in the tile of each pixel of a packet, the light that comes from there, and what the ray met.
    fn shade<L: Lanes>(&self, tile: &Tile, seen: &Seen<'_, L>, mut see: impl FnMut(usize, Light3, FirstHit)) {
        let Primary { scene, view, .. } = &self.primary;
        let active = L::bitmask(seen.block.active);
        let hit = L::bitmask(seen.hits.hit);
        let lanes = Unpacked::new(seen.hits, view.directions(seen.block), seen.block.y);
        for lane in (0..L::COUNT).filter(|lane| active >> lane & 1 == 1) {
            let [x, y] = seen.block.pixel(lane);
            let place = ((y - tile.y) * TILE_SIZE + x - tile.x) as usize;
            if hit >> lane & 1 == 0 {
                let nothing = FirstHit { steps: lanes.steps[lane], ..FirstHit::NONE };
                see(place, self.background(lanes.y[lane]), nothing);
                continue;
            }
            let distance = match &seen.placements {
                Some(placements) => placements[lane].distance(lanes.distance[lane]) as f32,
                None => lanes.distance[lane],
            };
            let direction = lanes.direction(lane);
            let length = direction.length();
            let position = view.eye().as_vec3() + direction * distance;
            let payload = scene.octree.payload_of(lanes.node[lane], lanes.part[lane]);
            let normal = payload.normal().decode();
            let color = self.palette[usize::from(payload.palette_index())];
            let light = self.lighting.shade(position, Vec3::from_array(normal), direction / -length, color);
            let met = FirstHit {
                distance: distance * length,
                normal,
                steps: lanes.steps[lane],
                level: MANTISSA_BITS.saturating_sub(lanes.exponent[lane]) as u8,
            };
            see(place, light, met);
        }
    }

    fn background(&self, y: f32) -> Light3 {
        let background = self.lighting.background;
        background.top.lerp(background.bottom, (y / self.picture_height as f32).clamp(0.0, 1.0))
    }
}

/// The lanes of a traced block, in arrays.
struct Unpacked {
    distance: [f32; MAX_LANES],
    node: [u32; MAX_LANES],
    part: [u32; MAX_LANES],
    steps: [u32; MAX_LANES],
    exponent: [u32; MAX_LANES],
    direction: [[f32; MAX_LANES]; 3],
    y: [f32; MAX_LANES],
}

impl Unpacked {
    fn new<L: Lanes>(hits: &Hits<L>, direction: [L::Float; 3], y: L::Float) -> Self {
        Self {
            distance: L::floats(hits.distance),
            node: L::words(hits.node),
            part: L::words(hits.part),
            steps: L::words(hits.steps),
            exponent: L::words(hits.exponent),
            direction: direction.map(L::floats),
            y: L::floats(y),
        }
    }

    fn direction(&self, lane: usize) -> Vec3 {
        Vec3::new(self.direction[0][lane], self.direction[1][lane], self.direction[2][lane])
    }
}
