//! Small pictures.

use octvox_raytracer::{Camera, DEFAULT_FOV, Frame, Octree, RenderOptions, render};

/// A camera that shows the whole model in a picture of this size.
#[must_use]
pub fn framing(octree: &Octree, [width, height]: [u32; 2]) -> Camera {
    Camera::framing(octree, f64::from(width) / f64::from(height), DEFAULT_FOV)
}

/// Renders the whole model.
#[must_use]
pub fn picture(octree: &Octree, options: &RenderOptions) -> Frame {
    render(octree, &framing(octree, options.size), options, |_| {}).unwrap().0
}
