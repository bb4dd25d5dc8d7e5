//! A scene made ready for rays: what they meet first, among all its instances.

use crate::bvh::{BoxRays, Bvh, Waiting};
use crate::crowd::Crowd;
use crate::departure::{Departure, Departures};
use crate::ends::RAYS;
use crate::lanes::{Lanes, MAX_LANES};
use crate::passing::{Met, Passes, trace_past};
use crate::ray::{Gathered, Packet, Placement, Ray};
use crate::scene::{Model, Scene, Similarity};
use crate::surface::Tangent;
use crate::traversal::{Hits, Path, Target, trace_to_end};
use glam::{DVec3, Vec3};

/// A scene made ready for rays.
pub(crate) struct World<'a> {
    pub scene: &'a Scene<'a>,
    /// Its instances, in their order.
    pub placed: Vec<Placed<'a>>,
    bvh: Bvh,
}

/// An instance made ready for rays.
pub(crate) struct Placed<'a> {
    pub model: &'a Model<'a>,
    pub placement: Similarity,
    pub target: Target<'a>,
}

/// The number that stands for the ground where instances have theirs.
pub(crate) const GROUND: u32 = u32::MAX;

/// A ray in the scene.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SceneRay {
    pub origin: DVec3,
    /// A unit vector.
    pub direction: Vec3,
    /// Distance at which it ends.
    pub end: f32,
    pub leaving: Option<Leaving>,
}

/// What a ray leaves.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Leaving {
    /// The number of the instance, or [`GROUND`].
    pub instance: u32,
    /// The place on the instance; of the ground none that counts.
    pub from: Departure,
    /// The surface there, past whose voxels the ray goes.
    pub past: Option<Tangent>,
}

/// What a ray in the scene met.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SceneHit {
    /// The number of the instance, or [`GROUND`].
    pub instance: u32,
    /// With `part`, names the voxel in the octree.
    pub node: u32,
    pub part: u32,
    /// In the scene.
    pub distance: f64,
    /// The place on the instance; of the ground none that counts.
    pub departure: Departure,
}

/// Room for following packet after packet.
pub(crate) struct Walks<L: Lanes> {
    path: Path<L>,
    crowd: Crowd<L>,
    stack: Vec<Waiting>,
}

impl<L: Lanes> Walks<L> {
    pub fn new() -> Self {
        Self { path: Path::new(), crowd: Crowd::new(), stack: Vec::new() }
    }
}

impl SceneHit {
    /// A place that is not on an instance, or that nobody asks for.
    pub const NOWHERE: Departure = Departure { point: Vec3::ONE, voxel: [Vec3::ONE; 2] };
}

impl<'a> World<'a> {
    /// `targets` are the octrees of the scene's instances, and how rays see them, in their order.
    pub fn new(scene: &'a Scene<'a>, targets: impl Iterator<Item = Target<'a>>) -> Self {
        let placed: Vec<Placed<'a>> = scene
            .instances
            .iter()
            .zip(targets)
            .map(|(instance, target)| Placed {
                model: &scene.models[instance.model],
                placement: instance.placement,
                target,
            })
            .collect();
        // Cells above the finest reach beyond the box around those, but not out of the cube.
        let boxes: Vec<_> = placed
            .iter()
            .map(|placed| {
                let bounds = placed.target.octree.unit_bounds().map(DVec3::from_array);
                let room = f64::from(!placed.target.lod.is_exact()) * (bounds[1] - bounds[0]).max_element();
                placed
                    .placement
                    .box_around([(bounds[0] - room).max(DVec3::ZERO), (bounds[1] + room).min(DVec3::ONE)])
            })
            .collect();
        Self { scene, placed, bvh: Bvh::new(&boxes) }
    }

    /// Whether rays end at the finest cells of everything.
    pub fn is_exact(&self) -> bool {
        self.placed.iter().all(|placed| placed.target.lod.is_exact())
    }

