//! What the rays of a picture have brought, pixel by pixel, and which pixels need more of them.

use crate::color::{Display, Light3};
use crate::frame::{FirstHit, Frame};
use crate::quality::Quality;
use crate::tile::{TILE_PIXELS, TILE_SIZE, Tile};
use crate::tone::Tone;
use glam::Vec3;

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

/// A picture in the making.
pub(crate) struct Film {
    size: [u32; 2],
    region: Region,
    pixels: Vec<PixelSum>,
    first_hits: Option<Vec<FirstHit>>,
    tone: Tone,
}

/// A rectangle of pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Region {
    /// Column and row of the upper left pixel.
    pub corner: [u32; 2],
    /// Columns and rows.
    pub size: [u32; 2],
}

/// What the rays through a tile have brought in one round.
pub(crate) struct TileLight {
    pub tile: Tile,
    pub pixels: Vec<PixelSum>,
    /// Of all pixels, if this is the first round and they are asked for.
    pub first_hits: Vec<FirstHit>,
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
    /// Adds what a ray brought.
    pub fn add(&mut self, light: Light3, tone: &Tone, is_hit: bool) {
        let shown = shown(light, tone).element_sum() / 3.0;
        self.light += light;
        self.shown += shown;
        self.shown_squared += shown * shown;
        self.rays += 1;
        self.is_hit |= is_hit;
    }

    fn plus(&mut self, other: &Self) {
        self.light += other.light;
        self.shown += other.shown;
        self.shown_squared += other.shown_squared;
        self.rays += other.rays;
        self.is_hit |= other.is_hit;
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
    pub fn new([width, height]: [u32; 2], region: Region, first_hits: bool, tone: Tone) -> Self {
        let area = width as usize * height as usize;
        Self {
            size: [width, height],
            region,
            pixels: vec![PixelSum::default(); area],
            first_hits: first_hits.then(|| vec![FirstHit::NONE; area]),
            tone,
        }
    }

    /// Whether any pixel of a tile is part of the picture, or looked at to tell whether others need more rays.
    pub fn needs(&self, tile: &Tile) -> bool {
        self.region.touches(tile)
    }

    /// Adds what a tile has brought.
    pub fn add(&mut self, light: &TileLight) {
        let Tile { x, y, width, height } = light.tile;
        for row in 0..height {
            let from = (row * TILE_SIZE) as usize;
            let to = (y + row) as usize * self.size[0] as usize + x as usize;
            for column in 0..width as usize {
                self.pixels[to + column].plus(&light.pixels[from + column]);
                if let (Some(all), Some(hit)) = (&mut self.first_hits, light.first_hits.get(from + column)) {
                    all[to + column] = *hit;
                }
            }
        }
    }

    /// The pixels of each tile that need more rays, by their place in the tile, and how many rays they have; tiles where
    /// none does are left out.
    ///
    /// A pixel needs more if it is displayed unlike one of its neighbours, after the first round, or if its rays are
    /// displayed too differently for their mean to be known well. Neighbours are not asked later: those beyond a region
    /// get no more rays, and what is in it must not depend on that.
    pub fn wanting(&self, tiles: &[Tile], quality: &Quality, is_first: bool) -> Vec<(Tile, Vec<(u32, u32)>)> {
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
            (!places.is_empty()).then_some((*tile, places))
        };
        tiles.iter().filter_map(of_tile).collect()
    }

    fn at(&self, [x, y]: [u32; 2]) -> &PixelSum {
        &self.pixels[y as usize * self.size[0] as usize + x as usize]
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
    pub fn develop(self) -> Frame {
        let [width, height] = self.size;
        let display = Display::new();
        let region = self.region;
        let is_inside = |place: usize| region.contains([place as u32 % width, place as u32 / width]);
        let pixel = |(place, sum): (usize, &PixelSum)| {
            if is_inside(place) { display.pixel(self.tone.apply(sum.mean())) } else { [0; 4] }
        };
        let light = |(place, sum): (usize, &PixelSum)| if is_inside(place) { sum.mean() } else { Vec3::ZERO };
        let hit_pixels =
            self.pixels.iter().enumerate().filter(|(place, sum)| sum.is_hit && is_inside(*place)).count();
        let mut first_hits = self.first_hits;
        for (place, hit) in first_hits.iter_mut().flatten().enumerate() {
            if !is_inside(place) {
                *hit = FirstHit::NONE;
            }
        }
        Frame {
            width,
            height,
            pixels: self.pixels.iter().enumerate().map(pixel).collect(),
            light: Some(self.pixels.iter().enumerate().map(light).collect()),
            hit_pixels: hit_pixels as u64,
            first_hits,
        }
    }
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
