//! Tiles of the picture, the unit of work; and the blocks of pixels in them that are traced as packets.

use crate::beam::{BEAM_SIZE, Beam};
use crate::camera::{PixelBlock, View};
use crate::lanes::{Lanes, MAX_LANES};
use crate::octree::Octree;

/// Pixels along the side of a tile (Bohnen 2009, section 3.5.1).
pub const TILE_SIZE: u32 = 32;

/// Pixels of a whole tile.
pub(crate) const TILE_PIXELS: usize = (TILE_SIZE * TILE_SIZE) as usize;

/// A rectangle of pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Tile {
    /// Left-most column of pixels.
    pub x: u32,
    /// Topmost row of pixels.
    pub y: u32,
    /// Columns within the picture.
    pub width: u32,
    /// Rows within the picture.
    pub height: u32,
}

/// The tiles of a picture, row by row.
pub(crate) fn tiles(width: u32, height: u32) -> Vec<Tile> {
    let along =
        |size: u32| (0..size).step_by(TILE_SIZE as usize).map(move |at| (at, TILE_SIZE.min(size - at)));
    along(height)
        .flat_map(|(y, height)| along(width).map(move |(x, width)| Tile { x, y, width, height }))
        .collect()
}

/// Columns and rows of the block of pixels that a packet covers: as square as its number of lanes allows.
pub(crate) const fn block_shape(lanes: usize) -> (u32, u32) {
    match lanes {
        32 => (8, 4),
        16 => (4, 4),
        8 => (4, 2),
        4 => (2, 2),
        _ => (1, 1),
    }
}

/// Columns and rows of each lane's pixel within its block.
const fn offsets(lanes: usize) -> ([f32; MAX_LANES], [f32; MAX_LANES]) {
    let (columns, _) = block_shape(lanes);
    let mut x = [0.0; MAX_LANES];
    let mut y = [0.0; MAX_LANES];
    let mut lane = 0;
    while lane < lanes {
        x[lane] = (lane as u32 % columns) as f32;
        y[lane] = (lane as u32 / columns) as f32;
        lane += 1;
    }
    (x, y)
}

/// Beams along the side of a tile.
const BEAMS: u32 = TILE_SIZE / BEAM_SIZE;

/// For each beam of a tile, row by row, a distance before which none of its rays hits anything; infinite if none ever
/// does.
pub(crate) type Starts = [f32; (BEAMS * BEAMS) as usize];

/// The starts of rays that nothing is known of.
pub(crate) const AT_THE_EYE: Starts = [0.0; (BEAMS * BEAMS) as usize];

impl Tile {
    /// Sends the beams of the tile, for rays that may stop at cells of `lod_pixels`.
    pub fn starts<L: Lanes>(&self, octree: &Octree, view: &View, lod_pixels: f64) -> Starts {
        if !view.is_near() {
            return AT_THE_EYE;
        }
        let low = [self.x, self.y];
        let whole = Beam::new(view, low, low.map(|corner| corner + TILE_SIZE));
        let seeds = whole.seeds::<L>(octree, lod_pixels);
        std::array::from_fn(|number| {
            let low = [number as u32 % BEAMS * BEAM_SIZE, number as u32 / BEAMS * BEAM_SIZE];
            if low[0] >= self.width || low[1] >= self.height {
                return f32::INFINITY;
            }
            let low = [self.x + low[0], self.y + low[1]];
            let beam = Beam::new(view, low, low.map(|corner| corner + BEAM_SIZE));
            beam.start::<L>(octree, &seeds, lod_pixels)
        })
    }

    /// Visits the blocks of the tile, row by row: `trace` gets the places to sample, at `offset` from the upper
    /// left corner of each pixel, and the column and row of the block within the tile.
    #[inline(always)]
    pub fn for_each_block<L: Lanes>(
        &self,
        offset: [f32; 2],
        starts: &Starts,
        mut trace: impl FnMut(PixelBlock<L>, u32, u32),
    ) {
        let (columns, rows) = block_shape(L::COUNT);
        let (lane_x, lane_y) = const { offsets(L::COUNT) };
        let (lane_x, lane_y) = (L::load(&lane_x), L::load(&lane_y));
        let end_x = L::float((self.x + self.width) as f32);
        let end_y = L::float((self.y + self.height) as f32);
        for row in (0..self.height).step_by(rows as usize) {
            for column in (0..self.width).step_by(columns as usize) {
                let pixel_x = L::float((self.x + column) as f32) + lane_x;
                let pixel_y = L::float((self.y + row) as f32) + lane_y;
                let block = PixelBlock {
                    x: pixel_x + L::float(offset[0]),
                    y: pixel_y + L::float(offset[1]),
                    active: L::less(pixel_x, end_x) & L::less(pixel_y, end_y),
                    start: starts[(row / BEAM_SIZE * BEAMS + column / BEAM_SIZE) as usize],
                };
                trace(block, column, row);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{Eight, Four, Single, Sixteen};

    fn covers_each_pixel_once<L: Lanes>() {
        let (width, height) = (70, 37);
        let mut visits = vec![0; width * height];
        for tile in tiles(width as u32, height as u32) {
            tile.for_each_block::<L>([0.5, 0.5], &AT_THE_EYE, |block, _, _| {
                let (mut x, mut y) = ([0.0; MAX_LANES], [0.0; MAX_LANES]);
                L::store(block.x, &mut x);
                L::store(block.y, &mut y);
                for lane in 0..L::COUNT {
                    if L::bitmask(block.active) >> lane & 1 == 1 {
                        visits[y[lane] as usize * width + x[lane] as usize] += 1;
                    }
                }
            });
        }
        assert!(visits.iter().all(|&count| count == 1));
    }

    #[test]
    fn blocks_of_every_width_cover_each_pixel_once() {
        covers_each_pixel_once::<Single>();
        covers_each_pixel_once::<Four>();
        covers_each_pixel_once::<Eight>();
        covers_each_pixel_once::<Sixteen>();
    }
}
