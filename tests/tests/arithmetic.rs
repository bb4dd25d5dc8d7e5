//! Single precision and double beside the exact walk: the fast setting is off by a rounding, the exact one never is.

use glam::{DVec3, Vec3};
use octvox_format::{SphericalNormal, Voxel};
use octvox_raytracer::oracle::{ExactHit, LatticeRay, first_hit};
use octvox_raytracer::scene::{
    Ambient, Background, Ground, Instance, Light, Scene, Similarity, Source, SurfaceMaterial,
};
use octvox_raytracer::{
    Arithmetic, Camera, CheckOptions, Frame, Hit, Lens, Octree, Projection, Quality, Ray, RenderOptions,
    RenderReport, Visibility, VisibilityOptions, Width, check, replay,
};
use octvox_tests::meshes::{cube, sphere, torus};
use octvox_tests::models::Model;
use octvox_tests::naive_walk::walk;
use octvox_tests::random::Random;
use octvox_tests::rays::{
    UNIT, axes_and_diagonals, exact_in_single_precision, is_of_hit, nearly_parallel, on_the_lattice,
    same_bits,
};
use octvox_tests::stage::{alone, exact, mirror, render_with};
use octvox_tests::tree::Tree;

fn in_double(octree: &Octree, rays: &[Ray]) -> Vec<Option<Hit>> {
    octree.hits_with(rays, Arithmetic::Double, Width::One)
}

/// Whether a ray ends in the exact cell, or in none if there is none.
fn is_exact(hit: &Option<Hit>, exact: &Option<ExactHit>) -> bool {
    match (hit, exact) {
        (Some(hit), Some(exact)) => is_of_hit(hit, exact.cell),
        (None, None) => true,
        _ => false,
    }
}

/// Asserts that rays end in the exact cell at the exact distance.
fn assert_exact(name: &str, octree: &Octree, lattice_rays: &[LatticeRay]) {
    let rays: Vec<Ray> = lattice_rays.iter().map(LatticeRay::to_ray).collect();
    for (ray, hit) in lattice_rays.iter().zip(in_double(octree, &rays)) {
        let exact = first_hit(octree, ray, |_| true);
        assert!(is_exact(&hit, &exact), "{name}: {ray:?}, {hit:?} instead of {exact:?}");
        assert_eq!(hit.map(|hit| hit.distance), exact.map(|exact| exact.distance), "{name}: {ray:?}");
    }
}

/// The setting matters: there are rays on which single precision meets another voxel, and double does not. Those that go
/// through corners of cells cross three planes at once, in the order of the axes only if nothing is rounded.
#[test]
fn rays_on_which_single_precision_is_wrong_double_is_right() {
    const DEPTH: u8 = 6;
    let random = &mut Random::new(1);
    let tree = Tree::random(random, DEPTH, 0.05, 0.0);
    let octree = tree.octree();
    let mut to_a_corner = || loop {
        let cell = [(); 3].map(|()| random.between(0, (1 << DEPTH) - 1));
        if tree.voxel_at(cell.map(|part| part as u32), DEPTH).is_some() {
            let corner = cell.map(|part| (part + random.between(0, 1)) * (UNIT >> DEPTH));
            let origin = [(); 3].map(|()| random.between(-UNIT / 2, 3 * UNIT / 2));
            let direction = std::array::from_fn(|axis| corner[axis] - origin[axis]);
            return LatticeRay { origin, direction };
        }
    };
    let lattice_rays: Vec<LatticeRay> = (0..50_000).map(|_| to_a_corner()).collect();
    let rays: Vec<Ray> = lattice_rays.iter().map(LatticeRay::to_ray).collect();
    let single = octree.hits(&rays, Width::Sixteen);
    let double = in_double(&octree, &rays);
    let mut wrong = Vec::new();
    for (place, ray) in lattice_rays.iter().enumerate() {
        let exact = first_hit(&octree, ray, |_| true);
        assert!(is_exact(&double[place], &exact), "{ray:?}: {:?} instead of {exact:?}", double[place]);
        if !is_exact(&single[place], &exact) {
            wrong.push((ray, single[place], exact));
        }
    }
    assert!(wrong.len() > 20 && wrong.len() < 10_000, "{}", wrong.len());

    // In an octree of nothing but that voxel single precision meets it, too, though the exact ray passes it by.
    let mut passed_by = 0;
    for (ray, hit, _) in wrong {
        let Some(Hit { cell, .. }) = hit else { continue };
        let voxel = Voxel { palette_index: 1, normal: SphericalNormal { theta: 0, phi: 0 } };
        let alone = Tree::of_cells(DEPTH, &[(cell, voxel)]).octree();
        assert_eq!(alone.hit(&ray.to_ray()).map(|hit| hit.cell), Some(cell), "{ray:?}");
        let exact = first_hit(&alone, ray, |_| true);
        assert!(is_exact(&in_double(&alone, &[ray.to_ray()])[0], &exact), "{ray:?}");
        passed_by += u32::from(exact.is_none());
    }
    assert!(passed_by > 0);
}

