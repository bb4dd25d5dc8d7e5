//! The `.vox` file, version 5: the octree cut into subtrees that are compressed, checked and found one by one.
//!
//! ```text
//!  bytes  part
//!  96     header             depth, cut level, normal code, compression, world, writer, CRC-32
//!  32 …   section "MATL"     the material palette
//!  32 …   section "TREE"     a subtree …
//!         …                  … and the others, in Morton order
//!  32 …   section "TOP "     the levels above the subtrees
//!  32 …   section "INDX"     voxels of each level; where each subtree is
//!  36     trailer            where "TOP " and "INDX" are, number of subtrees and voxels, CRC-32
//!
//!  header        offset  0 magic 4D 42    2 version 05 00   4 depth          5 cut level      6 normal code
//!                        7 compression    8 materials u16  10 zeros         16 origin 3 f64  40 voxel size f64
//!                       48 writer UTF-8  92 CRC-32
//!
//!  section head  offset  0 kind           4 stored length u32               8 Morton code u64
//!                       16 masks u32     20 items u32      24 table u16     26 encoding u8   27 zero
//!                       28 CRC-32        32 stored bytes
//!
//!  material      offset  0 diffuse        3 reflectivity    4 specular       7 transparency   8 shininess f32
//!                       12 refraction index f32            16 absorption 3 f32              28 emission 3 f32
//!
//!  levels        table of t palette indices u16; then for each level from the root's, of n voxels:
//!                n child masks (not on the finest level), 0, n or 2n bytes of palette indices, 2n bytes of normals
//!
//!  index         (depth + 1) × { voxels u64, nodes u64 }, subtrees × entry
//!  entry         offset  0 Morton code    8 offset u64     16 stored length u32              20 masks u32
//!                       24 voxels u32    28 CRC-32
//!
//!  trailer       offset  0 "END "         4 subtrees u32    8 offset of "TOP " u64
//!                       16 offset of "INDX" u64            24 voxels u64    32 CRC-32
//! ```
//!
//! `format/FORMAT.md` has the whole description. In short: only filled voxels are stored, level by level, within a level in
//! Morton order, with a mask of eight bits for the children. Palette indices and normals are stored as differences from
//! the parent, apart from each other and from the masks, and each section is compressed on its own.
//!
//! # Writing
//!
//! A file is written from its beginning to its end, without going back: the subtrees, which any number of threads may
//! encode, and then the levels above them.
//!
//! ```
//! use octvox_format::v5::{Header, Levels, Planes, Subtree, Writer};
//! use octvox_format::{Material, MaterialPalette, NormalCode};
//!
//! // An octree of 4³ cells, cut at level 1: a subtree has 2³ cells.
//! let header = Header { cut_level: 1, ..Header::new(2) };
//! let materials = MaterialPalette::new(vec![Material::matte([200, 0, 0])])?;
//! let up = NormalCode::Octahedral.encode([0.0, 0.0, 1.0]);
//!
//! let mut writer = Writer::new(Vec::new(), &header, &materials)?;
//! let encoder = writer.encoder();
//! // In the eighth that is farthest from the origin, the lower four cells: a root with the children 0 to 3.
//! let planes = Planes { masks: vec![0b1111], palette_indices: vec![1; 5], normals: vec![up; 5] };
//! let subtree = Subtree { code: 7, levels: Levels::subtree(1, 2, planes)? };
//! writer.subtree(&encoder.encode(&subtree)?)?;
//! // Above, there is only the root of the octree, which has the child 7.
//! let planes = Planes { masks: vec![1 << 7], palette_indices: vec![1], normals: vec![up] };
//! let file = writer.finish(&Levels::top(1, planes)?)?;
//! # assert_eq!(octvox_format::v5::Archive::of_bytes(&file)?.index().voxels(), 6);
//! # Ok::<(), octvox_format::FormatError>(())
//! ```
//!
//! # Reading
//!
//! An [`Archive`] finds any subtree at any time, for several threads at once; a [`Reader`] takes them as they come. Either
//! way whole lists of voxels are returned, checked so that nothing that counts the bits of masks can go astray.
//!
//! ```
//! use octvox_format::v5::{Archive, Region, Source};
//! use octvox_format::FormatError;
//!
//! /// Filled cells of the finest level in the subtrees that meet a region.
//! fn count(archive: &Archive<impl Source>, region: Region) -> Result<usize, FormatError> {
//!     let mut leaves = 0;
//!     for number in archive.subtrees_in(region) {
//!         let subtree = archive.subtree(number)?;
//!         leaves += subtree.levels.level(archive.header().depth).normals.len();
//!     }
//!     Ok(leaves)
//! }
//! ```

mod archive;
mod compression;
mod decoding;
mod encoding;
mod header;
mod index;
mod levels;
mod morton;
mod prediction;
mod raw_bytes;
mod reader;
mod records;
mod recycled;
mod region;
mod section;
mod source;
mod splitter;
mod subtree;
mod summary;
mod trailer;
mod writer;

pub use archive::Archive;
pub use header::{Compression, Header, VERSION};
pub use index::{Index, IndexEntry, LevelCount};
pub use levels::{Level, LevelDefect, Levels, Planes};
pub use morton::{cell_of_code, code_of_cell};
pub use reader::{Ending, Parts, Reader};
pub(crate) use records::Preorder;
pub use records::Records;
pub use region::Region;
pub use source::{Seekable, Source};
pub(crate) use splitter::Splitter;
pub use subtree::{Decoder, EncodedSubtree, Encoder, StoredSubtree, Subtree};
pub use summary::summarize;
pub use writer::Writer;
