//! What the surface of a triangle looks like.

use crate::texture_map::TextureMap;

/// The look of a surface: colours, how it mirrors and lets light through, and the textures that vary them.
///
/// [`Material::default`] is a matte, opaque grey.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// The name it has in the file.
    pub name: String,
    /// Diffuse colour as displayed (sRGB), 0 to 1 for red, green, blue.
    pub diffuse: [f64; 3],
    /// Multiplies the diffuse colour.
    pub diffuse_map: Option<TextureMap>,
    /// Share of the light that does not pass through: 1 is opaque, 0 invisible but for highlights and mirror images.
    pub opacity: f64,
    /// Where the surface is: samples below [`Material::alpha_cutoff`] are cut out.
    pub opacity_map: Option<TextureMap>,
    /// The smallest sample of [`Material::opacity_map`] that is still surface, 0 to 1.
    pub alpha_cutoff: f64,
    /// Colour of highlights as displayed (sRGB), 0 to 1.
    pub specular: [f64; 3],
    /// Exponent of highlights (Phong 1975), 0 or more. The larger it is the smaller the highlight.
    pub shininess: f64,
    /// Share of the light that is mirrored, 0 to 1.
    pub reflectivity: f64,
    /// Speed of light outside over that inside, more than 0; 1 if light is not bent.
    pub refraction_index: f64,
    /// Light given off by itself, red, green and blue, linear, 0 or more.
    pub emission: [f64; 3],
    /// What the inside absorbs of red, green and blue for each world unit of the way, 0 or more.
    pub absorption: [f64; 3],
    /// Tilts the normals.
    pub normal_map: Option<NormalMap>,
    /// Moves the surface.
    pub displacement_map: Option<DisplacementMap>,
}

/// A texture that tilts the normals of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NormalMap {
    /// The texture.
    pub map: TextureMap,
    /// How its values are meant.
    pub kind: NormalMapKind,
}

/// How the values of a normal map are meant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NormalMapKind {
    /// Colours are directions in tangent space: red along u, green along v, blue along the normal, each from −1 to 1.
    Tangent {
        /// Multiplies red and green; 1 is as painted.
        strength: f64,
    },
    /// Brightness is height above the surface.
    Height {
        /// Height of white over black (`-bm`). Where a texture repeats once over a unit of texture coordinates, 1 means
        /// as high as that unit is wide.
        multiplier: f64,
    },
}

/// A texture whose brightness moves the surface along its normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DisplacementMap {
    /// The texture.
    pub map: TextureMap,
    /// Way of white over black, in world units (`-bm`).
    pub multiplier: f64,
}

impl Material {
    /// What a triangle without a material looks like: the grey that MTL files mean if they say nothing.
    pub const DEFAULT_DIFFUSE: [f64; 3] = [0.8; 3];

    /// An opaque material without highlight, of a colour in sRGB.
    #[must_use]
    pub fn matte(name: impl Into<String>, diffuse: [f64; 3]) -> Self {
        Self {
            name: name.into(),
            diffuse,
            diffuse_map: None,
            opacity: 1.0,
            opacity_map: None,
            alpha_cutoff: 0.5,
            specular: [0.0; 3],
            shininess: 0.0,
            reflectivity: 0.0,
            refraction_index: 1.0,
            emission: [0.0; 3],
            absorption: [0.0; 3],
            normal_map: None,
            displacement_map: None,
        }
    }

    /// All the texture maps it has.
    pub(crate) fn maps(&self) -> impl Iterator<Item = &TextureMap> {
        [
            self.diffuse_map.as_ref(),
            self.opacity_map.as_ref(),
            self.normal_map.as_ref().map(|normal| &normal.map),
            self.displacement_map.as_ref().map(|displacement| &displacement.map),
        ]
        .into_iter()
        .flatten()
    }
}

impl Default for Material {
    fn default() -> Self {
        Self::matte("", Self::DEFAULT_DIFFUSE)
    }
}
