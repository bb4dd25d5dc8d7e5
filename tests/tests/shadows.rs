//! Shadows on surfaces made of cubes, held against shadows traced on the triangles that they were made from.

use glam::{DVec3, Vec3};
use octvox_converter::{Mesh, Options, WorldTransform};
use octvox_raytracer::scene::{Ambient, Background, Light, Scene};
use octvox_raytracer::truth::Triangles;
use octvox_raytracer::{Camera, DEFAULT_FOV, Leave, Lens, Quality, Ray, RenderOptions, render_scene};
use octvox_tests::models::{Model, sample, shared};
use rayon::prelude::*;

/// How many pixels of a picture are in shadow, and ought to be.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Found {
    /// Pixels whose middle shows the model, in both.
    pixels: usize,
    /// In shadow, though the triangles are lit.
    wrongly_dark: usize,
    /// Lit, though the triangles are in shadow.
    wrongly_lit: usize,
    /// In shadow, both.
    dark: usize,
}

impl Found {
    fn share_dark(&self) -> f64 {
        100.0 * self.wrongly_dark as f64 / self.pixels as f64
    }

    fn share_lit(&self) -> f64 {
        100.0 * self.wrongly_lit as f64 / self.pixels as f64
    }
}

const SIZE: [u32; 2] = [480, 400];

/// Degrees above the horizon, and to the right of the z axis.
#[derive(Debug, Clone, Copy)]
struct Lamp {
    elevation: f32,
    azimuth: f32,
}

impl Lamp {
    /// From the right and behind the camera.
    const LOW: Self = Self { elevation: 10.0, azimuth: 50.0 };
    /// From the left and above.
    const HIGH: Self = Self { elevation: 54.0, azimuth: -17.0 };

    fn towards(self) -> Vec3 {
        let (elevation, azimuth) = (self.elevation.to_radians(), self.azimuth.to_radians());
        Vec3::new(elevation.cos() * azimuth.sin(), elevation.sin(), elevation.cos() * azimuth.cos())
    }
}

/// How shadows are found: how rays leave the surface, and over how many pixels on each side they are blurred then.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Method {
    leave: Leave,
    blur: usize,
}

impl Method {
    const ALL: [Self; 5] = [
        Self { leave: Leave::Surface, blur: 0 },
        Self { leave: Leave::Voxel, blur: 0 },
        Self { leave: Leave::Raised, blur: 0 },
        // The thesis's other suggestion is to blur what is shadowed wrongly.
        Self { leave: Leave::Voxel, blur: 2 },
        Self { leave: Leave::Voxel, blur: 6 },
    ];
}

/// For each pixel that faces the lamp, whether most of those that do are dark in the square about it.
fn blurred(facing: &[bool], dark: &[bool], blur: usize) -> Vec<bool> {
    let [width, height] = SIZE.map(|size| size as usize);
    let is_dark = |place: usize| {
        let (x, y) = (place % width, place / width);
        let rows = y.saturating_sub(blur)..=(y + blur).min(height - 1);
        let around = rows.flat_map(|row| {
            (x.saturating_sub(blur)..=(x + blur).min(width - 1)).map(move |column| row * width + column)
        });
        let (mut all, mut found) = (0, 0);
        for other in around.filter(|&other| facing[other]) {
            all += 1;
            found += usize::from(dark[other]);
        }
        facing[place] && 2 * found > all
    };
    (0..width * height).map(is_dark).collect()
}

