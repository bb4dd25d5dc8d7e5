//! Points of surfaces, and the surfaces that rays leave.

use crate::color::Light3;
use crate::departure::Departure;
use crate::octree::Octree;
use crate::passing::Met;
use crate::quality::Leave;
use crate::scene::SurfaceMaterial;
use crate::smoothing;
use crate::world::{GROUND, Leaving, SceneHit, SceneRay, World};
use glam::{DVec3, Vec3};

/// A point that a ray met.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Point<'s> {
    /// The number of its instance, or [`GROUND`].
    instance: u32,
    departure: Departure,
    /// In the scene.
    pub position: DVec3,
    /// Unit vector in the scene, as it is stored.
    pub normal: Vec3,
    /// The same in the instance's unit space.
    unit_normal: Vec3,
    /// The edge of the instance's cube in the scene.
    scale: f32,
    pub surface: &'s SurfaceMaterial,
    /// What it scatters: that of the surface, or a mean about the point.
    pub diffuse: Light3,
}

impl<'s> Point<'s> {
    /// What a ray met.
    #[inline(always)]
    pub fn new(world: &'s World<'s>, ray: &SceneRay, hit: &SceneHit) -> Self {
        let position = ray.origin + ray.direction.as_dvec3() * hit.distance;
        if hit.instance == GROUND {
            return Self::of_ground(world, position, hit);
        }
        let placed = &world.placed[hit.instance as usize];
        let payload = placed.target.octree.payload_of(hit.node, hit.part);
        let unit_normal = Vec3::from_array(payload.normal().decode());
        let entry = usize::from(payload.palette_index()).wrapping_sub(1);
        let surface = placed.model.surfaces.get(entry).unwrap_or(&SurfaceMaterial::BLACK);
        Self {
            instance: hit.instance,
            departure: hit.departure,
            position,
            normal: placed.placement.direction_to_scene(unit_normal),
            unit_normal,
            scale: placed.placement.scale as f32,
            surface,
            diffuse: surface.diffuse,
        }
    }

    #[cold]
    fn of_ground(world: &'s World<'s>, position: DVec3, hit: &SceneHit) -> Self {
        let surface = world.scene.ground.as_ref().map_or(&SurfaceMaterial::BLACK, |ground| {
            let square = |coordinate: f64| (coordinate / ground.square).floor().rem_euclid(2.0);
            &ground.surfaces[usize::from(square(position.x) != square(position.z))]
        });
        Self {
            instance: GROUND,
            departure: hit.departure,
            position,
            normal: Vec3::Y,
            unit_normal: Vec3::Y,
            scale: 1.0,
            surface,
            diffuse: surface.diffuse,
        }
    }

    /// The point on the smooth surface of which the voxel that a ray met is a sample, and how much farther on the ray that
    /// is; nothing if the ray passes it by. Voxels that stand for more than a finest cell stay as they are.
    pub fn smoothed(mut self, world: &World<'_>, ray: &SceneRay) -> Option<(Self, f64)> {
        if self.instance == GROUND {
            return Some((self, 0.0));
        }
        let placed = &world.placed[self.instance as usize];
        let octree = placed.target.octree;
        let size = f64::from(octree.resolution());
        if f64::from(self.departure.size()) * size > 1.0 {
            return Some((self, 0.0));
        }
        let cell = (self.departure.middle().as_dvec3() - 1.0) * size;
        let cell = cell.to_array().map(|coordinate| coordinate as u32);
        let direction = placed.placement.direction_to_unit(ray.direction.as_dvec3()).as_vec3();
        let point = self.departure.point.as_dvec3() - 1.0;
        let surfaces = &placed.model.surfaces;
        let hit = smoothing::meet(octree, surfaces, cell, point, direction, self.unit_normal)?;
        let beyond = hit.beyond * placed.placement.scale;
        self.position += ray.direction.as_dvec3() * beyond;
        self.unit_normal = hit.normal;
        self.normal = placed.placement.direction_to_scene(hit.normal);
        self.diffuse = hit.diffuse;
        Some((self, beyond))
    }

    /// The octree level of the voxel; 0 on the ground.
    pub fn level(&self) -> u8 {
        // An edge is a power of two, one of a place that is none is zero.
        let size = self.departure.size();
        if size > 0.0 { (-libm::ilogbf(size)).clamp(0, 255) as u8 } else { 0 }
    }

    /// The edge of the voxel in the scene; zero on the ground.
    pub fn voxel_size(&self) -> f64 {
        if self.instance == GROUND { 0.0 } else { f64::from(self.departure.size() * self.scale) }
    }

