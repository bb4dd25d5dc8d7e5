//! Light from what rays meet to the eye: what surfaces scatter, mirror and let pass, and the rays that this takes.
//!
//! Rays wait in lists, one for each lamp, one for light from around, one for mirrors and glass, and each list is traced in
//! full packets before the next one is looked at. A ray is only put there if it can change the picture. What a ray brings
//! belongs to the *slot* of the ray from the eye that it stems from. The rays of a slot keep their order whatever others are
//! between them, so a sum of light does not depend on which rays go together.

use crate::color::Light3;
use crate::lanes::Lanes;
use crate::optics::{fresnel, mirrored, refracted, schlick};
use crate::plan::{Plan, effect};
use crate::quality::Quality;
use crate::sampling::{hashed, sample_2d};
use crate::scene::{SurfaceMaterial, across, on_disk};
use crate::surface::{BACK, Point, towards_eye};
use crate::world::{SceneHit, SceneRay, Walks, World};
use glam::Vec3;
use serde::Serialize;

/// Rays sent, by what they are for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct RayCounts {
    /// From the eye.
    pub primary: u64,
    /// To lamps.
    pub shadow: u64,
    /// Into mirrors.
    pub reflection: u64,
    /// Into glass and out of it.
    pub refraction: u64,
    /// All around.
    pub ambient: u64,
}

impl RayCounts {
    /// All rays.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.primary + self.shadow + self.reflection + self.refraction + self.ambient
    }

    pub(crate) fn plus(self, other: Self) -> Self {
        Self {
            primary: self.primary + other.primary,
            shadow: self.shadow + other.shadow,
            reflection: self.reflection + other.reflection,
            refraction: self.refraction + other.refraction,
            ambient: self.ambient + other.ambient,
        }
    }
}

/// How a ray came to a point, and what it brings to the eye.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Arrival {
    /// Number of the ray from the eye.
    pub slot: u32,
    /// The direction of the ray, a unit vector in the scene.
    pub direction: Vec3,
    /// The share of the light from the point that comes to the eye.
    pub weight: Light3,
    /// How often it was mirrored or bent.
    pub bounce: u32,
    /// What the material absorbs that the ray runs through; nothing outside.
    pub inside: Option<Vec3>,
    /// Tells its random numbers from those of others.
    pub seed: u32,
    /// Number of the sample, for points that are spread well over the samples of a pixel.
    pub sample: u32,
}

/// A ray to a lamp or around.
#[derive(Debug, Clone, Copy)]
struct Question {
    ray: SceneRay,
    slot: u32,
    /// What comes to the eye if nothing is in the way.
    light: Light3,
    /// Of a ray around, the share of light from what it meets that comes to the eye.
    share: Light3,
}

/// A ray into a mirror or glass.
#[derive(Debug, Clone, Copy)]
struct Branch {
    ray: SceneRay,
    arrival: Arrival,
}

/// How light goes on from a surface.
struct Onward {
    /// A unit vector.
    direction: Vec3,
    /// The share of the light from there that comes back the way of the ray.
    share: Light3,
    /// What the material absorbs that the ray runs through then.
    inside: Option<Vec3>,
    is_mirrored: bool,
}

/// Room for rays that wait, to be used for one tile after the other.
#[derive(Default)]
pub(crate) struct Queues {
    light: Vec<Light3>,
    to_lamps: Vec<Vec<Question>>,
    around: Vec<Question>,
    branches: Vec<Branch>,
    rays: Vec<SceneRay>,
    hits: Vec<Option<SceneHit>>,
}

/// Follows light for a number of rays from the eye.
pub(crate) struct Transport<'w, L: Lanes> {
    world: &'w World<'w>,
    plan: Plan,
    quality: Quality,
    /// Light that has come to each slot.
    pub light: Vec<Light3>,
    pub counts: RayCounts,
    to_lamps: Vec<Vec<Question>>,
    around: Vec<Question>,
    branches: Vec<Branch>,
    walks: &'w mut Walks<L>,
    rays: Vec<SceneRay>,
    hits: Vec<Option<SceneHit>>,
}

