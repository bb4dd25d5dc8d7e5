//! Rays and eyes from far away.

use glam::DVec3;
use octvox_raytracer::{Camera, Ray, RenderOptions, render};
use octvox_tests::meshes;
use octvox_tests::models::Model;
use octvox_tests::random::Random;
use octvox_tests::rays::{between, hits_of_every_width};

/// How far the origins are, in sides of the cube.
const DISTANCES: [f64; 5] = [3.0, 1e3, 1e5, 1e7, 1e12];

/// Where Embree's test of watertightness stands.
const EMBREE: DVec3 = DVec3::new(148_376.0, 1234.0, -223_423.0);

/// Origins at every distance in random directions, and Embree's point.
fn origins(random: &mut Random) -> Vec<DVec3> {
    let around = |distance: f64| 0.5 + random.direction() * distance;
    DISTANCES.iter().flat_map(|&distance| [distance; 20]).map(around).chain([EMBREE; 20]).collect()
}

/// Rays to points within a closed surface are stopped before they are there.
#[test]
fn nothing_gets_through_a_closed_surface() {
    let random = &mut Random::new(1);
    for depth in [5, 8] {
        // Two cells of clearance within the smallest parts.
        let sphere = Model::of_depth(&meshes::sphere(4).mesh(), depth).octree;
        let radius = 0.49 - 3.0 / f64::from(sphere.resolution());
        let cube = Model::of_depth(&meshes::cube().mesh(), depth).octree;
        let wall = 3.0 / f64::from(cube.resolution());
        for origin in origins(random) {
            let into_sphere: Vec<Ray> = (0..200)
                .map(|_| between(origin, 0.5 + random.direction() * random.unit() * radius))
                .collect();
            let into_cube: Vec<Ray> =
                (0..200).map(|_| between(origin, random.point(wall, 1.0 - wall))).collect();
            for (octree, rays) in [(&sphere, into_sphere), (&cube, into_cube)] {
                for (ray, hit) in rays.iter().zip(hits_of_every_width(octree, &rays)) {
                    let hit = hit.unwrap_or_else(|| panic!("{ray:?} leaks"));
                    assert!(hit.distance < 1.0, "{ray:?} goes through: {hit:?}");
                }
            }
        }
    }
}

/// What is hit lies on the line, and where it is met the ray comes into it.
#[test]
fn the_voxel_that_is_hit_lies_on_the_ray() {
    let random = &mut Random::new(2);
    let octree = Model::of_depth(&meshes::torus(0.15, 96, 48).mesh(), 7).octree;
    let size = f64::from(octree.resolution());
    for origin in origins(random) {
        let rays: Vec<Ray> = (0..200).map(|_| between(origin, random.point(0.2, 0.8))).collect();
        // What doubles lose at that distance, and floats near the cube.
        let tolerance = 1e-5 + origin.length() * 1e-15;
        for (ray, hit) in rays.iter().zip(hits_of_every_width(&octree, &rays)) {
            let Some(hit) = hit else { continue };
            let point = ray.origin + ray.direction * hit.distance;
            for axis in 0..3 {
                let low = f64::from(hit.cell[axis]) / size;
                assert!(
                    (low - tolerance..=low + 1.0 / size + tolerance).contains(&point[axis]),
                    "{ray:?}: {hit:?} at {point}"
                );
            }
        }
    }
}

/// Rays that pass by, however far they come from, hit nothing.
#[test]
fn rays_that_pass_by_miss() {
    let random = &mut Random::new(3);
    let octree = Model::of_depth(&meshes::sphere(4).mesh(), 6).octree;
    for origin in origins(random) {
        let mut rays = Vec::new();
        for _ in 0..100 {
            // A point farther from the middle than the corners of the cube, beside the line to it.
            let forward = (0.5 - origin).normalize();
            let aside = forward.cross(random.direction()).normalize();
            rays.push(between(origin, 0.5 + aside * (0.88 + random.unit())));
            // And away from the cube.
            rays.push(Ray { origin, direction: origin - random.point(0.0, 1.0) });
        }
        for (ray, hit) in rays.iter().zip(hits_of_every_width(&octree, &rays)) {
            assert!(hit.is_none(), "{ray:?}: {hit:?}");
        }
    }
}

/// A telescope shows the front of a cube: every pixel of it is covered, and no other.
#[test]
fn a_far_eye_sees_a_closed_face() {
    let octree = Model::of_depth(&meshes::cube().mesh(), 6).octree;
    let target = DVec3::splat(0.5);
    for (distance, degrees) in [(1e2, 0.25), (1e3, 0.025), (2e4, 0.001), (1e5, 0.001)] {
        let size = 99;
        let camera =
            Camera { eye: target + DVec3::Z * distance, target, up: DVec3::Y, vertical_fov: degrees };
        let options = RenderOptions { size: [size, size], first_hits: true, ..RenderOptions::default() };
        let (frame, _) = render(&octree, &camera, &options, |_| {}).unwrap();
        // Half of the picture's side at the distance of the front.
        let half_side = (degrees.to_radians() / 2.0).tan() * (distance - 0.5);
        let pixel = 2.0 * half_side / f64::from(size);
        for (index, hit) in frame.first_hits.unwrap().iter().enumerate() {
            let offset = [index as u32 % size, index as u32 / size]
                .map(|place| (f64::from(place) + 0.5) * pixel - half_side)
                .map(f64::abs);
            let from_edge = 0.5 - offset[0].max(offset[1]);
            if from_edge.abs() > 0.1 * pixel {
                assert_eq!(hit.distance.is_finite(), from_edge > 0.0, "pixel {index} at {distance}");
            }
        }
    }
}
