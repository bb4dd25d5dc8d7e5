//! What a voxel sees of a texture.
//!
//! The mean over the voxel's footprint, an ellipse in the image, is taken with a few probes side by side along its length,
//! each the size of its width (McCormack et al. 1999, "Feline"). A probe is interpolated within two levels of the image's
//! pyramid and between them. So a texture that is squeezed along one axis is blurred along that one only. Where a voxel is
//! smaller than a texel, the probe is the interpolated image itself.
//!
//! All arithmetic is additions, products, quotients and square roots in a fixed order, which are the same everywhere.

use super::footprint::Gradients;
use super::pyramid::Pyramid;
use crate::texture_map::{Channel, TextureMap, Wrap};

/// Most probes for a sample. Beyond this elongation the texture is blurred along its narrow axis as well.
const MAX_PROBES: f64 = 16.0;

/// A texture map on a triangle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lookup<'a> {
    pyramid: &'a Pyramid<'a>,
    map: &'a TextureMap,
    probes: u32,
    /// From the first probe to the last, in widths and heights of the image.
    probe_line: [f64; 2],
    /// The finer of the two levels, and how far the size of a probe is towards the next one.
    level: usize,
    towards_next: f32,
    /// Width of a probe, in widths and heights of the image.
    pub probe_size: [f64; 2],
}

/// Red, green, blue (as light, or as numbers) and alpha, from 0 to 1 as long as the map has no gain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Seen {
    pub color: [f32; 3],
    alpha: f32,
    channel: Channel,
}

impl<'a> Lookup<'a> {
    /// The map as a voxel sees it on a triangle with these gradients of its texture coordinates.
    pub(crate) fn new(pyramid: &'a Pyramid<'a>, map: &'a TextureMap, gradients: &Gradients) -> Self {
        let size = pyramid.size(0).map(f64::from);
        let texels = [0, 1].map(|k| f64::from(map.scale[k]) * size[k]);
        let footprint = gradients.footprint(texels);
        let probes = (footprint.major / footprint.minor.max(1.0)).round().clamp(1.0, MAX_PROBES);
        let probe = (footprint.major / probes).max(1.0);
        // Evenly along the major axis, the outer ones half a probe from its ends.
        let reach = footprint.major - footprint.major / probes;
        let (level, towards_next) = level_of(probe, pyramid.last_level());
        Self {
            pyramid,
            map,
            probes: probes as u32,
            probe_line: [0, 1].map(|k| footprint.direction[k] * reach / size[k]),
            level,
            towards_next,
            probe_size: size.map(|size| probe / size),
        }
    }

    /// Widths and heights of the image to a unit of the texture coordinates.
    pub(crate) fn scale(&self) -> [f32; 2] {
        self.map.scale
    }

    /// What a voxel sees around these texture coordinates.
    #[inline]
    pub(crate) fn see(&self, coordinates: [f64; 2]) -> Seen {
        self.see_beside(coordinates, [0.0; 2])
    }

    /// What it sees beside them, in widths and heights of the image.
    pub(crate) fn see_beside(&self, coordinates: [f64; 2], shift: [f64; 2]) -> Seen {
        let map = self.map;
        let center = [0, 1]
            .map(|k| f64::from(map.offset[k]) + f64::from(map.scale[k]) * coordinates[k] + shift[k])
            .map(|place| if place.is_finite() { place } else { 0.0 });
        let mut sum = WeightedSum::default();
        for probe in 0..self.probes {
            let along =
                if self.probes == 1 { 0.0 } else { f64::from(probe) / f64::from(self.probes - 1) - 0.5 };
            let place = [0, 1].map(|k| center[k] + along * self.probe_line[k]);
            self.add_level(self.level, place, 1.0 - self.towards_next, &mut sum);
            if self.towards_next > 0.0 {
                self.add_level(self.level + 1, place, self.towards_next, &mut sum);
            }
        }
        sum.mean(map)
    }

    /// Adds the four texels around a place, weighted by how near they are.
    fn add_level(&self, level: usize, [right, up]: [f64; 2], weight: f32, sum: &mut WeightedSum) {
        let [width, height] = self.pyramid.size(level);
        let columns = Neighbors::new(right, width, self.map.wrap[0]);
        // Rows are counted from the top.
        let rows = Neighbors::new(up, height, self.map.wrap[1]);
        for (row, near_row) in rows.with_weights() {
            for (column, near_column) in columns.with_weights() {
                let [red, green, blue, alpha] = self.pyramid.texel(level, column, height - 1 - row);
                let area = weight * near_row * near_column;
                sum.add([red, green, blue], alpha, area, area * self.pyramid.weight(alpha) as f32);
            }
        }
    }
}

