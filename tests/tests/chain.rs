//! The whole chain: a mesh, its file, the octree in memory, a picture.

use glam::DVec3;
use octvox_converter::{Mesh, Options};
use octvox_format::{Reader, Record, summarize};
use octvox_raytracer::{Ray, RenderOptions};
use octvox_tests::meshes::{Shape, cube, sphere, torus};
use octvox_tests::models::{Model, SAMPLES, sample, shared};
use octvox_tests::pictures::picture;
use octvox_tests::rays::hits_of_every_width;

/// The finest cells of the leaves of a file, as lowest cell, side in cells, and record.
fn leaves(file: &[u8], depth: u8) -> Vec<([u32; 3], u32, Record)> {
    let mut leaves = Vec::new();
    let mut corners = vec![[0u32; 3]; usize::from(depth) + 1];
    for record in Reader::new(file).unwrap() {
        let record = record.unwrap();
        let side = 1u32 << (depth - record.level);
        let level = usize::from(record.level);
        if level > 0 {
            let parent = corners[level - 1];
            corners[level] = [0, 1, 2].map(|axis| parent[axis] + side * u32::from(record.octant >> axis & 1));
        }
        if !record.has_children {
            leaves.push((corners[level], side, record));
        }
    }
    leaves
}

/// What every model must satisfy on its way.
fn assert_chain(name: &str, model: &Model, depth: u8) {
    let Model { file, report, octree } = model;
    let summary = summarize(Reader::new(&file[..]).unwrap()).unwrap();
    assert!(summary.is_valid(), "{name}: {:?}", summary.first_defect);
    assert_eq!((report.depth, report.resolution), (depth, 1 << depth), "{name}");
    assert_eq!((summary.depth, octree.depth()), (depth, depth), "{name}");
    assert_eq!(u128::from(report.leaf_voxels), summary.leaf_voxels, "{name}");
    assert_eq!(report.leaf_voxels, octree.leaf_voxels(), "{name}");
    assert_eq!((report.nodes, report.stored_voxels), (summary.nodes, summary.stored_voxels), "{name}");
    assert_eq!(report.stored_voxels, 1 + 8 * report.nodes, "{name}");
    assert!(report.thesis_voxels >= report.stored_voxels, "{name}");
    assert_eq!((report.file_bytes, summary.file_bytes), (file.len() as u64, file.len() as u64), "{name}");
    assert_eq!(report.palette_size as usize, octree.palette().len(), "{name}");

    // Every cell of every leaf is in the octree as it is in the file, and nothing is beyond the bounds.
    let (mut low, mut high, mut filled) = ([u32::MAX; 3], [0; 3], 0);
    for (corner, side, record) in leaves(file, depth) {
        let voxel = record.voxel;
        // Of a large leaf, the corners stand for all cells.
        let offsets = if side == 1 {
            vec![[0; 3]]
        } else {
            (0..8).map(|k| [0, 1, 2].map(|axis| (k >> axis & 1) * (side - 1))).collect()
        };
        for offset in offsets {
            let cell = [0, 1, 2].map(|axis| corner[axis] + offset[axis]);
            let found = octree.voxel(cell).map(|payload| payload.voxel());
            assert_eq!(found, Some(voxel).filter(|voxel| !voxel.is_empty()), "{name}: cell {cell:?}");
        }
        if !voxel.is_empty() {
            filled += u64::from(side).pow(3);
            low = [0, 1, 2].map(|axis| low[axis].min(corner[axis]));
            high = [0, 1, 2].map(|axis| high[axis].max(corner[axis] + side));
        }
    }
    assert_eq!(filled, octree.leaf_voxels(), "{name}");
    assert_eq!((octree.bounds().low, octree.bounds().high), (low, high), "{name}");
    // The longest axis fills the cube.
    let extent = (0..3).map(|axis| high[axis] - low[axis]).max();
    assert_eq!(extent, Some(octree.resolution()), "{name}");
}

/// A picture of the whole model shows something, and not everywhere.
fn assert_is_seen(name: &str, model: &Model) {
    let frame = picture(&model.octree, &RenderOptions { size: [96, 64], ..RenderOptions::default() });
    let area = u64::from(frame.width * frame.height);
    assert!(
        frame.hit_pixels > area / 20 && frame.hit_pixels < area,
        "{name}: {} of {area}",
        frame.hit_pixels
    );
    assert_eq!(frame.pixels.len() as u64, area);
    assert!(frame.pixels.iter().all(|pixel| pixel[3] == 255), "{name} is opaque");
}

#[test]
fn generated_models() {
    for (name, shape) in [("cube", cube()), ("sphere", sphere(4)), ("torus", torus(0.15, 96, 48))] {
        for depth in [1, 2, 5, 6, 7] {
            let model = Model::of_depth(&shape.colored_mesh(), depth);
            assert_chain(name, &model, depth);
            assert_is_seen(name, &model);
        }
    }
}

#[test]
fn samples() {
    for name in SAMPLES {
        let mesh = sample(name);
        for depth in [6, 8] {
            let model = Model::of_depth(&mesh, depth);
            assert!(model.report.warnings.is_empty(), "{name}: {:?}", model.report.warnings);
            assert_eq!(model.report.triangles, mesh.triangles().len() as u64);
            assert_chain(name, &model, depth);
            assert_is_seen(name, &model);
        }
    }
}

#[test]
fn models_of_the_thesis() {
    let names = ["al", "bunny", "porsche", "soccerball", "teapot", "world_curved"];
    for path in
        names.map(|name| format!("seed/{name}.obj")).iter().map(String::as_str).chain(["textured/spot.obj"])
    {
        let Some(mesh) = shared(path) else { continue };
        let model = Model::of_depth(&mesh, 7);
        assert_chain(path, &model, 7);
        assert_is_seen(path, &model);
    }
}

