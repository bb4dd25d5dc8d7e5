//! Secondary rays of a picture: from what is seen to lamps, into mirrors and all around.

use crate::arithmetic::Arithmetic;
use crate::bundle::Workspace;
use crate::camera::{Camera, CameraError, View};
use crate::departure::{Departures, LeavingRay, RayList};
use crate::lanes::{Lanes, Sixteen};
use crate::lod::LevelOfDetail;
use crate::octree::Octree;
use crate::primary::Primary;
use crate::random::Random;
use crate::scene::{Light, studio};
use crate::surface::towards_eye;
use crate::tile::{Tile, tiles};
use crate::traversal::{Path, Target, trace, trace_any};
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
    let mut path = Path::new();
    let mut rays: Vec<(u32, LeavingRay)> = Vec::new();
    let seeds = primary.seeds::<L>(tile, &mut workspace);
    primary.trace::<L, LOD, false>(tile, seeds.as_ref(), [0.5, 0.5], &mut workspace, |seen| {
        let hit = L::bitmask(seen.hits.hit);
        if hit == 0 {
            return;
        }
        let (packet, _) = view.packet(seen.block);
        let departures = Departures::new::<L, LOD>(target, &packet, seen.hits, &mut path);
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
    let mut path = Path::new();
    for first in (0..rays.len()).step_by(L::COUNT) {
        let packet = rays.packet::<L>(first);
        let room = first..first + L::COUNT;
        let (hit, steps, packet_steps) = if ANY {
            let (hit, steps, packet_steps) = trace_any::<L, false, COUNT>(target, &packet, &mut path);
            let distance = L::select(hit, L::float(0.0), L::float(f32::INFINITY));
            L::store(distance, &mut found.distance[room.clone()]);
            found.node[room.clone()].fill(0);
            found.part[room].fill(0);
            (hit, steps, packet_steps)
        } else {
            let hits = trace::<L, false, COUNT>(target, &packet, &mut path);
            L::store(hits.distance, &mut found.distance[room.clone()]);
            L::store_words(hits.node, &mut found.node[room.clone()]);
            L::store_words(hits.part, &mut found.part[room]);
            (hits.hit, hits.steps, hits.packet_steps)
        };
        counts.hits += u64::from(L::bitmask(hit).count_ones());
        if COUNT {
            counts.add_steps::<L>(steps, packet_steps);
        }
    }
    found.distance[rays.len()..].fill(f32::INFINITY);
    found.node[rays.len()..].fill(0);
    found.part[rays.len()..].fill(0);
    counts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ray::{Packet, Ray};
    use crate::traversal::Hits;
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
            let hits: Hits<L> = trace::<L, false, false>(&target(octree), &packet, &mut path);
            let departures = Departures::new::<L, false>(&target(octree), &packet, &hits, &mut path);
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
