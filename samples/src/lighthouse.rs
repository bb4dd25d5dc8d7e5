//! `lighthouse`: a small island with a striped lighthouse, houses under tiled roofs, trees, a jetty and boats.
//!
//! All colours are materials, many of them: it looks the same in any program that reads MTL files.

mod house;
mod island;
mod life;
mod paints;
mod plants;
mod sea;
mod ships;
mod tower;

use crate::detail::Detail;
use crate::mesh::Mesh;
use crate::placement::{shift, turn_y};
use crate::primitives::cuboid;
use crate::scene::Scene;
use glam::{DAffine3, DVec2, DVec3};
use house::House;
use paints::Paints;

/// Where the tower stands: x and z.
const TOWER: DVec2 = DVec2::new(-0.42, -0.38);

/// Builds the scene. The sea's level is y = 0, the front of the island looks towards +z.
pub fn build(detail: Detail) -> Scene {
    let mut scene = Scene::new("lighthouse", "an island with a striped lighthouse, houses, trees and boats");
    let paints = Paints::new(&mut scene);
    scene.add(sea::water(detail, &paints));
    scene.add(sea::foam(detail, &paints));
    scene.add(island::ground(detail, &paints));
    scene.add(island::rocks(detail, &paints));
    scene.add(island::stepping_stones(detail, &paints));
    scene.add(tower::lighthouse(detail, &paints).placed(on_ground(TOWER, 0.0)));
    for house in &HOUSES {
        scene.add(house.build(detail, &paints).placed(on_ground(house.place, house.heading)));
    }
    scene.add(plants::trees(detail, &paints));
    scene.add(plants::flowers(detail, &paints));
    scene.add(ships::jetty(detail, &paints));
    scene.add(ships::sailing_boat(detail, &paints).placed(shift(1.1, 0.012, 0.84) * turn_y(0.16)));
    scene.add(ships::rowing_boat(detail, &paints).placed(shift(0.45, 0.012, 1.3) * turn_y(0.21)));
    scene.add(ships::buoy(detail, &paints).placed(shift(-1.1, 0.0, 0.95)));
    scene.add(life::gulls(detail, &paints));
    scene.add(life::sheep(detail, &paints));
    scene
}

const HOUSES: [House; 4] = [
    House {
        place: DVec2::new(0.16, -0.30),
        heading: 0.02,
        length: 0.44,
        width: 0.26,
        wall: 0.20,
        coat: 0,
        roof: 0,
    },
    House {
        place: DVec2::new(0.62, -0.12),
        heading: 0.19,
        length: 0.34,
        width: 0.24,
        wall: 0.17,
        coat: 1,
        roof: 1,
    },
    House {
        place: DVec2::new(-0.16, 0.30),
        heading: -0.06,
        length: 0.32,
        width: 0.22,
        wall: 0.16,
        coat: 2,
        roof: 0,
    },
    House {
        place: DVec2::new(0.36, 0.36),
        heading: 0.28,
        length: 0.26,
        width: 0.19,
        wall: 0.14,
        coat: 3,
        roof: 1,
    },
];

/// Puts a part that stands on its own plane y = 0 on the island's ground, turned around the vertical by `heading`.
fn on_ground(place: DVec2, heading: f64) -> DAffine3 {
    shift(place.x, island::height(place), place.y) * turn_y(heading)
}

/// A box with edges of the given lengths around a point.
fn block(size: [f64; 3], [x, y, z]: [f64; 3]) -> Mesh {
    cuboid(DVec3::from_array(size)).placed(shift(x, y, z))
}
