//! Pictures by triangles: held against formulas, and pictures of voxels held against them.

use glam::{DQuat, DVec3, Vec3};
use octvox_converter::{Compression, FileFormat, Material, Mesh, Options};
use octvox_format::NormalCode;
use octvox_raytracer::picture_error::{depth_and_normal_errors, rmse};
use octvox_raytracer::scene::{
    Ambient, Background, Ground, Instance, Light, Scene, Similarity, Source, SurfaceMaterial,
};
use octvox_raytracer::truth::{Truth, TruthModel};
use octvox_raytracer::{
    Camera, DEFAULT_FOV, FirstHit, Frame, Lens, Projection, Quality, RenderOptions, Tone, render_scene,
    to_linear,
};
use octvox_tests::meshes::{Shape, sphere};
use octvox_tests::models::{Model, shared};

const SIZE: [u32; 2] = [160, 120];

/// What the converter gives to triangles without a colour, and the ray tracer to files without a highlight.
const GREY: u8 = 204;
const HIGHLIGHT: (f64, f64) = (0.22, 32.0);

fn truth_model<'m>(mesh: &'m Mesh, model: &Model) -> TruthModel<'m> {
    let crease = Options::default().crease_degrees;
    TruthModel::new(mesh, model.report.world, model.report.resolution, crease).unwrap()
}

/// A model alone in the dark.
fn in_the_dark<'a>(model: &'a Model, camera: &Camera) -> Scene<'a> {
    let mut scene = Scene::of_model(&model.octree, camera);
    scene.lights.clear();
    scene.ambient = Ambient { color: Vec3::ZERO, occlusion: None, glow: false };
    scene.background = Background::uniform(Vec3::ZERO);
    scene
}

/// A rectangle by a corner and two edges.
fn rectangle(shape: &mut Shape, corner: DVec3, right: DVec3, up: DVec3) {
    let first = shape.positions.len() as u32;
    shape.positions.extend([corner, corner + right, corner + right + up, corner + up]);
    shape.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
}

/// The unit square on the floor of the cube.
fn floor() -> Shape {
    let mut shape = Shape::default();
    rectangle(&mut shape, DVec3::ZERO, DVec3::Z, DVec3::X);
    shape
}

/// From above on the middle of the floor.
fn above() -> Camera {
    Camera {
        eye: DVec3::new(0.5, 1.2, 1.1),
        target: DVec3::new(0.5, 0.5, 0.5),
        up: DVec3::Y,
        vertical_fov: 40.0,
    }
}

/// The ray through the middle of a pixel, by the definition of the camera.
fn direction(camera: &Camera, place: usize) -> DVec3 {
    let (x, y) = (place as u32 % SIZE[0], place as u32 / SIZE[0]);
    let forward = (camera.target - camera.eye).normalize();
    let right = forward.cross(camera.up).normalize();
    let reach = (camera.vertical_fov.to_radians() / 2.0).tan() / (f64::from(SIZE[1]) / 2.0);
    let across = right * (f64::from(x) + 0.5 - f64::from(SIZE[0]) / 2.0);
    let up = right.cross(forward) * (f64::from(SIZE[1]) / 2.0 - f64::from(y) - 0.5);
    (forward + (across + up) * reach).normalize()
}

/// Light that arrives with an amount from a direction, as the grey surface scatters it to the eye.
fn scattered(normal: DVec3, towards: DVec3, to_eye: DVec3, amount: f64) -> f64 {
    let mirrored = 2.0 * normal.dot(towards) * normal - towards;
    let highlight = HIGHLIGHT.0 * mirrored.dot(to_eye).max(0.0).powf(HIGHLIGHT.1);
    amount * (f64::from(to_linear(GREY)) * normal.dot(towards) + highlight)
}

