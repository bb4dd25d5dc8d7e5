//! The images of textures.

use crate::ConvertError;

/// An image of at least one pixel.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Image {
    pub(crate) name: String,
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) pixels: Vec<[u8; 4]>,
}

impl Image {
    /// An image of red, green, blue (sRGB) and alpha, row by row, the top row first. `name` is used in messages.
    ///
    /// # Errors
    /// [`ConvertError::ImageSize`] if there is no pixel, or not `width · height` of them.
    pub fn new(
        name: impl Into<String>,
        width: u32,
        height: u32,
        pixels: Vec<[u8; 4]>,
    ) -> Result<Self, ConvertError> {
        let name = name.into();
        let expected = u64::from(width) * u64::from(height);
        if expected == 0 || pixels.len() as u64 != expected {
            return Err(ConvertError::ImageSize { name, width, height, pixels: pixels.len() });
        }
        Ok(Self { name, width, height, pixels })
    }

    /// Where it is from.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Pixels in a row.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Pixels in a column.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// Red, green, blue (sRGB) and alpha of all pixels, row by row, the top row first.
    #[must_use]
    pub fn pixels(&self) -> &[[u8; 4]] {
        &self.pixels
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_number_of_pixels_must_be_right() {
        let pixels = |count| vec![[1, 2, 3, 4]; count];
        assert_eq!(Image::new("a", 2, 3, pixels(6)).unwrap().pixels().len(), 6);
        for (width, height, count) in [(2, 3, 5), (2, 3, 7), (0, 3, 0), (3, 0, 0), (u32::MAX, u32::MAX, 1)] {
            let error = Image::new("bark.png", width, height, pixels(count)).unwrap_err().to_string();
            assert!(error.contains("bark.png"), "{error}");
        }
    }
}
