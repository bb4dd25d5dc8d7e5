//! `[[light]]`: lamps.

use super::error::{SceneFileError, SceneProblem};
use super::text::{Text, given, value};
use super::value::{Color, Direction, DiskAngle, NotNegative, Number, Point};
use crate::scene::{Light, Source};
use glam::{DVec3, Vec3};
use serde::Deserialize;
use toml::Spanned;

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LightTable {
    kind: Spanned<Kind>,
    towards: Option<Spanned<Direction>>,
    direction: Option<Spanned<Direction>>,
    angle: Option<Spanned<DiskAngle>>,
    position: Option<Spanned<Point>>,
    radius: Option<Spanned<NotNegative>>,
    target: Option<Spanned<Point>>,
    cone: Option<Spanned<[Number; 2]>>,
    right: Option<Spanned<Point>>,
    up: Option<Spanned<Point>>,
    color: Option<Color>,
    intensity: Option<NotNegative>,
    shadow: Option<bool>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Kind {
    Directional,
    Point,
    Spot,
    Area,
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::Directional => "a directional light",
            Self::Point => "a point light",
            Self::Spot => "a spot light",
            Self::Area => "an area light",
        }
    }

    /// The keys that only some kinds have.
    fn keys(self) -> &'static [&'static str] {
        match self {
            Self::Directional => &["towards", "direction", "angle"],
            Self::Point => &["position", "radius"],
            Self::Spot => &["position", "radius", "target", "direction", "cone"],
            Self::Area => &["position", "right", "up"],
        }
    }
}

/// Degrees of a spot's cones if the file gives none.
const CONE: [f64; 2] = [25.0, 30.0];

/// The cosine of a cone is kept in single precision: of cones that are alike, the outer one must stay wider.
const LEAST_EDGE: f64 = 0.05;

impl LightTable {
    pub fn light(&self, text: &Text) -> Result<Light, SceneFileError> {
        self.check_keys(text)?;
        let source = match self.kind.get_ref() {
            Kind::Directional => self.directional(text)?,
            Kind::Point => Source::Point { position: self.position(text)?, radius: self.radius() },
            Kind::Spot => self.spot(text)?,
            Kind::Area => self.area(text)?,
        };
        let color = self.color.map_or(Vec3::ONE, |color| color.0);
        let intensity = self.intensity.map_or(1.0, |intensity| intensity.0);
        Ok(Light { source, color: color * intensity as f32, shadow: self.shadow.unwrap_or(true) })
    }

    /// No key of another kind.
    fn check_keys(&self, text: &Text) -> Result<(), SceneFileError> {
        let given = given([
            ("towards", self.towards.as_ref().map(Spanned::span)),
            ("direction", self.direction.as_ref().map(Spanned::span)),
            ("angle", self.angle.as_ref().map(Spanned::span)),
            ("position", self.position.as_ref().map(Spanned::span)),
            ("radius", self.radius.as_ref().map(Spanned::span)),
            ("target", self.target.as_ref().map(Spanned::span)),
            ("cone", self.cone.as_ref().map(Spanned::span)),
            ("right", self.right.as_ref().map(Spanned::span)),
            ("up", self.up.as_ref().map(Spanned::span)),
        ]);
        let kind = *self.kind.get_ref();
        for (key, span) in given {
            if !kind.keys().contains(&key) {
                let advice = format!("it has {}", kind.keys().join(", "));
                return Err(text.error(&span, SceneProblem::Useless { key, of: kind.name(), advice }));
            }
        }
        Ok(())
    }

    fn directional(&self, text: &Text) -> Result<Source, SceneFileError> {
        let towards = match (&self.towards, &self.direction) {
            (Some(_), Some(direction)) => {
                let problem = SceneProblem::Both { key: "direction", other: "towards" };
                return Err(text.error(&direction.span(), problem));
            }
            (Some(towards), None) => towards.get_ref().0,
            (None, Some(direction)) => -direction.get_ref().0,
            (None, None) => return Err(self.lacking(text, "towards")),
        };
        let angle = value(self.angle.as_ref()).map_or(0.0, |angle| angle.0);
        Ok(Source::Directional { towards: unit(towards), radius: (angle / 2.0).to_radians() as f32 })
    }

    fn spot(&self, text: &Text) -> Result<Source, SceneFileError> {
        let position = self.position(text)?;
        let towards = match (&self.target, &self.direction) {
            (Some(_), Some(direction)) => {
                let problem = SceneProblem::Both { key: "direction", other: "target" };
                return Err(text.error(&direction.span(), problem));
            }
            (Some(target), None) => {
                let towards = (target.get_ref().0 - position.as_dvec3()).to_array();
                let towards = Direction::try_from(towards);
                towards.map_err(|_| text.error(&target.span(), same_place()))?.0
            }
            (None, Some(direction)) => direction.get_ref().0,
            (None, None) => return Err(self.lacking(text, "target")),
        };
        let [inner, outer] = value(self.cone.as_ref()).map_or(CONE, |cone| cone.map(|angle| angle.0));
        if let Some(cone) = &self.cone {
            if !(0.0..=180.0).contains(&inner) || !(0.0..=180.0).contains(&outer) {
                let found = format!("found [{inner}, {outer}], expected degrees from 0 to 180");
                return Err(text.error(&cone.span(), SceneProblem::Invalid(found)));
            }
            if inner > outer {
                let problem = SceneProblem::Order { what: "the cone of", low: inner, high: outer };
                return Err(text.error(&cone.span(), problem));
            }
        }
        // A sharp edge is one that is too narrow to see.
        let outer = outer.max((inner + LEAST_EDGE).min(180.0));
        let inner = inner.min(outer - LEAST_EDGE);
        let cone = [inner, outer].map(|angle| angle.to_radians().cos() as f32);
        Ok(Source::Spot { position, radius: self.radius(), towards: unit(towards), cone })
    }

    fn area(&self, text: &Text) -> Result<Source, SceneFileError> {
        let position = self.position(text)?;
        let right = self.right.as_ref().ok_or_else(|| self.lacking(text, "right"))?;
        let up = self.up.as_ref().ok_or_else(|| self.lacking(text, "up"))?;
        let [across, along] = [right, up].map(|side| side.get_ref().0);
        // The sine of the angle between them, so that it does not depend on their size.
        let sine = across.normalize_or_zero().cross(along.normalize_or_zero()).length();
        let [right, up_vector] = [across, along].map(DVec3::as_vec3);
        if sine < 1e-6 || right.cross(up_vector).try_normalize().is_none() {
            return Err(text.error(&up.span(), SceneProblem::NoArea));
        }
        Ok(Source::Area { position, right, up: up_vector })
    }

    fn position(&self, text: &Text) -> Result<Vec3, SceneFileError> {
        let position = value(self.position.as_ref()).ok_or_else(|| self.lacking(text, "position"))?;
        Ok(position.0.as_vec3())
    }

    fn radius(&self) -> f32 {
        value(self.radius.as_ref()).map_or(0.0, |radius| radius.0 as f32)
    }

    fn lacking(&self, text: &Text, key: &'static str) -> SceneFileError {
        text.error(&self.kind.span(), SceneProblem::Lacking { key, of: self.kind.get_ref().name() })
    }
}

fn same_place() -> SceneProblem {
    SceneProblem::Invalid("the lamp is at its target; move one of them".into())
}

/// A unit vector in single precision.
fn unit(direction: DVec3) -> Vec3 {
    direction.as_vec3().normalize()
}
