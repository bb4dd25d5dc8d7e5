//! Rays, and packets of rays made ready for the traversal.
//!
//! The traversal works in a mirrored space in which every ray runs towards smaller coordinates: an axis along
//! which a ray's direction is positive is reflected about the middle of the cube, `x ↦ 3 − x` on [1, 2].

use crate::departure::Departure;
use crate::lanes::{Lanes, MAX_LANES, Real, each};
use glam::{DVec3, Vec3};

/// A half-line in unit space, in which the octree's cube is [0, 1]³.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Where the ray begins.
    pub origin: DVec3,
    /// Where it goes; of any length but zero. Distances along the ray are in units of this length.
    pub direction: DVec3,
}

/// The least magnitude of a direction's component, relative to its largest, that is told from zero: a power of
/// two, so that its reciprocal is exact and finite. Across the cube it moves a ray by less than 2⁻⁹⁰.
const LEAST_SLOPE: f32 = f32::from_bits((127 - 100) << 23);

/// What tells where rays cross planes, and from where to where they go, in the mirrored space of the traversal. One component per
/// axis.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lines<L: Lanes> {
    /// Mirrored origin; the unit cube is [1, 2]³.
    pub origin: [L::Float; 3],
    /// What distances are divided by, `−slope` of [`Packet`], in the form that [`Lanes::quotient`] takes: finite, and not zero.
    pub divisor: [L::Float; 3],
    /// Distance from the mirrored origin at which the walk begins.
    pub start: L::Float,
    /// Distance at which it ends, for those that are asked about the end.
    pub end: L::Float,
}

impl<L: Lanes> Lines<L> {
    /// Distance at which each ray crosses a plane that is normal to an axis: the one question that the traversal asks.
    ///
    /// Never decreasing towards lower planes; see [`crate::Arithmetic`] for what is rounded.
    #[inline(always)]
    pub fn distance_to(&self, axis: usize, plane: L::Float) -> L::Float {
        L::quotient(plane - self.origin[axis], self.divisor[axis])
    }

    /// The distance at which each ray has crossed all of three planes, one for each axis, but not before its start.
    #[inline(always)]
    pub fn entry(&self, planes: [L::Float; 3]) -> L::Float {
        let enter: [L::Float; 3] = each(|axis| self.distance_to(axis, planes[axis]));
        // Zeros of either sign become +0.
        L::abs(L::max(L::max(enter[0], enter[1]), L::max(enter[2], self.start)))
    }

    /// The distance just behind the first of three planes, one for each axis: those through which a box is left, so that no
    /// rounding of the origin leads back into the box.
    #[inline(always)]
    pub fn behind(&self, planes: [L::Float; 3]) -> L::Float {
        let exit: [L::Float; 3] = each(|axis| self.distance_to(axis, planes[axis]));
        // Zeros of either sign become +0.
        L::next_up(L::abs(L::min(L::min(exit[0], exit[1]), exit[2])))
    }
}

/// Rays of a packet in the mirrored space of the traversal. One component per axis.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Packet<L: Lanes> {
    pub lines: Lines<L>,
    /// Magnitude of the direction, at least [`LEAST_SLOPE`].
    pub slope: [L::Float; 3],
    /// All ones where the axis is mirrored, else zero.
    pub mirror: [L::Word; 3],
    /// Lanes that hold a ray.
    pub active: L::Mask,
}

impl<L: Lanes> Packet<L> {
    /// Rays from one origin near the cube, in unit space: see [`is_near`].
    ///
    /// The components of each active direction are finite, and the largest is of magnitude between 2⁻²⁰ and 2²⁰.
    #[inline(always)]
    pub fn from_origin(origin: DVec3, direction: [L::Float; 3], active: L::Mask) -> Self {
        debug_assert!(is_near::<L::Real>(origin));
        let origin = in_traversal_space(origin);
        let origin = each(|axis| (L::real(origin[axis][0]), L::real(origin[axis][1])));
        Self::new(origin, direction, L::float(0.0), active)
    }

