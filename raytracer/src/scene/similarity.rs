//! Placing, turning and scaling a model.

use glam::{DQuat, DVec3, Vec3};

/// Leads from unit space, in which a model's cube is [0, 1]³, to the scene: `x ↦ scale · rotation · x + translation`.
///
/// Lengths grow alike in all directions, so angles, normals and the shape of cells stay what they are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Similarity {
    /// Length of the cube's edge in the scene, above zero.
    pub scale: f64,
    /// A unit quaternion.
    pub rotation: DQuat,
    /// Where the cube's corner (0, 0, 0) is in the scene.
    pub translation: DVec3,
}

impl Default for Similarity {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl Similarity {
    /// The scene's space is unit space.
    pub const IDENTITY: Self = Self { scale: 1.0, rotation: DQuat::IDENTITY, translation: DVec3::ZERO };

    /// A point of unit space in the scene.
    #[must_use]
    pub fn to_scene(&self, point: DVec3) -> DVec3 {
        self.rotation * (point * self.scale) + self.translation
    }

    /// A point of the scene in unit space.
    #[must_use]
    pub fn to_unit(&self, point: DVec3) -> DVec3 {
        self.direction_to_unit(point - self.translation) / self.scale
    }

    /// A direction in the scene, turned as the model's; its length stays.
    #[must_use]
    pub fn direction_to_unit(&self, direction: DVec3) -> DVec3 {
        if self.rotation == DQuat::IDENTITY { direction } else { self.rotation.conjugate() * direction }
    }

    /// A direction of the model, turned as in the scene; its length stays.
    #[must_use]
    pub fn direction_to_scene(&self, direction: Vec3) -> Vec3 {
        if self.rotation == DQuat::IDENTITY {
            direction
        } else {
            (self.rotation * direction.as_dvec3()).as_vec3()
        }
    }

    /// Whether all numbers are finite, the scale is above zero and the rotation is one.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.scale.is_finite()
            && self.scale > 0.0
            && self.rotation.is_normalized()
            && self.translation.is_finite()
    }

    /// The box in the scene around a box in unit space, low corner and high corner.
    #[must_use]
    pub fn box_around(&self, [low, high]: [DVec3; 2]) -> [DVec3; 2] {
        let corners = (0..8).map(|corner| {
            let upper = glam::BVec3::new(corner & 1 != 0, corner & 2 != 0, corner & 4 != 0);
            self.to_scene(DVec3::select(upper, high, low))
        });
        corners.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], corner| {
            [low.min(corner), high.max(corner)]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn to_the_scene_and_back() {
        let place = Similarity {
            scale: 2.5,
            rotation: DQuat::from_rotation_y(0.7) * DQuat::from_rotation_x(-0.2),
            translation: DVec3::new(3.0, -1.0, 10.0),
        };
        let point = DVec3::new(0.2, 0.9, 0.4);
        assert!((place.to_unit(place.to_scene(point)) - point).length() < 1e-14);
        let quarter = Similarity { rotation: DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2), ..place };
        assert!((quarter.to_scene(DVec3::X) - DVec3::new(3.0, 1.5, 10.0)).length() < 1e-14);
        assert!((quarter.direction_to_scene(Vec3::X) - Vec3::Y).length() < 1e-6);
        let [low, high] = quarter.box_around([DVec3::ZERO, DVec3::ONE]);
        assert!((low - DVec3::new(0.5, -1.0, 10.0)).length() < 1e-12);
        assert!((high - DVec3::new(3.0, 1.5, 12.5)).length() < 1e-12);
    }
}
