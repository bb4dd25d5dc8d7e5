//! The model on the command line: a `.vox` as it is, a mesh converted in memory.

use anyhow::{Context, bail, ensure};
use octvox_cli::{CommonArgs, Progress};
use octvox_converter::{FileFormat, Options, convert, load_mesh};
use octvox_format::WorldTransform;
use octvox_format::v5::Compression;
use octvox_raytracer::Octree;
use std::path::{Path, PathBuf};

/// The model, and how to read it.
#[derive(clap::Args)]
pub struct ModelArguments {
    /// The model: a .vox file, or a mesh (.obj, .ply, .stl, .gltf or .glb), which is converted in memory first; to render,
    /// a scene (.toml), too
    #[arg(value_name = "MODEL")]
    pub model: PathBuf,
    /// Cells along each axis that a mesh is converted to: a power of two [default: 1024]
    #[arg(short, long, value_name = "CELLS", value_parser = parse_resolution)]
    pub resolution: Option<u8>,
}

/// A model ready for rays.
pub struct Model {
    pub octree: Octree,
    /// Where the cube is in the world, if the file tells.
    pub world: Option<WorldTransform>,
}

/// A resolution as the depth of the octree.
pub fn parse_resolution(text: &str) -> Result<u8, String> {
    let limit = 1u32 << Options::MAX_DEPTH;
    match text.parse::<u32>() {
        Ok(cells) if cells.is_power_of_two() && cells <= limit => Ok(cells.trailing_zeros() as u8),
        _ => Err(format!("not a power of two from 1 to {limit}")),
    }
}

impl ModelArguments {
    /// Whether it is a scene file.
    pub fn is_scene(&self) -> bool {
        extension(&self.model).as_deref() == Some("toml")
    }

    pub fn load(&self, common: &CommonArgs) -> anyhow::Result<Model> {
        ensure!(
            !self.is_scene(),
            "{}: is a scene; this command takes a model, a .vox file or a mesh",
            self.model.display()
        );
        load(&self.model, self.resolution, common)
    }
}

/// Reads a model; `depth` is that of the octree that a mesh is converted to.
pub fn load(path: &Path, depth: Option<u8>, common: &CommonArgs) -> anyhow::Result<Model> {
    match extension(path).as_deref() {
        Some("vox") if depth.is_some() => {
            bail!("{}: a resolution is for meshes, a .vox file has its own", path.display())
        }
        Some("vox") => {
            let octree = Octree::open(path)?;
            Ok(Model { world: octree.world(), octree })
        }
        // Which kind of mesh it is `load_mesh` tells from the content.
        _ => convert_in_memory(path, depth, common),
    }
}

fn convert_in_memory(path: &Path, depth: Option<u8>, common: &CommonArgs) -> anyhow::Result<Model> {
    let default = Options::default();
    // Of the two versions the one that keeps materials.
    let format = FileFormat::Version5 { compression: Compression::None };
    let options = Options { depth: depth.unwrap_or(default.depth), format, ..default };
    let name = || path.display().to_string();
    let progress = Progress::new(1, common.quiet);
    let mesh = load_mesh(path)?;
    let mut file = Vec::new();
    let report = convert(&mesh, &options, &progress, &mut file).with_context(name)?;
    progress.finish();
    for warning in &report.warnings {
        eprintln!("warning: {warning}");
    }
    let octree = Octree::from_bytes(&file).with_context(name)?;
    Ok(Model { octree, world: Some(report.world) })
}

/// Whether a file is a `.vox` by its name.
pub fn is_vox(path: &Path) -> bool {
    extension(path).as_deref() == Some("vox")
}

fn extension(path: &Path) -> Option<String> {
    Some(path.extension()?.to_str()?.to_ascii_lowercase())
}
