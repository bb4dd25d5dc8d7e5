//! Small scenes under known light, and the light of their pictures.

use crate::tree::Tree;
use glam::{DVec3, Vec3};
use octvox_format::{SphericalNormal, Voxel};
use octvox_raytracer::scene::{Ambient, Background, Instance, Model, Scene, Similarity, SurfaceMaterial};
use octvox_raytracer::{
    Camera, Frame, Lens, Light3, Octree, Projection, Quality, Ray, RenderOptions, RenderReport, render_scene,
};

/// Every approximation in its exact setting, but for the number of rays: voxels are the finest ones, and no ray is left out
/// because it changes little.
#[must_use]
pub fn exact() -> Quality {
    Quality { lod_pixels: 0.0, cutoff: 0.0, ..Quality::of_samples(1) }
}

/// An octree of `1 << depth` cells per axis, each empty or with a palette index and a normal.
///
/// The normals of all axes but −z are kept without rounding.
#[must_use]
pub fn voxels(depth: u8, of_cell: impl Fn([u32; 3]) -> Option<(u16, DVec3)>) -> Octree {
    let side = 1u32 << depth;
    let cells = (0..side.pow(3)).map(|code| [code % side, code / side % side, code / side / side]);
    let filled: Vec<_> = cells
        .filter_map(|cell| {
            let (palette_index, normal) = of_cell(cell)?;
            let normal = SphericalNormal::encode(normal.as_vec3().to_array());
            Some((cell, Voxel { palette_index, normal }))
        })
        .collect();
    Tree::of_cells(depth, &filled).octree()
}

/// The lowest layer of cells.
#[must_use]
pub fn floor(depth: u8) -> Octree {
    voxels(depth, |[_, y, _]| (y == 0).then_some((1, DVec3::Y)))
}

/// A model alone in the dark: no lamps, no light from around, nothing behind. Palette index `k + 1` is `surfaces[k]`.
#[must_use]
pub fn alone<'a>(octree: &'a Octree, surfaces: &[SurfaceMaterial]) -> Scene<'a> {
    Scene {
        models: vec![Model { octree, surfaces: surfaces.to_vec() }],
        instances: vec![Instance { model: 0, placement: Similarity::IDENTITY }],
        ground: None,
        lights: Vec::new(),
        ambient: Ambient { color: Vec3::ZERO, occlusion: None, glow: false },
        background: Background::uniform(Vec3::ZERO),
    }
}

/// A surface that gives off light and scatters none.
#[must_use]
pub fn glowing(amount: f32) -> SurfaceMaterial {
    SurfaceMaterial { emission: Vec3::splat(amount), ..SurfaceMaterial::matte(Vec3::ZERO) }
}

/// A surface that scatters all of what it does not mirror.
#[must_use]
pub fn mirror(reflectivity: f32) -> SurfaceMaterial {
    SurfaceMaterial { reflectivity: Vec3::splat(reflectivity), ..SurfaceMaterial::matte(Vec3::ONE) }
}

/// A surface that lets light pass or mirrors it, and scatters none.
#[must_use]
pub fn glass(refraction_index: f32) -> SurfaceMaterial {
    SurfaceMaterial { transparency: 1.0, refraction_index, ..SurfaceMaterial::matte(Vec3::ZERO) }
}

/// Looks straight down on the cube, of which the picture shows the square [0, 1]² of x (to the right) and z (downwards).
#[must_use]
pub fn from_above() -> (Camera, Lens) {
    let eye = DVec3::new(0.5, 1.5, 0.5);
    let camera = Camera { eye, target: eye - DVec3::Y, up: -DVec3::Z, vertical_fov: 40.0 };
    (camera, Lens { projection: Projection::Orthographic { height: 1.0 }, ..Lens::default() })
}

/// Renders a scene.
///
/// # Panics
/// If the camera sees nothing.
#[must_use]
pub fn render_with(
    scene: &Scene<'_>,
    (camera, lens): &(Camera, Lens),
    options: &RenderOptions,
) -> (Frame, RenderReport) {
    render_scene(scene, camera, lens, options, |_| {}).unwrap()
}

/// The light of each pixel, row by row.
#[must_use]
pub fn light(scene: &Scene<'_>, view: &(Camera, Lens), size: [u32; 2], quality: Quality) -> Vec<Light3> {
    let options = RenderOptions { size, quality, ..RenderOptions::default() };
    render_with(scene, view, &options).0.light.unwrap()
}

/// The ray of a pinhole camera through the middle of a pixel, with a unit vector as direction.
#[must_use]
pub fn pixel_ray(camera: &Camera, [width, height]: [u32; 2], [x, y]: [u32; 2]) -> Ray {
    let forward = (camera.target - camera.eye).normalize();
    let right = forward.cross(camera.up).normalize();
    let up = right.cross(forward);
    let pixel = 2.0 * (camera.vertical_fov.to_radians() / 2.0).tan() / f64::from(height);
    let across = (f64::from(x) + 0.5 - f64::from(width) / 2.0) * pixel;
    let down = (f64::from(y) + 0.5 - f64::from(height) / 2.0) * pixel;
    Ray { origin: camera.eye, direction: (forward + right * across - up * down).normalize() }
}
