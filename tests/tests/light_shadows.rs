//! Shadows lie where geometry says, and begin where things touch.

use glam::{BVec3, DQuat, DVec3, Vec3};
use octvox_raytracer::scene::{Ground, Instance, Light, Scene, Similarity, Source, SurfaceMaterial};
use octvox_raytracer::{Camera, Lens, Octree, Quality, RenderOptions};
use octvox_tests::meshes::{Shape, cube};
use octvox_tests::models::Model;
use octvox_tests::stage::{alone, exact, floor, from_above, glass, light, pixel_ray, render_with, voxels};

const WHITE: SurfaceMaterial = SurfaceMaterial {
    diffuse: Vec3::ONE,
    specular: Vec3::ZERO,
    shininess: 0.0,
    reflectivity: Vec3::ZERO,
    transparency: 0.0,
    refraction_index: 1.0,
    absorption: Vec3::ZERO,
    emission: Vec3::ZERO,
};

fn lamp(source: Source) -> Light {
    Light { source, color: Vec3::ONE, shadow: true }
}

/// A floor and a plate above it, a box in cells of which there are 64 per axis.
fn plate([low, high]: [[u32; 3]; 2]) -> Octree {
    voxels(6, |cell| {
        let is_in = (0..3).all(|axis| (low[axis]..high[axis]).contains(&cell[axis]));
        (cell[1] == 0 || is_in).then_some((1, DVec3::Y))
    })
}

/// Whether the way from one point to another leads through a box that is grown by `margin`.
fn is_blocked(from: DVec3, to: DVec3, [low, high]: [[u32; 3]; 2], margin: f64) -> bool {
    let [low, high] = [low, high].map(|corner| DVec3::from_array(corner.map(f64::from)) / 64.0);
    let (a, b) = ((low - margin - from) / (to - from), (high + margin - from) / (to - from));
    a.min(b).max_element().max(0.0) < a.max(b).min_element().min(1.0)
}

/// The shadow of a plate above a floor, in one model and in two: every pixel is lit if and only if nothing is on the way
/// from its middle to the lamp. Rays run in single precision: a point closer to the edge than this may be on either side.
#[test]
fn a_hard_shadow_lies_where_geometry_says() {
    const MARGIN: f64 = 1e-5;
    const SIZE: [u32; 2] = [96, 96];
    let bounds = [[20, 20, 24], [40, 22, 37]];
    let together = plate(bounds);
    let ground = floor(6);
    let above = voxels(6, |cell| {
        let is_in = (0..3).all(|axis| (bounds[0][axis]..bounds[1][axis]).contains(&cell[axis]));
        is_in.then_some((1, DVec3::Y))
    });
    let towards = DVec3::new(0.5, 1.0, -0.35).normalize();
    let position = DVec3::new(0.45, 0.9, 0.3);
    for (source, end) in [
        (Source::Directional { towards: towards.as_vec3(), radius: 0.0 }, None),
        (Source::Point { position: position.as_vec3(), radius: 0.0 }, Some(position)),
    ] {
        let one = Scene { lights: vec![lamp(source)], ..alone(&together, &[WHITE]) };
        let mut two = Scene { lights: vec![lamp(source)], ..alone(&ground, &[WHITE]) };
        two.models.push(alone(&above, &[WHITE]).models.remove(0));
        two.instances.push(Instance { model: 1, placement: Similarity::IDENTITY });
        for scene in [&one, &two] {
            let (mut lit, mut dark) = (0, 0);
            for (number, pixel) in (0..).zip(light(scene, &from_above(), SIZE, exact())) {
                let [x, z] = [number % SIZE[0], number / SIZE[0]].map(|at| (f64::from(at) + 0.5) / 96.0);
                let place = DVec3::new(x, 1.0 / 64.0, z);
                let is_covered = is_blocked(place, place + DVec3::Y, bounds, 0.0);
                let to = end.unwrap_or(place + towards * 4.0);
                let [less, more] = [-MARGIN, MARGIN].map(|margin| is_blocked(place, to, bounds, margin));
                if is_covered || less != more {
                    continue;
                }
                assert_eq!(pixel == Vec3::ZERO, less, "{source:?}, {place}: {pixel}");
                *(if less { &mut dark } else { &mut lit }) += 1;
            }
            println!("{source:?}: {lit} pixels lit, {dark} dark");
            assert!(lit > 5000 && dark > 200, "{lit} pixels lit, {dark} dark");
        }
    }
}

