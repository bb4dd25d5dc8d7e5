//! `[camera]`: where the eye is, how it moves, and its lens.

use super::error::{SceneFileError, SceneProblem};
use super::extent::Extent;
use super::instance::mapped;
use super::text::{Span, Text, value};
use super::track::{Track, frames};
use super::value::{Amount, Direction, FieldOfView, FrameNumber, NotNegative, Number, Point, Positive};
use crate::camera::framing_points;
use crate::{Camera, CameraError, DEFAULT_FOV, Lens, Projection};
use glam::{DQuat, DVec3};
use serde::Deserialize;
use toml::Spanned;

#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CameraTable {
    eye: Option<Spanned<Point>>,
    target: Option<Spanned<Point>>,
    up: Option<Spanned<Direction>>,
    fov: Option<Spanned<FieldOfView>>,
    projection: Option<ProjectionName>,
    height: Option<Spanned<Positive>>,
    aperture: Option<NotNegative>,
    focus: Option<Positive>,
    #[serde(default)]
    key: Vec<CameraKeyTable>,
    turntable: Option<Turntable>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum ProjectionName {
    Perspective,
    Orthographic,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct CameraKeyTable {
    frame: Spanned<FrameNumber>,
    eye: Option<Spanned<Point>>,
    target: Option<Spanned<Point>>,
    up: Option<Spanned<Direction>>,
    fov: Option<Spanned<FieldOfView>>,
}

/// An eye that goes round.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
struct Turntable {
    frames: Amount,
    #[serde(default = "upwards")]
    axis: Direction,
    #[serde(default = "once")]
    angle: Number,
}

fn upwards() -> Direction {
    Direction(DVec3::Y)
}

fn once() -> Number {
    Number(360.0)
}

impl Turntable {
    /// How far it has turned at a frame, in radians. The first frame follows the last.
    fn angle(&self, frame: u32) -> f64 {
        (self.angle.0 * (f64::from(frame) / f64::from(self.frames.0))).to_radians()
    }
}

/// The camera over time.
#[derive(Debug, Clone)]
pub(super) struct CameraPath {
    eye: Track<DVec3>,
    target: Track<DVec3>,
    up: Track<DVec3>,
    fov: Track<f64>,
    turntable: Option<Turntable>,
    projection: ProjectionName,
    height: Option<f64>,
    aperture: f64,
    focus: Option<f64>,
    /// One more than the last key frame, or 0.
    key_frames: u32,
    /// Where the file speaks of it.
    span: Span,
}

impl CameraPath {
    pub fn new(text: &Text, table: Option<Spanned<CameraTable>>) -> Result<Self, SceneFileError> {
        let span = table.as_ref().map_or(0..0, Spanned::span);
        let table = table.map(Spanned::into_inner).unwrap_or_default();
        let projection = table.projection.unwrap_or(ProjectionName::Perspective);
        if let Some(height) = table.height.as_ref().filter(|_| projection == ProjectionName::Perspective) {
            let advice = "give `fov`, or `projection = \"orthographic\"`".into();
            let problem = SceneProblem::Useless { key: "height", of: "a perspective", advice };
            return Err(text.error(&height.span(), problem));
        }
        let frames = frames(text, table.key.iter().map(|key| key.frame.clone()))?;
        let keys = || frames.iter().copied().zip(&table.key);
        let point = |Point(point)| point;
        let direction = |Direction(direction)| direction;
        let degrees = |FieldOfView(degrees)| degrees;
        let path = Self {
            eye: Track::new(
                text,
                "eye",
                value(table.eye.as_ref()).map(point),
                keys().map(|(frame, key)| (frame, mapped(key.eye.as_ref(), point))),
            )?,
            target: Track::new(
                text,
                "target",
                value(table.target.as_ref()).map(point),
                keys().map(|(frame, key)| (frame, mapped(key.target.as_ref(), point))),
            )?,
            up: Track::new(
                text,
                "up",
                value(table.up.as_ref()).map(direction),
                keys().map(|(frame, key)| (frame, mapped(key.up.as_ref(), direction))),
            )?,
            fov: Track::new(
                text,
                "fov",
                value(table.fov.as_ref()).map(degrees),
                keys().map(|(frame, key)| (frame, mapped(key.fov.as_ref(), degrees))),
            )?,
            turntable: table.turntable,
            projection,
            height: value(table.height.as_ref()).map(|height| height.0),
            aperture: table.aperture.map_or(0.0, |aperture| aperture.0),
            focus: table.focus.map(|focus| focus.0),
            key_frames: frames.last().map_or(0, |last| last + 1),
            span,
        };
        // What does not depend on the models is wrong now, not only when they have been loaded.
        for frame in frames.iter().copied().chain([0]) {
            if let (Some(eye), Some(target)) = (path.eye.smooth(frame), path.target.smooth(frame)) {
                let camera = Camera { eye, target, up: path.up(frame), vertical_fov: DEFAULT_FOV };
                path.check(text, &camera)?;
            }
        }
        Ok(path)
    }

    /// The frame after the last in which something changes.
    pub fn frames(&self) -> u32 {
        self.key_frames.max(self.turntable.map_or(0, |turntable| turntable.frames.0))
    }

    /// The camera at a frame, of a picture of which `aspect` is the width over the height.
    pub fn at<'e>(
        &self,
        text: &Text,
        frame: u32,
        aspect: f64,
        extent: &impl Fn() -> &'e Extent,
    ) -> Result<(Camera, Lens), SceneFileError> {
        let camera = self.camera(frame, aspect, extent);
        self.check(text, &camera)?;
        let projection = match (self.projection, self.height) {
            (ProjectionName::Perspective, _) => Projection::Perspective,
            (ProjectionName::Orthographic, Some(height)) => Projection::Orthographic { height },
            (ProjectionName::Orthographic, None) => {
                let first = if frame == 0 { camera } else { self.camera(0, aspect, extent) };
                Projection::Orthographic { height: height_of_all(&first, aspect, &self.seen(extent())) }
            }
        };
        Ok((camera, Lens { projection, aperture: self.aperture, focus: self.focus }))
    }

    fn camera<'e>(&self, frame: u32, aspect: f64, extent: &impl Fn() -> &'e Extent) -> Camera {
        let vertical_fov = self.fov.at(frame, |from, to, share| from + (to - from) * share);
        let vertical_fov = vertical_fov.unwrap_or(DEFAULT_FOV);
        let (eye, target) = (self.eye.smooth(frame), self.target.smooth(frame));
        let (eye, target, pivot) = if let (Some(eye), Some(target)) = (eye, target) {
            (eye, target, target)
        } else {
            let extent = extent();
            let framing =
                framing_points(&self.seen(extent), extent.middle(), extent.size(), aspect, vertical_fov);
            let pivot = target.unwrap_or(if eye.is_some() { framing.target } else { extent.middle() });
            (eye.unwrap_or(framing.eye), target.unwrap_or(framing.target), pivot)
        };
        let turn = |turntable: &Turntable| DQuat::from_axis_angle(turntable.axis.0, turntable.angle(frame));
        let turn = self.turntable.as_ref().map_or(DQuat::IDENTITY, turn);
        Camera {
            eye: pivot + turn * (eye - pivot),
            target: pivot + turn * (target - pivot),
            up: turn * self.up(frame),
            vertical_fov,
        }
    }

    fn up(&self, frame: u32) -> DVec3 {
        self.up.at(frame, DVec3::lerp).unwrap_or(DVec3::Y)
    }

    /// What has to be in the picture: seen by an eye that goes round, all that comes before it.
    fn seen(&self, extent: &Extent) -> Vec<DVec3> {
        /// More directions than these hardly add anything.
        const DIRECTIONS: u32 = 24;
        let Some(turntable) = &self.turntable else {
            return extent.points.clone();
        };
        let steps = turntable.frames.0.min(DIRECTIONS);
        let frame = |step: u32| (u64::from(step) * u64::from(turntable.frames.0) / u64::from(steps)) as u32;
        extent.turned(turntable.axis.0, (0..steps).map(|step| turntable.angle(frame(step))))
    }

    fn check(&self, text: &Text, camera: &Camera) -> Result<(), SceneFileError> {
        let Camera { eye, target, up, .. } = *camera;
        let forward = (target - eye).try_normalize().ok_or(CameraError::NoDirection { eye, target });
        let across = |forward: DVec3| {
            let across = up.try_normalize().map_or(0.0, |up| forward.cross(up).length());
            if across > 1e-9 { Ok(()) } else { Err(CameraError::NoUp { up }) }
        };
        forward.and_then(across).map_err(|error| text.error(&self.span, error.into()))
    }
}

/// The height of a picture without perspective that shows all points.
fn height_of_all(camera: &Camera, aspect: f64, points: &[DVec3]) -> f64 {
    /// The share of the picture's width or height that they fill.
    const FILLED: f64 = 0.9;
    let forward = (camera.target - camera.eye).normalize();
    let right = forward.cross(camera.up).normalize();
    let up = right.cross(forward);
    let across = points.iter().map(|point| {
        let offset = *point - camera.target;
        (offset.dot(right).abs() / aspect).max(offset.dot(up).abs())
    });
    let half = across.fold(0.0, f64::max);
    if half > 0.0 { 2.0 * half / FILLED } else { 1.0 }
}
