//! The two views of the comparison, as rays for Embree and as a camera of octvox.

use crate::embree::{LANES, Packet, Scene};
use glam::{DVec3, Vec3};
use octvox_raytracer::{Camera, DEFAULT_FOV};

/// Columns and rows of the picture: both multiples of a packet's sides.
pub const SIZE: [u32; 2] = [1312, 640];

/// Pixels along each side of a packet.
const SIDE: u32 = 4;

/// Where the eye is.
pub struct View {
    pub name: &'static str,
    pub camera: Camera,
}

/// The views of `voxtrace bench`: the whole model, and from close by.
pub fn views() -> [View; 2] {
    let looking = |name, eye: [f64; 3]| View {
        name,
        camera: Camera {
            eye: DVec3::from_array(eye),
            target: DVec3::splat(0.5),
            up: DVec3::Y,
            vertical_fov: DEFAULT_FOV,
        },
    };
    [looking("outside", [0.5, 0.5, 1.9]), looking("close", [0.8, 0.7, 1.1])]
}

/// What Embree finds for each pixel: the distance from the eye in unit space, infinite where nothing is hit.
pub struct Picture {
    pub distance: Vec<f32>,
}

impl Picture {
    pub fn new() -> Self {
        Self { distance: vec![0.0; (SIZE[0] * SIZE[1]) as usize] }
    }

    /// Traces all pixels, packet by packet, on this thread.
    pub fn trace(&mut self, scene: &Scene, camera: &Camera) {
        let forward = (camera.target - camera.eye).normalize();
        let right = forward.cross(camera.up).normalize();
        let up = right.cross(forward);
        let [width, height] = SIZE;
        let pixel = 2.0 * (camera.vertical_fov.to_radians() / 2.0).tan() / f64::from(height);
        let [eye, forward, right, up] =
            [camera.eye, forward, right * pixel, up * pixel].map(|vector| vector.as_vec3());
        let half = [width, height].map(|pixels| pixels as f32 / 2.0 - 0.5);
        for top in (0..height).step_by(SIDE as usize) {
            for left in (0..width).step_by(SIDE as usize) {
                let pixel = |lane: usize| [left + lane as u32 % SIDE, top + lane as u32 / SIDE];
                let mut direction = [[0.0; LANES]; 3];
                let mut length = [0.0; LANES];
                for lane in 0..LANES {
                    let [x, y] = pixel(lane);
                    let towards: Vec3 = forward + right * (x as f32 - half[0]) - up * (y as f32 - half[1]);
                    length[lane] = towards.length();
                    for axis in 0..3 {
                        direction[axis][lane] = towards[axis];
                    }
                }
                let mut packet = Packet::new(eye.to_array(), direction);
                scene.intersect(&mut packet);
                for lane in 0..LANES {
                    let [x, y] = pixel(lane);
                    let distance =
                        if packet.is_hit(lane) { packet.far[lane] * length[lane] } else { f32::INFINITY };
                    self.distance[(y * width + x) as usize] = distance;
                }
            }
        }
    }
}
