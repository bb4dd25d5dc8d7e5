//! The exact walk against one written from the definition, and the traversal against both.

use octvox_raytracer::oracle::{LatticeRay, first_hit};
use octvox_raytracer::{CheckOptions, Hit, Octree, Ray, Width, check};
use octvox_tests::naive_walk::walk;
use octvox_tests::random::Random;
use octvox_tests::rays::{
    exact_in_single_precision, hits_of_every_width, is_of_hit, nearly_parallel, on_the_lattice,
    through_a_corner,
};
use octvox_tests::tree::Tree;

/// A random octree and how it is to be asked.
struct Scene {
    name: String,
    tree: Tree,
    octree: Octree,
    /// Depth of the octree in memory; that of a single voxel is 1.
    depth: u8,
}

impl Scene {
    fn new(name: String, tree: Tree) -> Self {
        let octree = tree.octree();
        let depth = tree.depth().max(1);
        assert_eq!(octree.depth(), depth, "{name}");
        Self { name, tree, octree, depth }
    }

    fn is_filled(&self, cell: [u32; 3]) -> bool {
        self.tree.voxel_at(cell, self.depth).is_some()
    }
}

/// Octrees of every depth from 0 to 6, nearly empty to full, whole and with leaves above the finest level.
fn scenes() -> impl Iterator<Item = Scene> {
    (0..=6).flat_map(|depth| {
        [0.0, 0.02, 0.1, 0.5, 1.0].into_iter().flat_map(move |fill| {
            [0.0, 0.15, 0.5].into_iter().map(move |early| {
                let name = format!("depth {depth}, fill {fill}, early leaves {early}");
                let random =
                    &mut Random::new(u64::from(depth) + (fill * 1e3) as u64 * 10 + (early * 1e3) as u64);
                Scene::new(name, Tree::random(random, depth, fill, early))
            })
        })
    })
}

/// Voxels come back from the octree in memory as they stand in the file.
#[test]
fn every_cell_of_random_octrees_is_known() {
    for scene in scenes() {
        let size = 1u32 << scene.depth;
        let expected = scene.tree.leaf_voxels(scene.depth);
        assert_eq!(scene.octree.leaf_voxels(), expected, "{}", scene.name);
        for z in 0..size {
            for y in 0..size {
                for x in 0..size {
                    let found = scene.octree.voxel([x, y, z]).map(|payload| payload.voxel());
                    assert_eq!(
                        found,
                        scene.tree.voxel_at([x, y, z], scene.depth),
                        "{}: {x} {y} {z}",
                        scene.name
                    );
                }
            }
        }
        assert_eq!(scene.octree.voxel([size, 0, 0]), None);
        assert_eq!(scene.octree.voxel([0, 0, u32::MAX]), None);
    }
}

/// The exact walk of the ray tracer, which skips empty cells, finds the cell and the distance of the definition.
#[test]
fn the_exact_walk_is_the_definition() {
    for (number, scene) in scenes().enumerate() {
        let random = &mut Random::new(1000 + number as u64);
        for index in 0..400 {
            let ray = if index % 2 == 0 { exact_in_single_precision(random) } else { on_the_lattice(random) };
            let naive = walk(scene.depth, &ray, |cell| scene.is_filled(cell)).hit;
            let exact = first_hit(&scene.octree, &ray, |_| true);
            let naive = naive.map(|hit| (hit.cell, hit.distance.to_f64()));
            let exact = exact.map(|hit| (hit.cell, hit.distance));
            assert_eq!(exact, naive, "{}: {ray:?}", scene.name);
        }
    }
}