    /// What each ray meets first, up to its end, that is not of the surface that it leaves; of things at equal distance the one
    /// with the lower number. The result does not depend on the width, nor on which rays go together.
    pub fn first_hits<L: Lanes, const LOD: bool>(
        &self,
        rays: &[SceneRay],
        walks: &mut Walks<L>,
        found: &mut Vec<Option<SceneHit>>,
    ) {
        found.clear();
        for rays in rays.chunks(Crowd::<L>::PACKETS * L::COUNT) {
            match &self.placed[..] {
                [only] => self.hits_of_only::<L, LOD>(only, rays, &mut walks.crowd, found),
                _ => {
                    for rays in rays.chunks(L::COUNT) {
                        let hits = self.packet_hits::<L, LOD>(rays, walks);
                        found.extend_from_slice(&hits[..rays.len()]);
                    }
                }
            }
        }
    }

    /// Adds what some rays meet where there is one instance.
    fn hits_of_only<L: Lanes, const LOD: bool>(
        &self,
        only: &Placed<'_>,
        rays: &[SceneRay],
        crowd: &mut Crowd<L>,
        found: &mut Vec<Option<SceneHit>>,
    ) {
        let before = found.len();
        found.extend(rays.iter().map(|ray| self.ground_hit(ray)));
        let found = &mut found[before..];
        let mut packets = Vec::with_capacity(Crowd::<L>::PACKETS);
        let mut placements = Vec::with_capacity(Crowd::<L>::PACKETS);
        for (rays, found) in rays.chunks(L::COUNT).zip(found.chunks(L::COUNT)) {
            let (packet, placed) = only.packet::<L>(0, rays, u32::MAX, found);
            packets.push(packet);
            placements.push(placed);
        }
        let mut passing = Passing::new(only, 0, rays);
        let mut passes = |met: &Met| passing.passes(met);
        let passes = Passing::is_asked_for(0, rays).then_some(&mut passes as &mut Passes<'_>);
        crowd.first_hits::<LOD, false>(&only.target, &packets, passes, |number, hits, place| {
            let found = &mut found[number * L::COUNT..];
            only.keep::<L>(0, &packets[number], &placements[number], hits, place, found);
        });
    }

    fn packet_hits<L: Lanes, const LOD: bool>(
        &self,
        rays: &[SceneRay],
        walks: &mut Walks<L>,
    ) -> [Option<SceneHit>; MAX_LANES] {
        let count = rays.len();
        let mut found = [None; MAX_LANES];
        let mut ends = [0.0; MAX_LANES];
        for (lane, ray) in rays.iter().enumerate() {
            found[lane] = self.ground_hit(ray);
            ends[lane] = found[lane].map_or(ray.end, |hit| hit.distance as f32);
        }
        let Walks { path, stack, .. } = walks;
        let column = |of: &dyn Fn(&SceneRay) -> f32| {
            let mut values = [1.0; MAX_LANES];
            for (value, ray) in values.iter_mut().zip(rays) {
                *value = of(ray);
            }
            L::load(&values)
        };
        let origin = [0, 1, 2].map(|axis| column(&|ray| ray.origin[axis] as f32));
        let direction = [0, 1, 2].map(|axis| column(&|ray| ray.direction[axis]));
        let boxes = BoxRays::<L>::new(origin, direction, L::first(count));
        self.bvh.visit(&boxes, L::load(&ends), stack, |number, lanes| {
            self.placed[number as usize].meet::<L, LOD>(number, rays, lanes, path, &mut found);
            for lane in 0..count {
                if let Some(hit) = &found[lane] {
                    ends[lane] = hit.distance as f32;
                }
            }
            L::load(&ends)
        });
        found
    }

    /// Where a ray meets the ground.
    pub fn ground_hit(&self, ray: &SceneRay) -> Option<SceneHit> {
        let ground = self.scene.ground.as_ref()?;
        if ray.leaving.is_some_and(|leaving| leaving.instance == GROUND) {
            return None;
        }
        let distance = (ground.height - ray.origin.y) / f64::from(ray.direction.y);
        (distance >= 0.0 && distance < f64::from(ray.end)).then_some(SceneHit {
            instance: GROUND,
            node: 0,
            part: 0,
            distance,
            departure: SceneHit::NOWHERE,
        })
    }
}

impl Placed<'_> {
    /// Holds some rays, a bit for each, against the instance, and keeps what is nearer than was found before.
    fn meet<L: Lanes, const LOD: bool>(
        &self,
        number: u32,
        rays: &[SceneRay],
        lanes: u32,
        path: &mut Path<L>,
        found: &mut [Option<SceneHit>; MAX_LANES],
    ) {
        let (packet, placements) = self.packet::<L>(number, rays, lanes, found);
        let (hits, place) = if Passing::is_asked_for(number, rays) {
            let mut passing = Passing::new(self, number, rays);
            trace_past::<L, LOD>(&self.target, &packet, path, 0, &mut |met| passing.passes(met))
        } else {
            trace_to_end::<L, LOD, false>(&self.target, &packet, path)
        };
        self.keep::<L>(number, &packet, &placements, &hits, place, found);
    }

