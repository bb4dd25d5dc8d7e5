//! The jetty, a sailing boat, a rowing boat and a buoy.

use super::block;
use super::island::LANDING;
use super::paints::Paints;
use crate::detail::Detail;
use crate::mesh::Mesh;
use crate::noise::{random, random_between};
use crate::placement::{scale, shift, turn_x, turn_y, turn_z};
use crate::primitives::{Ends, cylinder, prism, revolution, rings};
use crate::trigonometry::{power, sine};
use glam::{DVec2, DVec3};

/// Planks on posts, from the beach out over the water.
pub fn jetty(detail: Detail, paints: &Paints) -> Mesh {
    const PLANKS: u32 = 19;
    const STEP: f64 = 0.034;
    let mut jetty = Mesh::default();
    let start = LANDING.y - 0.06;
    for plank in 0..PLANKS {
        let size = [0.15 + random_between(317, plank, -0.008, 0.008), 0.014, 0.028];
        let part = block(size, [LANDING.x, 0.085, start + STEP * f64::from(plank)]);
        jetty.append(part.of(paints.wood.at(random(331, plank))));
    }
    let length = STEP * f64::from(PLANKS);
    for side in [-0.06, 0.06] {
        let beam = block([0.014, 0.02, length], [LANDING.x + side, 0.068, start + length / 2.0 - 0.02]);
        jetty.append(beam.of(paints.wood.at(0.0)));
        for post in 0..4 {
            let place = shift(LANDING.x + side * 1.2, -0.15, start + 0.1 + 0.17 * f64::from(post));
            let post = cylinder(0.013, 0.011, 0.30, detail.segments(8)).placed(place);
            jetty.append(post.of(paints.wood.at(0.1)));
        }
    }
    jetty
}

/// A hull along x, its bow towards +x, open above: `length` long and half as high as wide.
fn hull(detail: Detail, length: f64, width: f64) -> Mesh {
    let (rows, columns) = (detail.segments(18), 14);
    let end = |x: f64, y: f64| DVec3::new(x * length / 2.0, y, 0.0);
    let ends = Ends::Points(end(-0.97, width * 0.2), end(0.99, width * 0.36));
    rings(rows, columns, ends, |row, column| {
        let along = 2.0 * (row as f64 + 0.5) / rows as f64 - 1.0;
        // Full at the stern, sharp at the bow, and rising to it.
        let fullness = power(1.0 - power((along + 0.15).abs() / 1.15, 2.6), 0.7);
        let sheer = width * (0.34 + 0.14 * along * along + 0.06 * along);
        let half = width / 2.0 * fullness;
        let keel = -0.12 * width * fullness;
        // Around the section: half of the columns are the outside, the others the inside.
        let outside = column < columns / 2;
        let place = (column % (columns / 2)) as f64 / (columns / 2 - 1) as f64;
        let (across, thickness) =
            if outside { (1.0 - 2.0 * place, 0.0) } else { (2.0 * place - 1.0, 0.035 * width) };
        let depth = (1.0 - across * across).max(0.0).sqrt();
        // Inside, the floor lies above the water.
        let floor = if outside { keel } else { 0.18 * width };
        let y = sheer + (floor - sheer) * depth;
        let z = across * (half - thickness).max(half * 0.3);
        DVec3::new(along * length / 2.0, y, z)
    })
    .creased(0.13)
}

