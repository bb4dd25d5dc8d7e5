//! Rays against the triangles themselves: the truth that pictures of voxels are measured against.
//!
//! All in double precision. A triangle is projected along the ray onto a plane, and three edge functions tell whether the
//! ray passes within it (Woop, Benthin, Wald: Watertight ray/triangle intersection, 2013). Products are subtracted without
//! cancellation, so the sign of an edge function is exact for the projected corners, and two triangles agree on which side
//! of their edge a ray passes: a closed surface lets none through. Edges and corners belong to all that they bound.
//!
//! A binary hierarchy of boxes leaves out triangles that are certainly missed. Boxes are grown by more than is rounded, so
//! they change no result.

use glam::DVec3;
use octvox_converter::{Mesh, WorldTransform};
use octvox_raytracer::Ray;

/// Triangles made ready for rays, in the space that the rays are in.
///
/// Rays are finite, and the largest component of their direction is between 10⁻¹⁰⁰ and 10¹⁰⁰; others meet nothing.
/// Both sides of a triangle are met, and one seen exactly from its edge is not.
#[derive(Debug, Clone)]
pub struct Triangles {
    /// Numbers and corners of triangles; those of a leaf stand side by side.
    triangles: Vec<(usize, [DVec3; 3])>,
    /// Normals at the corners of each triangle, of any length; empty if there are none.
    corner_normals: Vec<[[f32; 3]; 3]>,
    /// The root first; empty if there are no triangles.
    nodes: Vec<Node>,
}

/// Where a ray meets a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TriangleHit {
    /// Distance along the ray, in units of the length of its direction.
    pub distance: f64,
    /// Number of the triangle, as in the mesh.
    pub triangle: usize,
    /// Weights of the second and the third corner; that of the first is what is missing to 1.
    pub barycentric: [f64; 2],
    /// Unit normal of the plane, towards the side from which the corners run counterclockwise, wherever the ray comes from;
    /// zero if the triangle is too thin to have one.
    pub normal: DVec3,
}

/// A box of the hierarchy, with its first child behind it.
#[derive(Debug, Clone, Copy)]
struct Node {
    bounds: Bounds,
    /// The second child of a node, or where the triangles of a leaf begin.
    next: usize,
    /// Triangles of a leaf; zero in a node with children.
    count: usize,
}

/// A leaf has no more triangles than this.
const LEAF: usize = 4;

/// Planes at which a box may be cut, and one more.
const BINS: usize = 16;

impl Triangles {
    /// The triangles of a mesh, in its own space.
    #[must_use]
    pub fn new(mesh: &Mesh) -> Self {
        Self::of_mesh(mesh, |position| position)
    }

    /// The triangles of a mesh where its voxels are in unit space, in which the octree's cube is [0, 1]³.
    ///
    /// `world` and `resolution` are those of the conversion's report. Vertices are not rounded to the converter's fine grid.
    #[must_use]
    pub fn in_unit_space(mesh: &Mesh, world: WorldTransform, resolution: u32) -> Self {
        let side = world.voxel_size * f64::from(resolution);
        Self::of_mesh(mesh, |position| (position - DVec3::from_array(world.origin)) / side)
    }

    /// Triangles by their corners, which are finite, numbered from 0.
    #[must_use]
    pub fn from_corners(corners: &[[DVec3; 3]]) -> Self {
        let mut boxes: Vec<_> = corners.iter().copied().map(Bounds::around).zip(0..).collect();
        let mut nodes = Vec::new();
        if !boxes.is_empty() {
            build(&mut nodes, &mut boxes, 0);
        }
        let triangles = boxes.into_iter().map(|(_, triangle)| (triangle, corners[triangle])).collect();
        Self { triangles, corner_normals: Vec::new(), nodes }
    }

    fn of_mesh(mesh: &Mesh, place: impl Fn(DVec3) -> DVec3) -> Self {
        let corner = |vertex: u32| place(DVec3::from_array(mesh.positions()[vertex as usize]));
        let corners: Vec<_> = mesh.triangles().iter().map(|triangle| triangle.map(corner)).collect();
        Self { corner_normals: mesh.corner_normals().to_vec(), ..Self::from_corners(&corners) }
    }

    /// The first triangle that a ray meets at the distance `from` or behind it; of several at one distance, that of the
    /// lowest number. Distances are in units of the length of the ray's direction.
    #[must_use]
    pub fn first_hit(&self, ray: &Ray, from: f64) -> Option<TriangleHit> {
        self.search(ray, [from, f64::INFINITY], false)
    }

