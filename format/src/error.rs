//! Every way in which reading or writing a file can go wrong.

use crate::Defect;
use crate::exchange::ExchangeError;
use crate::v5::LevelDefect;
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
         convert it with voxconvert"
    )]
    MagicaVoxel,
    /// The version is not one that the reader takes: [`Reader`](crate::Reader) takes 4, those of [`v5`](crate::v5) take 5,
    /// and [`AnyReader`](crate::AnyReader) takes both.
    #[error("byte 2: format version {version} cannot be read here{}; convert the mesh again", known_versions(*version))]
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

    // A file of version 5 is damaged.
    /// The file ends behind its header, inside another part.
    #[error(
        "byte {offset}: the file ends {missing} bytes too early, in the {section}; it is incomplete, copy or convert it again"
    )]
    TruncatedSection {
        /// The part that is cut off.
        section: &'static str,
        /// Length of the file.
        offset: u64,
        /// Bytes of the part that are not there.
        missing: u64,
    },
    /// A part of the file has been changed since it was written.
    #[error(
        "byte {offset}: the {section} has the checksum {computed:08X} instead of {stored:08X}; the file is damaged, copy or convert it again"
    )]
    ChecksumMismatch {
        /// Where the part begins.
        offset: u64,
        /// The part.
        section: &'static str,
        /// The checksum in the file.
        stored: u32,
        /// The checksum of what is there.
        computed: u32,
    },
    /// A field has a value that it cannot have. Also an error of a caller who makes a [`Header`](crate::v5::Header).
    #[error("byte {offset}: the {field} is {value}, but at most {limit} is possible")]
    FieldOutOfRange {
        /// Where the field is.
        offset: u64,
        /// What it says.
        field: &'static str,
        /// What it is.
        value: u64,
        /// The largest possible value.
        limit: u64,
    },
    /// A field holds what it cannot mean.
    #[error("byte {offset}: the {field} makes no sense; the file is damaged, copy or convert it again")]
    DamagedField {
        /// Where the field is.
        offset: u64,
        /// What it says.
        field: &'static str,
    },
    /// Where a section should begin, something unknown does.
    #[error(
        "byte {offset}: a section begins with {found:02X?}, which is none of \"MATL\", \"TREE\", \"TOP \", \"INDX\"; \
         the file is damaged, copy or convert it again"
    )]
    UnknownSection {
        /// Where the section begins.
        offset: u64,
        /// Its first four bytes.
        found: [u8; 4],
    },
    /// Where a section should begin, another one does.
    #[error(
        "byte {offset}: the {expected} should be here, but the {found} is; copy or convert the file again"
    )]
    UnexpectedSection {
        /// Where the section begins.
        offset: u64,
        /// What it is.
        found: &'static str,
        /// What it should be.
        expected: &'static str,
    },
    /// A section is longer or shorter than what it holds.
    #[error(
        "byte {offset}: the {section} holds {found} bytes, but what it tells about itself takes {expected}; \
         copy or convert the file again"
    )]
    SectionLength {
        /// Where the section begins.
        offset: u64,
        /// What it is.
        section: &'static str,
        /// Its length without its head.
        found: u64,
        /// The length that it should have.
        expected: u64,
    },
    /// A section cannot be decompressed.
    #[error("byte {offset}: the {section} cannot be decompressed; copy or convert the file again")]
    Decompression {
        /// Where the section begins.
        offset: u64,
        /// What it is.
        section: &'static str,
        /// What is wrong.
        source: io::Error,
    },
    /// The lists of voxels in a section are not the levels of a tree, or do not fit the palette. Also an error of a caller
    /// of [`v5::Writer`](crate::v5::Writer).
    #[error("byte {offset}: in the {section}, {defect}; copy or convert the file again")]
    DamagedLevels {
        /// Where the section begins.
        offset: u64,
        /// What it is.
        section: &'static str,
        /// What is wrong.
        defect: LevelDefect,
    },
    /// A subtree is not in the cube. Also an error of a caller of [`v5::Writer`](crate::v5::Writer).
    #[error(
        "byte {offset}: a subtree has the Morton code {code}, but level {cut_level} has only 8^{cut_level} cells"
    )]
    SubtreeCode {
        /// Where the subtree begins.
        offset: u64,
        /// Its Morton code.
        code: u64,
        /// The level at which the octree is cut.
        cut_level: u8,
    },
    /// A subtree stands behind one that it should precede. Also an error of a caller of [`v5::Writer`](crate::v5::Writer).
    #[error("byte {offset}: a subtree with the Morton code {code} stands behind that with {previous}")]
    SubtreeOrder {
        /// Where the subtree begins.
        offset: u64,
        /// Its Morton code.
        code: u64,
        /// The Morton code of the one before.
        previous: u64,
    },
    /// The top of the tree names other subtrees than there are. Also an error of a caller of
    /// [`v5::Writer`](crate::v5::Writer).
    #[error(
        "byte {offset}: the top of the tree names {named} subtrees and there are {found}; number {place} is the first \
         that is another; convert the mesh again"
    )]
    TopSubtrees {
        /// Where the top of the tree begins.
        offset: u64,
        /// Subtrees that it names.
        named: u64,
        /// Subtrees that there are.
        found: u64,
        /// The first that is not the one named, counted from 0.
        place: u64,
    },
    /// The index describes a subtree other than it is.
    #[error("byte {offset}: subtree {place} is not as the index says; copy or convert the file again")]
    WrongIndex {
        /// Where the index or the subtree begins.
        offset: u64,
        /// The number of the subtree, counted from 0.
        place: u64,
    },
    /// The index counts other voxels than there are.
    #[error(
        "byte {offset}: level {level} has {found} voxels and {found_nodes} nodes, but {told} and {told_nodes} by the index; convert the mesh again"
    )]
    WrongCount {
        /// Where the index ends.
        offset: u64,
        /// The level.
        level: u8,
        /// Voxels on the level.
        found: u64,
        /// Voxels with children on the level.
        found_nodes: u64,
        /// Voxels by the index.
        told: u64,
        /// Voxels with children by the index.
        told_nodes: u64,
    },
    /// The file does not end as a complete one does.
    #[error("byte {offset}: there is no end of the file here; it is incomplete, copy or convert it again")]
    NoTrailer {
        /// Where the end should begin.
        offset: u64,
    },
    /// The end of the file says of the rest what is not so.
    #[error(
        "byte {offset}: the {field} is {found}, but {told} by the end of the file; copy or convert it again"
    )]
    WrongTrailer {
        /// Where the field is.
        offset: u64,
        /// What it says.
        field: &'static str,
        /// What it is.
        told: u64,
        /// What it should be.
        found: u64,
    },
    /// Sections do not follow each other without a gap.
    #[error(
        "byte {offset}: a section ends here, but the next one begins at byte {next}; copy or convert the file again"
    )]
    Gap {
        /// Where a section ends.
        offset: u64,
        /// Where the next one begins.
        next: u64,
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

    /// A section holds more than allowed, before compression.
    #[error(
        "byte {offset}: the {section} holds {bytes} bytes, more than the limit of {limit}; \
         cut the octree at a deeper level"
    )]
    SectionTooLarge {
        /// Where the section begins; 0 if it has not been written.
        offset: u64,
        /// What it is.
        section: &'static str,
        /// Bytes before compression.
        bytes: u64,
        /// The number of bytes that is allowed.
        limit: u64,
    },
    /// There are more subtrees than an index can have.
    #[error("{count} subtrees are too many for a file; cut the octree at a higher level")]
    TooManySubtrees {
        /// Number of subtrees.
        count: u64,
    },

    // The caller is at fault.
    /// A palette has more materials than the indices of its version can name.
    #[error("{count} materials are too many for the file, which can have {limit}; merge some")]
    TooManyMaterials {
        /// Number of materials.
        count: usize,
        /// The number that is possible.
        limit: usize,
    },
    /// A number of a material is negative, infinite or not a number. Also an error of a damaged file.
    #[error("material {index}: {value} is not a possible {field}")]
    ImpossibleMaterial {
        /// The palette index of the material, which counts from 1.
        index: u32,
        /// The field.
        field: &'static str,
        /// Its value.
        value: f32,
    },
    /// A world transform cannot lead anywhere. Also an error of a damaged file.
    #[error("voxels of size {voxel_size} at {origin:?} are not a possible place in the world")]
    ImpossibleWorld {
        /// World position of the cube's minimum corner.
        origin: [f64; 3],
        /// Length of the edge of a voxel.
        voxel_size: f64,
    },
    /// The name of the writing program does not fit.
    #[error("the name of the writer, {name:?}, must be at most {limit} bytes, none of them zero")]
    WriterName {
        /// The name.
        name: String,
        /// Bytes that there are room for.
        limit: usize,
    },
    /// Lists of voxels are not the levels of a tree.
    #[error("these are not the levels of a tree: {0}")]
    Levels(#[from] LevelDefect),
    /// A subtree has other levels than those of the file.
    #[error(
        "a subtree has {count} levels from level {first} on, but the file has subtrees with {expected_count} levels \
         from level {expected_first} on"
    )]
    SubtreeLevels {
        /// Level of the subtree's root.
        first: u8,
        /// Number of levels.
        count: u8,
        /// The level at which the octree is cut.
        expected_first: u8,
        /// Number of levels from that to the finest.
        expected_count: u8,
    },
    /// The top of the tree has other levels than those above the subtrees.
    #[error(
        "the top of the tree should be the {expected_count} levels above the cut, but is {count} levels from level {first} on"
    )]
    TopLevels {
        /// The first level.
        first: u8,
        /// Number of levels.
        count: u8,
        /// The level at which the octree is cut.
        expected_count: u8,
    },
    /// There is no such subtree.
    #[error("there is no subtree {number}, only {count}, counted from 0")]
    NoSubtree {
        /// Number of the subtree that was asked for.
        number: u64,
        /// Number of subtrees.
        count: u64,
    },
    /// The end of a file was asked for after reading it had failed.
    #[error("byte {offset}: reading has failed before")]
    AfterError {
        /// How much had been read.
        offset: u64,
    },
    /// An octree that makes no sense cannot be converted.
    #[error("{0}; an octree like this cannot be converted, convert the mesh again")]
    Senseless(#[from] Defect),
    /// A file of another program, or for one, is at fault.
    #[error(transparent)]
    Exchange(#[from] ExchangeError),
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
    /// A section could not be compressed.
    #[error("cannot compress a section")]
    Compression(#[source] io::Error),
}

/// What could be read instead.
fn known_versions(version: u16) -> &'static str {
    match version {
        4 => ", only version 5 can",
        5 => ", only version 4 can",
        _ => ", only versions 4 and 5 are known",
    }
}
