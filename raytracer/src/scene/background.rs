//! What is seen where nothing is.

use crate::color::Light3;
use glam::Vec3;

/// What is seen beyond all models.
#[derive(Debug, Clone, PartialEq)]
pub enum Background {
    /// From the lower to the upper edge of the picture; in mirrors and through glass from straight below to straight above.
    Gradient {
        /// At the lower edge.
        bottom: Light3,
        /// At the upper edge.
        top: Light3,
    },
    /// A picture of all directions.
    Surroundings(Surroundings),
}

/// A picture of all directions: longitude from left to right, with +z in the middle of its left and right edge and −z in
/// its middle; latitude from straight above to straight below.
#[derive(Debug, Clone, PartialEq)]
pub struct Surroundings {
    width: usize,
    height: usize,
    pixels: Vec<Light3>,
}

impl Background {
    /// The same everywhere.
    #[must_use]
    pub fn uniform(color: Light3) -> Self {
        Self::Gradient { bottom: color, top: color }
    }

    /// Whether the eye sees the same in all directions at one height of the picture.
    pub(crate) fn is_gradient(&self) -> bool {
        matches!(self, Self::Gradient { .. })
    }

    /// What is seen in a direction, a unit vector.
    pub(crate) fn towards(&self, direction: Vec3) -> Light3 {
        match self {
            Self::Gradient { bottom, top } => bottom.lerp(*top, (direction.y / 2.0 + 0.5).clamp(0.0, 1.0)),
            Self::Surroundings(picture) => picture.towards(direction),
        }
    }

    /// What the eye sees in a direction, a unit vector, at a share of the picture's height from its top.
    #[inline(always)]
    pub(crate) fn at(&self, share: f32, direction: Vec3) -> Light3 {
        match self {
            Self::Gradient { bottom, top } => top.lerp(*bottom, share.clamp(0.0, 1.0)),
            Self::Surroundings(picture) => picture.towards(direction),
        }
    }
}

impl Surroundings {
    /// A picture of amounts of light, row by row from the top. `None` unless there are `width` times `height` of them, at
    /// least one.
    #[must_use]
    pub fn new(width: usize, height: usize, pixels: Vec<Light3>) -> Option<Self> {
        (!pixels.is_empty() && width.checked_mul(height) == Some(pixels.len())).then_some(Self {
            width,
            height,
            pixels,
        })
    }

    fn towards(&self, direction: Vec3) -> Light3 {
        use std::f32::consts::{PI, TAU};
        let longitude = libm::atan2f(direction.x, -direction.z) / TAU + 0.5;
        let latitude = libm::acosf(direction.y.clamp(-1.0, 1.0)) / PI;
        let x = longitude * self.width as f32 - 0.5;
        let y = (latitude * self.height as f32 - 0.5).clamp(0.0, (self.height - 1) as f32);
        let (left, above) = (x.floor(), y.floor());
        let column = |offset: usize| (left as isize).rem_euclid(self.width as isize) as usize + offset;
        let row = |offset: usize| (above as usize + offset).min(self.height - 1);
        let at = |dx: usize, dy: usize| self.pixels[row(dy) * self.width + column(dx) % self.width];
        let across = |dy: usize| at(0, dy).lerp(at(1, dy), x - left);
        across(0).lerp(across(1), y - above)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_find_their_place_in_the_picture() {
        // Four columns: behind, left, in front, right; two rows: above and below.
        let pixels = (0..8).map(|number| Vec3::splat(number as f32)).collect();
        let picture = Surroundings::new(4, 2, pixels).unwrap();
        let at = |x: f32, y: f32, z: f32| picture.towards(Vec3::new(x, y, z).normalize()).x;
        // Straight up the first row counts alone; the middle of a column is at 45° between two axes.
        assert!((at(-1.0, 1e3, 1.0) - 0.0).abs() < 1e-3);
        assert!((at(-1.0, 1e3, -1.0) - 1.0).abs() < 1e-3);
        assert!((at(1.0, 1e3, -1.0) - 2.0).abs() < 1e-3);
        assert!((at(1.0, -1e3, 1.0) - 7.0).abs() < 1e-3);
        assert!((at(0.0, 1e3, -1.0) - 1.5).abs() < 1e-3);
        assert_eq!(Surroundings::new(3, 2, vec![Vec3::ZERO; 5]), None);
        assert_eq!(Surroundings::new(0, 0, Vec::new()), None);
    }
}
