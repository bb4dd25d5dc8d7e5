//! The colours of a file.

use crate::FormatError;

/// The colours that voxels refer to by index.
///
/// Indices count from 1; index 0 is no colour but says that a voxel is empty.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Palette {
    colors: Vec<[u8; 3]>,
}

impl Palette {
    /// The largest palette: indices have 15 bits, and index 0 is taken.
    pub const MAX_COLORS: usize = (1 << 15) - 1;

    /// A palette of `colors` (red, green, blue; 0 to 255), of which the first gets index 1.
    ///
    /// # Errors
    /// [`FormatError::PaletteTooLarge`] if there are more than [`Palette::MAX_COLORS`].
    pub fn new(colors: Vec<[u8; 3]>) -> Result<Self, FormatError> {
        if colors.len() > Self::MAX_COLORS {
            return Err(FormatError::PaletteTooLarge { size: colors.len() });
        }
        Ok(Self { colors })
    }

    /// The colours in order: entry `k` has palette index `k + 1`.
    #[must_use]
    pub fn colors(&self) -> &[[u8; 3]] {
        &self.colors
    }

    /// The colour of a palette index; `None` for index 0 and for an index beyond the palette.
    #[must_use]
    pub fn color(&self, index: u16) -> Option<[u8; 3]> {
        let entry = usize::from(index).checked_sub(1)?;
        self.colors.get(entry).copied()
    }

    /// Number of colours, at most [`Palette::MAX_COLORS`]; also the largest index in use.
    #[must_use]
    pub fn len(&self) -> usize {
        self.colors.len()
    }

    /// Whether there are no colours, so that only empty voxels can refer to this palette.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.colors.is_empty()
    }

    /// The largest index in use, in the type of an index.
    pub(crate) fn last_index(&self) -> u16 {
        // The constructor has bounded the length.
        self.colors.len() as u16
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_count_from_one() {
        let palette = Palette::new(vec![[1, 2, 3], [4, 5, 6]]).unwrap();
        assert_eq!(palette.color(0), None);
        assert_eq!(palette.color(1), Some([1, 2, 3]));
        assert_eq!(palette.color(2), Some([4, 5, 6]));
        assert_eq!(palette.color(3), None);
        assert_eq!(palette.color(u16::MAX), None);
        assert_eq!(palette.len(), 2);
        assert!(!palette.is_empty() && Palette::default().is_empty());
    }

    #[test]
    fn one_color_too_many_is_refused() {
        let largest = Palette::new(vec![[7; 3]; 32_767]).unwrap();
        assert_eq!(largest.color(32_767), Some([7; 3]));
        let error = Palette::new(vec![[7; 3]; 32_768]).unwrap_err();
        assert!(matches!(error, FormatError::PaletteTooLarge { size: 32_768 }), "{error}");
    }
}