/// Surfaces of glass that a ray to a lamp goes through at the most; behind more of them it is dark.
const MOST_PANES: u32 = 256;

impl<'w, L: Lanes> Transport<'w, L> {
    /// `queues` are empty, as those of [`Transport::finished`] are.
    pub fn new(
        world: &'w World<'w>,
        plan: Plan,
        quality: Quality,
        queues: Queues,
        walks: &'w mut Walks<L>,
    ) -> Self {
        let Queues { light, mut to_lamps, around, branches, rays, hits } = queues;
        to_lamps.resize_with(world.scene.lights.len(), Vec::new);
        let counts = RayCounts::default();
        Self { world, plan, quality, light, counts, to_lamps, around, branches, walks, rays, hits }
    }

    /// The rays sent, and the room that they took, when none waits any more.
    pub fn finished(self) -> (RayCounts, Queues) {
        let Self { counts, light, to_lamps, around, branches, rays, hits, .. } = self;
        (counts, Queues { light, to_lamps, around, branches, rays, hits })
    }

    /// Begins anew with so many slots.
    pub fn begin(&mut self, slots: usize) {
        self.light.clear();
        self.light.resize(slots, Vec3::ZERO);
    }

    /// What rays meet in the scene first, one after the other.
    pub fn first_hits<const LOD: bool>(&mut self, rays: &[SceneRay]) -> &[Option<SceneHit>] {
        self.world.first_hits::<L, LOD>(rays, self.walks, &mut self.hits);
        &self.hits
    }

    /// Adds light that is seen from a slot.
    #[inline(always)]
    pub fn add(&mut self, slot: u32, light: Light3) {
        self.light[slot as usize] += light;
    }

    /// Adds what a point that was met gives off and scatters to the eye, and asks for the rays that this takes.
    #[inline(always)]
    pub fn shade<const EFFECTS: u8>(&mut self, point: &Point<'_>, arrival: &Arrival) {
        let surface = point.surface;
        let to_eye = -arrival.direction;
        let mut scattered = point.diffuse;
        let normal = if EFFECTS == effect::ALL && self.plan.branches() {
            let (normal, share) = self.branch(point, arrival);
            scattered *= share;
            normal
        } else {
            towards_eye(point.normal, to_eye)
        };
        let weight = arrival.weight;
        let mut light = surface.emission;
        if EFFECTS == effect::ALL && self.plan.around() {
            self.ask_around(point, arrival, normal, scattered);
        } else {
            light += self.world.scene.ambient.color * scattered;
        }
        for (number, lamp) in self.world.scene.lights.iter().enumerate() {
            let is_soft = EFFECTS != effect::NONE && lamp.shadow && lamp.is_soft();
            let samples = if is_soft { self.quality.light_samples.max(1) } else { 1 };
            for sample in 0..samples {
                let arriving = if is_soft {
                    let seed = hashed(arrival.seed, number as u32);
                    let chosen = sample_2d(arrival.sample * samples + sample, seed);
                    lamp.arriving_at(point.position.as_vec3(), chosen)
                } else {
                    lamp.middle_at(point.position.as_vec3())
                };
                let facing = normal.dot(arriving.towards);
                if facing <= 0.0 {
                    continue;
                }
                let mut from_lamp = arriving.amount * scattered * facing;
                if surface.specular != Vec3::ZERO {
                    let highlight = (normal * (2.0 * facing) - arriving.towards).dot(to_eye);
                    if highlight > 0.0 {
                        from_lamp +=
                            arriving.amount * surface.specular * power(highlight.min(1.0), surface.shininess);
                    }
                }
                if EFFECTS != effect::NONE && lamp.shadow {
                    let share = weight * from_lamp;
                    if share.max_element() > self.quality.cutoff {
                        let end = arriving.distance;
                        self.counts.shadow += 1;
                        self.to_lamps[number].push(Question {
                            ray: point.leave(normal, arriving.towards, end, self.quality.leave),
                            slot: arrival.slot,
                            light: share / samples as f32,
                            share: Vec3::ZERO,
                        });
                        continue;
                    }
                    from_lamp /= samples as f32;
                }
                light += from_lamp;
            }
        }
        self.add(arrival.slot, weight * light);
    }

