//! What a caller can choose.

use crate::{ConvertError, LodColor};
use octvox_format::v5::Compression;
use octvox_format::{NormalCode, Palette};
use std::path::PathBuf;

/// How a mesh is converted.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// Depth of the octree, 0 to [`Options::MAX_DEPTH`]; there are 2^`depth` cells per axis.
    pub depth: u8,
    /// Largest number of palette entries, 1 to 32,767. More colours than that are merged.
    pub palette_size: usize,
    /// Whether eight equal leaves are replaced by their parent.
    pub prune: bool,
    /// Whether every voxel that a triangle touches is filled (a 26-separating surface), instead of the thin surface.
    pub conservative: bool,
    /// Whether displacement maps move the surface.
    pub displace: bool,
    /// Whether the inside is filled, not only the surface. It is stored as the largest cubes that fit, also without
    /// [`Options::prune`]; it has the mean colour of the surface, and a normal along z.
    pub solid: bool,
    /// How coarser levels get their colours.
    pub lod_color: LodColor,
    /// Faces that meet at a larger angle than this, in degrees, have an edge between them. Only matters for computed
    /// normals.
    pub crease_degrees: f64,
    /// Version of the file.
    pub format: FileFormat,
    /// The region to convert in world units: xmin, ymin, zmin, xmax, ymax, zmax.
    /// `None`: the bounding box of the model.
    pub bounds: Option<[f64; 6]>,
    /// Length of a voxel's edge in world units. `None`: the region fills the cube.
    pub voxel_size: Option<f64>,
    /// Bytes of memory that the process may take, with the mesh. Voxels that have no room wait in a temporary file. The
    /// result is the same. `None`: no bound, and no temporary file.
    pub memory: Option<u64>,
    /// Where the output and temporary files go. `None`: temporary files go where the system wants them, and it is not
    /// checked whether the output has room.
    pub folder: Option<PathBuf>,
    /// Whether to begin even if memory or disk seem to be too small.
    pub force: bool,
}

/// Version of the file to write.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FileFormat {
    /// All voxels in preorder, also empty ones; colours without materials, spherical normals (Bohnen 2009).
    #[default]
    Version4,
    /// The filled voxels in subtrees that are checked and found one by one; materials, octahedral normals, and the way
    /// back to the world.
    Version5 {
        /// Whether subtrees are made shorter.
        compression: Compression,
    },
}

impl FileFormat {
    /// The number of the version.
    #[must_use]
    pub fn version(self) -> u16 {
        match self {
            Self::Version4 => 4,
            Self::Version5 { .. } => octvox_format::v5::VERSION,
        }
    }

    /// How normals are stored.
    pub(crate) fn normal_code(self) -> NormalCode {
        match self {
            Self::Version4 => NormalCode::Spherical,
            Self::Version5 { .. } => NormalCode::Octahedral,
        }
    }
}

impl Default for Options {
    fn default() -> Self {
        Self {
            depth: 10,
            palette_size: Palette::MAX_COLORS,
            prune: true,
            conservative: false,
            displace: false,
            solid: false,
            lod_color: LodColor::Mean,
            crease_degrees: 60.0,
            format: FileFormat::default(),
            bounds: None,
            voxel_size: None,
            memory: None,
            folder: None,
            force: false,
        }
    }
}

impl Options {
    /// The deepest octree: 16,384 cells per axis.
    pub const MAX_DEPTH: u8 = 14;

    /// Cells per axis.
    #[must_use]
    pub fn resolution(&self) -> u32 {
        1 << self.depth.min(Self::MAX_DEPTH)
    }

    /// Where temporary files go.
    pub(crate) fn folder_of_temporary_files(&self) -> PathBuf {
        self.folder.clone().unwrap_or_else(std::env::temp_dir)
    }

    /// Checks each choice on its own.
    ///
    /// # Errors
    /// [`ConvertError::Depth`], [`ConvertError::PaletteSize`], [`ConvertError::CreaseAngle`], [`ConvertError::Bounds`],
    /// [`ConvertError::VoxelSize`].
    pub fn check(&self) -> Result<(), ConvertError> {
        if self.depth > Self::MAX_DEPTH {
            return Err(ConvertError::Depth { depth: self.depth, max: Self::MAX_DEPTH });
        }
        if !(1..=Palette::MAX_COLORS).contains(&self.palette_size) {
            return Err(ConvertError::PaletteSize { size: self.palette_size, max: Palette::MAX_COLORS });
        }
        if !(0.0..=180.0).contains(&self.crease_degrees) {
            return Err(ConvertError::CreaseAngle { degrees: self.crease_degrees });
        }
        if let Some(bounds) = self.bounds
            && !(0..3).all(|axis| {
                let (min, max) = (bounds[axis], bounds[axis + 3]);
                min.is_finite() && max.is_finite() && min < max && (max - min).is_finite()
            })
        {
            return Err(ConvertError::Bounds { bounds });
        }
        if let Some(size) = self.voxel_size
            && !(size.is_normal() && size > 0.0 && size * f64::from(1 << Self::MAX_DEPTH) < f64::MAX)
        {
            return Err(ConvertError::VoxelSize { size });
        }
        Ok(())
    }
}
