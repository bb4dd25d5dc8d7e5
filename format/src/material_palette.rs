//! The materials of a file.

use crate::{FormatError, Material, Palette};

/// The materials that voxels refer to by index.
///
/// Indices count from 1; index 0 is no material but says that a voxel is empty.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MaterialPalette {
    materials: Vec<Material>,
}

impl MaterialPalette {
    /// The largest palette: indices have 16 bits, and index 0 is taken.
    pub const MAX_MATERIALS: usize = u16::MAX as usize;

    /// A palette of `materials`, of which the first gets index 1.
    ///
    /// # Errors
    /// [`FormatError::TooManyMaterials`] if there are more than [`MaterialPalette::MAX_MATERIALS`];
    /// [`FormatError::ImpossibleMaterial`] if a number is negative, infinite or not a number.
    pub fn new(materials: Vec<Material>) -> Result<Self, FormatError> {
        if materials.len() > Self::MAX_MATERIALS {
            return Err(FormatError::TooManyMaterials { count: materials.len(), limit: Self::MAX_MATERIALS });
        }
        for (index, material) in (1..).zip(&materials) {
            if let Some((field, value)) = material.impossible_field() {
                return Err(FormatError::ImpossibleMaterial { index, field, value });
            }
        }
        Ok(Self { materials })
    }

    /// The materials in order: entry `k` has palette index `k + 1`.
    #[must_use]
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// The material of a palette index; `None` for index 0 and for an index beyond the palette.
    #[must_use]
    pub fn material(&self, index: u16) -> Option<&Material> {
        let entry = usize::from(index).checked_sub(1)?;
        self.materials.get(entry)
    }

    /// The diffuse colour of a palette index, in sRGB; `None` as in [`MaterialPalette::material`].
    #[must_use]
    pub fn color(&self, index: u16) -> Option<[u8; 3]> {
        self.material(index).map(|material| material.diffuse)
    }

    /// The diffuse colours of all materials in order, in sRGB.
    #[must_use]
    pub fn colors(&self) -> Vec<[u8; 3]> {
        self.materials.iter().map(|material| material.diffuse).collect()
    }

    /// Number of materials, at most [`MaterialPalette::MAX_MATERIALS`]; also the largest index in use.
    #[must_use]
    pub fn len(&self) -> usize {
        self.materials.len()
    }

    /// Whether there are no materials, so that only empty voxels can refer to this palette.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.materials.is_empty()
    }

    /// The diffuse colours alone, for version 4.
    ///
    /// # Errors
    /// [`FormatError::TooManyMaterials`] if there are more than [`Palette::MAX_COLORS`].
    pub fn to_palette(&self) -> Result<Palette, FormatError> {
        if self.len() > Palette::MAX_COLORS {
            return Err(FormatError::TooManyMaterials { count: self.len(), limit: Palette::MAX_COLORS });
        }
        Palette::new(self.colors())
    }

    /// The materials as in a file of version 5.
    pub(crate) fn to_bytes(&self) -> Vec<u8> {
        self.materials.iter().flat_map(|material| material.to_bytes()).collect()
    }

    /// The materials from a file of version 5.
    pub(crate) fn from_bytes(bytes: &[u8]) -> Result<Self, FormatError> {
        Self::new(bytes.as_chunks().0.iter().map(Material::from_bytes).collect())
    }

    /// The largest index in use, in the type of an index.
    pub(crate) fn last_index(&self) -> u16 {
        // The constructor has bounded the length.
        self.materials.len() as u16
    }
}

impl From<&Palette> for MaterialPalette {
    /// Opaque materials without highlights.
    fn from(palette: &Palette) -> Self {
        Self { materials: palette.colors().iter().map(|color| Material::matte(*color)).collect() }
    }
}