    /// Whether a ray meets a triangle between two distances, both included.
    #[must_use]
    pub fn is_blocked(&self, ray: &Ray, from: f64, to: f64) -> bool {
        self.search(ray, [from, to], true).is_some()
    }

    /// The unit normal interpolated between those that the mesh has at the corners. A corner without one has that of the
    /// plane; the converter smooths normals there instead.
    #[must_use]
    pub fn shading_normal(&self, hit: &TriangleHit) -> DVec3 {
        let Some(corners) = self.corner_normals.get(hit.triangle) else { return hit.normal };
        let [a, b, c] = corners
            .map(|normal| DVec3::from_array(normal.map(f64::from)).try_normalize().unwrap_or(hit.normal));
        let [v, w] = hit.barycentric;
        (a * (1.0 - v - w) + b * v + c * w).try_normalize().unwrap_or(hit.normal)
    }

    /// The first hit within two distances, or any.
    fn search(&self, ray: &Ray, [from, mut to]: [f64; 2], is_any_enough: bool) -> Option<TriangleHit> {
        let query = Query::new(ray, &self.nodes.first()?.bounds)?;
        let mut first: Option<TriangleHit> = None;
        let mut waiting = vec![(from, 0)];
        while let Some((enter, node)) = waiting.pop() {
            if enter > to {
                continue;
            }
            let Node { next, count, .. } = self.nodes[node];
            if count == 0 {
                let already = waiting.len();
                for child in [next, node + 1] {
                    let enter = query.enter(&self.nodes[child].bounds, [from, to]);
                    waiting.extend(enter.map(|enter| (enter, child)));
                }
                // The nearer one is looked at first.
                if let [one, other] = &mut waiting[already..]
                    && one.0 < other.0
                {
                    std::mem::swap(one, other);
                }
                continue;
            }
            for &(triangle, corners) in &self.triangles[next..next + count] {
                let Some(hit) = query.meet(triangle, corners) else { continue };
                let is_first = first.is_none_or(|first| hit.distance < to || triangle < first.triangle);
                if hit.distance >= from && hit.distance <= to && is_first {
                    (first, to) = (Some(hit), hit.distance);
                    if is_any_enough {
                        return first;
                    }
                }
            }
        }
        first
    }
}

/// Puts the node of some triangles, and all below it, behind the nodes there are. Sorts the triangles, which are given by
/// their boxes and numbers; `first` are before them.
fn build(nodes: &mut Vec<Node>, triangles: &mut [(Bounds, usize)], first: usize) {
    let node = nodes.len();
    let bounds = union(triangles);
    nodes.push(Node { bounds, next: first, count: triangles.len() });
    if triangles.len() > LEAF {
        let middle = split(triangles);
        let (below, above) = triangles.split_at_mut(middle);
        build(nodes, below, first);
        nodes[node] = Node { bounds, next: nodes.len(), count: 0 };
        build(nodes, above, first + below.len());
    }
}

/// Sorts triangles so that the first few of them are better in a box of their own, by the surface area heuristic along the
/// axis on which their middles are farthest apart; returns how many.
fn split(triangles: &mut [(Bounds, usize)]) -> usize {
    let twice_middle = |bounds: &Bounds| bounds.low + bounds.high;
    let Bounds { low, high } = Bounds::around(triangles.iter().map(|(bounds, _)| twice_middle(bounds)));
    let axis = (high - low).max_position();
    let scale = BINS as f64 / (high - low)[axis];
    let bin = |bounds: &Bounds| (((twice_middle(bounds) - low)[axis] * scale) as usize).min(BINS - 1);
    let mut bins = [(Bounds::EMPTY, 0); BINS];
    for (bounds, _) in &*triangles {
        let (whole, count) = &mut bins[bin(bounds)];
        *whole = whole.union(bounds);
        *count += 1;
    }
    let count = |bins: &[(Bounds, usize)]| bins.iter().map(|(_, count)| count).sum::<usize>();
    let cost = |bins: &[(Bounds, usize)]| union(bins).area() * count(bins) as f64;
    let cuts = (1..BINS).filter(|&cut| (1..triangles.len()).contains(&count(&bins[..cut])));
    let best = cuts
        .map(|cut| (cut, cost(&bins[..cut]) + cost(&bins[cut..])))
        .min_by(|(_, one), (_, other)| one.total_cmp(other));
    // If all middles are in one place, any half is as good.
    let Some((cut, _)) = best else { return triangles.len() / 2 };
    let mut below = 0;
    for k in 0..triangles.len() {
        if bin(&triangles[k].0) < cut {
            triangles.swap(k, below);
            below += 1;
        }
    }
    below
}

