//! Rays along axes and diagonals, in faces, along edges, through corners, from wherever a camera may stand.

use glam::DVec3;
use octvox_raytracer::oracle::{LATTICE_BITS, LatticeRay};
use octvox_raytracer::{Octree, Ray, Width};
use octvox_tests::naive_walk::walk;
use octvox_tests::random::Random;
use octvox_tests::rays::{UNIT, axes_and_diagonals, hits_of_every_width, is_of_hit, same_bits};
use octvox_tests::tree::Tree;

/// Small octrees of odd and even depth, one of them full of single voxels, one with large leaves.
fn trees() -> Vec<Tree> {
    [(2, 0.15, 0.0), (2, 0.6, 0.3), (3, 0.05, 0.0), (3, 0.5, 0.2), (1, 0.5, 0.0)]
        .into_iter()
        .enumerate()
        .map(|(seed, (depth, fill, early))| Tree::random(&mut Random::new(seed as u64), depth, fill, early))
        .collect()
}

fn assert_all_are_exact(tree: &Tree, octree: &Octree, lattice_rays: &[LatticeRay]) {
    let depth = tree.depth();
    let rays: Vec<Ray> = lattice_rays.iter().map(LatticeRay::to_ray).collect();
    for (ray, hit) in lattice_rays.iter().zip(hits_of_every_width(octree, &rays)) {
        let expected = walk(depth, ray, |cell| tree.voxel_at(cell, depth).is_some()).hit;
        match (hit, expected) {
            (None, None) => {}
            (Some(hit), Some(expected)) => {
                assert!(is_of_hit(&hit, expected.cell), "{ray:?}: {hit:?} instead of {expected:?}");
                assert_eq!(hit.distance, expected.distance.to_f64(), "{ray:?}");
            }
            (hit, expected) => panic!("{ray:?}: {hit:?} instead of {expected:?}"),
        }
    }
}

/// All 26 directions from all points of a lattice of quarter cells in and around the cube: on corners, edges and faces
/// of cells, and within them.
#[test]
fn axes_and_diagonals_from_everywhere() {
    for tree in trees() {
        let octree = tree.octree();
        // An eighth of the cube more on every side.
        let steps = 4 << tree.depth();
        let around = -steps / 8..=steps + steps / 8;
        let step = UNIT / steps;
        for direction in axes_and_diagonals() {
            let mut rays = Vec::new();
            for (x, y) in around.clone().flat_map(|x| around.clone().map(move |y| (x, y))) {
                rays.extend(around.clone().map(|z| LatticeRay {
                    origin: [x, y, z].map(|coordinate| coordinate * step),
                    direction: direction.map(|part| part * UNIT),
                }));
            }
            assert_all_are_exact(&tree, &octree, &rays);
        }
    }
}

/// Directions that are no diagonals but lie in a face of a cell, from points of its edges and corners.
#[test]
fn rays_that_lie_in_faces() {
    for tree in trees() {
        let octree = tree.octree();
        let cells = 1 << tree.depth();
        let side = UNIT / cells;
        let mut rays = Vec::new();
        for axis in 0..3 {
            for (u, v) in [(1, 2), (1, -2), (-1, 4), (-1, -4), (2, 1), (-4, 1)] {
                for (plane, across) in
                    (-1..=cells + 1).flat_map(|plane| (-2..=2 * cells + 2).map(move |k| (plane, k)))
                {
                    let mut ray = LatticeRay { origin: [0; 3], direction: [0; 3] };
                    ray.origin[axis] = plane * side;
                    ray.origin[(axis + 1) % 3] = if u > 0 { -side } else { UNIT + side };
                    ray.origin[(axis + 2) % 3] = across * side / 2;
                    ray.direction[(axis + 1) % 3] = u * UNIT;
                    ray.direction[(axis + 2) % 3] = v * UNIT;
                    rays.push(ray);
                }
            }
        }
        assert_all_are_exact(&tree, &octree, &rays);
    }
}

/// The smallest scene in which a ray that comes in through a corner of the cube must take one axis after the other.
#[test]
fn through_the_corners_of_the_cube() {
    for octant in 0..8u32 {
        let cell = [0, 1, 2].map(|axis| octant >> axis & 1);
        let only = octvox_tests::tree::voxel(&mut Random::new(1));
        let tree = Tree::of_cells(1, &[(cell, only)]);
        let octree = tree.octree();
        let rays: Vec<LatticeRay> = axes_and_diagonals()
            .flat_map(|direction| {
                (0..27).flat_map(move |corner: i32| {
                    let through = [corner % 3, corner / 3 % 3, corner / 9].map(|part| part * UNIT / 2);
                    [0, 1, 2].map(|back| LatticeRay {
                        origin: [0, 1, 2].map(|axis| through[axis] - back * direction[axis] * UNIT / 2),
                        direction: direction.map(|part| part << LATTICE_BITS),
                    })
                })
            })
            .collect();
        assert_all_are_exact(&tree, &octree, &rays);
    }
}

