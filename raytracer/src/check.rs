//! The fast traversal held against the exact one, ray by ray.

use crate::arithmetic::Arithmetic;
use crate::cast::{Effort, Hit, cast};
use crate::enclosure::Enclosure;
use crate::octree::Octree;
use crate::oracle::{ExactHit, LATTICE_BITS, LatticeRay, first_hit};
use crate::picture_check::check_pictures;
use crate::random::Random;
use crate::ray::Ray;
use crate::width::{Width, with_lanes};
use rayon::prelude::*;
use serde::Serialize;
use std::cmp::Ordering;

/// What to check.
#[derive(Debug, Clone, PartialEq)]
pub struct CheckOptions {
    /// Number of rays.
    pub rays: u64,
    /// Where the random numbers begin.
    pub seed: u64,
    /// How precisely rays are followed.
    pub arithmetic: Arithmetic,
    /// Widths that must agree; with [`Arithmetic::Double`] there is one, whatever is here.
    pub widths: Vec<Width>,
}

impl Default for CheckOptions {
    /// A million rays in single precision by all widths.
    fn default() -> Self {
        Self { rays: 1_000_000, seed: 1, arithmetic: Arithmetic::Single, widths: Width::ALL.to_vec() }
    }
}

impl CheckOptions {
    /// The widths that there are in the arithmetic.
    fn widths(&self) -> &[Width] {
        match self.arithmetic {
            Arithmetic::Single => &self.widths,
            Arithmetic::Double => &[Width::Eight],
        }
    }
}

/// What a check found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CheckReport {
    /// How precisely rays were followed.
    pub arithmetic: Arithmetic,
    /// Rays followed by every width and by the exact walk.
    pub rays: u64,
    /// Widths compared.
    pub widths: Vec<u32>,
    /// Rays on which the widths disagree in a bit.
    pub width_differences: u64,
    /// Rays whose voxel is not that of the exact walk. With [`Arithmetic::Double`] there must be none.
    pub differences: u64,
    /// Differences that the bound on the rounding error does not explain.
    pub mismatches: u64,
    /// Rays that cross a closed surface unseen; nothing if the model encloses no space.
    pub leaks: Option<u64>,
    /// Rays that began or were aimed inside a closed surface.
    pub enclosed_rays: u64,
    /// The most cells that a ray visited.
    pub max_steps: u32,
    /// Rays that were stopped by the bound on the number of steps.
    pub guard_hits: u64,
    /// The largest error of a distance, in voxels, among the rays whose voxel is that of the exact walk.
    pub max_distance_error: f64,
    /// The ray to look at first, by its number, see [`crate::replay`]: one of those that must not be, or else the one with the
    /// largest error of its distance. Nothing, if no distance could be compared.
    pub worst_ray: Option<u64>,
    /// Rays through the pixels of pictures, followed by every width, with beams and without.
    pub picture_rays: u64,
    /// Of those, the ones that do not see the same, to the last bit.
    pub picture_differences: u64,
}

impl CheckReport {
    /// Whether nothing was found that must not be.
    #[must_use]
    pub fn is_right(&self) -> bool {
        let to_the_exact = match self.arithmetic {
            Arithmetic::Single => self.mismatches,
            Arithmetic::Double => self.differences,
        };
        let differences = self.width_differences + to_the_exact + self.picture_differences;
        differences + self.leaks.unwrap_or(0) + self.guard_hits == 0
    }
}

/// Rays that are followed together.
const BATCH: u64 = 1 << 12;

/// Cells between a point that counts as inside and the surface : a ray that begins in a cell cut
/// by the surface may already be beyond it.
const CLEARANCE: u32 = 2;