/// The level of the pyramid whose texels are as large as a probe, and how far the probe is towards the next level.
fn level_of(probe: f64, last: usize) -> (usize, f32) {
    // A probe is at least 1, so its exponent as a number is the logarithm rounded down; between two levels it is taken as
    // linear.
    let exponent = (probe.to_bits() >> 52) as usize - 1023;
    if exponent >= last {
        return (last, 0.0);
    }
    (exponent, (probe / (1u64 << exponent) as f64 - 1.0) as f32)
}

/// The two texels on either side of a place along an axis.
#[derive(Debug, Clone, Copy)]
struct Neighbors {
    indices: [u32; 2],
    towards_second: f32,
}

impl Neighbors {
    /// At `place`, in sizes of the image.
    fn new(place: f64, size: u32, wrap: Wrap) -> Self {
        let place = match wrap {
            Wrap::Repeat => place - place.floor(),
            Wrap::Clamp => place.clamp(0.0, 1.0),
            Wrap::Mirror => place - 2.0 * (place / 2.0).floor(),
        };
        // Texel k has its centre at k + 1/2.
        let texels = place * f64::from(size) - 0.5;
        let first = texels.floor();
        let (size, index) = (i64::from(size), first as i64);
        let indices = [index, index + 1].map(|index| match wrap {
            Wrap::Repeat => index.rem_euclid(size),
            Wrap::Clamp => index.clamp(0, size - 1),
            Wrap::Mirror => {
                let index = index.rem_euclid(2 * size);
                index.min(2 * size - 1 - index)
            }
        });
        Self { indices: indices.map(|index| index as u32), towards_second: (texels - first) as f32 }
    }

    fn with_weights(self) -> [(u32, f32); 2] {
        [(self.indices[0], 1.0 - self.towards_second), (self.indices[1], self.towards_second)]
    }
}

#[derive(Debug, Default)]
struct WeightedSum {
    colors: [f32; 3],
    color_weight: f32,
    alpha: f32,
    area: f32,
}

impl WeightedSum {
    #[inline]
    fn add(&mut self, color: [u16; 3], alpha: u16, area: f32, color_weight: f32) {
        for (sum, value) in self.colors.iter_mut().zip(color) {
            *sum += color_weight * f32::from(value);
        }
        self.color_weight += color_weight;
        self.alpha += area * f32::from(alpha);
        self.area += area;
    }

    fn mean(&self, map: &TextureMap) -> Seen {
        let adjusted = |mean: f32| map.base + map.gain * (mean / 65_535.0);
        Seen {
            color: self.colors.map(|sum| adjusted(sum / self.color_weight)),
            alpha: adjusted(self.alpha / self.area),
            channel: map.channel,
        }
    }
}

impl Seen {
    /// As three values: those of the map's channel, three times if it is a single one.
    pub(crate) fn color(&self) -> [f32; 3] {
        match self.channel {
            Channel::Color => self.color,
            _ => [self.number(); 3],
        }
    }

