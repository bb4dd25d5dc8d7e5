//! Gulls above the sea and sheep on the meadow.

use super::paints::Paints;
use super::{block, on_ground};
use crate::detail::Detail;
use crate::mesh::Mesh;
use crate::noise::random;
use crate::placement::{scale, shift, turn_x, turn_y, turn_z};
use crate::primitives::{cylinder, ellipsoid, prism};
use glam::{DVec2, DVec3};

/// Gulls at fixed places around the tower.
pub fn gulls(detail: Detail, paints: &Paints) -> Mesh {
    [
        (-1.0, 1.35, -0.2, 0.05),
        (0.5, 1.5, -0.5, 0.2),
        (0.95, 1.15, 0.2, 0.12),
        (-0.85, 0.8, 0.65, -0.05),
        (0.15, 1.2, -0.1, 0.3),
    ]
    .into_iter()
    .map(|(x, y, z, heading)| {
        gull(detail, paints).placed(shift(x, y, z) * turn_y(heading) * turn_x(0.04) * scale(1.25))
    })
    .collect()
}

/// A gull that flies towards +x, its wings along z.
fn gull(detail: Detail, paints: &Paints) -> Mesh {
    let body =
        ellipsoid(DVec3::new(0.055, 0.017, 0.017), detail.segments(8), detail.segments(5)).of(paints.white);
    let head = ellipsoid(DVec3::splat(0.013), 6, 4).placed(shift(0.052, 0.008, 0.0)).of(paints.white);
    let beak =
        cylinder(0.005, 0.0, 0.022, 6).placed(shift(0.062, 0.007, 0.0) * turn_z(-0.26)).of(paints.beak);
    let wing = |side: f64| -> Mesh {
        // Drawn in the plane of x and y, then laid flat; the outer half is bent down.
        let inner = [(-0.022, 0.0), (0.028, 0.0), (0.026, 0.07), (-0.014, 0.07)].map(DVec2::from);
        let outer = [(-0.014, 0.0), (0.026, 0.0), (-0.012, 0.085)].map(DVec2::from);
        let bent = prism(&outer, 0.006).placed(shift(0.0, 0.068, 0.0) * turn_x(-0.07)).of(paints.dark);
        let whole: Mesh = [prism(&inner, 0.007).of(paints.white), bent].into_iter().collect();
        // The two wings are half a turn apart around the way of flight, and raised.
        whole.placed(turn_x(side))
    };
    let tail =
        prism(&[(-0.075, -0.018), (-0.04, -0.006), (-0.04, 0.006), (-0.075, 0.018)].map(DVec2::from), 0.006);
    let tail = tail.placed(turn_x(0.25)).of(paints.white);
    [body.smooth(), head.smooth(), beak, wing(0.22), wing(-0.22), tail].into_iter().collect()
}

/// A few sheep on the meadow in front of the houses.
pub fn sheep(detail: Detail, paints: &Paints) -> Mesh {
    [(-0.55, 0.25), (-0.68, 0.12), (-0.5, 0.42), (0.7, 0.3)]
        .into_iter()
        .enumerate()
        .map(|(index, place)| {
            one_sheep(detail, paints).placed(on_ground(DVec2::from(place), random(337, index as u32)))
        })
        .collect()
}

/// A sheep that looks towards +x.
fn one_sheep(detail: Detail, paints: &Paints) -> Mesh {
    let ball = |radii: [f64; 3], [x, y, z]: [f64; 3]| {
        ellipsoid(DVec3::from_array(radii), detail.segments(8), detail.segments(5))
            .placed(shift(x, y, z))
            .smooth()
    };
    let legs = [(-0.025, -0.014), (-0.025, 0.014), (0.025, -0.014), (0.025, 0.014)]
        .map(|(x, z)| block([0.009, 0.05, 0.009], [x, 0.015, z]).of(paints.dark));
    let body = ball([0.046, 0.032, 0.03], [0.0, 0.055, 0.0]).of(paints.wool);
    let head = ball([0.02, 0.015, 0.014], [0.055, 0.068, 0.0]).of(paints.dark);
    let cap = ball([0.013, 0.011, 0.013], [0.047, 0.079, 0.0]).of(paints.wool);
    [body, head, cap].into_iter().chain(legs).collect()
}
