//! One picture, whatever the width of packets, the number of threads and the grid.

use octvox_converter::Options;
use octvox_format::Reader;
use octvox_raytracer::{
    CheckOptions, Counts, Frame, Hit, Octree, Quality, Ray, RenderOptions, Visibility, VisibilityOptions,
    Width, check,
};
use octvox_tests::meshes::{sphere, torus};
use octvox_tests::models::Model;
use octvox_tests::pictures::{framing, picture};
use octvox_tests::random::Random;
use octvox_tests::rays::{exact_in_single_precision, hits_of_every_width, is_of_hit, on_the_lattice};
use octvox_tests::tree::Tree;

/// No multiple of a tile or of a packet, so that some are cut.
const SIZE: [u32; 2] = [117, 75];

fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
}

fn octrees() -> Vec<(&'static str, Octree)> {
    let random = &mut Random::new(1);
    vec![
        ("torus", Model::of_depth(&torus(0.12, 48, 24).colored_mesh(), 7).octree),
        ("sphere", Model::of_depth(&sphere(4).colored_mesh(), 6).octree),
        ("random, pruned", Tree::random(random, 6, 0.1, 0.1).octree()),
        ("random, odd", Tree::random(random, 5, 0.02, 0.0).octree()),
        ("full", Tree::random(random, 3, 1.0, 0.3).octree()),
        ("empty", Tree::empty().octree()),
    ]
}

/// The picture in every setting that must not change it.
#[test]
fn every_width_and_number_of_threads_gives_the_same_picture() {
    for (name, octree) in octrees() {
        for quality in [
            Quality { lod_pixels: 0.0, ..Quality::of_samples(1) },
            Quality { lod_pixels: 0.0, ..Quality::of_samples(3) },
            Quality { lod_pixels: 4.0, ..Quality::of_samples(1) },
        ] {
            let mut first: Option<Frame> = None;
            for width in Width::ALL {
                for threads in [1, 2, 3, 8] {
                    let options = RenderOptions {
                        size: SIZE,
                        quality,
                        width,
                        first_hits: true,
                        ..RenderOptions::default()
                    };
                    let frame = on_threads(threads, || picture(&octree, &options));
                    let first = first.get_or_insert_with(|| frame.clone());
                    let setting = format!("{name}, {quality:?}, {width:?}, {threads} threads");
                    assert_eq!(frame.hash(), first.hash(), "{setting}");
                    assert!(frame == *first, "{setting}: same pixels, other hits");
                }
            }
        }
    }
}

/// Distance, node and part of each pixel.
fn bits(seen: &Visibility) -> impl Iterator<Item = [u32; 3]> {
    let distances = seen.distance.iter().map(|distance| distance.to_bits());
    distances.zip(&seen.node).zip(&seen.part).map(|((distance, &node), &part)| [distance, node, part])
}

/// Primary visibility alone: distances, voxels, rays, hits and steps.
#[test]
fn every_width_sees_the_same() {
    for (name, octree) in octrees() {
        let camera = framing(&octree, SIZE);
        let see = |width, threads| {
            on_threads(threads, || {
                let mut seen = Visibility::default();
                let options = VisibilityOptions {
                    width,
                    beams: false,
                    count_steps: true,
                    ..VisibilityOptions::default()
                };
                let counts = seen.trace(&octree, &camera, SIZE, &options).unwrap();
                (seen, counts)
            })
        };
        let (_, counts) = see(Width::One, 1);
        assert_eq!(counts.rays, u64::from(SIZE[0]) * u64::from(SIZE[1]));
        let quality = Quality { lod_pixels: 0.0, ..Quality::default() };
        let frame = picture(&octree, &RenderOptions { size: SIZE, quality, ..RenderOptions::default() });
        assert_eq!(counts.hits, frame.hit_pixels, "{name}");
        for width in Width::ALL {
            let (reference, reference_counts) = see(width, 1);
            // How many lanes had nothing to do depends on how many there are.
            let Counts { lane_steps, .. } = reference_counts;
            assert_eq!(reference_counts, Counts { lane_steps, ..counts }, "{name}, {width:?}");
            assert!(lane_steps >= counts.steps, "{name}, {width:?}");
            for threads in [2, 3, 8] {
                let (seen, counts) = see(width, threads);
                assert_eq!(counts, reference_counts, "{name}, {width:?}, {threads} threads");
                assert!(bits(&seen).eq(bits(&reference)), "{name}, {width:?}, {threads} threads");
            }
        }
    }
}

