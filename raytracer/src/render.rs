//! From a scene to a picture, tile by tile on all threads, round after round until no pixel needs more rays.

use crate::bits::ones;
use crate::bundle::Workspace;
use crate::camera::{Camera, CameraError};
use crate::eye::Eye;
use crate::film::{Film, Keeping, PixelSum, Region, TilePart};
use crate::frame::{FirstHit, Frame};
use crate::lanes::Lanes;
use crate::lens::Lens;
use crate::octree::{MANTISSA_BITS, Octree};
use crate::plan::{Plan, effect, with_effects};
use crate::primary::{Primary, Seeds, Seen};
use crate::quality::Quality;
use crate::sampling::{hashed, sample_2d};
use crate::scene::Scene;
use crate::surface::Point;
use crate::tile::{TILE_PIXELS, TILE_SIZE, Tile};
use crate::tone::Tone;
use crate::transport::{Arrival, Queues, RayCounts, Transport};
use crate::traversal::Target;
use crate::width::{Width, with_lanes};
use crate::world::{GROUND, Leaving, SceneHit, SceneRay, Walks, World};
use glam::Vec3;
use rayon::prelude::*;
use std::any::Any;
use std::time::{Duration, Instant};

/// How to render.
#[derive(Debug, Clone, PartialEq)]
pub struct RenderOptions {
    /// Columns and rows of the picture.
    pub size: [u32; 2],
    /// The part of the picture that is rendered; without one, all of it. What is outside stays transparent.
    pub region: Option<Region>,
    /// What may be approximated.
    pub quality: Quality,
    /// How light is displayed.
    pub tone: Tone,
    /// Rays that go together; the picture does not depend on it.
    pub width: Width,
    /// Whether to keep what the ray through the middle of each pixel met. Where no sample of the picture is that ray, it is sent
    /// besides.
    pub first_hits: bool,
    /// Whether to keep the light of each pixel, as it is before it is displayed.
    pub light: bool,
    /// After this time no more rays are sent, as soon as every pixel has had its first; the picture depends on the machine
    /// then.
    pub time_limit: Option<Duration>,
}

impl Default for RenderOptions {
    fn default() -> Self {
        Self {
            size: [1312, 640],
            region: None,
            quality: Quality::default(),
            tone: Tone::default(),
            width: Width::FASTEST,
            first_hits: false,
            light: true,
            time_limit: None,
        }
    }
}

/// A tile is done.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TileDone {
    /// Pixels of the region that have had their first rays; 0 if they had them before.
    pub pixels: u64,
    /// Rays of all kinds that were sent.
    pub rays: u64,
}

/// What was done for a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RenderReport {
    /// The effects that were simulated.
    pub plan: Plan,
    /// Rays sent.
    pub rays: RayCounts,
}

/// Renders a model alone, under the light of a studio; `progress` is told of every tile that is done.
///
/// # Errors
/// If the camera sees nothing.
pub fn render(
    octree: &Octree,
    camera: &Camera,
    options: &RenderOptions,
    progress: impl Fn(TileDone) + Sync,
) -> Result<(Frame, RenderReport), CameraError> {
    render_scene(&Scene::of_model(octree, camera), camera, &Lens::default(), options, progress)
}

/// Renders a scene; `progress` is told of every tile that is done.
///
/// # Errors
/// If the camera sees nothing.
pub fn render_scene(
    scene: &Scene<'_>,
    camera: &Camera,
    lens: &Lens,
    options: &RenderOptions,
    progress: impl Fn(TileDone) + Sync,
) -> Result<(Frame, RenderReport), CameraError> {
    render_telling(scene, camera, lens, options, &progress)
}

