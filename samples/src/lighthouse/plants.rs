//! Trees and flowers.

use super::paints::Paints;
use super::{HOUSES, TOWER, island, on_ground};
use crate::detail::Detail;
use crate::mesh::Mesh;
use crate::noise::{noise, random, random_between};
use crate::placement::{scale, shift};
use crate::primitives::{Ends, cylinder, ellipsoid, rings};
use crate::scene::Shades;
use crate::trigonometry::{circle, cosine};
use glam::{DVec2, DVec3};

/// Pines behind, other trees between the houses, wherever there is room.
pub fn trees(detail: Detail, paints: &Paints) -> Mesh {
    let mut trees = Mesh::default();
    let mut planted: Vec<DVec2> = Vec::new();
    for index in 0..400 {
        let direction = circle(random(229, index));
        let place = direction * random(233, index).sqrt() * 0.95;
        let in_view = place.y > 0.3 && place.x.abs() < 0.45;
        let room = !in_view && planted.iter().all(|other| other.distance(place) > 0.15);
        if !room || !is_free(place, 0.08) || island::height(place) < 0.12 || is_steep(place) {
            continue;
        }
        planted.push(place);
        let heading = random(239, index);
        let size = random_between(241, index, 0.75, 1.2);
        let tree = if place.y < -0.1 + 0.3 * noise(251, (place * 3.0).extend(0.0)) {
            pine(detail, index, paints)
        } else {
            broad_leaved(detail, index, paints)
        };
        trees.append(tree.placed(on_ground(place, heading) * scale(size)));
    }
    trees
}

/// Whether nothing else stands within `margin` of a place.
fn is_free(place: DVec2, margin: f64) -> bool {
    let path = DVec2::new(0.11, place.y.clamp(-0.1, 1.0));
    place.distance(TOWER) > 0.3 + margin
        && place.distance(path) > 0.05 + margin
        && HOUSES.iter().all(|house| place.distance(house.place) > house.length / 2.0 + 0.03 + margin)
}

fn is_steep(place: DVec2) -> bool {
    let step = 0.03;
    let rise_x =
        island::height(place + DVec2::new(step, 0.0)) - island::height(place - DVec2::new(step, 0.0));
    let rise_z =
        island::height(place + DVec2::new(0.0, step)) - island::height(place - DVec2::new(0.0, step));
    rise_x.abs().max(rise_z.abs()) > step
}

/// A pine of about 0.4 height: four ragged skirts of branches above each other.
fn pine(detail: Detail, index: u32, paints: &Paints) -> Mesh {
    const SKIRTS: usize = 4;
    let columns = detail.segments(14);
    let ends = Ends::Points(DVec3::new(0.0, 0.07, 0.0), DVec3::new(0.0, 0.43, 0.0));
    let crown = rings(SKIRTS * 2, columns, ends, |row, column| {
        let turn = column as f64 / columns as f64;
        let (skirt, is_tip) = ((row / 2) as f64, row % 2 == 0);
        let branches = cosine(turn * 7.0 + random(257 + index, row as u32 / 2));
        let spread = 0.115 - 0.024 * skirt;
        let (radius, height) = if is_tip {
            (spread * (1.0 + 0.16 * branches), 0.06 + 0.085 * skirt - 0.012 * branches)
        } else {
            (spread * 0.42, 0.145 + 0.085 * skirt)
        };
        let around = circle(turn) * radius;
        DVec3::new(around.x, height, -around.y)
    });
    let tone = random_between(263, index, -0.2, 0.2);
    let crown = crown.assigned(|face, center, normal| {
        let light = random((face / columns) as u32, index);
        paints.pine.at(0.35 + tone + 0.5 * normal.y * center.y + 0.25 * light)
    });
    let trunk = cylinder(0.02, 0.014, 0.12, 8).placed(shift(0.0, -0.03, 0.0)).of(paints.wood.at(0.1));
    [crown.creased(0.12), trunk].into_iter().collect()
}

/// A tree of about 0.3 height with a knobbly crown.
fn broad_leaved(detail: Detail, index: u32, paints: &Paints) -> Mesh {
    let kind: &Shades = &paints.leaves[(random(269, index) * 4.0) as usize % 4];
    let knobbly = |point: DVec3| point * (1.0 + 0.28 * noise(271 + index, point * 2.6));
    let crown =
        ellipsoid(DVec3::ONE, detail.segments(11), detail.segments(7)).displaced(knobbly).creased(0.07);
    let crown = crown.assigned(|_, center, normal| {
        kind.at(0.45 + 0.4 * normal.y + 0.5 * noise(277 + index, center * 3.0))
    });
    let radii = DVec3::new(0.085, random_between(281, index, 0.075, 0.11), 0.085);
    let crown = crown.displaced(|point| point * radii).placed(shift(0.0, 0.185, 0.0));
    let trunk = cylinder(0.018, 0.012, 0.16, 8).placed(shift(0.0, -0.03, 0.0)).of(paints.wood.at(0.5));
    [crown, trunk].into_iter().collect()
}

/// Flowers scattered over the meadow.
pub fn flowers(detail: Detail, paints: &Paints) -> Mesh {
    let flower = |index: u32| {
        let place = circle(random(283, index)) * random(293, index).sqrt() * 0.92;
        if !is_free(place, 0.0) || island::height(place) < 0.11 || is_steep(place) {
            return None;
        }
        // In patches of one colour.
        let tone = 0.5 + 0.9 * noise(307, (place * 2.2).extend(0.0)) + random_between(311, index, -0.1, 0.1);
        let radius = random_between(313, index, 0.008, 0.014);
        let head = ellipsoid(DVec3::splat(radius), detail.segments(5), detail.segments(3)).smooth();
        Some(head.placed(on_ground(place, 0.0) * shift(0.0, radius, 0.0)).of(paints.flowers.at(tone)))
    };
    (0..95).filter_map(flower).collect()
}
