//! What can be wrong with a file of another program, or with an octree that is to become one.

/// Why a file of another program cannot be read, or an octree not be made one. Offsets are in bytes from the beginning of
/// the file.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ExchangeError {
    /// The file does not begin with `VOX `.
    #[error("byte 0: begins with {found:02X?} instead of \"VOX \", so this is no MagicaVoxel file")]
    NotMagicaVoxel {
        /// Its first bytes, at most four.
        found: Vec<u8>,
    },
    /// The file ends inside of something.
    #[error("byte {offset}: the {part} is cut off; save the file again in MagicaVoxel")]
    Truncated {
        /// Where what is missing should begin.
        offset: u64,
        /// What is cut off.
        part: &'static str,
    },
    /// A field of the file holds what it cannot mean.
    #[error(
        "byte {offset}: the {field} is {value}, which makes no sense; save the file again in MagicaVoxel"
    )]
    DamagedField {
        /// Where the field is, or the part of the file that it is in.
        offset: u64,
        /// What it says.
        field: &'static str,
        /// What it is.
        value: String,
    },
    /// There is no model in the file.
    #[error("the file has no models that are shown, or they have no voxels")]
    Nothing,
    /// The scene has more voxels, or more nodes, than allowed.
    #[error("the scene has more than {limit} {what}; delete some, or save parts of it as files of their own")]
    SceneTooLarge {
        /// `voxels` or `nodes`.
        what: &'static str,
        /// The number that is allowed.
        limit: u64,
    },
    /// The scene is longer along an axis than an octree can be.
    #[error("the scene is {extent} voxels long, but an octree can have {limit}; move its models together")]
    SceneTooLong {
        /// Voxels along the longest axis.
        extent: u64,
        /// The number that is possible.
        limit: u64,
    },
    /// The octree has too many cells, or too many runs of them, for what is to be made of it.
    #[error(
        "{bytes} bytes would be needed for a volume of {resolution}³ cells, more than the limit of {limit}; \
         keep fewer levels (--level) or raise the limit (--max-bytes)"
    )]
    VolumeTooLarge {
        /// Cells along each axis.
        resolution: u64,
        /// Bytes that are needed at least.
        bytes: u128,
        /// Bytes that are allowed.
        limit: u64,
    },
    /// A byte cannot name the materials of the file.
    #[error(
        "the palette has {materials} materials, but a byte names 255; use two bytes (--cells u16) or colours (--cells rgba)"
    )]
    TooManyForBytes {
        /// Number of materials.
        materials: usize,
    },
    /// The octree is too fine for MagicaVoxel.
    #[error(
        "the octree has {resolution} cells along each axis and {voxels} filled ones or more, but MagicaVoxel takes \
         {resolution_limit} and {voxel_limit}; keep fewer levels (--level)"
    )]
    TooFineForMagicaVoxel {
        /// Cells along each axis.
        resolution: u64,
        /// Filled cells as far as they have been counted.
        voxels: u64,
        /// Cells along each axis that are possible.
        resolution_limit: u64,
        /// Filled cells that are possible.
        voxel_limit: u64,
    },
}
