//! Every way in which reading or writing a file can go wrong.

use std::io;

/// What is wrong with a file, with a palette, or with the order of calls to a writer.
///
/// Offsets are in bytes from the beginning of the file. The name of the file is not known here; programs add it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FormatError {
    // The file is something else.
    /// The file does not begin with `4D 42`.
    #[error(
        "byte 0: begins with {:02X} {:02X} instead of 4D 42, so this is not a voxel octree; \
         convert a mesh with obj2vox",
        found[0], found[1]
    )]
    WrongMagic {
        /// The first two bytes of the file.
        found: [u8; 2],
    },
    /// The file begins with `VOX `: it is of the unrelated format of the MagicaVoxel editor.
    #[error(
        "byte 0: this is a MagicaVoxel file, another format that shares the ending .vox; \
         export it from MagicaVoxel as .obj and convert that with obj2vox"
    )]
    MagicaVoxel,
    /// The version is not one that this crate reads.
    #[error("byte 2: format version {version} is not known, only version 4 is; convert the mesh again")]
    UnsupportedVersion {
        /// The version in the file.
        version: u16,
    },

    // The file is damaged.
    /// The file ends inside the header.
    #[error(
        "byte {offset}: the file ends {missing} bytes too early, in the {field}; it is incomplete, copy or convert it again"
    )]
    TruncatedHeader {
        /// The field that is cut off.
        field: &'static str,
        /// Length of the file.
        offset: u64,
        /// Bytes of the field that are not there.
        missing: u64,
    },
    /// The file ends inside the octree.
    #[error(
        "byte {offset}: the file ends inside the octree, at least {missing} more voxels should follow; it is incomplete, copy or convert it again"
    )]
    TruncatedVoxels {
        /// Length of the file.
        offset: u64,
        /// The least number of voxels that would complete the octree, a cut one included.
        missing: u64,
    },
    /// The octree is complete, but the file goes on.
    #[error(
        "byte {offset}: the octree ends here but the file goes on; it is damaged, copy or convert it again"
    )]
    TrailingBytes {
        /// Where the octree ends.
        offset: u64,
    },
    /// The file's palette has more colours than an index of 15 bits can name.
    #[error(
        "byte 4: the palette has {size} colours, but voxels can use only {}; copy or convert the file again",
        crate::Palette::MAX_COLORS
    )]
    PaletteSizeOutOfRange {
        /// Number of colours in the file.
        size: u16,
    },
    /// A voxel names a colour that the palette does not have. Also an error of a caller of [`Writer`](crate::Writer).
    #[error(
        "byte {offset}: a voxel has palette index {index}, but the palette has {palette_size} colours; \
         copy or convert the file again"
    )]
    PaletteIndexOutOfRange {
        /// Where the voxel begins.
        offset: u64,
        /// Its palette index, which counts from 1.
        index: u16,
        /// Number of colours in the palette.
        palette_size: u16,
    },

    // A limit is reached.
    /// A voxel at the last level that is allowed has children. Also an error of a caller of [`Writer`](crate::Writer).
    #[error(
        "byte {offset}: the octree is deeper than the limit of {max_depth} levels below the root; \
         convert at a lower resolution"
    )]
    TooDeep {
        /// Where the voxel begins whose children would be too deep.
        offset: u64,
        /// The depth that is allowed.
        max_depth: u8,
    },
    /// The file has more voxels than allowed.
    #[error(
        "byte {offset}: the octree has more voxels than the limit of {max_records}; \
         convert at a lower resolution"
    )]
    TooManyRecords {
        /// Where the first voxel too many begins.
        offset: u64,
        /// The number of voxels that is allowed.
        max_records: u64,
    },

    // The caller is at fault.
    /// A palette was made of more colours than an index of 15 bits can name.
    #[error(
        "{size} colours are too many for a palette, which holds {}; merge some",
        crate::Palette::MAX_COLORS
    )]
    PaletteTooLarge {
        /// Number of colours.
        size: usize,
    },
    /// A voxel was written after the octree was complete.
    #[error("byte {offset}: the octree is complete after {records} voxels, no other can follow")]
    TreeComplete {
        /// Where the voxel would have been.
        offset: u64,
        /// Number of voxels of the octree.
        records: u64,
    },
    /// The writer was finished before the octree was complete.
    #[error(
        "byte {offset}: the octree was ended after {records} voxels, but at least {missing} more must follow"
    )]
    TreeIncomplete {
        /// Length of the file so far.
        offset: u64,
        /// Number of voxels written.
        records: u64,
        /// The least number of voxels that would complete the octree.
        missing: u64,
    },

    // The system is at fault.
    /// The input could not be read.
    #[error("byte {offset}: cannot read")]
    Read {
        /// How much had been read.
        offset: u64,
        /// What the system said.
        source: io::Error,
    },
    /// The output could not be written.
    #[error("byte {offset}: cannot write")]
    Write {
        /// How much had been handed to the writer.
        offset: u64,
        /// What the system said.
        source: io::Error,
    },
}
