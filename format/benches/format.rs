//! How many voxels a second go into files and come out of them, on a generated surface and one thread.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use octvox_format::v5::{Archive, Compression, Header};
use octvox_format::{Palette, Reader, SphericalNormal, Voxel, Writer, to_version_4, to_version_5};
use std::f64::consts::TAU;
use std::hint::black_box;
use std::io::Cursor;

/// Levels below the root of the octree that is read and written.
const DEPTH: u8 = 9;

/// A ball with bumps in a cube of side 1: the distance of a point from its surface is less than what `bumpy_ball` returns.
fn bumpy_ball([x, y, z]: [f64; 3]) -> f64 {
    let [x, y, z] = [x - 0.5, y - 0.5, z - 0.5];
    let bumps = (7.0 * TAU * x).sin() * (6.0 * TAU * y).sin() * (5.0 * TAU * z).sin();
    (x * x + y * y + z * z).sqrt() - 0.44 + 0.012 * bumps
}

/// What the surface looks like at a point: stripes of colours, and the gradient.
fn voxel(point: [f64; 3]) -> Voxel {
    let slope = |axis: usize| {
        let shifted = |shift: f64| {
            let mut point = point;
            point[axis] += shift;
            bumpy_ball(point)
        };
        (shifted(1e-4) - shifted(-1e-4)) as f32
    };
    let stripe = (point[1] * 40.0) as u16;
    Voxel { palette_index: 1 + stripe % 5, normal: SphericalNormal::encode([slope(0), slope(1), slope(2)]) }
}

/// Writes the cell with this corner and what is in it.
fn write(writer: &mut Writer<Vec<u8>>, corner: [f64; 3], side: f64, level: u8) {
    let centre = corner.map(|coordinate| coordinate + side / 2.0);
    // The function falls and rises at most so steeply.
    let is_met = |centre: [f64; 3], side: f64| bumpy_ball(centre).abs() < 0.75 * side;
    if level == DEPTH {
        writer.leaf(voxel(centre)).unwrap();
        return;
    }
    writer.node(voxel(centre)).unwrap();
    let half = side / 2.0;
    for octant in 0..8_u32 {
        let corner: [f64; 3] =
            std::array::from_fn(|axis| corner[axis] + half * f64::from(octant >> axis & 1));
        // A node must have a filled child, whichever is nearest.
        let distance = |octant: u32| {
            bumpy_ball(std::array::from_fn(|axis| {
                centre[axis] + half * (f64::from(octant >> axis & 1) - 0.5)
            }))
        };
        let nearest = (0..8).min_by(|a, b| distance(*a).abs().total_cmp(&distance(*b).abs()));
        if nearest == Some(octant) || is_met(corner.map(|coordinate| coordinate + half / 2.0), half) {
            write(writer, corner, half, level + 1);
        } else {
            writer.empty().unwrap();
        }
    }
}

fn surface() -> Vec<u8> {
    let palette = Palette::new((0..5).map(|k| [50 * k, 100, 200 - 40 * k]).collect()).unwrap();
    let mut writer = Writer::new(Vec::new(), &palette).unwrap();
    write(&mut writer, [0.0; 3], 1.0, 0);
    writer.finish().unwrap()
}

fn version_5(version_4: &[u8], compression: Compression) -> Vec<u8> {
    to_version_5(Cursor::new(version_4), Vec::new(), |depth| Header { compression, ..Header::new(depth) })
        .unwrap()
}

fn read_4(file: &[u8]) -> u64 {
    Reader::new(file).unwrap().map(|record| u64::from(record.unwrap().voxel.palette_index)).sum()
}

/// Opens a file as a loader does: all subtrees, whole.
fn open_5(file: &[u8]) -> usize {
    let archive = Archive::of_bytes(file).unwrap();
    (0..archive.subtree_count()).map(|number| archive.subtree(number).unwrap().levels.voxel_count()).sum()
}

fn benchmarks(criterion: &mut Criterion) {
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let old = surface();
    let voxels = octvox_format::summarize(Reader::new(&old[..]).unwrap()).unwrap().levels.iter().sum();

    let mut group = criterion.benchmark_group("version 4");
    group
        .sample_size(20)
        .throughput(Throughput::ElementsAndBytes { elements: voxels, bytes: old.len() as u64 });
    group.bench_function("read", |bencher| bencher.iter(|| read_4(black_box(&old))));
    let archive_bytes = version_5(&old, Compression::None);
    let archive = Archive::of_bytes(&archive_bytes).unwrap();
    group.bench_function("write from version 5", |bencher| {
        bencher.iter(|| to_version_4(black_box(&archive), Vec::with_capacity(old.len())).unwrap());
    });
    group.finish();

    for compression in [Compression::None, Compression::Zstandard] {
        let file = version_5(&old, compression);
        let archive = Archive::of_bytes(&file).unwrap();
        let subtrees: Vec<_> =
            (0..archive.subtree_count()).map(|number| archive.subtree(number).unwrap()).collect();
        let header = Header { compression, ..Header::new(DEPTH) };
        let encoder = octvox_format::v5::Encoder::new(&header);

        let mut group = criterion.benchmark_group(format!("version 5, compression {}", compression.name()));
        group
            .sample_size(20)
            .throughput(Throughput::ElementsAndBytes { elements: voxels, bytes: file.len() as u64 });
        group.bench_function("open", |bencher| bencher.iter(|| open_5(black_box(&file))));
        group.bench_function("records", |bencher| {
            bencher.iter(|| archive.records().map(|record| u64::from(record.unwrap().level)).sum::<u64>());
        });
        group.bench_function("encode", |bencher| {
            bencher.iter(|| {
                subtrees.iter().map(|subtree| encoder.encode(subtree).unwrap().byte_length()).sum::<u64>()
            });
        });
        group.bench_function("from version 4", |bencher| {
            bencher.iter(|| one_thread.install(|| version_5(black_box(&old), compression)));
        });
        group.finish();
    }
}

criterion_group!(format, benchmarks);
criterion_main!(format);