/// Follows random rays by every width and by the exact walk.
///
/// The rays are of five kinds in turn: between random points about the cube; along an axis or a diagonal; from a
/// plane of the lattice; from within a closed surface outwards; from outside to a point within. Then as many rays again
/// through the pixels of pictures, the last of which is completed. `progress` is told of each batch of rays done, twice as
/// many as asked for in all.
pub fn check(octree: &Octree, options: &CheckOptions, progress: impl Fn(u64) + Sync) -> CheckReport {
    let targets = Targets::new(octree, options.seed);
    let has_inside = targets.has_inside;
    let batches = options.rays.div_ceil(BATCH);
    let empty = Findings::default();
    let findings = (0..batches)
        .into_par_iter()
        .map(|batch| {
            let rays = batch * BATCH..options.rays.min((batch + 1) * BATCH);
            let count = rays.end - rays.start;
            let findings = check_batch(&targets, options, rays);
            progress(count);
            findings
        })
        .reduce(|| empty, Findings::plus);
    let pictures =
        check_pictures(octree, options.rays, options.seed, options.arithmetic, options.widths(), progress);
    CheckReport {
        arithmetic: options.arithmetic,
        rays: options.rays,
        widths: options.widths().iter().map(|width| width.lanes()).collect(),
        width_differences: findings.width_differences,
        differences: findings.differences,
        mismatches: findings.mismatches,
        leaks: has_inside.then_some(findings.leaks),
        enclosed_rays: findings.enclosed_rays,
        max_steps: findings.max_steps,
        guard_hits: findings.guard_hits,
        max_distance_error: findings.max_distance_error,
        worst_ray: findings.worst.map(|worst| worst.index),
        picture_rays: pictures.rays,
        picture_differences: pictures.differences,
    }
}

#[derive(Debug, Clone, Copy, Default)]
struct Findings {
    width_differences: u64,
    differences: u64,
    mismatches: u64,
    leaks: u64,
    enclosed_rays: u64,
    max_steps: u32,
    guard_hits: u64,
    max_distance_error: f64,
    worst: Option<Worst>,
}

/// How bad a ray is.
#[derive(Debug, Clone, Copy)]
struct Worst {
    index: u64,
    /// Whether it must not be.
    is_wrong: bool,
    distance_error: f64,
}

impl Worst {
    /// The worse of two; of two alike, the one that comes first.
    fn worse(self, other: Self) -> Self {
        let badness = |ray: &Self| (ray.is_wrong, ray.distance_error);
        match badness(&self).partial_cmp(&badness(&other)) {
            Some(Ordering::Less) => other,
            Some(Ordering::Equal) if other.index < self.index => other,
            _ => self,
        }
    }
}

impl Findings {
    /// Adds a ray.
    fn add(&mut self, index: u64, probe: &Probe, effort: Effort, verdict: &Verdict) {
        self.width_differences += u64::from(verdict.widths_differ);
        self.differences += u64::from(verdict.is_other_voxel);
        self.mismatches += u64::from(verdict.is_mismatch);
        self.leaks += u64::from(verdict.leaks);
        self.enclosed_rays += u64::from(probe.crosses_before.is_some());
        self.max_steps = self.max_steps.max(effort.steps);
        self.guard_hits += u64::from(effort.guarded);
        let distance_error = verdict.distance_error.unwrap_or(0.0);
        self.max_distance_error = self.max_distance_error.max(distance_error);
        if verdict.is_wrong() || verdict.distance_error.is_some() {
            let ray = Worst { index, is_wrong: verdict.is_wrong(), distance_error };
            self.worst = Some(self.worst.map_or(ray, |worst| worst.worse(ray)));
        }
    }

    fn plus(self, other: Self) -> Self {
        Self {
            width_differences: self.width_differences + other.width_differences,
            differences: self.differences + other.differences,
            mismatches: self.mismatches + other.mismatches,
            leaks: self.leaks + other.leaks,
            enclosed_rays: self.enclosed_rays + other.enclosed_rays,
            max_steps: self.max_steps.max(other.max_steps),
            guard_hits: self.guard_hits + other.guard_hits,
            max_distance_error: self.max_distance_error.max(other.max_distance_error),
            worst: self.worst.into_iter().chain(other.worst).reduce(Worst::worse),
        }
    }
}