/// Octrees of even and odd depth, sparse and dense, whole and pruned.
fn random_octrees() -> impl Iterator<Item = (String, Tree, u8)> {
    (0..=6).flat_map(|depth| {
        [(0.02, 0.0), (0.1, 0.15), (0.5, 0.0), (1.0, 0.3)].into_iter().map(move |(fill, early)| {
            let random = &mut Random::new(u64::from(depth) + (fill * 1e3) as u64 * 10);
            let tree = Tree::random(random, depth, fill, early);
            let depth = tree.depth().max(1);
            (format!("depth {depth}, fill {fill}, early leaves {early}"), tree, depth)
        })
    })
}

/// A ray from a plane, an edge or a corner of the lattice along an axis or a diagonal.
fn along_planes(random: &mut Random) -> LatticeRay {
    let directions: Vec<[i32; 3]> = axes_and_diagonals().collect();
    let step = UNIT >> random.between(0, 7);
    let origin = [(); 3].map(|()| random.between(-UNIT / step, 2 * UNIT / step) * step);
    LatticeRay { origin, direction: random.choose(&directions).map(|part| part * random.between(1, UNIT)) }
}

/// A ray from far away to a point of the cube.
fn from_afar(random: &mut Random) -> LatticeRay {
    let origin = [(); 3].map(|()| random.between(-17 * UNIT, 17 * UNIT));
    let target = [(); 3].map(|()| random.between(0, UNIT));
    LatticeRay { origin, direction: std::array::from_fn(|axis| target[axis] - origin[axis]) }
}

/// Double precision follows every kind of ray on the lattice to the voxel and the distance of the definition, through
/// every grid.
#[test]
fn double_precision_is_the_definition() {
    for (number, (name, tree, depth)) in random_octrees().enumerate() {
        let mut octree = tree.octree();
        let random = &mut Random::new(100 + number as u64);
        let kinds = [exact_in_single_precision, on_the_lattice, along_planes, nearly_parallel, from_afar];
        let lattice_rays: Vec<LatticeRay> =
            (0..1500).map(|count| kinds[count % kinds.len()](random)).collect();
        let rays: Vec<Ray> = lattice_rays.iter().map(LatticeRay::to_ray).collect();
        let is_filled = |cell| tree.voxel_at(cell, depth).is_some();
        let naive: Vec<_> = lattice_rays.iter().map(|ray| walk(depth, ray, is_filled).hit).collect();
        for level in [0, 2, 6] {
            octree.set_grid(level);
            for ((ray, hit), naive) in lattice_rays.iter().zip(in_double(&octree, &rays)).zip(&naive) {
                let found =
                    hit.map(|hit| (hit.distance, naive.is_some_and(|naive| is_of_hit(&hit, naive.cell))));
                let expected = naive.map(|naive| (naive.distance.to_f64(), true));
                assert_eq!(found, expected, "{name}, grid level {level}: {ray:?}, {hit:?}, {naive:?}");
            }
        }
    }
}