    /// Some rays, a bit for each, in the instance's space, up to what they have met before; and how to read their distances.
    fn packet<L: Lanes>(
        &self,
        number: u32,
        rays: &[SceneRay],
        lanes: u32,
        found: &[Option<SceneHit>],
    ) -> (Packet<L>, [Placement; MAX_LANES]) {
        let mut gathered = Gathered::<L>::new();
        let mut ends = [L::Real::default(); MAX_LANES];
        for (lane, ray) in rays.iter().enumerate().filter(|(lane, _)| lanes >> lane & 1 == 1) {
            let direction = self.placement.direction_to_unit(ray.direction.as_dvec3());
            match &ray.leaving {
                Some(Leaving { instance, from, .. }) if *instance == number => {
                    gathered.put_leaving(lane, from, direction.as_vec3(), self.placement.scale);
                }
                _ => {
                    let origin = self.placement.to_unit(ray.origin);
                    gathered.put(lane, &Ray { origin, direction: direction / self.placement.scale });
                }
            }
            // Of two at the same distance the one with the lower number counts, so the end is just behind.
            let end = found[lane].map_or(f64::from(ray.end), |hit| hit.distance.next_up());
            ends[lane] = gathered.placements[lane].traversed(end);
        }
        let mut packet = gathered.packet();
        packet.lines.end = L::load_reals(&ends);
        (packet, gathered.placements)
    }

    /// Keeps what the rays of a packet have met, where it is nearer than what was found before.
    fn keep<L: Lanes>(
        &self,
        number: u32,
        packet: &Packet<L>,
        placements: &[Placement; MAX_LANES],
        hits: &Hits<L>,
        place: [L::Word; 3],
        found: &mut [Option<SceneHit>],
    ) {
        let hit = L::bitmask(hits.hit);
        if hit == 0 {
            return;
        }
        let departures = Departures::new(self.target.octree, packet, hits, place);
        let (distance, node, part) = (L::reals(hits.distance), L::words(hits.node), L::words(hits.part));
        for lane in (0..L::COUNT).filter(|lane| hit >> lane & 1 == 1) {
            let distance = placements[lane].distance(distance[lane]);
            let is_first =
                found[lane].is_none_or(|before| (distance, number) < (before.distance, before.instance));
            if is_first {
                found[lane] = Some(SceneHit {
                    instance: number,
                    node: node[lane],
                    part: part[lane],
                    distance,
                    departure: departures.of_lane(lane),
                });
            }
        }
    }
}

