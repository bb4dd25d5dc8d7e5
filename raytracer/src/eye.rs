//! Rays from the eye in the scene, one by one, for any lens.

use crate::camera::{Camera, CameraError, View};
use crate::lens::{Lens, Projection};
use crate::octree::Octree;
use crate::scene::{Similarity, on_disk};
use crate::world::SceneRay;
use glam::{DVec3, Vec2};

/// A camera and its lens, made ready for pictures of one size.
pub(crate) struct Eye {
    view: View,
    lens: Lens,
    focus: f64,
    /// From a pixel to the next one to the right and below, in the scene, if rays run side by side.
    step: Option<[DVec3; 2]>,
    half_size: [f64; 2],
}

impl Eye {
    /// # Errors
    /// If the camera sees nothing.
    pub fn new(camera: &Camera, lens: &Lens, [width, height]: [u32; 2]) -> Result<Self, CameraError> {
        // What the box holds does not matter here.
        let view = View::new(camera, [DVec3::ZERO; 2], width, height)?;
        let [right, up, _] = view.axes();
        let step = match lens.projection {
            Projection::Perspective => None,
            Projection::Orthographic { height: seen } => {
                let pixel = seen / f64::from(height);
                Some([right * pixel, up * -pixel])
            }
        };
        Ok(Self {
            view,
            lens: *lens,
            focus: lens.focus.unwrap_or_else(|| camera.eye.distance(camera.target)),
            step,
            half_size: [f64::from(width) / 2.0, f64::from(height) / 2.0],
        })
    }

    /// The size of a pixel at a distance, in the scene.
    pub fn pixel_at(&self, distance: f64) -> f64 {
        match self.step {
            None => self.view.pixel_size() * distance,
            Some([right, _]) => right.length(),
        }
    }

    /// Where it is in the scene.
    pub fn position(&self) -> DVec3 {
        self.view.eye()
    }

    /// The ray through a point of the picture. `chosen`, in [0, 1)², tells through which point of the lens.
    pub fn ray(&self, [x, y]: [f32; 2], chosen: Vec2) -> SceneRay {
        let [x, y] = [f64::from(x), f64::from(y)];
        let (mut origin, mut direction) = match self.step {
            None => (self.view.eye(), self.view.direction(x, y)),
            Some([right, down]) => {
                let across = right * (x - self.half_size[0]) + down * (y - self.half_size[1]);
                (self.view.eye() + across, self.view.forward())
            }
        };
        if self.lens.aperture > 0.0 {
            let sharp = origin + direction * self.focus;
            let [right, up, _] = self.view.axes();
            let place = on_disk(chosen).as_dvec2() * self.lens.aperture;
            origin += right * place.x + up * place.y;
            direction = sharp - origin;
        }
        SceneRay { origin, direction: direction.normalize().as_vec3(), end: f32::INFINITY, leaving: None }
    }

    /// A pinhole camera that sees an octree as this one sees it placed in the scene, in its unit space: the same one, if
    /// this is a pinhole camera itself, or one to which its cells look as large.
    pub fn view_of(&self, octree: &Octree, placement: &Similarity) -> View {
        // From very far away, cells at any distance look alike.
        const FAR: f64 = 4096.0;
        let view = self.view.placed(placement, octree.unit_bounds().map(DVec3::from_array));
        match self.step {
            None => view,
            Some([right, _]) => {
                let eye = DVec3::splat(0.5) - view.forward() * FAR;
                view.moved(eye, right.length() / placement.scale / FAR)
            }
        }
    }
}
