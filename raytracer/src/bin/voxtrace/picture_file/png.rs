//! PNG: red, green, blue and opacity, eight bits each.

use super::{Content, Picture, checked_size};
use anyhow::ensure;
use image::codecs::png::{PngDecoder, PngEncoder};
use image::{ColorType, DynamicImage, ExtendedColorType, ImageDecoder, ImageEncoder, Limits};
use std::fs::File;
use std::io::{BufReader, Write};

pub fn write(out: impl Write, [width, height]: [u32; 2], pixels: &[[u8; 4]]) -> anyhow::Result<()> {
    let encoder = PngEncoder::new(out);
    encoder.write_image(pixels.as_flattened(), width, height, ExtendedColorType::Rgba8)?;
    Ok(())
}

/// # Errors
/// If the file is no PNG, or one whose numbers do not fit eight bits.
pub fn read(file: File) -> anyhow::Result<Picture> {
    let decoder = PngDecoder::with_limits(BufReader::new(file), Limits::default())?;
    let (width, height) = decoder.dimensions();
    let size = checked_size(width.into(), height.into())?;
    let color = decoder.color_type();
    let fits = matches!(color, ColorType::L8 | ColorType::La8 | ColorType::Rgb8 | ColorType::Rgba8);
    ensure!(fits, "it has 16 bits a channel, expected 8");
    let bytes = DynamicImage::from_decoder(decoder)?.into_rgba8().into_raw();
    Ok(Picture { size, content: Content::Displayed(bytes.as_chunks().0.to_vec()) })
}
