//! `[[model]]`: files of models, and what is changed about their materials.

use super::error::{SceneFileError, SceneProblem};
use super::text::{Span, Text, given};
use super::value::{Color, ColorShare, Displayed, NotNegative, Positive, Share};
use crate::octree::{MAX_DEPTH, Octree};
use crate::scene::{Model, SurfaceMaterial};
use serde::Deserialize;
use std::path::PathBuf;
use toml::Spanned;

/// A file to be loaded.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ModelFile {
    /// A `.vox` or a mesh.
    pub path: PathBuf,
    /// Depth of the octree that a mesh is converted to, whose logarithm to base two its resolution is; `None` for a
    /// `.vox` or if the scene file does not say it.
    pub depth: Option<u8>,
    /// Where the scene file names it first, counted from 1.
    pub line: usize,
}

#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ModelTable {
    name: Spanned<String>,
    file: Spanned<String>,
    resolution: Option<Spanned<Resolution>>,
    #[serde(default)]
    material: Vec<Spanned<MaterialTable>>,
}

/// Cells along each axis, as the depth of the octree.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(try_from = "i64")]
struct Resolution(u8);

impl TryFrom<i64> for Resolution {
    type Error = String;

    fn try_from(cells: i64) -> Result<Self, String> {
        let limit = 1u32 << MAX_DEPTH;
        match u32::try_from(cells) {
            Ok(cells) if cells.is_power_of_two() && cells <= limit => Ok(Self(cells.trailing_zeros() as u8)),
            _ => Err(format!("found {cells}, expected a power of two from 1 to {limit}")),
        }
    }
}

/// What is changed about some entries of a palette.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct MaterialTable {
    entry: Option<Spanned<u16>>,
    entries: Option<Spanned<Vec<Spanned<u16>>>>,
    color: Option<Spanned<Displayed>>,
    diffuse: Option<ColorShare>,
    specular: Option<ColorShare>,
    shininess: Option<NotNegative>,
    reflectivity: Option<ColorShare>,
    transparency: Option<Share>,
    refraction_index: Option<Positive>,
    absorption: Option<Color>,
    emission: Option<Color>,
}

/// A model of the scene file.
#[derive(Debug, Clone)]
pub(super) struct NamedModel {
    pub name: String,
    /// Which of the files.
    pub file: usize,
    materials: Vec<Spanned<MaterialTable>>,
}

/// The models by their names, and the files that they need, each once.
#[derive(Debug, Clone)]
pub(super) struct Models {
    pub files: Vec<ModelFile>,
    pub models: Vec<NamedModel>,
}

impl Models {
    pub fn new(text: &Text, tables: Vec<ModelTable>) -> Result<Self, SceneFileError> {
        let mut models = Self { files: Vec::new(), models: Vec::new() };
        for table in tables {
            let file = models.file(text, &table)?;
            let (span, name) = (table.name.span(), table.name.into_inner());
            if name.is_empty() {
                return Err(text.error(&span, SceneProblem::EmptyName { key: "name" }));
            }
            if models.models.iter().any(|other| other.name == name) {
                return Err(text.error(&span, SceneProblem::SameName { name }));
            }
            for material in &table.material {
                material.get_ref().check(text)?;
            }
            models.models.push(NamedModel { name, file, materials: table.material });
        }
        if models.models.is_empty() {
            return Err(text.error(&(0..0), SceneProblem::NoModel));
        }
        Ok(models)
    }

    /// Which file a model needs.
    fn file(&mut self, text: &Text, table: &ModelTable) -> Result<usize, SceneFileError> {
        let span = table.file.span();
        if table.file.get_ref().is_empty() {
            return Err(text.error(&span, SceneProblem::EmptyName { key: "file" }));
        }
        let path = text.relative(table.file.get_ref());
        let is_vox = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("vox"));
        if let Some(resolution) = table.resolution.as_ref().filter(|_| is_vox) {
            return Err(text.error(&resolution.span(), SceneProblem::ResolutionOfVox));
        }
        let depth = table.resolution.as_ref().map(|resolution| resolution.get_ref().0);
        let known = self.files.iter().position(|file| file.path == path && file.depth == depth);
        Ok(known.unwrap_or_else(|| {
            self.files.push(ModelFile { path, depth, line: text.line(&span) });
            self.files.len() - 1
        }))
    }

    /// The model of a name.
    pub fn find(&self, text: &Text, name: &str, span: &Span) -> Result<usize, SceneFileError> {
        let found = self.models.iter().position(|model| model.name == name);
        found.ok_or_else(|| {
            let known: Vec<String> = self.models.iter().map(|model| format!("`{}`", model.name)).collect();
            text.error(span, SceneProblem::UnknownModel { name: name.into(), known: known.join(", ") })
        })
    }
}

