//! Rays of a camera, in double precision.

use crate::camera::{Camera, CameraError, View};
use crate::lens::{Lens, Projection};
use crate::ray::Ray;
use glam::{DVec2, DVec3};

/// A camera for pictures of one size; a lens with an opening is taken as closed to a point.
pub(super) struct Eye {
    position: DVec3,
    forward: DVec3,
    /// From a pixel to the next one to the right and below: at distance one, or anywhere if rays run side by side.
    step: [DVec3; 2],
    middle: DVec2,
    is_parallel: bool,
}

impl Eye {
    /// # Errors
    /// If the camera sees nothing.
    pub fn new(camera: &Camera, lens: &Lens, [width, height]: [u32; 2]) -> Result<Self, CameraError> {
        // It is asked for what is wrong with a camera, not for rays.
        View::new(camera, [DVec3::ZERO; 2], width, height)?;
        let forward = (camera.target - camera.eye).normalize();
        let right = forward.cross(camera.up.normalize()).normalize();
        let [width, height] = [width, height].map(f64::from);
        let seen = match lens.projection {
            Projection::Perspective => 2.0 * (camera.vertical_fov.to_radians() / 2.0).tan(),
            Projection::Orthographic { height } => height,
        };
        Ok(Self {
            position: camera.eye,
            forward,
            step: [right, forward.cross(right)].map(|direction| direction * (seen / height)),
            middle: DVec2::new(width, height) / 2.0,
            is_parallel: lens.projection != Projection::Perspective,
        })
    }

    /// The ray through a point of the picture, in pixels from its upper left corner; its direction is a unit vector.
    pub fn ray(&self, [x, y]: [f64; 2]) -> Ray {
        let [right, down] = self.step;
        let across = right * (x - self.middle.x) + down * (y - self.middle.y);
        if self.is_parallel {
            Ray { origin: self.position + across, direction: self.forward }
        } else {
            Ray { origin: self.position, direction: (self.forward + across).normalize() }
        }
    }
}
