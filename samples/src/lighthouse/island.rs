//! The island: its shape, ground, rocks and the stepping stones from the jetty to the tower.

use super::paints::Paints;
use super::{HOUSES, TOWER};
use crate::color::smooth_step;
use crate::detail::Detail;
use crate::mesh::Mesh;
use crate::noise::{layered_noise, noise, random, random_between};
use crate::placement::{shift, stretch, turn_x, turn_y};
use crate::primitives::{Ends, ellipsoid, rings};
use crate::trigonometry::{angle, circle};
use glam::{DVec2, DVec3};

/// Where the jetty meets the beach: x and z.
pub const LANDING: DVec2 = DVec2::new(0.12, 0.93);

/// The distance from the middle to the shore in a direction, in turns from +x towards -z.
pub fn shore_radius(turn: f64) -> f64 {
    let outward = circle(turn);
    1.06 + 0.12 * noise(127, (outward * 1.1).extend(0.5)) + 0.035 * noise(131, (outward * 4.0).extend(0.5))
}

/// How far a place lies outside the shore; negative on land.
pub fn shore_distance(place: DVec2) -> f64 {
    place.length() - shore_radius(angle(DVec2::new(place.x, -place.y)))
}

/// The height of the ground above the sea's level: a beach in front, cliffs behind, a knoll under the tower, and a
/// level place for each house.
pub fn height(place: DVec2) -> f64 {
    let natural = natural_height(place);
    HOUSES.iter().fold(natural, |ground, house| {
        let level = smooth_step(0.34, 0.2, place.distance(house.place));
        ground + (natural_height(house.place) - ground) * level
    })
}

fn natural_height(place: DVec2) -> f64 {
    let inland = -shore_distance(place);
    if inland < 0.0 {
        return (inland * 0.7).max(-0.12);
    }
    let at = DVec3::new(place.x, 0.0, place.y);
    let front = smooth_step(-0.35, 0.5, place.y / place.length().max(0.2));
    let beach = 0.16 * smooth_step(0.12, 0.5, inland) + 0.05 * smooth_step(0.0, 0.3, inland);
    let cliff =
        0.27 * smooth_step(0.0, 0.13, inland) + 0.03 * noise(137, at * 6.0) * smooth_step(0.0, 0.1, inland);
    let knoll = 0.26 * smooth_step(0.55, 0.17, place.distance(TOWER));
    cliff
        + (beach - cliff) * front
        + knoll
        + 0.02 * layered_noise(139, at * 3.0, 2) * smooth_step(0.0, 0.4, inland)
}

/// The ground: sand by the shore, grass above, rock where it is steep.
pub fn ground(detail: Detail, paints: &Paints) -> Mesh {
    let (rows, columns) = (detail.segments(28), detail.segments(78));
    let ends = Ends::Points(DVec3::new(0.0, -0.15, 0.0), DVec3::new(0.0, height(DVec2::ZERO), 0.0));
    let hill = rings(rows, columns, ends, |row, column| {
        let turn = column as f64 / columns as f64;
        // From a little outside the shore inward, in smaller steps near the shore.
        let inward = (row + 1) as f64 / (rows + 1) as f64;
        let outward = circle(turn) * shore_radius(turn) * (1.12 - 1.12 * inward * (0.7 + 0.3 * inward));
        let place = DVec2::new(outward.x, -outward.y);
        let bottom = if row == 0 { -0.15 } else { height(place) };
        DVec3::new(place.x, bottom, place.y)
    });
    hill.creased(0.14).assigned(|_, center, normal| {
        let grain = noise(149, center * 23.0);
        let patches = layered_noise(151, center * 4.0, 3);
        if normal.y < 0.58 {
            paints.rock.at(0.45 + 0.35 * grain + 0.3 * (center.y - 0.15))
        } else if center.y < 0.07 + 0.025 * patches {
            paints.sand.at(4.0 * center.y + 0.4 + 0.3 * grain)
        } else {
            paints.grass.at(0.4 + 0.3 * grain + 0.7 * patches + 0.4 * (center.y - 0.2))
        }
    })
}

/// Boulders along the shore and around the tower, facetted.
pub fn rocks(detail: Detail, paints: &Paints) -> Mesh {
    let boulder = |index: u32, place: DVec2, size: f64| {
        let rough = |point: DVec3| point * (1.0 + 0.35 * noise(157 + index, point * 1.4));
        let ball =
            ellipsoid(DVec3::ONE, detail.segments(7), detail.segments(4)).displaced(rough).creased(0.04);
        let ball = ball.placed(
            shift(place.x, height(place) + size * 0.1, place.y)
                * turn_y(random(163, index))
                * turn_x(random_between(167, index, -0.06, 0.06))
                * stretch(size, size * 0.75, size * 0.85),
        );
        ball.assigned(|_, center, normal| {
            paints.rock.at(0.5 + 0.3 * normal.y + 0.3 * noise(173, center * 15.0))
        })
    };
    let along_shore = (0..30).map(|index| {
        // Mostly behind and at the sides, where there are cliffs.
        let turn = random_between(179, index, -0.13, 0.63);
        let radius = shore_radius(turn) + random_between(181, index, -0.05, 0.09);
        let place = circle(turn) * radius;
        boulder(index, DVec2::new(place.x, -place.y), random_between(191, index, 0.035, 0.11))
    });
    let around_tower = (0..12).map(|index| {
        let place = TOWER + circle(f64::from(index) / 12.0 + 0.03) * random_between(193, index, 0.27, 0.42);
        boulder(100 + index, place, random_between(197, index, 0.03, 0.075))
    });
    along_shore.chain(around_tower).collect()
}

/// Flat stones in a winding line from the landing past the houses up to the tower.
pub fn stepping_stones(detail: Detail, paints: &Paints) -> Mesh {
    const STONES: u32 = 27;
    let bends = [
        LANDING,
        DVec2::new(0.10, 0.72),
        DVec2::new(0.13, 0.45),
        DVec2::new(0.12, 0.15),
        DVec2::new(-0.02, -0.05),
        DVec2::new(-0.17, -0.20),
        TOWER + DVec2::new(0.17, 0.13),
    ];
    let stone = |index: u32| {
        let along = f64::from(index) / f64::from(STONES - 1) * (bends.len() - 1) as f64;
        let bend = (along as usize).min(bends.len() - 2);
        let side = DVec2::new(random_between(199, index, -0.02, 0.02), 0.0);
        let place = bends[bend].lerp(bends[bend + 1], along - bend as f64) + side;
        let size = random_between(211, index, 0.032, 0.046);
        ellipsoid(DVec3::new(size, 0.014, size * 0.8), detail.segments(7), detail.segments(3))
            .placed(shift(place.x, height(place) + 0.008, place.y) * turn_y(random(223, index)))
            .smooth()
            .of(paints.paving.at(random(227, index)))
    };
    (0..STONES).map(stone).collect()
}