/// A floor in the middle of the cube under each kind of lamp, against the formulas that `Light` documents.
#[test]
fn a_floor_under_lamps() {
    let mesh = floor().mesh();
    let model = Model::of_depth(&mesh, 5);
    let models = [truth_model(&mesh, &model)];
    let camera = above();
    let lamp = DVec3::new(0.3, 0.9, 0.6);
    let towards = DVec3::new(0.48, 0.8, 0.36);
    let position = lamp.as_vec3();
    let sources = [
        Source::Directional { towards: towards.as_vec3(), radius: 0.0 },
        Source::Point { position, radius: 0.0 },
        Source::Spot { position, radius: 0.0, towards: -Vec3::Y, cone: [0.95, 0.8] },
        Source::Area { position, right: Vec3::X * 0.1, up: Vec3::Z * 0.1 },
    ];
    for (kind, source) in sources.into_iter().enumerate() {
        let mut scene = in_the_dark(&model, &camera);
        scene.ambient.color = Vec3::splat(0.125);
        // An area's soft shadow would take other points than its middle.
        scene.lights = vec![Light { source, color: Vec3::splat(0.5), shadow: kind != 3 }];
        let truth = Truth::new(&scene, &models);
        let picture = truth.picture(&camera, &Lens::default(), SIZE, 1, &Tone::default()).unwrap();
        let hits = truth.first_hits(&camera, &Lens::default(), SIZE).unwrap();
        let mut seen = 0;
        for (place, hit) in hits.iter().enumerate() {
            let direction = direction(&camera, place);
            let distance = (0.5 - camera.eye.y) / direction.y;
            let point = camera.eye + direction * distance;
            let is_seen = distance > 0.0 && (0.0..1.0).contains(&point.x) && (0.0..1.0).contains(&point.z);
            if !is_seen {
                assert_eq!((hit.distance, picture.light[place]), (f64::INFINITY, Vec3::ZERO));
                continue;
            }
            seen += 1;
            assert!((hit.distance - distance).abs() < 1e-12 && hit.normal == DVec3::Y, "{hit:?}");
            let away = lamp.distance(point);
            let to_lamp = (lamp - point) / away;
            let share = ((to_lamp.y - 0.8) / 0.15).clamp(0.0, 1.0);
            let (towards, amount) = [
                (towards, 0.5),
                (to_lamp, 0.5 / (away * away)),
                (to_lamp, 0.5 / (away * away) * share * share * (3.0 - 2.0 * share)),
                // From x to z is a turn about −y: its front is down.
                (to_lamp, 0.5 / (away * away) * to_lamp.y),
            ][kind];
            let expected =
                0.125 * f64::from(to_linear(GREY)) + scattered(DVec3::Y, towards, -direction, amount);
            let found = f64::from(picture.light[place].y);
            assert!((found - expected).abs() < 2e-5, "{found} instead of {expected}, lamp {kind}");
        }
        assert_eq!(picture.hit_pixels, seen);
        assert!(seen > 10_000, "{seen}");
    }
}

/// A ball of triangles with the normals of a sphere: its shading is that of the sphere, and no triangle darkens itself.
#[test]
fn a_sphere_is_shaded_as_one() {
    let shape = sphere(6);
    let normal = |vertex: u32| (shape.positions[vertex as usize] - 0.5).normalize().as_vec3().to_array();
    let normals = shape.triangles.iter().map(|triangle| triangle.map(normal)).collect();
    let mesh = shape.mesh().with_corner_normals(normals).unwrap();
    let model = Model::of_depth(&mesh, 5);
    let models = [truth_model(&mesh, &model)];
    let camera = Camera::framing(&model.octree, 4.0 / 3.0, DEFAULT_FOV);
    let mut scene = in_the_dark(&model, &camera);
    let towards = DVec3::new(-0.8, 0.6, 0.0);
    scene.lights = vec![Light { shadow: true, ..Light::directional(towards.as_vec3(), Vec3::ONE) }];
    let truth = Truth::new(&scene, &models);
    let picture = truth.picture(&camera, &Lens::default(), SIZE, 1, &Tone::default()).unwrap();
    let mut compared = [0; 2];
    for place in 0..picture.light.len() {
        let direction = direction(&camera, place);
        let to_middle = DVec3::splat(0.5) - camera.eye;
        let along = to_middle.dot(direction);
        let inside = 0.25 - (to_middle.length_squared() - along * along);
        // Edges of triangles are within this of the sphere.
        if inside < 0.002 {
            continue;
        }
        let normal = (camera.eye + direction * (along - inside.sqrt()) - 0.5).normalize();
        let facing = normal.dot(towards);
        let found = f64::from(picture.light[place].x);
        if facing > 0.02 {
            let expected = scattered(normal, towards, -direction, 1.0);
            assert!((found - expected).abs() < 0.012, "{found} instead of {expected}");
            compared[0] += 1;
        } else if facing < 0.0 {
            assert!(found < 1e-3, "{found}");
            compared[1] += 1;
        }
    }
    assert!(compared[0] > 2000 && compared[1] > 2000, "{compared:?}");
}

