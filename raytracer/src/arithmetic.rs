//! How precisely rays are followed.

use serde::Serialize;

/// The arithmetic in which a ray's distances to planes are found. Everything else about a walk is integers, see
/// `traversal.rs`, so it is the only one that there is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Arithmetic {
    /// Single precision: a distance is a product with the reciprocal of the slope, rounded twice.
    ///
    /// The order of the planes of one axis is right; planes of two axes that are crossed within about 2⁻²² of their
    /// distance of each other may change their order. So a ray may meet a voxel that it misses by that much.
    #[default]
    Single,
    /// Double precision: a distance is one division, rounded once. Always eight rays go together, whatever the
    /// [`Width`](crate::Width).
    ///
    /// On a lattice nothing is lost. Let the components of origin and direction be whole multiples of 2⁻²⁰ (those of
    /// [`LatticeRay`](crate::oracle::LatticeRay)) and planes such of 2⁻²², as they are in the deepest octree. The difference
    /// of a plane and the origin is n · 2⁻²² with a whole number n, a component of the direction d · 2⁻²⁰, and where
    /// |n| and |d| are below 2⁵³ both are kept exactly. So the distance is the fraction n / d, correctly rounded:
    ///
    /// - equal fractions give the same number, whichever planes they stem from;
    /// - of two fractions n₁ / d₁ < n₂ / d₂, all numbers positive, the greater one is larger by (n₂ d₁ − n₁ d₂) / (d₁ d₂),
    ///   and at least by 1 / (d₁ d₂), for the numerator is a whole number. That is 1 / (n₁ d₂) of the smaller one, and
    ///   if n₁ d₂ < 2⁵² it is more than the distance of neighbouring numbers there, 2⁻⁵² of it. So both are not
    ///   rounded to the same number, and their order is kept.
    ///
    /// A ray from up to 30 cubes away to a point of the cube, which is at distance 1, has n below 31 · 2²² and d below
    /// 31 · 2²⁰; one from up to 250 cubes away whose direction is no longer than four cubes n below 251 · 2²² and d up to
    /// 2²². So rays of both kinds visit just the cells of the exact walk, without exception. Rays that are on no lattice may
    /// meet a voxel that they miss by about 2⁻⁵⁰.
    ///
    /// A component of a direction that is less than 2⁻¹⁰⁰ of the largest is taken for zero, as in single precision; on the
    /// lattice no component but zero is that small. A ray crosses no plane that it runs parallel to, also where it lies in
    /// one.
    ///
    /// The rays of pictures keep double precision from the eye of a pinhole camera to the first thing, in scenes of one
    /// model. Directions of all others are rounded to single precision by the shading before they are followed, and so are
    /// the points from which rays leave.
    Double,
}

impl Arithmetic {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Single, Self::Double];

    /// Its name on the command line and in scene files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Single => "single",
            Self::Double => "double",
        }
    }

    /// The one of this name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|arithmetic| arithmetic.name() == name)
    }
}
