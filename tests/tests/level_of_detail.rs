//! What stands for a cell from afar, and pictures that end at it.

use octvox_converter::{Mesh, Options};
use octvox_format::{Reader, Record, Voxel};
use octvox_raytracer::{Camera, Frame, Octree, Quality, RenderOptions, Width, render};
use octvox_tests::meshes::{cube, sphere, torus};
use octvox_tests::models::{Model, SAMPLES, sample, shared};
use octvox_tests::pictures::{framing, picture};
use octvox_tests::random::Random;
use octvox_tests::tree::Tree;

fn records(file: &[u8]) -> (usize, Vec<Record>) {
    let mut reader = Reader::new(file).unwrap();
    let records = reader.by_ref().collect::<Result<_, _>>().unwrap();
    (reader.palette().len(), records)
}

/// Checks a file: a parent is filled if and only if a child is, and palette indices are in range. Returns the number of
/// parents. What they look like is tested beside the converter.
fn assert_levels_of_detail(file: &[u8]) -> usize {
    let (colors, records) = records(file);
    let mut parents = 0;
    for (place, record) in records.iter().enumerate() {
        assert!(usize::from(record.voxel.palette_index) <= colors);
        if !record.has_children {
            continue;
        }
        parents += 1;
        let children: Vec<Voxel> = records[place + 1..]
            .iter()
            .take_while(|other| other.level > record.level)
            .filter(|other| other.level == record.level + 1)
            .map(|child| child.voxel)
            .filter(|child| !child.is_empty())
            .collect();
        assert!(!children.is_empty(), "record {place}: a parent of empty children");
        assert!(!record.voxel.is_empty(), "record {place}: an empty parent of filled children");
    }
    parents
}

#[test]
fn a_parent_is_filled_if_and_only_if_a_child_is() {
    for shape in [cube(), sphere(3), torus(0.2, 24, 12)] {
        for depth in [0, 1, 3, 5, 6] {
            for options in [
                Options { depth, ..Options::default() },
                Options { depth, prune: false, palette_size: 7, ..Options::default() },
                Options { depth, conservative: true, ..Options::default() },
            ] {
                let model = Model::new(&shape.colored_mesh(), &options);
                assert_eq!(assert_levels_of_detail(&model.file) as u64, model.report.nodes);
            }
        }
    }
}

#[test]
fn in_samples_too() {
    for name in SAMPLES {
        let model = Model::of_depth(&sample(name), 7);
        assert_eq!(assert_levels_of_detail(&model.file) as u64, model.report.nodes, "{name}");
    }
}

#[test]
fn in_models_of_the_thesis_too() {
    for name in ["seed/al.obj", "seed/porsche.obj", "textured/spot.obj"] {
        if let Some(mesh) = shared(name) {
            assert!(assert_levels_of_detail(&Model::of_depth(&mesh, 7).file) > 1000);
        }
    }
}

fn lod_options(lod_pixels: f64) -> RenderOptions {
    RenderOptions {
        size: [160, 120],
        quality: Quality { lod_pixels, ..Quality::default() },
        first_hits: true,
        ..RenderOptions::default()
    }
}

/// Roundings of a distance, relative: seen past an edge, two cells that share it are at distances that differ by some.
const ROUNDINGS: f32 = 1.0 / (1 << 19) as f32;

/// Every pixel that the exact picture covers is covered, no later on the ray, by a cell that is no finer.
fn assert_covers(name: &str, coarse: &Frame, exact: &Frame) {
    let (coarse, exact) = (coarse.first_hits.as_ref().unwrap(), exact.first_hits.as_ref().unwrap());
    for (pixel, (coarse, exact)) in coarse.iter().zip(exact).enumerate() {
        if exact.distance.is_finite() {
            assert!(
                coarse.distance <= exact.distance * (1.0 + ROUNDINGS),
                "{name}, pixel {pixel}: {coarse:?} for {exact:?}"
            );
            assert!(coarse.level <= exact.level, "{name}, pixel {pixel}: {coarse:?} for {exact:?}");
        }
    }
}

/// A coarser cell covers its children, so ending rays early opens no hole, at any footprint.
#[test]
fn coarse_pictures_cover_what_exact_ones_do() {
    let meshes: [(&str, Mesh); 3] = [
        ("cube", cube().colored_mesh()),
        ("sphere", sphere(4).colored_mesh()),
        ("torus", torus(0.1, 48, 24).colored_mesh()),
    ];
    for (name, mesh) in meshes {
        for depth in [6, 7, 8] {
            let octree = Model::of_depth(&mesh, depth).octree;
            let exact = picture(&octree, &lod_options(0.0));
            let mut hit_pixels = exact.hit_pixels;
            for lod_pixels in [0.5, 1.0, 2.0, 3.7, 10.0, 50.0, 1000.0] {
                let coarse = picture(&octree, &lod_options(lod_pixels));
                assert_covers(&format!("{name} at depth {depth}, {lod_pixels} pixels"), &coarse, &exact);
                // Coarser and coarser, larger and larger.
                assert!(coarse.hit_pixels >= hit_pixels, "{name} at depth {depth}, {lod_pixels} pixels");
                hit_pixels = coarse.hit_pixels;
            }
        }
    }
}

