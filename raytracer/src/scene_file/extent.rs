//! How far the things of a scene reach, over the whole animation.

use super::instance::Actor;
use crate::octree::Octree;
use crate::scene::Similarity;
use glam::{DQuat, DVec3};
use std::iter;

/// Where all models are, at all key frames.
#[derive(Debug)]
pub(super) struct Extent {
    /// Points that show it: the outline of a model that stands alone, else the corners of the boxes around the models.
    pub points: Vec<DVec3>,
    /// The box around the models, low corner and high corner.
    pub bounds: [DVec3; 2],
}

impl Extent {
    /// `octree` leads to that of an actor.
    pub fn new<'a>(actors: &[Actor], octree: impl Fn(&Actor) -> &'a Octree) -> Self {
        let is_alone = actors.len() == 1;
        let mut points = Vec::new();
        for (actor, model) in actors.iter().map(|actor| (actor, octree(actor))) {
            if model.leaf_voxels() == 0 {
                continue;
            }
            // The outline takes a while, so it is made only where a box around the model would be far too large.
            let mut outline = None;
            for placement in placements(actor, model) {
                if is_alone || is_tilted(&placement) {
                    let outline = outline.get_or_insert_with(|| model.outline());
                    let around = outline.iter().map(|point| placement.to_scene(*point));
                    if is_alone { points.extend(around) } else { points.extend(corners(bounds(around))) }
                } else {
                    let own = model.unit_bounds().map(DVec3::from_array);
                    points.extend(corners(placement.box_around(own)));
                }
            }
        }
        if points.is_empty() {
            points.extend(corners([DVec3::ZERO, DVec3::ONE]));
        }
        Self { bounds: bounds(points.iter().copied()), points }
    }

    /// The middle of the box around the models.
    pub fn middle(&self) -> DVec3 {
        (self.bounds[0] + self.bounds[1]) / 2.0
    }

    /// The longest edge of the box around the models.
    pub fn size(&self) -> f64 {
        (self.bounds[1] - self.bounds[0]).max_element()
    }

    /// As an eye sees it that goes round an axis through the middle, by each of the angles, in radians.
    pub fn turned(&self, axis: DVec3, angles: impl Iterator<Item = f64>) -> Vec<DVec3> {
        let middle = self.middle();
        let turn = |angle: f64| {
            let rotation = DQuat::from_axis_angle(axis, -angle);
            self.points.iter().map(move |point| middle + rotation * (*point - middle))
        };
        angles.flat_map(turn).collect()
    }
}

/// Where an actor is at the beginning and at its key frames.
fn placements(actor: &Actor, octree: &Octree) -> impl Iterator<Item = Similarity> {
    let later = actor.key_frames().iter().copied().filter(|frame| *frame > 0);
    iter::once(0).chain(later).map(|frame| actor.pose(frame).placement(actor.anchor, octree))
}

/// Whether what is up in the model is not up in the scene.
fn is_tilted(placement: &Similarity) -> bool {
    (placement.rotation * DVec3::Y).distance(DVec3::Y) > 1e-9
}

fn bounds(points: impl Iterator<Item = DVec3>) -> [DVec3; 2] {
    points
        .fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], point| [low.min(point), high.max(point)])
}

fn corners([low, high]: [DVec3; 2]) -> [DVec3; 8] {
    std::array::from_fn(|corner| {
        let upper = glam::BVec3::new(corner & 1 != 0, corner & 2 != 0, corner & 4 != 0);
        DVec3::select(upper, high, low)
    })
}
