//! Coiled shells: a cross-section that grows by a constant factor with each turn around an axis (Raup 1966).

use crate::color::{Color, smooth_step};
use crate::detail::Detail;
use crate::mesh::Mesh;
use crate::primitives::{Ends, rings};
use crate::trigonometry::{circle, power};
use glam::DVec3;

/// The form of a shell that coils around the z axis, counter-clockwise seen from +z. Lengths are those at the opening.
#[derive(Debug, Clone, Copy)]
pub struct Coil {
    /// Turns from the first, closed end to the opening.
    pub turns: f64,
    /// Factor by which everything grows in a turn.
    pub growth: f64,
    /// From the axis to the middle of the cross-section.
    pub distance: f64,
    /// From the point where all turns would end to the middle of the opening, along the axis.
    pub rise: f64,
    /// Half the cross-section away from the axis.
    pub half_width: f64,
    /// Half the cross-section along the axis.
    pub half_height: f64,
    /// How far the wall reaches back inside, in turns.
    pub depth: f64,
    /// Thickness of the wall, in parts of the cross-section's radius.
    pub wall: f64,
}

/// A place on the wall of a shell.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    /// Turns before the opening, zero or less.
    pub turn: f64,
    /// Angle around the cross-section in turns: 0 farthest from the axis, a quarter towards +z.
    pub around: f64,
    /// Whether this is the inner side of the wall.
    pub inside: bool,
    /// Position on the outer wall before any relief.
    pub position: DVec3,
}

impl Coil {
    /// Builds the shell as one closed surface: outer wall, lip, inner wall and a partition at its end.
    ///
    /// At detail 1 there are `rows_per_turn` rows in a turn, and a column at each of the angles `columns`, which rise from 0
    /// and stay below 1. `relief` raises the wall by a part of the cross-section's radius, `paint` colours all of it.
    pub fn build(
        &self,
        detail: Detail,
        rows_per_turn: f64,
        columns: &[f64],
        relief: impl Fn(&Place) -> f64,
        paint: impl Fn(&Place) -> Color,
    ) -> Mesh {
        let columns = subdivided(columns, detail);
        let count = |turns: f64| detail.segments((turns * rows_per_turn).ceil() as usize).max(2);
        let (outer, inner) = (count(self.turns), count(self.depth / 2.0));
        let path: Vec<(f64, bool)> = (0..outer)
            .map(|row| (self.turns * (row as f64 / (outer - 1) as f64 - 1.0), false))
            .chain((0..inner).map(|row| (-self.depth * row as f64 / (inner - 1) as f64, true)))
            .collect();
        let point = |row: usize, column: usize| {
            let (turn, inside) = path[row];
            // From the outside towards -z first, so that the columns run counter-clockwise about the direction of growth.
            let around = 1.0 - columns[column];
            let place = Place { turn, around, inside, position: self.surface(turn, around, 1.0) };
            let reach = 1.0 + relief(&place) - if inside { self.thickness(turn) } else { 0.0 };
            (self.surface(turn, around, reach), paint(&place))
        };
        let ends = Ends::Points(self.middle(-self.turns), self.middle(-self.depth));
        rings(path.len(), columns.len(), ends, point)
    }

    /// The wall is thinner at the lip, which is rounded by it.
    fn thickness(&self, turn: f64) -> f64 {
        self.wall * (0.4 + 0.6 * smooth_step(0.0, 0.03, -turn))
    }

    fn middle(&self, turn: f64) -> DVec3 {
        let outward = circle(turn);
        let size = power(self.growth, turn);
        DVec3::new(self.distance * outward.x, self.distance * outward.y, self.rise) * size
    }

    /// The point of the cross-section at `around`, `reach` times as far from its middle as the plain wall.
    fn surface(&self, turn: f64, around: f64, reach: f64) -> DVec3 {
        let outward = circle(turn).extend(0.0);
        let direction = circle(around);
        let offset = outward * (direction.x * self.half_width) + DVec3::Z * (direction.y * self.half_height);
        self.middle(turn) + offset * (reach * power(self.growth, turn))
    }
}

/// Divides the steps between the angles of a full turn evenly.
fn subdivided(angles: &[f64], detail: Detail) -> Vec<f64> {
    let parts = detail.segments(1);
    let next = angles.iter().skip(1).copied().chain([1.0]);
    let steps = angles.iter().zip(next);
    steps
        .flat_map(|(&from, to)| (0..parts).map(move |part| from + (to - from) * part as f64 / parts as f64))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::topology::{open_edges, volume};

    const COIL: Coil = Coil {
        turns: 2.0,
        growth: 2.0,
        distance: 1.0,
        rise: 0.5,
        half_width: 0.3,
        half_height: 0.2,
        depth: 0.25,
        wall: 0.1,
    };

    #[test]
    fn a_turn_earlier_everything_is_smaller_by_the_growth() {
        for around in [0.0, 0.2, 0.7] {
            let (now, earlier) = (COIL.surface(-0.3, around, 1.0), COIL.surface(-1.3, around, 1.0));
            assert!((now / COIL.growth).distance(earlier) < 1e-12);
        }
    }

    #[test]
    fn the_shell_is_closed_and_has_the_volume_of_its_cross_sections() {
        let columns: Vec<f64> = (0..32).map(|column| f64::from(column) / 32.0).collect();
        let solid = Coil { depth: 0.0, wall: 0.0, ..COIL };
        let mesh = solid.build(Detail(2), 60.0, &columns, |_| 0.0, |_| DVec3::ONE);
        assert_eq!(open_edges(&mesh), 0);
        // Pappus: area of the section times the way of its middle around the axis, both growing with the turn;
        // the integral of growth^(3 turn) over the turns is (1 - growth^(-3 turns)) / ln(growth^3).
        let area = std::f64::consts::PI * COIL.half_width * COIL.half_height;
        let turns = (1.0 - 2f64.powf(-3.0 * COIL.turns)) / 8f64.ln();
        let expected = area * std::f64::consts::TAU * COIL.distance * turns;
        assert!((volume(&mesh) / expected - 1.0).abs() < 0.02, "{} {expected}", volume(&mesh));
    }

    #[test]
    fn the_inner_wall_stays_inside_and_takes_volume_away() {
        let columns: Vec<f64> = (0..16).map(|column| f64::from(column) / 16.0).collect();
        let relief = |place: &Place| 0.1 * crate::trigonometry::cosine(place.turn * 7.0);
        let hollow = COIL.build(Detail(1), 40.0, &columns, relief, |_| DVec3::ONE);
        let solid =
            Coil { depth: 0.0, wall: 0.0, ..COIL }.build(Detail(1), 40.0, &columns, relief, |_| DVec3::ONE);
        assert_eq!(open_edges(&hollow), 0);
        assert!(volume(&hollow) < 0.9 * volume(&solid));
    }

    #[test]
    fn finer_columns_keep_the_given_angles() {
        assert_eq!(subdivided(&[0.0, 0.5], Detail(2)), [0.0, 0.25, 0.5, 0.75]);
        assert_eq!(subdivided(&[0.0, 0.1, 0.9], Detail(1)), [0.0, 0.1, 0.9]);
    }
}