/// A ray, and what must not happen to it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Probe {
    pub ray: LatticeRay,
    /// A closed surface is crossed before this distance.
    pub crosses_before: Option<f64>,
}

fn check_batch(targets: &Targets<'_>, options: &CheckOptions, indices: std::ops::Range<u64>) -> Findings {
    let octree = targets.octree;
    let numbers = indices.clone();
    let probes: Vec<Probe> = indices.map(|index| targets.probe(options.seed, index)).collect();
    let rays: Vec<Ray> = probes.iter().map(|probe| probe.ray.to_ray()).collect();

    let mut first: Vec<(Option<Hit>, Effort)> = Vec::new();
    let mut differs = vec![false; rays.len()];
    for (number, &width) in options.widths().iter().enumerate() {
        let found = follow(octree, &rays, options.arithmetic, width);
        if number == 0 {
            first = found;
            continue;
        }
        for (differs, (other, reference)) in differs.iter_mut().zip(found.iter().zip(&first)) {
            *differs |= !is_same(other, reference);
        }
    }

    let mut findings = Findings::default();
    for (((index, probe), found), widths_differ) in numbers.zip(&probes).zip(&first).zip(differs) {
        let verdict = Verdict::new(octree, probe, found, widths_differ, options.arithmetic);
        findings.add(index, probe, found.1, &verdict);
    }
    findings
}

/// What each ray hits, `width` at a time.
pub(crate) fn follow(
    octree: &Octree,
    rays: &[Ray],
    arithmetic: Arithmetic,
    width: Width,
) -> Vec<(Option<Hit>, Effort)> {
    let mut found = Vec::with_capacity(rays.len());
    with_lanes!(arithmetic, width, L => cast::<L, true>(octree, rays, |hit, effort| found.push((hit, effort))));
    found
}

/// Whether two widths found the same, to the last bit.
pub(crate) fn is_same(a: &(Option<Hit>, Effort), b: &(Option<Hit>, Effort)) -> bool {
    same_bits(a.0, b.0) && a.1 == b.1
}

/// What is to be said of a ray.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Verdict {
    arithmetic: Arithmetic,
    /// What the exact walk hits.
    pub exact: Option<ExactHit>,
    /// Whether the widths do not agree in every bit.
    pub widths_differ: bool,
    /// Whether a closed surface was crossed unseen.
    pub leaks: bool,
    /// Whether the bound on the number of steps stopped it.
    pub is_guarded: bool,
    /// Whether its voxel is not that of the exact walk.
    pub is_other_voxel: bool,
    /// Whether the bound on the rounding error does not explain that.
    pub is_mismatch: bool,
    /// The error of its distance in voxels, if the voxel is the same.
    pub distance_error: Option<f64>,
}

impl Verdict {
    pub fn new(
        octree: &Octree,
        probe: &Probe,
        (hit, effort): &(Option<Hit>, Effort),
        widths_differ: bool,
        arithmetic: Arithmetic,
    ) -> Self {
        let exact = first_hit(octree, &probe.ray, |_| true);
        let mut verdict = Self {
            arithmetic,
            exact,
            widths_differ,
            leaks: probe.crosses_before.is_some_and(|limit| hit.is_none_or(|hit| hit.distance > limit)),
            is_guarded: effort.guarded,
            is_other_voxel: false,
            is_mismatch: false,
            distance_error: None,
        };
        match (hit, exact) {
            (None, None) => {}
            (Some(hit), Some(exact)) if contains(hit, exact.cell) => {
                let voxels = f64::from(octree.resolution()) * length(&probe.ray);
                verdict.distance_error = Some((hit.distance - exact.distance).abs() * voxels);
            }
            _ => {
                verdict.is_other_voxel = true;
                verdict.is_mismatch = !is_explained(octree, &probe.ray, hit.as_ref());
            }
        }
        verdict
    }

