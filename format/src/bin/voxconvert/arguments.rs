//! What is asked for.

use crate::input::InputKind;
use clap::error::ErrorKind;
use clap::{CommandFactory, Parser, ValueEnum};
use octvox_cli::CommonArgs;
use octvox_format::NormalCode;
use octvox_format::exchange::Cells;
use octvox_format::v5::Compression;
use std::path::PathBuf;

/// Convert voxel octrees.
///
/// Reads .vox files of version 4 and 5, and those of MagicaVoxel. What is written is chosen by the ending of OUT: .vox (see
/// --format), .binvox, .npy (an array [x, y, z] for NumPy) or .raw (cell after cell, x fastest, then y, then z).
#[derive(Parser)]
#[command(name = "voxconvert", version, after_help = EXAMPLES)]
pub struct Arguments {
    /// A .vox file
    pub input: PathBuf,
    /// The file to write: .vox, .binvox, .npy or .raw
    pub output: PathBuf,
    /// Kind of a .vox file to write [default: version 5; version 4 if that is what is read]
    #[arg(long, value_enum, value_name = "KIND")]
    pub format: Option<VoxKind>,
    /// Keep only the levels down to L, and nodes in place of what is below
    #[arg(long, value_name = "L", value_parser = clap::value_parser!(u8).range(0..=23))]
    pub level: Option<u8>,
    /// Version 5: whether subtrees are compressed [default: as they are, or zstd]
    #[arg(long, value_enum)]
    pub compression: Option<CompressionKind>,
    /// Version 5: the level at which the octree is cut into subtrees [default: as it is, or 7 above the finest]
    #[arg(long, value_name = "L", value_parser = clap::value_parser!(u8).range(0..=21))]
    pub cut_level: Option<u8>,
    /// Version 5: the code of normals [default: as it is]
    #[arg(long, value_enum, value_name = "CODE")]
    pub normals: Option<NormalKind>,
    /// .npy and .raw: what stands for a cell [default: u8; u16 if there are more than 255 materials]
    #[arg(long, value_enum)]
    pub cells: Option<CellKind>,
    /// .npy, .raw and .binvox: the most bytes that a volume may take
    #[arg(long, value_name = "N", default_value_t = 4 << 30)]
    pub max_bytes: u64,
    #[command(flatten)]
    pub common: CommonArgs,
}

const EXAMPLES: &str = "\
Examples:
  voxconvert bunny.vox small.vox --format 5          version 5: a tenth of the size, and faster to open
  voxconvert bunny.vox preview.vox --level 7         128³ cells
  voxconvert bunny.vox bunny.npy --level 9           numpy.load(\"bunny.npy\")[x, y, z]
  voxconvert castle.vox castle-octree.vox            from MagicaVoxel
  voxconvert bunny.vox edit.vox --format magicavoxel --level 8";

/// Kinds of .vox files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum VoxKind {
    /// Version 4: colours, spherical normals
    #[value(name = "4")]
    Version4,
    /// Version 5: materials, checksums, compression
    #[value(name = "5")]
    Version5,
    /// The file of the MagicaVoxel editor
    #[value(name = "magicavoxel")]
    MagicaVoxel,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum CompressionKind {
    None,
    Zstd,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum NormalKind {
    Spherical,
    Octahedral,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum CellKind {
    /// The palette index, 0 for an empty cell
    U8,
    /// The palette index in two bytes
    U16,
    /// Red, green, blue and opacity
    Rgba,
}

/// What is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    Vox(VoxKind),
    Binvox,
    Npy,
    Raw,
}

impl Target {
    pub fn name(self) -> &'static str {
        match self {
            Self::Vox(VoxKind::Version4) => "version 4",
            Self::Vox(VoxKind::Version5) => "version 5",
            Self::Vox(VoxKind::MagicaVoxel) => "magicavoxel",
            Self::Binvox => "binvox",
            Self::Npy => "npy",
            Self::Raw => "raw",
        }
    }
}

impl Arguments {
    /// What to write, by the ending of its name. Another ending ends the program.
    pub fn target(&self, input: InputKind) -> Target {
        let ending = self.output.extension().map(|ending| ending.to_ascii_lowercase());
        match ending.as_ref().and_then(|ending| ending.to_str()) {
            Some("vox") => Target::Vox(self.format.unwrap_or(match input {
                InputKind::Version4 => VoxKind::Version4,
                InputKind::Version5 | InputKind::MagicaVoxel => VoxKind::Version5,
            })),
            Some("binvox") => Target::Binvox,
            Some("npy") => Target::Npy,
            Some("raw") => Target::Raw,
            _ => refuse(&format!(
                "the ending of {} says nothing about what to write; name a .vox, .binvox, .npy or .raw file",
                self.output.display()
            )),
        }
    }

    /// An option that means nothing for what is written ends the program.
    pub fn check(&self, target: Target) {
        let is_version_5 = target == Target::Vox(VoxKind::Version5);
        let is_array = matches!(target, Target::Npy | Target::Raw);
        let options = [
            ("--format", self.format.is_some() && !matches!(target, Target::Vox(_)), ".vox files"),
            ("--compression", self.compression.is_some() && !is_version_5, "files of version 5"),
            ("--cut-level", self.cut_level.is_some() && !is_version_5, "files of version 5"),
            ("--normals", self.normals.is_some() && !is_version_5, "files of version 5"),
            ("--cells", self.cells.is_some() && !is_array, ".npy and .raw files"),
        ];
        if let Some((option, _, what)) = options.into_iter().find(|(_, is_wrong, _)| *is_wrong) {
            refuse(&format!("{option} is for {what} only, but the output is {}", target.name()));
        }
    }

    pub fn compression(&self) -> Option<Compression> {
        self.compression.map(|kind| match kind {
            CompressionKind::None => Compression::None,
            CompressionKind::Zstd => Compression::Zstandard,
        })
    }

    pub fn normal_code(&self) -> Option<NormalCode> {
        self.normals.map(|kind| match kind {
            NormalKind::Spherical => NormalCode::Spherical,
            NormalKind::Octahedral => NormalCode::Octahedral,
        })
    }

    pub fn cells(&self) -> Option<Cells> {
        self.cells.map(|kind| match kind {
            CellKind::U8 => Cells::Index8,
            CellKind::U16 => Cells::Index16,
            CellKind::Rgba => Cells::Rgba,
        })
    }
}

/// Ends the program as clap does when arguments are wrong.
fn refuse(message: &str) -> ! {
    Arguments::command().error(ErrorKind::ArgumentConflict, message).exit()
}
