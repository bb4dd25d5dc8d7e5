//! The sea: a disc of water with waves, and a line of foam along the shore.

use super::island;
use super::paints::Paints;
use crate::color::smooth_step;
use crate::detail::Detail;
use crate::mesh::Mesh;
use crate::noise::{layered_noise, noise};
use crate::primitives::{Ends, rings, slab, square_to_disc};
use crate::trigonometry::{circle, sine};
use glam::{DVec2, DVec3};

const RADIUS: f64 = 1.68;
const THICKNESS: f64 = 0.22;
const FOAM_SEGMENTS: usize = 120;

/// The water, deeper in colour away from the shore.
pub fn water(detail: Detail, paints: &Paints) -> Mesh {
    let cells = detail.segments(45);
    let surface = slab(cells, cells, -THICKNESS, |u, v| {
        let place = square_to_disc(DVec2::new(u, v) * 2.0 - 1.0) * RADIUS;
        DVec3::new(place.x, level(place), place.y)
    });
    surface.creased(0.12).assigned(|_, center, normal| {
        let place = DVec2::new(center.x, center.z);
        if normal.y < 0.5 {
            return paints.water.at(0.95 + center.y);
        }
        let offshore = island::shore_distance(place);
        let patches = 0.10 * layered_noise(101, center * 3.0, 3);
        paints.water.at(smooth_step(-0.2, 0.8, offshore) + patches - 2.2 * center.y)
    })
}

/// The height of the waves: three trains with sharp crests, calm near the shore.
fn level(place: DVec2) -> f64 {
    let at = DVec3::new(place.x, 0.0, place.y);
    let bend = 0.25 * noise(103, at * 1.5);
    let crest = |direction: DVec2, phase: f64| 1.0 - 2.0 * sine(place.dot(direction) + phase + bend).abs();
    let waves = 0.5 * crest(DVec2::new(0.55, 1.25), 0.0)
        + 0.3 * crest(DVec2::new(-0.9, 1.1), 0.3)
        + 0.2 * noise(107, at * 7.0);
    0.032 * waves * smooth_step(-0.05, 0.5, island::shore_distance(place))
}

/// A closed ribbon of foam where the waves meet the island.
pub fn foam(detail: Detail, paints: &Paints) -> Mesh {
    let count = detail.segments(FOAM_SEGMENTS);
    const COLUMNS: usize = 5;
    rings(count, COLUMNS, Ends::Joined, |row, column| {
        let turn = row as f64 / count as f64;
        let outward = circle(turn);
        let shore = island::shore_radius(turn);
        let ragged = noise(109, (outward * 6.0).extend(0.0));
        let middle = shore + 0.035 + 0.02 * ragged;
        let width = 0.035 + 0.022 * noise(113, (outward * 17.0).extend(3.0));
        let section = circle(column as f64 / COLUMNS as f64);
        let radius = middle - width * section.x;
        // Counter-clockwise about the direction of the ring, which runs from x to -z: from inside upward.
        DVec3::new(radius * outward.x, 0.004 + 0.012 * section.y, -radius * outward.y)
    })
    .of(paints.foam)
    .smooth()
}