/// As [`render_scene`], compiled once, not for every kind of `progress`.
fn render_telling(
    scene: &Scene<'_>,
    camera: &Camera,
    lens: &Lens,
    options: &RenderOptions,
    progress: &(dyn Fn(TileDone) + Sync),
) -> Result<(Frame, RenderReport), CameraError> {
    let start = Instant::now();
    let eye = Eye::new(camera, lens, options.size)?;
    let quality = options.quality;
    let targets = scene.instances.iter().map(|instance| {
        let octree = scene.models[instance.model].octree;
        Target::new(octree, &eye.view_of(octree, &instance.placement), quality.lod_pixels)
    });
    let world = World::new(scene, targets);
    let primary = match &world.placed[..] {
        [only] if lens.is_pinhole() => {
            let view = eye.view_of(only.target.octree, &only.placement);
            let margin = quality.filter.radius() - 0.5;
            Some(Primary { margin, ..Primary::new(only.target.octree, view, quality.lod_pixels, true) })
        }
        _ => None,
    };
    let plan = Plan::new(scene, lens, &quality);
    let samples = quality.most_samples.max(quality.samples);
    let mut offsets: Vec<_> = (0..samples).map(|index| quality.sample_place(index)).collect();
    offsets.push(MIDDLE);
    let job = Job {
        world: &world,
        eye,
        primary,
        plan,
        quality,
        tone: options.tone,
        first_hits: options.first_hits,
        first_hit_sample: if offsets[0] == MIDDLE && !plan.depth_of_field { 0 } else { samples },
        offsets,
        picture_height: options.size[1],
        misses_are_plain: scene.background.is_gradient() && scene.ground.is_none() && !options.first_hits,
    };

    let region = options.region.unwrap_or(Region { corner: [0; 2], size: options.size });
    let keeping = Keeping { sums: job.adapts(), light: options.light, first_hits: options.first_hits };
    let mut film = Film::new(options.size, region, keeping, options.tone);
    let first_round = Round::All;
    let work = film.parts().into_iter().map(|part| (part, &first_round)).collect();
    let mut rays = job.round(work, options.width, None, |tile, rays| {
        progress(TileDone { pixels: region.pixels_of(tile), rays });
    });
    let deadline = options.time_limit.map(|limit| start + limit);
    let is_late = || deadline.is_some_and(|deadline| Instant::now() >= deadline);
    let mut is_first = true;
    while job.adapts() && !is_late() {
        let rounds: Vec<Round> = film.wanting(&quality, is_first).into_iter().map(Round::Some).collect();
        let work: Vec<_> =
            film.parts().into_iter().zip(&rounds).filter(|(_, round)| !round.is_empty()).collect();
        if work.is_empty() {
            break;
        }
        let done = job.round(work, options.width, deadline, |_, rays| progress(TileDone { pixels: 0, rays }));
        rays = rays.plus(done);
        is_first = false;
    }
    Ok((film.develop(), RenderReport { plan, rays }))
}

/// What all tiles of a picture share.
struct Job<'a> {
    world: &'a World<'a>,
    eye: Eye,
    /// If the rays of a beam can go together: there is one model, and all rays come from the eye.
    primary: Option<Primary<'a>>,
    plan: Plan,
    quality: Quality,
    tone: Tone,
    first_hits: bool,
    /// Where each sample goes through its pixel, and at last a ray through the middle.
    offsets: Vec<[f32; 2]>,
    /// The sample of which first hits are kept: the first one if it is in the middle, or the last of the offsets, which is only
    /// sent for that.
    first_hit_sample: u32,
    picture_height: u32,
    /// What a ray that meets no model sees depends on its place in the picture alone, and nothing else is asked of it.
    misses_are_plain: bool,
}

/// The middle of a pixel, from its upper left corner; and that of the square from which points of a lens are chosen.
const MIDDLE: [f32; 2] = [0.5; 2];

/// Which rays to send through a tile.
enum Round {
    /// The first ones through all of its pixels.
    All,
    /// More of them through some pixels, given by their places in the tile and the number of rays they have.
    Some(Vec<(u32, u32)>),
}

impl Round {
    fn is_empty(&self) -> bool {
        matches!(self, Self::Some(places) if places.is_empty())
    }
}

/// Room that is used for one tile after the other.
#[derive(Default)]
struct Buffers {
    sums: Vec<PixelSum>,
    queues: Queues,
    slots: Vec<(u32, bool)>,
    passed_by: Vec<Sighting>,
    /// [`Rooms`] of the width that was used last.
    rooms: Option<Box<dyn Any>>,
}

/// Room for packets of one width, to be used for one tile after the other.
struct Rooms<L: Lanes> {
    workspace: Workspace<L>,
    walks: Walks<L>,
}

impl<L: Lanes> Rooms<L> {
    /// Those of the last tile, or new ones.
    fn of(buffers: &mut Buffers) -> Box<Self> {
        let used = buffers.rooms.take().and_then(|rooms| rooms.downcast().ok());
        used.unwrap_or_else(|| Box::new(Self { workspace: Workspace::new(), walks: Walks::new() }))
    }
}

