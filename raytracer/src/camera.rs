//! The eye: from pixels to directions.

use crate::lanes::{Lanes, MAX_LANES, Real};
use crate::octree::Octree;
use crate::ray::Placement;
use crate::ray::{Packet, Ray, is_near};
use crate::scene::Similarity;
use crate::tile::block_shape;
use glam::{DVec2, DVec3};

/// Where the eye is and what it sees, in unit space, in which the octree's cube is [0, 1]³.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Position of the eye.
    pub eye: DVec3,
    /// The point in the middle of the picture.
    pub target: DVec3,
    /// A direction that is upwards in the picture.
    pub up: DVec3,
    /// Angle between the lower and the upper edge of the picture, in degrees.
    pub vertical_fov: f64,
}

/// Why a camera sees nothing.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CameraError {
    /// Eye and target are one point, or a coordinate is not finite.
    #[error("the camera at {eye} cannot look at {target}; give two different points with finite coordinates")]
    NoDirection {
        /// Position of the eye.
        eye: DVec3,
        /// The point it should look at.
        target: DVec3,
    },
    /// The up direction is zero, not finite, or along the line of sight.
    #[error("the up direction {up} is along the line of sight or zero; give another, such as 0,1,0")]
    NoUp {
        /// The direction given.
        up: DVec3,
    },
    /// The angle is not one that a plane picture can have.
    #[error("a vertical field of view of {degrees} degrees is not between 0.001 and 179")]
    FieldOfView {
        /// The angle given.
        degrees: f64,
    },
}

/// The default vertical field of view, in degrees: twice the arctangent of 0.4.
pub const DEFAULT_FOV: f64 = 43.6028;

impl Camera {
    /// Unit vectors to the right and up in the picture, and from it towards the eye; nothing if the camera sees nothing.
    pub(crate) fn axes(&self) -> Option<[DVec3; 3]> {
        View::new(self, [DVec3::ZERO; 2], 1, 1).ok().map(|view| view.axes())
    }

    /// The size at distance one, along the direction of the middle of the picture, of a pixel of a picture with so many rows.
    #[must_use]
    pub fn pixel_at_one(&self, height: u32) -> f64 {
        2.0 * (self.vertical_fov.to_radians() / 2.0).tan() / f64::from(height)
    }

    /// A camera that shows the whole model from its front, a little from the right and from above.
    ///
    /// `aspect` is width over height of the picture, `vertical_fov` in degrees.
    #[must_use]
    pub fn framing(octree: &Octree, aspect: f64, vertical_fov: f64) -> Self {
        let [low, high] = octree.unit_bounds().map(DVec3::from_array);
        framing_points(&octree.outline(), (low + high) / 2.0, 1.0, aspect, vertical_fov)
    }
}

/// A camera that shows all points from the front, a little from the right and from above.
///
/// `middle` is about their middle and `size` about how far they reach; `aspect` is width over height of the picture,
/// `vertical_fov` in degrees.
pub(crate) fn framing_points(
    points: &[DVec3],
    middle: DVec3,
    size: f64,
    aspect: f64,
    vertical_fov: f64,
) -> Camera {
    /// Their share of the picture's width or height, whichever they fill.
    const FILLED: f64 = 0.9;
    let back = DVec3::new(0.45, 0.35, 1.0).normalize();
    let right = DVec3::Y.cross(back).normalize();
    let up = back.cross(right);
    let tangent = (vertical_fov.clamp(0.001, 179.0).to_radians() / 2.0).tan() * FILLED;
    let mut target = middle;
    let mut distance = size;
    // Each round moves the camera back until all is in the picture, then sideways until it is in the middle; what
    // is nearer moves more, so it takes a few.
    for _ in 0..4 {
        let seen = |point: &DVec3| {
            let offset = *point - target;
            DVec3::new(offset.dot(right), offset.dot(up), offset.dot(back))
        };
        distance = points.iter().map(seen).fold(1e-3 * size, |distance: f64, seen| {
            let across = (seen.x.abs() / aspect).max(seen.y.abs());
            distance.max(seen.z + across / tangent)
        });
        let on_picture = |seen: DVec3| DVec2::new(seen.x, seen.y) / (distance - seen.z).max(1e-6 * size);
        let (least, most) = points
            .iter()
            .map(|point| on_picture(seen(point)))
            .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(least, most), at| (least.min(at), most.max(at)));
        let shift = (least + most) / 2.0 * distance;
        if shift.is_finite() {
            target += right * shift.x + up * shift.y;
        }
    }
    Camera { eye: target + back * distance, target, up: DVec3::Y, vertical_fov }
}