/// A boat with two striped sails.
pub fn sailing_boat(detail: Detail, paints: &Paints) -> Mesh {
    let hull = hull(detail, 0.62, 0.2).assigned(|_, center, _| {
        if center.y > 0.065 {
            paints.white
        } else if center.y > 0.02 {
            paints.red
        } else {
            paints.dark
        }
    });
    let deck = block([0.30, 0.012, 0.13], [0.0, 0.05, 0.0]).of(paints.wood.at(0.8));
    let mast = cylinder(0.011, 0.006, 0.78, detail.segments(8))
        .placed(shift(0.05, 0.0, 0.0))
        .of(paints.wood.at(0.6));
    let boom = cylinder(0.007, 0.006, 0.32, detail.segments(8));
    let boom = boom.placed(shift(0.05, 0.155, 0.0) * turn_y(-0.03) * turn_z(0.25)).of(paints.wood.at(0.6));
    let striped = |face_height: f64| {
        if (face_height / 0.085).floor().rem_euclid(2.0) < 1.0 { paints.sail } else { paints.red }
    };
    let main = sail(detail, 0.30, 0.56).placed(shift(0.04, 0.17, 0.0) * turn_y(0.47));
    let main = main.assigned(|_, center, _| striped(center.y));
    let fore = sail(detail, 0.20, 0.46).placed(shift(0.29, 0.15, 0.0) * turn_y(0.48) * turn_z(-0.055));
    let pennant = prism(&[(0.0, 0.0), (-0.09, -0.02), (0.0, -0.045)].map(DVec2::from), 0.006);
    let pennant = pennant.placed(shift(0.05, 0.78, 0.0)).of(paints.flowers.at(0.3));
    let boat: Mesh = [hull, deck, mast, boom, main, fore.of(paints.sail), pennant].into_iter().collect();
    boat.placed(turn_x(0.015) * scale(1.1))
}

/// A triangular sail in the plane of x and y, full of wind towards +z: its foot along x, its tip above the origin.
fn sail(detail: Detail, foot: f64, height: f64) -> Mesh {
    const THICKNESS: f64 = 0.007;
    let (rows, half) = (detail.segments(14), detail.segments(6));
    let surface = |across: f64, up: f64, side: f64| {
        let breadth = foot * (1.0 - 0.97 * up);
        let bulge = 0.45 * breadth * across * (1.0 - across) * sine(0.06 + 0.4 * up);
        DVec3::new(across * breadth, up * height, bulge + side * THICKNESS / 2.0)
    };
    let middle = |up: f64| surface(0.5, up, 0.0);
    // Each ring runs along the front from left to right, and back behind.
    rings(rows, 2 * half, Ends::Points(middle(0.0), middle(1.0)), |row, column| {
        let up = row as f64 / (rows - 1) as f64;
        let along = |step: usize| step as f64 / (half - 1) as f64;
        if column < half {
            surface(along(column), up, 1.0)
        } else {
            surface(along(2 * half - 1 - column), up, -1.0)
        }
    })
    .creased(0.12)
}

/// A small boat with oars inside.
pub fn rowing_boat(detail: Detail, paints: &Paints) -> Mesh {
    let hull = hull(detail, 0.30, 0.125)
        .assigned(|_, center, _| if center.y > 0.042 { paints.white } else { paints.coats[1] });
    let benches = [-0.07, 0.03].map(|x| block([0.03, 0.008, 0.10], [x, 0.036, 0.0]).of(paints.wood.at(0.9)));
    let oars = [-0.025, 0.025].map(|z| {
        let oar = cylinder(0.005, 0.005, 0.24, 6).placed(shift(0.12, 0.045, z) * turn_z(0.25));
        oar.of(paints.wood.at(0.4))
    });
    [hull].into_iter().chain(benches).chain(oars).collect()
}

/// A striped buoy with a lamp.
pub fn buoy(detail: Detail, paints: &Paints) -> Mesh {
    let columns = detail.segments(18);
    let profile = [
        (0.0, -0.08),
        (0.07, -0.05),
        (0.085, 0.0),
        (0.07, 0.03),
        (0.045, 0.09),
        (0.032, 0.15),
        (0.022, 0.21),
    ];
    let body = revolution(&profile.map(DVec2::from), columns);
    let body = body.assigned(
        |_, center, _| {
            if center.y < 0.06 || center.y > 0.12 { paints.red } else { paints.white }
        },
    );
    let lamp =
        revolution(&[(0.018, 0.2), (0.018, 0.235), (0.0, 0.25)].map(DVec2::from), columns).of(paints.lamp);
    [body, lamp].into_iter().collect::<Mesh>().placed(turn_x(0.015) * scale(1.15))
}