/// Passing over voxels, the exact walk meets all those that the definition has on the way, in that order.
#[test]
fn the_exact_walk_goes_on_behind_a_voxel() {
    for (number, scene) in scenes().enumerate() {
        let random = &mut Random::new(2000 + number as u64);
        for _ in 0..40 {
            let ray = on_the_lattice(random);
            let mut met = Vec::new();
            assert!(
                first_hit(&scene.octree, &ray, |hit| {
                    met.push(hit.cell);
                    false
                })
                .is_none()
            );
            let mut before = Vec::new();
            while let Some(hit) =
                walk(scene.depth, &ray, |cell| scene.is_filled(cell) && !before.contains(&cell)).hit
            {
                before.push(hit.cell);
            }
            assert_eq!(met, before, "{}: {ray:?}", scene.name);
        }
    }
}

/// Where single precision loses nothing, every width finds the voxel and the distance of the definition, through
/// every grid.
#[test]
fn where_single_precision_is_exact_so_is_the_traversal() {
    for (number, mut scene) in scenes().enumerate() {
        let random = &mut Random::new(3000 + number as u64);
        let lattice_rays: Vec<LatticeRay> = (0..600).map(|_| exact_in_single_precision(random)).collect();
        let rays: Vec<Ray> = lattice_rays.iter().map(LatticeRay::to_ray).collect();
        let naive: Vec<_> =
            lattice_rays.iter().map(|ray| walk(scene.depth, ray, |cell| scene.is_filled(cell)).hit).collect();
        for level in 0..=8 {
            scene.octree.set_grid(level);
            let hits = hits_of_every_width(&scene.octree, &rays);
            for ((ray, hit), naive) in lattice_rays.iter().zip(&hits).zip(&naive) {
                let place = format!("{}, grid level {level}: {ray:?}, {hit:?}", scene.name);
                match (hit, naive) {
                    (None, None) => {}
                    (Some(hit), Some(naive)) => {
                        assert!(is_of_hit(hit, naive.cell), "{place} instead of {naive:?}");
                        assert_eq!(hit.distance, naive.distance.to_f64(), "{place}");
                        let voxel = scene.tree.voxel_at(naive.cell, scene.depth).unwrap();
                        assert_eq!(hit.payload.voxel(), voxel, "{place}");
                    }
                    _ => panic!("{place} instead of {naive:?}"),
                }
            }
        }
    }
}

/// On any ray of the lattice, a voxel other than that of the definition is one that the ray comes very close to; and it is
/// the same one, to the last bit, through every grid.
#[test]
fn elsewhere_the_traversal_is_off_by_a_rounding() {
    /// Twenty roundings at the coordinate 4, in unit space: far more than a ray can be off, far less than a voxel.
    const MARGIN: f64 = 20.0 * 4.0 / (1 << 24) as f64;
    let (mut rays_sent, mut differences) = (0, 0);
    for (number, mut scene) in scenes().enumerate() {
        let random = &mut Random::new(4000 + number as u64);
        let some_ray = |count| match count % 3 {
            0 => on_the_lattice(random),
            1 => through_a_corner(random, scene.depth),
            _ => nearly_parallel(random),
        };
        let lattice_rays: Vec<LatticeRay> = (0..3000).map(some_ray).collect();
        let rays: Vec<Ray> = lattice_rays.iter().map(LatticeRay::to_ray).collect();
        let hits = hits_of_every_width(&scene.octree, &rays);
        for level in [0, 1, 4, 8] {
            scene.octree.set_grid(level);
            let others = scene.octree.hits(&rays, Width::Sixteen);
            for ((ray, hit), other) in lattice_rays.iter().zip(&hits).zip(&others) {
                // Of a large voxel, how much is the cell depends on the grid.
                let seen = |hit: &Option<Hit>| hit.map(|hit| (hit.distance.to_bits(), hit.payload));
                let place = || format!("{}, grid level {level}: {ray:?}", scene.name);
                assert_eq!(seen(other), seen(hit), "{}, {hit:?} became {other:?}", place());
            }
        }
        for ((lattice_ray, ray), hit) in lattice_rays.iter().zip(&rays).zip(&hits) {
            rays_sent += 1;
            let naive = walk(scene.depth, lattice_ray, |cell| scene.is_filled(cell)).hit;
            let (place, size) =
                (format!("{}: {lattice_ray:?}, {hit:?}", scene.name), f64::from(1u32 << scene.depth));
            let same = match (hit, naive) {
                (None, None) => true,
                (Some(hit), Some(naive)) => is_of_hit(hit, naive.cell),
                _ => false,
            };
            differences += u32::from(!same);
            if let Some(hit) = hit {
                assert!(scene.is_filled(hit.cell), "{place}");
                let low = hit.cell.map(|coordinate| f64::from(coordinate) / size);
                let side = f64::from(1u32 << hit.size_log2) / size;
                let passage = passage(ray, low, side, MARGIN).unwrap_or_else(|| panic!("{place}"));
                let slack = 2.0 * MARGIN / ray.direction.abs().max_element();
                assert!(passage[0] - slack <= hit.distance && hit.distance <= passage[1] + slack, "{place}");
            }
            if !same && let Some(naive) = naive {
                // The voxel that was overlooked is only grazed.
                let low = naive.cell.map(|coordinate| f64::from(coordinate) / size);
                let first = hit.is_none_or(|hit| hit.distance > naive.distance.to_f64());
                assert!(
                    !first || passage(ray, low, 1.0 / size, -MARGIN).is_none(),
                    "{place} passes {naive:?}"
                );
            }
        }
    }
    assert!(0 < differences && differences * 100 < rays_sent, "{differences} of {rays_sent}");
}

