//! `shell`: a ribbed ammonite with a pearly inside on rippled sand, with a tower shell, a starfish, pebbles and pearls.
//!
//! All colours are colours of vertices; the materials only say how glossy a part is.

use crate::coil::{Coil, Place};
use crate::color::{Color, WHITE, gradient, hex, mix, smooth_step};
use crate::detail::Detail;
use crate::material::Material;
use crate::mesh::Mesh;
use crate::noise::{layered_noise, noise, random, random_between};
use crate::placement::{scale, shift, stretch, turn_x, turn_y, turn_z};
use crate::primitives::{Ends, ellipsoid, rings, slab, square_to_disc};
use crate::scene::Scene;
use crate::trigonometry::{circle, cosine, sine};
use glam::{DVec2, DVec3};

const SAND_RADIUS: f64 = 1.28;
/// From the bottom up to the plane y = 0, around which the surface ripples.
const SAND_THICKNESS: f64 = 0.16;

/// Builds the scene.
pub fn build(detail: Detail) -> Scene {
    let mut scene = Scene::new("shell", "a ribbed sea shell with a pearly inside on rippled sand");
    let nacre = scene.material(Material::matte("nacre", WHITE).glossy(hex(0x909090), 50.0));
    let skin = scene.material(Material::matte("skin", WHITE).glossy(hex(0x202020), 12.0));
    let sand = scene.material(Material::matte("sand", WHITE));
    let stone = scene.material(Material::matte("stone", WHITE).glossy(hex(0x303030), 20.0));
    let pearl = scene.material(Material::matte("pearl", WHITE).glossy(hex(0xd0d0d0), 90.0));

    scene.add(sand_disc(detail).of(sand));
    let upright = shift(-0.1, 0.81, -0.16) * turn_y(0.09) * turn_z(-0.13) * turn_x(-0.012);
    scene.add(ammonite(detail).placed(upright).of(nacre).smooth());
    let lying = shift(0.2, 0.03, 0.8) * turn_y(0.3) * turn_x(-0.022) * turn_z(0.3);
    scene.add(tower_shell(detail).placed(lying).of(nacre).smooth());
    let star = shift(-0.72, 0.01, 0.60) * turn_y(0.03) * scale(0.34);
    scene.add(starfish(detail).placed(star).of(skin).smooth());
    for (x, z, radius) in [(-0.16, 0.86, 0.075), (0.0, 0.95, 0.055), (-0.27, 0.98, 0.045)] {
        let ball = ellipsoid(DVec3::splat(radius), detail.segments(20), detail.segments(10));
        let tint = mix(hex(0xfff4ec), hex(0xe8f0ff), random(3, (radius * 1000.0) as u32));
        let place = shift(x, sand_height(x, z) + radius * 0.75, z);
        scene.add(
            ball.painted(|point| mix(tint, hex(0xf5c8d8), point.y / radius)).placed(place).of(pearl).smooth(),
        );
    }
    for index in 0..12 {
        scene.add(pebble(detail, index).of(stone).smooth());
    }
    scene
}