/// Behind an edge, the part of a lamp that is seen grows over a strip as wide as similar triangles say.
#[test]
fn a_soft_shadow_is_as_wide_as_similar_triangles_say() {
    const SIZE: [u32; 2] = [128, 128];
    const POINTS: i32 = 400;
    let octree = plate([[0, 20, 0], [32, 21, 64]]);
    let source = Source::Area {
        position: DVec3::new(0.3, 60.0 / 64.0, 0.5).as_vec3(),
        right: Vec3::X * 0.1,
        up: Vec3::Z * 0.05,
    };
    let shadowed = Scene { lights: vec![lamp(source)], ..alone(&octree, &[WHITE]) };
    let bare = floor(6);
    let open = Scene { lights: vec![lamp(source)], ..alone(&bare, &[WHITE]) };
    let quality = Quality { light_samples: 256, ..exact() };
    let [shadowed, open] = [&shadowed, &open].map(|scene| light(scene, &from_above(), SIZE, quality));
    // The upper edge of the plate is at x = 32 of 64 cells, 20 above the floor and 39 below the lamp.
    let row = SIZE[1] / 2;
    let mut seen = Vec::new();
    for column in SIZE[0] / 2..SIZE[0] {
        let number = (row * SIZE[0] + column) as usize;
        let found = f64::from(shadowed[number].x / open[number].x);
        let x = (f64::from(column) + 0.5) / f64::from(SIZE[0]);
        // From here, the lamp is seen to the right of this.
        let from = 0.5 - (x - 0.5) * 39.0 / 20.0;
        let points = (0..POINTS).map(|k| 0.2 + 0.2 * (f64::from(k) + 0.5) / f64::from(POINTS));
        let brings = |point: f64| {
            let offset = DVec3::new(point - x, 59.0 / 64.0, 0.0);
            offset.y.powi(2) / offset.length().powi(4)
        };
        let [part, whole] =
            [from, 0.0].map(|from| points.clone().filter(|point| *point > from).map(brings).sum::<f64>());
        // One of 256 points more or less, as the strip is along an axis of the lamp, and what each of them brings.
        assert!((found - part / whole).abs() < 0.01, "column {column}: {found} instead of {}", part / whole);
        seen.push(found);
    }
    let columns = seen.iter().filter(|part| **part > 0.0 && **part < 1.0).count() as f64;
    let expected = 0.2 * 20.0 / 39.0 * f64::from(SIZE[0]);
    println!("penumbra: {columns} pixels, expected {expected}");
    assert!((columns - expected).abs() <= 1.0, "{columns} pixels instead of {expected}");
    assert_eq!([seen.first(), seen.last()], [Some(&0.0), Some(&1.0)]);
}

/// A box with corners at `low` and `high`.
fn block(low: DVec3, high: DVec3) -> Shape {
    let shape = cube();
    Shape {
        positions: shape.positions.iter().map(|position| low + *position * (high - low)).collect(),
        ..shape
    }
}

/// A floor two wide, and on it a wall one wide and 0.6 high, turned about y.
fn wall_on_floor(thickness: f64, turn: DQuat) -> Shape {
    let mut shape = block(DVec3::new(-1.0, -0.1, -1.0), DVec3::new(1.0, 0.0, 1.0));
    let half = thickness / 2.0;
    let wall = block(DVec3::new(-0.5, 0.0, -half), DVec3::new(0.5, 0.6, half));
    let before = shape.positions.len() as u32;
    shape.triangles.extend(wall.triangles.iter().map(|triangle| triangle.map(|vertex| vertex + before)));
    shape.positions.extend(wall.positions);
    shape.positions.iter_mut().for_each(|position| *position = turn * *position);
    shape
}

