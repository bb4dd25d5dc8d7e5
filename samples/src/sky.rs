//! `sky.png`: all directions of a studio at dusk, for mirrors and glass to show: a dark sky, brighter at the horizon, the glow
//! of a sun that has gone, and two soft boxes of light.
//!
//! Longitude runs from left to right, straight ahead (−z) in the middle; latitude from straight above to straight below.

use crate::color::smooth_step;
use crate::trigonometry::power;
use glam::DVec3;
use image::{ImageBuffer, Rgb};

/// A picture of 16 bits a channel, in sRGB.
pub type Sky = ImageBuffer<Rgb<u16>, Vec<u16>>;

/// The amount of light that is white in the picture.
const WHITE: f64 = 8.0;

/// A rectangle of light with soft edges.
struct SoftBox {
    /// Degrees to the right of straight ahead, and above the horizon.
    middle: [f64; 2],
    /// Half its width and height, in degrees.
    half: [f64; 2],
    light: DVec3,
}

const BOXES: [SoftBox; 2] = [
    SoftBox { middle: [150.0, 62.0], half: [70.0, 9.0], light: DVec3::new(6.0, 5.9, 5.6) },
    SoftBox { middle: [75.0, 38.0], half: [16.0, 22.0], light: DVec3::new(3.2, 3.1, 3.0) },
];

/// Paints the sky.
pub fn paint() -> Sky {
    const SIZE: [u32; 2] = [384, 192];
    ImageBuffer::from_fn(SIZE[0], SIZE[1], |x, y| {
        let longitude = ((f64::from(x) + 0.5) / f64::from(SIZE[0]) - 0.5) * 360.0;
        let latitude = (0.5 - (f64::from(y) + 0.5) / f64::from(SIZE[1])) * 180.0;
        let light = light(longitude, latitude) / WHITE;
        Rgb(light.to_array().map(|light| (displayed(light) * 65535.0 + 0.5) as u16))
    })
}

/// Amount of light from a direction in degrees.
fn light(longitude: f64, latitude: f64) -> DVec3 {
    const ZENITH: DVec3 = DVec3::new(0.05, 0.09, 0.19);
    const MIDDLE: DVec3 = DVec3::new(0.17, 0.22, 0.31);
    const HORIZON: DVec3 = DVec3::new(0.36, 0.40, 0.46);
    const GROUND: DVec3 = DVec3::new(0.06, 0.06, 0.07);
    const GLOW: DVec3 = DVec3::new(0.16, 0.07, 0.02);
    let sky = if latitude < 0.0 {
        GROUND + (HORIZON - GROUND) * libm::exp(latitude / 6.0)
    } else {
        let above = latitude / 90.0;
        let lower = HORIZON + (MIDDLE - HORIZON) * (1.0 - libm::exp(-above * 15.0));
        lower + (ZENITH - MIDDLE) * smooth_step(0.1, 0.9, above)
    };
    let (along, up) = (turned(longitude + 40.0) / 50.0, latitude / 14.0);
    let glow = GLOW * libm::exp(-along * along - up * up);
    BOXES.iter().fold(sky + glow, |sum, lamp| {
        const SOFT: f64 = 4.0;
        let within = |off: f64, half: f64| 1.0 - smooth_step(half - SOFT, half + SOFT, off.abs());
        let share = within(turned(longitude - lamp.middle[0]), lamp.half[0])
            * within(latitude - lamp.middle[1], lamp.half[1]);
        sum + lamp.light * share
    })
}

/// An angle in degrees between −180 and 180.
fn turned(degrees: f64) -> f64 {
    (degrees + 180.0).rem_euclid(360.0) - 180.0
}

/// The displayed value of the sRGB standard for an amount of light, both from 0 to 1.
fn displayed(light: f64) -> f64 {
    let light = light.clamp(0.0, 1.0);
    if light <= 0.003_130_8 { light * 12.92 } else { 1.055 * power(light, 1.0 / 2.4) - 0.055 }
}
