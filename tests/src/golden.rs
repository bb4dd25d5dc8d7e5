//! Pictures that are committed, and compared pixel by pixel.

use image::RgbaImage;
use octvox_raytracer::Frame;
use std::path::{Path, PathBuf};

/// If this variable is set to 1, golden pictures are written instead of compared.
pub const UPDATE: &str = "OCTVOX_UPDATE_GOLDEN";

/// Compares a picture with `golden/NAME.png`.
///
/// # Panics
/// If they differ in a pixel. The picture and one of the differences are then in `differences/`.
pub fn assert_is_golden(name: &str, frame: &Frame) {
    let actual = to_image(frame);
    let golden = folder("golden").join(name).with_extension("png");
    if std::env::var_os(UPDATE).is_some_and(|value| value == "1") {
        actual.save(&golden).unwrap();
        return;
    }
    let expected = match image::open(&golden) {
        Ok(image) => image.into_rgba8(),
        Err(error) => panic!("{}: {error}; write it with {UPDATE}=1", golden.display()),
    };
    if let Some(difference) = difference(&actual, &expected) {
        let folder = folder("differences");
        std::fs::create_dir_all(&folder).unwrap();
        let actual_path = folder.join(format!("{name}.actual.png"));
        let difference_path = folder.join(format!("{name}.difference.png"));
        actual.save(&actual_path).unwrap();
        difference.picture.save(&difference_path).unwrap();
        panic!(
            "{name}: {} of {} pixels differ, by up to {} of 255\n  golden      {}\n  actual      {}\n  difference  {}",
            difference.pixels,
            actual.pixels().len(),
            difference.largest,
            golden.display(),
            actual_path.display(),
            difference_path.display()
        );
    }
}

/// Where two pictures differ.
#[derive(Debug)]
struct Difference {
    pixels: usize,
    largest: u8,
    /// White where pixels differ, on the darkened actual picture; magenta beyond one of the pictures.
    picture: RgbaImage,
}

/// `None` if the pictures are the same.
fn difference(actual: &RgbaImage, expected: &RgbaImage) -> Option<Difference> {
    if actual == expected {
        return None;
    }
    let (width, height) = (actual.width().max(expected.width()), actual.height().max(expected.height()));
    let mut difference = Difference { pixels: 0, largest: 0, picture: RgbaImage::new(width, height) };
    for (x, y, pixel) in difference.picture.enumerate_pixels_mut() {
        let (largest, color) = match (actual.get_pixel_checked(x, y), expected.get_pixel_checked(x, y)) {
            (Some(actual), Some(expected)) => {
                let channels = actual.0.iter().zip(expected.0);
                let largest = channels.map(|(a, b)| a.abs_diff(b)).max().unwrap_or(0);
                (largest, if largest > 0 { [255; 3] } else { [0, 1, 2].map(|channel| actual.0[channel] / 4) })
            }
            _ => (255, [255, 0, 255]),
        };
        difference.pixels += usize::from(largest > 0);
        difference.largest = difference.largest.max(largest);
        let [red, green, blue] = color;
        pixel.0 = [red, green, blue, 255];
    }
    Some(difference)
}

/// The frame as an image.
fn to_image(frame: &Frame) -> RgbaImage {
    let bytes = frame.pixels.as_flattened().to_vec();
    RgbaImage::from_raw(frame.width, frame.height, bytes).unwrap()
}

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_changed_pixel_is_found_and_shown() {
        let expected = RgbaImage::from_pixel(3, 2, image::Rgba([40, 80, 120, 255]));
        assert!(difference(&expected, &expected).is_none());
        let mut actual = expected.clone();
        actual.get_pixel_mut(2, 1).0[1] += 7;
        let found = difference(&actual, &expected).unwrap();
        assert_eq!((found.pixels, found.largest), (1, 7));
        assert_eq!(found.picture.get_pixel(2, 1).0, [255; 4]);
        assert_eq!(found.picture.get_pixel(0, 0).0, [10, 20, 30, 255]);
    }

    #[test]
    fn pictures_of_different_size_differ() {
        let expected = RgbaImage::from_pixel(3, 2, image::Rgba([0, 0, 0, 255]));
        let found = difference(&RgbaImage::from_pixel(2, 2, image::Rgba([0, 0, 0, 255])), &expected).unwrap();
        assert_eq!((found.pixels, found.largest), (2, 255));
    }
}
