//! How often single precision meets another voxel than it should, by resolution.

use super::super::record::{Chapter, Table};
use super::super::subject::{Conversion, Subject};
use super::parts_per_million;
use octvox_raytracer::{Arithmetic, CheckOptions, DISPLACEMENT, Width, check};

/// Checks the octrees of one resolution after the other; `levels` are those added to the subject's own depth.
pub fn differences(
    subject: &Subject,
    levels: impl Iterator<Item = i8>,
    rays: u64,
    progress: impl Fn(),
) -> anyhow::Result<Chapter> {
    let mut rows = Vec::new();
    for levels in levels {
        let prepared = subject.prepare(&Conversion { levels, ..Conversion::default() })?;
        let octree = &prepared.octrees[0];
        for arithmetic in Arithmetic::ALL {
            // All widths are the same to the last bit, which the program's check proves; here it is the voxels that count.
            let options = CheckOptions { rays, seed: 1, arithmetic, widths: vec![Width::FASTEST] };
            let report = check(octree, &options, |_| {});
            let displacement = DISPLACEMENT * f64::from(octree.resolution());
            let bound = match arithmetic {
                Arithmetic::Single => format!("{:.1}", 4.0 * displacement * 1e6),
                Arithmetic::Double => "0".into(),
            };
            rows.push(vec![
                format!("{}³", octree.resolution()),
                arithmetic.name().into(),
                report.rays.to_string(),
                report.differences.to_string(),
                parts_per_million(report.differences, report.rays),
                bound,
                report.mismatches.to_string(),
                report.leaks.map_or_else(|| "not closed".into(), |leaks| leaks.to_string()),
                format!("{:.2e}", report.max_distance_error),
            ]);
        }
        progress();
    }
    let columns = [
        "resolution",
        "arithmetic",
        "rays",
        "other voxels",
        "per million",
        "bound per million",
        "unexplained",
        "leaks",
        "largest error of a distance (voxels)",
    ];
    let table = Table {
        title: "Held against integers".into(),
        note: format!(
            "A ray in single precision may be displaced by {DISPLACEMENT:.2e} of the cube (4 roundings of a way of 4). A ray \
             that meets a face of a voxel meets another one only if it comes that close to an edge of the face: that is at most \
             the share 4 · displacement · resolution of all places on it, the bound. Rays of the check go to lattice points, \
             along axes and diagonals too, which come close to edges more often than others, and are displaced by less. In \
             double precision rays of the lattice are followed exactly; the bound is 0. The same is printed by `voxtrace check \
             --arithmetic single` and `double`."
        ),
        columns: columns.map(String::from).to_vec(),
        rows,
    };
    let introduction = "Random rays on a lattice of 2⁻²⁰ of the cube, followed in floating point and by integers. Other voxels \
                        are those that are not the exact ones; unexplained are those that rounding does not account for, \
                        which must not be.";
    Ok(Chapter {
        title: "How often rounding shows".into(),
        introduction: introduction.into(),
        tables: vec![table],
    })
}
