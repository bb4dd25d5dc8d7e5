//! How far two pictures are from each other.
//!
//! - [`rmse`]: the root mean square difference of displayed values, the plain measure.
//! - [`ssim`]: whether the same structures are seen; 1 if so.
//! - [`flip`]: what an observer notices who alternates between the two; 0 if nothing.
//! - [`depth_and_normal_errors`]: how far what is seen lies from where it should, and is turned from how it should.
//!
//! Pictures are as a [`Frame`](crate::Frame) holds them: red, green, blue and opacity as displayed (sRGB), row by row from
//! the top. A frame is opaque but for what is outside the region that was rendered, and that is black. So opacity is no
//! colour: all measures take what is transparent for the black that it is stored as, except that [`rmse`] leaves out the
//! pixels that are transparent in both pictures, so that it is about the region alone.
//!
//! Pictures of different sizes have no difference: it is not a number.

mod convolution;
mod false_color;
mod flip;
mod geometry;
mod rmse;
mod ssim;

pub use false_color::difference_picture;
pub use flip::{FlipMap, PIXELS_PER_DEGREE, flip};
pub use geometry::{GeometryErrors, depth_and_normal_errors};
pub use rmse::rmse;
pub use ssim::ssim;

/// Whether two pictures have `size` columns and rows.
fn are_of_size<T>(a: &[T], b: &[T], size: [u32; 2]) -> bool {
    let area = size[0] as usize * size[1] as usize;
    a.len() == area && b.len() == area
}

#[cfg(test)]
pub(crate) mod test_pictures {
    //! Pictures from formulas, which other programs can make, too.

    /// Columns and rows.
    pub const SIZE: [u32; 2] = [64, 48];

    fn picture(color: impl Fn(u32, u32) -> [u32; 3]) -> Vec<[u8; 4]> {
        let [width, height] = SIZE;
        (0..height)
            .flat_map(|y| (0..width).map(move |x| (x, y)))
            .map(|(x, y)| {
                let [red, green, blue] = color(x, y).map(|value| (value % 256) as u8);
                [red, green, blue, 255]
            })
            .collect()
    }

    /// Gradients in all three channels, with wraps that are edges.
    pub fn gradients() -> Vec<[u8; 4]> {
        picture(|x, y| [4 * x, 5 * y + 10, 2 * x + 3 * y])
    }

    /// The same moved by two pixels, with a bright square.
    pub fn moved() -> Vec<[u8; 4]> {
        picture(|x, y| {
            let is_square = (20..30).contains(&x) && (10..25).contains(&y);
            if is_square { [250, 240, 90] } else { [4 * x + 8, 5 * y + 10, 2 * x + 3 * y + 4] }
        })
    }

    /// A checkerboard of squares of four pixels, dim blue and orange.
    pub fn checkers() -> Vec<[u8; 4]> {
        picture(|x, y| if (x / 4 + y / 4) % 2 == 0 { [40, 60, 120] } else { [230, 140, 20] })
    }

    /// The same with noise: an arithmetic hash of the place, up to 31 in each channel.
    pub fn noisy() -> Vec<[u8; 4]> {
        picture(|x, y| {
            let noise = |channel: u32| (x * 73 + y * 151 + channel * 57 + x * y * 7) % 32;
            let base = if (x / 4 + y / 4) % 2 == 0 { [40, 60, 120] } else { [220, 140, 20] };
            [base[0] + noise(0), base[1] + noise(1), base[2] + noise(2)]
        })
    }
}
