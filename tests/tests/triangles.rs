//! Rays against triangles: held against every triangle asked on its own, against another formula, and closed meshes.

use glam::{DQuat, DVec3};
use octvox_converter::Mesh;
use octvox_raytracer::Ray;
use octvox_raytracer::truth::Triangles;
use octvox_tests::meshes::{Shape, cube, sphere};
use octvox_tests::models::Model;
use octvox_tests::random::Random;
use octvox_tests::rays::between;

/// The corners of a triangle.
type Corners = [DVec3; 3];

/// What the hierarchy must give: every triangle is asked, alone.
fn by_brute_force(alone: &[Triangles], ray: &Ray, from: f64) -> Option<(f64, usize)> {
    let hits =
        alone.iter().zip(0..).filter_map(|(triangle, index)| Some((triangle.first_hit(ray, from)?, index)));
    hits.map(|(hit, index)| (hit.distance, index)).min_by(|a, b| a.partial_cmp(b).unwrap())
}

/// The test of Möller and Trumbore: distance and weights.
fn by_cramers_rule([a, b, c]: [DVec3; 3], ray: &Ray) -> Option<(f64, [f64; 2])> {
    let (p, q, from_a) = (b - a, c - a, ray.origin - a);
    let determinant = p.dot(ray.direction.cross(q));
    let v = from_a.dot(ray.direction.cross(q)) / determinant;
    let w = ray.direction.dot(from_a.cross(p)) / determinant;
    (v >= 0.0 && w >= 0.0 && v + w <= 1.0).then(|| (q.dot(from_a.cross(p)) / determinant, [v, w]))
}

/// Small triangles, large ones and slivers anywhere in the unit cube.
fn anywhere(random: &mut Random, count: usize) -> Vec<Corners> {
    let triangle = |random: &mut Random| {
        let (middle, size) = (random.point(0.0, 1.0), random.choose(&[0.01, 0.1, 0.5]));
        [(); 3].map(|()| middle + random.point(-size, size) * random.point(0.0, 1.0))
    };
    (0..count).map(|_| triangle(random)).collect()
}

/// Triangles with corners on a coarse lattice: many lie in planes, meet at corners, are the same or have no area.
fn on_a_lattice(random: &mut Random, count: usize) -> Vec<Corners> {
    let corner = |random: &mut Random| random.point(0.0, 5.0).floor() / 4.0;
    (0..count).map(|_| [(); 3].map(|()| corner(random))).collect()
}

/// Of every length, half of them through lattice points, some parallel to planes.
fn ray(random: &mut Random) -> Ray {
    let point = |random: &mut Random| {
        let point = random.point(-1.0, 2.0);
        if random.chance(0.5) { (point * 4.0).round() / 4.0 } else { point }
    };
    loop {
        let mut ray = between(point(random), point(random));
        ray.direction *= random.choose(&[1e-90, 0.3, 1.0, 1e90]);
        if ray.direction != DVec3::ZERO {
            return ray;
        }
    }
}

#[test]
fn boxes_change_nothing() {
    let random = &mut Random::new(1);
    for count in [1, 3, 30, 1000] {
        for corners in [anywhere(random, count), on_a_lattice(random, count)] {
            let triangles = Triangles::from_corners(&corners);
            let alone: Vec<_> = corners.iter().map(|corners| Triangles::from_corners(&[*corners])).collect();
            let mut hits = 0;
            for _ in 0..3000 {
                let ray = ray(random);
                let reach = ray.direction.length().recip();
                for from in [0.0, 0.7 * reach, -reach] {
                    let expected = by_brute_force(&alone, &ray, from);
                    let found = triangles.first_hit(&ray, from);
                    assert_eq!(
                        found.map(|hit| (hit.distance, hit.triangle)),
                        expected,
                        "{ray:?} from {from}"
                    );
                    let Some((distance, _)) = expected else { continue };
                    hits += 1;
                    // Blocked at this distance, and not before.
                    assert!(triangles.is_blocked(&ray, from, distance));
                    assert!(!triangles.is_blocked(&ray, from, distance.next_down()));
                    assert!(triangles.is_blocked(&ray, from, f64::INFINITY));
                }
            }
            assert!(hits > 10, "{hits} of {count}");
        }
    }
}

