//! What rays cost that are hard on floating point.

use super::super::measure::Repetitions;
use super::super::record::{Chapter, Table};
use super::nanoseconds;
use glam::DVec3;
use octvox_raytracer::{Arithmetic, Octree, Ray, Width};
use std::hint::black_box;

/// A kind of rays, all of which come from about the cube.
struct Kind {
    name: &'static str,
    ray: fn([f64; 6]) -> Ray,
}

/// From a point beside the cube towards a point in it.
fn between(at: [f64; 6]) -> Ray {
    let origin = DVec3::new(-1.0, at[1] * 3.0 - 1.0, at[2] * 3.0 - 1.0);
    Ray { origin, direction: DVec3::new(at[3], at[4], at[5]) - origin }
}

/// Along x, at a place within the cube.
fn along_an_axis(at: [f64; 6]) -> Ray {
    Ray { origin: DVec3::new(-1.0, at[1], at[2]), direction: DVec3::X }
}

const KINDS: [Kind; 6] = [
    Kind { name: "anywhere", ray: between },
    Kind { name: "along an axis", ray: along_an_axis },
    Kind {
        name: "along an axis, in planes of cells",
        ray: |at| {
            let Ray { origin, direction } = along_an_axis(at);
            Ray { origin: (origin * 64.0).round() / 64.0, direction }
        },
    },
    Kind {
        name: "with components of 1e-30",
        ray: |at| Ray { direction: DVec3::new(1.0, 1e-30, -1e-30), ..along_an_axis(at) },
    },
    Kind {
        name: "with the smallest subnormal components",
        ray: |at| Ray {
            direction: DVec3::new(1.0, f64::from_bits(1), -f64::from(f32::from_bits(1))),
            ..along_an_axis(at)
        },
    },
    Kind {
        name: "whole directions of 1e-310",
        ray: |at| {
            let Ray { origin, direction } = along_an_axis(at);
            Ray { origin, direction: direction * 1e-310 }
        },
    },
];

/// Rays of each kind that are timed.
const RAYS: u32 = 1 << 16;

/// Times rays of each kind on one thread, in each arithmetic.
pub fn hard_rays(octree: &Octree, repetitions: Repetitions) -> anyhow::Result<Chapter> {
    let mut rows = Vec::new();
    for arithmetic in Arithmetic::ALL {
        let (mut usual, mut usual_axis) = (1.0, 1.0);
        for (number, kind) in KINDS.iter().enumerate() {
            let rays: Vec<Ray> = (0..RAYS).map(|ray| (kind.ray)(spread(ray))).collect();
            let time = repetitions.time(|| {
                black_box(octree.hits_with(black_box(&rays), arithmetic, Width::FASTEST));
                Ok(())
            })?;
            match number {
                0 => usual = time.median,
                1 => usual_axis = time.median,
                _ => {}
            }
            let ratio = |to: f64| format!("{:.2}", time.median / to);
            rows.push(vec![
                kind.name.into(),
                arithmetic.name().into(),
                nanoseconds(time.median, rays.len()),
                ratio(usual),
                if number == 0 { "–".into() } else { ratio(usual_axis) },
            ]);
        }
    }
    let columns = ["rays", "arithmetic", "ns a ray", "times that of anywhere", "times that of along an axis"];
    let table = Table {
        title: "Hard rays".into(),
        note: format!(
            "{RAYS} rays of each kind, in packets, on one thread, at the finest cells. Subnormal numbers can \
                       take a processor a hundred times as long; no more than 2.5 times is wanted."
        ),
        columns: columns.map(String::from).to_vec(),
        rows,
    };
    let introduction = "Rays that run in planes of cells, or with components so small that floating point has no full \
                        precision for them, meet what they should (the tests hold them against integers); here is what they \
                        cost.";
    Ok(Chapter { title: "Hard rays".into(), introduction: introduction.into(), tables: vec![table] })
}

/// Numbers from 0 to 1 that are spread well over six dimensions: the additive recurrence with powers of the root of
/// x⁷ = x + 1 (M. Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018).
fn spread(number: u32) -> [f64; 6] {
    const ROOT: f64 = 1.112_775_684_278_705_5;
    std::array::from_fn(|axis| (0.5 + f64::from(number) * ROOT.powi(-(axis as i32 + 1))).fract())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_root_is_one_and_numbers_spread() {
        let root = spread(1)[0] - 0.5;
        assert!((1.0 / root).powi(7) - 1.0 / root - 1.0 < 1e-9);
        let mean: f64 = (0..1000).map(|number| spread(number)[5]).sum::<f64>() / 1000.0;
        assert!((mean - 0.5).abs() < 0.02, "{mean}");
    }
}