/// A wall without end between the floor and a sun with a disk: the share of the disk that looks over the wall.
#[test]
fn a_penumbra_is_the_share_of_the_lamp() {
    const WIDE: f64 = 40.0;
    let mut shape = Shape::default();
    rectangle(&mut shape, DVec3::new(0.0, 0.0, -WIDE), DVec3::Z * 2.0 * WIDE, DVec3::X * 8.0);
    rectangle(&mut shape, DVec3::new(2.0, 0.0, -WIDE), DVec3::Z * 2.0 * WIDE, DVec3::Y);
    let mesh = shape.mesh();
    let model = Model::of_depth(&mesh, 6);
    let models = [truth_model(&mesh, &model)];
    let world = model.report.world;
    let side = world.voxel_size * f64::from(model.report.resolution);
    let to_unit = |point: DVec3| (point - DVec3::from_array(world.origin)) / side;
    // Straight down on the floor on the shadow's side.
    let target = to_unit(DVec3::new(1.0, 0.0, 0.0));
    let camera = Camera { eye: target + DVec3::Y * 0.1, target, up: DVec3::Z, vertical_fov: 10.0 };
    let mut scene = in_the_dark(&model, &camera);
    let axis = DVec3::new(0.8, 0.6, 0.0);
    let reach = 0.1f64;
    let source = Source::Directional { towards: axis.as_vec3(), radius: reach.atan() as f32 };
    scene.lights = vec![Light { source, color: Vec3::ONE, shadow: true }];
    let lens = Lens { projection: Projection::Orthographic { height: 1.8 / side }, ..Lens::default() };
    let truth = Truth::new(&scene, &models);
    let light = truth.picture(&camera, &lens, SIZE, 4, &Tone::default()).unwrap().light;
    let hits = truth.first_hits(&camera, &lens, SIZE).unwrap();
    scene.lights[0].shadow = false;
    scene.lights[0].source = Source::Directional { towards: axis.as_vec3(), radius: 0.0 };
    let lit = Truth::new(&scene, &models).picture(&camera, &lens, SIZE, 1, &Tone::default()).unwrap().light;
    let (mut in_penumbra, mut error) = (0, 0.0f64);
    for (place, hit) in hits.iter().enumerate() {
        // `up` is z, so x falls to the right.
        let from_middle = f64::from(place as u32 % SIZE[0]) + 0.5 - f64::from(SIZE[0]) / 2.0;
        let x = 1.0 - 1.8 / f64::from(SIZE[1]) * from_middle;
        if !(0.2..1.7).contains(&x) {
            continue;
        }
        assert!((hit.distance - 0.1).abs() < 1e-9);
        // What is steeper than the wall's edge is seen: a half plane of the disk, this far from its middle.
        let steeper = DVec3::new(-1.0 / (2.0 - x), 1.0, 0.0);
        let across = steeper - axis * steeper.dot(axis);
        let off = (steeper.dot(axis) / across.length() / reach).clamp(-1.0, 1.0);
        let expected = 1.0 - (off.acos() - off * (1.0 - off * off).sqrt()) / std::f64::consts::PI;
        let found = f64::from(light[place].x / lit[place].x);
        // Over the disk the cosine of the floor changes; in the mean it hardly does.
        let tolerance = if expected == 0.0 { 1e-9 } else { 0.15 };
        assert!((found - expected).abs() <= tolerance, "{found} instead of {expected} at {x}");
        if expected > 0.02 && expected < 0.98 {
            in_penumbra += 1;
            error += (found - expected).abs();
        }
    }
    assert!(in_penumbra > 1500, "{in_penumbra}");
    assert!(error / f64::from(in_penumbra) < 0.05, "{}", error / f64::from(in_penumbra));
}

