//! What is studied: a mesh, a `.vox` or a scene, converted in one way or another.

use crate::model::{self, ModelArguments};
use anyhow::{Context, bail};
use octvox_cli::Progress;
use octvox_converter::{FileFormat, LodColor, Mesh, Options, WorldTransform, convert, load_mesh};
use octvox_format::v5::Compression;
use octvox_raytracer::scene::Scene;
use octvox_raytracer::{Camera, Lens, Octree, Quality, SceneFile, Tone};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// How meshes become octrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conversion {
    /// Levels added to the depth that each model has by itself.
    pub levels: i8,
    /// The most entries of a palette.
    pub palette_size: usize,
    pub normals: Normals,
    pub lod_color: LodColor,
}

/// What normals voxels have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Normals {
    /// Those of the faces, whatever the mesh says, in 16 bits on an octahedron.
    Faces,
    /// Those of the mesh, as two angles of 8 bits (format version 4).
    Spherical,
    /// Those of the mesh, in 16 bits on an octahedron (format version 5).
    Octahedral,
}

impl Default for Conversion {
    fn default() -> Self {
        let Options { palette_size, lod_color, .. } = Options::default();
        Self { levels: 0, palette_size, normals: Normals::Octahedral, lod_color }
    }
}

/// Where the voxels of a model come from.
enum Source {
    Mesh {
        mesh: Box<Mesh>,
        depth: u8,
    },
    /// A `.vox`, which is as it is.
    File(PathBuf),
}

/// What is studied, loaded but for its octrees.
pub struct Subject {
    name: String,
    sources: Vec<Source>,
    file: Option<(Box<SceneFile>, u32)>,
}

/// The octrees of a conversion.
pub struct Prepared {
    pub octrees: Vec<Octree>,
    /// Where in the world each octree's cube is, if that is known.
    pub worlds: Vec<Option<WorldTransform>>,
    /// What conversion and loading took.
    pub seconds: f64,
}

/// From where a subject is seen, whatever its conversion.
#[derive(Debug, Clone)]
pub struct View {
    pub camera: Camera,
    pub lens: Lens,
}

impl Subject {
    /// Loads what the command line names; `frame` is that of a scene.
    pub fn load(arguments: &ModelArguments, frame: u32) -> anyhow::Result<Self> {
        let path = &arguments.model;
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if !arguments.is_scene() {
            let sources = vec![Source::open(path, arguments.resolution)?];
            return Ok(Self { name, sources, file: None });
        }
        if arguments.resolution.is_some() {
            bail!("{}: is a scene, whose models have a resolution each", path.display());
        }
        let file = Box::new(SceneFile::open(path)?);
        if frame >= file.frames() {
            bail!("{}: has {} frames, counted from 0", path.display(), file.frames());
        }
        let place = |line: usize| move || format!("{}:{line}", path.display());
        let source = |model: octvox_raytracer::ModelFile| {
            Source::open(&model.path, model.depth).with_context(place(model.line))
        };
        let sources = file.models().map(source).collect::<anyhow::Result<_>>()?;
        Ok(Self { name, sources, file: Some((file, frame)) })
    }

    /// The name of the file.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Whether it is a scene file.
    pub fn is_scene(&self) -> bool {
        self.file.is_some()
    }

    /// The meshes, if all models are some.
    pub fn meshes(&self) -> Option<Vec<&Mesh>> {
        self.sources.iter().map(Source::mesh).collect()
    }

    /// The depths that the meshes are converted to by themselves, the least and the greatest; nothing without a mesh.
    pub fn depths(&self) -> Option<[u8; 2]> {
        let depths = || self.sources.iter().filter_map(Source::depth);
        Some([depths().min()?, depths().max()?])
    }

    /// What the scene file says may be approximated, and how light is displayed.
    pub fn quality_and_tone(&self) -> (Quality, Tone) {
        self.file.as_ref().map_or_else(Default::default, |(file, _)| (file.quality(), file.tone()))
    }

    /// Columns and rows, if a scene file says it.
    pub fn size(&self) -> Option<[u32; 2]> {
        self.file.as_ref().and_then(|(file, _)| file.size())
    }

