//! Filled models: what is inside, what it costs, and what is refused.

mod support;

use octvox_cli::Progress;
use octvox_converter::{Compression, ConvertError, FileFormat, Material, Mesh, Options, convert};
use octvox_format::to_version_4;
use octvox_format::v5::Archive;
use std::collections::{BTreeMap, BTreeSet};
use support::{Cell, Tree, convert_to_bytes, cuboid, icosphere, torus, unit_voxels, voxels};

fn cells(mesh: &Mesh, options: &Options) -> BTreeSet<Cell> {
    voxels(mesh, options).into_keys().collect()
}

fn solid(options: &Options) -> Options {
    Options { solid: true, ..options.clone() }
}

/// A filled model is its surface and the empty cells whose centres are inside; `certain` tells which cells are neither
/// so near the surface that the triangles' flatness matters.
fn assert_filled(
    mesh: &Mesh,
    depth: u8,
    inside: impl Fn([f64; 3]) -> bool,
    certain: impl Fn([f64; 3]) -> bool,
) -> usize {
    let options = unit_voxels(depth);
    let surface = cells(mesh, &options);
    let filled = cells(mesh, &solid(&options));
    let mut interior = 0;
    for z in 0..1 << depth {
        for y in 0..1 << depth {
            for x in 0..1 << depth {
                let cell = [x, y, z];
                let center = cell.map(|c| f64::from(c) + 0.5);
                if surface.contains(&cell) {
                    assert!(filled.contains(&cell), "{cell:?} is surface");
                } else if certain(center) {
                    assert_eq!(filled.contains(&cell), inside(center), "{cell:?}");
                }
                interior += usize::from(filled.contains(&cell) && !surface.contains(&cell));
            }
        }
    }
    interior
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt()
}

#[test]
fn a_sphere_is_a_ball() {
    let center = [31.3, 32.1, 31.8];
    let radius = |point| distance(point, center);
    let ball = icosphere(center, 28.0, 5);
    let interior = assert_filled(&ball, 6, |p| radius(p) < 28.0, |p| (radius(p) - 28.0).abs() > 0.1);
    // All that is farther than a voxel's diagonal inside.
    assert!(interior > (4.0 / 3.0 * std::f64::consts::PI * 26.3f64.powi(3)) as usize);
}

#[test]
fn a_torus_keeps_its_hole() {
    let center = [63.7, 64.2, 64.1];
    let from_ring = |p: [f64; 3]| ((p[0] - center[0]).hypot(p[1] - center[1]) - 40.0).hypot(p[2] - center[2]);
    // Two blocks along each axis.
    let mesh = torus(center, 40.0, 20.0, 300, 150);
    assert_filled(&mesh, 7, |p| from_ring(p) < 20.0, |p| (from_ring(p) - 20.0).abs() > 0.1);
}

/// Whether a cell of 9³ belongs to Menger's sponge of the second step.
fn is_sponge(cell: [i32; 3]) -> bool {
    cell.iter().all(|c| (0..9).contains(c))
        && [1, 3].iter().all(|size| cell.iter().filter(|&&c| c / size % 3 == 1).count() < 2)
}

/// The faces between the sponge's cells and the rest, as a mesh with cells of `size`.
fn sponge(size: f64) -> Mesh {
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for index in 0..9 * 9 * 9 {
        let cell = [index % 9, index / 9 % 9, index / 81];
        for axis in 0..3 {
            for step in [-1, 1] {
                let mut neighbor = cell;
                neighbor[axis] += step;
                if !is_sponge(cell) || is_sponge(neighbor) {
                    continue;
                }
                let first = positions.len() as u32;
                let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
                for (along_u, along_v) in [(0, 0), (1, 0), (1, 1), (0, 1)] {
                    let mut corner = cell;
                    corner[axis] += i32::from(step > 0);
                    corner[u] += along_u;
                    corner[v] += along_v;
                    positions.push(corner.map(|c| f64::from(c) * size));
                }
                let quad = if step > 0 { [[0, 1, 2], [0, 2, 3]] } else { [[0, 2, 1], [0, 3, 2]] };
                triangles.extend(quad.map(|triangle| triangle.map(|corner: u32| first + corner)));
            }
        }
    }
    Mesh::new(positions, triangles).unwrap()
}