    /// `origin` holds, per axis, the origin in the traversal's space as it is and mirrored.
    #[inline(always)]
    fn new(
        origin: [(L::Float, L::Float); 3],
        direction: [L::Float; 3],
        start: L::Float,
        active: L::Mask,
    ) -> Self {
        // A component too small to count is none, whatever its sign.
        let mirrored = each(|axis| L::at_most(L::float(LEAST_SLOPE), direction[axis]));
        let slope = each(|axis| L::max(L::abs(direction[axis]), L::float(LEAST_SLOPE)));
        let mut origin = each(|axis| {
            let (plain, reflected) = origin[axis];
            L::select(mirrored[axis], reflected, plain)
        });
        for axis in 0..3 {
            let parallel = L::less(L::abs(direction[axis]), L::float(LEAST_SLOPE));
            if L::any(parallel) {
                origin[axis] = L::select(parallel, off_the_planes::<L>(origin[axis]), origin[axis]);
            }
        }
        Self {
            lines: Lines {
                origin,
                divisor: each(|axis| L::divisor(slope[axis])),
                start,
                end: L::float(f32::INFINITY),
            },
            slope,
            mirror: each(|axis| L::select_word(mirrored[axis], L::word(u32::MAX), L::word(0))),
            active,
        }
    }

    /// Rays that leave the boxes in which they begin: nothing is met in there.
    ///
    /// All coordinates are in the traversal's space, not mirrored; each origin is in its box, a cell of the octree.
    #[inline(always)]
    pub fn leaving(
        origin: [L::Float; 3],
        direction: [L::Float; 3],
        voxel: [[L::Float; 3]; 2],
        active: L::Mask,
    ) -> Self {
        let origin = each(|axis| (origin[axis], L::float(3.0) - origin[axis]));
        let mut packet = Self::new(origin, direction, L::float(0.0), active);
        packet.lines.start = packet.behind(voxel);
        packet
    }

    /// The distance just behind a box, for rays that are in it before. Corners are not mirrored.
    #[inline(always)]
    pub fn behind(&self, [low, high]: [[L::Float; 3]; 2]) -> L::Float {
        let mirrored = self.mirrored();
        self.lines.behind(each(|axis| L::select(mirrored[axis], L::float(3.0) - high[axis], low[axis])))
    }

    /// As [`Lines::distance_to`].
    #[inline(always)]
    pub fn distance_to(&self, axis: usize, plane: L::Float) -> L::Float {
        self.lines.distance_to(axis, plane)
    }

    /// Whether a plane, given as the bits of a float, has not been crossed, if those nearer than `reached` have.
    #[inline(always)]
    pub fn is_ahead(&self, axis: usize, plane: L::Word, reached: &[L::Float; 3]) -> L::Mask {
        L::at_most(reached[axis], self.distance_to(axis, L::from_bits(plane)))
    }

    /// Per axis, the lanes in which it is mirrored.
    #[inline(always)]
    pub fn mirrored(&self) -> [L::Mask; 3] {
        each(|axis| L::test(self.mirror[axis], L::word(1)))
    }

    /// The first `COUNT` of some rays; rays that are not finite or have no direction are left out.
    ///
    /// Also gives, per lane, what turns the traversal's distance into the ray's: an offset and a factor.
    pub fn from_rays(rays: impl IntoIterator<Item = Ray>) -> (Self, [Placement; MAX_LANES]) {
        let mut gathered = Gathered::<L>::new();
        for (lane, ray) in rays.into_iter().take(L::COUNT).enumerate() {
            gathered.put(lane, &ray);
        }
        (gathered.packet(), gathered.placements)
    }
}

/// Rays of a packet, gathered one by one.
pub(crate) struct Gathered<L: Lanes> {
    /// What turns the traversal's distances into those of the rays.
    pub placements: [Placement; MAX_LANES],
    /// Per axis, origins in the traversal's space as they are and mirrored.
    origin: [[[L::Real; MAX_LANES]; 2]; 3],
    direction: [[L::Real; MAX_LANES]; 3],
    /// Low and high corners of the voxels that are left.
    voxel: [[[f32; MAX_LANES]; 3]; 2],
    /// Lanes that hold a ray.
    active: u32,
    /// Lanes whose ray leaves a voxel.
    leaving: u32,
}

impl<L: Lanes> Gathered<L> {
    /// No rays.
    pub fn new() -> Self {
        let nothing = [L::Real::default(); MAX_LANES];
        Self {
            placements: [Placement::default(); MAX_LANES],
            origin: [[nothing; 2]; 3],
            direction: [nothing; 3],
            voxel: [[[0.0; MAX_LANES]; 3]; 2],
            active: 0,
            leaving: 0,
        }
    }

    /// Puts a ray in unit space into a lane, unless it is not finite or has no direction.
    pub fn put(&mut self, lane: usize, ray: &Ray) {
        let Some(near) = ray.approach::<L::Real>() else { return };
        self.active |= 1 << lane;
        self.placements[lane] = near.placement;
        for (axis, [plain, reflected]) in in_traversal_space(near.origin).into_iter().enumerate() {
            self.origin[axis][0][lane] = plain;
            self.origin[axis][1][lane] = reflected;
            self.direction[axis][lane] = L::Real::rounded(near.direction[axis]);
        }
    }

