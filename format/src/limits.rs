//! How much of a file a reader is willing to read.

/// Bounds on what a [`Reader`](crate::Reader) accepts, for files from strangers.
///
/// Reading needs the same small memory for every file, so the bounds protect what the caller builds from the
/// records.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Limits {
    /// Levels below the root. More than [`Limits::MAX_DEPTH`] counts as [`Limits::MAX_DEPTH`].
    pub max_depth: u8,
    /// Records of version 4, one for each voxel in the file; voxels of version 5, which are only the filled ones.
    pub max_records: u64,
    /// Bytes in a section of version 5 before compression, so that a short file cannot demand much memory. More than 1 GiB
    /// counts as 1 GiB.
    pub max_section_bytes: u64,
}

impl Limits {
    /// The deepest octree that can be read or written: 2²³ cells along each axis, as many as the significand of an
    /// `f32` can tell apart in a cube of side 1.
    pub const MAX_DEPTH: u8 = 23;
}

impl Default for Limits {
    /// As deep as possible, and as many records as the file has.
    fn default() -> Self {
        Self { max_depth: Self::MAX_DEPTH, max_records: u64::MAX, max_section_bytes: 1 << 30 }
    }
}