#[test]
fn an_eye_in_a_voxel_sees_it_at_once() {
    let random = &mut Random::new(5);
    let tree = Tree::random(random, 4, 0.3, 0.1);
    let octree = tree.octree();
    let mut seen = 0;
    while seen < 500 {
        // Well within the cell, so that rounding cannot move it to another.
        let cell = [(); 3].map(|()| random.between(0, 15) as u32);
        let Some(voxel) = tree.voxel_at(cell, 4) else { continue };
        seen += 1;
        let origin = DVec3::from_array(cell.map(f64::from)) / 16.0 + random.point(0.01, 0.99) / 16.0;
        let rays: Vec<Ray> = (0..8).map(|_| Ray { origin, direction: random.direction() }).collect();
        for hit in hits_of_every_width(&octree, &rays) {
            let hit = hit.unwrap();
            assert!(is_of_hit(&hit, cell));
            assert_eq!((hit.distance, hit.payload.voxel()), (0.0, voxel));
        }
    }
}

/// Zeros of either sign, in origin and direction, are one ray.
#[test]
fn minus_zero_is_zero() {
    let random = &mut Random::new(6);
    for tree in trees() {
        let octree = tree.octree();
        for direction in axes_and_diagonals().filter(|direction| direction.contains(&0)) {
            for _ in 0..200 {
                let mut origin = random.point(-0.5, 1.5);
                for axis in 0..3 {
                    if random.chance(0.5) {
                        origin[axis] = 0.0;
                    }
                }
                let direction = DVec3::from_array(direction.map(f64::from));
                let negated = |value: DVec3, bits: u32| {
                    DVec3::from_array([0, 1, 2].map(|axis| match value[axis] {
                        0.0 if bits >> axis & 1 == 1 => -0.0,
                        other => other,
                    }))
                };
                let rays: Vec<Ray> = (0..64)
                    .map(|bits| Ray {
                        origin: negated(origin, bits),
                        direction: negated(direction, bits >> 3),
                    })
                    .collect();
                let hits = hits_of_every_width(&octree, &rays);
                for (ray, hit) in rays.iter().zip(&hits) {
                    assert!(same_bits(hit, &hits[0]), "{ray:?}: {hit:?} instead of {:?}", hits[0]);
                }
            }
        }
    }
}

/// However small a component is, its sign decides on which side of a plane a ray goes on that begins on it; only below
/// 2⁻¹⁰⁰ of the largest one it is none.
#[test]
fn the_smallest_components_count() {
    let random = &mut Random::new(7);
    for axis in [1, 2] {
        // One voxel below and one above the middle of the cube, as seen along x.
        let below = [1, 1, 1];
        let mut above = below;
        above[axis] = 2;
        let other = 3 - axis;
        // Others in corners, so that the ray begins within the box around all.
        let cells = [below, above, [0; 3], [0, 3, 3]];
        let tree = Tree::of_cells(2, &cells.map(|cell| (cell, octvox_tests::tree::voxel(random))));
        let octree = tree.octree();
        for (power, sign) in (0..=110).flat_map(|power| [(power, -1.0), (power, 1.0)]) {
            let mut ray = Ray { origin: DVec3::splat(0.5), direction: DVec3::X };
            // In the empty cells before the voxels.
            ray.origin.x = 0.1875;
            ray.origin[other] = 0.375;
            ray.direction[axis] = sign * 2f64.powi(-power);
            let hit = hits_of_every_width(&octree, &[ray])[0].unwrap();
            let goes_down = sign < 0.0 && power <= 100;
            assert_eq!(hit.cell, if goes_down { below } else { above }, "{ray:?}");
        }
    }
}

/// A ray hits the same whatever its companions are, and however few.
#[test]
fn packets_with_one_live_lane() {
    let random = &mut Random::new(8);
    let tree = Tree::random(random, 5, 0.1, 0.1);
    let octree = tree.octree();
    let dead = Ray { origin: DVec3::NAN, direction: DVec3::X };
    for _ in 0..300 {
        let origin = random.point(-0.5, 1.5);
        let target = random.point(0.0, 1.0);
        let ray = Ray { origin, direction: target - origin };
        let alone = octree.hit(&ray);
        for width in Width::ALL {
            for lane in 0..width.lanes() as usize {
                let mut rays = vec![dead; width.lanes() as usize];
                rays[lane] = ray;
                let hits = octree.hits(&rays, width);
                for (other, hit) in hits.iter().enumerate() {
                    let expected = if other == lane { &alone } else { &None };
                    assert!(same_bits(hit, expected), "{ray:?} in lane {lane} of {width:?}: {hit:?}");
                }
                // A packet that is not full, too.
                let hits = octree.hits(&rays[..=lane], width);
                assert!(same_bits(&hits[lane], &alone));
            }
        }
    }
}

#[test]
fn no_rays_give_no_hits() {
    let octree = trees()[0].octree();
    for width in Width::ALL {
        assert!(octree.hits(&[], width).is_empty());
    }
}
