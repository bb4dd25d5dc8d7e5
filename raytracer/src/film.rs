//! What the rays of a picture have brought, pixel by pixel, and which pixels need more of them.

use crate::color::{Display, Light3};
use crate::frame::{FirstHit, Frame};
use crate::quality::Quality;
use crate::tile::{TILE_PIXELS, TILE_SIZE, Tile, tiles};
use crate::tone::Tone;
use glam::Vec3;
use rayon::prelude::*;
use std::ops::Range;

/// What the rays through a pixel have brought.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct PixelSum {
    light: Light3,
    /// Sum of how bright each ray is displayed, from 0 to 1, and of the squares of that.
    shown: f32,
    shown_squared: f32,
    /// Number of rays.
    pub rays: u32,
    is_hit: bool,
}

/// A picture in the making. Pixels stand tile by tile, whole ones also where the picture ends within them, so that each tile
/// is written by one thread alone.
pub(crate) struct Film {
    size: [u32; 2],
    region: Region,
    /// The tiles that are rendered: those in which a pixel is part of the region, or next to one that is and looked at to tell
    /// whether that needs more rays.
    tiles: Vec<Tile>,
    /// For each tile of the picture, row by row, its place among them; of others anything.
    places: Vec<u32>,
    /// What rays have brought to each pixel, kept while there may be more of them.
    sums: Option<Vec<PixelSum>>,
    /// As displayed.
    shown: Vec<[u8; 4]>,
    light: Option<Vec<Light3>>,
    first_hits: Option<Vec<FirstHit>>,
    /// For each tile, its pixels in the region of which a ray met something.
    hit_pixels: Vec<u32>,
    tone: Tone,
}

/// What a film keeps of each pixel besides how it is displayed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Keeping {
    /// What its rays have brought, so that there may be more of them; else each tile is developed as soon as it has its rays,
    /// while they are at hand.
    pub sums: bool,
    pub light: bool,
    pub first_hits: bool,
}

/// A tile of the film, to be written to. Lists are those of a whole tile, row by row, or empty if they are not kept.
pub(crate) struct TilePart<'f> {
    pub tile: Tile,
    pub sums: Option<&'f mut [PixelSum]>,
    pub first_hits: &'f mut [FirstHit],
    pub picture: TilePicture<'f>,
}

/// The picture of a tile.
pub(crate) struct TilePicture<'f> {
    shown: &'f mut [[u8; 4]],
    light: &'f mut [Light3],
    hit_pixels: &'f mut u32,
    region: Region,
    tone: &'f Tone,
}

impl TilePicture<'_> {
    /// Makes it from what rays have brought.
    pub fn develop(self, tile: &Tile, sums: &[PixelSum]) {
        let display = Display::shared();
        let means = sums.iter().map(PixelSum::mean);
        // Pixels side by side often show the same background.
        let mut last = (Vec3::ZERO, display.pixel(self.tone.apply(Vec3::ZERO)));
        for (shown, mean) in self.shown.iter_mut().zip(means.clone()) {
            if mean != last.0 {
                last = (mean, display.pixel(self.tone.apply(mean)));
            }
            *shown = last.1;
        }
        for (light, mean) in self.light.iter_mut().zip(means) {
            *light = mean;
        }
        let is_seen = |place: u32| {
            let is_within = place % TILE_SIZE < tile.width && place / TILE_SIZE < tile.height;
            is_within && self.region.contains(tile.pixel(place))
        };
        let hits = (0..).zip(sums).filter(|&(place, sum)| sum.is_hit && is_seen(place));
        *self.hit_pixels = hits.count() as u32;
    }
}

/// A rectangle of pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Region {
    /// Column and row of the upper left pixel.
    pub corner: [u32; 2],
    /// Columns and rows.
    pub size: [u32; 2],
}

impl Region {
    /// Whether a pixel is in it.
    #[must_use]
    pub fn contains(&self, [x, y]: [u32; 2]) -> bool {
        let within = |at: u32, axis: usize| {
            at >= self.corner[axis]
                && u64::from(at) < u64::from(self.corner[axis]) + u64::from(self.size[axis])
        };
        within(x, 0) && within(y, 1)
    }

    /// How many pixels of a tile are in it.
    pub(crate) fn pixels_of(&self, tile: &Tile) -> u64 {
        let shared = |low: u32, size: u32, axis: usize| {
            let [start, end] = [self.corner[axis], self.corner[axis].saturating_add(self.size[axis])];
            u64::from((low + size).min(end).saturating_sub(low.max(start)))
        };
        shared(tile.x, tile.width, 0) * shared(tile.y, tile.height, 1)
    }