/// A picture of voxels and one of triangles.
struct Both {
    frame: Frame,
    pixels: Vec<[u8; 4]>,
    truth: Vec<FirstHit>,
}

fn both(scene: &Scene<'_>, models: &[TruthModel<'_>], camera: &Camera) -> Both {
    const SAMPLES: u32 = 4;
    let lens = Lens::default();
    let quality = Quality { lod_pixels: 0.0, cutoff: 0.0, light_samples: 16, ..Quality::of_samples(SAMPLES) };
    let options = RenderOptions { size: SIZE, quality, first_hits: true, ..RenderOptions::default() };
    let (frame, _) = render_scene(scene, camera, &lens, &options, |_| {}).unwrap();
    let truth = Truth::new(scene, models);
    let picture = truth.picture(camera, &lens, SIZE, SAMPLES, &Tone::default()).unwrap();
    let hits = truth.first_hits(camera, &lens, SIZE).unwrap();
    Both { frame, pixels: picture.pixels, truth: hits.into_iter().map(FirstHit::from).collect() }
}

impl Both {
    /// Mean difference of displayed values, where both see something.
    fn mean_difference(&self) -> f64 {
        let hits = self.frame.first_hits.as_ref().unwrap();
        let (mut sum, mut count) = (0.0, 0.0);
        for (place, (a, b)) in self.frame.pixels.iter().zip(&self.pixels).enumerate() {
            if hits[place].distance.is_finite() && self.truth[place].distance.is_finite() {
                sum += (0..3).map(|channel| f64::from(a[channel].abs_diff(b[channel]))).sum::<f64>() / 3.0;
                count += 1.0;
            } else if !self.near_silhouette(place) {
                assert_eq!(a, b, "the background is the same");
            }
        }
        assert!(count > 2000.0);
        sum / count
    }

    /// Whether a pixel that sees something is next to one that does not, by the triangles.
    fn near_silhouette(&self, place: usize) -> bool {
        let [width, height] = SIZE.map(|size| size as usize);
        let (x, y) = (place % width, place / width);
        let rows = y.saturating_sub(1)..=(y + 1).min(height - 1);
        let mut around = rows
            .flat_map(|row| {
                (x.saturating_sub(1)..=(x + 1).min(width - 1)).map(move |column| row * width + column)
            })
            .map(|place| self.truth[place].distance.is_finite());
        let first = around.next();
        around.any(|sees| Some(sees) != first)
    }

    /// Silhouettes are within a pixel, and places within one and a half voxels of the triangle's plane, which along the ray
    /// is farther the more aslant it is seen.
    fn check_geometry(&self, voxel: f64, camera: &Camera) {
        let hits = self.frame.first_hits.as_ref().unwrap();
        let (mut near, mut both) = (0.0, 0.0);
        for (place, (a, b)) in hits.iter().zip(&self.truth).enumerate() {
            if a.distance.is_finite() != b.distance.is_finite() {
                assert!(self.near_silhouette(place), "silhouettes differ by more than a pixel at {place}");
            } else if a.distance.is_finite() {
                both += 1.0;
                let [a_normal, b_normal] = [a, b].map(|hit| Vec3::from_array(hit.normal).as_dvec3());
                let aslant = b_normal.dot(direction(camera, place)).abs();
                let apart = f64::from((a.distance - b.distance).abs()) * aslant;
                near += f64::from(a_normal.dot(b_normal) > 0.5 && apart < 1.5 * voxel);
            }
        }
        assert!(near / both > 0.99, "{} of {both} pixels see the same place", near / both);
        let errors = depth_and_normal_errors(hits, &self.truth, camera.pixel_at_one(SIZE[1])).unwrap();
        println!(
            "{errors:?}, mean difference {:.2}, rmse {:.2}",
            self.mean_difference(),
            rmse(&self.frame.pixels, &self.pixels)
        );
        assert!(
            errors.depth < 1.5 * voxel && errors.silhouette_share < 0.1 && errors.coverage_share < 0.01,
            "{errors:?}"
        );
    }
}

