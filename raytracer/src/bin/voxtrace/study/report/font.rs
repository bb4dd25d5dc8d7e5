//! Letters of bitmaps, from a font that is part of the program, so a machine needs none.
//!
//! It is Ubuntu Light (Ubuntu Font Licence 1.0). The width of its letters also serves to find room for
//! labels in the page, whose font is the reader's.

use ab_glyph::{Font, FontRef, PxScaleFont, ScaleFont};
use anyhow::Context;
use epaint_default_fonts::UBUNTU_LIGHT;

/// Letters of a height.
pub struct Letters {
    font: PxScaleFont<FontRef<'static>>,
    /// Half the height of capital letters.
    middle: f64,
}

/// Half the height of capital letters, as a part of the em square.
const MIDDLE: f64 = 0.347;

impl Letters {
    /// Of a nominal height in pixels as CSS means it, the side of the em square.
    ///
    /// # Errors
    /// If the font is none.
    pub fn of_height(height: f64) -> anyhow::Result<Self> {
        let font = FontRef::try_from_slice(UBUNTU_LIGHT).context("the font of the plots")?;
        let units = font.units_per_em().context("the font of the plots")?;
        // What the crate calls a height is that from the lowest to the highest letter.
        let scale = height as f32 * font.height_unscaled() / units;
        Ok(Self { font: font.into_scaled(scale), middle: MIDDLE * height })
    }

    /// Width of a line in pixels.
    pub fn width(&self, text: &str) -> f64 {
        self.place(text).1
    }

    /// Calls `draw` with column, row and coverage of the pixels that a text touches, from the left end of
    /// the middle of its height, which is half a capital letter above the line.
    pub fn draw(&self, text: &str, mut draw: impl FnMut(f64, f64, f32)) {
        for (glyph, left) in self.place(text).0 {
            let mut glyph = self.font.scaled_glyph(glyph);
            glyph.position.x = left as f32;
            if let Some(outline) = self.font.outline_glyph(glyph) {
                let bounds = outline.px_bounds();
                let (x, y) = (f64::from(bounds.min.x), f64::from(bounds.min.y) + self.middle);
                outline
                    .draw(|column, row, coverage| draw(x + f64::from(column), y + f64::from(row), coverage));
            }
        }
    }

    /// Characters with the place of each, and the width of all.
    fn place(&self, text: &str) -> (Vec<(char, f64)>, f64) {
        let mut left = 0.0;
        let mut last = None;
        let mut placed = Vec::new();
        for character in text.chars() {
            // The font lacks the raised minus; a macron looks much like it.
            let character = if character == '⁻' { '¯' } else { character };
            let glyph = self.font.glyph_id(character);
            left += last.map_or(0.0, |last| f64::from(self.font.kern(last, glyph)));
            placed.push((character, left));
            left += f64::from(self.font.h_advance(glyph));
            last = Some(glyph);
        }
        (placed, left)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_are_as_high_as_asked_for() {
        let letters = Letters::of_height(100.0).unwrap();
        let mut rows = (f64::INFINITY, f64::NEG_INFINITY);
        letters.draw("H", |_, row, coverage| {
            if coverage > 0.5 {
                rows = (rows.0.min(row), rows.1.max(row));
            }
        });
        // Capital letters of this font are 0.693 em high, and stand in the middle.
        assert!((rows.1 - rows.0 - 69.3).abs() < 2.0, "{rows:?}");
        assert!((rows.0 + rows.1).abs() < 8.0, "{rows:?}");
    }

    #[test]
    fn every_character_of_figures_is_in_the_font() {
        let font = FontRef::try_from_slice(UBUNTU_LIGHT).unwrap();
        for character in "0123456789.,−–×µ⁰¹²³⁴⁵⁶⁷⁸⁹¯³ü∞ ".chars() {
            assert_ne!(font.glyph_id(character).0, 0, "{character}");
        }
    }
}
