//! `[picture]` and `[quality]`: size, tone, and what may be approximated.

use super::error::{SceneFileError, SceneProblem};
use super::text::{Text, value};
use super::value::{MaybeInfinite, NotNegative, Positive, Rays, RaysEach, Times};
use crate::frame::MAX_PIXELS;
use crate::{Arithmetic, Filter, Leave, Quality, Tone, ToneMapping};
use serde::Deserialize;
use toml::Spanned;

#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PictureTable {
    pub size: Option<PictureSize>,
    exposure: Option<Positive>,
    tone: Option<Spanned<String>>,
}

/// Columns and rows.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(try_from = "[u32; 2]")]
pub(super) struct PictureSize(pub [u32; 2]);

impl TryFrom<[u32; 2]> for PictureSize {
    type Error = String;

    fn try_from([width, height]: [u32; 2]) -> Result<Self, String> {
        if width == 0 || height == 0 {
            return Err(format!("found [{width}, {height}], expected two numbers above zero"));
        }
        if u64::from(width) * u64::from(height) > MAX_PIXELS {
            return Err(format!("found [{width}, {height}], expected no more than {MAX_PIXELS} pixels"));
        }
        Ok(Self([width, height]))
    }
}

#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct QualityTable {
    lod_pixels: Option<NotNegative>,
    samples: Option<Rays>,
    most_samples: Option<Spanned<Rays>>,
    contrast: Option<NotNegative>,
    filter: Option<FilterName>,
    light_samples: Option<RaysEach>,
    ambient_samples: Option<RaysEach>,
    bounces: Option<Times>,
    cutoff: Option<NotNegative>,
    leave: Option<LeaveName>,
    smooth_pixels: Option<MaybeInfinite>,
    arithmetic: Option<ArithmeticName>,
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(try_from = "String")]
struct FilterName(Filter);

impl TryFrom<String> for FilterName {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        Filter::from_name(&name).map(Self).ok_or_else(|| unknown(&name, &Filter::ALL.map(Filter::name)))
    }
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(try_from = "String")]
struct LeaveName(Leave);

impl TryFrom<String> for LeaveName {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        Leave::from_name(&name).map(Self).ok_or_else(|| unknown(&name, &Leave::ALL.map(Leave::name)))
    }
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(try_from = "String")]
struct ArithmeticName(Arithmetic);

impl TryFrom<String> for ArithmeticName {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        Arithmetic::from_name(&name)
            .map(Self)
            .ok_or_else(|| unknown(&name, &Arithmetic::ALL.map(Arithmetic::name)))
    }
}

fn unknown(name: &str, known: &[&str]) -> String {
    format!("found \"{name}\", expected one of {}", known.join(", "))
}

impl PictureTable {
    pub fn tone(&self, text: &Text) -> Result<Tone, SceneFileError> {
        let mut tone = Tone::default();
        if let Some(exposure) = self.exposure {
            tone.exposure = exposure.0 as f32;
        }
        if let Some(name) = &self.tone {
            tone.mapping = ToneMapping::from_name(name.get_ref()).ok_or_else(|| {
                let known: Vec<&str> = ToneMapping::ALL.iter().map(|mapping| mapping.name()).collect();
                let problem =
                    SceneProblem::UnknownTone { name: name.get_ref().clone(), known: known.join(", ") };
                text.error(&name.span(), problem)
            })?;
        }
        Ok(tone)
    }
}

impl QualityTable {
    pub fn quality(&self, text: &Text) -> Result<Quality, SceneFileError> {
        let samples = self.samples.map_or(1, |samples| samples.0);
        let most = value(self.most_samples.as_ref()).map_or(samples, |most| most.0);
        if let Some(span) = self.most_samples.as_ref().filter(|_| most < samples).map(Spanned::span) {
            return Err(text.error(&span, SceneProblem::Samples { most, least: samples }));
        }
        let defaults = Quality::adapting(samples, most);
        Ok(Quality {
            lod_pixels: self.lod_pixels.map_or(defaults.lod_pixels, |pixels| pixels.0),
            samples,
            most_samples: most,
            contrast: self.contrast.map_or(defaults.contrast, |contrast| contrast.0 as f32),
            filter: self.filter.map_or(defaults.filter, |filter| filter.0),
            light_samples: self.light_samples.map_or(defaults.light_samples, |rays| rays.0),
            ambient_samples: self.ambient_samples.map_or(defaults.ambient_samples, |rays| rays.0),
            bounces: self.bounces.map_or(defaults.bounces, |times| times.0),
            cutoff: self.cutoff.map_or(defaults.cutoff, |cutoff| cutoff.0 as f32),
            leave: self.leave.map_or(defaults.leave, |leave| leave.0),
            smooth_pixels: self.smooth_pixels.map_or(defaults.smooth_pixels, |pixels| pixels.0),
            arithmetic: self.arithmetic.map_or(defaults.arithmetic, |arithmetic| arithmetic.0),
        })
    }
}