    /// Asks for rays all around a point.
    fn ask_around(&mut self, point: &Point<'_>, arrival: &Arrival, normal: Vec3, scattered: Light3) {
        let ambient = &self.world.scene.ambient;
        let samples = self.quality.ambient_samples.max(1);
        let share = arrival.weight * scattered / samples as f32;
        let light = share * ambient.color;
        let brightest = if self.plan.glow { share.max_element() } else { light.max_element() };
        if brightest * samples as f32 <= self.quality.cutoff {
            return self.add(arrival.slot, light * samples as f32);
        }
        let end = if self.plan.glow { f32::INFINITY } else { ambient.occlusion.unwrap_or(f32::INFINITY) };
        let [right, up] = across(normal);
        for sample in 0..samples {
            // As likely as light from there counts: even on the disk below the hemisphere (Malley's method).
            let seed = hashed(arrival.seed, u32::MAX);
            let place = on_disk(sample_2d(arrival.sample * samples + sample, seed));
            let above = (1.0 - place.length_squared()).max(0.0).sqrt().max(1e-3);
            let direction = (right * place.x + up * place.y + normal * above).normalize();
            self.counts.ambient += 1;
            self.around.push(Question {
                ray: point.leave(normal, direction, end, self.quality.leave),
                slot: arrival.slot,
                light,
                share,
            });
        }
    }

    /// Asks for the rays into a mirror or glass. Gives the normal on the side of the ray, and the share of light that the
    /// surface scatters.
    fn branch(&mut self, point: &Point<'_>, arrival: &Arrival) -> (Vec3, Light3) {
        let surface = point.surface;
        let to_eye = -arrival.direction;
        let facing = point.normal.dot(to_eye);
        if !surface.is_transparent() {
            let normal = towards_eye(point.normal, to_eye);
            let share = schlick(normal.dot(to_eye), surface.reflectivity);
            self.mirror(point, arrival, normal, share);
            return (normal, Vec3::ONE - share);
        }
        // Which side the ray comes from, the normal tells, unless it is at a silhouette; then it is the side that it is on.
        let enters = if facing.abs() < -BACK { arrival.inside.is_none() } else { facing > 0.0 };
        let outward = if enters { point.normal } else { -point.normal };
        let normal = towards_eye(outward, to_eye);
        let cosine = normal.dot(to_eye);
        let ratio = if enters { 1.0 / surface.refraction_index } else { surface.refraction_index };
        let share = schlick(cosine, surface.reflectivity).max(Vec3::splat(fresnel(cosine, ratio)));
        // What is hardly transparent is no glass but cloth, and mirrors as little; at grazing angles all mirrors.
        self.mirror(point, arrival, normal, share * surface.transparency.max(share.max_element()));
        let passing = (Vec3::ONE - share) * surface.transparency;
        if let Some(direction) = refracted(arrival.direction, normal, ratio) {
            let inside = enters.then_some(surface.absorption);
            let onward = Onward { direction, share: passing, inside, is_mirrored: false };
            self.send(point, arrival, normal, &onward);
        }
        (normal, (Vec3::ONE - share) * (1.0 - surface.transparency))
    }

    fn mirror(&mut self, point: &Point<'_>, arrival: &Arrival, normal: Vec3, share: Light3) {
        let direction = mirrored(arrival.direction, normal);
        let onward = Onward { direction, share, inside: arrival.inside, is_mirrored: true };
        self.send(point, arrival, normal, &onward);
    }

