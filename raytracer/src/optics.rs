//! What light does at a surface: how much is mirrored, and where to.

use crate::color::Light3;
use glam::Vec3;

/// The direction into which a ray is mirrored. `normal` is a unit vector.
pub(crate) fn mirrored(direction: Vec3, normal: Vec3) -> Vec3 {
    (direction - normal * (2.0 * direction.dot(normal))).normalize_or(normal)
}

/// The direction into which a ray is bent (Snell's law), where `ratio` is the index of refraction it comes from over that
/// it goes into; nothing if all is mirrored. `normal` is a unit vector against which the ray runs.
pub(crate) fn refracted(direction: Vec3, normal: Vec3, ratio: f32) -> Option<Vec3> {
    if ratio == 1.0 {
        return Some(direction);
    }
    let cosine = -direction.dot(normal);
    let squared = 1.0 - ratio * ratio * (1.0 - cosine * cosine);
    (squared > 0.0)
        .then(|| (direction * ratio + normal * (ratio * cosine - squared.sqrt())).normalize_or(direction))
}

/// The share of light that a smooth surface between two transparent materials mirrors, for light that is not polarised
/// (Fresnel). `cosine` is that of the angle between ray and normal, `ratio` as of [`refracted`].
pub(crate) fn fresnel(cosine: f32, ratio: f32) -> f32 {
    if ratio == 1.0 {
        return 0.0;
    }
    let cosine = cosine.clamp(0.0, 1.0);
    let squared = 1.0 - ratio * ratio * (1.0 - cosine * cosine);
    if squared <= 0.0 {
        return 1.0;
    }
    let inside = squared.sqrt();
    let parallel = (cosine - ratio * inside) / (cosine + ratio * inside);
    let across = (ratio * cosine - inside) / (ratio * cosine + inside);
    (parallel * parallel + across * across) / 2.0
}

/// The share of light that an opaque surface mirrors, of which `straight` is that at a right angle (Schlick, "An
/// inexpensive BRDF model for physically-based rendering", 1994). What mirrors nothing mirrors nothing from the side either.
pub(crate) fn schlick(cosine: f32, straight: Light3) -> Light3 {
    if straight == Vec3::ZERO {
        return Vec3::ZERO;
    }
    let rest = 1.0 - cosine.clamp(0.0, 1.0);
    let squared = rest * rest;
    straight + (Vec3::ONE - straight) * (squared * squared * rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Known values: glass mirrors 4 % of what comes straight at it, nothing of one polarisation at Brewster's angle.
    #[test]
    fn glass_mirrors_what_it_should() {
        assert!((fresnel(1.0, 1.0 / 1.5) - 0.04).abs() < 1e-6);
        assert!((fresnel(1.0, 1.5) - 0.04).abs() < 1e-6);
        assert_eq!(fresnel(0.0, 1.0 / 1.5), 1.0);
        let brewster = 1.5f32.atan();
        let across = (brewster.cos() - 1.5 * (1.0 - (brewster.sin() / 1.5).powi(2)).sqrt())
            / (brewster.cos() + 1.5 * (1.0 - (brewster.sin() / 1.5).powi(2)).sqrt());
        assert!((fresnel(brewster.cos(), 1.0 / 1.5) - across * across / 2.0).abs() < 1e-6);
        // Beyond the critical angle, from inside, all of it.
        let critical = (1.0 / 1.5f32).asin();
        assert_eq!(fresnel((critical + 0.01).cos(), 1.5), 1.0);
        assert!(fresnel((critical - 0.01).cos(), 1.5) < 1.0);
    }

    #[test]
    fn light_is_bent_by_the_ratio_of_the_sines() {
        for degrees in [0.0f32, 10.0, 40.0, 80.0] {
            let angle = degrees.to_radians();
            let direction = Vec3::new(angle.sin(), -angle.cos(), 0.0);
            let inside = refracted(direction, Vec3::Y, 1.0 / 1.5).unwrap();
            assert!((inside.x * 1.5 - angle.sin()).abs() < 1e-6);
            let back = refracted(inside, Vec3::Y, 1.5).unwrap();
            assert!((back - direction).length() < 1e-5, "{degrees}°");
        }
        assert_eq!(refracted(Vec3::new(0.8, -0.6, 0.0), Vec3::Y, 1.5), None);
        assert!((mirrored(Vec3::new(0.6, -0.8, 0.0), Vec3::Y) - Vec3::new(0.6, 0.8, 0.0)).length() < 1e-6);
    }
}
