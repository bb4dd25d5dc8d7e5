//! `ball`: a sphere, to be made of glass, of silver or of light.

use crate::color::hex;
use crate::detail::Detail;
use crate::material::Material;
use crate::primitives::ellipsoid;
use crate::scene::Scene;
use glam::DVec3;

/// Builds the scene.
pub fn build(detail: Detail) -> Scene {
    let mut scene = Scene::new("ball", "a sphere");
    let plaster = scene.material(Material::matte("plaster", hex(0xd8d8d8)));
    let ball = ellipsoid(DVec3::ONE, detail.segments(72), detail.segments(36));
    scene.add(ball.smooth().of(plaster));
    scene
}