    /// Whether a pixel of a tile is in it, or next to one that is.
    pub(crate) fn touches(&self, tile: &Tile) -> bool {
        let within = |low: u32, size: u32, axis: usize| {
            let end = u64::from(self.corner[axis]) + u64::from(self.size[axis]) + 1;
            u64::from(low) < end && low + size + 1 > self.corner[axis]
        };
        within(tile.x, tile.width, 0) && within(tile.y, tile.height, 1)
    }
}

impl PixelSum {
    /// Adds what a ray brought. How it is displayed is only kept with a `tone`: who does not ask for the error of the mean need
    /// not know.
    #[inline(always)]
    pub fn add(&mut self, light: Light3, tone: Option<&Tone>, is_hit: bool) {
        self.light += light;
        self.rays += 1;
        self.is_hit |= is_hit;
        if let Some(tone) = tone {
            let shown = shown(light, tone).element_sum() / 3.0;
            self.shown += shown;
            self.shown_squared += shown * shown;
        }
    }

    fn mean(&self) -> Light3 {
        if self.rays == 0 { Vec3::ZERO } else { self.light * (1.0 / self.rays as f32) }
    }

    /// What the mean is off by, probably: the standard error of how bright it is displayed.
    fn error(&self) -> f32 {
        let rays = self.rays as f32;
        if self.rays < 2 {
            return 0.0;
        }
        let mean = self.shown / rays;
        ((self.shown_squared / rays - mean * mean).max(0.0) / (rays - 1.0)).sqrt()
    }
}

/// How bright light is displayed, from 0 to 1 per channel; the root is close to what a display does.
fn shown(light: Light3, tone: &Tone) -> Vec3 {
    let light = tone.apply(light).clamp(Vec3::ZERO, Vec3::ONE);
    Vec3::from_array(light.to_array().map(f32::sqrt))
}

impl Film {
    pub fn new(size: [u32; 2], region: Region, keeping: Keeping, tone: Tone) -> Self {
        let (mut rendered, mut places) = (Vec::new(), Vec::new());
        for tile in tiles(size[0], size[1]) {
            places.push(rendered.len() as u32);
            if region.touches(&tile) {
                rendered.push(tile);
            }
        }
        let area = rendered.len() * TILE_PIXELS;
        Self {
            size,
            region,
            hit_pixels: vec![0; rendered.len()],
            tiles: rendered,
            places,
            sums: keeping.sums.then(|| filled(PixelSum::default(), area)),
            shown: filled([0; 4], area),
            light: keeping.light.then(|| filled(Vec3::ZERO, area)),
            first_hits: keeping.first_hits.then(|| filled(FirstHit::NONE, area)),
            tone,
        }
    }

