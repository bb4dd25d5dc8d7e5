//! Lamps: where light comes from, and how much of it arrives.

use crate::color::Light3;
use glam::{Vec2, Vec3};

/// A lamp.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// Where it is and how it shines.
    pub source: Source,
    /// Amount of light: of a directional lamp what arrives, of others what arrives at distance one, straight in front.
    pub color: Light3,
    /// Whether what stands in its way makes a shadow.
    pub shadow: bool,
}

/// Where a lamp is and how it shines. Positions and lengths are in the scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Source {
    /// From very far away, such as the sun.
    Directional {
        /// Unit vector towards the lamp.
        towards: Vec3,
        /// Half the angle that its disk covers in the sky, in radians below a quarter turn; 0 for hard shadows.
        radius: f32,
    },
    /// A ball; falls off with the square of the distance.
    Point {
        /// Its middle.
        position: Vec3,
        /// Its radius; 0 for hard shadows.
        radius: f32,
    },
    /// A ball that shines only into a cone; falls off with the square of the distance.
    Spot {
        /// Its middle.
        position: Vec3,
        /// Its radius; 0 for hard shadows.
        radius: f32,
        /// Unit vector, the axis of the cone.
        towards: Vec3,
        /// Cosines of the angles to the axis within which all light arrives, and beyond which none does.
        cone: [f32; 2],
    },
    /// A parallelogram that shines on the side from which `right` to `up` turns counterclockwise, in proportion to the
    /// cosine; falls off with the square of the distance.
    Area {
        /// Its middle.
        position: Vec3,
        /// From the middle to the middle of one edge.
        right: Vec3,
        /// From the middle to the middle of the next edge.
        up: Vec3,
    },
}

/// Light that arrives at a point from a point of a lamp, if nothing is in between.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Arriving {
    /// Unit vector towards the lamp.
    pub towards: Vec3,
    /// How far it is away; infinitely if it has no place.
    pub distance: f32,
    /// Amount of light on a surface that faces the lamp.
    pub amount: Light3,
}

impl Light {
    /// A lamp very far away that makes no shadows. `towards` is a unit vector.
    #[must_use]
    pub fn directional(towards: Vec3, color: Light3) -> Self {
        Self { source: Source::Directional { towards, radius: 0.0 }, color, shadow: false }
    }

    /// Whether it has an extent, so that its shadows are soft.
    #[must_use]
    pub fn is_soft(&self) -> bool {
        match self.source {
            Source::Directional { radius, .. }
            | Source::Point { radius, .. }
            | Source::Spot { radius, .. } => radius > 0.0,
            Source::Area { .. } => true,
        }
    }

    /// What arrives at `position` from the middle of the lamp.
    #[inline(always)]
    pub(crate) fn middle_at(&self, position: Vec3) -> Arriving {
        match self.source {
            // The most common lamp, without a call and its way through memory.
            Source::Directional { towards, radius } if radius <= 0.0 => {
                Arriving { towards, distance: f32::INFINITY, amount: self.color }
            }
            _ => self.arriving_at(position, Vec2::splat(0.5)),
        }
    }

    /// What arrives at `position` from the point of the lamp that is chosen by two numbers in [0, 1), evenly for evenly
    /// spread numbers.
    pub(crate) fn arriving_at(&self, position: Vec3, chosen: Vec2) -> Arriving {
        match self.source {
            Source::Directional { towards, radius } => {
                let towards = if radius > 0.0 {
                    let [right, up] = across(towards);
                    let [x, y] = (on_disk(chosen) * libm::tanf(radius)).to_array();
                    (towards + right * x + up * y).normalize()
                } else {
                    towards
                };
                Arriving { towards, distance: f32::INFINITY, amount: self.color }
            }
            Source::Point { position: middle, radius } => self.ball_at(position, middle, radius, chosen),
            Source::Spot { position: middle, radius, towards, cone: [all, none] } => {
                let arriving = self.ball_at(position, middle, radius, chosen);
                let cosine = -arriving.towards.dot(towards);
                let share = ((cosine - none) / (all - none).max(f32::EPSILON)).clamp(0.0, 1.0);
                // A smooth step between the two cones.
                let share = share * share * (3.0 - 2.0 * share);
                Arriving { amount: arriving.amount * share, ..arriving }
            }
            Source::Area { position: middle, right, up } => {
                let [x, y] = (chosen * 2.0 - 1.0).to_array();
                let arriving = self.point_at(position, middle + right * x + up * y);
                let facing = -arriving.towards.dot(right.cross(up).normalize_or_zero());
                Arriving { amount: arriving.amount * facing.max(0.0), ..arriving }
            }
        }
    }

