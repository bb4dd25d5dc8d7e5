//! The images of textures.

use crate::ConvertError;
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};
use std::io::Cursor;
use std::sync::Arc;

/// An image of at least one pixel.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Image {
    name: String,
    width: u32,
    height: u32,
    /// Shared by the copies of a mesh.
    pixels: Arc<Vec<[u8; 4]>>,
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
        Ok(Self { name, width, height, pixels: Arc::new(pixels) })
    }

    /// Largest number of pixels of a file, 16,384 by 8,192.
    pub const MAX_PIXELS: u64 = 1 << 27;

    /// Reads a PNG, JPEG, BMP or TGA file of any depth and kind of colour. What is transparent, grey, of a palette or of 16 bits
    /// per channel becomes red, green, blue and alpha of 8 bits.
    ///
    /// `bytes` are those of the file. The format is told from them, that of TGA, which cannot be, from the ending of `name`.
    ///
    /// # Errors
    /// [`ConvertError::UnreadableImage`] if the file is damaged or of another kind, [`ConvertError::LargeImage`] if it has more
    /// than [`Image::MAX_PIXELS`].
    pub fn decode(name: impl Into<String>, bytes: &[u8]) -> Result<Self, ConvertError> {
        let name = name.into();
        match decode(&name, bytes) {
            Ok(Ok(image)) => {
                let (width, height) = (image.width(), image.height());
                let pixels = image.into_rgba8().into_raw().as_chunks::<4>().0.to_vec();
                Self::new(name, width, height, pixels)
            }
            Ok(Err((width, height))) => {
                Err(ConvertError::LargeImage { name, width, height, max: Self::MAX_PIXELS })
            }
            Err(source) => Err(ConvertError::UnreadableImage { name, source }),
        }
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

/// The image, or its size if it is too large.
fn decode(name: &str, bytes: &[u8]) -> Result<Result<DynamicImage, (u32, u32)>, image::ImageError> {
    let mut reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format()?;
    if let (None, Ok(format)) = (reader.format(), ImageFormat::from_path(name)) {
        reader.set_format(format);
    }
    let mut limits = Limits::default();
    // Eight bytes for each pixel, and what a decoder needs beside.
    limits.max_alloc = Some(12 * Image::MAX_PIXELS);
    reader.limits(limits);
    let decoder = reader.into_decoder()?;
    let (width, height) = decoder.dimensions();
    if u64::from(width) * u64::from(height) > Image::MAX_PIXELS {
        return Ok(Err((width, height)));
    }
    DynamicImage::from_decoder(decoder).map(Ok)
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::{DynamicImage, ImageBuffer};

    fn file(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        image.write_to(&mut bytes, format).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn files_of_all_kinds_are_read() {
        // Three columns, two rows: no symmetry that could hide a flip.
        let color = |x: u32, y: u32| [10 + 50 * x as u8, 20 + 90 * y as u8, 200];
        let image = DynamicImage::ImageRgb8(ImageBuffer::from_fn(3, 2, |x, y| image::Rgb(color(x, y))));
        for (format, name) in [
            (ImageFormat::Png, "a.png"),
            // The bytes count, not the name.
            (ImageFormat::Png, "a.jpg"),
            (ImageFormat::Bmp, "a.bmp"),
            (ImageFormat::Tga, "a.tga"),
        ] {
            let found = Image::decode(name, &file(&image, format)).unwrap();
            assert_eq!((found.width(), found.height(), found.name()), (3, 2, name));
            for (index, &pixel) in found.pixels().iter().enumerate() {
                let [red, green, blue] = color(index as u32 % 3, index as u32 / 3);
                assert_eq!(pixel, [red, green, blue, 255], "{name}");
            }
        }
        let even = DynamicImage::ImageRgb8(ImageBuffer::from_pixel(16, 8, image::Rgb([200, 100, 50])));
        let jpeg = Image::decode("a.jpeg", &file(&even, ImageFormat::Jpeg)).unwrap();
        let [red, green, blue, alpha] = jpeg.pixels()[77];
        assert!(red.abs_diff(200) < 4 && green.abs_diff(100) < 4 && blue.abs_diff(50) < 4 && alpha == 255);
    }

    #[test]
    fn grey_alpha_and_sixteen_bits_become_eight_bits_of_each() {
        let first = |image: DynamicImage| {
            Image::decode("a.png", &file(&image, ImageFormat::Png)).unwrap().pixels()[0]
        };
        let grey = ImageBuffer::from_pixel(2, 2, image::Luma([77]));
        assert_eq!(first(DynamicImage::ImageLuma8(grey)), [77, 77, 77, 255]);
        let grey_alpha = ImageBuffer::from_pixel(2, 2, image::LumaA([77, 9]));
        assert_eq!(first(DynamicImage::ImageLumaA8(grey_alpha)), [77, 77, 77, 9]);
        let deep = ImageBuffer::from_pixel(2, 2, image::Rgba([257, 2 * 257, 65_535, 128 * 257]));
        assert_eq!(first(DynamicImage::ImageRgba16(deep)), [1, 2, 255, 128]);
        let deep = ImageBuffer::from_pixel(2, 2, image::Luma([40 * 257]));
        assert_eq!(first(DynamicImage::ImageLuma16(deep)), [40, 40, 40, 255]);
    }

    #[test]
    fn damaged_files_are_errors_that_name_the_file() {
        let image =
            DynamicImage::ImageRgb8(ImageBuffer::from_fn(9, 7, |x, y| image::Rgb([x as u8, y as u8, 3])));
        for format in [ImageFormat::Png, ImageFormat::Bmp, ImageFormat::Tga, ImageFormat::Jpeg] {
            let bytes = file(&image, format);
            for length in 0..bytes.len() {
                // A picture with its end missing may be one all the same, but nothing panics.
                let _ = Image::decode("cut.tga", &bytes[..length]);
            }
            for at in 0..bytes.len() {
                let mut damaged = bytes.clone();
                damaged[at] ^= 0xff;
                let _ = Image::decode("damaged.tga", &damaged);
            }
        }
        for bytes in [&b""[..], b"no picture", b"\x89PNG\r\n\x1a\n"] {
            let error = Image::decode("bark.png", bytes).unwrap_err().to_string();
            assert!(error.contains("bark.png") && error.contains("PNG, JPEG, BMP or TGA"), "{error}");
        }
    }

    #[test]
    fn images_too_large_to_hold_are_refused_by_their_size() {
        // The head of a BMP of 100,000 × 100,000 pixels with nothing behind it.
        let mut bytes = file(&DynamicImage::new_rgb8(1, 1), ImageFormat::Bmp);
        bytes[18..26].copy_from_slice(&[100_000u32.to_le_bytes(), 100_000u32.to_le_bytes()].concat());
        let error = Image::decode("huge.bmp", &bytes).unwrap_err().to_string();
        assert!(error.contains("huge.bmp"), "{error}");
        // As many pixels as are allowed, but with nothing behind the head they are not there.
        bytes[18..26].copy_from_slice(&[16_384u32.to_le_bytes(), 8_193u32.to_le_bytes()].concat());
        let error = Image::decode("large.bmp", &bytes).unwrap_err().to_string();
        assert!(error.contains("16384 × 8193"), "{error}");
    }

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
