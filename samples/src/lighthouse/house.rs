//! A house with plastered walls, windows, a chimney and a tiled roof.

use super::block;
use super::paints::Paints;
use crate::detail::Detail;
use crate::mesh::Mesh;
use crate::noise::random;
use crate::placement::{shift, turn_y, turn_z};
use crate::primitives::{prism, slab};
use crate::scene::Shades;
use crate::trigonometry::{angle, sine};
use glam::{DVec2, DVec3};

/// Measures and colours of a house. Its ridge runs along its own z axis, its door looks to +x.
#[derive(Debug, Clone, Copy)]
pub struct House {
    /// Where it stands: x and z.
    pub place: DVec2,
    /// Turn around the vertical.
    pub heading: f64,
    pub length: f64,
    pub width: f64,
    /// Height of the walls under the eaves.
    pub wall: f64,
    /// Which of the plasters.
    pub coat: usize,
    /// Which of the roof tiles.
    pub roof: usize,
}

/// Rise of a roof over its run.
const STEEPNESS: f64 = 0.85;
/// How far a roof reaches beyond the walls.
const OVERHANG: f64 = 0.03;
const TILE: f64 = 0.04;

impl House {
    /// The house on the plane y = 0.
    pub fn build(&self, detail: Detail, paints: &Paints) -> Mesh {
        let (half, ridge) = (self.width / 2.0, self.wall + self.width / 2.0 * STEEPNESS);
        let foundation = block([self.width + 0.02, 0.1, self.length + 0.02], [0.0, -0.025, 0.0]);
        let gable =
            [(-half, 0.0), (half, 0.0), (half, self.wall), (0.0, ridge), (-half, self.wall)].map(DVec2::from);
        let mut house = foundation.of(paints.rock.at(0.8));
        house.append(prism(&gable, self.length).of(paints.coats[self.coat]));
        for side in [0.0, 0.5] {
            house.append(self.roof_side(detail, &paints.tiles[self.roof]).placed(turn_y(side)));
        }
        let ridge_tiles = block([0.03, 0.02, self.length + 2.0 * OVERHANG], [0.0, ridge + 0.022, 0.0]);
        house.append(ridge_tiles.of(paints.tiles[self.roof].at(0.0)));
        house.append(self.chimney(ridge, paints));
        house.append(self.openings(paints));
        house
    }

    /// The half of the roof towards +x: rows of tiles that overlap downward, round from column to column.
    fn roof_side(&self, detail: Detail, tiles: &Shades) -> Mesh {
        let slope = DVec2::new(1.0, STEEPNESS);
        let run = self.width / 2.0 + OVERHANG;
        let fall = run * slope.length();
        let breadth = self.length + 2.0 * OVERHANG;
        let (down, across) = ((fall / TILE).round() as usize, (breadth / TILE).round() as usize);
        let (rows, columns) = (across * detail.segments(2), down * detail.segments(2));
        let plate = slab(columns, rows, -0.012, |u, v| {
            let step = (u * down as f64 + 1e-9).fract();
            let bulge = sine(v * across as f64 / 2.0).abs();
            DVec3::new(u * fall, 0.004 + 0.009 * step + 0.010 * bulge, (v - 0.5) * breadth)
        });
        let plate = plate.assigned(|_, center, _| {
            let (row, column) = ((center.x / TILE).floor(), (center.z / TILE).floor());
            tiles.at(random(self.roof as u32 + 3, (row * 131.0 + column) as i32 as u32))
        });
        let ridge = self.wall + self.width / 2.0 * STEEPNESS;
        plate.creased(0.12).placed(shift(0.0, ridge + 0.012, 0.0) * turn_z(-angle(slope)))
    }

    fn chimney(&self, ridge: f64, paints: &Paints) -> Mesh {
        let (x, z) = (-self.width * 0.2, self.length * 0.25);
        [
            block([0.05, 0.16, 0.05], [x, ridge + 0.01, z]).of(paints.tiles[0].at(0.1)),
            block([0.062, 0.016, 0.062], [x, ridge + 0.09, z]).of(paints.rock.at(0.9)),
            block([0.03, 0.02, 0.03], [x, ridge + 0.102, z]).of(paints.dark),
        ]
        .into_iter()
        .collect()
    }

    fn openings(&self, paints: &Paints) -> Mesh {
        let mut openings = Mesh::default();
        let (half, sill) = (self.width / 2.0, self.wall * 0.56);
        let door = [
            block([0.02, self.wall * 0.78, 0.075], [half, self.wall * 0.40, 0.0]).of(paints.white),
            block([0.03, self.wall * 0.70, 0.055], [half, self.wall * 0.37, 0.0]).of(paints.wood.at(0.3)),
            block([0.07, 0.025, 0.09], [half + 0.03, 0.02, 0.0]).of(paints.paving.at(0.4)),
        ];
        openings.extend(door);
        let window = |paint_box: f64| -> Mesh {
            [
                block([0.016, 0.068, 0.062], [0.0, 0.0, 0.0]).of(paints.white),
                block([0.022, 0.052, 0.046], [0.0, 0.0, 0.0]).of(paints.glass),
                block([0.026, 0.052, 0.006], [0.0, 0.0, 0.0]).of(paints.white),
                block([0.04, 0.02, 0.07], [0.012, -0.045, 0.0]).of(paints.wood.at(0.6)),
                block([0.03, 0.016, 0.062], [0.014, -0.03, 0.0]).of(paints.flowers.at(paint_box)),
            ]
            .into_iter()
            .collect()
        };
        let along = self.length * 0.31;
        for (index, z) in [-along, along].into_iter().enumerate() {
            let tone = random(7, index as u32 + self.coat as u32 * 2);
            openings.append(window(tone).placed(shift(half, sill, z)));
            openings.append(window(tone).placed(shift(-half, sill, z) * turn_y(0.5)));
        }
        for (turn, z) in [(-0.25, self.length / 2.0), (0.25, -self.length / 2.0)] {
            for (x, y) in [(-self.width * 0.22, sill), (self.width * 0.22, sill), (0.0, self.wall + 0.03)] {
                openings.append(window(random(11, self.coat as u32)).placed(shift(x, y, z) * turn_y(turn)));
            }
        }
        openings
    }
}
