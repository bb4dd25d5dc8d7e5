//! How many rays a second the kernels of tracing follow, and how many voxels a second loading takes, on a generated model.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::DVec3;
use octvox_cli::Progress;
use octvox_converter::{Compression, FileFormat, Mesh, Options, convert};
use octvox_raytracer::{
    Arithmetic, Camera, DEFAULT_FOV, Octree, Ray, SecondaryKind, SecondaryRays, Visibility,
    VisibilityOptions, Width,
};
use std::hint::black_box;
use std::time::Duration;

const SIZE: [u32; 2] = [640, 480];

/// A `.vox` of a ball with waves all over it.
fn wavy_ball(depth: u8, format: FileFormat) -> Vec<u8> {
    const RINGS: u32 = 200;
    const SPOKES: u32 = 400;
    let angle = |k: u32, count: u32| f64::from(k) / f64::from(count) * std::f64::consts::TAU;
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for ring in 0..=RINGS {
        for spoke in 0..SPOKES {
            let (theta, phi) = (angle(ring, 2 * RINGS), angle(spoke, SPOKES));
            let radius = 1.0 + 0.05 * (12.0 * theta).cos() * (9.0 * phi).cos() * theta.sin();
            positions.push([
                radius * theta.sin() * phi.cos(),
                radius * theta.cos(),
                radius * theta.sin() * phi.sin(),
            ]);
            if ring < RINGS {
                let at = |ring: u32, spoke: u32| ring * SPOKES + spoke % SPOKES;
                let [a, b] = [at(ring, spoke), at(ring, spoke + 1)];
                let [c, d] = [at(ring + 1, spoke + 1), at(ring + 1, spoke)];
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    let mesh = Mesh::new(positions, triangles).expect("the ball is a valid mesh");
    let mut file = Vec::new();
    let options = Options { depth, format, ..Options::default() };
    convert(&mesh, &options, &Progress::hidden(), &mut file).expect("the ball can be converted");
    file
}

fn octree(depth: u8) -> Octree {
    Octree::from_bytes(&wavy_ball(depth, FileFormat::Version4)).expect("the file is valid")
}

fn cameras(octree: &Octree) -> [(&'static str, Camera); 3] {
    let outside = Camera::framing(octree, 640.0 / 480.0, DEFAULT_FOV);
    let nearer = outside.target + (outside.eye - outside.target) * 0.5;
    let inside = outside.target + DVec3::new(0.05, 0.02, 0.03);
    [
        ("outside", outside),
        ("close", Camera { eye: nearer, ..outside }),
        ("inside", Camera { eye: inside, ..outside }),
    ]
}

fn settings() -> impl Iterator<Item = (Width, bool)> {
    Width::ALL.into_iter().flat_map(|width| [(width, false), (width, true)])
}

/// Primary visibility: every width, with beams and without.
fn primary(criterion: &mut Criterion) {
    let octree = octree(9);
    for (name, camera) in cameras(&octree) {
        let mut group = criterion.benchmark_group(format!("primary, {name}"));
        group.throughput(Throughput::Elements(u64::from(SIZE[0] * SIZE[1])));
        for (width, beams) in settings() {
            let id = BenchmarkId::new(if beams { "beams" } else { "packets" }, width.lanes());
            let options = VisibilityOptions { width, beams, ..VisibilityOptions::default() };
            let mut picture = Visibility::default();
            group.bench_function(id, |bencher| {
                bencher.iter(|| picture.trace(black_box(&octree), &camera, SIZE, &options));
            });
        }
        group.finish();
    }
}

/// With levels of detail, at several resolutions.
fn levels_of_detail(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("levels of detail");
    group.throughput(Throughput::Elements(u64::from(SIZE[0] * SIZE[1])));
    for depth in [7, 9, 11] {
        let octree = octree(depth);
        let [(_, camera), ..] = cameras(&octree);
        for lod_pixels in [0.0, 1.0] {
            let id = BenchmarkId::new(format!("{lod_pixels} pixels"), 1 << depth);
            let options = VisibilityOptions { lod_pixels, ..VisibilityOptions::default() };
            let mut picture = Visibility::default();
            group.bench_function(id, |bencher| {
                bencher.iter(|| picture.trace(black_box(&octree), &camera, SIZE, &options));
            });
        }
    }
    group.finish();
}

/// Rays from what is seen: to a lamp, all around, reflected.
fn secondary(criterion: &mut Criterion) {
    let octree = octree(9);
    let [(_, camera), ..] = cameras(&octree);
    for kind in [SecondaryKind::Shadow, SecondaryKind::Ambient, SecondaryKind::Reflection] {
        let mut group = criterion.benchmark_group(format!("secondary, {kind:?}").to_lowercase());
        let rays = SecondaryRays::new(&octree, &camera, SIZE, 0.0, kind).expect("the camera sees the ball");
        group.throughput(Throughput::Elements(rays.len() as u64));
        let mut found = Visibility::default();
        for width in Width::ALL {
            group.bench_function(BenchmarkId::from_parameter(width.lanes()), |bencher| {
                bencher.iter(|| rays.trace(black_box(&octree), Arithmetic::Single, width, false, &mut found));
            });
        }
        group.finish();
    }
}

/// Rays that have nothing to do with one another, one by one through the library.
fn scattered(criterion: &mut Criterion) {
    let octree = octree(9);
    let mut group = criterion.benchmark_group("scattered");
    let mut state = 1u64;
    let mut part = || {
        state = state.wrapping_mul(0x5851_F42D_4C95_7F2D).wrapping_add(0x1405_7B7E_F767_814F);
        (state >> 40) as f64 / f64::from(1 << 24)
    };
    let mut point = |low: f64, high: f64| DVec3::from_array([(); 3].map(|()| low + (high - low) * part()));
    let rays: Vec<Ray> = (0..20_000)
        .map(|_| {
            let origin = point(-1.0, 2.0);
            Ray { origin, direction: point(0.0, 1.0) - origin }
        })
        .collect();
    let with_ends: Vec<(Ray, f64)> = rays.iter().map(|ray| (*ray, 1.0)).collect();
    group.throughput(Throughput::Elements(rays.len() as u64));
    for width in Width::ALL {
        group.bench_function(BenchmarkId::new("first hit", width.lanes()), |bencher| {
            bencher.iter(|| octree.hits(black_box(&rays), width));
        });
        group.bench_function(BenchmarkId::new("any hit", width.lanes()), |bencher| {
            bencher.iter(|| octree.blocked(black_box(&with_ends), width));
        });
    }
    group.finish();
}

/// From a file in memory to an octree, and its grid.
fn loading(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("load");
    let compressed = FileFormat::Version5 { compression: Compression::Zstandard };
    for (name, format) in [("version 4", FileFormat::Version4), ("version 5", compressed)] {
        let file = wavy_ball(10, format);
        let octree = Octree::from_bytes(&file).expect("the file is valid");
        group.throughput(Throughput::Elements(octree.leaf_voxels()));
        group.bench_function(name, |bencher| bencher.iter(|| Octree::from_bytes(black_box(&file))));
    }
    group.finish();
    let mut group = criterion.benchmark_group("grid");
    let mut octree = octree(10);
    group.bench_function("64³ cells", |bencher| bencher.iter(|| octree.set_grid(black_box(6))));
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .sample_size(20)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(2));
    targets = primary, levels_of_detail, secondary, scattered, loading
}
criterion_main!(benches);
