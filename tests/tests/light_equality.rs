//! One picture of a scene, whatever the width of packets, the number of threads, and the parts it is made in.

use glam::{DQuat, DVec3, Vec3};
use octvox_raytracer::scene::{
    Ambient, Background, Ground, Instance, Light, Model, Scene, Similarity, Source, SurfaceMaterial,
};
use octvox_raytracer::{
    Camera, Frame, Lens, Octree, Quality, Region, RenderOptions, RenderReport, Width, render,
};
use octvox_tests::meshes::{sphere, torus};
use octvox_tests::models;
use octvox_tests::pictures::framing;
use octvox_tests::random::Random;
use octvox_tests::stage::{alone, exact, glass, mirror, render_with};

/// No multiple of a tile or of a packet, so that some are cut.
const SIZE: [u32; 2] = [70, 53];

fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
}

fn octrees() -> [Octree; 2] {
    [
        models::Model::of_depth(&sphere(4).colored_mesh(), 5).octree,
        models::Model::of_depth(&torus(0.15, 48, 24).mesh(), 6).octree,
    ]
}

/// Everything at once: two models, six instances, ground, soft shadows, glass, mirrors, occlusion, things that shine.
fn everything([ball, ring]: &[Octree; 2]) -> Scene<'_> {
    let mut colored = Model::new(ball);
    for (number, surface) in colored.surfaces.iter_mut().enumerate() {
        if number % 7 == 0 {
            *surface = SurfaceMaterial { emission: Vec3::new(0.5, 0.3, 0.1), ..*surface };
        }
    }
    let of_one = |octree, surface| Model { octree, surfaces: vec![surface; octree.palette().len()] };
    let models = vec![
        colored,
        of_one(ring, mirror(0.6)),
        of_one(ball, SurfaceMaterial { absorption: Vec3::new(0.5, 0.1, 1.0), ..glass(1.5) }),
    ];
    let random = &mut Random::new(8);
    let instances = (0..6)
        .map(|number| Instance {
            model: number % 3,
            placement: Similarity {
                scale: 0.5 + random.unit(),
                rotation: DQuat::from_axis_angle(random.direction(), random.unit() * 6.0),
                translation: DVec3::new((number % 3) as f64 * 1.3, 0.4, (number / 3) as f64 * 1.5),
            },
        })
        .collect();
    let ground = [0.7, 0.2].map(|share| SurfaceMaterial {
        diffuse: Vec3::splat(share),
        reflectivity: Vec3::splat(0.1),
        ..mirror(0.1)
    });
    let lamp = |source, amount| Light { source, color: Vec3::splat(amount), shadow: true };
    Scene {
        models,
        instances,
        ground: Some(Ground { height: -0.3, surfaces: ground, square: 0.6 }),
        lights: vec![
            lamp(Source::Directional { towards: Vec3::new(0.48, 0.8, 0.36), radius: 0.02 }, 0.6),
            lamp(Source::Point { position: Vec3::new(1.0, 3.0, 3.0), radius: 0.3 }, 3.0),
            lamp(Source::Area { position: Vec3::new(1.0, 3.0, 0.0), right: Vec3::X, up: Vec3::Z }, 2.0),
            lamp(
                Source::Spot {
                    position: Vec3::new(-1.0, 3.0, 2.0),
                    radius: 0.0,
                    towards: Vec3::new(0.6, -0.8, 0.0),
                    cone: [0.95, 0.9],
                },
                4.0,
            ),
        ],
        ambient: Ambient { color: Vec3::new(0.2, 0.25, 0.3), occlusion: Some(0.5), glow: true },
        background: Background::Gradient { bottom: Vec3::ONE, top: Vec3::new(0.3, 0.5, 0.9) },
    }
}

fn view() -> (Camera, Lens) {
    let camera = Camera {
        eye: DVec3::new(3.0, 2.2, 5.5),
        target: DVec3::new(1.6, 0.7, 1.0),
        up: DVec3::Y,
        vertical_fov: 40.0,
    };
    (camera, Lens { aperture: 0.05, focus: Some(4.5), ..Lens::default() })
}

