//! One ray of a check again, with all that there is to say about it.

use crate::arithmetic::Arithmetic;
use crate::cast::{Effort, Hit};
use crate::check::{Targets, Verdict, follow, is_same};
use crate::octree::Octree;
use crate::width::Width;
use serde::Serialize;

/// A ray of a check, and what became of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Replay {
    /// Its number.
    pub ray: u64,
    /// Where it begins, in unit space: whole multiples of 2⁻²⁰.
    pub origin: [f64; 3],
    /// Where it goes; distances are in units of its length.
    pub direction: [f64; 3],
    /// It must hit something before this distance, because it comes from or goes into a closed surface.
    pub stopped_before: Option<f64>,
    /// What the exact walk hits.
    pub exact: Option<ReplayedHit>,
    /// What each width hits in single precision.
    pub widths: Vec<ReplayedWidth>,
    /// What is hit in double precision.
    pub double: ReplayedWidth,
    /// Whether that is not the exact voxel, which it must be.
    pub double_is_other_voxel: bool,
    /// Whether the widths do not agree in every bit.
    pub widths_differ: bool,
    /// Whether a voxel is hit in single precision that is not the exact one.
    pub is_other_voxel: bool,
    /// Whether the bound on the rounding error does not explain that.
    pub is_mismatch: bool,
    /// Whether a closed surface is crossed unseen.
    pub leaks: bool,
    /// Whether the bound on the number of steps stopped it.
    pub is_guarded: bool,
    /// The error of the distance, in voxels, if the voxel is the exact one.
    pub distance_error: Option<f64>,
    /// Whether something of it must not be.
    pub is_wrong: bool,
}

/// A hit of a [`Replay`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ReplayedHit {
    /// The lowest finest cell of the voxel.
    pub cell: [u32; 3],
    /// The voxel is `1 << size_log2` finest cells wide.
    pub size_log2: u32,
    /// In units of the direction's length.
    pub distance: f64,
}

/// What packets of one width and arithmetic make of the ray.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ReplayedWidth {
    /// Rays that go together.
    pub lanes: u32,
    /// What is hit.
    pub hit: Option<ReplayedHit>,
    /// Cells visited.
    pub steps: u32,
}

/// Follows one ray of [`crate::check`] again: the one with this number, of a check with this seed.
#[must_use]
pub fn replay(octree: &Octree, seed: u64, ray: u64) -> Replay {
    let probe = Targets::new(octree, seed).probe(seed, ray);
    let as_ray = probe.ray.to_ray();
    let found = Width::ALL.map(|width| follow(octree, &[as_ray], Arithmetic::Single, width)[0]);
    let widths_differ = found.iter().any(|other| !is_same(other, &found[0]));
    let verdict = Verdict::new(octree, &probe, &found[0], widths_differ, Arithmetic::Single);
    let in_double = follow(octree, &[as_ray], Arithmetic::Double, Width::Eight)[0];
    let of_double = Verdict::new(octree, &probe, &in_double, false, Arithmetic::Double);
    let of_width = |(width, (hit, effort)): (Width, (Option<Hit>, Effort))| ReplayedWidth {
        lanes: width.lanes(),
        hit: hit.map(ReplayedHit::from),
        steps: effort.steps,
    };
    Replay {
        ray,
        origin: as_ray.origin.to_array(),
        direction: as_ray.direction.to_array(),
        stopped_before: probe.crosses_before.filter(|distance| distance.is_finite()),
        exact: verdict.exact.map(|exact| ReplayedHit {
            cell: exact.cell,
            size_log2: 0,
            distance: exact.distance,
        }),
        widths: Width::ALL.into_iter().zip(found).map(of_width).collect(),
        double: of_width((Width::Eight, in_double)),
        double_is_other_voxel: of_double.is_other_voxel,
        widths_differ,
        is_other_voxel: verdict.is_other_voxel,
        is_mismatch: verdict.is_mismatch,
        leaks: verdict.leaks || of_double.leaks,
        is_guarded: verdict.is_guarded || of_double.is_guarded,
        distance_error: verdict.distance_error,
        is_wrong: verdict.is_wrong() || of_double.is_wrong(),
    }
}

impl From<Hit> for ReplayedHit {
    fn from(hit: Hit) -> Self {
        Self { cell: hit.cell, size_log2: hit.size_log2, distance: hit.distance }
    }
}
