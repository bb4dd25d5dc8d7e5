//! The light of a scene that has none of its own.

use super::{Ambient, Background, Light};
use crate::color::Light3;
use glam::{DVec3, Vec3};

/// Light from everywhere.
pub(crate) const AMBIENT: Ambient =
    Ambient { color: Vec3::new(0.10, 0.11, 0.13), occlusion: None, glow: false };

/// The background's lower edge, which is brighter.
pub(crate) const BOTTOM: Light3 = Vec3::new(0.90, 0.88, 0.85);

/// The background's upper edge.
pub(crate) const TOP: Light3 = Vec3::new(0.42, 0.55, 0.70);

/// Bright.
pub(crate) const BACKGROUND: Background = Background::Gradient { bottom: BOTTOM, top: TOP };

/// Three lamps about a camera, given by its unit vectors to the right, up, and back: a warm one from the upper left that
/// makes shadows, a cool one from the right, a white one from behind the model.
pub(crate) fn lights([right, up, back]: [DVec3; 3]) -> [Light; 3] {
    let lamp = |across: f64, above: f64, behind: f64, color: Vec3| {
        let towards = (right * across + up * above + back * behind).normalize();
        Light::directional(towards.as_vec3(), color)
    };
    [
        Light { shadow: true, ..lamp(-0.55, 0.75, 0.65, Vec3::new(0.80, 0.74, 0.64)) },
        lamp(0.90, 0.10, 0.55, Vec3::new(0.16, 0.21, 0.32)),
        lamp(0.15, 0.80, -0.75, Vec3::new(0.26, 0.25, 0.24)),
    ]
}
