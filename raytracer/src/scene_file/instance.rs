//! `[[instance]]`: where models stand, and how they move.

use super::error::SceneFileError;
use super::model::Models;
use super::text::{Text, value};
use super::track::{Track, frames};
use super::value::{FrameNumber, Point, Positive, Turn};
use crate::octree::Octree;
use crate::scene::Similarity;
use glam::{DQuat, DVec3};
use serde::Deserialize;
use toml::Spanned;

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct InstanceTable {
    model: Spanned<String>,
    position: Option<Spanned<Point>>,
    turn: Option<Spanned<Turn>>,
    scale: Option<Spanned<Positive>>,
    #[serde(default)]
    anchor: Anchor,
    #[serde(default)]
    key: Vec<InstanceKeyTable>,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct InstanceKeyTable {
    frame: Spanned<FrameNumber>,
    position: Option<Spanned<Point>>,
    turn: Option<Spanned<Turn>>,
    scale: Option<Spanned<Positive>>,
}

/// Which point of a model stands at its position.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Anchor {
    /// The cube's corner (0, 0, 0).
    #[default]
    Cube,
    /// The middle of the box around the voxels.
    Center,
    /// The middle of the lower side of that box.
    Base,
}

impl Anchor {
    /// The point in unit space.
    fn point(self, octree: &Octree) -> DVec3 {
        let [low, high] = octree.unit_bounds().map(DVec3::from_array);
        let middle = (low + high) / 2.0;
        match self {
            Self::Cube => DVec3::ZERO,
            Self::Center => middle,
            Self::Base => middle.with_y(low.y),
        }
    }
}

/// How a model stands at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pose {
    /// Where the anchor is in the scene.
    pub position: DVec3,
    pub rotation: DQuat,
    /// Length of the cube's edge in the scene.
    pub scale: f64,
}

impl Pose {
    pub const IDENTITY: Self = Self { position: DVec3::ZERO, rotation: DQuat::IDENTITY, scale: 1.0 };

    pub fn placement(&self, anchor: Anchor, octree: &Octree) -> Similarity {
        let Self { position, rotation, scale } = *self;
        Similarity { scale, rotation, translation: position - rotation * (anchor.point(octree) * scale) }
    }
}

/// A model that stands or moves in the scene.
#[derive(Debug, Clone)]
pub(super) struct Actor {
    /// Which of the scene file's models.
    pub model: usize,
    pub anchor: Anchor,
    motion: Motion,
}

#[derive(Debug, Clone)]
enum Motion {
    /// Does not move. `size` is the scale that absorption is made for.
    Still {
        pose: Pose,
        size: f64,
    },
    Keys {
        frames: Vec<u32>,
        position: Track<DVec3>,
        turn: Track<DQuat>,
        scale: Track<f64>,
    },
}

impl Actor {
    pub fn new(text: &Text, models: &Models, table: &InstanceTable) -> Result<Self, SceneFileError> {
        let model = models.find(text, table.model.get_ref(), &table.model.span())?;
        let frames = frames(text, table.key.iter().map(|key| key.frame.clone()))?;
        let own = (value(table.position.as_ref()), value(table.turn.as_ref()), value(table.scale.as_ref()));
        let keys = || frames.iter().copied().zip(&table.key);
        let position = Track::new(
            text,
            "position",
            own.0.map(|Point(point)| point),
            keys().map(|(frame, key)| (frame, mapped(key.position.as_ref(), |Point(point)| point))),
        )?;
        let turn = Track::new(
            text,
            "turn",
            own.1.map(|Turn(turn)| turn),
            keys().map(|(frame, key)| (frame, mapped(key.turn.as_ref(), |Turn(turn)| turn))),
        )?;
        let scale = Track::new(
            text,
            "scale",
            own.2.map(|Positive(scale)| scale),
            keys().map(|(frame, key)| (frame, mapped(key.scale.as_ref(), |Positive(scale)| scale))),
        )?;
        Ok(Self { model, anchor: table.anchor, motion: Motion::Keys { frames, position, turn, scale } })
    }

    /// One that does not move. What it absorbs is as if it had the scale `size`.
    pub fn still(model: usize, anchor: Anchor, pose: Pose, size: f64) -> Self {
        Self { model, anchor, motion: Motion::Still { pose, size } }
    }

    pub fn pose(&self, frame: u32) -> Pose {
        match &self.motion {
            Motion::Still { pose, .. } => *pose,
            Motion::Keys { position, turn, scale, .. } => Pose {
                position: position.at(frame, DVec3::lerp).unwrap_or(Pose::IDENTITY.position),
                rotation: turn.at(frame, DQuat::slerp).map_or(Pose::IDENTITY.rotation, DQuat::normalize),
                scale: scale.at(frame, |from, to, share| from + (to - from) * share).unwrap_or(1.0),
            },
        }
    }

    /// The scale that absorption is made for, of a pose.
    pub fn size(&self, pose: &Pose) -> f64 {
        match &self.motion {
            Motion::Still { size, .. } => *size,
            Motion::Keys { .. } => pose.scale,
        }
    }

    /// The frames between which it moves evenly; empty if it does not move.
    pub fn key_frames(&self) -> &[u32] {
        match &self.motion {
            Motion::Still { .. } => &[],
            Motion::Keys { frames, .. } => frames,
        }
    }
}

/// Another value at the same place.
pub(super) fn mapped<T: Copy, U>(spanned: Option<&Spanned<T>>, map: impl Fn(T) -> U) -> Option<Spanned<U>> {
    spanned.map(|spanned| Spanned::new(spanned.span(), map(*spanned.get_ref())))
}