/// The box around some boxes.
fn union<T>(boxes: &[(Bounds, T)]) -> Bounds {
    boxes.iter().fold(Bounds::EMPTY, |whole, (bounds, _)| whole.union(bounds))
}

/// A box with its sides along the axes.
#[derive(Debug, Clone, Copy)]
struct Bounds {
    low: DVec3,
    high: DVec3,
}

impl Bounds {
    const EMPTY: Self = Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };

    fn around(points: impl IntoIterator<Item = DVec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |bounds, point| bounds.union(&Self { low: point, high: point }))
    }

    fn union(&self, other: &Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// Half of the surface.
    fn area(&self) -> f64 {
        let DVec3 { x, y, z } = self.high - self.low;
        x * y + y * z + z * x
    }
}

/// A ray made ready for boxes and triangles.
struct Query {
    origin: DVec3,
    direction: DVec3,
    /// Of the direction's components; infinite where one is zero.
    reciprocal: DVec3,
    /// The axes, the one along which the ray is fastest last.
    axes: [usize; 3],
    /// What boxes are grown by on each side. Where a ray meets a triangle is off by some thirty roundings of the largest
    /// coordinate, as seen from the ray's origin; so it is in the grown box of the triangle, whatever was rounded.
    margin: f64,
}

impl Query {
    /// `None` if the ray meets nothing in `bounds`, as [`Triangles`] says.
    fn new(ray: &Ray, bounds: &Bounds) -> Option<Self> {
        let Ray { origin, direction } = *ray;
        let fastest = direction.abs().max_position();
        let is_usual = direction.is_finite() && (1e-100..=1e100).contains(&direction[fastest].abs());
        let farthest = (bounds.low - origin).abs().max((bounds.high - origin).abs()).max_element();
        (is_usual && farthest.is_finite()).then(|| Self {
            origin,
            direction,
            reciprocal: direction.recip(),
            axes: [(fastest + 1) % 3, (fastest + 2) % 3, fastest],
            margin: 64.0 * f64::EPSILON * farthest,
        })
    }

    /// Distance from which on the ray is in a box, or a little less; `None` if it certainly is not between two distances.
    fn enter(&self, bounds: &Bounds, [mut enter, mut leave]: [f64; 2]) -> Option<f64> {
        let low = bounds.low - self.origin - self.margin;
        let high = bounds.high - self.origin + self.margin;
        for axis in 0..3 {
            let reciprocal = self.reciprocal[axis];
            let is_down = reciprocal.is_sign_negative();
            let [near, far] = if is_down { [high[axis], low[axis]] } else { [low[axis], high[axis]] };
            // A ray in a plane that it is parallel to: 0 × ∞ is not a number, and does not count.
            enter = enter.max(near * reciprocal);
            leave = leave.min(far * reciprocal);
        }
        (enter <= leave).then_some(enter)
    }

    /// Where the ray, as a whole line, meets a triangle.
    fn meet(&self, triangle: usize, corners: [DVec3; 3]) -> Option<TriangleHit> {
        let [x, y, z] = self.axes.map(|axis| self.direction[axis]);
        let [a, b, c] = corners.map(|corner| {
            let offset = corner - self.origin;
            let [p, q, r] = self.axes.map(|axis| offset[axis]);
            // How far the ray passes it, times the speed along the last axis.
            [difference_of_products(p, z, r, x), difference_of_products(q, z, r, y), r]
        });
        let edge = |p: [f64; 3], q: [f64; 3]| difference_of_products(p[0], q[1], p[1], q[0]);
        let [u, v, w] = [edge(b, c), edge(c, a), edge(a, b)];
        let area = u + v + w;
        let is_within = u >= 0.0 && v >= 0.0 && w >= 0.0 || u <= 0.0 && v <= 0.0 && w <= 0.0;
        if !is_within || area == 0.0 {
            return None;
        }
        let [v, w] = [v / area, w / area];
        // Exact where the triangle is normal to the axis.
        let along = a[2] + (v * (b[2] - a[2]) + w * (c[2] - a[2]));
        Some(TriangleHit { distance: along / z, triangle, barycentric: [v, w], normal: normal(corners) })
    }
}

