//! What a mesh looks like at a point of its surface, for others than the converter itself.

use crate::placement;
use crate::surface::{Surface, value_to_light};
use crate::texture::{Coordinates, TexturePoint};
use crate::{ConvertError, Mesh, Options};

/// The surface of a mesh as scan conversion samples it, but at any point, and with textures as sharp as their images.
pub struct MeshLook<'a> {
    surface: Surface<'a>,
    has_cut_outs: bool,
}

/// What a mesh looks like at a point of its surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Look {
    /// Unit normal: that of the file, or smooth where it has none, tilted by a normal map. It may be on either side.
    pub normal: [f64; 3],
    /// Diffuse colour as an amount of light, 0 to 1 for red, green, blue: of material, corners and texture together.
    pub diffuse: [f64; 3],
}

impl<'a> MeshLook<'a> {
    /// Makes normals, colours and textures ready. Where the mesh has no normals, faces are smoothed over that meet at no more
    /// than `crease_degrees`, as [`Options::crease_degrees`] says.
    ///
    /// # Errors
    /// [`ConvertError::ExtentTooLarge`].
    pub fn new(mesh: &'a Mesh, crease_degrees: f64) -> Result<Self, ConvertError> {
        // The finest grid there is: how a texture lies on a triangle is told from corners that are rounded to it. Version 4
        // keeps no finishes, and nobody asks for them here.
        let options = Options { depth: Options::MAX_DEPTH, crease_degrees, ..Options::default() };
        let world = placement::place(mesh, &options)?;
        Ok(Self {
            surface: Surface::new(mesh, world, &options)?,
            has_cut_outs: mesh.materials.iter().any(|material| material.opacity_map.is_some()),
        })
    }

    /// Whether there may be points where nothing is, for [`MeshLook::at`] to tell.
    #[must_use]
    pub fn has_cut_outs(&self) -> bool {
        self.has_cut_outs
    }

    /// What the mesh looks like at a point of a triangle, which is given by its number and the weights of its three
    /// corners. `None` if an opacity map cuts it out, or there is no such triangle.
    #[must_use]
    pub fn at(&self, triangle: usize, weights: [f64; 3]) -> Option<Look> {
        if triangle >= self.surface.triangles.len() {
            return None;
        }
        let corners = self.surface.normals_and_light(triangle);
        let mean =
            |k: usize| (0..3).map(|corner| weights[corner] * f64::from(corners[corner][k])).sum::<f64>();
        // The conversion to an integer saturates.
        let values = [0, 1, 2, 3, 4, 5].map(|k| mean(k).round() as i16);
        let Some((coordinates, appearance)) = self.surface.finest_texture(triangle) else {
            return Some(Look::new([0, 1, 2].map(mean), values));
        };
        let seen = appearance.of(values, TexturePoint::mean(&coordinates, weights))?;
        let [x, y, z, ..] = seen;
        Some(Look::new([x, y, z].map(f64::from), seen))
    }
}

impl Look {
    fn new(normal: [f64; 3], [.., red, green, blue]: [i16; 6]) -> Self {
        let normal = crate::vector::unit(normal).unwrap_or([0.0, 0.0, 1.0]);
        Self { normal, diffuse: [red, green, blue].map(|value| f64::from(value_to_light(value)) / 65_535.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Image, Material, TextureMap};

    const MIDDLE: [f64; 3] = [0.25, 0.25, 0.5];

    fn triangle() -> Mesh {
        Mesh::new(vec![[0.0; 3], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]], vec![[0, 1, 2]]).unwrap()
    }

    fn light(displayed: f64) -> f64 {
        if displayed <= 0.04045 { displayed / 12.92 } else { ((displayed + 0.055) / 1.055).powf(2.4) }
    }

    fn close(found: [f64; 3], expected: [f64; 3]) {
        assert!((0..3).all(|k| (found[k] - expected[k]).abs() < 1e-3), "{found:?}, not {expected:?}");
    }

    #[test]
    fn colors_of_corners_are_mixed_as_light() {
        let colors = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.2]];
        let materials = vec![Material::matte("", [0.6, 1.0, 1.0])];
        let mesh = triangle().with_corner_colors(vec![colors]).unwrap();
        let mesh = mesh.with_materials(materials, vec![0]).unwrap();
        let look = MeshLook::new(&mesh, 60.0).unwrap();
        let seen = look.at(0, MIDDLE).unwrap();
        close(seen.diffuse, [0.25 * light(0.6), 0.25, 0.5 * light(0.2)]);
        close(seen.normal, [0.0, 0.0, 1.0]);
        assert_eq!(look.at(1, MIDDLE), None);
        assert!(!look.has_cut_outs());
    }

    #[test]
    fn normals_are_those_of_the_file() {
        let normals = [[0.6, 0.0, 0.8], [0.0, 0.0, 3.0], [0.0; 3]];
        let mesh = triangle().with_corner_normals(vec![normals]).unwrap();
        let seen = MeshLook::new(&mesh, 60.0).unwrap().at(0, MIDDLE).unwrap();
        let length = (0.15f64 * 0.15 + 0.95 * 0.95).sqrt();
        close(seen.normal, [0.15 / length, 0.0, 0.95 / length]);
    }

    /// An image whose texels a voxel of no resolution could tell apart: it is sharp all the same. One of its columns is cut
    /// out.
    #[test]
    fn textures_are_sharp_and_have_holes() {
        const SIDE: u32 = 4096;
        let pixels = (0..SIDE * 2)
            .map(|place| {
                let column = place % SIDE;
                [if column.is_multiple_of(2) { 255 } else { 0 }, 128, 0, if column == 7 { 0 } else { 255 }]
            })
            .collect();
        let map = TextureMap { scale: [100.0, 1.0], ..TextureMap::new(0) };
        let alpha = TextureMap { channel: crate::Channel::Alpha, ..map };
        let material = Material {
            diffuse_map: Some(map),
            opacity_map: Some(alpha),
            ..Material::matte("stripes", [1.0; 3])
        };
        let mesh = triangle()
            .with_corner_texture_coordinates(vec![[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]])
            .and_then(|mesh| mesh.with_images(vec![Image::new("", SIDE, 2, pixels)?]))
            .and_then(|mesh| mesh.with_materials(vec![material], vec![0]))
            .unwrap();
        let look = MeshLook::new(&mesh, 60.0).unwrap();
        assert!(look.has_cut_outs());
        let texel = |column: f64| {
            let u = (column + 0.5) / f64::from(SIDE) / 100.0;
            look.at(0, [1.0 - u - 0.5, u, 0.5])
        };
        for (column, red) in [(0.0, 1.0), (1.0, 0.0), (4.0, 1.0), (4095.0, 0.0)] {
            close(texel(column).unwrap().diffuse, [red, light(128.0 / 255.0), 0.0]);
        }
        assert_eq!(texel(7.0), None);
    }
}