#[test]
fn voxels_of_a_sphere_look_like_its_triangles() {
    let mesh = sphere(6).colored_mesh();
    let model = Model::of_depth(&mesh, 8);
    let models = [truth_model(&mesh, &model)];
    let camera = Camera::framing(&model.octree, 4.0 / 3.0, DEFAULT_FOV);
    let found = both(&Scene::of_model(&model.octree, &camera), &models, &camera);
    found.check_geometry(1.0 / 256.0, &camera);
    assert!(found.mean_difference() < 1.5, "{}", found.mean_difference());
}

/// With textures, normals of the file and a highlight of its own.
#[test]
fn voxels_of_a_textured_model_look_like_its_triangles() {
    let Some(mesh) = shared("textured/spot.obj") else { return };
    let format = FileFormat::Version5 { compression: Compression::None };
    let model = Model::new(&mesh, &Options { depth: 8, format, ..Options::default() });
    let models = [truth_model(&mesh, &model)];
    let camera = Camera::framing(&model.octree, 4.0 / 3.0, DEFAULT_FOV);
    let found = both(&Scene::of_model(&model.octree, &camera), &models, &camera);
    found.check_geometry(1.0 / 256.0, &camera);
    assert!(found.mean_difference() < 4.0, "{}", found.mean_difference());
}

/// Instances of two materials on a ground, lamps of all kinds with hard and soft shadows.
#[test]
fn a_scene_of_voxels_looks_like_its_triangles() {
    let shape = sphere(5);
    let materials = vec![
        Material { specular: [0.9, 0.5, 0.5], shininess: 20.0, ..Material::matte("red", [0.9, 0.2, 0.1]) },
        Material::matte("blue", [0.1, 0.3, 0.9]),
    ];
    let is_above = |triangle: &[u32; 3]| u32::from(shape.positions[triangle[0] as usize].y > 0.5);
    let of_triangles = shape.triangles.iter().map(is_above).collect();
    let mesh = shape.mesh().with_materials(materials, of_triangles).unwrap();
    let format = FileFormat::Version5 { compression: Compression::None };
    let model = Model::new(&mesh, &Options { depth: 8, format, ..Options::default() });
    let models = [truth_model(&mesh, &model)];
    let camera = Camera {
        eye: DVec3::new(0.4, 2.5, 6.0),
        target: DVec3::new(0.2, 0.6, 0.0),
        up: DVec3::Y,
        vertical_fov: 40.0,
    };
    let mut scene = in_the_dark(&model, &camera);
    scene.background = Background::Gradient { bottom: Vec3::splat(0.2), top: Vec3::new(0.3, 0.5, 0.9) };
    scene.ambient.color = Vec3::splat(0.05);
    let place = |scale: f64, angle: f64, translation: DVec3| Instance {
        model: 0,
        placement: Similarity { scale, rotation: DQuat::from_rotation_z(angle), translation },
    };
    scene.instances =
        vec![place(1.4, 0.4, DVec3::new(-1.2, 0.1, -0.5)), place(1.0, -1.0, DVec3::new(0.3, 0.9, 0.2))];
    let white = SurfaceMaterial::matte(Vec3::splat(0.8));
    scene.ground = Some(Ground {
        height: 0.0,
        surfaces: [white, SurfaceMaterial::matte(Vec3::splat(0.3))],
        square: 0.5,
    });
    let light = |source, amount: f32, shadow| Light { source, color: Vec3::splat(amount), shadow };
    let position = Vec3::new(2.0, 3.0, 2.0);
    scene.lights = vec![
        light(Source::Directional { towards: Vec3::new(0.6, 0.64, 0.48), radius: 0.05 }, 0.3, true),
        light(Source::Point { position, radius: 0.0 }, 2.0, true),
        light(Source::Point { position: -position, radius: 0.1 }, 1.0, true),
        light(
            Source::Spot { position: Vec3::Y * 4.0, radius: 0.2, towards: -Vec3::Y, cone: [0.98, 0.9] },
            3.0,
            true,
        ),
        light(
            Source::Area { position: Vec3::new(-3.0, 2.0, 2.0), right: Vec3::Z, up: Vec3::Y * 0.5 },
            2.0,
            false,
        ),
        light(
            Source::Area { position: Vec3::new(-2.0, 3.0, 0.0), right: Vec3::X * 0.4, up: Vec3::Z * 0.4 },
            2.0,
            true,
        ),
    ];
    let found = both(&scene, &models, &camera);
    found.check_geometry(1.4 / 256.0, &camera);
    assert!(found.mean_difference() < 2.0, "{}", found.mean_difference());
}