    /// Asks for a ray that brings a share of what it sees, unless that cannot be noticed.
    fn send(&mut self, point: &Point<'_>, arrival: &Arrival, normal: Vec3, onward: &Onward) {
        let Onward { direction, share, inside, is_mirrored } = *onward;
        let weight = arrival.weight * share;
        if weight.max_element() <= self.quality.cutoff || arrival.bounce >= self.quality.bounces {
            return;
        }
        let side = if normal.dot(direction) >= 0.0 { normal } else { -normal };
        if is_mirrored {
            self.counts.reflection += 1;
        } else {
            self.counts.refraction += 1;
        }
        self.branches.push(Branch {
            ray: point.leave(side, direction, f32::INFINITY, self.quality.leave),
            arrival: Arrival {
                direction,
                weight,
                bounce: arrival.bounce + 1,
                inside,
                seed: hashed(arrival.seed, u32::from(is_mirrored) << 16 | arrival.bounce),
                ..*arrival
            },
        });
    }

    /// Traces all rays that wait, and those that come of them.
    pub fn finish<const EFFECTS: u8, const LOD: bool>(&mut self) {
        loop {
            if EFFECTS != effect::NONE {
                for number in 0..self.to_lamps.len() {
                    let mut questions = std::mem::take(&mut self.to_lamps[number]);
                    self.see_lamp::<LOD>(number, &mut questions);
                    questions.clear();
                    self.to_lamps[number] = questions;
                }
            }
            if EFFECTS == effect::ALL {
                let mut questions = std::mem::take(&mut self.around);
                self.see_around::<LOD>(&questions);
                questions.clear();
                self.around = questions;
            }
            if EFFECTS != effect::ALL || self.branches.is_empty() {
                return;
            }
            let branches = std::mem::take(&mut self.branches);
            self.follow::<LOD>(branches.iter().map(|branch| branch.ray));
            let hits = std::mem::take(&mut self.hits);
            for (branch, hit) in branches.iter().zip(&hits) {
                self.arrive::<EFFECTS>(branch, hit.as_ref());
            }
            self.hits = hits;
        }
    }

    /// What a ray out of a mirror or glass brings.
    fn arrive<const EFFECTS: u8>(&mut self, branch: &Branch, hit: Option<&SceneHit>) {
        let mut arrival = branch.arrival;
        let Some(hit) = hit else {
            let seen = self.world.scene.background.towards(arrival.direction);
            return self.add(arrival.slot, arrival.weight * seen);
        };
        if let Some(absorption) = arrival.inside {
            arrival.weight *= left_after(absorption, hit.distance);
        }
        let point = Point::new(self.world, &branch.ray, hit);
        self.shade::<EFFECTS>(&point, &arrival);
    }

    /// Adds the light of those rays to a lamp that nothing is in the way of. What lets light pass dims and tints it.
    fn see_lamp<const LOD: bool>(&mut self, lamp: usize, questions: &mut Vec<Question>) {
        // Of a lamp with an extent, a ray brings one share of several.
        let is_soft = self.world.scene.lights[lamp].is_soft();
        let rays = if is_soft { self.quality.light_samples.max(1) } else { 1 };
        for _ in 0..MOST_PANES {
            if questions.is_empty() {
                return;
            }
            self.follow::<LOD>(questions.iter().map(|question| question.ray));
            let hits = std::mem::take(&mut self.hits);
            let mut place = 0;
            for (number, hit) in hits.iter().enumerate() {
                let Some(hit) = hit else {
                    let Question { slot, light, .. } = questions[number];
                    self.add(slot, light);
                    continue;
                };
                if !self.plan.refraction {
                    continue;
                }
                let mut question = questions[number];
                let point = Point::new(self.world, &question.ray, hit);
                let cosine = point.normal.dot(question.ray.direction);
                question.light *= passing(point.surface, cosine);
                // It comes out on the side to which the surface faces: so far it was inside.
                if cosine > 0.0 {
                    question.light *= left_after(point.surface.absorption, hit.distance);
                }
                if question.light.max_element() * rays as f32 > self.quality.cutoff {
                    let normal = point.normal;
                    let direction = question.ray.direction;
                    let side = if normal.dot(direction) >= 0.0 { normal } else { -normal };
                    let end = question.ray.end - hit.distance as f32;
                    question.ray = point.leave(side, direction, end, self.quality.leave);
                    questions[place] = question;
                    place += 1;
                }
            }
            questions.truncate(place);
            self.hits = hits;
        }
    }

