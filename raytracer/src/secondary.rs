//! Secondary rays of a picture: from what is seen to lamps, into mirrors and all around.

use crate::arithmetic::Arithmetic;
use crate::bundle::Workspace;
use crate::camera::{Camera, CameraError, View};
use crate::crowd::Crowd;
use crate::departure::{LeavingRay, RayList};
use crate::lanes::{Lanes, Sixteen};
use crate::lod::LevelOfDetail;
use crate::octree::Octree;
use crate::primary::Primary;
use crate::random::Random;
use crate::scene::{Light, studio};
use crate::surface::towards_eye;
use crate::tile::{Tile, tiles};
use crate::traversal::Target;
use crate::visibility::{Counts, Room, Visibility};
use crate::width::{Width, with_lanes};
use glam::Vec3;
use rayon::prelude::*;

/// What secondary rays are for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum SecondaryKind {
    /// One to the brightest lamp, to see whether anything is in between. Those of neighbouring pixels run side by side.
    Shadow,
    /// One in a random direction, more often along the normal than across, to see whether anything is within an eighth of
    /// the cube's side: how much light comes from around. These run in all directions.
    Ambient,
    /// One that is reflected, to see what it meets first.
    Reflection,
}

/// How far rays for light from around go, in unit space.
const AMBIENT_DISTANCE: f32 = 0.125;

/// A secondary ray for each pixel that shows the model and asks for one, tile by tile.
#[derive(Debug, Clone)]
pub struct SecondaryRays {
    kind: SecondaryKind,
    tiles: Vec<RayList>,
}

impl SecondaryRays {
    /// The rays that a picture sends after its primary rays, with lamps as of a model that has none.
    ///
    /// # Errors
    /// If the camera sees nothing.
    pub fn new(
        octree: &Octree,
        camera: &Camera,
        [width, height]: [u32; 2],
        lod_pixels: f64,
        kind: SecondaryKind,
    ) -> Result<Self, CameraError> {
        let view = View::of_octree(camera, octree, [width, height])?;
        let primary = Primary::new(octree, view, lod_pixels, true);
        let lamp = studio::lights(view.axes())[0];
        let tiles = tiles(width, height).into_par_iter().map(|tile| {
            if primary.target.lod.is_exact() {
                rays_of_tile::<false>(&primary, &lamp, kind, &tile)
            } else {
                rays_of_tile::<true>(&primary, &lamp, kind, &tile)
            }
        });
        Ok(Self { kind, tiles: tiles.collect() })
    }