/// Where a ray is in a cube that is grown by `margin` on all sides: distances at which it comes in and goes out.
fn passage(ray: &Ray, low: [f64; 3], side: f64, margin: f64) -> Option<[f64; 2]> {
    let (mut enter, mut leave) = (0.0f64, f64::INFINITY);
    for (axis, low) in low.into_iter().enumerate() {
        let planes = [low - margin, low + side + margin];
        if ray.direction[axis] == 0.0 {
            if !(planes[0]..=planes[1]).contains(&ray.origin[axis]) {
                return None;
            }
        } else {
            let distances = planes.map(|plane| (plane - ray.origin[axis]) / ray.direction[axis]);
            enter = enter.max(distances[0].min(distances[1]));
            leave = leave.min(distances[0].max(distances[1]));
        }
    }
    (enter <= leave).then_some([enter, leave])
}

/// The check of the ray tracer itself finds nothing wrong on random octrees, through every grid.
#[test]
fn the_check_finds_nothing_on_random_octrees() {
    for (number, mut scene) in scenes().enumerate() {
        scene.octree.set_grid(number as u8 % 9);
        let options = CheckOptions { rays: 4000, seed: number as u64, ..CheckOptions::default() };
        let report = check(&scene.octree, &options, |_| {});
        assert!(report.is_right(), "{}: {report:?}", scene.name);
        assert_eq!((report.width_differences, report.mismatches, report.guard_hits), (0, 0, 0));
        assert_eq!(report.widths, Width::ALL.map(Width::lanes));
    }
}

/// The comparison can fail: without one of its voxels, an octree is not the one that the definition walks through.
#[test]
fn a_missing_voxel_is_noticed() {
    let random = &mut Random::new(7);
    let whole = Tree::random(random, 3, 0.1, 0.0);
    let cells = (0..512).map(|code| [code % 8, code / 8 % 8, code / 64]);
    let mut filled: Vec<_> = cells.filter_map(|cell| Some((cell, whole.voxel_at(cell, 3)?))).collect();
    filled.swap_remove(filled.len() / 2);
    let octree = Tree::of_cells(3, &filled).octree();
    let noticed = (0..4000).filter(|_| {
        let ray = on_the_lattice(random);
        let expected = walk(3, &ray, |cell| whole.voxel_at(cell, 3).is_some()).hit;
        octree.hit(&ray.to_ray()).map(|hit| hit.cell) != expected.map(|hit| hit.cell)
    });
    assert!(noticed.count() > 10);
}
