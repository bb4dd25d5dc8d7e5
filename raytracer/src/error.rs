//! What can go wrong between a file and a picture.

use octvox_format::FormatError;
use std::path::PathBuf;

/// Why a model could not be made ready for tracing.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LoadError {
    /// The failure of one file, which is named.
    #[error("{}: {error}", path.display())]
    InFile {
        /// The file.
        path: PathBuf,
        /// What was wrong with it.
        error: Box<LoadError>,
    },
    /// The file cannot be read.
    #[error("cannot read: {0}")]
    Read(#[from] std::io::Error),
    /// The file is not a valid `.vox`.
    #[error(transparent)]
    Format(#[from] FormatError),
    /// The file changed between the two passes over it.
    #[error("the file changed while it was read; load it again")]
    Changed,
    /// The octree has more levels than a coordinate has bits.
    #[error(
        "depth {depth} is too deep to trace, at most {limit} levels fit a coordinate; convert at a lower resolution"
    )]
    TooDeep {
        /// Levels below the root.
        depth: u8,
        /// How many can be traced.
        limit: u8,
    },
    /// More nodes or voxels than an index can count.
    #[error("{found} {what} are too many to trace, at most {limit} fit; convert at a lower resolution")]
    TooLarge {
        /// What there is too much of.
        what: &'static str,
        /// How many.
        found: u64,
        /// How many fit.
        limit: u64,
    },
}