    /// Adds the light that comes from around.
    fn see_around<const LOD: bool>(&mut self, questions: &[Question]) {
        self.follow::<LOD>(questions.iter().map(|question| question.ray));
        let hits = std::mem::take(&mut self.hits);
        let occlusion = self.world.scene.ambient.occlusion;
        for (question, hit) in questions.iter().zip(&hits) {
            let Some(hit) = hit else {
                self.add(question.slot, question.light);
                continue;
            };
            if self.plan.glow {
                let away = hit.distance;
                if occlusion.is_none_or(|distance| away > f64::from(distance)) {
                    self.add(question.slot, question.light);
                }
                let point = Point::new(self.world, &question.ray, hit);
                self.add(question.slot, question.share * point.surface.emission);
            }
        }
        self.hits = hits;
    }

    /// Finds what rays meet beyond the surfaces that they leave: `self.hits`, one for each.
    fn follow<const LOD: bool>(&mut self, rays: impl Iterator<Item = SceneRay>) {
        self.rays.clear();
        self.rays.extend(rays);
        self.world.first_hits::<L, LOD>(&self.rays, self.walks, &mut self.hits);
    }
}

/// The share of light that is left after a way through a material (Beer and Lambert).
fn left_after(absorption: Vec3, distance: f64) -> Light3 {
    if absorption == Vec3::ZERO {
        return Vec3::ONE;
    }
    Vec3::from_array((absorption * -(distance as f32)).to_array().map(libm::expf))
}

/// The share of light that passes a surface straight on. `cosine` is that of the angle between ray and normal.
fn passing(surface: &SurfaceMaterial, cosine: f32) -> Light3 {
    if !surface.is_transparent() {
        return Vec3::ZERO;
    }
    let cosine = cosine.abs();
    let mirrored = schlick(cosine, surface.reflectivity)
        .max(Vec3::splat(fresnel(cosine, 1.0 / surface.refraction_index.max(1.0))));
    (Vec3::ONE - mirrored) * surface.transparency
}

/// A power of a number in [0, 1]; whole ones by squaring.
fn power(base: f32, exponent: f32) -> f32 {
    if exponent.fract() != 0.0 || exponent >= 1e6 {
        return libm::powf(base, exponent);
    }
    let mut rest = exponent as u32;
    if rest == 0 {
        return 1.0;
    }
    // Most exponents are powers of two, and have nothing to multiply.
    let mut square = base;
    while rest & 1 == 0 {
        square *= square;
        rest >>= 1;
    }
    let mut result = square;
    while rest > 1 {
        square *= square;
        rest >>= 1;
        if rest & 1 == 1 {
            result *= square;
        }
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_by_squaring() {
        assert_eq!(power(0.5, 5.0), 0.031_25);
        assert_eq!([power(0.7, 0.0), power(0.7, 1.0), power(0.0, 3.0)], [1.0, 0.7, 0.0]);
        for exponent in 0..200 {
            let expected = 0.97f64.powi(exponent);
            assert!((f64::from(power(0.97, exponent as f32)) / expected - 1.0).abs() < 1e-5, "{exponent}");
        }
        assert!((power(0.7, 2.5) - 0.7f32.powf(2.5)).abs() < 1e-6);
    }
}
