//! A scene: one mesh, its materials and its textures.

use crate::color::gradient;
use crate::material::Material;
use crate::mesh::{MaterialId, Mesh};
use crate::normals;

/// A picture that a material refers to.
#[derive(Debug, Clone)]
pub struct Texture {
    /// File name, beside the OBJ file.
    pub name: String,
    pub image: image::RgbImage,
}

/// Everything that goes into the files of a scene.
#[derive(Debug, Clone)]
pub struct Scene {
    /// Stem of the file names.
    pub name: &'static str,
    /// One line that says what is to be seen.
    pub title: &'static str,
    pub mesh: Mesh,
    pub materials: Vec<Material>,
    pub textures: Vec<Texture>,
}

impl Scene {
    /// An empty scene.
    pub fn new(name: &'static str, title: &'static str) -> Self {
        Self { name, title, mesh: Mesh::default(), materials: Vec::new(), textures: Vec::new() }
    }

    /// Adds a material.
    pub fn material(&mut self, material: Material) -> MaterialId {
        self.materials.push(material);
        MaterialId(self.materials.len() - 1)
    }

    /// Adds materials `name_0`, `name_1` … like `model`, with `count` colours taken evenly from a gradient over [0, 1].
    pub fn shades(&mut self, model: &Material, count: usize, stops: &[(f64, u32)]) -> Shades {
        let shades = (0..count).map(|index| {
            let diffuse = gradient(stops, (index as f64 + 0.5) / count as f64);
            self.material(Material { name: format!("{}_{index}", model.name), diffuse, ..model.clone() })
        });
        Shades(shades.collect())
    }

    /// Adds a part, with normals as its creases demand.
    pub fn add(&mut self, mut part: Mesh) {
        normals::compute(&mut part);
        self.mesh.append(part);
    }
}

/// A gradient of materials.
#[derive(Debug, Clone)]
pub struct Shades(Vec<MaterialId>);

impl Shades {
    /// The material at a position of the gradient; the ends reach on outside of [0, 1].
    pub fn at(&self, position: f64) -> MaterialId {
        let last = self.0.len() as f64 - 1.0;
        self.0[(position * self.0.len() as f64).floor().clamp(0.0, last) as usize]
    }
}
