//! What stands for a cell from afar, and pictures that end at it.

use glam::DVec3;
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

/// Unit directions of the rays of a picture, row by row from the top.
fn directions_of_pixels(camera: &Camera, [width, height]: [u32; 2]) -> Vec<DVec3> {
    let forward = (camera.target - camera.eye).normalize();
    let right = forward.cross(camera.up).normalize();
    let up = right.cross(forward);
    let pixel = 2.0 * (camera.vertical_fov.to_radians() / 2.0).tan() / f64::from(height);
    let offset = |place: u32, count: u32| (f64::from(place) + 0.5 - f64::from(count) / 2.0) * pixel;
    (0..width * height)
        .map(|place| (offset(place % width, width), offset(place / width, height)))
        .map(|(x, y)| (forward + right * x - up * y).normalize())
        .collect()
}

/// A cell of a level: its low corner and its size.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Cell {
    low: DVec3,
    size: f64,
}

impl Cell {
    /// The cell of a level that a ray comes into at a point; nothing if that is so near an edge that it may be another.
    ///
    /// # Panics
    /// If the point is on no face.
    fn entered_at(point: DVec3, direction: DVec3, level: u8) -> Option<Self> {
        /// Shares of a cell: more than points are off by roundings.
        const NEAR: f64 = 2e-3;
        let size = 0.5f64.powi(level.into());
        let place = (point / size).to_array();
        let is_near = place.map(|part| (part - part.round()).abs() < NEAR);
        assert!(is_near.contains(&true), "{point} is within a cell of level {level}");
        let low = std::array::from_fn(|axis| match (is_near[axis], direction[axis] > 0.0) {
            (false, _) => place[axis].floor(),
            (true, true) => place[axis].round(),
            (true, false) => place[axis].round() - 1.0,
        });
        let is_on_one_face = is_near.iter().filter(|&&is_near| is_near).count() == 1;
        is_on_one_face.then_some(Self { low: DVec3::from_array(low) * size, size })
    }

    /// The distance at which a ray comes in, if it goes through more than the outermost hundredth.
    fn entry(&self, eye: DVec3, direction: DVec3) -> Option<f64> {
        let margin = self.size / 100.0;
        let a = (self.low + margin - eye) / direction;
        let b = (self.low + self.size - margin - eye) / direction;
        let (enter, leave) = (a.min(b).max_element().max(0.0), a.max(b).min_element());
        (enter < leave).then_some(enter)
    }
}

/// A ray comes into the cell in which it ends through a face of that, and no other ray of the picture gets through it:
/// coarse cells are as solid as the finest, though not all of their children are filled.
#[test]
fn cells_of_every_level_are_solid() {
    const SIZE: [u32; 2] = [72, 54];
    let random = &mut Random::new(77);
    let octrees = [
        Model::of_depth(&torus(0.1, 48, 24).colored_mesh(), 7).octree,
        Tree::random(random, 6, 0.03, 0.1).octree(),
        Tree::random(random, 7, 0.01, 0.0).octree(),
    ];
    let mut coarse_cells = 0;
    for octree in &octrees {
        let mut camera = framing(octree, SIZE);
        let away = camera.eye - camera.target;
        for (distance, lod_pixels) in [(1.0, 0.0), (1.0, 2.0), (1.0, 6.0), (0.6, 4.0), (0.6, 15.0)] {
            camera.eye = camera.target + away * distance;
            let options = RenderOptions { size: SIZE, ..lod_options(lod_pixels) };
            let hits = render(octree, &camera, &options, |_| {}).unwrap().0.first_hits.unwrap();
            let directions = directions_of_pixels(&camera, SIZE);
            let mut seen: Vec<Cell> = Vec::new();
            for (&direction, hit) in directions.iter().zip(&hits) {
                if !hit.distance.is_finite() || hit.distance == 0.0 {
                    continue;
                }
                let point = camera.eye + direction * f64::from(hit.distance);
                if let Some(cell) = Cell::entered_at(point, direction, hit.level)
                    && !seen.contains(&cell)
                {
                    seen.push(cell);
                    coarse_cells += u32::from(hit.level < octree.depth());
                }
            }
            for (&direction, hit) in directions.iter().zip(&hits) {
                for cell in &seen {
                    assert!(
                        cell.entry(camera.eye, direction)
                            .is_none_or(|entry| f64::from(hit.distance) <= entry),
                        "{lod_pixels} pixels: {direction} goes through {cell:?} to {hit:?}"
                    );
                }
            }
        }
    }
    assert!(coarse_cells > 1000, "{coarse_cells}");
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