    /// Puts a ray into a lane that leaves a voxel. `direction` is a unit vector in unit space, in which the ray's unit of
    /// distance is `1 / scale`.
    pub fn put_leaving(&mut self, lane: usize, from: &Departure, direction: Vec3, scale: f64) {
        self.active |= 1 << lane;
        self.leaving |= 1 << lane;
        self.placements[lane] = Placement { offset: 0.0, factor: scale };
        for axis in 0..3 {
            let point = L::Real::from(from.point[axis]);
            self.origin[axis][0][lane] = point;
            self.origin[axis][1][lane] = L::Real::from(3.0) - point;
            self.direction[axis][lane] = L::Real::from(direction[axis]);
            self.voxel[0][axis][lane] = from.voxel[0][axis];
            self.voxel[1][axis][lane] = from.voxel[1][axis];
        }
    }

    /// The packet, its lanes as far as there are some.
    pub fn packet(&self) -> Packet<L> {
        let origin =
            self.origin.each_ref().map(|[plain, reflected]| (L::load_reals(plain), L::load_reals(reflected)));
        let direction = self.direction.each_ref().map(|values| L::load_reals(values));
        let mut packet = Packet::new(origin, direction, L::float(0.0), L::from_bitmask(self.active));
        if self.leaving != 0 {
            let voxel = self.voxel.each_ref().map(|corner| corner.each_ref().map(|values| L::load(values)));
            packet.lines.start =
                L::select(L::from_bitmask(self.leaving), packet.behind(voxel), packet.lines.start);
        }
        packet
    }
}

/// Per axis, a point of unit space in the traversal's space, as it is and mirrored.
pub(crate) fn in_traversal_space<R: Real>(point: DVec3) -> [[R; 2]; 3] {
    point.to_array().map(|component| [R::rounded(1.0 + component), R::rounded(2.0 - component)])
}

/// A coordinate that does not change along the ray, moved within its finest cell to where no plane is, so that the
/// ray never crosses one; out of the cube if it is on the high face.
///
/// A finest cell is two units of the mantissa or more, see [`crate::octree::MAX_DEPTH`]. The bits of a coordinate in the cube
/// are rounded down, to a place in the same cell.
#[inline(always)]
fn off_the_planes<L: Lanes>(coordinate: L::Float) -> L::Float {
    let middle = L::from_bits(L::to_bits(coordinate) | L::word(1));
    let beyond = coordinate + L::float(1.0);
    L::select(L::less(coordinate, L::float(2.0)), middle, beyond)
}

/// Where a ray's distances are in units of the traversal's: `ray = offset + factor · traversal`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Placement {
    pub offset: f64,
    pub factor: f64,
}

impl Placement {
    /// The ray's distance.
    pub fn distance(&self, traversed: impl Into<f64>) -> f64 {
        let traversed = traversed.into();
        // A direction too short for its reciprocal has an infinite factor.
        let along = if traversed == 0.0 { 0.0 } else { self.factor * traversed };
        self.offset + along
    }

    /// The least of the traversal's distances that is not before one of the ray; none is, if that is infinite. Zero for
    /// no ray, and for no distance at all.
    pub fn traversed<R: Real>(&self, distance: f64) -> R {
        if distance == f64::INFINITY {
            return R::INFINITY;
        }
        let zero = R::default();
        let is_before = |traversed: R| self.distance(traversed) < distance;
        if distance.is_nan() || !is_before(zero) {
            return zero;
        }
        // Bisection over the ranks of numbers from zero on; an estimate is near in most cases.
        let estimate = R::rounded((distance - self.offset) / self.factor);
        let near = if estimate > zero { estimate.rank() } else { 0 };
        let (mut before, mut reaches) = (0, R::INFINITY.rank());
        for probe in [near.saturating_sub(2), near.saturating_add(2).min(reaches)] {
            if is_before(R::of_rank(probe)) {
                before = before.max(probe);
            } else {
                reaches = reaches.min(probe);
            }
        }
        while reaches - before > 1 {
            let middle = before + (reaches - before) / 2;
            if is_before(R::of_rank(middle)) { before = middle } else { reaches = middle }
        }
        R::of_rank(reaches)
    }
}

/// A ray brought near the cube, its direction's largest component of magnitude in [1, 2).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct NearRay {
    pub origin: DVec3,
    pub direction: DVec3,
    pub placement: Placement,
}

