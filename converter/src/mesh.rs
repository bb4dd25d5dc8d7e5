//! Triangles as they come from a file: positions, normals, colours, materials, textures.

use crate::{ConvertError, Image, Material};

/// A triangle mesh in model space.
///
/// Every vertex that a triangle uses has finite coordinates, and every index is in range: the constructor has checked it.
/// What is given for corners is given for all triangles or for none.
#[derive(Debug, Clone, Default)]
pub struct Mesh {
    pub(crate) positions: Vec<[f64; 3]>,
    pub(crate) triangles: Vec<[u32; 3]>,
    pub(crate) materials: Vec<Material>,
    pub(crate) triangle_materials: Vec<u32>,
    pub(crate) corner_normals: Vec<[[f32; 3]; 3]>,
    pub(crate) corner_colors: Vec<[[f32; 3]; 3]>,
    pub(crate) corner_texture_coordinates: Vec<[[f32; 2]; 3]>,
    pub(crate) images: Vec<Image>,
    pub(crate) warnings: Vec<String>,
}

/// Marks a corner whose normal is to be computed from the faces around it.
pub(crate) const NO_NORMAL: [f32; 3] = [0.0; 3];

impl Mesh {
    /// A mesh of one grey material whose normals are computed when it is converted.
    ///
    /// `positions` are vertices in model space, `triangles` index them from 0.
    ///
    /// # Errors
    /// [`ConvertError::NoFaces`], [`ConvertError::IndexOutOfRange`], [`ConvertError::NotFinite`],
    /// [`ConvertError::TooLarge`].
    pub fn new(positions: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>) -> Result<Self, ConvertError> {
        let mesh = Self { positions, triangles, ..Self::default() };
        mesh.check()?;
        Ok(mesh)
    }

    /// The same mesh with materials; `triangle_materials` holds one index into `materials` for each triangle.
    ///
    /// # Errors
    /// [`ConvertError::LengthMismatch`], [`ConvertError::IndexOutOfRange`].
    pub fn with_materials(
        mut self,
        materials: Vec<Material>,
        triangle_materials: Vec<u32>,
    ) -> Result<Self, ConvertError> {
        self.materials = materials;
        self.triangle_materials = triangle_materials;
        self.check()?;
        Ok(self)
    }

    /// The same mesh with normals at the three corners of each triangle, of any length.
    ///
    /// A normal of length zero, and one that is not finite, is computed instead.
    ///
    /// # Errors
    /// [`ConvertError::LengthMismatch`].
    pub fn with_corner_normals(mut self, corner_normals: Vec<[[f32; 3]; 3]>) -> Result<Self, ConvertError> {
        self.corner_normals = corner_normals;
        self.check()?;
        Ok(self)
    }

    /// The same mesh with colours (sRGB, 0 to 1) at the three corners of each triangle. They multiply those of the materials,
    /// if there are any.
    ///
    /// # Errors
    /// [`ConvertError::LengthMismatch`].
    pub fn with_corner_colors(mut self, corner_colors: Vec<[[f32; 3]; 3]>) -> Result<Self, ConvertError> {
        self.corner_colors = corner_colors;
        self.check()?;
        Ok(self)
    }

    /// The same mesh with texture coordinates at the three corners of each triangle: u to the right, v **up**, so that
    /// (0, 0) is the bottom left corner of an image and (1, 1) the top right one.
    ///
    /// # Errors
    /// [`ConvertError::LengthMismatch`].
    pub fn with_corner_texture_coordinates(
        mut self,
        corner_texture_coordinates: Vec<[[f32; 2]; 3]>,
    ) -> Result<Self, ConvertError> {
        self.corner_texture_coordinates = corner_texture_coordinates;
        self.check()?;
        Ok(self)
    }

    /// The same mesh with the images that texture maps of its materials refer to..
    ///
    /// # Errors
    /// [`ConvertError::MissingImage`] if materials refer to more images than there are.
    pub fn with_images(mut self, images: Vec<Image>) -> Result<Self, ConvertError> {
        self.images = images;
        self.check()?;
        Ok(self)
    }

    /// The vertices, in model space.
    #[must_use]
    pub fn positions(&self) -> &[[f64; 3]] {
        &self.positions
    }

    /// The triangles, as indices into the vertices.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// What triangles look like.
    #[must_use]
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// An index into the materials for each triangle; empty if the mesh has none.
    #[must_use]
    pub fn triangle_materials(&self) -> &[u32] {
        &self.triangle_materials
    }