    /// From a ball, seen as a disk that faces the point.
    fn ball_at(&self, position: Vec3, middle: Vec3, radius: f32, chosen: Vec2) -> Arriving {
        if radius > 0.0 {
            let towards = (middle - position).normalize_or(Vec3::Y);
            let [right, up] = across(towards);
            let [x, y] = (on_disk(chosen) * radius).to_array();
            self.point_at(position, middle + right * x + up * y)
        } else {
            self.point_at(position, middle)
        }
    }

    fn point_at(&self, position: Vec3, from: Vec3) -> Arriving {
        let offset = from - position;
        let squared = offset.length_squared().max(f32::MIN_POSITIVE);
        let distance = squared.sqrt();
        Arriving { towards: offset / distance, distance, amount: self.color / squared }
    }
}

/// Two unit vectors that are at right angles to a unit vector and to each other (Duff et al., "Building an orthonormal
/// basis, revisited", 2017).
pub(crate) fn across(axis: Vec3) -> [Vec3; 2] {
    let sign = 1f32.copysign(axis.z);
    let a = -1.0 / (sign + axis.z);
    let b = axis.x * axis.y * a;
    [
        Vec3::new(1.0 + sign * axis.x * axis.x * a, sign * b, -sign * axis.x),
        Vec3::new(b, sign + axis.y * axis.y * a, -axis.y),
    ]
}

/// A point of the unit disk from one of the unit square, evenly; neighbours stay neighbours (Shirley and Chiu, "A low
/// distortion map between disk and square", 1997).
pub(crate) fn on_disk(chosen: Vec2) -> Vec2 {
    use std::f32::consts::{FRAC_PI_2, FRAC_PI_4};
    let [x, y] = (chosen * 2.0 - 1.0).to_array();
    if x == 0.0 && y == 0.0 {
        return Vec2::ZERO;
    }
    let (radius, angle) =
        if x.abs() > y.abs() { (x, FRAC_PI_4 * (y / x)) } else { (y, FRAC_PI_2 - FRAC_PI_4 * (x / y)) };
    Vec2::new(libm::cosf(angle), libm::sinf(angle)) * radius
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(source: Source) -> Light {
        Light { source, color: Vec3::ONE, shadow: true }
    }

    #[test]
    fn light_falls_off_with_the_square_of_the_distance() {
        let lamp = point(Source::Point { position: Vec3::ZERO, radius: 0.0 });
        assert_eq!(lamp.middle_at(Vec3::Z).amount, Vec3::ONE);
        assert_eq!(lamp.middle_at(Vec3::Z * 2.0).amount, Vec3::splat(0.25));
        assert_eq!(lamp.middle_at(Vec3::Z * 2.0).distance, 2.0);
    }

    #[test]
    fn a_spot_shines_into_its_cone_alone() {
        let lamp = point(Source::Spot {
            position: Vec3::ZERO,
            radius: 0.0,
            towards: Vec3::X,
            cone: [30f32.to_radians().cos(), 40f32.to_radians().cos()],
        });
        let at = |degrees: f32| {
            lamp.middle_at(Vec3::new(degrees.to_radians().cos(), degrees.to_radians().sin(), 0.0)).amount.x
        };
        assert!((at(29.0) - 1.0).abs() < 1e-6 && at(41.0) == 0.0);
        assert!(at(33.0) > at(36.0) && at(36.0) > at(39.0) && at(39.0) > 0.0);
    }

    #[test]
    fn an_area_shines_to_its_front() {
        let lamp = point(Source::Area { position: Vec3::ZERO, right: Vec3::X, up: Vec3::Y });
        assert_eq!(lamp.middle_at(Vec3::Z).amount, Vec3::ONE);
        assert_eq!(lamp.middle_at(-Vec3::Z).amount, Vec3::ZERO);
    }

    #[test]
    fn the_disk_is_covered_evenly() {
        const SIDE: usize = 64;
        let mut within_half = 0;
        for step in 0..SIDE * SIDE {
            let chosen = Vec2::new((step % SIDE) as f32 + 0.5, (step / SIDE) as f32 + 0.5) / SIDE as f32;
            let point = on_disk(chosen);
            assert!(point.length() <= 1.0);
            within_half += usize::from(point.length() < 0.5);
        }
        assert!((within_half as f32 / (SIDE * SIDE) as f32 - 0.25).abs() < 0.01);
    }

    #[test]
    fn bases_are_orthonormal() {
        for axis in [Vec3::X, Vec3::Y, Vec3::Z, -Vec3::Z, Vec3::new(0.6, 0.0, -0.8), Vec3::ONE.normalize()] {
            let [right, up] = across(axis);
            let off = [right.dot(up), right.dot(axis), up.dot(axis), right.length() - 1.0, up.length() - 1.0];
            assert!(off.iter().all(|off| off.abs() < 1e-6), "{axis}: {off:?}");
        }
    }
}
