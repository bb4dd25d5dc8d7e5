//! How many voxels a second the stages of a conversion make, on a generated mesh.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use octvox_cli::Progress;
use octvox_converter::{Compression, FileFormat, Material, Mesh, Options, Report, convert, load_mesh};
use std::fmt::Write as _;
use std::hint::black_box;
use std::io::Write;
use std::time::Duration;

/// Vertices and triangles of a bumpy torus of 2 · `around` · `across` triangles.
fn bumpy_torus(around: u32, across: u32) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let angle = |k: u32, count: u32| f64::from(k) / f64::from(count) * std::f64::consts::TAU;
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for i in 0..around {
        for j in 0..across {
            let (u, v) = (angle(i, around), angle(j, across));
            let tube = 0.4 + 0.05 * (9.0 * u).sin() * (5.0 * v).sin();
            let reach = 1.0 + tube * v.cos();
            positions.push([reach * u.cos(), reach * u.sin(), tube * v.sin()]);
            let at = |i: u32, j: u32| (i % around) * across + j % across;
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    (positions, triangles)
}

fn mesh(around: u32, across: u32, materials: u32) -> Mesh {
    let (positions, triangles) = bumpy_torus(around, across);
    let of_triangle = (0..triangles.len() as u32).map(|triangle| triangle / 7 % materials).collect();
    let material = |k: u32| Material::matte("", [f64::from(k) / f64::from(materials); 3]);
    Mesh::new(positions, triangles)
        .and_then(|mesh| mesh.with_materials((0..materials).map(material).collect(), of_triangle))
        .expect("the torus is a valid mesh")
}

fn run(mesh: &Mesh, depth: u8) -> Report {
    convert_into(mesh, &Options { depth, ..Options::default() }, &mut std::io::sink())
}

fn convert_into(mesh: &Mesh, options: &Options, out: &mut impl Write) -> Report {
    convert(mesh, options, &Progress::hidden(), out).expect("the torus can be converted")
}

/// The whole conversion without reading, into nothing.
fn whole(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("convert");
    for (name, mesh) in [
        ("few large triangles", mesh(24, 12, 1)),
        ("many small triangles", mesh(600, 240, 1)),
        ("many materials", mesh(200, 80, 50)),
    ] {
        for depth in [8, 10] {
            group.throughput(Throughput::Elements(run(&mesh, depth).leaf_voxels));
            group.bench_with_input(BenchmarkId::new(name, 1 << depth), &depth, |bencher, &depth| {
                bencher.iter(|| run(black_box(&mesh), depth));
            });
        }
    }
    group.finish();
}

/// Each stage by the time that the report gives for it, in leaf voxels a second.
fn stages(criterion: &mut Criterion) {
    const DEPTH: u8 = 10;
    let mesh = mesh(300, 120, 1);
    let version_4 = Options { depth: DEPTH, ..Options::default() };
    let version_5 =
        |compression| Options { format: FileFormat::Version5 { compression }, ..version_4.clone() };
    let mut group = criterion.benchmark_group("stage at 1024");
    group.throughput(Throughput::Elements(run(&mesh, DEPTH).leaf_voxels));
    let mut stage = |name: &str, options: &Options, seconds: fn(&Report) -> f64| {
        group.bench_function(name, |bencher| {
            bencher.iter_custom(|iterations| {
                let run = || convert_into(&mesh, options, &mut std::io::sink());
                (0..iterations).map(|_| Duration::from_secs_f64(seconds(&run()))).sum()
            });
        });
    };
    stage("scan", &version_4, |report| report.seconds.scan);
    stage("palette", &version_4, |report| report.seconds.palette);
    stage("build", &version_4, |report| report.seconds.build);
    stage("encode version 4", &version_4, |report| report.seconds.write);
    stage("encode version 5, uncompressed", &version_5(Compression::None), |report| report.seconds.write);
    stage("encode version 5, zstd", &version_5(Compression::Zstandard), |report| report.seconds.write);
    group.bench_function("encode version 4 and write it to a file", |bencher| {
        bencher.iter_custom(|iterations| {
            let seconds = |_| {
                let mut file = tempfile::tempfile().expect("there is a temporary folder");
                convert_into(&mesh, &version_4, &mut file).seconds.write
            };
            Duration::from_secs_f64((0..iterations).map(seconds).sum())
        });
    });
    group.finish();
}

/// Reading an OBJ file, in triangles a second.
fn read(criterion: &mut Criterion) {
    let (positions, triangles) = bumpy_torus(300, 120);
    let mut text = String::new();
    for [x, y, z] in positions {
        writeln!(text, "v {x:.6} {y:.6} {z:.6}").expect("writing to memory succeeds");
    }
    for triangle in &triangles {
        let [a, b, c] = triangle.map(|vertex| vertex + 1);
        writeln!(text, "f {a} {b} {c}").expect("writing to memory succeeds");
    }
    let folder = tempfile::tempdir().expect("there is a temporary folder");
    let path = folder.path().join("torus.obj");
    std::fs::write(&path, text).expect("the temporary folder can be written");
    let mut group = criterion.benchmark_group("read");
    group.throughput(Throughput::Elements(triangles.len() as u64));
    group.bench_function("obj", |bencher| bencher.iter(|| load_mesh(black_box(&path))));
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10);
    targets = whole, stages, read
}
criterion_main!(benches);