/// Rays that begin in a voxel meet it where they begin; on a mesh's octree, too, every kind of ray ends in the exact cell.
#[test]
fn double_precision_is_exact_on_meshes() {
    for (name, mesh, depth) in
        [("cube", cube(), 5), ("sphere", sphere(3), 8), ("torus", torus(0.15, 48, 24), 7)]
    {
        let octree = Model::of_depth(&mesh.mesh(), depth).octree;
        let random = &mut Random::new(depth.into());
        let kinds = [on_the_lattice, along_planes, nearly_parallel, from_afar];
        let rays: Vec<LatticeRay> = (0..20_000).map(|count| kinds[count % kinds.len()](random)).collect();
        assert_exact(name, &octree, &rays);
        // From where those end.
        let from_within: Vec<LatticeRay> = rays
            .iter()
            .filter_map(|ray| {
                let cell = first_hit(&octree, ray, |_| true)?.cell;
                let size = UNIT >> depth;
                let origin = cell.map(|part| part as i32 * size + random.between(0, size - 1));
                Some(LatticeRay { origin, direction: ray.direction })
            })
            .collect();
        assert!(from_within.len() > 3000);
        assert_exact(name, &octree, &from_within);
        let rays: Vec<Ray> = from_within.iter().map(LatticeRay::to_ray).collect();
        assert!(in_double(&octree, &rays).iter().all(|hit| hit.is_some_and(|hit| hit.distance == 0.0)));
    }
}

/// −0.0 is zero, and so are components that are less than 2⁻¹⁰⁰ of the largest, whatever their sign.
#[test]
fn hardly_a_component_is_none() {
    let octree = Tree::random(&mut Random::new(5), 5, 0.05, 0.1).octree();
    let random = &mut Random::new(6);
    let mut hits = 0;
    for _ in 0..4000 {
        let ray = along_planes(random).to_ray();
        let expected = in_double(&octree, &[ray])[0];
        hits += u32::from(expected.is_some());
        for tiny in [-0.0f64, 5e-324, -5e-324, 1e-310, -1e-310, 1e-40, -1e-40] {
            let changed = |vector: DVec3, zero: f64| {
                DVec3::from_array(vector.to_array().map(|part| if part == 0.0 { zero } else { part }))
            };
            let origin = changed(ray.origin, -0.0);
            // In proportion to the largest component.
            let tiny = if tiny.abs() > 1e-300 { tiny * ray.direction.abs().max_element() } else { tiny };
            let other = Ray { origin, direction: changed(ray.direction, tiny) };
            let hit = in_double(&octree, &[other])[0];
            assert!(same_bits(&hit, &expected), "{other:?}: {hit:?} instead of {expected:?}");
        }
    }
    assert!(hits > 150, "{hits}");
}

/// Whether anything is in the way before a distance is known in double precision, too, to the last bit.
#[test]
fn rays_are_blocked_at_the_exact_distance() {
    let octree = Model::of_depth(&sphere(3).mesh(), 7).octree;
    let random = &mut Random::new(9);
    let rays: Vec<Ray> = (0..3000).map(|_| on_the_lattice(random).to_ray()).collect();
    for (ray, hit) in rays.iter().zip(in_double(&octree, &rays)) {
        let ends = hit.map_or([1e300, f64::INFINITY, 0.0], |hit| {
            [hit.distance, hit.distance.next_up(), hit.distance.next_down()]
        });
        let expected = [false, hit.is_some(), false];
        let asked = ends.map(|end| (*ray, end));
        assert_eq!(octree.blocked_with(&asked, Arithmetic::Double, Width::One), expected, "{ray:?}");
    }
}

