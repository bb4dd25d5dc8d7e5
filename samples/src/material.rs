//! How a surface reflects light: the fields of an MTL file that the scenes use.

use crate::color::{Color, hex};

/// A Phong material.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    pub name: String,
    /// `Kd`: multiplied with the colours of vertices and texture, where there are any.
    pub diffuse: Color,
    /// `Ks`
    pub specular: Color,
    /// `Ns`
    pub shininess: f64,
    /// `Ke`
    pub emission: Color,
    /// `map_Kd`: the name of a texture of the same scene.
    pub texture: Option<String>,
}

impl Material {
    /// A dull material.
    pub fn matte(name: impl Into<String>, diffuse: Color) -> Self {
        Self {
            name: name.into(),
            diffuse,
            specular: hex(0x000000),
            shininess: 1.0,
            emission: hex(0x000000),
            texture: None,
        }
    }

    /// This material with highlights.
    #[must_use]
    pub fn glossy(mut self, specular: Color, shininess: f64) -> Self {
        self.specular = specular;
        self.shininess = shininess;
        self
    }

    /// This material, shining by itself.
    #[must_use]
    pub fn glowing(mut self, emission: Color) -> Self {
        self.emission = emission;
        self
    }

    /// This material, painted with a texture.
    #[must_use]
    pub fn textured(mut self, texture: &str) -> Self {
        self.texture = Some(texture.to_owned());
        self
    }
}