#[test]
fn a_sponge_is_filled_cell_by_cell() {
    let inside = |p: [f64; 3]| is_sponge(p.map(|c| (c / 7.0).floor() as i32));
    let interior = assert_filled(&sponge(7.0), 6, inside, |_| true);
    assert!(interior > 0);
    // 400 cubes of 7³ voxels, and a layer where surface lies on the far sides.
    let (_, report) = convert_to_bytes(&sponge(7.0), &solid(&unit_voxels(6)));
    assert!(report.leaf_voxels >= 400 * 343, "{}", report.leaf_voxels);
}

#[test]
fn what_a_shell_encloses_is_filled_with_all_shells_in_it() {
    let center = [32.0; 3];
    let (outer, inner) = (icosphere(center, 28.0, 4), icosphere(center, 12.0, 3));
    let count = outer.positions().len() as u32;
    let positions = [outer.positions(), inner.positions()].concat();
    let more = inner.triangles().iter().map(|triangle| triangle.map(|vertex| vertex + count));
    let triangles = outer.triangles().iter().copied().chain(more).collect();
    let both = Mesh::new(positions, triangles).unwrap();
    assert_eq!(cells(&both, &solid(&unit_voxels(6))), cells(&outer, &solid(&unit_voxels(6))));
}

/// A box whose upper side along x is cut into 8 × 8 squares, of which those that `open` names are missing.
fn box_with_holes(min: [f64; 3], max: [f64; 3], open: impl Fn(u32, u32) -> bool) -> Mesh {
    let corner = |k: usize| [0, 1, 2].map(|axis| if k >> axis & 1 == 1 { max[axis] } else { min[axis] });
    let mut positions: Vec<[f64; 3]> = Vec::new();
    let mut triangles = Vec::new();
    let mut quad = |corners: [[f64; 3]; 4]| {
        let first = positions.len() as u32;
        positions.extend(corners);
        triangles.extend([[0, 1, 2], [0, 2, 3]].map(|triangle: [u32; 3]| triangle.map(|c| c + first)));
    };
    for sides in [[0, 4, 6, 2], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]] {
        quad(sides.map(corner));
    }
    let at = |i: u32, j: u32| {
        let between = |axis: usize, k: u32| min[axis] + (max[axis] - min[axis]) * f64::from(k) / 8.0;
        [max[0], between(1, i), between(2, j)]
    };
    for i in 0..8 {
        for j in 0..8 {
            if !open(i, j) {
                quad([at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
    }
    Mesh::new(positions, triangles).unwrap()
}

#[test]
fn a_box_with_a_hole_is_filled_up_to_the_hole() {
    let (min, max) = ([25.3, 36.2, 34.4], [100.3, 90.2, 94.4]);
    let options = unit_voxels(7);
    let mesh = box_with_holes(min, max, |i, j| (3..5).contains(&i) && (3..5).contains(&j));
    let filled = cells(&mesh, &solid(&options));
    let whole = cells(&cuboid(min, max), &solid(&options));
    // The sides are those of the closed box; only before and behind the hole, by less than its size, may they differ.
    let hole = [100.3, 63.2, 64.4];
    for cell in filled.symmetric_difference(&whole) {
        let center = cell.map(|c| f64::from(c) + 0.5);
        assert!(distance(center, hole) < 12.0, "{cell:?}");
    }
    let near = filled.symmetric_difference(&whole).count();
    assert!(near < 14 * 15 * 6, "{near}");

    // Nothing gets in any more, and there is nothing to get in to: all that is empty is reached from outside.
    let index = |[x, y, z]: Cell| (x + 128 * (y + 128 * z)) as usize;
    let mut closed = vec![false; 1 << 21];
    filled.iter().for_each(|cell| closed[index(*cell)] = true);
    let mut waiting = vec![[0u32; 3]];
    while let Some(cell) = waiting.pop() {
        if std::mem::replace(&mut closed[index(cell)], true) {
            continue;
        }
        for axis in 0..3 {
            for step in [u32::MAX, 1] {
                let mut neighbor = cell;
                neighbor[axis] = neighbor[axis].wrapping_add(step);
                if neighbor[axis] < 128 {
                    waiting.push(neighbor);
                }
            }
        }
    }
    assert!(closed.iter().all(|closed| *closed));
    assert!(filled.contains(&[40, 60, 60]));
}

#[test]
fn what_has_no_inside_is_refused() {
    let sheet = Mesh::new(
        vec![[1.0, 1.0, 8.0], [15.0, 1.0, 8.0], [15.0, 15.0, 8.0], [1.0, 15.0, 8.0]],
        vec![[0, 1, 2], [0, 2, 3]],
    )
    .unwrap();
    for depth in [4, 7] {
        let options = Options { depth, solid: true, ..Options::default() };
        let error = convert(&sheet, &options, &Progress::hidden(), &mut Vec::new()).unwrap_err();
        assert!(matches!(error, ConvertError::OpenMesh { open_edges: 4 }), "{error}");
    }
}

#[test]
fn the_inside_has_the_mean_color_and_costs_little() {
    let center = [64.0; 3];
    let ball = icosphere(center, 60.0, 5);
    // Half of the light comes from the upper half.
    let materials = vec![Material::matte("black", [0.0; 3]), Material::matte("white", [1.0; 3])];
    let upper =
        |triangle: &[u32; 3]| u32::from(triangle.iter().all(|v| ball.positions()[*v as usize][2] > 64.0));
    let of_triangle = ball.triangles().iter().map(upper).collect();
    let mesh = ball.with_materials(materials, of_triangle).unwrap();
    for prune in [false, true] {
        let options = Options { prune, ..unit_voxels(7) };
        let (_, hollow) = convert_to_bytes(&mesh, &options);
        let (bytes, filled) = convert_to_bytes(&mesh, &solid(&options));
        assert!(filled.stored_voxels * 10 < hollow.stored_voxels * 11, "{filled:?}");
        let tree = Tree::read(&bytes);
        let leaves: BTreeMap<Cell, _> = tree.leaves(7);
        assert_eq!(filled.leaf_voxels, leaves.len() as u64);
        let [red, green, blue] = tree.color(leaves[&[64; 3]]);
        // The nearest that there is to half of the light, 188.
        assert!(red == green && green == blue && (150..220).contains(&red), "{red} {green} {blue}");
        assert_eq!(leaves[&[64; 3]].normal.decode(), [0.0, 0.0, 1.0]);
    }
}

#[test]
fn version_5_is_filled_like_version_4() {
    let mesh = torus([63.7, 64.2, 64.1], 40.0, 20.0, 60, 30);
    for prune in [false, true] {
        let options = Options { prune, ..solid(&unit_voxels(7)) };
        let (_, expected) = convert_to_bytes(&mesh, &options);
        let format = FileFormat::Version5 { compression: Compression::None };
        let (bytes, report) = convert_to_bytes(&mesh, &Options { format, ..options.clone() });
        assert_eq!(
            (report.leaf_voxels, report.thesis_voxels),
            (expected.leaf_voxels, expected.thesis_voxels)
        );
        let version_4 = to_version_4(&Archive::of_bytes(&bytes).unwrap(), Vec::new()).unwrap();
        let found: BTreeSet<Cell> = Tree::read(&version_4).leaves(7).into_keys().collect();
        assert_eq!(found, cells(&mesh, &options));
    }
}
