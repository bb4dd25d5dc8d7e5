//! An image at ever coarser resolutions (Williams 1983, "Pyramidal Parametrics").
//!
//! Each level has half the width and height of the one before, rounded down, to a single texel at the end. A texel is the
//! mean of the area of the finer level that it covers: of 2 × 2 texels, and where a size is odd of three texels along that
//! axis, the outer ones in part. So every texel of the image weighs the same in every level.
//!
//! Means are those of light, not of displayed values. Where alpha says what is surface, colours weigh as much as there is
//! surface, so that the colour behind a hole does not bleed into the rim.

use crate::Image;
use crate::color_space::to_linear;
use rayon::prelude::*;

/// What the red, green and blue of an image stand for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Encoding {
    /// A displayed colour (sRGB).
    Color,
    /// Numbers: a direction, a height, an opacity.
    Numbers,
}

/// Red, green, blue (linear) and alpha, each from 0 to 65,535.
pub(crate) type Texel = [u16; 4];

/// An image and its coarser levels.
#[derive(Debug)]
pub(crate) struct Pyramid<'a> {
    image: &'a Image,
    encoding: Encoding,
    /// Whether colours weigh as much as their alpha.
    pub weighted: bool,
    /// The levels from 1 on; level 0 is the image itself.
    levels: Vec<Level>,
}

#[derive(Debug)]
struct Level {
    width: u32,
    height: u32,
    texels: Vec<Texel>,
}

impl<'a> Pyramid<'a> {
    pub(crate) fn new(image: &'a Image, encoding: Encoding, weighted: bool) -> Self {
        let mut pyramid = Self { image, encoding, weighted, levels: Vec::new() };
        while pyramid.size(pyramid.last_level()) != [1, 1] {
            let level = pyramid.next_level();
            pyramid.levels.push(level);
        }
        pyramid
    }

    /// The coarsest level, a single texel.
    pub(crate) fn last_level(&self) -> usize {
        self.levels.len()
    }

    /// Width and height of a level, in texels.
    #[inline]
    pub(crate) fn size(&self, level: usize) -> [u32; 2] {
        match level.checked_sub(1) {
            None => [self.image.width(), self.image.height()],
            Some(coarser) => [self.levels[coarser].width, self.levels[coarser].height],
        }
    }

    /// The texel in a column, counted from the left, and a row, counted from the top.
    #[inline]
    pub(crate) fn texel(&self, level: usize, column: u32, row: u32) -> Texel {
        match level.checked_sub(1) {
            None => {
                let pixel = self.image.pixels()[row as usize * self.image.width() as usize + column as usize];
                self.decode(pixel)
            }
            Some(coarser) => {
                let level = &self.levels[coarser];
                level.texels[row as usize * level.width as usize + column as usize]
            }
        }
    }

    #[inline]
    fn decode(&self, [red, green, blue, alpha]: [u8; 4]) -> Texel {
        let number = |byte: u8| u16::from(byte) * 257;
        let [red, green, blue] = match self.encoding {
            Encoding::Color => to_linear([red, green, blue]),
            Encoding::Numbers => [red, green, blue].map(number),
        };
        [red, green, blue, number(alpha)]
    }

    /// How much of a texel's colour counts: all of it where nothing is surface, so that there is always a colour.
    #[inline]
    pub(crate) fn weight(&self, alpha: u16) -> u32 {
        if self.weighted { u32::from(alpha) + 1 } else { 1 }
    }

    fn next_level(&self) -> Level {
        let finer = self.last_level();
        let [width, height] = self.size(finer);
        let coarser = [width, height].map(|size| (size / 2).max(1));
        let mut texels = vec![[0; 4]; coarser[0] as usize * coarser[1] as usize];
        texels.par_chunks_mut(coarser[0] as usize).enumerate().for_each(|(row, texels)| {
            let rows = Taps::new(row as u32, height);
            for (column, texel) in texels.iter_mut().enumerate() {
                *texel = self.mean(finer, Taps::new(column as u32, width), rows);
            }
        });
        Level { width: coarser[0], height: coarser[1], texels }
    }

    /// The mean of the texels of a level under these taps.
    fn mean(&self, level: usize, columns: Taps, rows: Taps) -> Texel {
        // Products of taps sum up to no more than the number of pixels (or 4); weights and values have 32 bits together.
        let (mut colors, mut weights, mut alphas, mut area) = ([0u64; 3], 0u64, 0u64, 0u64);
        for (row, tall) in rows.iter() {
            for (column, wide) in columns.iter() {
                let [red, green, blue, alpha] = self.texel(level, column, row);
                let covered = u64::from(wide) * u64::from(tall);
                let weight = covered * u64::from(self.weight(alpha));
                for (sum, value) in colors.iter_mut().zip([red, green, blue]) {
                    *sum += weight * u64::from(value);
                }
                weights += weight;
                alphas += covered * u64::from(alpha);
                area += covered;
            }
        }
        let [red, green, blue] = colors.map(|sum| rounded_quotient(sum, weights));
        [red, green, blue, rounded_quotient(alphas, area)]
    }
}

fn rounded_quotient(sum: u64, weights: u64) -> u16 {
    ((sum + weights / 2) / weights) as u16
}

