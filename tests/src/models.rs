//! Models: from the project's samples, from the folder of shared test data, and converted in memory.

use octvox_cli::Progress;
use octvox_converter::{Mesh, Options, Report, convert, load_mesh};
use octvox_raytracer::Octree;
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// A mesh that has gone all the way.
#[derive(Debug)]
pub struct Model {
    /// The `.vox` file.
    pub file: Vec<u8>,
    /// What the converter tells.
    pub report: Report,
    /// The file, made ready for rays.
    pub octree: Octree,
}

impl Model {
    /// Converts a mesh.
    #[must_use]
    pub fn new(mesh: &Mesh, options: &Options) -> Self {
        let mut file = Vec::new();
        let report = convert(mesh, options, &Progress::hidden(), &mut file).unwrap();
        let octree = Octree::read(Cursor::new(&file)).unwrap();
        Self { file, report, octree }
    }

    /// Converts a mesh to `1 << depth` cells per axis.
    #[must_use]
    pub fn of_depth(mesh: &Mesh, depth: u8) -> Self {
        Self::new(mesh, &Options { depth, ..Options::default() })
    }
}

/// Names of the sample scenes.
pub const SAMPLES: [&str; 4] = ["shell", "lighthouse", "knots", "globe"];

/// The OBJ file of a sample scene.
#[must_use]
pub fn sample_path(name: &str) -> PathBuf {
    root().join("samples/models").join(name).with_extension("obj")
}

/// A sample scene.
#[must_use]
pub fn sample(name: &str) -> Mesh {
    load_mesh(&sample_path(name)).unwrap()
}

/// A mesh of the folder `shared/models` beside the project, which not everybody has. Says so if it is not there.
#[must_use]
pub fn shared(name: &str) -> Option<Mesh> {
    let path = root().join("../shared/models").join(name);
    if !path.is_file() {
        println!("skipped: {} is not there", path.display());
        return None;
    }
    Some(load_mesh(&path).unwrap())
}

/// The project's folder.
fn root() -> &'static Path {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR"));
    tests.parent().unwrap_or(tests)
}