/// A camera made ready for pictures of one size.
#[derive(Debug, Clone, Copy)]
pub(crate) struct View {
    eye: DVec3,
    /// Direction of the middle of the picture, a unit vector; distances along rays are in its direction.
    forward: DVec3,
    /// From a pixel to the next one on the right.
    right: DVec3,
    /// From a pixel to the next one below.
    down: DVec3,
    /// From the centre to the corner of the picture, in pixels.
    half_size: [f32; 2],
    /// The box around the filled cells, low corner and high corner.
    bounds: [DVec3; 2],
}

/// Where the lanes of a packet are in the picture: pixels `x + offset_x[lane]`, `y + offset_y[lane]`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PixelBlock<L: Lanes> {
    /// Column and row of the first lane's pixel.
    pub corner: [u32; 2],
    /// Sampled places, in pixels from the left.
    pub x: L::Float,
    /// Sampled places, in pixels from the top.
    pub y: L::Float,
    /// Lanes within the picture.
    pub active: L::Mask,
}

impl<L: Lanes> PixelBlock<L> {
    /// Column and row of a lane's pixel.
    #[inline(always)]
    pub fn pixel(&self, lane: usize) -> [u32; 2] {
        let (columns, _) = block_shape(L::COUNT);
        [self.corner[0] + lane as u32 % columns, self.corner[1] + lane as u32 / columns]
    }
}

impl View {
    /// A camera for pictures of a size, of what is in a box, given by its low and its high corner.
    ///
    /// # Errors
    /// If the camera sees nothing.
    pub fn new(camera: &Camera, bounds: [DVec3; 2], width: u32, height: u32) -> Result<Self, CameraError> {
        let Camera { eye, target, up, vertical_fov } = *camera;
        let direction = target - eye;
        let forward = direction.try_normalize().filter(|_| eye.is_finite() && target.is_finite());
        let forward = forward.ok_or(CameraError::NoDirection { eye, target })?;
        let right = up.try_normalize().map(|up| forward.cross(up)).filter(|right| right.length() > 1e-9);
        let right = right.ok_or(CameraError::NoUp { up })?.normalize();
        if !(0.001..=179.0).contains(&vertical_fov) {
            return Err(CameraError::FieldOfView { degrees: vertical_fov });
        }
        let pixel = camera.pixel_at_one(height);
        Ok(Self {
            eye,
            forward,
            right: right * pixel,
            down: -right.cross(forward) * pixel,
            half_size: [width as f32 / 2.0, height as f32 / 2.0],
            bounds,
        })
    }

    /// A camera for pictures of an octree alone, in its unit space.
    ///
    /// # Errors
    /// If the camera sees nothing.
    pub fn of_octree(
        camera: &Camera,
        octree: &Octree,
        [width, height]: [u32; 2],
    ) -> Result<Self, CameraError> {
        Self::new(camera, octree.unit_bounds().map(DVec3::from_array), width, height)
    }

    /// The same camera in the unit space of an instance, of what is in a box there.
    pub fn placed(&self, placement: &Similarity, bounds: [DVec3; 2]) -> Self {
        Self {
            eye: placement.to_unit(self.eye),
            forward: placement.direction_to_unit(self.forward),
            right: placement.direction_to_unit(self.right),
            down: placement.direction_to_unit(self.down),
            bounds,
            ..*self
        }
    }

    /// The same camera at another place, with another size of pixels at distance one.
    pub fn moved(&self, eye: DVec3, pixel: f64) -> Self {
        let factor = pixel / self.pixel_size();
        Self { eye, right: self.right * factor, down: self.down * factor, ..*self }
    }

