//! Which instance a pixel shows, whoever sends the ray.

use glam::{DQuat, DVec3, Vec3};
use octvox_raytracer::scene::{Ground, Instance, Model, Scene, Similarity, SurfaceMaterial};
use octvox_raytracer::{Camera, Lens, Projection, Ray, RenderOptions, Width};
use octvox_tests::random::Random;
use octvox_tests::stage::{alone, exact, glowing, pixel_ray, render_with, voxels};
use octvox_tests::tree::Tree;

/// Side by side, rays show a checker of voxels as a checker of pixels, in every width and whatever is in the way of none.
#[test]
fn an_orthographic_camera_shows_cells_as_squares() {
    let octree = voxels(4, |[x, y, z]| (z == 3).then_some((if (x + y) % 2 == 0 { 1 } else { 2 }, DVec3::Z)));
    let scene = alone(&octree, &[glowing(0.25), glowing(0.75)]);
    let eye = DVec3::new(0.5, 0.5, 4.0);
    for eye in [eye, eye + DVec3::Z * 1000.0] {
        let camera = Camera { eye, target: eye - DVec3::Z, up: DVec3::Y, vertical_fov: 40.0 };
        let lens = Lens { projection: Projection::Orthographic { height: 1.0 }, ..Lens::default() };
        for width in Width::ALL {
            let options =
                RenderOptions { size: [64, 64], width, quality: exact(), ..RenderOptions::default() };
            let (frame, _) = render_with(&scene, &(camera, lens), &options);
            for (number, light) in frame.light.unwrap().into_iter().enumerate() {
                let [x, y] = [number % 64 / 4, 15 - number / 64 / 4];
                let expected = if (x + y) % 2 == 0 { 0.25 } else { 0.75 };
                assert_eq!(light, Vec3::splat(expected), "{width:?}, pixel {number}");
            }
        }
    }
}

/// Two hundred cubes, each of its own colour: every pixel shows the one that is nearest among all of them.
#[test]
fn every_pixel_shows_the_nearest_of_all_instances() {
    const SIZE: [u32; 2] = [96, 96];
    let random = &mut Random::new(200);
    let octrees = [voxels(2, |_| Some((1, DVec3::Y))), Tree::random(random, 3, 0.3, 0.2).octree()];
    let mut scene = alone(&octrees[0], &[]);
    scene.models = (0..200)
        .map(|number| Model {
            octree: &octrees[number % 2],
            surfaces: vec![glowing(number as f32 + 1.0); octrees[number % 2].palette().len()],
        })
        .collect();
    scene.instances = (0..200)
        .map(|model| Instance {
            model,
            placement: Similarity {
                scale: 0.1 + 0.4 * random.unit(),
                rotation: DQuat::from_axis_angle(random.direction(), random.unit() * 6.0),
                translation: random.point(-1.5, 1.5),
            },
        })
        .collect();
    let camera = Camera {
        eye: DVec3::new(0.5, 1.0, 5.0),
        target: DVec3::new(0.2, 0.1, 0.0),
        up: DVec3::Y,
        vertical_fov: 36.0,
    };
    let options = RenderOptions { size: SIZE, quality: exact(), ..RenderOptions::default() };
    let (frame, _) = render_with(&scene, &(camera, Lens::default()), &options);
    let (mut different, mut seen) = (0, vec![false; 200]);
    for (number, light) in (0..).zip(frame.light.unwrap()) {
        let ray = pixel_ray(&camera, SIZE, [number % SIZE[0], number / SIZE[0]]);
        let nearest = scene.instances.iter().filter_map(|Instance { model, placement }| {
            let direction = placement.direction_to_unit(ray.direction) / placement.scale;
            let ray = Ray { origin: placement.to_unit(ray.origin), direction };
            let hit = scene.models[*model].octree.hit(&ray)?;
            Some((hit.distance, *model))
        });
        let nearest = nearest.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, model)| model);
        nearest.into_iter().for_each(|model| seen[model] = true);
        different += usize::from(light.x != nearest.map_or(0.0, |model| model as f32 + 1.0));
    }
    let seen = seen.iter().filter(|seen| **seen).count();
    println!("{different} pixels show another cube, {seen} cubes are seen");
    // Directions in the scene are rounded to single floats: by a 500th of a millionth of the picture, which is to be passed
    // by one of some 5000 edge pixels at the most.
    assert!(different <= 1, "{different} pixels show another cube");
    assert!(seen > 100, "{seen} cubes are seen");
}

/// A ray that leaves a flight of steps goes past voxels of it, and tells nevertheless where it ends: a mirror that leans shows
/// the checker of the ground where geometry has it.
#[test]
fn a_mirror_made_of_steps_shows_the_ground_where_it_is() {
    const SIZE: [u32; 2] = [96, 96];
    // A plane that rises by half a cell along x, so that every other cell is a step.
    let normal = DVec3::new(-1.0, 2.0, 0.0).normalize();
    let octree = voxels(6, |[x, y, _]| (y == 16 + x / 2).then_some((1, normal)));
    let silver = SurfaceMaterial { reflectivity: Vec3::ONE, ..SurfaceMaterial::matte(Vec3::ZERO) };
    let square = 0.5;
    let ground = Ground { height: -0.5, surfaces: [glowing(0.25), glowing(0.75)], square };
    let scene = Scene { ground: Some(ground), ..alone(&octree, &[silver]) };
    // From where it is seen at ten degrees or so: what it mirrors leaves along it, past its lower end.
    let target = DVec3::new(0.3, 0.4, 0.5);
    let eye = target + DVec3::new(1.2, 0.9, 0.0);
    let camera = Camera { eye, target, up: DVec3::Y, vertical_fov: 30.0 };
    let stored = {
        let payload = octree.voxel([32, 32, 32]).unwrap();
        DVec3::from_array(payload.voxel().normal.decode().map(f64::from))
    };
    let options =
        RenderOptions { size: SIZE, quality: exact(), first_hits: true, ..RenderOptions::default() };
    let (frame, _) = render_with(&scene, &(camera, Lens::default()), &options);
    let (mut compared, mut different) = (0, 0);
    for (number, (light, hit)) in (0..).zip(frame.light.unwrap().iter().zip(frame.first_hits.unwrap())) {
        let ray = pixel_ray(&camera, SIZE, [number % SIZE[0], number / SIZE[0]]);
        let place = ray.origin + ray.direction * f64::from(hit.distance);
        let mirrored = ray.direction - 2.0 * ray.direction.dot(stored) * stored;
        // What shows the mirror from above, and in it the ground.
        let is_from_above = ray.direction.dot(stored) < -0.02;
        if place.y < 0.0 || !hit.distance.is_finite() || !is_from_above || mirrored.y > -0.02 {
            continue;
        }
        let seen = place + mirrored * ((-0.5 - place.y) / mirrored.y);
        let [x, z] = [seen.x, seen.z].map(|at| (at / square).floor().rem_euclid(2.0));
        compared += 1;
        different += usize::from(light.x != if x == z { 0.25 } else { 0.75 });
    }
    println!("mirror of steps: {different} of {compared} pixels show another square");
    // Along a border of squares, rounding may take either; there are a few hundred such pixels, and each is off by a millionth.
    assert!(compared > 500 && different <= 1, "{different} of {compared}");
}