/// Rays that are added to a pixel at once.
const BATCH: u32 = 8;

/// Rays from the eye that are followed to their end before others begin.
const SLOTS: usize = TILE_PIXELS;

/// A ray from the eye.
#[derive(Debug, Clone, Copy)]
struct Sighting {
    slot: u32,
    /// Column and row of the pixel.
    pixel: [u32; 2],
    sample: u32,
    ray: SceneRay,
    hit: Option<SceneHit>,
    /// Cells that the ray has visited, or nodes with others of a beam, if they were counted.
    steps: u32,
    /// The octree level of what was met, if the walk told it.
    level: Option<u8>,
    /// The way from the eye to where the ray begins: it has passed a smooth surface by.
    gone: f64,
}

/// How many voxels a ray may pass by the smooth surface of; what it meets then it meets.
const MOST_PASSED_BY: u32 = 16;

impl Job<'_> {
    /// Whether pixels may get more rays than others.
    fn adapts(&self) -> bool {
        self.quality.most_samples > self.quality.samples
    }

    /// Sends rays through tiles, unless it is too late.
    fn round(
        &self,
        work: Vec<(TilePart<'_>, &Round)>,
        width: Width,
        deadline: Option<Instant>,
        progress: impl Fn(&Tile, u64) + Sync,
    ) -> RayCounts {
        work.into_par_iter()
            .filter(|_| deadline.is_none_or(|deadline| Instant::now() < deadline))
            .map_init(Buffers::default, |buffers, (part, round)| {
                let tile = part.tile;
                let rays = with_lanes!(self.quality.arithmetic, width, L => with_effects!(self.plan.effects(), EFFECTS => {
                    match (self.world.is_exact(), self.first_hits) {
                        (true, false) => self.tile::<L, EFFECTS, false, false>(part, round, buffers),
                        (true, true) => self.tile::<L, EFFECTS, false, true>(part, round, buffers),
                        (false, false) => self.tile::<L, EFFECTS, true, false>(part, round, buffers),
                        (false, true) => self.tile::<L, EFFECTS, true, true>(part, round, buffers),
                    }
                }));
                progress(&tile, rays.total());
                rays
            })
            .reduce(RayCounts::default, RayCounts::plus)
    }

    fn tile<L: Lanes, const EFFECTS: u8, const LOD: bool, const COUNT: bool>(
        &self,
        part: TilePart<'_>,
        round: &Round,
        buffers: &mut Buffers,
    ) -> RayCounts {
        let TilePart { tile, sums: kept, first_hits, picture } = part;
        let is_kept = kept.is_some();
        let mut own = std::mem::take(&mut buffers.sums);
        let pixels = kept.unwrap_or_else(|| {
            own.clear();
            own.resize(TILE_PIXELS, PixelSum::default());
            &mut own
        });
        let mut rooms = Rooms::<L>::of(buffers);
        let Rooms { workspace, walks } = &mut *rooms;
        let mut work =
            TileWork::<L, EFFECTS, LOD>::new(self, tile, pixels, first_hits, std::mem::take(buffers), walks);
        // A ray for first hits alone comes before the samples of the picture.
        let middle = (self.first_hits && self.first_hit_sample > 0).then_some(self.first_hit_sample);
        match (round, &self.primary) {
            (Round::All, Some(primary)) => {
                let seeds = primary.seeds::<L>(&tile, workspace);
                for sample in middle.into_iter().chain(0..self.quality.samples) {
                    work.all_together::<COUNT>(primary, sample, seeds.as_ref(), workspace);
                }
            }
            (Round::All, None) => {
                for sample in middle.into_iter().chain(0..self.quality.samples) {
                    let rays: Vec<_> = tile.pixels_by_block().map(|place| (place, sample)).collect();
                    work.one_by_one(&rays);
                }
            }
            (Round::Some(places), primary) => {
                let batch = |&(place, rays): &(u32, u32)| {
                    (rays..self.quality.most_samples.min(rays + BATCH)).map(move |sample| (place, sample))
                };
                let rays: Vec<_> = places.iter().flat_map(batch).collect();
                for rays in rays.chunks(SLOTS) {
                    match primary {
                        Some(primary) => work.points(primary, rays, workspace),
                        None => work.one_by_one(rays),
                    }
                }
            }
        }
        let (rays, used) = work.finish();
        if !is_kept {
            picture.develop(&tile, &own);
        }
        *buffers = Buffers { sums: own, rooms: Some(rooms), ..used };
        rays
    }

    /// Whether a sample is no part of the picture, but only tells what is met.
    fn is_for_first_hits(&self, sample: u32) -> bool {
        sample > 0 && sample == self.first_hit_sample
    }

    /// How far down the picture a sample of a pixel goes through it, from 0 to 1.
    fn height_of(&self, [_, y]: [u32; 2], sample: u32) -> f32 {
        (y as f32 + self.offsets[sample as usize][1]) / self.picture_height as f32
    }

    /// The point of the picture through which a sample of a pixel goes.
    fn point_of(&self, [x, y]: [u32; 2], sample: u32) -> [f32; 2] {
        let [across, down] = self.offsets[sample as usize];
        [x as f32 + across, y as f32 + down]
    }
}

