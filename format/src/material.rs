//! What a surface is made of.

use byteorder::{ByteOrder, LittleEndian};

/// How the surface of a voxel takes and gives light.
///
/// ```text
///  offset  bytes  field
///  0       3      diffuse           red, green, blue      sRGB
///  3       1      reflectivity      in units of 1/255
///  4       3      specular          red, green, blue      sRGB
///  7       1      transparency      in units of 1/255
///  8       4      shininess         f32, ≥ 0
///  12      4      refraction index  f32, > 0
///  16      12     absorption        red, green, blue      f32, ≥ 0, per unit of length
///  28      12     emission          red, green, blue      f32, ≥ 0, linear
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// Colour of the light that is scattered in all directions: red, green, blue in sRGB.
    pub diffuse: [u8; 3],
    /// Share of the light that is mirrored, in units of 1/255.
    pub reflectivity: u8,
    /// Colour of the highlight: red, green, blue in sRGB. Black if there is none.
    pub specular: [u8; 3],
    /// Share of the light that passes into the material, in units of 1/255; 0 for an opaque one.
    pub transparency: u8,
    /// Exponent of the highlight (Phong 1975), 0 or more. The larger it is the smaller the highlight.
    pub shininess: f32,
    /// Speed of light outside over that inside, more than 0; 1 if light is not bent.
    pub refraction_index: f32,
    /// What the inside absorbs of red, green and blue, 0 or more: after a way of length `s` the share `exp(−a s)` is left
    /// (Beer and Lambert). Lengths are in world units, or in edges of the cube if its place in the world is unknown.
    pub absorption: [f32; 3],
    /// Light given off by itself, red, green and blue, linear, 0 or more: 1 is as bright as white in full light.
    pub emission: [f32; 3],
}

/// Length of a material in the file, in bytes.
pub(crate) const MATERIAL_BYTES: usize = 40;

impl Material {
    /// An opaque material without highlight, of a colour in sRGB.
    #[must_use]
    pub const fn matte(diffuse: [u8; 3]) -> Self {
        Self {
            diffuse,
            reflectivity: 0,
            specular: [0; 3],
            transparency: 0,
            shininess: 0.0,
            refraction_index: 1.0,
            absorption: [0.0; 3],
            emission: [0.0; 3],
        }
    }

    /// The material as in the file.
    pub(crate) fn to_bytes(self) -> [u8; MATERIAL_BYTES] {
        let mut bytes = [0; MATERIAL_BYTES];
        bytes[0..3].copy_from_slice(&self.diffuse);
        bytes[3] = self.reflectivity;
        bytes[4..7].copy_from_slice(&self.specular);
        bytes[7] = self.transparency;
        LittleEndian::write_f32(&mut bytes[8..12], self.shininess);
        LittleEndian::write_f32(&mut bytes[12..16], self.refraction_index);
        LittleEndian::write_f32_into(&self.absorption, &mut bytes[16..28]);
        LittleEndian::write_f32_into(&self.emission, &mut bytes[28..40]);
        bytes
    }

    /// The material from the file, not yet checked.
    pub(crate) fn from_bytes(bytes: &[u8; MATERIAL_BYTES]) -> Self {
        let three = |offset: usize| std::array::from_fn(|k| bytes[offset + k]);
        let number = |offset: usize| LittleEndian::read_f32(&bytes[offset..offset + 4]);
        let numbers = |offset: usize| std::array::from_fn(|k| number(offset + 4 * k));
        Self {
            diffuse: three(0),
            reflectivity: bytes[3],
            specular: three(4),
            transparency: bytes[7],
            shininess: number(8),
            refraction_index: number(12),
            absorption: numbers(16),
            emission: numbers(28),
        }
    }

    /// The first field whose number no material can have, and that number.
    pub(crate) fn impossible_field(&self) -> Option<(&'static str, f32)> {
        let positive = self.refraction_index.is_finite() && self.refraction_index > 0.0;
        let lists = [("absorption", &self.absorption[..]), ("emission", &self.emission[..])];
        let shininess = [("shininess", std::slice::from_ref(&self.shininess))];
        if !positive {
            return Some(("refraction index", self.refraction_index));
        }
        shininess.into_iter().chain(lists).find_map(|(name, numbers)| {
            let number = numbers.iter().find(|number| !(number.is_finite() && **number >= 0.0))?;
            Some((name, *number))
        })
    }
}