    /// Number of rays.
    #[must_use]
    pub fn len(&self) -> usize {
        self.tiles.iter().map(RayList::len).sum()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Finds what each ray meets, on all threads of the current pool. The order of rays does not depend on the width.
    ///
    /// Of rays that are only asked whether they meet something, the distance is 0 if they do.
    pub fn trace(
        &self,
        octree: &Octree,
        arithmetic: Arithmetic,
        width: Width,
        count_steps: bool,
        found: &mut Visibility,
    ) -> Counts {
        let rooms = found.rooms(self.tiles.iter().map(RayList::room));
        let target = Target { octree, grid: &octree.grid, lod: LevelOfDetail::EXACT };
        self.tiles
            .par_iter()
            .zip(rooms)
            .map(|(rays, mut found)| {
                let found = &mut found;
                let any = self.kind != SecondaryKind::Reflection;
                with_lanes!(arithmetic, width, L => match (any, count_steps) {
                    (false, false) => trace_list::<L, false, false>(&target, rays, found),
                    (false, true) => trace_list::<L, false, true>(&target, rays, found),
                    (true, false) => trace_list::<L, true, false>(&target, rays, found),
                    (true, true) => trace_list::<L, true, true>(&target, rays, found),
                })
            })
            .reduce(Counts::default, Counts::plus)
    }
}

/// The rays that a tile of the picture sends: by Morton order of its pixels, so that any packet is a compact part of it.
fn rays_of_tile<const LOD: bool>(
    primary: &Primary<'_>,
    lamp: &Light,
    kind: SecondaryKind,
    tile: &Tile,
) -> RayList {
    /// The packets of the primary rays; the list does not depend on it.
    type L = Sixteen;
    let Primary { target, view, .. } = primary;
    let mut workspace = Workspace::<L>::new();
    let mut rays: Vec<(u32, LeavingRay)> = Vec::new();
    let seeds = primary.seeds::<L>(tile, &mut workspace);
    primary.trace::<L, LOD, false>(tile, seeds.as_ref(), [0.5, 0.5], &mut workspace, |seen| {
        let hit = L::bitmask(seen.hits.hit);
        if hit == 0 {
            return;
        }
        let Some(departures) = seen.departures(target.octree) else { return };
        let directions = view.directions(seen.block).map(L::floats);
        let (node, part) = (L::words(seen.hits.node), L::words(seen.hits.part));
        for lane in (0..L::COUNT).filter(|lane| hit >> lane & 1 == 1) {
            let [column, row] = seen.block.pixel(lane);
            let to_eye = -Vec3::from_array(directions.map(|floats| floats[lane])).normalize();
            let normal = target.octree.payload_of(node[lane], part[lane]).normal().decode();
            let normal = towards_eye(Vec3::from_array(normal), to_eye);
            let point = Vec3::from_array(departures.point.map(|floats| floats[lane])) - 1.0;
            let number = u64::from(row) << 32 | u64::from(column);
            if let Some((direction, end)) = kind.ray(point, normal, to_eye, lamp, number) {
                let place = spread(column - tile.x) | spread(row - tile.y) << 1;
                let from = departures.of_lane(lane);
                rays.push((place, LeavingRay { from, direction, end }));
            }
        }
    });
    rays.sort_unstable_by_key(|&(place, _)| place);
    let rays: Vec<LeavingRay> = rays.into_iter().map(|(_, ray)| ray).collect();
    RayList::new(&rays)
}

/// The five bits of a place in a tile, with room between them for those of the other axis.
fn spread(bits: u32) -> u32 {
    (0..5).map(|bit| (bits >> bit & 1) << (2 * bit)).sum()
}

impl SecondaryKind {
    /// Direction and length of the ray that leaves a point of a surface, if one is needed there. `number` is that of the
    /// pixel.
    fn ray(self, point: Vec3, normal: Vec3, to_eye: Vec3, lamp: &Light, number: u64) -> Option<(Vec3, f32)> {
        let (direction, end) = match self {
            Self::Shadow => {
                let arriving = lamp.middle_at(point);
                (arriving.towards, arriving.distance)
            }
            Self::Ambient => (about(normal, &mut Random::stream(0, number)), AMBIENT_DISTANCE),
            Self::Reflection => (normal * (2.0 * normal.dot(to_eye)) - to_eye, f32::INFINITY),
        };
        // What faces away from a lamp is dark anyway.
        (normal.dot(direction) > 0.0).then_some((direction, end))
    }
}

/// A random direction on one side of a surface, as likely as the light from there counts: in proportion to the cosine.
/// A normal plus a random point on the unit sphere is just that.
fn about(normal: Vec3, random: &mut Random) -> Vec3 {
    const STEPS: i32 = 1 << 20;
    loop {
        let point = Vec3::from_array([(); 3].map(|()| random.between(-STEPS, STEPS) as f32 / STEPS as f32));
        let squared = point.length_squared();
        if (0.01..=1.0).contains(&squared) {
            let direction = normal + point / squared.sqrt();
            if direction.length_squared() > 1e-6 {
                return direction.normalize();
            }
        }
    }
}

fn trace_list<L: Lanes, const ANY: bool, const COUNT: bool>(
    target: &Target<'_>,
    rays: &RayList,
    found: &mut Room<'_>,
) -> Counts {
    let mut counts = Counts { rays: rays.len() as u64, ..Counts::default() };
    let mut crowd = Crowd::<L>::new();
    let mut packets = Vec::with_capacity(Crowd::<L>::PACKETS);
    for first in (0..rays.len()).step_by(Crowd::<L>::PACKETS * L::COUNT) {
        packets.clear();
        let all = (first..rays.len()).step_by(L::COUNT);
        packets.extend(all.take(Crowd::<L>::PACKETS).map(|first| rays.packet::<L>(first)));
        crowd.first_hits::<false, COUNT>(target, &packets, None, |number, hits, _| {
            let first = first + number * L::COUNT;
            let room = first..first + L::COUNT;
            if ANY {
                let distance = L::select(hits.hit, L::float(0.0), L::float(f32::INFINITY));
                L::store(distance, &mut found.distance[room.clone()]);
                found.node[room.clone()].fill(0);
                found.part[room].fill(0);
            } else {
                let met = |word: L::Word| L::select_word(hits.hit, word, L::word(0));
                let distance = L::select(hits.hit, hits.distance, L::float(f32::INFINITY));
                L::store(distance, &mut found.distance[room.clone()]);
                L::store_words(met(hits.node), &mut found.node[room.clone()]);
                L::store_words(met(hits.part), &mut found.part[room]);
            }
            counts.hits += u64::from(L::bitmask(hits.hit).count_ones());
            if COUNT {
                counts.add_steps::<L>(hits.steps, hits.packet_steps);
            }
        });
    }
    found.distance[rays.len()..].fill(f32::INFINITY);
    found.node[rays.len()..].fill(0);
    found.part[rays.len()..].fill(0);
    counts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::departure::{Departure, Departures};
    use crate::passing::{Met, Passes, trace_past};
    use crate::ray::{Packet, Ray};
    use crate::traversal::{Hits, Path, trace, trace_to_end};
    use glam::DVec3;
    use octvox_format::{Palette, SphericalNormal, Voxel, Writer};

    /// The octree of the cells of which `is_filled` is true. If it is pruned, cubes of filled cells are one voxel each.
    fn octree(depth: u8, is_pruned: bool, is_filled: &dyn Fn([u32; 3]) -> bool) -> Octree {
        const VOXEL: Voxel = Voxel { palette_index: 1, normal: SphericalNormal { theta: 0, phi: 0 } };
        struct Cubes<'a> {
            writer: Writer<Vec<u8>>,
            is_pruned: bool,
            is_filled: &'a dyn Fn([u32; 3]) -> bool,
        }
        impl Cubes<'_> {
            fn is_full(&self, size: u32, [x, y, z]: [u32; 3]) -> bool {
                let along = |low: u32| low..low + size;
                along(x).all(|x| along(y).all(|y| along(z).all(|z| (self.is_filled)([x, y, z]))))
            }

            fn write(&mut self, size: u32, corner: [u32; 3]) {
                if (size == 1 || self.is_pruned) && self.is_full(size, corner) {
                    return self.writer.leaf(VOXEL).unwrap();
                } else if size == 1 {
                    return self.writer.leaf(Voxel::EMPTY).unwrap();
                }
                self.writer.node(VOXEL).unwrap();
                for octant in 0..8 {
                    let low = std::array::from_fn(|axis| corner[axis] + (octant >> axis & 1) * size / 2);
                    self.write(size / 2, low);
                }
            }
        }
        let writer = Writer::new(Vec::new(), &Palette::new(vec![[9, 9, 9]]).unwrap()).unwrap();
        let mut cubes = Cubes { writer, is_pruned, is_filled };
        cubes.write(1 << depth, [0; 3]);
        Octree::from_bytes(&cubes.writer.finish().unwrap()).unwrap()
    }

    fn target(octree: &Octree) -> Target<'_> {
        Target { octree, grid: &octree.grid, lod: LevelOfDetail::EXACT }
    }

    fn random_vector(random: &mut Random) -> Vec3 {
        let component = |random: &mut Random| random.between(-1_000_000, 1_000_001) as f32 / 1e6;
        Vec3::new(component(random), component(random), component(random))
    }

    /// What some rays hit, and rays that leave from there in directions that depend on the hit's number.
    fn leaving<L: Lanes>(
        octree: &Octree,
        rays: &[Ray],
        mut direction: impl FnMut(usize) -> Vec3,
    ) -> Vec<([u32; 2], LeavingRay)> {
        let mut leaving = Vec::new();
        let mut path = Path::new();
        for rays in rays.chunks(L::COUNT) {
            let (packet, _) = Packet::<L>::from_rays(rays.iter().copied());
            let (hits, place) = trace::<L, false, false>(&target(octree), &packet, &mut path);
            let departures = Departures::new(octree, &packet, &hits, place);
            let (node, part) = (L::words(hits.node), L::words(hits.part));
            for lane in (0..rays.len()).filter(|lane| L::bitmask(hits.hit) >> lane & 1 == 1) {
                let direction = direction(leaving.len()).normalize();
                leaving.push((
                    [node[lane], part[lane]],
                    LeavingRay { from: departures.of_lane(lane), direction, end: f32::INFINITY },
                ));
            }
        }
        leaving
    }

    /// The distance at which each ray meets something first, and what.
    fn first_met<L: Lanes>(octree: &Octree, rays: &RayList) -> Vec<(f32, [u32; 2])> {
        let mut found = Visibility::default();
        let mut rooms = found.rooms(std::iter::once(rays.room()));
        trace_list::<L, false, false>(&target(octree), rays, &mut rooms[0]);
        let voxels = found.node.iter().zip(&found.part).map(|(&node, &part)| [node, part]);
        found.distance.iter().copied().zip(voxels).take(rays.len()).collect()
    }

    fn is_blocked<L: Lanes>(octree: &Octree, rays: &RayList) -> Vec<bool> {
        let mut found = Visibility::default();
        let mut rooms = found.rooms(std::iter::once(rays.room()));
        trace_list::<L, true, false>(&target(octree), rays, &mut rooms[0]);
        found.distance.iter().map(|&distance| distance == 0.0).take(rays.len()).collect()
    }

    /// Rays from about the cube into it.
    fn inward(count: usize) -> Vec<Ray> {
        let random = &mut Random::stream(7, 0);
        let ray = |_| {
            let target = DVec3::splat(0.5) + random_vector(random).as_dvec3() * 0.5;
            let origin = DVec3::splat(0.5) + random_vector(random).as_dvec3() * 1.5;
            Ray { origin, direction: target - origin }
        };
        (0..count).map(ray).collect()
    }

    /// However flat they run: a wall does not shadow itself.
    #[test]
    fn nothing_is_met_above_a_flat_wall() {
        for depth in [3, 6, 7] {
            let height = (1 << depth) / 3;
            for axis in 0..3 {
                let wall = octree(depth, false, &|cell| cell[axis] == height);
                let rays = inward(20_000);
                let above = f64::from(height) / f64::from(1 << depth);
                let rays: Vec<Ray> = rays.into_iter().filter(|ray| ray.origin[axis] > above + 0.1).collect();
                let random = &mut Random::stream(8, 0);
                let away = |number: usize| {
                    let mut direction = random_vector(random);
                    direction[axis] = direction[axis].abs() * [1.0, 1e-3, 1e-6, 0.0][number % 4];
                    direction
                };
                let leaving = leaving::<Sixteen>(&wall, &rays, away);
                assert!(leaving.len() > 1000);
                // Those that run along the wall are in it, if they began on its upper face.
                let leaving: Vec<LeavingRay> = leaving
                    .into_iter()
                    .map(|(_, ray)| ray)
                    .filter(|ray| {
                        ray.direction[axis] > 0.0 && ray.from.point[axis] == ray.from.voxel[1][axis]
                    })
                    .collect();
                assert!(leaving.len() > 1000);
                let met = is_blocked::<Sixteen>(&wall, &RayList::new(&leaving));
                let met = met.iter().filter(|&&met| met).count();
                assert_eq!(met, 0, "of {} rays, axis {axis}, depth {depth}", leaving.len());
            }
        }
    }

    /// Wherever a ray goes from a voxel, even through it: it does not meet that.
    #[test]
    fn no_ray_meets_the_voxel_that_it_leaves() {
        for (depth, spread) in [(5, 9), (6, 3), (7, 40)] {
            let octree = octree(depth, false, &|[x, y, z]| {
                Random::stream(1, u64::from(x << 16 | y << 8 | z)).between(0, spread) == 0
            });
            let random = &mut Random::stream(9, 0);
            let leaving = leaving::<Sixteen>(&octree, &inward(20_000), |_| random_vector(random));
            assert!(leaving.len() > 10_000);
            let (voxels, rays): (Vec<_>, Vec<_>) = leaving.into_iter().unzip();
            for ray in &rays {
                let [low, high] = ray.from.voxel;
                assert!(ray.from.point.cmpge(low).all() && ray.from.point.cmple(high).all());
                assert_eq!(high - low, Vec3::splat(1.0 / octree.resolution() as f32));
            }
            let met = first_met::<Sixteen>(&octree, &RayList::new(&rays));
            assert!(met.iter().zip(&voxels).all(|((_, met), from)| met != from));
            assert!(met.iter().filter(|(distance, _)| distance.is_finite()).count() > 1000);
        }
    }

    /// What is stored as one voxel is left as one, be it larger than a cell of the grid.
    #[test]
    fn no_ray_meets_the_large_voxel_that_it_leaves() {
        for depth in [4, 7, 8] {
            // Balls whose insides are large voxels, apart from one another.
            let step = 1 << (depth - 2);
            let mut octree = octree(depth, true, &|cell| {
                let squared = |part: u32| (f64::from(part % step) - f64::from(step) / 2.0 + 0.5).powi(2);
                cell.iter().map(|&part| squared(part)).sum::<f64>() < f64::from(step * step) / 5.0
            });
            let random = &mut Random::stream(11, 0);
            for level in [0, 3, 6] {
                octree.set_grid(level);
                let leaving = leaving::<Sixteen>(&octree, &inward(20_000), |_| random_vector(random));
                assert!(leaving.len() > 5000);
                let large = leaving.iter().filter(|(_, ray)| {
                    let [low, high] = ray.from.voxel;
                    (high - low).min_element() > 1.5 / octree.resolution() as f32
                });
                assert!(depth == 4 || large.count() > 50, "depth {depth}");
                let (voxels, rays): (Vec<_>, Vec<_>) = leaving.into_iter().unzip();
                let met = first_met::<Sixteen>(&octree, &RayList::new(&rays));
                assert!(met.iter().zip(&voxels).all(|((_, met), from)| met != from), "depth {depth}");
            }
        }
    }

    /// Rays that run up to eight ways, of which neighbours run a few: on lattices, so that they meet edges and corners, and in general.
    fn crowd_of(size: usize, depth: u8) -> Vec<Ray> {
        let random = &mut Random::stream(16, u64::from(depth));
        let in_general = inward(size / 2);
        let on_the_lattice = (size / 2..size).map(|_| {
            let mut number = |low: i32, high: i32| f64::from(random.between(low, high));
            let origin = DVec3::new(number(-8, 25), number(-8, 25), number(-8, 25)) / 16.0;
            let direction = DVec3::new(number(-3, 4), number(-3, 4), number(-3, 4));
            Ray { origin, direction }
        });
        let mut rays: Vec<Ray> = in_general.into_iter().chain(on_the_lattice).collect();
        // Three quarters by the way they run, the rest as they come.
        rays[..size * 3 / 4].sort_by_key(|ray| ray.direction.to_array().map(|along| along > 0.0));
        rays
    }

    /// What a ray has met, and from where on which voxel.
    #[derive(Debug, Default, PartialEq)]
    struct Found {
        end: Option<([u32; 3], Departure)>,
        /// What it was asked about on the way.
        on_the_way: Vec<([u32; 3], [Vec3; 2])>,
    }

    /// What rays meet before their ends: those of each packet alone, or many in a crowd. Each goes past some voxels, if any does.
    fn followed<L: Lanes, const LOD: bool>(
        target: &Target<'_>,
        rays: &[Ray],
        in_crowds: bool,
        any_passes: bool,
    ) -> Vec<Found> {
        let end_of = |packet: usize| [f32::INFINITY, 0.4, 1.5][packet % 3];
        let mut packets: Vec<Packet<L>> =
            rays.chunks(L::COUNT).map(|rays| Packet::from_rays(rays.iter().copied()).0).collect();
        for (number, packet) in packets.iter_mut().enumerate() {
            packet.lines.end = L::float(end_of(number));
        }
        let mut ends = Vec::new();
        let mut keep = |packet: &Packet<L>, hits: &Hits<L>, place| {
            let departures = Departures::new(target.octree, packet, hits, place);
            let (distance, node, part) = (L::floats(hits.distance), L::words(hits.node), L::words(hits.part));
            ends.extend((0..L::COUNT).map(|lane| {
                let met = [distance[lane].to_bits(), node[lane], part[lane]];
                (L::bitmask(hits.hit) >> lane & 1 == 1).then(|| (met, departures.of_lane(lane)))
            }));
        };
        let mut on_the_way: Vec<Vec<_>> = rays.iter().map(|_| Vec::new()).collect();
        let mut passes = |met: &Met, first: usize| {
            let ray = first + met.ray;
            // Rays that are followed together are not stopped at their ends before.
            if met.distance < end_of(ray / L::COUNT) && ray < rays.len() {
                on_the_way[ray].push(([met.distance.to_bits(), met.node, met.part], met.voxel));
            }
            !(met.node + met.part + ray as u32).is_multiple_of(4)
        };
        let size = if in_crowds { Crowd::<L>::PACKETS } else { 1 };
        let (mut crowd, mut path) = (Crowd::<L>::new(), Path::new());
        for (number, packets) in packets.chunks(size).enumerate() {
            let mut passes = |met: &Met| passes(met, number * size * L::COUNT);
            if in_crowds {
                let passes = any_passes.then_some(&mut passes as &mut Passes<'_>);
                crowd.first_hits::<LOD, false>(target, packets, passes, |number, hits, place| {
                    keep(&packets[number], hits, place);
                });
                continue;
            }
            let (hits, place) = if any_passes {
                trace_past::<L, LOD>(target, &packets[0], &mut path, 0, &mut passes)
            } else {
                trace_to_end::<L, LOD, false>(target, &packets[0], &mut path)
            };
            keep(&packets[0], &hits, place);
        }
        let found = ends.into_iter().zip(on_the_way);
        found.map(|(end, on_the_way)| Found { end, on_the_way }).collect()
    }

    #[test]
    fn rays_of_a_crowd_meet_what_each_meets_alone() {
        fn check<L: Lanes>(target: &Target<'_>, rays: &[Ray], any_passes: bool, setting: &str) -> [usize; 2] {
            let follow = |in_crowds| {
                if target.lod.is_exact() {
                    followed::<L, false>(target, rays, in_crowds, any_passes)
                } else {
                    followed::<L, true>(target, rays, in_crowds, any_passes)
                }
            };
            let (alone, in_crowds) = (follow(false), follow(true));
            for ((alone, in_crowds), ray) in alone.iter().zip(&in_crowds).zip(rays) {
                assert_eq!(alone, in_crowds, "{setting}, {ray:?}");
            }
            let met = alone.iter().filter(|found| found.end.is_some()).count();
            let often = alone.iter().filter(|found| found.on_the_way.len() > 2).count();
            [met, often]
        }
        for depth in 1..=7 {
            for is_pruned in [false, true] {
                let size = f64::from(1u32 << depth);
                let octree = octree(depth, is_pruned, &|cell| {
                    let [x, y, z] = cell.map(|part| (f64::from(part) + 0.5) / size - 0.5);
                    (x * x + y * y + z * z < 0.2 && x < 0.3)
                        != (cell[0] * 7 + cell[1] * 5 + cell[2]).is_multiple_of(61)
                });
                let view = View::of_octree(&Camera::framing(&octree, 1.5, 43.6), &octree, [20, 20]).unwrap();
                for (lod_pixels, any_passes) in [(0.0, false), (0.0, true), (1.5, false), (1.5, true)] {
                    let target = Target::new(&octree, &view, lod_pixels);
                    let rays = crowd_of(2000, depth);
                    let setting = format!(
                        "depth {depth}, pruned: {is_pruned}, LOD {lod_pixels}, past voxels: {any_passes}"
                    );
                    for width in Width::ALL {
                        with_lanes!(Arithmetic::Single, width, L => {
                            let [met, often] = check::<L>(&target, &rays, any_passes, &setting);
                            assert!(met > 100, "{met}, {setting}");
                            assert!(often > 100 || !any_passes, "{often}, {setting}");
                        });
                    }
                    with_lanes!(Arithmetic::Double, Width::Eight, L => {
                        check::<L>(&target, &rays, any_passes, &setting);
                    });
                }
            }
        }
    }

    /// Where the rays of a picture meet something, pixel by pixel of its tiles.
    fn departures<L: Lanes, const LOD: bool>(
        primary: &Primary<'_>,
        size: [u32; 2],
    ) -> Vec<Option<Departure>> {
        let mut workspace = Workspace::<L>::new();
        let mut found = Vec::new();
        for tile in tiles(size[0], size[1]) {
            let seeds = primary.seeds(&tile, &mut workspace);
            primary.trace::<L, LOD, false>(&tile, seeds.as_ref(), [0.5; 2], &mut workspace, |seen| {
                let departures = seen.departures(primary.target.octree);
                let is_hit = |lane: usize| L::bitmask(seen.hits.hit) >> lane & 1 == 1;
                let of_lane =
                    |lane| departures.as_ref().filter(|_| is_hit(lane)).map(|all| all.of_lane(lane));
                found.extend((0..L::COUNT).map(of_lane));
            });
        }
        found
    }

    /// Beams tell of voxels of all sizes where their rays meet them, whether these stay together or part.
    #[test]
    fn rays_of_beams_leave_from_where_each_alone_does() {
        for (depth, is_pruned) in [(3, false), (6, false), (6, true), (7, false)] {
            let size = f64::from(1u32 << depth);
            let octree = octree(depth, is_pruned, &|cell| {
                let [x, y, z] = cell.map(|part| (f64::from(part) + 0.5) / size - 0.5);
                (x * x + y * y + z * z < 0.2) && (cell[0] + cell[1] * 3 + cell[2] * 7) % 41 != 0
            });
            for (picture, lod_pixels) in
                [([60, 40], 0.0), ([60, 40], 2.0), ([200, 150], 0.0), ([200, 150], 9.0)]
            {
                let view = View::of_octree(&Camera::framing(&octree, 1.5, 43.6), &octree, picture).unwrap();
                let of = |beams| Primary::new(&octree, view, lod_pixels, beams);
                let (together, alone) = (of(true), of(false));
                let find = |primary| {
                    if lod_pixels == 0.0 {
                        departures::<Sixteen, false>(primary, picture)
                    } else {
                        departures::<Sixteen, true>(primary, picture)
                    }
                };
                let expected = find(&alone);
                assert!(expected.iter().flatten().count() > 300);
                assert!(find(&together) == expected, "depth {depth}, {picture:?}, LOD {lod_pixels}");
            }
        }
    }

    /// To ask whether anything is met up to a distance is to ask what is met first.
    #[test]
    fn any_is_first_for_every_width() {
        let octree = octree(6, false, &|[x, y, z]| {
            Random::stream(2, u64::from(x << 16 | y << 8 | z)).between(0, 30) == 0
        });
        let random = &mut Random::stream(10, 0);
        let leaving = leaving::<Sixteen>(&octree, &inward(5000), |_| random_vector(random));
        let rays: Vec<LeavingRay> = leaving
            .into_iter()
            .map(|(_, ray)| LeavingRay { end: random.between(1, 1000) as f32 / 2000.0, ..ray })
            .collect();
        let list = RayList::new(&rays);
        let first = first_met::<Sixteen>(&octree, &list);
        let expected: Vec<bool> = first.iter().zip(&rays).map(|((met, _), ray)| *met < ray.end).collect();
        assert!(expected.iter().filter(|&&met| met).count() > 500);
        assert!(expected.iter().filter(|&&met| !met).count() > 500);
        for width in Width::ALL {
            with_lanes!(Arithmetic::Single, width, L => {
                assert_eq!(is_blocked::<L>(&octree, &list), expected, "{width:?}");
                assert!(first_met::<L>(&octree, &list) == first, "{width:?}");
            });
        }
    }

    #[test]
    fn the_rays_of_a_picture_meet_the_same_for_every_width() {
        let ball = octree(6, false, &|cell| {
            let [x, y, z] = cell.map(|part| f64::from(part) - 31.5);
            (x * x + y * y + z * z - 600.0).abs() < 50.0 && y < 10.0
        });
        let camera = Camera::framing(&ball, 1.5, 43.6);
        for kind in [SecondaryKind::Shadow, SecondaryKind::Ambient, SecondaryKind::Reflection] {
            for lod_pixels in [0.0, 1.0, 9.0] {
                let rays = SecondaryRays::new(&ball, &camera, [90, 60], lod_pixels, kind).unwrap();
                assert!(rays.len() > 300, "{kind:?}");
                let results = Width::ALL.map(|width| {
                    let mut found = Visibility::default();
                    let counts = rays.trace(&ball, Arithmetic::Single, width, true, &mut found);
                    assert!(counts.steps <= counts.lane_steps && counts.rays == rays.len() as u64);
                    (Counts { lane_steps: 0, ..counts }, found.distance, found.node, found.part)
                });
                assert!(results.iter().all(|result| *result == results[0]), "{kind:?}");
                assert!(results[0].0.hits > 0, "{kind:?}");
            }
        }
    }
}