    /// The size of a pixel at distance one.
    pub fn pixel_size(&self) -> f64 {
        self.right.length()
    }

    /// Direction of the middle of the picture, a unit vector; distances along rays are measured along it.
    pub fn forward(&self) -> DVec3 {
        self.forward
    }

    /// Whether the eye is near enough to the cube for single precision, and so for beams.
    pub fn is_near(&self) -> bool {
        is_near::<f32>(self.eye)
    }

    /// Unit vectors to the right and up in the picture, and from it towards the eye.
    pub fn axes(&self) -> [DVec3; 3] {
        [self.right.normalize(), -self.down.normalize(), -self.forward]
    }

    /// Position of the eye in unit space.
    pub fn eye(&self) -> DVec3 {
        self.eye
    }

    /// The distance of the nearest point of the box around the filled cells along the direction of the middle of
    /// the picture, not below zero.
    pub fn nearest(&self) -> f64 {
        let corner = DVec3::select(self.forward.cmpgt(DVec3::ZERO), self.bounds[0], self.bounds[1]);
        (corner - self.eye).dot(self.forward).max(0.0)
    }

    /// The rays through a block of pixels; and, if the eye is far from the cube, how to read their distances.
    #[inline(always)]
    pub fn packet<L: Lanes>(&self, block: &PixelBlock<L>) -> (Packet<L>, Option<[Placement; MAX_LANES]>) {
        if is_near::<L::Real>(self.eye) {
            (self.near_packet(block), None)
        } else {
            self.packet_from_afar(block)
        }
    }

    /// As [`View::packet`], if the eye is near the cube: see [`is_near`].
    #[inline(always)]
    pub fn near_packet<L: Lanes>(&self, block: &PixelBlock<L>) -> Packet<L> {
        Packet::from_origin(self.eye, self.directions(block), block.active)
    }

    /// As [`View::packet`], each ray brought near the cube in double precision.
    #[cold]
    fn packet_from_afar<L: Lanes>(
        &self,
        block: &PixelBlock<L>,
    ) -> (Packet<L>, Option<[Placement; MAX_LANES]>) {
        let (x, y) = (L::reals(block.x), L::reals(block.y));
        let rays: [Ray; MAX_LANES] = std::array::from_fn(|lane| Ray {
            origin: self.eye,
            direction: self.direction(x[lane].into(), y[lane].into()),
        });
        let (mut packet, placements) = Packet::from_rays(rays);
        packet.active = packet.active & block.active;
        (packet, Some(placements))
    }

    /// The direction through each pixel, of component 1 along the direction of the middle of the picture.
    #[inline(always)]
    pub fn directions<L: Lanes>(&self, block: &PixelBlock<L>) -> [L::Float; 3] {
        let x = block.x - L::float(self.half_size[0]);
        let y = block.y - L::float(self.half_size[1]);
        let along = |axis: usize| {
            let component = |vector: &DVec3| L::real(L::Real::rounded(vector[axis]));
            component(&self.forward) + (x * component(&self.right) + y * component(&self.down))
        };
        [along(0), along(1), along(2)]
    }

    /// Normals of the planes through the eye and a column of the picture, and a row, which point to the right and down;
    /// no shorter than 1. Columns and rows count from the upper left corner.
    ///
    /// A direction is `forward + x · right + y · down`, so the normal of a column is linear in x, that of a row in y.
    pub fn column_and_row_normals(&self, [column, row]: [f64; 2]) -> [DVec3; 2] {
        let [x, y] = [column - f64::from(self.half_size[0]), row - f64::from(self.half_size[1])];
        let pixel = self.pixel_size();
        let (right, down) = (self.right / pixel, self.down / pixel);
        [right - self.forward * (x * pixel), down - self.forward * (y * pixel)]
    }

    /// The direction through a point of the picture, in double precision.
    pub fn direction(&self, x: f64, y: f64) -> DVec3 {
        let across = self.right * (x - f64::from(self.half_size[0]));
        let down = self.down * (y - f64::from(self.half_size[1]));
        self.forward + across + down
    }
}