    /// All tiles that are rendered.
    pub fn parts(&mut self) -> Vec<TilePart<'_>> {
        let mut sums = self.sums.iter_mut().flat_map(|sums| sums.chunks_mut(TILE_PIXELS));
        let mut light = self.light.iter_mut().flat_map(|light| light.chunks_mut(TILE_PIXELS));
        let mut first_hits = self.first_hits.iter_mut().flat_map(|hits| hits.chunks_mut(TILE_PIXELS));
        let shown = self.shown.chunks_mut(TILE_PIXELS).zip(&mut self.hit_pixels);
        let parts = self.tiles.iter().zip(shown).map(|(&tile, (shown, hit_pixels))| TilePart {
            tile,
            sums: sums.next(),
            first_hits: first_hits.next().unwrap_or_default(),
            picture: TilePicture {
                shown,
                light: light.next().unwrap_or_default(),
                hit_pixels,
                region: self.region,
                tone: &self.tone,
            },
        });
        parts.collect()
    }

    /// Of each tile that is rendered the pixels that need more rays, by their place in it, and how many rays they have.
    ///
    /// A pixel needs more if it is displayed unlike one of its neighbours, after the first round, or if its rays are
    /// displayed too differently for their mean to be known well. Neighbours are not asked later: those beyond a region
    /// get no more rays, and what is in it must not depend on that.
    pub fn wanting(&self, quality: &Quality, is_first: bool) -> Vec<Vec<(u32, u32)>> {
        let of_tile = |tile: &Tile| {
            let mut places = Vec::new();
            for place in 0..TILE_PIXELS as u32 {
                let (column, row) = (place % TILE_SIZE, place / TILE_SIZE);
                let pixel = tile.pixel(place);
                if column >= tile.width || row >= tile.height || !self.region.contains(pixel) {
                    continue;
                }
                let rays = self.at(pixel).rays;
                let may_want = rays < quality.most_samples && (is_first || rays > quality.samples);
                if may_want && self.is_wanting(pixel, quality) {
                    places.push((place, rays));
                }
            }
            places
        };
        self.tiles.par_iter().map(of_tile).collect()
    }

    /// Where a pixel of a tile that is rendered stands.
    fn index(&self, [x, y]: [u32; 2]) -> usize {
        let columns = self.size[0].div_ceil(TILE_SIZE);
        let tile = self.places[(y / TILE_SIZE * columns + x / TILE_SIZE) as usize] as usize;
        tile * TILE_PIXELS + (y % TILE_SIZE * TILE_SIZE + x % TILE_SIZE) as usize
    }

    /// What the rays through a pixel have brought; nothing if that is not kept.
    fn at(&self, pixel: [u32; 2]) -> PixelSum {
        self.sums.as_ref().map_or_else(PixelSum::default, |sums| sums[self.index(pixel)])
    }

    fn is_wanting(&self, [x, y]: [u32; 2], quality: &Quality) -> bool {
        let here = self.at([x, y]);
        if here.rays > quality.samples {
            return here.error() > quality.contrast / 2.0;
        }
        let seen = shown(here.mean(), &self.tone);
        let differs = (y.saturating_sub(1)..=(y + 1).min(self.size[1] - 1)).any(|row| {
            (x.saturating_sub(1)..=(x + 1).min(self.size[0] - 1)).any(|column| {
                let other = shown(self.at([column, row]).mean(), &self.tone);
                (other - seen).abs().max_element() > quality.contrast
            })
        });
        differs || here.error() > quality.contrast / 2.0
    }

    /// The picture.
    pub fn develop(mut self) -> Frame {
        self.parts().into_par_iter().for_each(|TilePart { tile, sums, picture, .. }| {
            if let Some(sums) = sums {
                picture.develop(&tile, sums);
            }
        });
        let [width, height] = self.size;
        Frame {
            width,
            height,
            pixels: self.by_rows(&self.shown, [0; 4]),
            light: self.light.as_ref().map(|light| self.by_rows(light, Vec3::ZERO)),
            hit_pixels: self.hit_pixels.iter().copied().map(u64::from).sum(),
            first_hits: self.first_hits.as_ref().map(|hits| self.by_rows(hits, FirstHit::NONE)),
        }
    }

    /// What stands tile by tile, row by row of the picture; what is outside the region is as given.
    fn by_rows<T: Copy + Send + Sync>(&self, by_tiles: &[T], outside: T) -> Vec<T> {
        let width = self.size[0] as usize;
        let mut all = filled(outside, width * self.size[1] as usize);
        all.par_chunks_mut(width.max(1)).enumerate().for_each(|(y, row)| {
            for (x, places) in self.runs(y as u32) {
                row[x..][..places.len()].copy_from_slice(&by_tiles[places]);
            }
        });
        all
    }

    /// The pixels of a row that are in the region, tile by tile: the column of the first, and where they stand.
    fn runs(&self, y: u32) -> impl Iterator<Item = (usize, Range<usize>)> {
        let [left, top] = self.region.corner;
        let [right, bottom] = [0, 1]
            .map(|axis| self.region.corner[axis].saturating_add(self.region.size[axis]).min(self.size[axis]));
        let mut x = if (top..bottom).contains(&y) { left } else { right };
        std::iter::from_fn(move || {
            let end = right.min((x / TILE_SIZE + 1) * TILE_SIZE);
            (x < right).then(|| {
                let (column, first) = (x as usize, self.index([x, y]));
                let run = (column, first..first + (end - x) as usize);
                x = end;
                run
            })
        })
    }
}

/// A list of equal values, written by all threads: memory that is touched first takes the system longer than the values do.
fn filled<T: Copy + Send + Sync>(value: T, count: usize) -> Vec<T> {
    rayon::iter::repeat_n(value, count).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_region_contains_its_corners_only_within() {
        let region = Region { corner: [2, 3], size: [4, 5] };
        assert!(region.contains([2, 3]) && region.contains([5, 7]));
        assert!(!region.contains([1, 3]) && !region.contains([2, 2]));
        assert!(!region.contains([6, 7]) && !region.contains([5, 8]));
        let far = Region { corner: [u32::MAX, 3], ..region };
        assert!(far.contains([u32::MAX, 3]));

        let pixels = |x, y| region.pixels_of(&Tile { x, y, width: 32, height: 32 });
        assert_eq!([pixels(0, 0), pixels(5, 0), pixels(0, 6), pixels(6, 0), pixels(0, 8)], [20, 5, 8, 0, 0]);
    }

    #[test]
    fn a_region_touches_the_tiles_about_it() {
        let region = Region { corner: [32, 40], size: [8, 24] };
        let tile = |x, y| Tile { x, y, width: 32, height: 32 };
        assert!(
            region.touches(&tile(32, 32)) && region.touches(&tile(0, 32)) && region.touches(&tile(32, 64))
        );
        assert!(
            !region.touches(&tile(64, 32)) && !region.touches(&tile(32, 0)) && !region.touches(&tile(32, 96))
        );
    }
}