/// Light from behind a wall. Pixels of the floor that are in its shadow, how many of them are lit, pixels beside the shadow, how
/// many of them are dark.
fn foot_of_wall(thickness: f64, depth: u8, degrees: f64, elevation: f64) -> [usize; 4] {
    const SIZE: [u32; 2] = [128, 128];
    let turn = DQuat::from_rotation_y(degrees.to_radians());
    let Model { report, octree, .. } = Model::of_depth(&wall_on_floor(thickness, turn).mesh(), depth);
    let voxel = report.world.voxel_size;
    // The scene is the world of the mesh.
    let placement = Similarity {
        scale: voxel * f64::from(report.resolution),
        translation: DVec3::from_array(report.world.origin),
        ..Similarity::IDENTITY
    };
    let (sin, cos) = elevation.to_radians().sin_cos();
    let towards = (turn * DVec3::new(0.0, sin, -cos)).as_vec3();
    let scene = Scene {
        instances: vec![Instance { model: 0, placement }],
        lights: vec![lamp(Source::Directional { towards, radius: 0.0 })],
        ..alone(&octree, &[WHITE])
    };
    let [eye, target] = [DVec3::new(0.1, 0.9, 1.3), DVec3::new(0.0, 0.0, 0.2)].map(|point| turn * point);
    let camera = Camera { eye, target, up: DVec3::Y, vertical_fov: 65.0 };
    let options =
        RenderOptions { size: SIZE, quality: exact(), first_hits: true, ..RenderOptions::default() };
    let (frame, _) = render_with(&scene, &(camera, Lens::default()), &options);
    let (light, hits) = (frame.light.unwrap(), frame.first_hits.unwrap());
    let shadow = 0.6 / elevation.to_radians().tan();
    let mut counts = [0; 4];
    for (number, (pixel, hit)) in (0..).zip(light.iter().zip(&hits)) {
        let ray = pixel_ray(&camera, SIZE, [number % SIZE[0], number / SIZE[0]]);
        let place = turn.conjugate() * (ray.origin + ray.direction * f64::from(hit.distance));
        // Not the wall, and not the edges of the floor, which are rounded.
        let room = 2.0 * voxel;
        if !(place.y.abs() < 1.5 * voxel && place.z < 1.0 - room && place.x.abs() < 1.0 - room) {
            continue;
        }
        let front = place.z - thickness / 2.0;
        if place.x.abs() < 0.5 - room && front > 0.0 && front < shadow - 2.0 * room {
            counts[0] += 1;
            counts[1] += usize::from(*pixel != Vec3::ZERO);
        } else if place.x.abs() > 0.5 + room || front > shadow + 2.0 * room {
            counts[2] += 1;
            counts[3] += usize::from(*pixel == Vec3::ZERO);
        }
    }
    counts
}

#[test]
fn no_light_gets_under_a_wall() {
    let mut leaks = Vec::new();
    for thickness in [0.2, 0.02, 0.0] {
        for depth in [5, 6, 7, 8] {
            for degrees in [0.0, 30.0] {
                for elevation in [45.0, 10.0, 3.0] {
                    let counts = foot_of_wall(thickness, depth, degrees, elevation);
                    let [dark, leaking, lit, missing] = counts;
                    let setting = format!(
                        "wall {thickness} thick, depth {depth}, turned by {degrees}°, light from {elevation}°"
                    );
                    println!("{setting}: {leaking} of {dark} lit, {missing} of {lit} dark");
                    assert!(dark > 100 && lit > 100, "{setting}: {counts:?}");
                    if leaking + missing > 0 {
                        leaks.push(format!("{setting}: {leaking} of {dark} lit, {missing} of {lit} dark"));
                    }
                }
            }
        }
    }
    assert!(leaks.is_empty(), "{}", leaks.join("\n"));
}