/// Rays that leave surfaces of an instance: which of its voxels they go past.
struct Passing<'r> {
    placed: &'r Placed<'r>,
    number: u32,
    rays: &'r [SceneRay],
    /// How many voxels each ray has passed.
    passed: [u8; RAYS],
}

/// Voxels of the surface that it leaves that a ray is asked about at the most. One that has passed so many runs along the surface,
/// and nothing of that instance is in its way.
const MOST_PASSED: u8 = 64;

impl<'r> Passing<'r> {
    /// For at most [`RAYS`] rays and the instance of some number.
    fn new(placed: &'r Placed<'r>, number: u32, rays: &'r [SceneRay]) -> Self {
        Self { placed, number, rays, passed: [0; RAYS] }
    }

    /// Whether some of the rays go past voxels of the instance of some number.
    fn is_asked_for(number: u32, rays: &[SceneRay]) -> bool {
        let mut leaving = rays.iter().filter_map(|ray| ray.leaving);
        leaving.any(|leaving| leaving.instance == number && leaving.past.is_some())
    }

    /// Whether a ray goes past a voxel.
    fn passes(&mut self, met: &Met) -> bool {
        let ray = &self.rays[met.ray];
        let Some(Leaving { instance, from, past: Some(tangent) }) = &ray.leaving else { return false };
        if *instance != self.number {
            return false;
        }
        if self.passed[met.ray] == MOST_PASSED {
            return true;
        }
        self.passed[met.ray] += 1;
        let direction = self.placed.placement.direction_to_unit(ray.direction.as_dvec3()).as_vec3();
        tangent.passes(self.placed.target.octree, met, from.point, direction)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::Single;
    use crate::lod::LevelOfDetail;
    use crate::octree::Octree;
    use crate::quality::Leave;
    use crate::surface::Point;
    use crate::{Camera, DEFAULT_FOV};
    use octvox_format::{Palette, SphericalNormal, Voxel, Writer};

    #[test]
    fn a_ray_that_runs_along_its_surface_meets_nothing_of_it() {
        let mut writer = Writer::new(Vec::new(), &Palette::new(vec![[9, 9, 9]]).unwrap()).unwrap();
        let up = Voxel { palette_index: 1, normal: SphericalNormal { theta: 0, phi: 0 } };
        writer.node(up).unwrap();
        for octant in 0..8 {
            writer.leaf(if octant == 0 { up } else { Voxel::EMPTY }).unwrap();
        }
        let octree = Octree::from_bytes(&writer.finish().unwrap()).unwrap();
        let scene = Scene::of_model(&octree, &Camera::framing(&octree, 1.0, DEFAULT_FOV));
        let target = Target { octree: &octree, grid: &octree.grid, lod: LevelOfDetail::EXACT };
        let world = World::new(&scene, std::iter::once(target));

        let (origin, direction) = (DVec3::new(0.25, 0.25, 3.0), Vec3::NEG_Z);
        let from_above = SceneRay { origin, direction, end: f32::INFINITY, leaving: None };
        let mut found = Vec::new();
        world.first_hits::<Single, false>(&[from_above], &mut Walks::new(), &mut found);
        let hit = found[0].unwrap();
        let ray =
            Point::new(&world, &from_above, &hit).leave(Vec3::Z, Vec3::X, f32::INFINITY, Leave::Surface);
        let rays = [ray];

        let [low, high] = hit.departure.voxel;
        let lifted = Vec3::Z * 2.0 * hit.departure.size();
        let of_surface = Met { ray: 0, node: hit.node, part: hit.part, voxel: [low, high], distance: 0.0 };
        let above = Met { voxel: [low + lifted, high + lifted], ..of_surface };
        let mut passing = Passing::new(&world.placed[0], 0, &rays);
        assert!(!passing.passes(&above));
        let mut passing = Passing::new(&world.placed[0], 0, &rays);
        assert!((0..MOST_PASSED).all(|_| passing.passes(&of_surface)));
        assert!(passing.passes(&above));
    }
}
