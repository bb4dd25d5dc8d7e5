//! Scene files: models, where they stand and move, camera, lamps and quality, in TOML. `SCENES.md` shows every key.
//!
//! A file is read and checked as a whole before a model is loaded. What is found wrong, then or later, is said with file,
//! line and column.

mod camera;
mod error;
mod extent;
mod ground;
mod instance;
mod light;
mod model;
mod picture;
mod scatter;
mod surroundings;
#[cfg(test)]
mod tests;
mod text;
mod track;
mod value;

pub use error::{SceneFileError, SceneProblem};
pub use model::ModelFile;

use crate::scene::{Ambient, Background, Instance, Light, Model, Scene};
use crate::{Camera, Lens, Octree, Quality, Tone};
use camera::{CameraPath, CameraTable};
use extent::Extent;
use ground::GroundTable;
use instance::{Actor, Anchor, InstanceTable, Pose};
use light::LightTable;
use model::{ModelTable, Models};
use picture::{PictureTable, QualityTable};
use scatter::ScatterTable;
use serde::Deserialize;
use std::cell::LazyCell;
use std::collections::HashMap;
use std::path::Path;
use surroundings::{AmbientTable, BackgroundTable};
use text::Text;
use toml::Spanned;

/// A scene file, read and checked; its models are not loaded.
#[derive(Debug, Clone)]
pub struct SceneFile {
    text: Text,
    models: Models,
    actors: Vec<Actor>,
    camera: CameraPath,
    lights: Vec<Light>,
    ambient: Ambient,
    background: Background,
    ground: Option<GroundTable>,
    size: Option<[u32; 2]>,
    tone: Tone,
    quality: Quality,
}

/// What a scene file shows in one frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Shot<'a> {
    /// What there is to see.
    pub scene: Scene<'a>,
    /// From where it is seen, in the scene.
    pub camera: Camera,
    /// How the camera forms its picture.
    pub lens: Lens,
    /// Whether the file has no lamps, so that those of the studio, which stand about the camera, are to be added.
    pub studio: bool,
}

/// The file as it stands.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Tables {
    #[serde(default)]
    model: Vec<ModelTable>,
    #[serde(default)]
    instance: Vec<InstanceTable>,
    #[serde(default)]
    scatter: Vec<ScatterTable>,
    camera: Option<Spanned<CameraTable>>,
    #[serde(default)]
    light: Vec<LightTable>,
    #[serde(default)]
    ambient: AmbientTable,
    #[serde(default)]
    background: BackgroundTable,
    ground: Option<GroundTable>,
    #[serde(default)]
    picture: PictureTable,
    #[serde(default)]
    quality: QualityTable,
}

impl SceneFile {
    /// Reads a scene file, and the picture of its background if it has one.
    ///
    /// # Errors
    /// If a file cannot be read, or does not describe a scene, with what and where.
    pub fn open(path: &Path) -> Result<Self, SceneFileError> {
        let text = std::fs::read_to_string(path);
        let text = text.map_err(|source| SceneFileError::Read { path: path.to_path_buf(), source })?;
        Self::parse(&text, path)
    }

    /// As [`SceneFile::open`], from the text of the file `path`. Files that it names are relative to the folder of `path`.
    ///
    /// # Errors
    /// If the text does not describe a scene, with what and where.
    pub fn parse(text: &str, path: &Path) -> Result<Self, SceneFileError> {
        let text = Text { path: path.to_path_buf(), text: text.into() };
        let tables: Tables = toml::from_str(&text.text).map_err(|error| {
            let problem = SceneProblem::Invalid(error.message().into());
            text.error(&error.span().unwrap_or_default(), problem)
        })?;
        let models = Models::new(&text, tables.model)?;
        let mut actors = Vec::new();
        if tables.instance.is_empty() && tables.scatter.is_empty() {
            let identity = Pose::IDENTITY;
            let alone = |model| Actor::still(model, Anchor::Cube, identity, identity.scale);
            actors.extend((0..models.models.len()).map(alone));
        }
        for table in &tables.instance {
            actors.push(Actor::new(&text, &models, table)?);
        }
        for (number, table) in (0..).zip(&tables.scatter) {
            actors.extend(scatter::scatter(&text, &models, number, table)?);
        }
        if let Some(ground) = &tables.ground {
            ground.check(&text)?;
        }
        let lights = tables.light.iter().map(|light| light.light(&text));
        Ok(Self {
            camera: CameraPath::new(&text, tables.camera)?,
            lights: lights.collect::<Result<_, _>>()?,
            ambient: tables.ambient.ambient(),
            background: tables.background.background(&text)?,
            ground: tables.ground,
            size: tables.picture.size.map(|size| size.0),
            tone: tables.picture.tone(&text)?,
            quality: tables.quality.quality(&text)?,
            models,
            actors,
            text,
        })
    }

