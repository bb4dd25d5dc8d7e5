//! `[ambient]` and `[background]`: light from around, and what is seen beyond the models.

use super::error::{SceneFileError, SceneProblem};
use super::text::{Text, given};
use super::value::{Color, NotNegative, Positive};
use crate::color::Light3;
use crate::frame::MAX_PIXELS;
use crate::scene::{Ambient, Background, Surroundings, studio};
use glam::Vec3;
use serde::Deserialize;
use std::path::Path;
use toml::Spanned;

#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct AmbientTable {
    color: Option<Color>,
    intensity: Option<NotNegative>,
    occlusion: Option<Positive>,
    #[serde(default)]
    glow: bool,
}

#[derive(Debug, Clone, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BackgroundTable {
    color: Option<Spanned<Color>>,
    bottom: Option<Spanned<Color>>,
    top: Option<Spanned<Color>>,
    picture: Option<Spanned<String>>,
    intensity: Option<NotNegative>,
}

impl AmbientTable {
    pub fn ambient(&self) -> Ambient {
        let intensity = self.intensity.map_or(1.0, |intensity| intensity.0 as f32);
        Ambient {
            color: self.color.map_or(studio::AMBIENT.color, |color| color.0) * intensity,
            occlusion: self.occlusion.map(|distance| distance.0 as f32),
            glow: self.glow,
        }
    }
}

impl BackgroundTable {
    pub fn background(&self, text: &Text) -> Result<Background, SceneFileError> {
        self.check(text)?;
        let intensity = self.intensity.map_or(1.0, |intensity| intensity.0 as f32);
        if let Some(picture) = &self.picture {
            if picture.get_ref().is_empty() {
                return Err(text.error(&picture.span(), SceneProblem::EmptyName { key: "picture" }));
            }
            let path = text.relative(picture.get_ref());
            let surroundings = load(&path, intensity).map_err(|reason| {
                text.error(&picture.span(), SceneProblem::Picture { picture: path.clone(), reason })
            })?;
            return Ok(Background::Surroundings(surroundings));
        }
        let of = |color: &Option<Spanned<Color>>, otherwise: Light3| {
            let own = color.as_ref().or(self.color.as_ref());
            own.map_or(otherwise, |color| color.get_ref().0) * intensity
        };
        Ok(Background::Gradient { bottom: of(&self.bottom, studio::BOTTOM), top: of(&self.top, studio::TOP) })
    }

    /// A colour, or two, or a picture.
    fn check(&self, text: &Text) -> Result<(), SceneFileError> {
        let spans = [
            ("picture", self.picture.as_ref().map(Spanned::span)),
            ("color", self.color.as_ref().map(Spanned::span)),
            ("bottom", self.bottom.as_ref().map(Spanned::span)),
            ("top", self.top.as_ref().map(Spanned::span)),
        ];
        let given = given(spans);
        match given.as_slice() {
            [] | [_] | [("bottom", _), ("top", _)] | [("top", _), ("bottom", _)] => Ok(()),
            [(other, _), (key, span), ..] => Err(text.error(span, SceneProblem::Both { key, other })),
        }
    }
}

/// A picture of all directions, as amounts of light.
fn load(path: &Path, intensity: f32) -> Result<Surroundings, String> {
    let is_exr = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("exr"));
    let (size, mut pixels) = if is_exr { load_exr(path)? } else { load_png(path)? };
    for (number, pixel) in pixels.iter_mut().enumerate() {
        // A filter may have left less than nothing; the larger of zero and what is no number is zero, so it is asked first.
        let is_number = !pixel.is_nan();
        *pixel = pixel.max(Vec3::ZERO) * intensity;
        if !is_number || !pixel.is_finite() {
            let (x, y) = (number % size[0].max(1), number / size[0].max(1));
            return Err(format!(
                "the pixel in column {x}, row {y} is no finite amount of light; mend the picture"
            ));
        }
    }
    Surroundings::new(size[0], size[1], pixels)
        .ok_or_else(|| "the picture has no pixels; give another".into())
}

fn load_png(path: &Path) -> Result<([usize; 2], Vec<Light3>), String> {
    let reader = image::ImageReader::open(path).map_err(|error| format!("cannot read: {error}"))?;
    let reader = reader.with_guessed_format().map_err(|error| format!("cannot read: {error}"))?;
    let picture = reader.decode().map_err(|error| format!("{error}; give a PNG or an EXR"))?.into_rgb16();
    let linear: Vec<f32> = (0..=u16::MAX).map(|displayed| linear(f64::from(displayed) / 65535.0)).collect();
    let pixels =
        picture.pixels().map(|pixel| Vec3::from_array(pixel.0.map(|part| linear[usize::from(part)])));
    Ok(([picture.width(), picture.height()].map(|size| size as usize), pixels.collect()))
}

/// The amount of light of an sRGB value from 0 to 1; as [`crate::to_linear`], of any number of bits.
fn linear(value: f64) -> f32 {
    (if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }) as f32
}

fn load_exr(path: &Path) -> Result<([usize; 2], Vec<Light3>), String> {
    use exr::prelude::{MetaData, Vec2, read_first_rgba_layer_from_file};
    let broken = |error: exr::error::Error| format!("{error}; give an EXR with channels R, G and B");
    // What the header says is not trusted with memory before it is looked at.
    let headers = MetaData::read_from_file(path, false).map_err(broken)?.headers;
    let is_huge = |size: Vec2<usize>| size.width() as u64 > MAX_PIXELS / (size.height() as u64).max(1);
    if headers.iter().any(|header| is_huge(header.layer_size)) {
        return Err(format!("the picture has more than {MAX_PIXELS} pixels; make it smaller"));
    }
    let layer = read_first_rgba_layer_from_file(
        path,
        |size, _| (size.width(), vec![Vec3::ZERO; size.area()]),
        |(width, pixels), place, (red, green, blue, _): (f32, f32, f32, f32)| {
            pixels[place.y() * *width + place.x()] = Vec3::new(red, green, blue);
        },
    );
    let layer = layer.map_err(broken)?.layer_data;
    Ok(([layer.size.width(), layer.size.height()], layer.channel_data.pixels.1))
}
