//! `globe`: a relief globe of an invented planet, painted with a texture, on a stand of brass and wood.
//!
//! Every part is watertight. Only the planet has texture coordinates; its colours are in `globe.png`.

mod planet;
mod stand;

use crate::color::{WHITE, hex};
use crate::detail::Detail;
use crate::material::Material;
use crate::mesh::Mesh;
use crate::placement::{shift, turn_y, turn_z};
use crate::primitives::ellipsoid;
use crate::scene::{Scene, Texture};
use crate::trigonometry::angle;
use glam::{DVec2, DVec3};
use std::collections::HashMap;

const TEXTURE: &str = "globe.png";
const TEXTURE_WIDTH: u32 = 1024;
const TEXTURE_HEIGHT: u32 = 512;
/// Inclination of the planet's axis in turns, the Earth's.
const TILT: f64 = 23.4 / 360.0;
/// Turn around the axis, to show the most varied side.
const SPIN: f64 = 0.3;
/// Height of the planet's centre above the table; its radius is 1.
const CENTER: f64 = 1.78;
/// How much the highest mountains stand out.
const RELIEF: f64 = 0.05;

/// Builds the scene.
pub fn build(detail: Detail) -> Scene {
    let mut scene = Scene::new("globe", "a globe of an invented planet on a stand, with a texture");
    let planet = Material::matte("planet", WHITE).glossy(hex(0x383838), 25.0).textured(TEXTURE);
    let planet = scene.material(planet);
    let place = shift(0.0, CENTER, 0.0) * turn_z(-TILT);
    scene.add(sphere(detail).placed(place * turn_y(SPIN)).of(planet).smooth());
    let metals = stand::Paints::new(&mut scene);
    scene.add(stand::meridian(detail, &metals).placed(place));
    scene.add(stand::foot(detail, &metals));
    let image = planet::paint(TEXTURE_WIDTH, TEXTURE_HEIGHT);
    scene.textures.push(Texture { name: TEXTURE.to_owned(), image });
    scene
}

/// The planet around the origin with its relief and texture coordinates, its north pole up.
fn sphere(detail: Detail) -> Mesh {
    let ball = ellipsoid(DVec3::ONE, detail.segments(128), detail.segments(64));
    let relief = |direction: DVec3| direction * (1.0 + RELIEF * planet::elevation(direction).max(0.0));
    with_map_coordinates(ball).displaced(relief)
}

/// Longitude and latitude as texture coordinates: u from 0 to 1 eastward, v from 0 at the south pole to 1 at the north pole.
fn map_coordinates(direction: DVec3) -> DVec2 {
    let longitude = angle(DVec2::new(direction.x, -direction.z)).rem_euclid(1.0);
    let latitude = angle(DVec2::new(DVec2::new(direction.x, direction.z).length(), direction.y));
    DVec2::new(longitude, latitude * 2.0 + 0.5)
}

/// Gives the corners of a sphere around the origin their texture coordinates. Vertices on the seam and at the poles get
/// several, one for each side they are seen from, but stay single vertices.
fn with_map_coordinates(mut mesh: Mesh) -> Mesh {
    let mut known = HashMap::new();
    for face in &mut mesh.faces {
        let positions = face.corners.iter().map(|corner| mesh.vertices[corner.vertex].position);
        let is_pole = |position: &DVec3| position.x == 0.0 && position.z == 0.0;
        let mut uvs: Vec<DVec2> = positions.clone().map(map_coordinates).collect();
        let crosses_seam = uvs.iter().any(|uv| uv.x > 0.75);
        for uv in uvs.iter_mut().filter(|uv| crosses_seam && uv.x < 0.25) {
            uv.x += 1.0;
        }
        let others: Vec<f64> = positions
            .clone()
            .zip(&uvs)
            .filter(|(position, _)| !is_pole(position))
            .map(|(_, uv)| uv.x)
            .collect();
        let middle = others.iter().sum::<f64>() / others.len() as f64;
        for (uv, _) in uvs.iter_mut().zip(positions).filter(|(_, position)| is_pole(position)) {
            uv.x = middle;
        }
        for (corner, uv) in face.corners.iter_mut().zip(uvs) {
            let key = (uv * 1e6).round().as_i64vec2();
            corner.uv = Some(*known.entry(key).or_insert_with(|| {
                mesh.uvs.push(uv);
                mesh.uvs.len() - 1
            }));
        }
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_face_stretches_across_the_map() {
        let mesh = sphere(Detail(1));
        for face in &mesh.faces {
            let uvs: Vec<DVec2> = face.corners.iter().map(|corner| mesh.uvs[corner.uv.unwrap()]).collect();
            for uv in &uvs {
                assert!((0.0..=1.0).contains(&uv.x) && (0.0..=1.0).contains(&uv.y), "{uv}");
                assert!((uv.x - uvs[0].x).abs() < 0.01 && (uv.y - uvs[0].y).abs() < 0.02, "{uvs:?}");
            }
        }
    }

    #[test]
    fn the_map_runs_eastward_and_northward() {
        assert_eq!(map_coordinates(DVec3::X), DVec2::new(0.0, 0.5));
        assert_eq!(map_coordinates(DVec3::NEG_Z), DVec2::new(0.25, 0.5));
        assert_eq!(map_coordinates(DVec3::Y).y, 1.0);
    }
}