    /// The files that [`SceneFile::shot`] needs, in order, each once.
    pub fn models(&self) -> impl ExactSizeIterator<Item = ModelFile> {
        self.models.files.iter().cloned()
    }

    /// Columns and rows of the picture, if the file says it.
    #[must_use]
    pub fn size(&self) -> Option<[u32; 2]> {
        self.size
    }

    /// What the picture may approximate.
    #[must_use]
    pub fn quality(&self) -> Quality {
        self.quality
    }

    /// How light is displayed.
    #[must_use]
    pub fn tone(&self) -> Tone {
        self.tone
    }

    /// How many frames the animation has; 1 if nothing moves.
    #[must_use]
    pub fn frames(&self) -> u32 {
        let last = self.actors.iter().filter_map(|actor| actor.key_frames().last());
        let of_actors = last.max().map_or(1, |last| last + 1);
        of_actors.max(self.camera.frames())
    }

    /// The scene at a frame, counted from 0; frames after the last are as the last, but for a turntable, which goes on.
    ///
    /// `aspect` is width over height of the picture. `octrees` are the loaded files in the order of
    /// [`SceneFile::models`].
    ///
    /// # Errors
    /// If the file speaks of materials that a model does not have, or the camera sees nothing at this frame.
    ///
    /// # Panics
    /// If there are fewer octrees than files.
    pub fn shot<'a>(
        &self,
        frame: u32,
        aspect: f64,
        octrees: &'a [Octree],
    ) -> Result<Shot<'a>, SceneFileError> {
        let octree = |actor: &Actor| &octrees[self.models.models[actor.model].file];
        // Not every file asks for it.
        let extent = LazyCell::new(|| Extent::new(&self.actors, octree));
        let (models, instances) = self.instances(frame, octrees)?;
        let (camera, lens) = self.camera.at(&self.text, frame, aspect, &|| &*extent)?;
        let scene = Scene {
            models,
            instances,
            ground: self.ground.as_ref().map(|ground| ground.ground(|| extent.bounds[0].y)),
            lights: self.lights.clone(),
            ambient: self.ambient,
            background: self.background.clone(),
        };
        Ok(Shot { scene, camera, lens, studio: self.lights.is_empty() })
    }

    /// Where all models stand at a frame, and as many of them as differ in their materials.
    fn instances<'a>(
        &self,
        frame: u32,
        octrees: &'a [Octree],
    ) -> Result<(Vec<Model<'a>>, Vec<Instance>), SceneFileError> {
        let (mut models, mut instances) = (Vec::new(), Vec::with_capacity(self.actors.len()));
        let mut made: HashMap<(usize, u64), usize> = HashMap::new();
        let absorbs: Vec<bool> = octrees
            .iter()
            .map(|octree| octree.palette().materials().iter().any(|material| material.absorption != [0.0; 3]))
            .collect();
        for actor in &self.actors {
            let named = &self.models.models[actor.model];
            let octree = &octrees[named.file];
            let pose = actor.pose(frame);
            // Only what is absorbed on the way depends on the size.
            let size = if absorbs[named.file] { actor.size(&pose) } else { 1.0 };
            let model = match made.get(&(actor.model, size.to_bits())) {
                Some(&model) => model,
                None => {
                    models.push(named.model(&self.text, octree, size)?);
                    made.insert((actor.model, size.to_bits()), models.len() - 1);
                    models.len() - 1
                }
            };
            instances.push(Instance { model, placement: pose.placement(actor.anchor, octree) });
        }
        Ok((models, instances))
    }
}