/// Rays of a beam go together, part, and change packets, and see what each would see alone.
#[test]
fn beams_change_nothing_that_is_seen() {
    // In the smallest picture pixels are so large that rays part levels above the finest cells.
    for ((name, octree), size) in octrees().iter().flat_map(|octree| [(octree, SIZE), (octree, [23, 17])]) {
        let mut camera = framing(octree, size);
        for distance in [1.0, 0.5, 0.1, 2.0] {
            camera.eye = camera.target + (camera.eye - camera.target) * distance;
            for lod_pixels in [0.0, 1.0, 20.0] {
                for width in Width::ALL {
                    let setting =
                        format!("{name}, {size:?}, distance {distance}, {lod_pixels} pixels, {width:?}");
                    let see = |beams, count_steps| {
                        let mut seen = Visibility::default();
                        let options = VisibilityOptions {
                            width,
                            lod_pixels,
                            beams,
                            count_steps,
                            ..VisibilityOptions::default()
                        };
                        let counts = seen.trace(octree, &camera, size, &options).unwrap();
                        (seen, counts)
                    };
                    let [(without, alone), (with, _), (counted, counts)] =
                        [see(false, false), see(true, false), see(true, true)];
                    let changed = bits(&without).zip(bits(&with)).filter(|(a, b)| a != b).count();
                    assert_eq!(changed, 0, "{setting}");
                    assert!(bits(&with).eq(bits(&counted)), "{setting}");
                    assert_eq!((counts.rays, counts.hits), (alone.rays, alone.hits), "{setting}");
                    assert!(counts.steps <= counts.lane_steps, "{setting}");
                }
            }
        }
    }
}

/// Whether two hits are at the same distance in the same cell. Of a large leaf, a grid of smaller cells may name a part.
fn is_same_place(a: &Option<Hit>, b: &Option<Hit>) -> bool {
    match (a, b) {
        (None, None) => true,
        (Some(a), Some(b)) => {
            let large = if a.size_log2 > b.size_log2 { a } else { b };
            let same = a.distance.to_bits() == b.distance.to_bits() && a.payload == b.payload;
            same && is_of_hit(large, a.cell) && is_of_hit(large, b.cell)
        }
        _ => false,
    }
}

/// Grids only skip empty cells: on rays that single precision follows exactly, they change nothing.
#[test]
fn no_grid_changes_an_exact_hit() {
    for (name, mut octree) in octrees() {
        let random = &mut Random::new(2);
        let rays: Vec<Ray> = (0..3000).map(|_| exact_in_single_precision(random).to_ray()).collect();
        octree.set_grid(0);
        let hits = hits_of_every_width(&octree, &rays);
        for level in 1..=8 {
            octree.set_grid(level);
            for ((ray, hit), other) in rays.iter().zip(&hits).zip(hits_of_every_width(&octree, &rays)) {
                assert!(
                    is_same_place(hit, &other),
                    "{name}, grid level {level}: {ray:?}, {hit:?} became {other:?}"
                );
            }
        }
    }
}

/// Rays of the lattice meet the same places through any grid, and what they meet is right.
#[test]
fn no_grid_is_wrong() {
    for (name, mut octree) in octrees() {
        let random = &mut Random::new(3);
        let rays: Vec<Ray> = (0..4000).map(|_| on_the_lattice(random).to_ray()).collect();
        octree.set_grid(0);
        let hits = hits_of_every_width(&octree, &rays);
        for level in 0..=8 {
            octree.set_grid(level);
            let others = hits_of_every_width(&octree, &rays);
            let changed = hits.iter().zip(&others).filter(|(hit, other)| !is_same_place(hit, other)).count();
            assert_eq!(changed, 0, "{name}: of {} hits that change with grid level {level}", rays.len());
            let options = CheckOptions { rays: 4000, seed: level.into(), ..CheckOptions::default() };
            let report = check(&octree, &options, |_| {});
            assert!(report.is_right(), "{name}, grid level {level}: {report:?}");
        }
    }
}

/// The check itself tells the same on any number of threads.
#[test]
fn the_check_does_not_depend_on_threads() {
    let octree = Model::of_depth(&torus(0.2, 48, 24).mesh(), 6).octree;
    let options = CheckOptions { rays: 20_000, seed: 5, ..CheckOptions::default() };
    let reports = [1, 2, 3, 8].map(|threads| on_threads(threads, || check(&octree, &options, |_| {})));
    assert!(reports.iter().all(|report| report == &reports[0]), "{reports:?}");
}

/// The same mesh gives the same bytes, converted twice, on any number of threads, its triangles in any order.
#[test]
fn the_file_is_the_same_on_any_number_of_threads() {
    let mesh = torus(0.2, 60, 30).colored_mesh();
    for options in [
        Options { depth: 7, ..Options::default() },
        Options { depth: 6, palette_size: 20, conservative: true, prune: false, ..Options::default() },
    ] {
        let first = Model::new(&mesh, &options).file;
        for threads in [1, 1, 2, 3, 8] {
            let file = on_threads(threads, || Model::new(&mesh, &options).file);
            assert!(file == first, "{threads} threads, {options:?}");
        }
        assert!(Reader::new(&first[..]).unwrap().all(|record| record.is_ok()));
    }
}

#[test]
fn the_order_of_triangles_and_corners_does_not_change_the_file() {
    let shape = sphere(3);
    let convert = |shape: &octvox_tests::meshes::Shape| Model::of_depth(&shape.mesh(), 6).file;
    let first = convert(&shape);
    let random = &mut Random::new(4);
    for _ in 0..5 {
        let mut shuffled = shape.clone();
        for place in (1..shuffled.triangles.len()).rev() {
            shuffled.triangles.swap(place, random.between(0, place as i32) as usize);
            let turns = random.between(0, 2) as usize;
            shuffled.triangles[place].rotate_left(turns);
        }
        assert!(convert(&shuffled) == first);
    }
}
