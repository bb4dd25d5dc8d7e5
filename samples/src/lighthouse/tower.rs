//! The lighthouse itself.

use super::block;
use super::paints::Paints;
use crate::curve::{Course, frames, sample_closed};
use crate::detail::Detail;
use crate::mesh::{MaterialId, Mesh};
use crate::placement::{shift, turn_y};
use crate::primitives::{cylinder, ellipsoid, revolution, wire};
use crate::trigonometry::circle;
use glam::{DVec2, DVec3};

const STRIPES: usize = 8;
/// Height of the plinth, where the stripes begin.
const FOOT: f64 = 0.08;
/// Height of the gallery, where they end.
const GALLERY: f64 = 1.28;
const FOOT_RADIUS: f64 = 0.205;
const NECK_RADIUS: f64 = 0.115;
const GALLERY_RADIUS: f64 = 0.19;
const LANTERN_RADIUS: f64 = 0.088;
const LANTERN_HEIGHT: f64 = 0.17;

/// The tower on the plane y = 0, its door towards +z.
pub fn lighthouse(detail: Detail, paints: &Paints) -> Mesh {
    let mut tower: Mesh =
        [shaft(detail, paints), gallery(detail, paints), lantern(detail, paints)].into_iter().collect();
    tower.append(openings(paints));
    tower
}

/// The radius of the shaft: wide at the foot, curving in.
fn radius_at(height: f64) -> f64 {
    let up = ((height - FOOT) / (GALLERY - FOOT)).clamp(0.0, 1.0);
    NECK_RADIUS + (FOOT_RADIUS - NECK_RADIUS) * (1.0 - up) * (1.0 - 0.45 * up)
}

fn shaft(detail: Detail, paints: &Paints) -> Mesh {
    let columns = detail.segments(30);
    let plinth = revolution(&[(0.235, -0.1), (0.235, 0.05), (0.215, FOOT)].map(DVec2::from), columns);
    // Two rows to a stripe, so that the stripes join exactly.
    let rows = STRIPES * 2;
    let profile: Vec<DVec2> = (0..=rows)
        .map(|row| FOOT - 0.01 + (GALLERY - FOOT + 0.01) * row as f64 / rows as f64)
        .map(|height| DVec2::new(radius_at(height), height))
        .collect();
    let striped =
        |face: usize| if (face / columns / 2).is_multiple_of(2) { paints.white } else { paints.red };
    let shaft = revolution(&profile, columns).assigned(|face, _, _| striped(face));
    [plinth.of(paints.rock.at(0.9)), shaft].into_iter().collect()
}

/// The platform with its railing.
fn gallery(detail: Detail, paints: &Paints) -> Mesh {
    let columns = detail.segments(30);
    let platform =
        [(0.10, -0.07), (0.125, -0.045), (0.165, -0.02), (GALLERY_RADIUS, -0.015), (GALLERY_RADIUS, 0.012)];
    let mut gallery = revolution(&platform.map(DVec2::from), columns).of(paints.dark);
    let radius = GALLERY_RADIUS - 0.012;
    for post in 0..16 {
        let place = circle(f64::from(post) / 16.0) * radius;
        gallery.append(
            cylinder(0.0045, 0.0045, 0.085, 4).placed(shift(place.x, 0.01, place.y)).of(paints.white),
        );
    }
    for height in [0.05, 0.092] {
        let rail = sample_closed(columns, |turn| {
            let place = circle(turn) * radius;
            DVec3::new(place.x, height, place.y)
        });
        let rail = wire(&frames(&rail, Course::Closed), Course::Closed, 4, 0.0055);
        gallery.append(rail.of(paints.white).smooth());
    }
    gallery.placed(shift(0.0, GALLERY, 0.0))
}

/// The glass house with the lamp, the dome above it and the ball on top.
fn lantern(detail: Detail, paints: &Paints) -> Mesh {
    let columns = detail.segments(24);
    let part = |profile: &[(f64, f64)], material: MaterialId| {
        let profile: Vec<DVec2> = profile.iter().copied().map(DVec2::from).collect();
        revolution(&profile, columns).of(material)
    };
    let base = 0.05;
    let top = base + LANTERN_HEIGHT;
    let mut lantern = part(&[(0.1, 0.0), (0.1, base)], paints.white);
    lantern.append(part(&[(LANTERN_RADIUS, base - 0.005), (LANTERN_RADIUS, top + 0.005)], paints.lamp));
    for bar in 0..10 {
        let place = circle(f64::from(bar) / 10.0) * LANTERN_RADIUS;
        let bar = cylinder(0.006, 0.006, LANTERN_HEIGHT, 4).placed(shift(place.x, base, place.y));
        lantern.append(bar.of(paints.dark));
    }
    let dome = [
        (0.118, 0.0),
        (0.122, 0.014),
        (0.108, 0.04),
        (0.082, 0.07),
        (0.046, 0.096),
        (0.016, 0.11),
        (0.0, 0.112),
    ];
    lantern.append(part(&dome, paints.red).placed(shift(0.0, top, 0.0)));
    let ball = ellipsoid(DVec3::splat(0.02), 12, 8).placed(shift(0.0, top + 0.122, 0.0));
    lantern.append(ball.of(paints.dark));
    lantern.append(part(&[(0.005, top + 0.12), (0.003, top + 0.24)], paints.dark));
    lantern.placed(shift(0.0, GALLERY + 0.01, 0.0))
}

/// The door, and windows that climb around the shaft.
fn openings(paints: &Paints) -> Mesh {
    let mut openings = Mesh::default();
    let front = radius_at(0.2);
    openings.append(block([0.115, 0.2, 0.04], [0.0, 0.15, front]).of(paints.white));
    openings.append(block([0.085, 0.175, 0.05], [0.0, 0.145, front + 0.002]).of(paints.wood.at(0.2)));
    openings.append(block([0.15, 0.03, 0.10], [0.0, 0.04, front + 0.05]).of(paints.paving.at(0.5)));
    for (turn, height) in
        [(0.06, 0.48), (0.2, 0.70), (0.04, 0.92), (-0.1, 0.62), (0.14, 1.12), (0.5, 0.55), (0.7, 0.95)]
    {
        let wall = radius_at(height);
        let window: Mesh = [
            block([0.062, 0.088, 0.04], [0.0, height, wall - 0.008]).of(paints.white),
            block([0.042, 0.066, 0.04], [0.0, height, wall - 0.004]).of(paints.glass),
            block([0.072, 0.012, 0.05], [0.0, height - 0.046, wall - 0.005]).of(paints.dark),
        ]
        .into_iter()
        .collect();
        openings.append(window.placed(turn_y(turn)));
    }
    openings
}