/// The big shell, coiling around the z axis, of radius 1 at its opening.
fn ammonite(detail: Detail) -> Mesh {
    const RIBS_PER_TURN: f64 = 15.0;
    // Stripes that run along the shell: ranges of the angle from its outermost line, on both sides.
    const KEEL: [f64; 2] = [0.0, 0.02];
    const TEAL: [f64; 2] = [0.095, 0.138];
    const PALE: [f64; 2] = [0.196, 0.209];
    let coil = Coil {
        turns: 2.9,
        growth: 2.3,
        distance: 0.65,
        rise: 0.0,
        half_width: 0.34,
        half_height: 0.31,
        depth: 0.42,
        wall: 0.09,
    };
    // Ribs bend forward towards the outside, and fade out near the opening.
    let rib = |place: &Place| place.turn * RIBS_PER_TURN - 0.55 * cosine(place.around);
    let relief = |place: &Place| {
        let outer = 0.5 + 0.5 * cosine(place.around);
        let flare = 0.10 * smooth_step(-0.14, 0.0, place.turn);
        flare + (0.025 + 0.035 * outer) * cosine(rib(place)) * smooth_step(0.0, -0.1, place.turn)
    };
    let paint = |place: &Place| {
        let place_noise = layered_noise(11, place.position * 5.0, 3);
        if place.inside {
            return pearly(place.position, -place.turn / coil.depth);
        }
        let age = 1.0 + (place.turn + 0.12 * place_noise) / coil.turns;
        let ground = gradient(
            &[
                (0.0, 0x3c1f6e),
                (0.35, 0x7a2a8c),
                (0.55, 0xc8386e),
                (0.72, 0xf0643c),
                (0.86, 0xf9a648),
                (0.97, 0xfde3a8),
                (1.0, 0xfff4dc),
            ],
            age,
        );
        // Flames between the ribs.
        let flame = smooth_step(-0.1, 0.7, cosine(rib(place) + 0.5 + 0.16 * place_noise));
        let flame_color =
            gradient(&[(0.0, 0x160a3c), (0.55, 0x5a1048), (0.8, 0x9c2410), (1.0, 0xb84a18)], age);
        let across = (place.around + 0.5).rem_euclid(1.0) - 0.5;
        // The edges themselves belong to a stripe, however their angle was rounded.
        let in_stripe = |[low, high]: [f64; 2]| (low - 1e-9..=high + 1e-9).contains(&across.abs());
        if in_stripe(KEEL) || in_stripe(PALE) {
            hex(0xfff2d8)
        } else if in_stripe(TEAL) {
            mix(hex(0x0fb0b4), hex(0x1a4fa0), 0.5 * flame)
        } else {
            mix(ground, flame_color, 0.85 * flame)
        }
    };
    // Columns just outside and inside of the edges of the stripes make these crisp.
    let half = [
        0.0, KEEL[1], 0.05, 0.09, TEAL[0], TEAL[1], 0.148, 0.17, 0.191, PALE[0], PALE[1], 0.214, 0.26, 0.32,
        0.40,
    ];
    let other_half = half[1..].iter().rev().map(|around| 1.0 - around);
    let columns: Vec<f64> = half.into_iter().chain([0.5]).chain(other_half).collect();
    // The first chamber fills the hole in the middle.
    let first_chamber = ellipsoid(DVec3::new(0.068, 0.068, 0.045), detail.segments(14), detail.segments(8));
    [coil.build(detail, 78.0, &columns, relief, paint), first_chamber.painted(|_| hex(0x3c1f6e))]
        .into_iter()
        .collect()
}

/// Mother of pearl: soft colours that change over the surface, darker towards the depth.
fn pearly(position: DVec3, depth: f64) -> Color {
    let shimmer = 0.5 + 0.9 * layered_noise(23, position * 2.2, 2) + 0.3 * position.z;
    let sheen = gradient(
        &[(0.0, 0xf7b7d0), (0.25, 0xfde6d2), (0.5, 0xd6f5e6), (0.75, 0xb8dcff), (1.0, 0xdcc6ff)],
        shimmer.rem_euclid(1.0),
    );
    mix(sheen, hex(0x8c4a78), depth * 0.75)
}

/// A slender shell with many turns around the z axis, coming to a point towards the origin.
fn tower_shell(detail: Detail) -> Mesh {
    let coil = Coil {
        turns: 9.0,
        growth: 1.24,
        distance: 0.092,
        rise: 0.8,
        half_width: 0.084,
        half_height: 0.095,
        depth: 0.3,
        wall: 0.2,
    };
    let relief = |place: &Place| 0.06 * cosine(place.around * 4.0);
    let paint = |place: &Place| {
        if place.inside {
            return mix(hex(0xffe8d8), hex(0xc07868), -place.turn / coil.depth);
        }
        let across = (place.around + 0.5).rem_euclid(1.0) - 0.5;
        let ground = gradient(&[(-0.25, 0x1d7f8c), (0.0, 0xfff1da), (0.25, 0xf2a65a)], across);
        let spots = cosine(place.turn * 8.0 + across);
        mix(ground, hex(0x6a1f3c), 0.9 * smooth_step(0.25, 0.7, spots))
    };
    let columns: Vec<f64> = (0..12).map(|column| f64::from(column) / 12.0).collect();
    coil.build(detail, 20.0, &columns, relief, paint)
}