/// A tile in the making.
struct TileWork<'j: 'f, 'f, L: Lanes, const EFFECTS: u8, const LOD: bool> {
    job: &'j Job<'j>,
    tile: Tile,
    pixels: &'f mut [PixelSum],
    first_hits: &'f mut [FirstHit],
    transport: Transport<'f, L>,
    /// For each slot, its place in the tile and whether its ray has met something.
    slots: Vec<(u32, bool)>,
    /// Rays that have passed a smooth surface by.
    passed_by: Vec<Sighting>,
}

impl<'j, 'f, L: Lanes, const EFFECTS: u8, const LOD: bool> TileWork<'j, 'f, L, EFFECTS, LOD> {
    fn new(
        job: &'j Job<'j>,
        tile: Tile,
        pixels: &'f mut [PixelSum],
        first_hits: &'f mut [FirstHit],
        buffers: Buffers,
        walks: &'f mut Walks<L>,
    ) -> Self {
        let Buffers { queues, slots, passed_by, .. } = buffers;
        let transport = Transport::new(job.world, job.plan, job.quality, queues, walks);
        Self { job, tile, pixels, first_hits, transport, slots, passed_by }
    }

    fn finish(self) -> (RayCounts, Buffers) {
        let Self { transport, slots, passed_by, .. } = self;
        let (rays, queues) = transport.finished();
        (rays, Buffers { queues, slots, passed_by, ..Buffers::default() })
    }

    /// One ray through each pixel, with beams.
    fn all_together<const COUNT: bool>(
        &mut self,
        primary: &Primary<'_>,
        sample: u32,
        seeds: Option<&Seeds>,
        workspace: &mut Workspace<L>,
    ) {
        self.begin((0..TILE_PIXELS as u32).map(|place| (place, false)));
        let tile = self.tile;
        let offset = self.job.offsets[sample as usize];
        primary.trace::<L, LOD, COUNT>(&tile, seeds, offset, workspace, |seen| {
            self.see(primary, seen, |lane| {
                let [x, y] = seen.block.pixel(lane);
                ((y - tile.y) * TILE_SIZE + x - tile.x, [x, y], sample)
            });
        });
        self.end(sample);
    }

    /// Rays through some pixels, each given by its place in the tile and the number of the sample.
    fn points(&mut self, primary: &Primary<'_>, rays: &[(u32, u32)], workspace: &mut Workspace<L>) {
        self.begin(rays.iter().map(|&(place, _)| (place, false)));
        let tile = self.tile;
        let point = |&(place, sample): &(u32, u32)| self.job.point_of(tile.pixel(place), sample);
        let points: Vec<_> = rays.iter().map(point).collect();
        primary.trace_points::<L, LOD, false>(&points, workspace, |first, seen| {
            self.see(primary, seen, |lane| {
                let (place, sample) = rays[first + lane];
                ((first + lane) as u32, tile.pixel(place), sample)
            });
        });
        self.develop();
    }

