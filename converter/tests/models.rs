//! The models of the thesis, where they are at hand.

mod support;

use octvox_converter::{Options, load_mesh};
use std::path::PathBuf;
use support::convert_to_bytes;

/// A model's path; `None`, with a message, if the models are absent.
fn model(name: &str) -> Option<PathBuf> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared/models/seed").join(name);
    if path.exists() {
        return Some(path);
    }
    eprintln!("skipped: {} is absent", path.display());
    None
}

/// Bohnen 2009, table 10: model, depth, voxels, and how much fewer they may be. His sampling is thicker, which shows
/// where parts are thin.
const THESIS: [(&str, u8, u64, f64); 6] = [
    ("al.obj", 3, 265, 0.13),
    ("al.obj", 6, 24_385, 0.13),
    ("al.obj", 8, 474_561, 0.12),
    ("porsche.obj", 3, 201, 0.0),
    ("porsche.obj", 6, 16_553, 0.13),
    ("porsche.obj", 8, 277_113, 0.08),
];

/// Counts of an independent program with the same rule but other rounding: model, depth, voxels.
const COUNTED: [(&str, u8, u64); 8] = [
    ("al.obj", 3, 249),
    ("al.obj", 6, 21_953),
    ("al.obj", 8, 428_505),
    ("porsche.obj", 3, 201),
    ("porsche.obj", 6, 14_681),
    ("porsche.obj", 8, 258_305),
    ("teapot.obj", 8, 263_361),
    ("soccerball.obj", 8, 668_113),
];

fn voxel_count(path: &std::path::Path, depth: u8) -> u64 {
    let mesh = load_mesh(path).unwrap();
    convert_to_bytes(&mesh, &Options { depth, ..Options::default() }).1.thesis_voxels
}

#[test]
fn voxel_counts_are_near_those_of_the_thesis() {
    for (name, depth, expected, tolerance) in THESIS {
        let Some(path) = model(name) else { return };
        let found = voxel_count(&path, depth);
        let missing = (expected as f64 - found as f64) / expected as f64;
        assert!((0.0..=tolerance).contains(&missing), "{name} at depth {depth}: {found}, thesis {expected}");
    }
}

#[test]
fn voxel_counts_agree_with_an_independent_program() {
    for (name, depth, expected) in COUNTED {
        let Some(path) = model(name) else { return };
        let found = voxel_count(&path, depth);
        // Vertices that lie within rounding of a centre line go one way or the other.
        assert!(
            found.abs_diff(expected) * 2_000 <= expected,
            "{name} at depth {depth}: {found}, not {expected}"
        );
    }
}

#[test]
fn each_level_has_four_times_the_voxels() {
    let Some(path) = model("bunny.obj") else { return };
    let ratio = voxel_count(&path, 9) as f64 / voxel_count(&path, 8) as f64;
    assert!((3.9..4.1).contains(&ratio), "{ratio}");
}

#[test]
fn the_bunny_is_filled_though_it_has_holes() {
    let Some(path) = model("bunny.obj") else { return };
    let mesh = load_mesh(&path).unwrap();
    let options = Options { depth: 6, ..Options::default() };
    let (_, hollow) = convert_to_bytes(&mesh, &options);
    let (_, solid) = convert_to_bytes(&mesh, &Options { solid: true, ..options });
    // The volume of the mesh, in voxels, by tetrahedra whose tips are in the plane of its holes.
    let lowest = mesh.positions().iter().map(|position| position[1]).fold(f64::MAX, f64::min);
    let volume: f64 = mesh
        .triangles()
        .iter()
        .map(|triangle| {
            let [a, b, c] = triangle.map(|vertex| {
                let [x, y, z] = mesh.positions()[vertex as usize];
                [x, y - lowest, z]
            });
            (a[0] * (b[1] * c[2] - b[2] * c[1])
                + a[1] * (b[2] * c[0] - b[0] * c[2])
                + a[2] * (b[0] * c[1] - b[1] * c[0]))
                / 6.0
        })
        .sum::<f64>()
        / solid.world.voxel_size.powi(3);
    // Voxels of the surface lie inside by half.
    let expected = volume + hollow.leaf_voxels as f64 / 2.0;
    let found = solid.leaf_voxels as f64;
    assert!((found / expected - 1.0).abs() < 0.03, "{found} voxels, expected {expected}");
    assert_eq!(solid.warnings, hollow.warnings);
}