#[test]
fn triangles_are_where_their_equations_say() {
    let random = &mut Random::new(2);
    let corners = anywhere(random, 300);
    let triangles = Triangles::from_corners(&corners);
    let mut hits = 0;
    for _ in 0..5000 {
        let ray = between(random.point(-0.5, 1.5), random.point(0.0, 1.0));
        let others = corners.iter().zip(0..).filter_map(|(corners, index)| {
            by_cramers_rule(*corners, &ray).map(|(distance, weights)| (distance, index, weights))
        });
        let other = others.filter(|other| other.0 >= 0.0).min_by(|a, b| a.0.total_cmp(&b.0));
        let hit = triangles.first_hit(&ray, 0.0);
        assert_eq!(hit.map(|hit| hit.triangle), other.map(|other| other.1), "{ray:?}");
        let (Some(hit), Some((distance, _, weights))) = (hit, other) else { continue };
        hits += 1;
        let [a, b, c] = corners[hit.triangle];
        assert!((hit.distance - distance).abs() < 1e-9, "{hit:?} instead of {distance}");
        assert!((0..2).all(|k| (hit.barycentric[k] - weights[k]).abs() < 1e-7), "{hit:?}, {weights:?}");
        let [v, w] = hit.barycentric;
        let point = a * (1.0 - v - w) + b * v + c * w;
        assert!((point - ray.origin - ray.direction * hit.distance).length() < 1e-14, "{hit:?}");
        assert!((point - hit.point).length() < 1e-15, "{hit:?}");
        assert!((hit.normal - (b - a).cross(c - a).normalize()).length() < 1e-9, "{hit:?}");
    }
    assert!(hits > 1000, "{hits}");
}

/// From within convex models, to corners, edges and faces, and back from outside.
#[test]
fn closed_surfaces_let_nothing_through() {
    let random = &mut Random::new(3);
    for (shape, scale) in [cube(), sphere(1), sphere(4)]
        .into_iter()
        .flat_map(|shape| [DVec3::ONE, DVec3::new(1.0, 0.1, 0.003)].map(|scale| (shape.clone(), scale)))
    {
        // As it is, and turned and moved, so that nothing is a round number.
        for turn in [DQuat::IDENTITY, DQuat::from_rotation_arc(random.direction(), random.direction())] {
            let shift = if turn == DQuat::IDENTITY { DVec3::ZERO } else { random.point(-3.0, 3.0) };
            let place = |point: DVec3| turn * (point * scale) + shift;
            let positions = shape.positions.iter().copied().map(place).collect();
            let shape = Shape { positions, triangles: shape.triangles.clone() };
            let triangles = Triangles::new(&shape.mesh());
            for _ in 0..2000 {
                let offset = random.choose(&[0.0, 0.1]) * random.point(-1.0, 1.0);
                let inside = place(offset + 0.5);
                let [a, b, c] =
                    random.choose(&shape.triangles).map(|vertex| shape.positions[vertex as usize]);
                let along = random.unit();
                for target in [a, (a + b) / 2.0, a.lerp(b, along), a.lerp(b, along).lerp(c, along)] {
                    let out = triangles.first_hit(&between(inside, target), 0.0).expect("a leak");
                    assert!((out.distance - 1.0).abs() < 1e-9, "{out:?}");
                    let outside = inside + (target - inside) * 3.0;
                    let back = triangles.first_hit(&between(outside, inside), 0.0).expect("a leak");
                    assert!((back.distance - 2.0 / 3.0).abs() < 1e-9, "{back:?}");
                }
                let anywhere = random.direction();
                let direction = random.choose(&[DVec3::X, -DVec3::Y, DVec3::Z, anywhere]);
                assert!(triangles.is_blocked(&Ray { origin: inside, direction }, 0.0, f64::INFINITY));
            }
        }
    }
}

/// In and beside the planes of a cube's faces, with zeros of both signs.
#[test]
fn rays_parallel_to_axes() {
    let triangles = Triangles::new(&cube().mesh());
    let places = [-0.25, 0.0f64.next_down(), 0.0, 0.25, 0.5, 1.0, 1.0f64.next_up()];
    for (axis, sign, zero) in (0..12).map(|code| (code / 4, [1.0, -1.0][code / 2 % 2], [0.0, -0.0][code % 2]))
    {
        let mut ray = Ray { origin: DVec3::ZERO, direction: DVec3::splat(zero) };
        ray.direction[axis] = 2.0 * sign;
        ray.origin[axis] = 0.5 - 1.5 * sign;
        for (u, v) in places.into_iter().flat_map(|u| places.map(|v| (u, v))) {
            ray.origin[(axis + 1) % 3] = u;
            ray.origin[(axis + 2) % 3] = v;
            let is_in = [u, v].iter().all(|place| (0.0..=1.0).contains(place));
            let from_here = |from| triangles.first_hit(&ray, from).map(|hit| hit.distance);
            assert_eq!(from_here(0.0), is_in.then_some(0.5), "{ray:?}");
            assert_eq!(from_here(0.5), is_in.then_some(0.5), "{ray:?}");
            assert_eq!(from_here(0.6), is_in.then_some(1.0), "{ray:?}");
            assert_eq!(from_here(1.1), None, "{ray:?}");
            assert!(!triangles.is_blocked(&ray, 0.6, 0.9));
            assert_eq!(triangles.is_blocked(&ray, 0.6, 1.0), is_in);
        }
    }
}