impl NamedModel {
    /// The octree with the materials of its file, but for what the scene file says of them.
    pub fn model<'a>(
        &self,
        text: &Text,
        octree: &'a Octree,
        scale: f64,
    ) -> Result<Model<'a>, SceneFileError> {
        let mut model = Model::scaled(octree, scale);
        for material in &self.materials {
            let chosen = self.chosen(text, material, octree)?;
            for entry in chosen {
                material.get_ref().change(&mut model.surfaces[entry]);
            }
        }
        Ok(model)
    }

    /// Which surfaces a table changes, counted from 0.
    fn chosen(
        &self,
        text: &Text,
        table: &Spanned<MaterialTable>,
        octree: &Octree,
    ) -> Result<Vec<usize>, SceneFileError> {
        let (span, table) = (table.span(), table.get_ref());
        let palette = octree.palette().materials();
        let model = || self.name.clone();
        let mut chosen = Vec::new();
        if let Some(color) = &table.color {
            let found = (0..palette.len()).filter(|&entry| palette[entry].diffuse == color.get_ref().0);
            chosen.extend(found);
            if chosen.is_empty() {
                let problem = SceneProblem::NoColor { model: model(), color: color.get_ref().to_string() };
                return Err(text.error(&color.span(), problem));
            }
        } else if table.entry.is_some() || table.entries.is_some() {
            let several = table.entries.iter().flat_map(|entries| entries.get_ref());
            for entry in table.entry.iter().chain(several) {
                let place =
                    usize::from(*entry.get_ref()).checked_sub(1).filter(|place| *place < palette.len());
                chosen.push(
                    place
                        .ok_or_else(|| {
                            let (entry, last) = (*entry.get_ref(), palette.len());
                            SceneProblem::NoEntry { model: model(), entry, last }
                        })
                        .map_err(|problem| text.error(&entry.span(), problem))?,
                );
            }
        } else {
            chosen.extend(0..palette.len());
        }
        if chosen.is_empty() {
            return Err(text.error(&span, SceneProblem::NothingChosen { model: model() }));
        }
        Ok(chosen)
    }
}

impl MaterialTable {
    /// At most one way to choose entries.
    fn check(&self, text: &Text) -> Result<(), SceneFileError> {
        let given = given([
            ("entry", self.entry.as_ref().map(Spanned::span)),
            ("entries", self.entries.as_ref().map(Spanned::span)),
            ("color", self.color.as_ref().map(Spanned::span)),
        ]);
        match given.as_slice() {
            [(other, _), (key, span), ..] => Err(text.error(span, SceneProblem::Both { key, other })),
            _ => Ok(()),
        }
    }

    fn change(&self, surface: &mut SurfaceMaterial) {
        fn set<T>(place: &mut T, value: Option<T>) {
            if let Some(value) = value {
                *place = value;
            }
        }
        set(&mut surface.diffuse, self.diffuse.map(|color| color.0));
        set(&mut surface.specular, self.specular.map(|color| color.0));
        set(&mut surface.shininess, self.shininess.map(|number| number.0 as f32));
        set(&mut surface.reflectivity, self.reflectivity.map(|color| color.0));
        set(&mut surface.transparency, self.transparency.map(|share| share.0));
        set(&mut surface.refraction_index, self.refraction_index.map(|number| number.0 as f32));
        set(&mut surface.absorption, self.absorption.map(|color| color.0));
        set(&mut surface.emission, self.emission.map(|color| color.0));
    }
}
