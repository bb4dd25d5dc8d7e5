//! What a voxel looks like in the light: the reflection model of Phong (1975).

use crate::camera::View;
use crate::color::Light3;
use glam::Vec3;

/// Something that shines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Light {
    /// From very far away.
    Directional {
        /// Unit vector towards the light, in unit space.
        towards: Vec3,
        /// Amount of light.
        color: Light3,
    },
    /// From a point; falls off with the square of the distance.
    Point {
        /// Position in unit space.
        position: Vec3,
        /// Amount of light at distance one.
        color: Light3,
    },
}

/// What is seen where no voxel is, from the lower to the upper edge of the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Background {
    /// At the lower edge.
    pub bottom: Light3,
    /// At the upper edge.
    pub top: Light3,
}

/// All the light of a scene, and how surfaces shine.
#[derive(Debug, Clone, PartialEq)]
pub struct Lighting {
    /// Light from everywhere.
    pub ambient: Light3,
    /// Lights with a place.
    pub lights: Vec<Light>,
    /// What is seen beyond the model.
    pub background: Background,
    /// How much light of a highlight is added to that of the colour.
    pub specular: f32,
    /// Phong's exponent: how small highlights are.
    pub shininess: u32,
}

impl Lighting {
    /// Three lamps about the camera: a warm one from the upper left, a cool one from the right, a white one from
    /// behind the model, on a bright background.
    #[must_use]
    pub(crate) fn studio(view: &View) -> Self {
        let [right, up, back] = view.axes();
        let lamp = |across: f32, above: f32, behind: f32, color: Light3| Light::Directional {
            towards: (right * across + up * above + back * behind).normalize(),
            color,
        };
        Self {
            ambient: Vec3::new(0.10, 0.11, 0.13),
            lights: vec![
                lamp(-0.55, 0.75, 0.65, Vec3::new(0.80, 0.74, 0.64)),
                lamp(0.90, 0.10, 0.55, Vec3::new(0.16, 0.21, 0.32)),
                lamp(0.15, 0.80, -0.75, Vec3::new(0.26, 0.25, 0.24)),
            ],
            background: Background { bottom: Vec3::new(0.90, 0.88, 0.85), top: Vec3::new(0.42, 0.55, 0.70) },
            specular: 0.22,
            shininess: 32,
        }
    }

    /// Light that leaves a surface towards the eye.
    ///
    /// `normal` and `to_eye` are unit vectors, `color` the share of light that the surface scatters.
    #[must_use]
    pub fn shade(&self, position: Vec3, normal: Vec3, to_eye: Vec3, color: Light3) -> Light3 {
        let normal = towards_eye(normal, to_eye);
        let mut light = self.ambient * color;
        for lamp in &self.lights {
            let (towards, amount) = lamp.at(position);
            let facing = normal.dot(towards);
            if facing <= 0.0 {
                continue;
            }
            light += amount * color * facing;
            let mirrored = normal * (2.0 * facing) - towards;
            let highlight = mirrored.dot(to_eye);
            if highlight > 0.0 {
                light += amount * (self.specular * power(highlight, self.shininess));
            }
        }
        light
    }
}

impl Light {
    /// Unit vector towards the light and how far it is away, infinitely if it has no place.
    pub(crate) fn seen_from(&self, position: Vec3) -> (Vec3, f32) {
        match *self {
            Self::Directional { towards, .. } => (towards, f32::INFINITY),
            Self::Point { position: from, .. } => (self.at(position).0, from.distance(position)),
        }
    }

    /// Unit vector towards the light, and its amount at `position`.
    fn at(&self, position: Vec3) -> (Vec3, Light3) {
        match *self {
            Self::Directional { towards, color } => (towards, color),
            Self::Point { position: from, color } => {
                let offset = from - position;
                let squared = offset.length_squared().max(f32::MIN_POSITIVE);
                (offset / squared.sqrt(), color / squared)
            }
        }
    }
}

/// The cosine beyond which a normal that faces away from the eye means the back of an open surface.
///
/// A voxel's normal is a mean over its cell and coded in 16 bits, so at a silhouette it may face away a little.
const BACK: f32 = -0.25;

/// The normal on the side of the surface that the eye sees: both sides look alike.
pub(crate) fn towards_eye(normal: Vec3, to_eye: Vec3) -> Vec3 {
    let facing = normal.dot(to_eye);
    if facing >= 0.0 {
        normal
    } else if facing < BACK {
        -normal
    } else {
        // At a silhouette: turned until it just faces the eye.
        (normal - to_eye * facing).normalize_or(to_eye)
    }
}

/// A whole power by squaring: the same bits on every machine, unlike `powf`.
fn power(base: f32, exponent: u32) -> f32 {
    let (mut result, mut square, mut rest) = (1.0, base, exponent);
    while rest > 0 {
        if rest & 1 == 1 {
            result *= square;
        }
        square *= square;
        rest >>= 1;
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lit_by(light: Light) -> Lighting {
        let background = Background { bottom: Vec3::ZERO, top: Vec3::ZERO };
        Lighting { ambient: Vec3::ZERO, lights: vec![light], background, specular: 0.5, shininess: 8 }
    }

    #[test]
    fn light_falls_off_with_the_square_of_the_distance() {
        let at = |distance: f32| {
            let light = Light::Point { position: Vec3::Z * distance, color: Vec3::ONE };
            // Seen from the side, where the highlight is not.
            lit_by(light).shade(Vec3::ZERO, Vec3::Z, Vec3::X, Vec3::ONE).x
        };
        assert_eq!(at(1.0), 1.0);
        assert_eq!(at(2.0), 0.25);
    }

    #[test]
    fn the_highlight_is_where_the_light_is_mirrored() {
        let towards = Vec3::new(1.0, 0.0, 1.0).normalize();
        let lighting = lit_by(Light::Directional { towards, color: Vec3::ONE });
        let seen_from =
            |x: f32| lighting.shade(Vec3::ZERO, Vec3::Z, Vec3::new(x, 0.0, 1.0).normalize(), Vec3::ZERO).x;
        assert!((seen_from(-1.0) - 0.5).abs() < 1e-6);
        assert!(seen_from(-1.0) > seen_from(-0.5) && seen_from(-0.5) > seen_from(0.5));
    }

    #[test]
    fn both_sides_of_a_surface_look_alike() {
        let lighting = lit_by(Light::Directional { towards: Vec3::Z, color: Vec3::ONE });
        let seen = |normal| lighting.shade(Vec3::ZERO, normal, Vec3::Z, Vec3::ONE);
        assert_eq!(seen(Vec3::Z), seen(-Vec3::Z));
    }

    #[test]
    fn powers_by_squaring() {
        assert_eq!(power(3.0, 5), 243.0);
        assert_eq!(power(7.0, 0), 1.0);
    }
}
