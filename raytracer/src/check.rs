//! The fast traversal held against the exact one, ray by ray.

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

/// What to check.
#[derive(Debug, Clone, PartialEq)]
pub struct CheckOptions {
    /// Number of rays.
    pub rays: u64,
    /// Where the random numbers begin.
    pub seed: u64,
    /// Widths that must agree.
    pub widths: Vec<Width>,
}

/// What a check found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CheckReport {
    /// Rays followed by every width and by the exact walk.
    pub rays: u64,
    /// Widths compared.
    pub widths: Vec<u32>,
    /// Rays on which the widths disagree in a bit.
    pub width_differences: u64,
    /// Rays whose voxel is not that of the exact walk.
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
    /// Rays through the pixels of pictures, followed by every width, with beams and without.
    pub picture_rays: u64,
    /// Of those, the ones that do not see the same, to the last bit.
    pub picture_differences: u64,
}

impl CheckReport {
    /// Whether nothing was found that must not be.
    #[must_use]
    pub fn is_right(&self) -> bool {
        let differences = self.width_differences + self.mismatches + self.picture_differences;
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
    let enclosure = Enclosure::new(octree);
    let targets = Targets { octree, enclosure: &enclosure };
    let has_inside = targets.find_any(options.seed);
    let batches = options.rays.div_ceil(BATCH);
    let empty = Findings::default();
    let findings = (0..batches)
        .into_par_iter()
        .map(|batch| {
            let rays = batch * BATCH..options.rays.min((batch + 1) * BATCH);
            let count = rays.end - rays.start;
            let findings = check_batch(&targets, has_inside, options, rays);
            progress(count);
            findings
        })
        .reduce(|| empty, Findings::plus);
    let pictures = check_pictures(octree, options.rays, options.seed, &options.widths, progress);
    CheckReport {
        rays: options.rays,
        widths: options.widths.iter().map(|width| width.lanes()).collect(),
        width_differences: findings.width_differences,
        differences: findings.differences,
        mismatches: findings.mismatches,
        leaks: has_inside.then_some(findings.leaks),
        enclosed_rays: findings.enclosed_rays,
        max_steps: findings.max_steps,
        guard_hits: findings.guard_hits,
        max_distance_error: findings.max_distance_error,
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
}

impl Findings {
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
        }
    }
}

/// A ray, and what must not happen to it.
#[derive(Debug, Clone, Copy)]
struct Probe {
    ray: LatticeRay,
    /// A closed surface is crossed before this distance.
    crosses_before: Option<f64>,
}

fn check_batch(
    targets: &Targets<'_>,
    has_inside: bool,
    options: &CheckOptions,
    indices: std::ops::Range<u64>,
) -> Findings {
    let octree = targets.octree;
    let probes: Vec<Probe> = indices.map(|index| targets.probe(options.seed, index, has_inside)).collect();
    let rays: Vec<Ray> = probes.iter().map(|probe| probe.ray.to_ray()).collect();
    let mut findings = Findings::default();

    let mut first: Vec<(Option<Hit>, Effort)> = Vec::new();
    let mut differs = vec![false; rays.len()];
    for (number, &width) in options.widths.iter().enumerate() {
        let mut found = Vec::with_capacity(rays.len());
        with_lanes!(width, L => cast::<L, true>(octree, &rays, |hit, effort| found.push((hit, effort))));
        if number == 0 {
            first = found;
            continue;
        }
        for (index, (other, reference)) in found.iter().zip(&first).enumerate() {
            differs[index] |= !same_bits(other.0, reference.0) || other.1 != reference.1;
        }
    }
    findings.width_differences = differs.iter().filter(|&&differs| differs).count() as u64;

    for (probe, (hit, effort)) in probes.iter().zip(&first) {
        findings.max_steps = findings.max_steps.max(effort.steps);
        findings.guard_hits += u64::from(effort.guarded);
        if let Some(limit) = probe.crosses_before {
            findings.enclosed_rays += 1;
            let stopped = hit.is_some_and(|hit| hit.distance <= limit);
            findings.leaks += u64::from(!stopped);
        }
        let exact = first_hit(octree, &probe.ray, |_| true);
        match (hit, exact) {
            (None, None) => {}
            (Some(hit), Some(exact)) if contains(hit, exact.cell) => {
                let voxels = f64::from(octree.resolution()) * length(&probe.ray);
                let error = (hit.distance - exact.distance).abs() * voxels;
                findings.max_distance_error = findings.max_distance_error.max(error);
            }
            _ => {
                findings.differences += 1;
                findings.mismatches += u64::from(!is_explained(octree, &probe.ray, hit.as_ref()));
            }
        }
    }
    findings
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

/// How far the traversed ray may be from the exact one, per axis, in unit space.
///
/// With u = 2⁻²⁴, the rounding error of one operation, the distance to a plane is off by 2u of itself: a reciprocal and a
/// product (the difference before it is exact on the lattice). A cell that is visited although the exact ray misses it has
/// a plane of entry that is farther than one of exit by no more than 4u of the distance. In that time the ray moves by 4u
/// of its way along an axis, and ways are at most 4.
const DISPLACEMENT: f64 = 4.0 * 4.0 / 16_777_216.0;

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
struct Targets<'a> {
    octree: &'a Octree,
    enclosure: &'a Enclosure,
}

/// Lattice units of the cube's side.
const UNIT: i32 = 1 << LATTICE_BITS;

impl Targets<'_> {
    /// Whether a point well inside a closed surface can be found.
    fn find_any(&self, seed: u64) -> bool {
        (0..4096).any(|index| self.inside(&mut Random::stream(!seed, index)).is_some())
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

    fn probe(&self, seed: u64, index: u64, has_inside: bool) -> Probe {
        let random = &mut Random::stream(seed, index);
        let about = |random: &mut Random| [(); 3].map(|()| random.between(-UNIT / 2, 3 * UNIT / 2));
        let within = |random: &mut Random| [(); 3].map(|()| random.between(0, UNIT + 1));
        let ray = match index % if has_inside { 5 } else { 3 } {
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
                let Some(origin) = self.inside(random) else { return self.probe(!seed, index, false) };
                let ray = LatticeRay::between(origin, about(random));
                return Probe { ray, crosses_before: Some(f64::INFINITY) };
            }
            _ => {
                let Some(target) = self.inside(random) else { return self.probe(!seed, index, false) };
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
