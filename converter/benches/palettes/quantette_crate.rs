//! Palettes of the crate `quantette`, in Oklab.

use crate::Colors;
use quantette::deps::palette::Srgb;
use quantette::{PaletteSize, Pipeline, QuantizeMethod};

/// Wu's cut.
pub fn wu(colors: &Colors, size: u16) -> Vec<[u8; 3]> {
    run(colors, size, QuantizeMethod::Wu)
}

/// Wu's cut and mini-batches of k-means.
pub fn kmeans(colors: &Colors, size: u16) -> Vec<[u8; 3]> {
    run(colors, size, QuantizeMethod::kmeans())
}

fn run(colors: &Colors, size: u16, method: QuantizeMethod) -> Vec<[u8; 3]> {
    // It takes pixels, not counts.
    let pixels: Vec<Srgb<u8>> = colors
        .colors
        .iter()
        .zip(&colors.counts)
        .flat_map(|(&[red, green, blue], &count)| {
            std::iter::repeat_n(Srgb::new(red, green, blue), count as usize)
        })
        .collect();
    let pipeline = Pipeline::new()
        .palette_size(PaletteSize::from_u16_clamped(size))
        .quantize_method(method)
        .parallel(true);
    match pipeline.input_slice(&pixels) {
        Ok(input) => {
            input.output_srgb8_palette().iter().map(|color| [color.red, color.green, color.blue]).collect()
        }
        Err(error) => panic!("quantette refuses {} colours: {error}", pixels.len()),
    }
}