fn options(quality: Quality) -> RenderOptions {
    RenderOptions { size: SIZE, quality, first_hits: true, ..RenderOptions::default() }
}

fn assert_same(frame: &(Frame, RenderReport), other: &(Frame, RenderReport), setting: &str) {
    assert_eq!(frame.0.hash(), other.0.hash(), "{setting}");
    assert!(frame.0 == other.0, "{setting}: same pixels, other light or hits");
    assert_eq!(frame.1, other.1, "{setting}");
}

/// Rays through each pixel: a few, few and then more where needed, with levels of detail and few rays left out.
fn qualities() -> [Quality; 3] {
    [
        Quality { bounces: 4, light_samples: 2, ambient_samples: 2, ..exact() },
        Quality { samples: 2, most_samples: 12, bounces: 4, ..exact() },
        Quality { most_samples: 9, light_samples: 3, smooth_pixels: 8.0, ..Quality::of_samples(3) },
    ]
}

#[test]
fn every_width_and_number_of_threads_gives_the_same_picture() {
    let octrees = octrees();
    let scene = everything(&octrees);
    for quality in qualities() {
        let first = render_with(&scene, &view(), &options(quality));
        assert!(first.1.plan.names().len() >= 8, "{:?}", first.1.plan);
        for width in Width::ALL {
            let options = RenderOptions { width, ..options(quality) };
            assert_same(&render_with(&scene, &view(), &options), &first, &format!("{quality:?}, {width:?}"));
        }
        for threads in [1, 2, 3] {
            let again = on_threads(threads, || render_with(&scene, &view(), &options(quality)));
            assert_same(&again, &first, &format!("{quality:?}, {threads} threads"));
        }
    }
}

/// A model alone goes another way: its rays from the eye go together.
#[test]
fn every_width_gives_the_same_picture_of_a_single_instance() {
    let octrees = octrees();
    let all = everything(&octrees);
    for number in 0..3 {
        let instances = vec![all.instances[number]];
        let scene = Scene { instances, ..all.clone() };
        let target = scene.instances[0].placement.to_scene(DVec3::splat(0.5));
        let camera = Camera { eye: target + DVec3::new(0.8, 0.9, 2.0), target, ..view().0 };
        for lens in [Lens::default(), view().1] {
            for quality in qualities() {
                let first = render_with(&scene, &(camera, lens), &options(quality));
                for width in Width::ALL {
                    let options = RenderOptions { width, ..options(quality) };
                    let again = on_threads(width.lanes() as usize % 3 + 1, || {
                        render_with(&scene, &(camera, lens), &options)
                    });
                    assert_same(&again, &first, &format!("instance {number}, {lens:?}, {width:?}"));
                }
            }
        }
    }
}

/// Two regions hold the pixels of the whole, also where a neighbour in the other one decides how many rays a pixel gets.
#[test]
fn regions_are_parts_of_the_whole() {
    let octrees = octrees();
    let all = everything(&octrees);
    let alone = Scene { instances: vec![all.instances[0]], ground: None, ..all.clone() };
    for (name, scene, lens) in [("all", &all, view().1), ("one", &alone, Lens::default())] {
        for (number, quality) in qualities().into_iter().enumerate() {
            let (whole, _) = render_with(scene, &(view().0, lens), &options(quality));
            for split in [32, 41] {
                let regions = [(0, split), (split, SIZE[0] - split)]
                    .map(|(x, columns)| Region { corner: [x, 0], size: [columns, SIZE[1]] });
                let mut hit_pixels = 0;
                for region in regions {
                    let options = RenderOptions { region: Some(region), ..options(quality) };
                    let (part, _) = render_with(scene, &(view().0, lens), &options);
                    hit_pixels += part.hit_pixels;
                    let [whole_light, part_light] =
                        [&whole, &part].map(|frame| frame.light.as_ref().unwrap());
                    let mut different = 0;
                    for place in 0..whole.pixels.len() {
                        let pixel = [place as u32 % SIZE[0], place as u32 / SIZE[0]];
                        if region.contains(pixel) {
                            let is_same = part_light[place] == whole_light[place];
                            different += usize::from(!is_same || part.pixels[place] != whole.pixels[place]);
                        } else {
                            assert_eq!((part.pixels[place], part_light[place]), ([0; 4], Vec3::ZERO));
                        }
                    }
                    assert_eq!(different, 0, "{name}, quality {number}: {different} pixels of {region:?}");
                }
                assert_eq!(hit_pixels, whole.hit_pixels);
            }
        }
    }
}

