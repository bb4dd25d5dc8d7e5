//! The mesh as scan conversion sees it: on the sub-voxel grid, with a normal, a colour and texture coordinates at every
//! corner.

use crate::color_space::{to_bytes, to_linear};
use crate::finish::Finishes;
use crate::fixed_point::{GridPoint, snap_vertices};
use crate::normals::{FixedNormal, corner_normals};
use crate::options::FileFormat;
use crate::scan_conversion::GridTriangle;
use crate::texture::{Appearance, Gradients, TexturePoint, Textures};
use crate::{ConvertError, Mesh, Options, WorldTransform};
use rayon::prelude::*;

/// Triangles on the sub-voxel grid.
pub(crate) struct Surface<'a> {
    pub vertices: Vec<GridPoint>,
    pub triangles: &'a [[u32; 3]],
    normals: Vec<[FixedNormal; 3]>,
    colors: Colors<'a>,
    textures: Textures<'a>,
    pub finishes: Finishes,
    mesh: &'a Mesh,
}

enum Colors<'a> {
    /// The same at all corners: a colour for each material, and the material of each triangle (none: all have the first).
    Materials { colors: Vec<[u8; 3]>, of_triangle: &'a [u32] },
    /// One for each corner.
    Corners(Vec<[[u8; 3]; 3]>),
}

impl<'a> Surface<'a> {
    /// # Errors
    /// [`ConvertError::TooLarge`] if there are too many different finishes.
    pub(crate) fn new(
        mesh: &'a Mesh,
        world: WorldTransform,
        options: &Options,
    ) -> Result<Self, ConvertError> {
        Ok(Self {
            vertices: snap_vertices(mesh, world, options.depth),
            triangles: &mesh.triangles,
            normals: corner_normals(mesh, world, options.crease_degrees),
            colors: Colors::new(mesh),
            textures: Textures::new(mesh),
            finishes: Finishes::new(match options.format {
                // It keeps colours only.
                FileFormat::Version4 => &[],
                FileFormat::Version5 { .. } => &mesh.materials,
            })?,
            mesh,
        })
    }

    /// Corners of a triangle.
    #[inline]
    pub(crate) fn corners(&self, triangle: usize) -> [GridPoint; 3] {
        self.triangles[triangle].map(|vertex| self.vertices[vertex as usize])
    }

    /// The one colour of these triangles, if they have no more than one.
    pub(crate) fn common_color(&self, mut triangles: impl Iterator<Item = usize>) -> Option<[u8; 3]> {
        match &self.colors {
            Colors::Materials { colors, .. } if colors.len() == 1 && self.textures.is_empty() => {
                Some(colors[0])
            }
            _ => {
                let first = self.color(triangles.next()?)?;
                triangles.all(|triangle| self.color(triangle) == Some(first)).then_some(first)
            }
        }
    }

    /// The colour of a triangle, if it is the same everywhere.
    fn color(&self, triangle: usize) -> Option<[u8; 3]> {
        if self.textures.material(triangle).is_some() {
            return None;
        }
        let [a, b, c] = self.corner_colors(triangle);
        (a == b && b == c).then_some(a)
    }

    fn corner_colors(&self, triangle: usize) -> [[u8; 3]; 3] {
        match &self.colors {
            Colors::Materials { colors, of_triangle } => {
                [colors[of_triangle.get(triangle).map_or(0, |&material| material as usize)]; 3]
            }
            Colors::Corners(colors) => colors[triangle],
        }
    }

    /// The triangle with its normals only.
    #[inline]
    pub(crate) fn with_normals(&self, triangle: usize) -> GridTriangle<3> {
        GridTriangle::new(self.corners(triangle), self.normals[triangle], self.finish(triangle))
    }

    /// The triangle with normals and light.
    #[inline]
    pub(crate) fn with_normals_and_light(&self, triangle: usize) -> GridTriangle<6> {
        let values = self.normals_and_light(triangle);
        GridTriangle::new(self.corners(triangle), values, self.finish(triangle))
    }

    /// The triangle with normals, light and texture coordinates, which are (0, 0) if it has none.
    pub(crate) fn with_texture_coordinates(&self, triangle: usize) -> GridTriangle<6, TexturePoint> {
        let coordinates = self.mesh.corner_texture_coordinates.get(triangle).copied().unwrap_or_default();
        let values = self.normals_and_light(triangle);
        let coordinates = coordinates.map(TexturePoint);
        GridTriangle::with_texture(self.corners(triangle), values, coordinates, self.finish(triangle))
    }

    /// The triangle with texture coordinates, and what its samples look like; `None` if it has no texture.
    pub(crate) fn textured(
        &self,
        triangle: usize,
    ) -> Option<(GridTriangle<6, TexturePoint>, Appearance<'_>)> {
        let material = self.textures.material(triangle)?;
        let triangle = self.with_texture_coordinates(triangle);
        Some((triangle, self.textures.appearance(material, &triangle)))
    }

    /// The texture coordinates of a triangle, and what its samples look like with textures as sharp as their images; `None`
    /// if it has no texture.
    pub(crate) fn finest_texture(&self, triangle: usize) -> Option<([TexturePoint; 3], Appearance<'_>)> {
        let material = self.textures.material(triangle)?;
        let coordinates = self.mesh.corner_texture_coordinates[triangle].map(TexturePoint);
        let gradients = Gradients::new(&self.corners(triangle), &coordinates);
        Some((coordinates, self.textures.finest_appearance(material, gradients.as_ref())))
    }

    /// The material of a triangle.
    pub(crate) fn material(&self, triangle: usize) -> Option<u32> {
        self.mesh.triangle_materials.get(triangle).copied()
    }

    fn finish(&self, triangle: usize) -> u16 {
        if self.finishes.finishes.len() == 1 { 0 } else { self.finishes.of(self.material(triangle)) }
    }

    /// Normal and light at the corners of a triangle.
    #[inline]
    pub(crate) fn normals_and_light(&self, triangle: usize) -> [[i16; 6]; 3] {
        let (normals, colors) = (&self.normals[triangle], self.corner_colors(triangle));
        [0, 1, 2].map(|corner| {
            let [x, y, z] = normals[corner];
            let [red, green, blue] = to_linear(colors[corner]).map(light_to_value);
            [x, y, z, red, green, blue]
        })
    }
}

impl<'a> Colors<'a> {
    fn new(mesh: &'a Mesh) -> Self {
        if mesh.corner_colors.is_empty() {
            let colors: Vec<_> = mesh.materials.iter().map(|material| to_bytes(material.diffuse)).collect();
            return if mesh.triangle_materials.is_empty() || colors.iter().all(|color| *color == colors[0]) {
                Self::Materials { colors: vec![to_bytes(mesh.diffuse(0))], of_triangle: &[] }
            } else {
                Self::Materials { colors, of_triangle: &mesh.triangle_materials }
            };
        }
        let has_materials = !mesh.triangle_materials.is_empty();
        let corners = mesh.corner_colors.par_iter().enumerate().map(|(triangle, corners)| {
            let diffuse = if has_materials { mesh.diffuse(triangle) } else { [1.0; 3] };
            corners
                .map(|color| to_bytes([0, 1, 2].map(|channel| f64::from(color[channel]) * diffuse[channel])))
        });
        Self::Corners(corners.collect())
    }
}

/// Linear light as a value that can be interpolated; order and differences stay the same.
pub(crate) fn light_to_value(light: u16) -> i16 {
    (light ^ 0x8000) as i16
}

/// The inverse of [`light_to_value`].
pub(crate) fn value_to_light(value: i16) -> u16 {
    value as u16 ^ 0x8000
}