fn compare(mesh: &Mesh, model: &Model, lamp: Lamp, Method { leave, blur }: Method) -> Found {
    let towards = lamp.towards();
    let camera = Camera::framing(&model.octree, f64::from(SIZE[0]) / f64::from(SIZE[1]), DEFAULT_FOV);
    let mut scene = Scene::of_model(&model.octree, &camera);
    scene.ambient = Ambient { color: Vec3::ZERO, occlusion: None, glow: false };
    scene.background = Background::uniform(Vec3::ZERO);
    // A matte surface: dark means that nothing comes from the lamp.
    scene.models[0].surfaces.iter_mut().for_each(|surface| {
        surface.specular = Vec3::ZERO;
        surface.diffuse = Vec3::ONE;
    });
    let quality = Quality { lod_pixels: 0.0, cutoff: 0.0, leave, ..Quality::default() };
    let options = RenderOptions { size: SIZE, quality, first_hits: true, ..RenderOptions::default() };
    let mut light = |shadow: bool| {
        scene.lights = vec![Light { shadow, ..Light::directional(towards, Vec3::ONE) }];
        let (frame, _) = render_scene(&scene, &camera, &Lens::default(), &options, |_| {}).unwrap();
        (frame.light.unwrap(), frame.first_hits.unwrap())
    };
    let ((without, hits), (with, _)) = (light(false), light(true));

    let facing: Vec<bool> = without.iter().map(|light| light.x > 0.0).collect();
    let dark: Vec<bool> = with.iter().zip(&facing).map(|(light, facing)| *facing && light.x == 0.0).collect();
    let dark = if blur > 0 { blurred(&facing, &dark, blur) } else { dark };

    let world = WorldTransform { ..model.report.world };
    let triangles = Triangles::in_unit_space(mesh, world, model.report.resolution);
    // The middle of each pixel, as the camera has it.
    let forward = (camera.target - camera.eye).normalize();
    let right = forward.cross(camera.up).normalize();
    let down = forward.cross(right);
    let pixel = 2.0 * (camera.vertical_fov.to_radians() / 2.0).tan() / f64::from(SIZE[1]);
    let towards = towards.as_dvec3();
    let of_pixel = |place: usize| {
        let mut found = Found::default();
        let (x, y) = (place % SIZE[0] as usize, place / SIZE[0] as usize);
        let x = (x as f64 + 0.5 - f64::from(SIZE[0]) / 2.0) * pixel;
        let y = (y as f64 + 0.5 - f64::from(SIZE[1]) / 2.0) * pixel;
        let ray = Ray { origin: camera.eye, direction: (forward + right * x + down * y).normalize() };
        let Some(hit) = triangles.first_hit(&ray, 0.0) else { return found };
        // Both must see the same place, not one of them what is behind an edge.
        let apart = (hit.distance - f64::from(hits[place].distance)).abs();
        if apart > 4.0 / f64::from(model.report.resolution) {
            return found;
        }
        found.pixels = 1;
        let normal = if hit.normal.dot(ray.direction) > 0.0 { -hit.normal } else { hit.normal };
        let point: DVec3 = ray.origin + ray.direction * hit.distance;
        let to_lamp = Ray { origin: point, direction: towards };
        let is_lit = normal.dot(towards) > 0.0 && !triangles.is_blocked(&to_lamp, 1e-7, f64::INFINITY);
        let (is_facing, is_dark) = (facing[place], dark[place]);
        found.wrongly_dark = usize::from(is_dark && is_lit);
        found.wrongly_lit = usize::from(is_facing && !is_dark && !is_lit);
        found.dark = usize::from(is_dark && !is_lit);
        found
    };
    let all = (0..without.len()).into_par_iter().map(of_pixel);
    all.reduce(Found::default, |a, b| Found {
        pixels: a.pixels + b.pixels,
        wrongly_dark: a.wrongly_dark + b.wrongly_dark,
        wrongly_lit: a.wrongly_lit + b.wrongly_lit,
        dark: a.dark + b.dark,
    })
}

/// A smooth surface made of cubes must not shadow itself, and what does shadow it must still do so.
#[test]
fn surfaces_do_not_shadow_themselves() {
    // Ribbons that touch and cross, under a low lamp; ribs and furrows that light grazes.
    let cases = [("knots", 9, Lamp::LOW, [1.05, 3.0]), ("shell", 9, Lamp::HIGH, [0.24, 1.5])];
    for (name, depth, lamp, [most_dark, most_lit]) in cases {
        let mesh = sample(name);
        let model = Model::of_depth(&mesh, depth);
        let found = compare(&mesh, &model, lamp, Method::ALL[0]);
        let naive = compare(&mesh, &model, lamp, Method::ALL[1]);
        println!("{name}: past the surface {found:?}, past the voxel {naive:?}");
        assert!(found.pixels > 30_000 && found.dark > 2000);
        assert!(found.share_dark() < most_dark, "{name}: {:.2} % wrongly dark", found.share_dark());
        assert!(found.share_lit() < most_lit, "{name}: {:.2} % wrongly lit", found.share_lit());
        // The test can tell: from outside the voxel alone, many more pixels are wrongly dark.
        assert!(naive.wrongly_dark > 4 * found.wrongly_dark);
    }
}

/// The table of the ray tracer's notes on light.
#[test]
#[ignore = "takes minutes, and models that not everybody has"]
fn self_shadowing_of_known_models() {
    for name in ["seed/teapot.obj", "seed/bunny.obj"] {
        let Some(mesh) = shared(name) else { continue };
        for depth in [9, 10, 12] {
            let model = Model::new(&mesh, &Options { depth, ..Options::default() });
            for method in Method::ALL {
                let found = compare(&mesh, &model, Lamp::LOW, method);
                println!(
                    "{name} {}³, {:7} blur {}: wrongly dark {:5.2} %, wrongly lit {:5.2} %, of {} pixels",
                    1 << depth,
                    method.leave.name(),
                    method.blur,
                    found.share_dark(),
                    found.share_lit(),
                    found.pixels
                );
                if method == Method::ALL[0] && depth >= 10 {
                    assert!(found.share_dark() < 0.5, "{:.2} %", found.share_dark());
                }
            }
        }
    }
}