#[test]
fn a_model_alone_is_the_only_instance_of_a_scene() {
    let [ball, _] = &octrees();
    let camera = framing(ball, SIZE);
    let studio = Scene::of_model(ball, &camera);
    let scene = Scene {
        models: vec![Model::new(ball)],
        lights: studio.lights.clone(),
        ambient: studio.ambient,
        background: studio.background.clone(),
        ..alone(ball, &[])
    };
    for quality in qualities() {
        let options = options(quality);
        let model = render(ball, &camera, &options, |_| {}).unwrap();
        assert_same(&render_with(&scene, &(camera, Lens::default()), &options), &model, "alone");
        // A second instance that is not in the picture: each ray goes its own way, in other roundings. That shows where one
        // passes an edge by a millionth of a pixel, if there is such a pixel at all.
        let mut with_another = scene.clone();
        let elsewhere = Similarity { translation: DVec3::Z * 50.0, ..Similarity::IDENTITY };
        with_another.instances.push(Instance { model: 0, placement: elsewhere });
        let (frame, _) = render_with(&with_another, &(camera, Lens::default()), &options);
        let differs = |pair: &(&[u8; 4], &[u8; 4])| (0..3).any(|k| pair.0[k].abs_diff(pair.1[k]) > 1);
        let different = frame.pixels.iter().zip(&model.0.pixels).filter(differs).count();
        println!("{different} pixels differ beside another instance");
        assert!(different <= 4, "{different} pixels differ beside another instance");
    }
}

/// Everything four times as large looks the same: powers of two are not rounded. Lamps need sixteen times the light, glass
/// absorbs a quarter on each length.
#[test]
fn a_scene_four_times_as_large_looks_the_same() {
    let octrees = octrees();
    let small = everything(&octrees);
    let mut large = small.clone();
    for instance in &mut large.instances {
        instance.placement.scale *= 4.0;
        instance.placement.translation *= 4.0;
    }
    for surface in large.models.iter_mut().flat_map(|model| &mut model.surfaces) {
        surface.absorption /= 4.0;
    }
    for light in &mut large.lights {
        match &mut light.source {
            Source::Directional { .. } => continue,
            Source::Point { position, radius } | Source::Spot { position, radius, .. } => {
                *position *= 4.0;
                *radius *= 4.0;
            }
            Source::Area { position, right, up } => [position, right, up].into_iter().for_each(|v| *v *= 4.0),
        }
        light.color *= 16.0;
    }
    large.ambient.occlusion = large.ambient.occlusion.map(|distance| distance * 4.0);
    large.ground = large.ground.map(|ground| Ground {
        height: ground.height * 4.0,
        square: ground.square * 4.0,
        ..ground
    });
    let (camera, lens) = view();
    let large_camera = Camera { eye: camera.eye * 4.0, target: camera.target * 4.0, ..camera };
    let large_lens =
        Lens { aperture: lens.aperture * 4.0, focus: lens.focus.map(|focus| focus * 4.0), ..lens };
    for quality in qualities() {
        let [small, large] =
            [(&small, camera, lens), (&large, large_camera, large_lens)].map(|(scene, camera, lens)| {
                let options = RenderOptions { first_hits: false, ..options(quality) };
                render_with(scene, &(camera, lens), &options)
            });
        assert_same(&small, &large, "four times as large");
    }
}