/// Unit normal of a triangle's plane; zero if it has none.
fn normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    let (p, q) = (b - a, c - a);
    let across = |u: usize, v: usize| difference_of_products(p[u], q[v], p[v], q[u]);
    DVec3::new(across(1, 2), across(2, 0), across(0, 1)).normalize_or_zero()
}

/// `a · b − c · d`, off by at most two roundings of the result, so that its sign is right and zero is exact (Jeannerod,
/// Louvet, Muller: Further analysis of Kahan's algorithm for the accurate computation of 2×2 determinants, 2013).
fn difference_of_products(a: f64, b: f64, c: f64, d: f64) -> f64 {
    let product = c * d;
    let rounded_off = (-c).mul_add(d, product);
    a.mul_add(b, -product) + rounded_off
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::meshes::{Shape, cube, sphere};
    use crate::models::Model;
    use crate::random::Random;
    use crate::rays::between;
    use glam::DQuat;

    /// What the hierarchy must give: every triangle is asked.
    fn by_brute_force(triangles: &Triangles, ray: &Ray, from: f64) -> Option<(f64, usize)> {
        let query = Query::new(ray, &triangles.nodes[0].bounds)?;
        let hits = triangles.triangles.iter().filter_map(|&(index, corners)| query.meet(index, corners));
        hits.map(|hit| (hit.distance, hit.triangle))
            .filter(|&(distance, _)| distance >= from)
            .min_by(|a, b| a.partial_cmp(b).unwrap())
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
    fn anywhere(random: &mut Random, count: usize) -> Triangles {
        let triangle = |random: &mut Random| {
            let (middle, size) = (random.point(0.0, 1.0), random.choose(&[0.01, 0.1, 0.5]));
            [(); 3].map(|()| middle + random.point(-size, size) * random.point(0.0, 1.0))
        };
        Triangles::from_corners(&(0..count).map(|_| triangle(random)).collect::<Vec<_>>())
    }

    /// Triangles with corners on a coarse lattice: many lie in planes, meet at corners, are the same or have no area.
    fn on_a_lattice(random: &mut Random, count: usize) -> Triangles {
        let corner = |random: &mut Random| random.point(0.0, 5.0).floor() / 4.0;
        Triangles::from_corners(&(0..count).map(|_| [(); 3].map(|()| corner(random))).collect::<Vec<_>>())
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
            for triangles in [anywhere(random, count), on_a_lattice(random, count)] {
                let mut hits = 0;
                for _ in 0..3000 {
                    let ray = ray(random);
                    let reach = ray.direction.length().recip();
                    for from in [0.0, 0.7 * reach, -reach] {
                        let expected = by_brute_force(&triangles, &ray, from);
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
        let triangles = anywhere(random, 300);
        let mut hits = 0;
        for _ in 0..5000 {
            let ray = between(random.point(-0.5, 1.5), random.point(0.0, 1.0));
            let others = triangles.triangles.iter().filter_map(|&(index, corners)| {
                by_cramers_rule(corners, &ray).map(|(distance, weights)| (distance, index, weights))
            });
            let other = others.filter(|other| other.0 >= 0.0).min_by(|a, b| a.0.total_cmp(&b.0));
            let hit = triangles.first_hit(&ray, 0.0);
            assert_eq!(hit.map(|hit| hit.triangle), other.map(|other| other.1), "{ray:?}");
            let (Some(hit), Some((distance, _, weights))) = (hit, other) else { continue };
            hits += 1;
            let (_, [a, b, c]) =
                *triangles.triangles.iter().find(|(index, _)| *index == hit.triangle).unwrap();
            assert!((hit.distance - distance).abs() < 1e-9, "{hit:?} instead of {distance}");
            assert!((0..2).all(|k| (hit.barycentric[k] - weights[k]).abs() < 1e-7), "{hit:?}, {weights:?}");
            let [v, w] = hit.barycentric;
            let point = a * (1.0 - v - w) + b * v + c * w;
            assert!((point - ray.origin - ray.direction * hit.distance).length() < 1e-14, "{hit:?}");
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
        for (axis, sign, zero) in
            (0..12).map(|code| (code / 4, [1.0, -1.0][code / 2 % 2], [0.0, -0.0][code % 2]))
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
}