/// The check finds no difference at all in double precision, where there are some in single; its worst ray can be followed
/// again in both.
#[test]
fn the_check_demands_the_exact_voxel() {
    let octree = Model::of_depth(&sphere(5).mesh(), 9).octree;
    let found = |arithmetic| {
        check(&octree, &CheckOptions { rays: 60_000, seed: 2, arithmetic, ..CheckOptions::default() }, |_| {})
    };
    let (single, double) = (found(Arithmetic::Single), found(Arithmetic::Double));
    assert!(single.is_right() && single.differences > 0, "{single:?}");
    assert!(double.is_right(), "{double:?}");
    assert_eq!((double.differences, double.max_distance_error, &double.widths[..]), (0, 0.0, &[8][..]));
    let worst = replay(&octree, 2, single.worst_ray.unwrap());
    assert!(!worst.is_wrong && !worst.double_is_other_voxel);
    let of = |hit: Option<octvox_raytracer::ReplayedHit>| hit.map(|hit| (hit.cell, hit.distance));
    assert_eq!(of(worst.double.hit), of(worst.exact));
    // One difference is enough.
    let wrong = octvox_raytracer::CheckReport { differences: 1, ..double };
    assert!(!wrong.is_right());
}

/// Cameras about random octrees and within them.
fn random_cameras(random: &mut Random) -> [Camera; 3] {
    [1.6, 0.4, 20.0].map(|away| {
        let target = random.point(0.3, 0.7);
        Camera {
            eye: target + random.direction() * away,
            target,
            up: random.direction(),
            vertical_fov: 60.0 / away.max(1.0),
        }
    })
}

fn traced(octree: &Octree, camera: &Camera, size: [u32; 2], options: &VisibilityOptions) -> Visibility {
    let mut seen = Visibility::default();
    seen.trace(octree, camera, size, options).unwrap();
    seen
}

/// In pictures, double precision sees just what the exact walk sees; single precision sees something else in a few pixels
/// of many, and then what a ray meets that is moved by its rounding.
#[test]
fn pictures_in_double_precision_are_exact() {
    /// How far a ray is moved at the most: some roundings of coordinates below 4.
    const DISPLACEMENT: f64 = 4.0 * 4.0 / (1 << 24) as f64;
    const SIZE: [u32; 2] = [150, 111];
    let (mut pixels, mut others) = (0, 0);
    for (number, (depth, fill)) in [(6, 0.01), (7, 0.003), (9, 0.0004)].into_iter().enumerate() {
        let random = &mut Random::new(30 + number as u64);
        let cells: Vec<_> = (0..(fill * 8f64.powi(depth.into())) as usize)
            .map(|_| {
                let cell = [(); 3].map(|()| random.between(0, (1 << depth) - 1) as u32);
                (cell, octvox_tests::tree::voxel(random))
            })
            .collect();
        let octree = Tree::of_cells(depth, &cells).octree();
        for camera in random_cameras(random) {
            let exact = |camera: &Camera, order| {
                let mut seen = Visibility::default();
                let counts = seen.trace_exact(&octree, camera, SIZE, order).unwrap();
                (seen, counts)
            };
            let (expected, counts) = exact(&camera, Width::Eight);
            assert_eq!(counts.rays, u64::from(SIZE[0] * SIZE[1]));
            assert!(counts.hits > 500, "{counts:?}");
            for beams in [false, true] {
                let options =
                    VisibilityOptions { arithmetic: Arithmetic::Double, beams, ..Default::default() };
                let seen = traced(&octree, &camera, SIZE, &options);
                assert!(seen.node == expected.node && seen.part == expected.part, "{camera:?}, {beams}");
                for (a, b) in seen.distance.iter().zip(&expected.distance) {
                    assert!(a == b || (a - b).abs() <= a * f32::EPSILON, "{a} {b}");
                }
            }

            let options = VisibilityOptions { width: Width::Eight, ..Default::default() };
            let single = traced(&octree, &camera, SIZE, &options);
            let differs = |seen: &Visibility, place: usize| {
                single.node[place] != seen.node[place] || single.part[place] != seen.part[place]
            };
            let mut unexplained: Vec<usize> =
                (0..single.node.len()).filter(|&place| differs(&expected, place)).collect();
            pixels += SIZE[0] * SIZE[1];
            others += unexplained.len() as u32;
            for way in axes_and_diagonals() {
                if unexplained.is_empty() {
                    break;
                }
                let offset = DVec3::from_array(way.map(f64::from)) * DISPLACEMENT;
                let moved = Camera { eye: camera.eye + offset, target: camera.target + offset, ..camera };
                let (nearby, _) = exact(&moved, Width::Eight);
                unexplained.retain(|&place| differs(&nearby, place));
            }
            assert_eq!(unexplained, Vec::<usize>::new(), "{camera:?}");
        }
    }
    assert!(0 < others && others * 200 < pixels, "{others} of {pixels}");
}

