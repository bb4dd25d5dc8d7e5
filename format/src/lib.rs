//! The `.vox` file of sparse voxel octrees: version 4 (Bohnen 2009, section 3.2), bit for bit, and version 5, our own.
//!
//! | | version 4 | version 5 |
//! |---|---|---|
//! | voxels | filled and empty, in preorder | filled ones, level by level, in subtrees |
//! | a voxel on disk | 4 bytes | about 2.3, or 0.3 to 0.8 compressed |
//! | palette | 32,767 colours | 65,535 [materials](Material) |
//! | normals | [spherical](SphericalNormal), 0.79° | [octahedral](OctahedralNormal), 0.64°, or spherical |
//! | place in the world | unknown | [known](WorldTransform) |
//! | damage | noticed if it makes no sense | noticed by checksums |
//! | read | from the beginning to the end | likewise, or by subtree, region and level, in parallel |
//! | write and read | [`Writer`], [`Reader`] | [`v5::Writer`], [`v5::Reader`], [`v5::Archive`] |
//!
//! [`AnyReader`] takes both; [`to_version_5`] and [`to_version_4`] lead from one to the other, and [`exchange`] to and from
//! the formats of other programs. Version 5 is described in
//! the module [`v5`], version 4 here:
//!
//! ```text
//!  offset      bytes  field
//!  0           2      magic            4D 42 ("MB")
//!  2           2      version          04 00
//!  4           2      palette size     n, at most 32,767
//!  6           3n     palette          n × { red, green, blue }
//!  6 + 3n      2      separator        7C 7C, ignored when reading
//!  8 + 3n      4      root             a voxel
//!  12 + 3n     4…     its subtrees     only if it has children: eight of them, each a voxel and its subtrees
//!
//!  voxel       0      palette index << 1 | has children        low byte
//!              1                                               high byte
//!              2      normal: theta                            0 to 255, in units of π/256
//!              3      normal: phi                              -128 to 127, in units of π/128
//! ```
//!
//! All numbers are little-endian. Palette indices count from 1, and 0 says that a voxel is *empty*. The octree's
//! children stand in the order of their *octant* `x + 2y + 4z`, where 1 is the upper half of an axis. So the voxels are in
//! preorder, which is also the Morton order with x in the lowest bit. A voxel without children is the same throughout,
//! however many cells of the finest level it covers.
//!
//! What a file holds is checked record by record while it streams through; neither reading nor writing needs more
//! memory for a large file than for a small one.
//!
//! # Writing version 4
//!
//! ```
//! use octvox_format::{Palette, SphericalNormal, Voxel, Writer};
//!
//! // A cube of which only the eighth next to the origin is filled, in red.
//! let palette = Palette::new(vec![[255, 0, 0]])?;
//! let red = Voxel { palette_index: 1, normal: SphericalNormal::encode([1.0, 1.0, 1.0]) };
//!
//! let mut writer = Writer::new(Vec::new(), &palette)?;
//! writer.node(red)?;
//! writer.leaf(red)?;
//! for _octant in 1..8 {
//!     writer.empty()?;
//! }
//! let file = writer.finish()?;
//! assert_eq!(file.len(), 8 + 3 + 9 * 4);
//! # Ok::<(), octvox_format::FormatError>(())
//! ```
//!
//! # Reading version 4
//!
//! ```
//! use octvox_format::{FormatError, Reader};
//!
//! fn count_filled_leaves(file: impl std::io::Read) -> Result<u64, FormatError> {
//!     let mut leaves = 0;
//!     for record in Reader::new(file)? {
//!         let record = record?;
//!         if !record.has_children && !record.voxel.is_empty() {
//!             leaves += 1;
//!         }
//!     }
//!     Ok(leaves)
//! }
//!
//! let file = [0x4D, 0x42, 4, 0, 1, 0, 255, 0, 0, 0x7C, 0x7C, 1 << 1, 0, 128, 64];
//! assert_eq!(count_filled_leaves(&file[..])?, 1);
//! # Ok::<(), FormatError>(())
//! ```

#[cfg(test)]
mod angles;
mod any_reader;
mod conversion;
mod error;
pub mod exchange;
mod header;
mod input;
mod limits;
mod material;
mod material_palette;
mod normal;
mod normal_code;
mod octahedral_normal;
mod outline;
mod palette;
mod preorder;
mod reader;
mod sine;
mod summary;
pub mod v5;
mod validation;
mod voxel;
mod world;
mod writer;

pub use any_reader::{AnyReader, AnyRecords};
pub use conversion::{rewrite_version_5, to_version_4, to_version_5, write_version_4};
pub use error::FormatError;
pub use header::VERSION;
pub use limits::Limits;
pub use material::Material;
pub use material_palette::MaterialPalette;
pub use normal::SphericalNormal;
pub use normal_code::NormalCode;
pub use octahedral_normal::OctahedralNormal;
pub use outline::Outline;
pub use palette::Palette;
pub use reader::Reader;
pub use summary::{Summary, summarize, summarize_with};
pub use validation::Defect;
pub use voxel::{Record, Voxel};
pub use world::WorldTransform;
pub use writer::Writer;

/// The examples of the README are tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
