//! Lamps, in double precision: what arrives from a point of them. See [`Light`] for what the numbers mean.

use crate::scene::{Light, Source};
use glam::{DVec2, DVec3, Vec3};
use std::f64::consts::TAU;

/// Light that arrives at a point, if nothing is in between.
#[derive(Debug, Clone, Copy)]
pub(super) struct Arriving {
    /// Unit vector towards the lamp.
    pub towards: DVec3,
    /// How far it is away; infinitely if it has no place.
    pub distance: f64,
    /// Amount of light on a surface that faces the lamp.
    pub amount: DVec3,
}

/// What arrives at `position` from a point of a lamp, chosen by two numbers in [0, 1); without them from its middle.
pub(super) fn arriving(light: &Light, position: DVec3, chosen: Option<DVec2>) -> Arriving {
    let color = light.color.as_dvec3();
    let from_point = |from: DVec3| {
        let distance = from.distance(position).max(f64::MIN_POSITIVE);
        let towards = (from - position) / distance;
        Arriving { towards, distance, amount: color / (distance * distance) }
    };
    let on_ball = |middle: Vec3, radius: f32| {
        let middle = middle.as_dvec3();
        let axis = (middle - position).normalize_or(DVec3::Y);
        from_point(middle + on_disk(axis, chosen) * f64::from(radius))
    };
    match light.source {
        Source::Directional { towards, radius } => {
            let axis = towards.as_dvec3().normalize_or_zero();
            let reach = f64::from(radius).tan();
            let towards = (axis + on_disk(axis, chosen) * reach).normalize_or_zero();
            Arriving { towards, distance: f64::INFINITY, amount: color }
        }
        Source::Point { position, radius } => on_ball(position, radius),
        Source::Spot { position, radius, towards, cone } => {
            let arriving = on_ball(position, radius);
            let cosine = -arriving.towards.dot(towards.as_dvec3());
            let [all, none] = cone.map(f64::from);
            let share = if cosine >= all {
                1.0
            } else if cosine <= none {
                0.0
            } else {
                let way = (cosine - none) / (all - none);
                way * way * (3.0 - 2.0 * way)
            };
            Arriving { amount: arriving.amount * share, ..arriving }
        }
        Source::Area { position, right, up } => {
            let [right, up] = [right, up].map(|edge| edge.as_dvec3());
            let place = chosen.map_or(DVec2::ZERO, |chosen| chosen * 2.0 - 1.0);
            let arriving = from_point(position.as_dvec3() + right * place.x + up * place.y);
            let front = right.cross(up).normalize_or_zero();
            Arriving { amount: arriving.amount * (-arriving.towards.dot(front)).max(0.0), ..arriving }
        }
    }
}

/// A point of the unit disk across an axis, evenly for evenly spread numbers; its middle without them.
fn on_disk(axis: DVec3, chosen: Option<DVec2>) -> DVec3 {
    let Some(DVec2 { x, y }) = chosen else { return DVec3::ZERO };
    if axis == DVec3::ZERO {
        return DVec3::ZERO;
    }
    let (right, up) = axis.any_orthonormal_pair();
    let (sine, cosine) = (TAU * y).sin_cos();
    (right * cosine + up * sine) * x.sqrt()
}