/// A plate that casts its shadow on the ground without end, which is no voxel.
#[test]
fn the_ground_takes_shadows() {
    let octree = voxels(4, |[x, y, z]| {
        (y == 8 && (4..12).contains(&x) && (4..12).contains(&z)).then_some((1, DVec3::Y))
    });
    let towards = DVec3::new(0.9, 1.0, 0.0);
    let source = Source::Directional { towards: towards.normalize().as_vec3(), radius: 0.0 };
    let ground = Ground { height: 0.0, surfaces: [WHITE; 2], square: 1.0 };
    let scene = Scene { lights: vec![lamp(source)], ground: Some(ground), ..alone(&octree, &[WHITE]) };
    let (mut camera, lens) = from_above();
    // Seen from below the plate, so that nothing hides the shadow.
    camera.eye.y = 0.4;
    camera.target.y = 0.0;
    camera.eye.x -= 0.4;
    camera.target.x -= 0.4;
    const SIZE: [u32; 2] = [64, 64];
    let mut dark = 0;
    for (number, pixel) in (0..).zip(light(&scene, &(camera, lens), SIZE, exact())) {
        let [x, z] = [number % SIZE[0], number / SIZE[0]].map(|at| (f64::from(at) + 0.5) / 64.0);
        let place = DVec3::new(x - 0.4, 0.0, z);
        let (low, high) = (DVec3::new(0.25, 0.5, 0.25), DVec3::new(0.75, 0.5625, 0.75));
        let (a, b) = ((low - place) / towards, (high - place) / towards);
        // Along z the ray does not move: it is in the box there or it is not.
        let is_between = place.z > 0.25 && place.z < 0.75;
        let [a, b] =
            [a, b].map(|distance| DVec3::select(BVec3::new(true, true, false), distance, DVec3::ONE));
        let enter = a.x.max(a.y);
        let is_dark = is_between && enter < b.x.min(b.y);
        if (enter - b.x.min(b.y)).abs() > 1e-4 {
            assert_eq!(pixel == Vec3::ZERO, is_dark, "{place}");
            dark += usize::from(is_dark);
        }
    }
    assert!(dark > 800, "{dark} pixels are dark");
}

/// Light from straight above through a pane of glass: each surface mirrors F = ((n − 1)/(n + 1))², and of what is on its way
/// for d inside, exp(−a d) is left. What is mirrored more than once inside is not looked for.
#[test]
fn a_pane_dims_and_tints_its_shadow() {
    let octree = voxels(5, |[x, y, _]| match y {
        0 => Some((1, DVec3::Y)),
        18 if x < 16 => Some((2, -DVec3::Y)),
        26 if x < 16 => Some((2, DVec3::Y)),
        _ => None,
    });
    // From below the pane.
    let (mut camera, lens) = from_above();
    camera.eye.y = 0.4;
    camera.target.y = 0.0;
    const SIZE: [u32; 2] = [64, 64];
    let sun = lamp(Source::Directional { towards: Vec3::Y, radius: 0.0 });
    for index in [1.0f32, 1.5, 2.4] {
        for absorption in [Vec3::ZERO, Vec3::new(0.5, 2.0, 8.0)] {
            let surface = SurfaceMaterial { absorption, ..glass(index) };
            let scene = Scene { lights: vec![sun], ..alone(&octree, &[WHITE, surface]) };
            let mirrored = ((index - 1.0) / (index + 1.0)).powi(2);
            let left = Vec3::from_array((absorption * -0.25).to_array().map(f32::exp));
            for (number, pixel) in (0..).zip(light(&scene, &(camera, lens), SIZE, exact())) {
                let is_beside = number % SIZE[0] >= 32;
                let expected = if is_beside { Vec3::ONE } else { left * (1.0 - mirrored).powi(2) };
                let off = (pixel - expected).abs().max_element();
                assert!(off < 1e-6, "index {index}, pixel {number}: {pixel} instead of {expected}");
            }
        }
    }
}
