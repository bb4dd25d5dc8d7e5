//! What stands for a cell in a volume.

use super::ExchangeError;
use crate::MaterialPalette;

/// What stands for a cell in a volume. An empty cell is zeros.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Cells {
    /// The palette index, in one byte.
    Index8,
    /// The palette index, in two bytes, the lower one first.
    Index16,
    /// Four bytes: red, green, blue (sRGB) and opacity. An opaque cell has 255.
    Rgba,
}

impl Cells {
    /// The shortest that can name all materials of a palette.
    #[must_use]
    pub fn of_palette(materials: &MaterialPalette) -> Self {
        if materials.len() <= usize::from(u8::MAX) { Self::Index8 } else { Self::Index16 }
    }

    /// Bytes for a cell.
    #[must_use]
    pub fn byte_length(self) -> usize {
        match self {
            Self::Index8 => 1,
            Self::Index16 => 2,
            Self::Rgba => 4,
        }
    }

    /// The bytes of a cell for each palette index, of which the first [`Cells::byte_length`] count.
    pub(crate) fn table(self, materials: &MaterialPalette) -> Result<Vec<[u8; 4]>, ExchangeError> {
        if self == Self::Index8 && materials.len() > usize::from(u8::MAX) {
            return Err(ExchangeError::TooManyForBytes { materials: materials.len() });
        }
        let colors = materials.materials().iter().zip(1_u16..).map(|(material, index)| match self {
            Self::Index8 | Self::Index16 => {
                let [low, high] = index.to_le_bytes();
                [low, high, 0, 0]
            }
            Self::Rgba => {
                let [red, green, blue] = material.diffuse;
                // What is filled is never quite invisible, so that it differs from what is empty.
                [red, green, blue, (u8::MAX - material.transparency).max(1)]
            }
        });
        Ok(std::iter::once([0; 4]).chain(colors).collect())
    }
}