impl Ray {
    /// Moves the origin close to the cube if it is too far away for numbers of a kind, and scales the direction by a power of
    /// two.
    ///
    /// `None` if a component is not finite, the direction is zero, or the ray does not come near the cube.
    pub(crate) fn approach<R: Real>(&self) -> Option<NearRay> {
        if !self.origin.is_finite() {
            return None;
        }
        let (direction, factor) = scale_to_one(self.direction)?;
        if is_near::<R>(self.origin) {
            let placement = Placement { offset: 0.0, factor };
            return Some(NearRay { origin: self.origin, direction, placement });
        }
        // The cube grown by one on each side: the walk itself finds the entry into the cube.
        let (mut enter, mut leave) = (0.0f64, f64::INFINITY);
        for axis in 0..3 {
            let (origin, slope) = (self.origin[axis], direction[axis]);
            if slope != 0.0 {
                let (a, b) = ((-1.0 - origin) / slope, (2.0 - origin) / slope);
                enter = enter.max(a.min(b));
                leave = leave.min(a.max(b));
            } else if !(-1.0..=2.0).contains(&origin) {
                return None;
            }
        }
        if enter > leave || enter.is_infinite() {
            return None;
        }
        // Rounding far away may leave the point somewhat outside the grown cube.
        let origin = (self.origin + direction * enter).clamp(DVec3::splat(-2.0), DVec3::splat(3.0));
        let offset = if enter == 0.0 { 0.0 } else { enter * factor };
        let placement = Placement { offset, factor };
        origin.is_finite().then_some(NearRay { origin, direction, placement })
    }
}

/// Whether an origin in unit space is close enough to the cube for numbers of a kind.
pub(crate) fn is_near<R: Real>(origin: DVec3) -> bool {
    origin.to_array().iter().all(|component| (-R::NEAR..=1.0 + R::NEAR).contains(component))
}

/// Scales `direction` by a power of two so that its largest component is of magnitude in [1, 2); also gives that
/// power. `None` if there is no such power: a zero, an infinity or a NaN.
fn scale_to_one(direction: DVec3) -> Option<(DVec3, f64)> {
    let mut scaled = direction;
    let mut factor = 1.0;
    // The exponent of the smallest subnormal is beyond one power of two, so it takes two rounds.
    for _ in 0..2 {
        let largest = scaled.abs().max_element();
        if !scaled.is_finite() || largest == 0.0 {
            return None;
        }
        let exponent = (largest.to_bits() >> 52) as i32 - 1023;
        let power = 2f64.powi((-exponent).clamp(-1022, 1022));
        scaled *= power;
        factor *= power;
    }
    Some((scaled, factor))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::Single;

    #[test]
    fn directions_are_scaled_exactly() {
        let tiny = f64::from_bits(1);
        for length in [tiny, 1e-310, 1e-300, 0.7, 1.0, 3.0, 1e300, f64::MAX] {
            let (scaled, factor) = scale_to_one(DVec3::new(length, -length, 0.0)).unwrap();
            assert!((1.0..2.0).contains(&scaled.x), "{length} became {scaled}");
            assert_eq!(scaled.y, -scaled.x);
            if factor.is_finite() && factor > 0.0 {
                assert_eq!(scaled.x / factor, length);
            }
        }
        for bad in [0.0, -0.0, f64::NAN, f64::INFINITY] {
            assert_eq!(scale_to_one(DVec3::splat(bad)), None);
        }
    }

    #[test]
    fn far_origins_are_moved_along_the_ray() {
        let ray = Ray { origin: DVec3::new(1e7, 0.5, 0.25), direction: DVec3::new(-4.0, 0.0, 0.0) };
        let near = ray.approach::<f32>().unwrap();
        assert_eq!(near.origin, DVec3::new(2.0, 0.5, 0.25));
        assert_eq!(near.placement, Placement { offset: (1e7 - 2.0) / 4.0, factor: 0.25 });
        assert_eq!(Ray { direction: DVec3::X, ..ray }.approach::<f32>(), None);
        assert_eq!(Ray { direction: DVec3::new(-1.0, 1.0, 0.0), ..ray }.approach::<f32>(), None);
    }

    #[test]
    fn reciprocals_are_finite_for_every_direction() {
        for component in [0.0, -0.0, f64::from_bits(1), -1e-30, 1.0] {
            let ray = Ray { origin: DVec3::splat(0.5), direction: DVec3::new(1.0, component, -1.0) };
            let (packet, _) = Packet::<Single>::from_rays([ray]);
            assert!(packet.active);
            assert!(
                packet.lines.divisor.iter().all(|reciprocal| reciprocal.is_finite() && *reciprocal < 0.0)
            );
            assert_eq!(packet.mirror[1] != 0, component == 1.0, "{component} is no direction");
        }
    }
}