    /// Whether it must not be.
    pub fn is_wrong(&self) -> bool {
        let is_inexact = self.arithmetic == Arithmetic::Double && self.is_other_voxel;
        self.widths_differ || self.leaks || self.is_guarded || self.is_mismatch || is_inexact
    }
}

fn same_bits(a: Option<Hit>, b: Option<Hit>) -> bool {
    a == b && a.map(|hit| hit.distance.to_bits()) == b.map(|hit| hit.distance.to_bits())
}

/// Whether a finest cell is the hit one, or one of those it stands for.
fn contains(hit: &Hit, cell: [u32; 3]) -> bool {
    (0..3).all(|axis| cell[axis] >> hit.size_log2 == hit.cell[axis] >> hit.size_log2)
}

fn length(ray: &LatticeRay) -> f64 {
    ray.to_ray().direction.length()
}

/// How far a ray in single precision may be from the exact one, per axis, in unit space.
///
/// With u = 2⁻²⁴, the rounding error of one operation, the distance to a plane is off by 2u of itself: a reciprocal and a
/// product (the difference before it is exact on the lattice). A cell that is visited although the exact ray misses it has
/// a plane of entry that is farther than one of exit by no more than 4u of the distance. In that time the ray moves by 4u
/// of its way along an axis, and ways are at most 4.
pub const DISPLACEMENT: f64 = 4.0 * 4.0 / 16_777_216.0;

/// Whether a rounding error of [`DISPLACEMENT`] explains what was hit: the exact ray comes that close to it, and cuts
/// each filled cell before it no deeper.
fn is_explained(octree: &Octree, ray: &LatticeRay, hit: Option<&Hit>) -> bool {
    let size = f64::from(octree.resolution());
    let exact = ray.to_ray();
    let reached = match hit {
        None => f64::INFINITY,
        Some(hit) => {
            let low = hit.cell.map(|coordinate| f64::from(coordinate) / size);
            let side = f64::from(1u32 << hit.size_log2) / size;
            match crossing(&exact, low, side, DISPLACEMENT) {
                Some([enter, _]) => enter,
                None => return false,
            }
        }
    };
    let cut_deeper = first_hit(octree, ray, |found: &ExactHit| {
        let low = found.cell.map(|coordinate| f64::from(coordinate) / size);
        crossing(&exact, low, 1.0 / size, -DISPLACEMENT).is_some()
    });
    let same = |found: &ExactHit| hit.is_some_and(|hit| contains(hit, found.cell));
    cut_deeper.is_none_or(|found| same(&found) || found.distance >= reached)
}

/// The part of a ray within a cube that is grown by `margin` on all sides.
fn crossing(ray: &Ray, low: [f64; 3], side: f64, margin: f64) -> Option<[f64; 2]> {
    let (mut enter, mut leave) = (0.0f64, f64::INFINITY);
    for axis in 0..3 {
        let (origin, direction) = (ray.origin[axis], ray.direction[axis]);
        let (low, high) = (low[axis] - margin, low[axis] + side + margin);
        if direction == 0.0 {
            if !(low..=high).contains(&origin) {
                return None;
            }
            continue;
        }
        let (a, b) = ((low - origin) / direction, (high - origin) / direction);
        enter = enter.max(a.min(b));
        leave = leave.min(a.max(b));
    }
    (enter <= leave).then_some([enter, leave])
}

/// Where probes go.
pub(crate) struct Targets<'a> {
    octree: &'a Octree,
    enclosure: Enclosure,
    /// Whether a point well inside a closed surface can be found.
    has_inside: bool,
}

/// Lattice units of the cube's side.
const UNIT: i32 = 1 << LATTICE_BITS;