    /// Normals at the corners of each triangle, of any length, zero where there is none; empty if there are none at all.
    #[must_use]
    pub fn corner_normals(&self) -> &[[[f32; 3]; 3]] {
        &self.corner_normals
    }

    /// Colours (sRGB) at the corners of each triangle; empty if the mesh has none.
    #[must_use]
    pub fn corner_colors(&self) -> &[[[f32; 3]; 3]] {
        &self.corner_colors
    }

    /// Texture coordinates (u to the right, v up) at the corners of each triangle; empty if the mesh has none.
    #[must_use]
    pub fn corner_texture_coordinates(&self) -> &[[[f32; 2]; 3]] {
        &self.corner_texture_coordinates
    }

    /// The images of the textures.
    #[must_use]
    pub fn images(&self) -> &[Image] {
        &self.images
    }

    /// What was odd about the file but did not prevent reading it.
    #[must_use]
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// The diffuse colour of a triangle.
    pub(crate) fn diffuse(&self, triangle: usize) -> [f64; 3] {
        self.triangle_materials
            .get(triangle)
            .map_or(Material::DEFAULT_DIFFUSE, |&material| self.materials[material as usize].diffuse)
    }

    /// The normals at the corners of a triangle; [`NO_NORMAL`] where there is none.
    pub(crate) fn normals(&self, triangle: usize) -> [[f32; 3]; 3] {
        self.corner_normals.get(triangle).copied().unwrap_or([NO_NORMAL; 3])
    }

    /// Positions of the corners of a triangle.
    pub(crate) fn corners(&self, triangle: usize) -> [[f64; 3]; 3] {
        self.triangles[triangle].map(|vertex| self.positions[vertex as usize])
    }

    /// Number of triangles without area.
    pub(crate) fn degenerate_triangles(&self) -> u64 {
        let has_area = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|vertex| self.positions[vertex as usize]);
            let edge = |to: [f64; 3]| [to[0] - a[0], to[1] - a[1], to[2] - a[2]];
            let (e, f) = (edge(b), edge(c));
            // Differences of products, compared without subtracting: exact equality is what makes the area zero.
            (0..3).any(|axis| {
                let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                e[u] * f[v] != e[v] * f[u]
            })
        };
        self.triangles.iter().filter(|triangle| !has_area(triangle)).count() as u64
    }

    /// Checks what the documentation of [`Mesh`] promises.
    pub(crate) fn check(&self) -> Result<(), ConvertError> {
        // Vertices, and the three corners of every triangle, are numbered with 32 bits.
        let max = u32::MAX as usize / 3;
        for (kind, count) in [("vertices", self.positions.len()), ("triangles", self.triangles.len())] {
            if count > max {
                return Err(ConvertError::TooLarge { kind, count, max });
            }
        }
        if self.triangles.is_empty() {
            return Err(ConvertError::NoFaces);
        }
        for (kind, found) in [
            ("material indices", self.triangle_materials.len()),
            ("corner normals", self.corner_normals.len()),
            ("corner colours", self.corner_colors.len()),
            ("corner texture coordinates", self.corner_texture_coordinates.len()),
        ] {
            let expected = self.triangles.len();
            if found != 0 && found != expected {
                return Err(ConvertError::LengthMismatch { kind, found, expected });
            }
        }
        for (triangle, vertices) in self.triangles.iter().enumerate() {
            for &index in vertices {
                let Some(position) = self.positions.get(index as usize) else {
                    let count = self.positions.len();
                    return Err(ConvertError::IndexOutOfRange { triangle, kind: "vertex", index, count });
                };
                if !position.iter().all(|coordinate| coordinate.is_finite()) {
                    return Err(ConvertError::NotFinite { vertex: index as usize, position: *position });
                }
            }
        }
        let count = self.materials.len();
        for (triangle, &index) in self.triangle_materials.iter().enumerate() {
            if index as usize >= count {
                return Err(ConvertError::IndexOutOfRange { triangle, kind: "material", index, count });
            }
        }
        for material in &self.materials {
            if let Some(map) = material.maps().find(|map| map.image >= self.images.len()) {
                return Err(ConvertError::MissingImage {
                    material: material.name.clone(),
                    image: map.image,
                    count: self.images.len(),
                });
            }
        }
        Ok(())
    }
}