#[test]
fn coarse_pictures_of_samples_cover_what_exact_ones_do() {
    for name in SAMPLES {
        let octree = Model::of_depth(&sample(name), 8).octree;
        let exact = picture(&octree, &lod_options(0.0));
        for lod_pixels in [1.0, 4.0, 32.0] {
            let coarse = picture(&octree, &lod_options(lod_pixels));
            assert_covers(&format!("{name}, {lod_pixels} pixels"), &coarse, &exact);
        }
    }
}

/// Random octrees, where neighbours differ in size as much as can be, from near and far.
#[test]
fn random_octrees_have_no_cracks() {
    for seed in 0..12 {
        let random = &mut Random::new(seed);
        let octree = Tree::random(random, 4 + (seed % 3) as u8, 0.03, 0.1).octree();
        let mut camera = framing(&octree, [160, 120]);
        for distance in [1.0, 0.3, 3.0] {
            camera.eye = camera.target + (camera.eye - camera.target) * distance;
            let render = |lod_pixels| render(&octree, &camera, &lod_options(lod_pixels), |_| {}).unwrap().0;
            let exact = render(0.0);
            for lod_pixels in [0.7, 3.0, 20.0] {
                assert_covers(&format!("seed {seed}, {lod_pixels} pixels"), &render(lod_pixels), &exact);
            }
        }
    }
}

/// Cells are as large as they may be and no larger, but for what a node is deep: its middle decides.
#[test]
fn cells_look_as_large_as_asked_for() {
    let octree = Model::of_depth(&torus(0.1, 96, 48).colored_mesh(), 9).octree;
    let mut camera = framing(&octree, [160, 120]);
    let away = (camera.eye - camera.target).normalize();
    for distance in [1.4, 3.0, 1000.0] {
        camera.eye = camera.target + away * distance;
        // All of the cube; so narrow that a distance along a ray is one along the direction of the picture's middle, nearly:
        // 0.86 of it in a corner of the nearest.
        let camera = Camera { vertical_fov: 2.0 * (0.5_f64 / distance).atan().to_degrees(), ..camera };
        let pixel = 1.0 / distance / 120.0;
        // Cells between the finest and those of the grid.
        for cells_across in [40.0, 70.0, 130.0, 250.0] {
            let lod_pixels = 1.0 / cells_across / (pixel * distance);
            let (frame, _) = render(&octree, &camera, &lod_options(lod_pixels), |_| {}).unwrap();
            let hits = frame.first_hits.unwrap();
            let mut hits = hits.iter().filter(|hit| hit.distance.is_finite()).peekable();
            assert!(hits.peek().is_some());
            for hit in hits {
                let size = 0.5f64.powi(hit.level.into());
                let largest = |distance: f64| lod_pixels * pixel * distance;
                let (met, parent) = (f64::from(hit.distance), 16.0 * size * 3f64.sqrt());
                let is_finest = hit.level == octree.depth();
                assert!(
                    is_finest || size <= largest(met + parent),
                    "{hit:?}, {lod_pixels} pixels at {distance}"
                );
                assert!(
                    2.0 * size > largest(met * 0.85 - parent),
                    "{hit:?}, {lod_pixels} pixels at {distance}"
                );
            }
        }
    }
}

/// A footprint smaller than every voxel changes nothing, and one larger than the model shows its root; or, where that covers
/// one level only, the cells of that.
#[test]
fn the_two_ends_of_the_scale() {
    for (depth, coarsest) in [(6, 0), (7, 1)] {
        the_two_ends(&Model::of_depth(&sphere(4).colored_mesh(), depth).octree, coarsest);
    }
}

fn the_two_ends(octree: &Octree, coarsest: u8) {
    let exact = picture(octree, &lod_options(0.0));
    assert_eq!(picture(octree, &lod_options(1e-6)).pixels, exact.pixels);
    let root = picture(octree, &lod_options(1e6));
    let levels: Vec<u8> =
        root.first_hits.unwrap().iter().filter(|hit| hit.distance.is_finite()).map(|hit| hit.level).collect();
    assert!(!levels.is_empty() && levels.iter().all(|&level| level == coarsest), "{levels:?}");
}

/// The picture with levels of detail is the same for every width.
#[test]
fn every_width_ends_at_the_same_cells() {
    let octree = Model::of_depth(&torus(0.1, 48, 24).colored_mesh(), 7).octree;
    for lod_pixels in [1.0, 5.0, 40.0] {
        let frames =
            Width::ALL.map(|width| picture(&octree, &RenderOptions { width, ..lod_options(lod_pixels) }));
        assert!(frames.iter().all(|frame| frame == &frames[0]), "{lod_pixels} pixels");
    }
}