    /// As one value: that of the map's channel, and brightness if it has three.
    pub(crate) fn number(&self) -> f32 {
        let [red, green, blue] = self.color;
        match self.channel {
            Channel::Red => red,
            Channel::Green => green,
            Channel::Blue => blue,
            Channel::Alpha => self.alpha,
            // Weights of the primaries of sRGB (ITU-R BT.709).
            Channel::Color | Channel::Luminance => 0.2126 * red + 0.7152 * green + 0.0722 * blue,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Image;
    use crate::texture::pyramid::Encoding;

    /// Columns count up in red, rows (from the top) in green.
    fn counted(width: u32, height: u32) -> Image {
        let pixels = (0..height)
            .flat_map(|row| (0..width).map(move |column| [column as u8 * 10, row as u8 * 10, 0, 255]))
            .collect();
        Image::new("counted", width, height, pixels).unwrap()
    }

    /// Red and green at a place, of an image and a map, as the numbers that [`counted`] wrote.
    fn seen(image: &Image, map: &TextureMap, place: [f64; 2]) -> [f32; 2] {
        let pyramid = Pyramid::new(image, Encoding::Numbers, false);
        let [red, green, _] = Lookup::new(&pyramid, map, &Gradients::STILL).see(place).color();
        [red * 25.5, green * 25.5]
    }

    fn close(found: [f32; 2], expected: [f32; 2]) -> bool {
        (0..2).all(|k| (found[k] - expected[k]).abs() < 1e-3)
    }

    #[test]
    fn v_goes_up_from_the_bottom_row() {
        let (image, map) = (counted(4, 8), TextureMap::new(0));
        for (place, expected) in [
            ([0.125, 0.0625], [0.0, 7.0]),
            ([0.875, 0.0625], [3.0, 7.0]),
            ([0.125, 0.9375], [0.0, 0.0]),
            ([0.25, 0.5], [0.5, 3.5]),
            ([0.375, 0.25], [1.0, 5.5]),
        ] {
            assert!(close(seen(&image, &map, place), expected), "{place:?}");
        }
    }

    #[test]
    fn beyond_the_edges() {
        let image = counted(4, 1);
        let at = |wrap, u: f64| {
            let map = TextureMap { wrap: [wrap; 2], ..TextureMap::new(0) };
            seen(&image, &map, [u, 0.3])[0]
        };
        // Centres of texels, from −1 to 2 times the width.
        let row =
            |wrap| (-4..8).map(|k| at(wrap, (f64::from(k) + 0.5) / 4.0).round() as i32).collect::<Vec<_>>();
        assert_eq!(row(Wrap::Repeat), [0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3]);
        assert_eq!(row(Wrap::Clamp), [0, 0, 0, 0, 0, 1, 2, 3, 3, 3, 3, 3]);
        assert_eq!(row(Wrap::Mirror), [3, 2, 1, 0, 0, 1, 2, 3, 3, 2, 1, 0]);
        // On the edge itself: between the outermost texels of both sides, or on one.
        for (wrap, expected) in [(Wrap::Repeat, 1.5), (Wrap::Clamp, 0.0), (Wrap::Mirror, 0.0)] {
            for u in [0.0, -1e-18] {
                assert!((at(wrap, u) - expected).abs() < 1e-3, "{wrap:?}");
            }
        }
        for (wrap, expected) in [(Wrap::Repeat, 1.5), (Wrap::Clamp, 3.0), (Wrap::Mirror, 3.0)] {
            assert!((at(wrap, 1.0) - expected).abs() < 1e-3, "{wrap:?}");
        }
        // No place at all is a place like any other.
        for u in [f64::NAN, f64::INFINITY, 1e300, -1e300] {
            for wrap in [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror] {
                assert!((0.0..=3.0).contains(&at(wrap, u)));
            }
        }
    }

    #[test]
    fn offset_scale_gain_and_channel() {
        let image = counted(4, 4);
        let map = TextureMap { offset: [0.25, 0.5], scale: [2.0, 1.0], ..TextureMap::new(0) };
        assert!(close(seen(&image, &map, [0.0625, 0.125]), [1.0, 1.0]));
        let map = TextureMap { base: 0.5, gain: -1.0, ..TextureMap::new(0) };
        assert!(close(seen(&image, &map, [0.375, 0.875]), [12.75 - 1.0, 12.75]));

        let image = Image::new("one", 1, 1, vec![[10, 20, 30, 40]]).unwrap();
        let pyramid = Pyramid::new(&image, Encoding::Numbers, false);
        for (channel, expected) in [
            (Channel::Red, 10.0),
            (Channel::Green, 20.0),
            (Channel::Blue, 30.0),
            (Channel::Alpha, 40.0),
            (Channel::Luminance, 0.2126 * 10.0 + 0.7152 * 20.0 + 0.0722 * 30.0),
        ] {
            let map = TextureMap { channel, ..TextureMap::new(0) };
            let seen = Lookup::new(&pyramid, &map, &Gradients::STILL).see([0.5; 2]);
            assert!((seen.number() * 255.0 - expected).abs() < 1e-3, "{channel:?}");
            assert_eq!(seen.color(), [seen.number(); 3]);
        }
    }

    #[test]
    fn the_level_has_texels_of_the_size_of_a_probe() {
        assert_eq!(level_of(1.0, 5), (0, 0.0));
        assert_eq!(level_of(1.5, 5), (0, 0.5));
        assert_eq!(level_of(2.0, 5), (1, 0.0));
        assert_eq!(level_of(12.0, 5), (3, 0.5));
        for probe in [32.0, 40.0, 1e300, f64::MAX] {
            assert_eq!(level_of(probe, 5), (5, 0.0));
        }
        assert_eq!(level_of(7.0, 0), (0, 0.0));
    }

    #[test]
    fn a_squeezed_texture_is_blurred_along_one_axis_only() {
        // Stripes across u that a voxel sees sixteen texels of, and along v one.
        let pixels = |stripe: fn(u32, u32) -> u32| {
            let pixels = (0..64u32)
                .flat_map(|row| (0..64).map(move |column| stripe(row, column)))
                .map(|on| [255 * on as u8; 4]);
            Image::new("stripes", 64, 64, pixels.collect()).unwrap()
        };
        let gradients = Gradients([[16.0 / 64.0, 0.0, 0.0], [0.0, 1.0 / 64.0, 0.0]]);
        let (upright, level) = (pixels(|_, column| column % 2), pixels(|row, _| row % 2));
        let map = TextureMap::new(0);
        let value = |image: &Image, place| {
            let pyramid = Pyramid::new(image, Encoding::Numbers, false);
            Lookup::new(&pyramid, &map, &gradients).see(place).color[0]
        };
        for row in 0..64 {
            let place = [0.37, (f64::from(row) + 0.5) / 64.0];
            assert!((value(&upright, place) - 0.5).abs() < 1e-4);
            // Rows from the top: the bottom one, 63, is white.
            assert!((value(&level, place) - ((63 - row) % 2) as f32).abs() < 1e-4);
        }
    }
}
