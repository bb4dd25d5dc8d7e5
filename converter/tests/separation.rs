//! Closed meshes give closed surfaces: no walk through unfilled voxels leads from outside to inside.

mod support;

use octvox_converter::{Mesh, Options};
use std::collections::BTreeSet;
use support::{Cell, Random, Steps, icosphere, reached, tetrahedron, torus, unit_voxels, voxels};

/// How often the mesh winds around a point: the sum of the solid angles of its triangles (Van Oosterom and Strackee 1983).
fn winding_number(mesh: &Mesh, point: [f64; 3]) -> f64 {
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let angle: f64 = mesh
        .triangles()
        .iter()
        .map(|triangle| {
            let [a, b, c] = triangle.map(|vertex| {
                let position = mesh.positions()[vertex as usize];
                [0, 1, 2].map(|axis| position[axis] - point[axis])
            });
            let [la, lb, lc] = [a, b, c].map(|v| dot(v, v).sqrt());
            let volume =
                dot(a, [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]]);
            2.0 * volume.atan2(la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb)
        })
        .sum();
    angle / (4.0 * std::f64::consts::PI)
}

/// Checks that no cell around which the mesh winds is reached from outside; returns how many such cells there are.
fn check(mesh: &Mesh, depth: u8) -> usize {
    let side = 1 << depth;
    let mut inside_cells = 0;
    for (conservative, steps) in [(false, Steps::Six), (true, Steps::TwentySix)] {
        let options = Options { conservative, ..unit_voxels(depth) };
        let filled: BTreeSet<Cell> = voxels(mesh, &options).into_keys().collect();
        let outside = reached(&filled, side, steps);
        inside_cells = 0;
        for x in 0..side {
            for y in 0..side {
                for z in 0..side {
                    let cell = [x, y, z];
                    if filled.contains(&cell) {
                        continue;
                    }
                    let winding = winding_number(mesh, cell.map(|c| f64::from(c) + 0.5));
                    // A centre on the surface, with half a winding or less, is on neither side.
                    let is_inside =
                        (winding - winding.round()).abs() < 0.01 && winding.round() as i64 % 2 != 0;
                    inside_cells += usize::from(is_inside);
                    assert!(
                        !(is_inside && outside.contains(&cell)),
                        "{cell:?} is reached, conservative: {conservative}"
                    );
                }
            }
        }
    }
    inside_cells
}

#[test]
fn spheres() {
    for (depth, radius, steps) in [(3, 2.9, 1), (4, 6.3, 2), (5, 13.0, 1)] {
        let center = f64::from(1u32 << depth) / 2.0;
        assert!(check(&icosphere([center + 0.13, center - 0.2, center], radius, steps), depth) > 20);
    }
}

#[test]
fn tori() {
    assert!(check(&torus([16.1, 15.8, 16.3], 9.5, 4.2, 17, 9), 5) > 500);
    // Vertices and edges on the lattice of voxel centres and corners.
    assert!(check(&torus([16.0, 16.0, 16.0], 9.0, 4.0, 4, 4), 5) > 100);
}

#[test]
fn boxes_on_the_lattice() {
    for offset in [0.0, 0.5] {
        let mesh = support::cuboid([3.0 + offset; 3], [12.0 + offset, 10.0 + offset, 9.0 + offset]);
        assert!(check(&mesh, 4) > 100);
    }
}

#[test]
fn tetrahedra_with_random_corners() {
    let mut random = Random(7);
    let mut inside_cells = 0;
    for round in 0..40 {
        // Every second one has its corners on the lattice of centres and faces, so that many ties occur.
        let corners = [(); 4].map(|()| {
            [(); 3].map(|()| {
                let coordinate = 1.5 + 29.0 * random.fraction();
                if round % 2 == 0 { coordinate } else { (2.0 * coordinate).round() / 2.0 }
            })
        });
        inside_cells += check(&tetrahedron(corners), 5);
    }
    assert!(inside_cells > 1000, "{inside_cells}");
}

#[test]
fn a_hole_is_found() {
    // The test itself must be able to fail: without a triangle, the inside is reached.
    let sphere = icosphere([8.0; 3], 6.3, 1);
    let open = Mesh::new(sphere.positions().to_vec(), sphere.triangles()[1..].to_vec()).unwrap();
    let filled: BTreeSet<Cell> = voxels(&open, &unit_voxels(4)).into_keys().collect();
    assert!(reached(&filled, 16, Steps::Six).contains(&[8; 3]));
}
