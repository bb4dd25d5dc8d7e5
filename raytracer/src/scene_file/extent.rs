//! How far the things of a scene reach, over the whole animation.

use super::instance::Actor;
use crate::octree::Octree;
use crate::scene::Similarity;
use glam::{DQuat, DVec3};

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
        let mut points = Vec::new();
        let mut bounds = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        for actor in actors {
            let model = octree(actor);
            if model.leaf_voxels() == 0 {
                continue;
            }
            // The outline takes a while, so it is made only if the box around a model would say less.
            let mut outline = None;
            for placement in placements(actor, model) {
                let is_tilted = (placement.rotation * DVec3::Y - DVec3::Y).length() > 1e-9;
                let around = if is_tilted || actors.len() == 1 {
                    outline
                        .get_or_insert_with(|| model.outline())
                        .iter()
                        .map(|point| placement.to_scene(*point))
                        .collect()
                } else {
                    corners(model.unit_bounds().map(DVec3::from_array))
                        .map(|corner| placement.to_scene(corner))
                        .to_vec()
                };
                let around: Vec<DVec3> = around;
                let own = around.iter().fold([DVec3::INFINITY, DVec3::NEG_INFINITY], include);
                bounds = own.iter().fold(bounds, include);
                if actors.len() == 1 { points.extend(around) } else { points.extend(corners(own)) }
            }
        }
        if points.is_empty() {
            bounds = [DVec3::ZERO, DVec3::ONE];
            points = corners(bounds).to_vec();
        }
        Self { points, bounds }
    }

    /// The middle of the box around the models.
    pub fn middle(&self) -> DVec3 {
        (self.bounds[0] + self.bounds[1]) / 2.0
    }

    /// The longest edge of the box around the models.
    pub fn size(&self) -> f64 {
        (self.bounds[1] - self.bounds[0]).max_element()
    }

    /// As seen by an eye that goes round: turned about an axis through the middle by each of the angles, in radians.
    pub fn turned(&self, axis: DVec3, angles: impl Iterator<Item = f64>) -> Vec<DVec3> {
        let middle = self.middle();
        let turn = |angle: f64| {
            let rotation = DQuat::from_axis_angle(axis, -angle);
            self.points.iter().map(move |point| middle + rotation * (*point - middle))
        };
        angles.flat_map(turn).collect()
    }
}

/// Where an actor is at its key frames.
fn placements(actor: &Actor, octree: &Octree) -> impl Iterator<Item = Similarity> {
    let still = actor.key_frames().is_empty().then_some(0);
    let frames = actor.key_frames().iter().copied().chain(still);
    frames.map(|frame| actor.pose(frame).placement(actor.anchor, octree))
}

fn include([low, high]: [DVec3; 2], point: &DVec3) -> [DVec3; 2] {
    [low.min(*point), high.max(*point)]
}

fn corners([low, high]: [DVec3; 2]) -> [DVec3; 8] {
    std::array::from_fn(|corner| {
        let upper = glam::BVec3::new(corner & 1 != 0, corner & 2 != 0, corner & 4 != 0);
        DVec3::select(upper, high, low)
    })
}
