//! The invented planet: where there is land, and how the map of it is painted.

use crate::color::{Color, gradient, hex, mix, smooth_step};
use crate::noise::{layered_noise, noise};
use crate::trigonometry::{circle, cosine};
use glam::DVec3;
use image::{Rgb, RgbImage};

/// The height of the ground in a direction from the planet's centre: from -1 in the deepest sea over 0 at the shore to 1.
pub fn elevation(direction: DVec3) -> f64 {
    let bent = direction
        + 0.25
            * DVec3::new(
                noise(401, direction * 2.1),
                noise(409, direction * 2.1),
                noise(419, direction * 2.1),
            );
    let land = 2.1 * layered_noise(421, bent * 1.55 + DVec3::splat(7.3), 6) - 0.06;
    // Mountain chains: where a noise passes through zero.
    let chain = 1.0 - layered_noise(431, bent * 2.6, 4).abs() * 8.0;
    let mountains = chain.max(0.0) * smooth_step(0.02, 0.35, land);
    let plains = if land > 0.0 { 0.35 * land } else { 0.75 * land };
    (plains + 0.55 * mountains).clamp(-1.0, 1.0)
}

/// Paints the whole planet as a map of longitude (x) and latitude (y, north above).
pub fn paint(width: u32, height: u32) -> RgbImage {
    let direction = |x: u32, y: u32| {
        let parallel = circle(0.25 - (f64::from(y) + 0.5) / f64::from(height) * 0.5);
        let meridian = circle((f64::from(x) + 0.5) / f64::from(width));
        DVec3::new(parallel.x * meridian.x, parallel.y, -parallel.x * meridian.y)
    };
    let rows = (0..=height).map(|y| (0..width).map(|x| elevation(direction(x, y))).collect());
    let elevations: Vec<Vec<f64>> = rows.collect();
    let at = |x: u32, y: u32| elevations[y as usize][(x % width) as usize];
    RgbImage::from_fn(width, height, |x, y| {
        // Light from the north-west, as maps have it.
        let rise = at(x, y) - at(x + 1, y + 1);
        let ground = ground_color(direction(x, y), at(x, y), rise);
        let (u, v) = ((f64::from(x) + 0.5) / f64::from(width), (f64::from(y) + 0.5) / f64::from(height));
        let color = over_lines(ground, u, v);
        // A grid of 64 levels keeps the file small.
        Rgb(color.to_array().map(|channel| ((channel * 63.0).round() / 63.0 * 255.0).round() as u8))
    })
}

/// The colour of sea or land of an elevation. `rise` is how much the ground falls off towards the south-east in a pixel.
fn ground_color(direction: DVec3, height: f64, rise: f64) -> Color {
    let cold = direction.y.abs() + 0.06 * layered_noise(433, direction * 5.0, 3) + 0.30 * height.max(0.0);
    let ice = smooth_step(0.93, 0.96, cold);
    if height < 0.0 {
        // In steps, as depths are shown on maps.
        let steps = (height * 14.0).floor() / 14.0;
        let water = gradient(
            &[(-0.8, 0x0d3b6e), (-0.45, 0x14609a), (-0.2, 0x2589b8), (-0.08, 0x4fb3c8), (0.0, 0x9adcd4)],
            steps + 0.035,
        );
        return mix(water, hex(0xe6f2f6), ice);
    }
    // Deserts lie in two belts beside the equator.
    let belt = smooth_step(0.22, 0.03, (direction.y.abs() - 0.40).abs());
    let dry = belt + 0.7 * layered_noise(439, direction * 3.0, 3);
    let low = mix(hex(0x4f9a46), hex(0xe3c070), smooth_step(0.25, 0.75, dry));
    let low = mix(low, hex(0x2f7d4a), smooth_step(0.22, 0.05, direction.y.abs()) * 0.7);
    let low = mix(low, hex(0x8a9a6a), smooth_step(0.62, 0.86, cold));
    let high = gradient(&[(0.15, 0xa88a52), (0.35, 0x8a5c3c), (0.5, 0x7a5a50), (0.62, 0xf8f8fa)], height);
    let land = mix(low, high, smooth_step(0.14, 0.34, height));
    let lit = mix(land, hex(0xf4f8fa), ice) * (1.0 + (rise * 9.0).clamp(-0.35, 0.3));
    let shore = smooth_step(0.012, 0.002, height);
    mix(lit, hex(0x5a3c28), 0.75 * shore).clamp(DVec3::ZERO, DVec3::ONE)
}

/// Draws the lines of the map over a colour: a grid every 15 degrees, the equator and the tropics.
fn over_lines(color: Color, u: f64, v: f64) -> Color {
    const DEGREES: f64 = 360.0;
    let latitude = (0.5 - v) * DEGREES / 2.0;
    let line = |distance: f64, half_width: f64| smooth_step(half_width, half_width * 0.4, distance.abs());
    let to_multiple = |value: f64, step: f64| value - (value / step).round() * step;
    let shrinking = cosine(latitude / DEGREES);
    let meridian =
        line(to_multiple(u * DEGREES, 15.0) * shrinking, 0.3) * smooth_step(86.0, 84.0, latitude.abs());
    let parallel = line(to_multiple(latitude, 15.0), 0.3);
    let color = mix(color, hex(0xfff4d8), 0.32 * meridian.max(parallel));
    let dashes = smooth_step(-0.2, 0.2, cosine(u * 90.0));
    let tropics = line(latitude.abs() - 23.4, 0.45).max(line(latitude.abs() - 66.6, 0.45)) * dashes;
    let color = mix(color, hex(0xc8402c), 0.8 * tropics);
    mix(color, hex(0xc8402c), 0.9 * line(latitude, 0.5))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_planet_has_land_and_sea() {
        let map = paint(128, 64);
        let blue = map.pixels().filter(|Rgb([red, _, blue])| blue > red).count();
        let share = blue as f64 / (128.0 * 64.0);
        assert!((0.4..0.8).contains(&share), "{share}");
    }

    #[test]
    fn the_map_has_no_seam() {
        let map = paint(512, 256);
        let difference = |left: u32, right: u32| -> f64 {
            let rows = 0..map.height();
            let sum: u32 = rows
                .map(|y| {
                    let (a, b) = (map.get_pixel(left, y), map.get_pixel(right, y));
                    a.0.iter().zip(b.0).map(|(a, b)| u32::from(a.abs_diff(b))).sum::<u32>()
                })
                .sum();
            f64::from(sum) / f64::from(map.height())
        };
        // A meridian is drawn on the seam, as on every multiple of 15 degrees: compare with the one at 180 degrees.
        assert!(difference(511, 0) < 2.0 * difference(255, 256) + 10.0);
    }
}