    /// As [`TileWork::points`], for any lens and any number of models.
    fn one_by_one(&mut self, rays: &[(u32, u32)]) {
        self.begin(rays.iter().map(|&(place, _)| (place, false)));
        let tile = self.tile;
        let from_eye: Vec<SceneRay> = rays
            .iter()
            .map(|&(place, sample)| {
                let lens_seed = hashed(seed_of(tile.pixel(place)), 0x1E25);
                let through_opening = self.job.plan.depth_of_field && !self.job.is_for_first_hits(sample);
                let chosen = if through_opening { sample_2d(sample, lens_seed) } else { MIDDLE.into() };
                self.job.eye.ray(self.job.point_of(tile.pixel(place), sample), chosen)
            })
            .collect();
        let hits = self.transport.first_hits::<LOD>(&from_eye).to_vec();
        for (slot, ((&(place, sample), ray), hit)) in rays.iter().zip(from_eye).zip(hits).enumerate() {
            self.arrive(&Sighting {
                slot: slot as u32,
                pixel: tile.pixel(place),
                sample,
                ray,
                hit,
                steps: 0,
                level: None,
                gone: 0.0,
            });
        }
        self.end(rays.first().map_or(0, |&(_, sample)| sample));
    }

    fn begin(&mut self, slots: impl Iterator<Item = (u32, bool)>) {
        self.slots.clear();
        self.slots.extend(slots);
        self.transport.begin(self.slots.len());
    }

    /// Takes what a packet has met. `of_lane` tells slot, pixel and sample of a lane.
    #[inline(always)]
    fn see(
        &mut self,
        primary: &Primary<'_>,
        seen: &Seen<'_, L>,
        of_lane: impl Fn(usize) -> (u32, [u32; 2], u32),
    ) {
        let placed = &self.job.world.placed[0];
        let hits = seen.hits;
        let (active, hit) = (L::bitmask(seen.block.active), L::bitmask(hits.hit));
        let directions = primary.view.directions(seen.block).map(L::floats);
        let (distance, node, part) = (L::reals(hits.distance), L::words(hits.node), L::words(hits.part));
        let (steps, exponent) = (L::words(hits.steps), L::words(hits.exponent));
        // Only rays that go on need to know just where they are.
        let goes_on = EFFECTS != effect::NONE || self.job.first_hits || self.job.plan.smoothing;
        let departures = if goes_on && hit != 0 { seen.departures(primary.target.octree) } else { None };
        for lane in ones(hit).map(|lane| lane as usize) {
            placed.target.octree.ask_for_payload(node[lane], part[lane]);
        }
        let is_plain = self.job.misses_are_plain;
        for lane in (0..L::COUNT).filter(|lane| active >> lane & 1 == 1) {
            if is_plain && hit >> lane & 1 == 0 {
                let (slot, pixel, sample) = of_lane(lane);
                self.transport.counts.primary += 1;
                let seen = self.job.world.scene.background.at(self.job.height_of(pixel, sample), Vec3::ZERO);
                self.transport.add(slot, seen);
                continue;
            }
            let along = Vec3::from_array(directions.map(|floats| floats[lane]));
            let length = along.length();
            let direction = placed.placement.direction_to_scene(along / length);
            let origin = self.job.eye.position();
            let mut ray = SceneRay { origin, direction, end: f32::INFINITY, leaving: None };
            let met = (hit >> lane & 1 == 1).then(|| {
                let in_unit = match &seen.placements {
                    Some(placements) => placements[lane].distance(distance[lane]),
                    None => distance[lane].into(),
                };
                SceneHit {
                    instance: 0,
                    node: node[lane],
                    part: part[lane],
                    distance: in_unit * f64::from(length) * placed.placement.scale,
                    departure: departures.as_ref().map_or(SceneHit::NOWHERE, |found| found.of_lane(lane)),
                }
            });
            ray.end = met.map_or(f32::INFINITY, |hit| hit.distance as f32);
            let met = self.job.world.ground_hit(&ray).or(met);
            let is_ground = met.is_some_and(|hit| hit.instance == GROUND);
            let level = (!is_ground).then(|| MANTISSA_BITS.saturating_sub(exponent[lane]) as u8);
            let (slot, pixel, sample) = of_lane(lane);
            self.arrive(&Sighting {
                slot,
                pixel,
                sample,
                ray,
                hit: met,
                steps: steps[lane],
                level,
                gone: 0.0,
            });
        }
    }

    /// Takes what a ray from the eye has met.
    #[inline(always)]
    fn arrive(&mut self, sighting: &Sighting) {
        self.transport.counts.primary += 1;
        self.go_on(sighting, self.job.plan.smoothing);
    }