    /// A ray that leaves the point on the side of a normal, which is the point's own or nearly so.
    #[inline(always)]
    pub fn leave(&self, side: Vec3, direction: Vec3, end: f32, how: Leave) -> SceneRay {
        let voxel = Leaving { instance: self.instance, from: self.departure, past: None };
        let ray = SceneRay { origin: self.position, direction, end, leaving: Some(voxel) };
        match how {
            _ if self.instance == GROUND => ray,
            Leave::Surface => {
                let is_front = self.normal.dot(side) >= 0.0;
                let past = Some(Tangent::new(&self.departure, self.unit_normal, is_front));
                SceneRay { leaving: Some(Leaving { past, ..voxel }), ..ray }
            }
            Leave::Voxel => ray,
            Leave::Raised => {
                let height = RAISED * self.departure.size() * self.scale;
                let origin = self.position + (side * height).as_dvec3();
                SceneRay { origin, leaving: None, ..ray }
            }
        }
    }
}

/// How far origins are raised, in edges of a voxel, where they are.
const RAISED: f32 = 1.5;

/// The tangent plane of a surface where a ray leaves it: tells voxels that are part of the same surface from others.
///
/// Scan conversion fills a voxel if the surface cuts one of the axis-parallel segments through its middle. So the plane is
/// no farther from the middle than half an edge times the largest component of the unit normal, and the middles of two
/// voxels of one plane differ in height by that component at the most. What lies higher is something else, or the surface has
/// bent upwards there; which of them, the ray tells. What faces elsewhere is in the way.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tangent {
    /// The middle of the voxel, in the traversal's space.
    middle: Vec3,
    /// On the side to which the ray leaves.
    normal: Vec3,
    /// What makes normals of voxels those on that side: 1 or −1.
    side: f32,
    /// Half the voxel's edge.
    half: f32,
}

/// What is added to the height up to which voxels are part of the surface, in edges: for surfaces that bend, and normals
/// that are means over a voxel.
const SLACK: f32 = 0.5;

/// What is added for each edge that two voxels are apart: normals are coded to 0.8°, and are those of vertices between
/// facets, which turn by some more.
const SLOPE: f32 = 0.03;

/// How steeply a ray may run to a surface, and still graze it: the cosine of its angle with the normal. One that rises from the
/// next step of the surface, no more than an edge too high, may be steeper: it has not come from below.
const GRAZING: f32 = 0.25;

/// How far below the plane through a voxel's middle such a ray may come in, in edges times the largest component of the unit
/// normal: the surface is somewhere within half of that on either side. A ray straight through a thin wall comes from half an
/// edge below, and is not let through.
const DIP: f32 = 0.3;

/// The least cosine of the angle between the normals of voxels of one surface.
const ALIKE: f32 = 0.5;

impl Tangent {
    fn new(departure: &Departure, front: Vec3, is_front: bool) -> Self {
        let side = if is_front { 1.0 } else { -1.0 };
        Self { middle: departure.middle(), normal: front * side, side, half: departure.size() / 2.0 }
    }

    /// Whether a voxel that a ray has met is part of the surface, and not in its way. `origin` is where the ray leaves the
    /// surface, `direction` a unit vector, both in the traversal's space.
    pub fn passes(&self, octree: &Octree, met: &Met, origin: Vec3, direction: Vec3) -> bool {
        let normal = Vec3::from_array(octree.payload_of(met.node, met.part).normal().decode()) * self.side;
        let alike = normal.dot(self.normal);
        if alike.abs() < ALIKE {
            return false;
        }
        let [low, high] = met.voxel;
        let point = (origin + direction * met.distance).clamp(low, high);
        let there = Departure { point, voxel: met.voxel };
        let (middle, size) = (there.middle(), there.size());
        let offset = middle - self.middle;
        let edges = self.half + size / 2.0;
        let highest = edges * (self.normal.abs().max_element() + SLACK) + SLOPE * offset.length();
        let height = self.normal.dot(offset);
        if height <= highest {
            return true;
        }
        // The surface has bent upwards. Its voxel is a piece of the plane through its middle: not in the way of a ray that stays
        // above that, from where it enters the voxel to where it leaves it.
        let above = |point: Vec3| normal.dot(point - middle);
        let rise = normal.dot(direction);
        let (steepest, lowest) = if rise > 0.0 && height <= highest + size {
            (1.0, -DIP * normal.abs().max_element() * size)
        } else {
            (GRAZING, 0.0)
        };
        alike > 0.0 && rise.abs() <= steepest && above(point) >= lowest && above(there.exit(direction)) >= 0.0
    }
}

/// The cosine beyond which a normal that faces away from the eye means the back of an open surface.
///
/// A voxel's normal is a mean over its cell and coded in 16 bits, so at a silhouette it may face away a little.
pub(crate) const BACK: f32 = -0.25;

/// The normal on the side of the surface that the eye sees: both sides look alike.
pub(crate) fn towards_eye(normal: Vec3, to_eye: Vec3) -> Vec3 {
    let facing = normal.dot(to_eye);
    if facing >= 0.0 {
        normal
    } else if facing < BACK {
        -normal
    } else {
        // At a silhouette: turned until it just faces the eye.
        (normal - to_eye * facing).normalize_or(to_eye)
    }
}