/// Neither beams nor levels of detail nor threads change a picture in double precision. Where rays end is decided as in
/// single precision.
#[test]
fn beams_and_threads_change_nothing_in_double_precision() {
    let random = &mut Random::new(3);
    let octrees = [
        Model::of_depth(&torus(0.12, 48, 24).mesh(), 7).octree,
        Tree::random(random, 6, 0.1, 0.1).octree(),
        Tree::random(random, 5, 0.02, 0.0).octree(),
        Tree::random(random, 1, 0.5, 0.0).octree(),
        Tree::empty().octree(),
    ];
    for octree in &octrees {
        for camera in random_cameras(random) {
            for lod_pixels in [0.0, 1.0, 6.0] {
                let seen = |beams, threads| {
                    let options = VisibilityOptions {
                        arithmetic: Arithmetic::Double,
                        lod_pixels,
                        beams,
                        ..VisibilityOptions::default()
                    };
                    on_threads(threads, || traced(octree, &camera, [117, 75], &options))
                };
                let first = seen(true, 2);
                for (beams, threads) in [(false, 1), (true, 1), (true, 3)] {
                    let other = seen(beams, threads);
                    let setting =
                        format!("{camera:?}, {lod_pixels} pixels, beams {beams}, {threads} threads");
                    assert_eq!(first.distance, other.distance, "{setting}");
                    assert_eq!((&first.node, &first.part), (&other.node, &other.part), "{setting}");
                }
            }
        }
    }
}

fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
}

/// Mirrors, shadows, light from around and smooth voxels, one model or two, in either arithmetic.
#[test]
fn all_effects_are_there_in_double_precision() {
    let ball = Model::of_depth(&sphere(4).colored_mesh(), 6).octree;
    let surfaces = vec![SurfaceMaterial { diffuse: Vec3::splat(0.5), ..mirror(0.4) }; ball.palette().len()];
    let beside = Similarity { translation: DVec3::new(0.9, 0.1, -0.3), ..Similarity::IDENTITY };
    let second = Instance { model: 0, placement: beside };
    let single_instance = Scene {
        ground: Some(Ground {
            height: -0.1,
            surfaces: [SurfaceMaterial::matte(Vec3::splat(0.6)), mirror(0.3)],
            square: 0.3,
        }),
        lights: vec![Light {
            source: Source::Directional { towards: Vec3::new(0.48, 0.8, 0.36), radius: 0.05 },
            color: Vec3::ONE,
            shadow: true,
        }],
        ambient: Ambient { color: Vec3::splat(0.3), occlusion: Some(0.5), glow: false },
        background: Background::uniform(Vec3::new(0.2, 0.4, 0.8)),
        ..alone(&ball, &surfaces)
    };
    let two = Scene { instances: vec![single_instance.instances[0], second], ..single_instance.clone() };
    let eye = DVec3::new(1.9, 1.4, 2.6);
    let camera = Camera { eye, target: DVec3::new(0.7, 0.4, 0.3), up: DVec3::Y, vertical_fov: 40.0 };
    let lenses =
        [Lens::default(), Lens { projection: Projection::Orthographic { height: 2.0 }, ..Lens::default() }];
    for (scene, smooth_pixels) in
        [(&single_instance, f64::INFINITY), (&single_instance, 2.0), (&two, f64::INFINITY)]
    {
        for lens in lenses {
            let picture = |arithmetic, threads| -> (Frame, RenderReport) {
                let quality = Quality { arithmetic, smooth_pixels, most_samples: 3, ..exact() };
                let options = RenderOptions { size: [90, 61], quality, ..RenderOptions::default() };
                on_threads(threads, || render_with(scene, &(camera, lens), &options))
            };
            let (single, _) = picture(Arithmetic::Single, 2);
            let (double, report) = picture(Arithmetic::Double, 2);
            assert!(report.rays.shadow > 1000 && report.rays.reflection > 500, "{report:?}");
            assert!(report.rays.ambient > 500, "{report:?}");
            assert!(double == picture(Arithmetic::Double, 1).0);
            let changed = single.pixels.iter().zip(&double.pixels);
            // A step of the display may come of any rounding of a point; what is seen is the same in nearly all pixels.
            let is_other = |(a, b): &(&[u8; 4], &[u8; 4])| (0..4).any(|part| a[part].abs_diff(b[part]) > 2);
            let changed = changed.filter(is_other).count();
            assert!(changed * 50 < single.pixels.len(), "{changed} of {}", single.pixels.len());
        }
    }
}