    /// Makes the octrees.
    pub fn prepare(&self, conversion: &Conversion) -> anyhow::Result<Prepared> {
        let start = Instant::now();
        let mut prepared = Prepared { octrees: Vec::new(), worlds: Vec::new(), seconds: 0.0 };
        for source in &self.sources {
            let (octree, world) = source.octree(conversion).with_context(|| self.name.clone())?;
            prepared.octrees.push(octree);
            prepared.worlds.push(world);
        }
        prepared.seconds = start.elapsed().as_secs_f64();
        Ok(prepared)
    }

    /// What there is to see, from where a scene file says it or, of a model alone, from where the whole of it is seen.
    pub fn shot<'a>(&self, prepared: &'a Prepared, size: [u32; 2]) -> anyhow::Result<(Scene<'a>, View)> {
        let aspect = f64::from(size[0]) / f64::from(size[1]);
        let Some((file, frame)) = &self.file else {
            let octree = &prepared.octrees[0];
            let camera = Camera::framing(octree, aspect, octvox_raytracer::DEFAULT_FOV);
            return Ok((Scene::of_model(octree, &camera), View { camera, lens: Lens::default() }));
        };
        let shot = file.shot(*frame, aspect, &prepared.octrees)?;
        let mut scene = shot.scene;
        if shot.studio {
            scene.light_as_studio(&shot.camera);
        }
        Ok((scene, View { camera: shot.camera, lens: shot.lens }))
    }

    /// What there is to see from a given place.
    pub fn scene<'a>(
        &self,
        prepared: &'a Prepared,
        view: &View,
        size: [u32; 2],
    ) -> anyhow::Result<Scene<'a>> {
        match &self.file {
            None => Ok(Scene::of_model(&prepared.octrees[0], &view.camera)),
            Some(_) => Ok(self.shot(prepared, size)?.0),
        }
    }
}

impl Source {
    fn open(path: &Path, depth: Option<u8>) -> anyhow::Result<Self> {
        if model::is_vox(path) {
            if depth.is_some() {
                bail!("{}: a resolution is for meshes, a .vox file has its own", path.display());
            }
            return Ok(Self::File(path.to_path_buf()));
        }
        let depth = depth.unwrap_or(Options::default().depth);
        Ok(Self::Mesh { mesh: Box::new(load_mesh(path)?), depth })
    }

    fn mesh(&self) -> Option<&Mesh> {
        match self {
            Self::Mesh { mesh, .. } => Some(mesh),
            Self::File(_) => None,
        }
    }

    fn depth(&self) -> Option<u8> {
        match self {
            Self::Mesh { depth, .. } => Some(*depth),
            Self::File(_) => None,
        }
    }

    fn octree(&self, conversion: &Conversion) -> anyhow::Result<(Octree, Option<WorldTransform>)> {
        let (mesh, depth) = match self {
            Self::File(path) => {
                let octree = Octree::open(path)?;
                let world = octree.world();
                return Ok((octree, world));
            }
            Self::Mesh { mesh, depth } => (mesh, depth),
        };
        let default = Options::default();
        let format = match conversion.normals {
            Normals::Spherical => FileFormat::Version4,
            Normals::Faces | Normals::Octahedral => FileFormat::Version5 { compression: Compression::None },
        };
        let are_faces = conversion.normals == Normals::Faces;
        let options = Options {
            depth: depth.saturating_add_signed(conversion.levels).min(Options::MAX_DEPTH),
            palette_size: conversion.palette_size,
            lod_color: conversion.lod_color,
            crease_degrees: if are_faces { 0.0 } else { default.crease_degrees },
            format,
            ..default
        };
        let without_normals;
        let mesh = if are_faces {
            without_normals = Mesh::clone(mesh).with_corner_normals(Vec::new())?;
            &without_normals
        } else {
            &**mesh
        };
        let mut file = Vec::new();
        let report = convert(mesh, &options, &Progress::hidden(), &mut file)?;
        Ok((Octree::from_bytes(&file)?, Some(report.world)))
    }
}
