//! Octrees as deep as positions have bits, and deeper.

use glam::DVec3;
use octvox_format::{Reader, summarize};
use octvox_raytracer::oracle::LatticeRay;
use octvox_raytracer::{CheckOptions, LoadError, Octree, Ray, check};
use octvox_tests::random::Random;
use octvox_tests::rays::{axes_and_diagonals, hits_of_every_width};
use octvox_tests::tree::{Tree, voxel};
use std::io::Cursor;

/// The deepest octree that can be traced.
const DEEPEST: u8 = 22;

/// Cells in corners, in the middle, and anywhere.
fn cells(depth: u8, random: &mut Random) -> Vec<[u32; 3]> {
    let last = (1u32 << depth) - 1;
    let half = 1u32 << (depth - 1);
    let mut cells = vec![[0; 3], [last; 3], [0, last, half], [half; 3], [half - 1, half, half - 1]];
    cells.extend((0..20).map(|_| [(); 3].map(|()| random.between(0, last as i32) as u32)));
    cells.sort_unstable();
    cells.dedup();
    cells
}

#[test]
fn deep_voxels_are_found_where_they_are() {
    for depth in [14, 19, 20, 21, DEEPEST] {
        let random = &mut Random::new(depth.into());
        let filled: Vec<_> = cells(depth, random).into_iter().map(|cell| (cell, voxel(random))).collect();
        let octree = Tree::of_cells(depth, &filled).octree();
        assert_eq!((octree.depth(), octree.leaf_voxels()), (depth, filled.len() as u64));
        let last = octree.resolution() - 1;
        assert_eq!((octree.bounds().low, octree.bounds().high), ([0; 3], [last + 1; 3]));
        for &(cell, voxel) in &filled {
            assert_eq!(octree.voxel(cell).unwrap().voxel(), voxel);
            for axis in 0..3 {
                let mut neighbor = cell;
                neighbor[axis] = neighbor[axis].wrapping_add(1);
                let is_filled = filled.iter().any(|(cell, _)| *cell == neighbor);
                assert_eq!(octree.is_filled(neighbor), is_filled);
            }
        }
    }
}

/// From a thousand cells away, a voxel is hit along every axis and diagonal, at its very distance.
#[test]
fn deep_voxels_are_hit_exactly() {
    for depth in [14, 19, 20, 21, DEEPEST] {
        let random = &mut Random::new(u64::from(depth) + 100);
        for cell in cells(depth, random) {
            let only = voxel(random);
            let octree = Tree::of_cells(depth, &[(cell, only)]).octree();
            let size = f64::from(octree.resolution());
            let centre = (DVec3::from_array(cell.map(f64::from)) + 0.5) / size;
            // Within the cube the coordinates of cells are exact.
            let away = 1000.0_f64.min(size / 4.0) / size;
            let rays: Vec<Ray> = axes_and_diagonals()
                .map(|direction| DVec3::from_array(direction.map(f64::from)))
                .map(|direction| Ray { origin: centre - direction * away, direction })
                .filter(|ray| ray.origin.cmpge(DVec3::ZERO).all() && ray.origin.cmplt(DVec3::ONE).all())
                .collect();
            assert!(!rays.is_empty());
            for (ray, hit) in rays.iter().zip(hits_of_every_width(&octree, &rays)) {
                let hit = hit.unwrap_or_else(|| panic!("{cell:?} at depth {depth}: {ray:?} misses"));
                assert_eq!((hit.cell, hit.size_log2, hit.payload.voxel()), (cell, 0, only));
                assert_eq!(hit.distance, away - 0.5 / size, "{cell:?} at depth {depth}: {ray:?}");
            }
        }
    }
}

/// A plane of 2¹⁰ voxels along an axis of the deepest octree: rays beside it miss it, rays on it do not.
#[test]
fn neighbors_are_told_apart_at_the_limit() {
    let random = &mut Random::new(9);
    let corner = [(); 3].map(|()| random.between(1 << 18, 1 << 21) as u32);
    let line: Vec<_> =
        (0..64).map(|step| ([corner[0] + step, corner[1], corner[2]], voxel(random))).collect();
    let octree = Tree::of_cells(DEEPEST, &line).octree();
    let size = f64::from(octree.resolution());
    for step in -3i32..67 {
        for beside in -2i32..=2 {
            let cell = DVec3::new(
                f64::from(corner[0]) + f64::from(step),
                f64::from(corner[1]) + f64::from(beside),
                f64::from(corner[2]),
            );
            let origin = (cell + DVec3::new(0.5, 0.5, -500.0)) / size;
            let [hit] = hits_of_every_width(&octree, &[Ray { origin, direction: DVec3::Z }])[..] else {
                panic!()
            };
            let expected = ((0..64).contains(&step) && beside == 0).then(|| line[step as usize].0);
            assert_eq!(hit.map(|hit| hit.cell), expected, "step {step}, beside {beside}");
        }
    }
}

#[test]
fn the_check_finds_nothing_in_deep_octrees() {
    for depth in [13, 16, 19, 20] {
        let random = &mut Random::new(u64::from(depth) + 200);
        let filled: Vec<_> = cells(depth, random).into_iter().map(|cell| (cell, voxel(random))).collect();
        let octree = Tree::of_cells(depth, &filled).octree();
        let report = check(&octree, &CheckOptions { rays: 5000, seed: 3, ..CheckOptions::default() }, |_| {});
        assert!(report.is_right(), "depth {depth}: {report:?}");
    }
}

/// The lattice of exact rays is coarser than these cells; on it, axis-parallel rays are exact all the same.
#[test]
fn rays_of_the_lattice_are_exact_below_it() {
    for depth in [21, DEEPEST] {
        let cell = [0x12_3400, 0x05_6780, 0x1F_FFC0].map(|coordinate: u32| coordinate << (depth - 21));
        let octree = Tree::of_cells(depth, &[(cell, voxel(&mut Random::new(1)))]).octree();
        let low = cell.map(|coordinate| (coordinate >> (depth - 20)) as i32);
        for axis in 0..3 {
            let mut ray = LatticeRay { origin: low, direction: [0; 3] };
            ray.origin[axis] = 0;
            ray.direction[axis] = 1 << 20;
            let exact = octvox_raytracer::oracle::first_hit(&octree, &ray, |_| true).unwrap();
            let [hit] = hits_of_every_width(&octree, &[ray.to_ray()])[..] else { panic!() };
            assert_eq!((exact.cell, exact.distance), (cell, f64::from(low[axis]) / f64::from(1 << 20)));
            assert_eq!(hit.map(|hit| (hit.cell, hit.distance)), Some((exact.cell, exact.distance)));
        }
    }
}

#[test]
fn one_level_too_many_is_an_error() {
    let file = Tree::of_cells(DEEPEST + 1, &[([5; 3], voxel(&mut Random::new(1)))]).file();
    // It is a good file.
    let summary = summarize(Reader::new(&file[..]).unwrap()).unwrap();
    assert_eq!((summary.depth, summary.is_valid()), (DEEPEST + 1, true));
    let error = Octree::read(Cursor::new(&file)).unwrap_err();
    assert!(matches!(error, LoadError::TooDeep { depth: 23, limit: DEEPEST }), "{error}");
    let sentence = error.to_string();
    assert!(
        sentence.contains("23") && sentence.contains("22") && sentence.contains("lower resolution"),
        "{sentence}"
    );
}
