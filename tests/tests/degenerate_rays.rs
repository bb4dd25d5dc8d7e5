//! Zeros, subnormal numbers, the largest ones, infinities and NaN, in every combination.

use glam::DVec3;
use octvox_raytracer::{Octree, Ray};
use octvox_tests::meshes;
use octvox_tests::models::Model;
use octvox_tests::random::Random;
use octvox_tests::rays::hits_of_every_width;
use octvox_tests::tree::Tree;

/// The smallest subnormal number of single precision.
const TINY_F32: f64 = 1.401_298_464_324_817e-45;

/// The smallest subnormal number of double precision.
const TINY_F64: f64 = 5e-324;

#[rustfmt::skip]
const COMPONENTS: [f64; 17] = [
    0.0, -0.0, TINY_F32, -TINY_F32, TINY_F64, -TINY_F64, 1e-30, -1e-30, 1.0, -1.0,
    f32::MAX as f64, f32::MIN as f64, f64::MAX, f64::MIN, f64::INFINITY, f64::NEG_INFINITY, f64::NAN,
];

/// Where rays begin: on the corner of the cube, within it, on its far side, outside, and where nothing is near.
const ORIGINS: [f64; 9] = [0.0, -0.0, TINY_F64, 0.3, 1.0, -1.0, f64::MAX, f64::NEG_INFINITY, f64::NAN];

/// Every triple of the items.
fn triples(items: &[f64]) -> impl Iterator<Item = DVec3> {
    items
        .iter()
        .flat_map(move |&x| items.iter().flat_map(move |&y| items.iter().map(move |&z| DVec3::new(x, y, z))))
}

fn assert_is_sane(octree: &Octree, rays: &[Ray]) {
    for (ray, hit) in rays.iter().zip(hits_of_every_width(octree, rays)) {
        let is_ray = ray.origin.is_finite() && ray.direction.is_finite() && ray.direction != DVec3::ZERO;
        assert!(is_ray || hit.is_none(), "{ray:?} is no ray, but hits {hit:?}");
        if let Some(hit) = hit {
            assert!(octree.is_filled(hit.cell), "{ray:?}: {hit:?}");
            assert!(hit.distance >= 0.0, "{ray:?}: {hit:?}");
        }
    }
}

/// No panic, an end, and the same for every width.
#[test]
fn every_combination_of_components() {
    let random = &mut Random::new(1);
    let octrees = [Tree::random(random, 4, 0.2, 0.1).octree(), Tree::random(random, 3, 0.9, 0.0).octree()];
    for octree in &octrees {
        for origin in triples(&ORIGINS) {
            let rays: Vec<Ray> = triples(&COMPONENTS).map(|direction| Ray { origin, direction }).collect();
            assert_is_sane(octree, &rays);
        }
    }
}

/// Every combination of components as the origin, with directions of all kinds.
#[test]
fn every_combination_of_origins() {
    let octree = Tree::random(&mut Random::new(2), 4, 0.2, 0.1).octree();
    let directions: Vec<DVec3> = triples(&[0.0, TINY_F64, -1e-30, 1.0, -1.0, f64::MAX]).collect();
    for origin in triples(&COMPONENTS) {
        let rays: Vec<Ray> = directions.iter().map(|&direction| Ray { origin, direction }).collect();
        assert_is_sane(&octree, &rays);
    }
}

/// The length of a direction changes the unit of distances and nothing else, from the smallest to the largest.
#[test]
fn only_the_ratio_of_components_counts() {
    let random = &mut Random::new(3);
    let octree = Tree::random(random, 5, 0.05, 0.1).octree();
    let mut hit_count = 0;
    for _ in 0..300 {
        let origin = random.point(-0.5, 1.5);
        let direction = random.point(0.0, 1.0) - origin;
        let powers = [0, -1000, -600, -100, -30, 30, 100, 600, 1000];
        let rays = powers.map(|power| Ray { origin, direction: direction * 2f64.powi(power) });
        let hits = hits_of_every_width(&octree, &rays);
        hit_count += hits.iter().flatten().count();
        for (power, hit) in powers.iter().zip(&hits) {
            let scaled = hit.map(|hit| (hit.cell, hit.distance * 2f64.powi(*power)));
            assert_eq!(scaled, hits[0].map(|hit| (hit.cell, hit.distance)), "2^{power}");
        }
    }
    assert!(hit_count > 500);
}

/// A closed surface stops rays of every direction that there is.
#[test]
fn no_direction_leaks_out_of_a_closed_cube() {
    let octree = Model::of_depth(&meshes::cube().mesh(), 4).octree;
    for origin in [[0.5; 3], [0.3, 0.7, 0.4375], [0.1875, 0.5, 0.8]].map(DVec3::from_array) {
        let rays: Vec<Ray> = triples(&COMPONENTS)
            .filter(|direction| direction.is_finite() && *direction != DVec3::ZERO)
            .map(|direction| Ray { origin, direction })
            .collect();
        for (ray, hit) in rays.iter().zip(hits_of_every_width(&octree, &rays)) {
            assert!(hit.is_some(), "{ray:?}");
        }
    }
}