/// Normals that a file keeps in 16 bits are no others than its codes, and as near as the code promises.
#[test]
fn normals_of_triangles_can_be_those_of_a_file() {
    let mesh = sphere(4).mesh();
    let model = Model::of_depth(&mesh, 5);
    let camera = Camera::framing(&model.octree, 4.0 / 3.0, DEFAULT_FOV);
    let scene = in_the_dark(&model, &camera);
    let seen = |model: TruthModel<'_>| {
        Truth::new(&scene, &[model]).first_hits(&camera, &Lens::default(), SIZE).unwrap()
    };
    let plain = seen(truth_model(&mesh, &model));
    for (code, bound) in [(NormalCode::Spherical, 0.8_f64), (NormalCode::Octahedral, 0.65)] {
        let coded = seen(truth_model(&mesh, &model).with_normal_code(code));
        let mut changed = 0;
        for (coded, plain) in coded.iter().zip(&plain).filter(|(_, plain)| plain.distance.is_finite()) {
            assert_eq!(coded.distance, plain.distance);
            let normal = coded.normal.as_vec3().to_array();
            assert_eq!(code.decode(code.encode(normal)), normal);
            assert!(coded.normal.angle_between(plain.normal).to_degrees() < bound, "{coded:?} {plain:?}");
            changed += u32::from(coded.normal != plain.normal);
        }
        assert!(changed > 1000, "{changed}");
    }
}

#[test]
fn what_triangles_do_not_show_is_said() {
    let mesh = floor().mesh();
    let model = Model::of_depth(&mesh, 4);
    let models = [truth_model(&mesh, &model)];
    let camera = above();
    let scene = in_the_dark(&model, &camera);
    let wide = Lens { aperture: 0.1, ..Lens::default() };
    let refused = |change: &dyn Fn(&mut Scene<'_>), models: &[TruthModel<'_>], lens: &Lens| {
        let mut scene = scene.clone();
        change(&mut scene);
        let truth = Truth::new(&scene, models);
        assert!(truth.first_hits(&camera, lens, SIZE).is_ok());
        truth.picture(&camera, lens, [2, 2], 1, &Tone::default()).unwrap_err().to_string()
    };
    let pinhole = Lens::default();
    let ground = |surface| Ground { height: 0.1, surfaces: [surface; 2], square: 1.0 };
    let matte = SurfaceMaterial::matte(Vec3::ONE);
    for (message, expected) in [
        (refused(&|scene| scene.models[0].surfaces[0].diffuse = Vec3::ZERO, &models, &pinhole), "materials"),
        (refused(&|_| {}, &[], &pinhole), "not a mesh"),
        (refused(&|_| {}, &models, &wide), "depth of field"),
        (refused(&|scene| scene.ambient.occlusion = Some(1.0), &models, &pinhole), "occlusion"),
        (
            refused(
                &|scene| scene.ground = Some(ground(SurfaceMaterial { reflectivity: Vec3::ONE, ..matte })),
                &models,
                &pinhole,
            ),
            "mirrors",
        ),
        (
            refused(
                &|scene| scene.ground = Some(ground(SurfaceMaterial { transparency: 0.5, ..matte })),
                &models,
                &pinhole,
            ),
            "light pass",
        ),
        (
            refused(
                &|scene| scene.ground = Some(ground(SurfaceMaterial { emission: Vec3::ONE, ..matte })),
                &models,
                &pinhole,
            ),
            "shine",
        ),
    ] {
        assert!(message.contains(expected), "{message}");
    }
    let blind = Camera { target: camera.eye, ..camera };
    let truth = Truth::new(&scene, &models);
    assert!(truth.first_hits(&blind, &pinhole, SIZE).is_err());
    assert!(truth.picture(&blind, &pinhole, SIZE, 1, &Tone::default()).is_err());
}