/// A starfish of radius 1 on the plane y = 0.
fn starfish(detail: Detail) -> Mesh {
    let (columns, rows) = (detail.segments(60), detail.segments(13));
    let ends = Ends::Points(DVec3::new(0.0, -0.08, 0.0), DVec3::new(0.0, 0.26, 0.0));
    rings(rows - 1, columns, ends, |row, column| {
        let turn = column as f64 / columns as f64;
        let arm = 0.5 + 0.5 * cosine(turn * 5.0);
        let reach = 0.40 + 0.60 * arm * arm.sqrt();
        let profile = circle((row + 1) as f64 / rows as f64 * 0.5 - 0.25);
        let out = reach * profile.x;
        let along = circle(turn + 0.02 * out * sine(turn * 2.0 + 0.1));
        // The ridge of an arm falls outward, and its side is round.
        let height = (0.26 - 0.16 * out) * profile.y.max(-0.25);
        let position = DVec3::new(out * along.x, height, -out * along.y);
        let dots = smooth_step(0.1, 0.7, cosine(profile.y * 3.0) * smooth_step(0.82, 0.98, arm));
        let body = mix(hex(0xc8281c), hex(0xff8a34), 0.2 + 0.7 * arm + 0.3 * noise(31, position * 9.0));
        (position, mix(body, hex(0xffe9c0), 0.9 * dots * smooth_step(-0.1, 0.3, profile.y)))
    })
}

/// The round block of sand that everything lies on.
fn sand_disc(detail: Detail) -> Mesh {
    let cells = detail.segments(40);
    slab(cells, cells, -SAND_THICKNESS, |u, v| {
        let DVec2 { x, y: z } = square_to_disc(DVec2::new(u, v) * 2.0 - 1.0) * SAND_RADIUS;
        let height = sand_height(x, z);
        let position = DVec3::new(x, height, z);
        let grain = 0.10 * noise(41, position * 60.0) + 0.10 * layered_noise(43, position * 4.0, 3);
        let color =
            gradient(&[(0.0, 0xb98a5c), (0.5, 0xe6c592), (1.0, 0xfbe9c6)], 0.5 + height * 12.0 + grain);
        (position, color)
    })
}

/// The surface of the sand: ripples, steeper on one side, that run around the shell.
fn sand_height(x: f64, z: f64) -> f64 {
    let place = DVec3::new(x, 0.0, z);
    let phase = 3.2 * (z + 0.25 * x) + 0.35 * layered_noise(47, place * 1.3, 2) + 0.10 * x * x;
    let wave = sine(phase) + 0.3 * sine(2.0 * phase + 0.1);
    let edge = smooth_step(SAND_RADIUS, SAND_RADIUS - 0.25, place.length());
    0.022 * wave * (0.35 + 0.65 * edge) + 0.03 * noise(53, place * 1.1)
}

/// A flat lump of stone, half sunk into the sand somewhere near its rim.
fn pebble(detail: Detail, index: u32) -> Mesh {
    let direction = circle(random(61, index));
    let place = direction * random_between(67, index, 0.55, 1.0).sqrt() * (SAND_RADIUS - 0.12);
    let radius = random_between(71, index, 0.02, 0.06);
    let color = gradient(
        &[
            (0.0, 0x5c6670),
            (0.3, 0x8c8478),
            (0.5, 0xb8a890),
            (0.7, 0x7c4c3c),
            (0.85, 0x4c7078),
            (1.0, 0xd8d0c4),
        ],
        random(73, index),
    );
    let lump = |point: DVec3| point * (1.0 + 0.25 * noise(79 + index, point * 1.5));
    ellipsoid(DVec3::ONE, detail.segments(10), detail.segments(6))
        .displaced(lump)
        .painted(|point| mix(color, WHITE, 0.25 * noise(83, point * 2.5)))
        .placed(
            shift(place.x, sand_height(place.x, place.y) + radius * 0.2, place.y)
                * turn_y(random(89, index))
                * stretch(radius, radius * 0.6, radius * 0.8),
        )
}