/// The counts of an independent program at 8³, 64³ and 256³, in voxels of the unpruned file.
#[test]
fn counts_of_the_thesis() {
    let counts = [
        ("seed/porsche.obj", [(3, 201), (6, 14_681), (8, 258_305)]),
        ("seed/al.obj", [(3, 249), (6, 21_953), (8, 428_505)]),
    ];
    for (path, counts) in counts {
        let Some(mesh) = shared(path) else { continue };
        for (depth, expected) in counts {
            let found = Model::of_depth(&mesh, depth).report.thesis_voxels;
            // Where a surface runs along a plane of cells, either side is right.
            let difference = (found as f64 / f64::from(expected) - 1.0).abs();
            assert!(difference < 0.02, "{path} at depth {depth}: {found} instead of {expected}");
        }
    }
}

/// A box that spans the cube is the full shell of 8³ cells, not 8×8×7.
#[test]
fn a_box_that_spans_the_cube_is_its_whole_shell() {
    let scaled = |scale: f64, offset: DVec3| {
        let shape = cube();
        let positions = shape.positions.iter().map(|position| *position * scale + offset).collect();
        Shape { positions, ..shape }
    };
    let boxes = [
        cube(),
        scaled(8.0, DVec3::ZERO),
        scaled(1.0 / 3.0, DVec3::new(0.1, -7.7, 1e3)),
        scaled(1e-7, DVec3::ZERO),
        scaled(1.0, DVec3::new(1e7, -1e7, 1e7)),
    ];
    for (number, shape) in boxes.iter().enumerate() {
        for conservative in [false, true] {
            let options = Options { depth: 3, conservative, ..Options::default() };
            let model = Model::new(&shape.mesh(), &options);
            assert_eq!(model.report.leaf_voxels, 8 * 8 * 8 - 6 * 6 * 6, "box {number}");
            for code in 0..512u32 {
                let cell = [code % 8, code / 8 % 8, code / 64];
                let on_shell = cell.iter().any(|coordinate| [0, 7].contains(coordinate));
                assert_eq!(model.octree.is_filled(cell), on_shell, "box {number}: {cell:?}");
            }
        }
    }
}

/// What the converter says about the world leads from a ray's hit back to the surface of the mesh.
#[test]
fn hits_lead_back_to_the_world() {
    let (centre, radius) = (DVec3::new(3.0, -20.0, 100.0), 7.0);
    let mut shape = sphere(5);
    for position in &mut shape.positions {
        *position = centre + (*position - 0.5) * 2.0 * radius;
    }
    let model = Model::of_depth(&shape.mesh(), 8);
    let world = model.report.world;
    let origin = DVec3::from_array(world.origin);
    let size = world.voxel_size * 256.0;
    let to_unit = |point: DVec3| (point - origin) / size;
    let rays: Vec<Ray> = octvox_tests::rays::axes_and_diagonals()
        .map(|direction| DVec3::from_array(direction.map(f64::from)).normalize())
        .map(|direction| Ray {
            origin: to_unit(centre + direction * 3.0 * radius),
            direction: -direction / size,
        })
        .collect();
    for (ray, hit) in rays.iter().zip(hits_of_every_width(&model.octree, &rays)) {
        // The direction is one world unit long, so distances are in the world.
        let distance = hit.unwrap().distance;
        assert!((distance - 2.0 * radius).abs() < 2.0 * world.voxel_size, "{ray:?}: {distance}");
    }
}

/// Colours go all the way: a voxel shows the colour of the mesh where it is.
#[test]
fn colors_lie_where_they_were_painted() {
    let model = Model::of_depth(&sphere(5).colored_mesh(), 6);
    let size = f64::from(model.octree.resolution());
    let mut seen = 0;
    for (corner, _, record) in leaves(&model.file, 6) {
        let Some(color) = model.octree.palette().color(record.voxel.palette_index) else { continue };
        // The mesh is painted with its own coordinates.
        let expected = (DVec3::from_array(corner.map(f64::from)) + 0.5) / size * 255.0;
        for axis in 0..3 {
            let found = f64::from(color[axis]);
            assert!((found - expected[axis]).abs() < 8.0, "{corner:?}: {color:?} instead of {expected}");
        }
        seen += 1;
    }
    assert!(seen > 5000);
}

/// Normals go all the way: those of a sphere point away from its middle.
#[test]
fn normals_point_outwards() {
    let model = Model::of_depth(&sphere(5).mesh(), 6);
    for (corner, side, record) in leaves(&model.file, 6) {
        if record.voxel.is_empty() {
            continue;
        }
        let middle = (DVec3::from_array(corner.map(f64::from)) + f64::from(side) / 2.0) / 64.0;
        let normal = DVec3::from_array(record.voxel.normal.decode().map(f64::from));
        assert!(normal.dot((middle - 0.5).normalize()) > 0.99, "{corner:?}: {normal}");
    }
}

/// A mesh without extent is one voxel in the middle, and is seen.
#[test]
fn a_single_point_is_a_voxel() {
    let mesh = Mesh::new(vec![[5.0; 3]], vec![[0, 0, 0]]).unwrap();
    let model = Model::of_depth(&mesh, 5);
    assert_eq!((model.report.leaf_voxels, model.octree.leaf_voxels()), (1, 1));
    let frame = picture(&model.octree, &RenderOptions { size: [32, 32], ..RenderOptions::default() });
    assert!(frame.hit_pixels > 32 * 32 / 4);
}
