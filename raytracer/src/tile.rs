//! Tiles of the picture, the unit of work; and the blocks of pixels in them that are traced as packets.

use crate::beam::BEAM_SIZE;
use crate::camera::PixelBlock;
use crate::lanes::{Lanes, MAX_LANES};

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

impl Tile {
    /// Column and row of the pixel at a place in the tile, counted row by row of a whole one.
    pub fn pixel(&self, place: u32) -> [u32; 2] {
        [self.x + place % TILE_SIZE, self.y + place / TILE_SIZE]
    }

    /// The places of the pixels in the tile, row by row of blocks of 4×4 of them, so that those that follow each other are
    /// close together.
    pub fn pixels_by_block(&self) -> impl Iterator<Item = u32> {
        const SIDE: u32 = 4;
        let Self { width, height, .. } = *self;
        let blocks = (0..height.div_ceil(SIDE))
            .flat_map(move |row| (0..width.div_ceil(SIDE)).map(move |column| [column * SIDE, row * SIDE]));
        blocks
            .flat_map(|[x, y]| (0..SIDE * SIDE).map(move |place| [x + place % SIDE, y + place / SIDE]))
            .filter(move |[x, y]| *x < width && *y < height)
            .map(|[x, y]| y * TILE_SIZE + x)
    }

    /// Visits the squares of [`BEAM_SIZE`] pixels of the tile, row by row: `visit` gets the upper left pixel.
    #[inline(always)]
    pub fn for_each_square(&self, mut visit: impl FnMut([u32; 2])) {
        for row in (0..self.height).step_by(BEAM_SIZE as usize) {
            for column in (0..self.width).step_by(BEAM_SIZE as usize) {
                visit([self.x + column, self.y + row]);
            }
        }
    }

    /// Visits the blocks of pixels in one of those squares, row by row: `visit` gets the places to sample, at `offset` from
    /// the upper left corner of each pixel. A block with no pixel in the picture is left out.
    #[inline(always)]
    pub fn for_each_block<L: Lanes>(
        &self,
        [left, top]: [u32; 2],
        offset: [f32; 2],
        mut visit: impl FnMut(PixelBlock<L>),
    ) {
        let (columns, rows) = block_shape(L::COUNT);
        let (lane_x, lane_y) = const { offsets(L::COUNT) };
        let (lane_x, lane_y) = (L::load(&lane_x), L::load(&lane_y));
        let (right, bottom) = (self.x + self.width, self.y + self.height);
        for y in (top..bottom.min(top + BEAM_SIZE)).step_by(rows as usize) {
            for x in (left..right.min(left + BEAM_SIZE)).step_by(columns as usize) {
                let pixel_x = L::float(x as f32) + lane_x;
                let pixel_y = L::float(y as f32) + lane_y;
                visit(PixelBlock {
                    corner: [x, y],
                    x: pixel_x + L::float(offset[0]),
                    y: pixel_y + L::float(offset[1]),
                    active: L::less(pixel_x, L::float(right as f32))
                        & L::less(pixel_y, L::float(bottom as f32)),
                });
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
            tile.for_each_square(|corner| {
                tile.for_each_block::<L>(corner, [0.5, 0.5], |block| {
                    let (mut x, mut y) = ([0.0; MAX_LANES], [0.0; MAX_LANES]);
                    L::store(block.x, &mut x);
                    L::store(block.y, &mut y);
                    assert_eq!([x[0], y[0]].map(|at| at as u32), block.corner);
                    for lane in 0..L::COUNT {
                        if L::bitmask(block.active) >> lane & 1 == 1 {
                            visits[y[lane] as usize * width + x[lane] as usize] += 1;
                        }
                    }
                });
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
