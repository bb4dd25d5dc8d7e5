//! `[ground]`: a plane below it all.

use super::error::{SceneFileError, SceneProblem};
use super::text::Text;
use super::value::{ColorShare, NotNegative, Number, Positive};
use crate::scene::{Ground, SurfaceMaterial};
use glam::Vec3;
use serde::Deserialize;
use toml::Spanned;

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct GroundTable {
    height: Option<Number>,
    color: Option<Spanned<ColorShare>>,
    checker: Option<Spanned<[ColorShare; 2]>>,
    square: Option<Spanned<Positive>>,
    reflectivity: Option<ColorShare>,
    specular: Option<ColorShare>,
    shininess: Option<NotNegative>,
}

/// The share that a ground without a colour scatters.
const GREY: f32 = 0.5;

impl GroundTable {
    pub fn check(&self, text: &Text) -> Result<(), SceneFileError> {
        if let (Some(_), Some(checker)) = (&self.color, &self.checker) {
            return Err(text.error(&checker.span(), SceneProblem::Both { key: "checker", other: "color" }));
        }
        if let (Some(square), None) = (&self.square, &self.checker) {
            let advice = "add `checker` with two colours, or leave it out".into();
            let problem = SceneProblem::Useless { key: "square", of: "a ground of one colour", advice };
            return Err(text.error(&square.span(), problem));
        }
        Ok(())
    }

    /// `lowest` is asked where the ground is if the file does not say it.
    pub fn ground(&self, lowest: impl FnOnce() -> f64) -> Ground {
        let color = self.color.as_ref().map_or(Vec3::splat(GREY), |color| color.get_ref().0);
        let colors =
            self.checker.as_ref().map_or([color; 2], |checker| checker.get_ref().map(|color| color.0));
        let of = |share: Option<ColorShare>| share.map_or(Vec3::ZERO, |share| share.0);
        Ground {
            height: self.height.map_or_else(lowest, |height| height.0),
            surfaces: colors.map(|color| SurfaceMaterial {
                specular: of(self.specular),
                shininess: self.shininess.map_or(0.0, |exponent| exponent.0 as f32),
                reflectivity: of(self.reflectivity),
                ..SurfaceMaterial::matte(color)
            }),
            square: self.square.as_ref().map_or(1.0, |square| square.get_ref().0),
        }
    }
}
