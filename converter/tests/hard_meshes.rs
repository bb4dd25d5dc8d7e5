//! Meshes that are hard to convert: slivers, duplicates, ties, extreme coordinates, and very many or very large triangles.

mod support;

use octvox_converter::{Compression, ConvertError, FileFormat, Mesh, Options};
use std::collections::BTreeSet;
use support::{Cell, Random, Steps, convert_to_bytes, cuboid, icosphere, reached, unit_voxels, voxels};

/// Replaces every triangle by three that meet at a point inside it, `nearness` of its size away from one of its edges.
fn split(mesh: &Mesh, nearness: f64, random: &mut Random) -> Mesh {
    let mut positions = mesh.positions().to_vec();
    let mut triangles = Vec::new();
    for &triangle in mesh.triangles() {
        let mut corners = triangle;
        corners.rotate_left(random.below(3) as usize);
        let [p, q, r] = corners.map(|vertex| mesh.positions()[vertex as usize]);
        let along = 0.1 + 0.8 * random.fraction();
        positions.push([0, 1, 2].map(|axis| {
            let on_edge = p[axis] + along * (q[axis] - p[axis]);
            on_edge + nearness * (r[axis] - on_edge)
        }));
        let middle = positions.len() as u32 - 1;
        let [a, b, c] = corners;
        triangles.extend([[a, b, middle], [b, c, middle], [c, a, middle]]);
    }
    Mesh::new(positions, triangles).unwrap()
}

/// A mesh with its vertices moved and scaled: `offset + scale · vertex`.
fn placed(mesh: &Mesh, offset: f64, scale: f64) -> Mesh {
    let positions = mesh.positions().iter().map(|position| position.map(|x| offset + scale * x)).collect();
    Mesh::new(positions, mesh.triangles().to_vec()).unwrap()
}

/// Options under which one world unit is a voxel, with a border of four voxels around a model of 24.
fn options() -> Options {
    unit_voxels(5)
}

/// Checks that no walk leads from the corner of the cube to its middle, through faces or, if conservative, anywhere.
fn assert_closed(mesh: &Mesh, options: &Options) {
    for (conservative, steps) in [(false, Steps::Six), (true, Steps::TwentySix)] {
        let options = Options { conservative, ..options.clone() };
        let filled: BTreeSet<Cell> = voxels(mesh, &options).into_keys().collect();
        let side = options.resolution();
        let middle = [side / 2; 3];
        assert!(!filled.contains(&middle));
        assert!(!reached(&filled, side, steps).contains(&middle), "conservative: {conservative}");
    }
}

/// Checks that neither order, nor threads, nor memory change a byte, in both formats.
fn assert_deterministic(mesh: &Mesh, options: &Options, random: &mut Random) {
    let mut triangles = mesh.triangles().to_vec();
    random.shuffle(&mut triangles);
    let shuffled = Mesh::new(mesh.positions().to_vec(), triangles).unwrap();
    for format in [FileFormat::Version4, FileFormat::Version5 { compression: Compression::None }] {
        let options = Options { format, ..options.clone() };
        let (expected, _) = convert_to_bytes(mesh, &options);
        let bounded = Options { memory: Some(1), force: true, ..options };
        for threads in [1, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let (found, report) = pool.install(|| convert_to_bytes(&shuffled, &bounded));
            assert!(report.temporary_bytes > 0);
            assert!(found == expected, "{threads} threads, {format:?}");
        }
    }
}

#[test]
fn slivers() {
    let mut random = Random(11);
    for mesh in [icosphere([16.0, 16.1, 15.8], 11.7, 1), cuboid([4.0; 3], [28.0, 27.5, 26.3])] {
        let slivers = split(&split(&mesh, 1e-7, &mut random), 1e-7, &mut random);
        assert_closed(&slivers, &options());
        assert_deterministic(&slivers, &options(), &mut random);
    }
}

