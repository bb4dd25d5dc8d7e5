//! How a camera forms its picture.

/// How rays leave a camera; by default from one point, as through a pinhole.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lens {
    /// Where rays come from.
    pub projection: Projection,
    /// Radius of the opening through which light comes in, in the scene; 0 if all is sharp.
    pub aperture: f64,
    /// Distance at which things are sharp, measured along the direction of the middle of the picture, above zero;
    /// without one, that of the target.
    pub focus: Option<f64>,
}

/// Where the rays of a picture come from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Projection {
    /// From the eye: what is farther away looks smaller. The camera's field of view is its angle.
    Perspective,
    /// Side by side: what is farther away looks the same. The camera's field of view does not count.
    Orthographic {
        /// From the lower to the upper edge of the picture, in the scene.
        height: f64,
    },
}

impl Default for Lens {
    fn default() -> Self {
        Self { projection: Projection::Perspective, aperture: 0.0, focus: None }
    }
}

impl Lens {
    /// Whether all rays come from the eye itself.
    #[must_use]
    pub fn is_pinhole(&self) -> bool {
        self.projection == Projection::Perspective && self.aperture == 0.0
    }
}