/// Axis-parallel rays, and those with components that hardly count, cost no more cells than there are along an axis; others
/// no more than there are planes. Subnormal numbers make no way longer. (What they cost in time, `voxtrace study` prints.)
#[test]
fn no_ray_takes_more_steps_than_there_are_planes() {
    for depth in [4, 7] {
        let cells = 1u32 << depth;
        // Along three edges of the cube, in the way of no ray that runs in the edge, but so close that no step of it leaves more
        // than a node of four cells.
        let beside = (2..cells).step_by(2).flat_map(|at| [[at, 1, 0], [0, at, 1], [1, 0, at]]);
        // The box around the voxels is the cube.
        let far = cells - 1;
        let filled = beside.chain([[far, far, far], [0, far, far], [far, 0, far], [far, far, 0]]);
        let voxel = Voxel { palette_index: 1, normal: SphericalNormal { theta: 0, phi: 0 } };
        let filled: Vec<_> = filled.map(|cell| (cell, voxel)).collect();
        let mut octree = Tree::of_cells(depth, &filled).octree();
        let random = &mut Random::new(13);
        for grid in [0, 3] {
            octree.set_grid(grid);
            for arithmetic in Arithmetic::ALL {
                for tiny in [0.0f64, -0.0, 5e-324, -5e-324, 1e-310, -1e-310, 1e-38, -1e-38, 1.0, -0.3] {
                    let is_parallel = tiny.abs() < 1e-31;
                    for (axis, sign) in (0..3).flat_map(|axis| [(axis, -1.0), (axis, 1.0)]) {
                        let mut direction = DVec3::splat(tiny);
                        direction[axis] = sign;
                        // Only where the eye is at zero, the target keeps the smallest numbers.
                        let mut eye = if is_parallel { DVec3::ZERO } else { random.point(0.0, 1.0) };
                        eye[axis] = 0.5 - sign;
                        let steps = steps_of(&octree, eye, direction, arithmetic);
                        let bound = if is_parallel { cells } else { 3 * cells - 2 };
                        let setting = format!("{direction}, {arithmetic:?}, grid level {grid}");
                        assert!(steps <= u64::from(bound), "{steps} of {bound}: {setting}");
                        assert!(!is_parallel || steps >= u64::from(cells / 4), "{steps}: {setting}");
                    }
                }
            }
        }
    }
}

/// Cells that a ray visits: that of the one pixel of a picture.
fn steps_of(octree: &Octree, eye: DVec3, direction: DVec3, arithmetic: Arithmetic) -> u64 {
    let across = if direction.x.abs() < 0.9 { DVec3::X } else { DVec3::Y };
    let camera = Camera { eye, target: eye + direction, up: across, vertical_fov: 1.0 };
    let width = Width::One;
    let options = VisibilityOptions { arithmetic, width, count_steps: true, ..VisibilityOptions::default() };
    Visibility::default().trace(octree, &camera, [1, 1], &options).unwrap().steps
}
