//! Moves, turns and scalings that put a part in its place; combined with `*`, the rightmost acts first.

use crate::trigonometry::circle;
use glam::{DAffine3, DMat3, DVec3};

/// A shift.
pub fn shift(x: f64, y: f64, z: f64) -> DAffine3 {
    DAffine3::from_translation(DVec3::new(x, y, z))
}

/// A scaling by one factor.
pub fn scale(factor: f64) -> DAffine3 {
    stretch(factor, factor, factor)
}

/// A scaling by a positive factor for each axis.
pub fn stretch(x: f64, y: f64, z: f64) -> DAffine3 {
    DAffine3::from_scale(DVec3::new(x, y, z))
}

/// A turn around the x axis, from y to z.
pub fn turn_x(turns: f64) -> DAffine3 {
    let (cosine, sine) = circle(turns).into();
    turn(DVec3::X, DVec3::new(0.0, cosine, sine), DVec3::new(0.0, -sine, cosine))
}

/// A turn around the y axis, from z to x: counter-clockwise seen from above.
pub fn turn_y(turns: f64) -> DAffine3 {
    let (cosine, sine) = circle(turns).into();
    turn(DVec3::new(cosine, 0.0, -sine), DVec3::Y, DVec3::new(sine, 0.0, cosine))
}

/// A turn around the z axis, from x to y.
pub fn turn_z(turns: f64) -> DAffine3 {
    let (cosine, sine) = circle(turns).into();
    turn(DVec3::new(cosine, sine, 0.0), DVec3::new(-sine, cosine, 0.0), DVec3::Z)
}

fn turn(x: DVec3, y: DVec3, z: DVec3) -> DAffine3 {
    DAffine3::from_mat3(DMat3::from_cols(x, y, z))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_turn_takes_one_axis_to_the_next() {
        for (turned, expected) in [
            (turn_x(0.25).transform_vector3(DVec3::Y), DVec3::Z),
            (turn_y(0.25).transform_vector3(DVec3::Z), DVec3::X),
            (turn_z(0.25).transform_vector3(DVec3::X), DVec3::Y),
        ] {
            assert!(turned.distance(expected) < 1e-12, "{turned}");
        }
    }
}
