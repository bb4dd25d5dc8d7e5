//! Rays against the triangles themselves.
//!
//! All in double precision. A triangle is projected along the ray onto a plane, and three edge functions tell whether the
//! ray passes within it (Woop, Benthin, Wald: Watertight ray/triangle intersection, 2013). Products are subtracted without
//! cancellation, so the sign of an edge function is exact for the projected corners, and two triangles agree on which side
//! of their edge a ray passes: a closed surface lets none through. Edges and corners belong to all that they bound.
//!
//! A binary hierarchy of boxes leaves out triangles that are certainly missed. Boxes are grown by more than is rounded, so
//! they change no result.

use super::hierarchy::{Bounds, Node, hierarchy};
use crate::ray::Ray;
use glam::DVec3;
use octvox_converter::{Mesh, WorldTransform};
use rayon::prelude::*;

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
    /// The point by its weights: off the plane by roundings of the corners alone, however far the ray came.
    pub point: DVec3,
}

/// Room for the boxes that a ray has yet to look at: kept from ray to ray, it saves asking for memory.
#[derive(Debug, Default)]
pub(super) struct Waiting(Vec<(f64, usize)>);

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
        let numbered = corners.par_iter().copied().enumerate();
        let mut boxes: Vec<_> =
            numbered.map(|(triangle, corners)| (Bounds::around(corners), triangle)).collect();
        let nodes = hierarchy(&mut boxes);
        let triangles = boxes.into_par_iter().map(|(_, triangle)| (triangle, corners[triangle])).collect();
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
        self.search(ray, [from, f64::INFINITY], false, |_, _| true, &mut Waiting::default())
    }

    /// Whether a ray meets a triangle between two distances, both included.
    #[must_use]
    pub fn is_blocked(&self, ray: &Ray, from: f64, to: f64) -> bool {
        self.search(ray, [from, to], true, |_, _| true, &mut Waiting::default()).is_some()
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

    /// The first hit within two distances, or any. `is_there` tells, by the number of a triangle and the weights of its
    /// second and third corner, whether something is to be met.
    pub(super) fn search(
        &self,
        ray: &Ray,
        [from, mut to]: [f64; 2],
        is_any_enough: bool,
        is_there: impl Fn(usize, [f64; 2]) -> bool,
        Waiting(waiting): &mut Waiting,
    ) -> Option<TriangleHit> {
        let query = Query::new(ray, &self.nodes.first()?.bounds)?;
        // Its place in the list, its number, and where it is met.
        let mut first: Option<(usize, usize, Meeting)> = None;
        waiting.clear();
        waiting.push((from, 0));
        'search: while let Some((enter, node)) = waiting.pop() {
            if enter > to {
                continue;
            }
            let Node { next, count, .. } = self.nodes[node];
            if count == 0 {
                let already = waiting.len();
                for child in [node + next, node + 1] {
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
            for place in next..next + count {
                let (triangle, corners) = &self.triangles[place];
                let Some(meeting) = query.meet(corners) else { continue };
                let is_first = first.is_none_or(|(_, first, _)| meeting.distance < to || *triangle < first);
                let is_within = meeting.distance >= from && meeting.distance <= to;
                if is_within && is_first && is_there(*triangle, meeting.barycentric) {
                    to = meeting.distance;
                    first = Some((place, *triangle, meeting));
                    if is_any_enough {
                        break 'search;
                    }
                }
            }
        }
        first.map(|(place, triangle, Meeting { distance, barycentric })| {
            let corners = self.triangles[place].1;
            let ([a, b, c], [v, w]) = (corners, barycentric);
            let point = a * (1.0 - v - w) + b * v + c * w;
            TriangleHit { distance, triangle, barycentric, normal: normal(corners), point }
        })
    }
}

/// Where a ray meets some triangle.
#[derive(Debug, Clone, Copy)]
struct Meeting {
    distance: f64,
    barycentric: [f64; 2],
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
    fn meet(&self, corners: &[DVec3; 3]) -> Option<Meeting> {
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
        Some(Meeting { distance: along / z, barycentric: [v, w] })
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