    /// Takes what a ray from the eye has met. If large voxels are to be smooth, it may pass one by.
    #[inline(always)]
    fn go_on(&mut self, sighting: &Sighting, smooth: bool) {
        let Sighting { slot, pixel, sample, ray, hit, gone, .. } = sighting;
        let Some(hit) = hit else {
            self.keep_first_hit(sighting, None);
            if self.job.is_for_first_hits(*sample) {
                return;
            }
            let share = self.job.height_of(*pixel, *sample);
            let seen = self.job.world.scene.background.at(share, ray.direction);
            return self.transport.add(*slot, seen);
        };
        let mut point = Point::new(self.job.world, ray, hit);
        let mut distance = gone + hit.distance;
        if smooth && point.voxel_size() > self.job.quality.smooth_pixels * self.job.eye.pixel_at(distance) {
            match point.smoothed(self.job.world, ray) {
                Some((smoothed, beyond)) => {
                    point = smoothed;
                    distance += beyond;
                }
                None => return self.passed_by.push(*sighting),
            }
        }
        self.keep_first_hit(sighting, Some((&point, distance)));
        if self.job.is_for_first_hits(*sample) {
            return;
        }
        self.slots[*slot as usize].1 = true;
        let arrival = Arrival {
            slot: *slot,
            direction: ray.direction,
            weight: Vec3::ONE,
            bounce: 0,
            inside: None,
            seed: seed_of(*pixel),
            sample: *sample,
        };
        self.transport.shade::<EFFECTS>(&point, &arrival);
    }

    /// Follows rays that have passed the smooth surface of a voxel by, to the next one.
    #[cold]
    fn pass_by(&mut self) {
        for round in 0..MOST_PASSED_BY {
            let mut sightings = std::mem::take(&mut self.passed_by);
            if sightings.is_empty() {
                return;
            }
            for sighting in &mut sightings {
                let Some(hit) = sighting.hit else { continue };
                sighting.ray.origin += sighting.ray.direction.as_dvec3() * hit.distance;
                sighting.ray.leaving =
                    Some(Leaving { instance: hit.instance, from: hit.departure, past: None });
                sighting.ray.end = f32::INFINITY;
                sighting.gone += hit.distance;
            }
            let rays: Vec<SceneRay> = sightings.iter().map(|sighting| sighting.ray).collect();
            let hits = self.transport.first_hits::<LOD>(&rays).to_vec();
            for (sighting, hit) in sightings.iter().zip(hits) {
                self.go_on(&Sighting { hit, level: None, ..*sighting }, round + 1 < MOST_PASSED_BY);
            }
        }
    }

    /// Keeps what the ray through the middle of a pixel met, and how far away.
    #[inline(always)]
    fn keep_first_hit(&mut self, sighting: &Sighting, met: Option<(&Point<'_>, f64)>) {
        if !self.job.first_hits || sighting.sample != self.job.first_hit_sample {
            return;
        }
        let hit = met.map_or(FirstHit::NONE, |(point, distance)| FirstHit {
            distance: distance as f32,
            normal: point.normal.to_array(),
            steps: 0,
            level: sighting.level.unwrap_or_else(|| point.level()),
        });
        let place = self.slots[sighting.slot as usize].0 as usize;
        self.first_hits[place] = FirstHit { steps: sighting.steps, ..hit };
    }

    /// Ends a round of rays of one sample.
    fn end(&mut self, sample: u32) {
        if self.job.is_for_first_hits(sample) {
            self.pass_by();
        } else {
            self.develop();
        }
    }

    /// Traces the rays that wait, and adds the light of each slot to its pixel.
    fn develop(&mut self) {
        if !self.passed_by.is_empty() {
            self.pass_by();
        }
        self.transport.finish::<EFFECTS, LOD>();
        let Tile { width, height, .. } = self.tile;
        let tone = self.job.adapts().then_some(&self.job.tone);
        for (&(place, is_hit), light) in self.slots.iter().zip(&self.transport.light) {
            if place % TILE_SIZE < width && place / TILE_SIZE < height {
                self.pixels[place as usize].add(*light, tone, is_hit);
            }
        }
    }
}

/// Where the random numbers of a pixel begin.
fn seed_of([x, y]: [u32; 2]) -> u32 {
    hashed(hashed(x, 1), y)
}