#[test]
fn coplanar_duplicates() {
    let mut random = Random(12);
    let sphere = icosphere([16.0; 3], 11.7, 1);
    let mut triangles = sphere.triangles().to_vec();
    // Copies, some of them turned over.
    triangles
        .extend(sphere.triangles().iter().map(|&[a, b, c]| if a % 2 == 0 { [a, b, c] } else { [b, a, c] }));
    let doubled = Mesh::new(sphere.positions().to_vec(), triangles).unwrap();
    assert_closed(&doubled, &options());
    assert_deterministic(&doubled, &options(), &mut random);
    let cells = |mesh: &Mesh| voxels(mesh, &options()).into_keys().collect::<Vec<_>>();
    assert_eq!(cells(&doubled), cells(&sphere));
}

#[test]
fn faces_on_the_boundaries_of_cells() {
    let mut random = Random(13);
    for (min, max) in [(4.0, 28.0), (4.5, 27.5), (0.0, 32.0)] {
        let mesh = split(&cuboid([min; 3], [max; 3]), 0.25, &mut random);
        assert_deterministic(&mesh, &options(), &mut random);
        if min > 0.0 {
            assert_closed(&mesh, &options());
        }
    }
}

#[test]
fn far_from_the_origin_and_tiny() {
    let mut random = Random(14);
    let sphere = icosphere([0.0; 3], 0.5, 2);
    // At 10⁷ coordinates are 2·10⁻⁹ apart, so an extent of 10⁻⁷ has some fifty of them.
    for (offset, scale) in [(1e7, 1.0), (1e7, 1e-7), (-1e7, 1e-7), (0.0, 1e-300), (0.0, 1e300)] {
        let mesh = placed(&sphere, offset, scale);
        let bounds = [0, 1, 2, 3, 4, 5].map(|k| offset + scale * if k < 3 { -0.6 } else { 0.6 });
        let options = Options { depth: 5, bounds: Some(bounds), ..Options::default() };
        assert_closed(&mesh, &options);
        assert_deterministic(&mesh, &options, &mut random);
    }
}

#[test]
fn what_is_no_place_is_refused() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let positions = vec![[0.0; 3], [1.0, bad, 0.0], [0.0, 1.0, 0.0]];
        let error = Mesh::new(positions, vec![[0, 1, 2]]).unwrap_err();
        assert!(matches!(error, ConvertError::NotFinite { vertex: 1, .. }), "{error}");
    }
    let error = Mesh::new(vec![[0.0; 3]; 3], vec![[0, 1, 3]]).unwrap_err();
    assert!(matches!(error, ConvertError::IndexOutOfRange { index: 3, count: 3, .. }), "{error}");
}

/// Triangles much smaller than a voxel: a sphere of 32 voxels across.
fn check_small_triangles(steps: u32) {
    let mut random = Random(15);
    let sphere = icosphere([16.0; 3], 11.7, steps);
    assert!(sphere.triangles().len() >= 20 << (2 * steps));
    assert_closed(&sphere, &options());
    assert_deterministic(&sphere, &options(), &mut random);
}

#[test]
fn triangles_smaller_than_a_voxel() {
    check_small_triangles(6);
}

#[test]
#[ignore = "takes minutes"]
fn ten_million_and_more_triangles_smaller_than_a_voxel() {
    check_small_triangles(10);
}

/// One triangle across the whole cube fills as many voxels as its largest projection has columns, about.
fn check_triangle_across(depth: u8) {
    let mut random = Random(16);
    let mesh = Mesh::new(vec![[0.0; 3], [1.0, 0.9, 0.3], [0.1, 1.0, 1.0]], vec![[0, 1, 2]]).unwrap();
    let options = Options { depth, ..Options::default() };
    let (_, report) = convert_to_bytes(&mesh, &options);
    let expected = report.estimate.leaf_voxels as f64;
    let found = report.leaf_voxels as f64;
    assert!((found / expected - 1.0).abs() < 0.02, "{found} voxels instead of {expected}");
    assert_deterministic(&mesh, &options, &mut random);
}

#[test]
fn a_triangle_across_the_cube() {
    check_triangle_across(9);
}

#[test]
#[ignore = "takes a minute, and 3 GiB on the disk"]
fn a_triangle_across_the_largest_cubes() {
    check_triangle_across(13);
}