impl<'a> Targets<'a> {
    pub fn new(octree: &'a Octree, seed: u64) -> Self {
        let mut targets = Self { octree, enclosure: Enclosure::new(octree), has_inside: false };
        let is_inside = |index| targets.inside(&mut Random::stream(!seed, index)).is_some();
        targets.has_inside = (0..4096).any(is_inside);
        targets
    }

    /// A point of the lattice well inside a closed surface, if a few tries find one.
    fn inside(&self, random: &mut Random) -> Option<[i32; 3]> {
        let bounds = self.octree.bounds();
        let units = UNIT >> self.octree.depth().min(LATTICE_BITS as u8);
        (0..64).find_map(|_| {
            let point = std::array::from_fn(|axis| {
                let [low, high] = [bounds.low[axis], bounds.high[axis]].map(|cell| cell as i32);
                random.between(low.saturating_mul(units), high.saturating_mul(units).max(1))
            });
            self.is_well_inside(point).then_some(point)
        })
    }

    fn is_well_inside(&self, point: [i32; 3]) -> bool {
        let shift = LATTICE_BITS as i32 - i32::from(self.octree.depth());
        if shift < 0 {
            return false;
        }
        let cell = point.map(|part| part >> shift);
        let around = -(CLEARANCE as i32)..=CLEARANCE as i32;
        let coordinates = |at: i32| around.clone().map(move |offset| at + offset);
        coordinates(cell[0]).all(|x| {
            coordinates(cell[1]).all(|y| {
                coordinates(cell[2]).all(|z| {
                    [x, y, z].iter().all(|&coordinate| coordinate >= 0)
                        && self.enclosure.is_inside(self.octree, [x, y, z].map(|part| part as u32))
                })
            })
        })
    }

    /// The ray with a number.
    pub fn probe(&self, seed: u64, index: u64) -> Probe {
        self.probe_of(seed, index, if self.has_inside { 5 } else { 3 })
    }

    /// The ray with a number, of so many kinds.
    fn probe_of(&self, seed: u64, index: u64, kinds: u64) -> Probe {
        let random = &mut Random::stream(seed, index);
        let about = |random: &mut Random| [(); 3].map(|()| random.between(-UNIT / 2, 3 * UNIT / 2));
        let within = |random: &mut Random| [(); 3].map(|()| random.between(0, UNIT + 1));
        let ray = match index % kinds {
            0 => LatticeRay::between(about(random), within(random)),
            1 => {
                let direction = [(); 3].map(|()| random.between(-1, 2) * UNIT);
                // Half of these begin on a plane of the lattice, if they begin in the cube.
                let snap = !0i32 << random.between(0, LATTICE_BITS as i32);
                let begin_on_plane = random.between(0, 2) == 1;
                let origin = about(random).map(|part| if begin_on_plane { part & snap } else { part });
                LatticeRay { origin, direction }
            }
            2 => {
                let snap = !0i32 << random.between(0, LATTICE_BITS as i32);
                LatticeRay::between(about(random).map(|part| part & snap), within(random))
            }
            3 => {
                let Some(origin) = self.inside(random) else { return self.probe_of(!seed, index, 3) };
                let ray = LatticeRay::between(origin, about(random));
                return Probe { ray, crosses_before: Some(f64::INFINITY) };
            }
            _ => {
                let Some(target) = self.inside(random) else { return self.probe_of(!seed, index, 3) };
                let mut origin = within(random);
                let side = random.between(0, 2);
                origin[random.between(0, 3) as usize] = side * UNIT + (2 * side - 1) * (UNIT / 3);
                return Probe { ray: LatticeRay::between(origin, target), crosses_before: Some(1.0) };
            }
        };
        Probe { ray, crosses_before: None }
    }
}

impl LatticeRay {
    /// From one point to another, which is at distance 1.
    fn between(origin: [i32; 3], target: [i32; 3]) -> Self {
        Self { origin, direction: std::array::from_fn(|axis| target[axis] - origin[axis]) }
    }
}