/// The texels of the finer level that a texel covers along an axis, and how much of each.
#[derive(Debug, Clone, Copy)]
struct Taps {
    first: u32,
    /// In units that make all of them integers; 0 for a texel that is not covered.
    weights: [u32; 3],
}

impl Taps {
    /// For the texel at `index`, where the finer level has `size` texels.
    fn new(index: u32, size: u32) -> Self {
        let coarser = size / 2;
        let weights = if size == 1 {
            [1, 0, 0]
        } else if size.is_multiple_of(2) {
            [1, 1, 0]
        } else {
            // The texel covers (2 + 1/m) texels from (2 + 1/m) · index on, where m is the coarser size.
            [coarser - index, coarser, index + 1]
        };
        Self { first: 2 * index, weights }
    }

    fn iter(self) -> impl Iterator<Item = (u32, u32)> {
        (self.first..).zip(self.weights).filter(|&(_, weight)| weight > 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn grey(width: u32, height: u32, value: impl Fn(u32, u32) -> u8) -> Image {
        let pixels = (0..height)
            .flat_map(|row| (0..width).map(move |column| (column, row)))
            .map(|(column, row)| {
                let value = value(column, row);
                [value, value, value, 255]
            })
            .collect();
        Image::new("grey", width, height, pixels).unwrap()
    }

    #[test]
    fn sizes_are_halved_down_to_a_single_texel() {
        let image = grey(13, 4, |_, _| 7);
        let pyramid = Pyramid::new(&image, Encoding::Numbers, false);
        let sizes: Vec<[u32; 2]> = (0..=pyramid.last_level()).map(|level| pyramid.size(level)).collect();
        assert_eq!(sizes, [[13, 4], [6, 2], [3, 1], [1, 1]]);
    }

    #[test]
    fn texels_of_odd_sizes_cover_parts() {
        // Five texels into two: each covers two and a half.
        let image = grey(5, 1, |column, _| [0, 50, 100, 200, 250][column as usize]);
        let pyramid = Pyramid::new(&image, Encoding::Numbers, false);
        let value = |column| f64::from(pyramid.texel(1, column, 0)[0]) / 257.0;
        assert!((value(0) - (0.0 + 50.0 + 100.0 / 2.0) / 2.5).abs() < 0.01);
        assert!((value(1) - (100.0 / 2.0 + 200.0 + 250.0) / 2.5).abs() < 0.01);
    }

    #[test]
    fn black_and_white_are_half_the_light() {
        let image = grey(2, 2, |column, _| if column == 0 { 0 } else { 255 });
        let light = |encoding| Pyramid::new(&image, encoding, false).texel(1, 0, 0)[0];
        assert!(light(Encoding::Color).abs_diff(32_768) <= 1);
        assert!(light(Encoding::Numbers).abs_diff(32_768) <= 1);
        // Medium grey tells them apart: it is displayed half as bright as white, with a fifth of the light.
        let image = grey(2, 1, |_, _| 128);
        let light = |encoding| f64::from(Pyramid::new(&image, encoding, false).texel(1, 0, 0)[0]) / 65_535.0;
        assert!((light(Encoding::Color) - 0.2158).abs() < 1e-3);
        assert!((light(Encoding::Numbers) - 128.0 / 255.0).abs() < 1e-4);
    }

    #[test]
    fn the_color_of_holes_does_not_bleed() {
        let pixels = vec![[200, 100, 50, 255], [0, 255, 0, 0], [0, 255, 0, 0], [200, 100, 50, 255]];
        let image = Image::new("leaf", 2, 2, pixels).unwrap();
        let leaf = Pyramid::new(&image, Encoding::Numbers, true).texel(1, 0, 0);
        for (channel, expected) in [(0, 200), (1, 100), (2, 50)] {
            assert!(leaf[channel].abs_diff(expected * 257) <= 3, "{leaf:?}");
        }
        assert!(leaf[3].abs_diff(32_768) <= 1);
        // Where alpha means something else, all colours count.
        assert!(Pyramid::new(&image, Encoding::Numbers, false).texel(1, 0, 0)[1].abs_diff(45_618) <= 1);
        // Nothing but holes: they have a colour all the same.
        let image = Image::new("air", 2, 1, vec![[10, 20, 30, 0], [30, 20, 10, 0]]).unwrap();
        assert_eq!(Pyramid::new(&image, Encoding::Numbers, true).texel(1, 0, 0), [5140, 5140, 5140, 0]);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(60))]

        #[test]
        fn the_last_level_is_the_mean_of_the_image(width in 1u32..40, height in 1u32..40, seed in any::<u64>()) {
            let random = |column: u32, row: u32| {
                let mixed = (u64::from(column) << 32 | u64::from(row)).wrapping_add(seed).wrapping_mul(0x9e37_79b9_7f4a_7c15);
                (mixed >> 56) as u8
            };
            let image = grey(width, height, random);
            let mean = image.pixels().iter().map(|pixel| f64::from(pixel[0])).sum::<f64>() / f64::from(width * height);
            let pyramid = Pyramid::new(&image, Encoding::Numbers, false);
            let found = f64::from(pyramid.texel(pyramid.last_level(), 0, 0)[0]) / 257.0;
            // Each level rounds by half a step of 1/257.
            prop_assert!((found - mean).abs() < 6.0 * 0.5 / 257.0, "{found} {mean}");
        }
    }
}