#[test]
fn what_is_no_ray_meets_nothing() {
    let triangles = Triangles::new(&cube().mesh());
    for bad in [0.0, f64::NAN, f64::INFINITY, 1e-200, 1e200] {
        let ray = Ray { origin: DVec3::splat(0.5), direction: DVec3::new(0.0, bad, 0.0) };
        assert_eq!(triangles.first_hit(&ray, 0.0), None);
    }
    for bad in [f64::NAN, f64::INFINITY] {
        let ray = Ray { origin: DVec3::new(0.5, bad, 0.5), direction: DVec3::Y };
        assert_eq!(triangles.first_hit(&ray, 0.0), None);
    }
    let ray = Ray { origin: DVec3::splat(0.5), direction: DVec3::Y };
    assert_eq!(Triangles::from_corners(&[]).first_hit(&ray, 0.0), None);
}

/// A cube elsewhere in the world, and the voxels made of it.
#[test]
fn voxels_are_in_the_same_place() {
    let shape = cube();
    let positions =
        shape.positions.iter().map(|&position| position * 3.0 + DVec3::new(7.0, -2.0, 0.5)).collect();
    let mesh = Shape { positions, ..shape }.mesh();
    let Model { report, octree, .. } = Model::of_depth(&mesh, 4);
    let triangles = Triangles::in_unit_space(&mesh, report.world, report.resolution);
    for axis in 0..3 {
        let mut ray = Ray { origin: DVec3::new(0.3, 0.4, 0.7), direction: DVec3::ZERO };
        ray.direction[axis] = -1.0;
        ray.origin[axis] = 2.0;
        let hit = triangles.first_hit(&ray, 0.0).unwrap();
        assert_eq!((hit.distance, hit.normal), (1.0, -ray.direction));
        assert_eq!(octree.hit(&ray).unwrap().distance, 1.0);
    }
}

#[test]
fn normals_are_interpolated() {
    let corners = vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
    let mesh = Mesh::new(corners, vec![[0, 1, 2], [0, 2, 1]]).unwrap();
    let hit = |mesh: &Mesh, z: f64| {
        let triangles = Triangles::new(mesh);
        let hit =
            triangles.first_hit(&Ray { origin: DVec3::new(1.0, 2.0, z), direction: -z * DVec3::Z }, 0.0);
        (hit.unwrap(), triangles.shading_normal(&hit.unwrap()))
    };
    let (plain, shading) = hit(&mesh, 1.0);
    assert_eq!((plain.triangle, plain.barycentric), (0, [0.25, 0.5]));
    assert_eq!((plain.normal, shading), (DVec3::Z, DVec3::Z));
    assert_eq!(hit(&mesh, -1.0).0, plain, "from either side, the first of two is the same");

    // Of any length; the second corner has none.
    let normals = [[5.0, 0.0, 0.0], [0.0; 3], [0.0, 0.1, 0.0]];
    let mesh = mesh.with_corner_normals(vec![normals; 2]).unwrap();
    let (same, shading) = hit(&mesh, 1.0);
    assert_eq!(same, plain);
    assert!((shading - DVec3::new(0.25, 0.5, 0.25).normalize()).length() < 1e-7, "{shading}");
}

/// A hierarchy whose halves are built at the same time.
#[test]
fn many_triangles() {
    let random = &mut Random::new(4);
    let shape = sphere(6);
    let mut corners: Vec<Corners> = shape
        .triangles
        .iter()
        .map(|triangle| triangle.map(|vertex| shape.positions[vertex as usize]))
        .collect();
    for place in 1..corners.len() {
        corners.swap(place, random.between(0, place as i32) as usize);
    }
    let triangles = Triangles::from_corners(&corners);
    let alone: Vec<_> = corners.iter().map(|corners| Triangles::from_corners(&[*corners])).collect();
    for _ in 0..60 {
        let ray = between(random.point(-1.0, 2.0), random.point(0.25, 0.75));
        let found = triangles.first_hit(&ray, 0.0).map(|hit| (hit.distance, hit.triangle));
        assert_eq!(found, by_brute_force(&alone, &ray, 0.0));
        assert!(found.is_some());
    }
}
