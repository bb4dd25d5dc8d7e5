//! To and from the formats of other programs.
//!
//! | format | ending | here |
//! |---|---|---|
//! | MagicaVoxel | `.vox` | [`magicavoxel::import`], [`magicavoxel::export`] |
//! | binvox | `.binvox` | [`write_binvox`] |
//! | NumPy | `.npy` | [`write_npy`] |
//! | cell after cell, without anything before | `.raw` | [`write_raw`] |
//!
//! All exports begin with the filled cells of an octree, its [`Leaves`], which are made from the records of any version.
//! A
//! [`Volume`], with a value for each of its cells, is never in memory: what is, are runs of filled cells, 16 bytes each.
//!
//! ```
//! use octvox_format::exchange::{Cells, Leaves, Volume, write_npy};
//! use octvox_format::AnyReader;
//! use std::io::Cursor;
//!
//! # let file = [0x4D, 0x42, 4, 0, 1, 0, 255, 0, 0, 0x7C, 0x7C, 1 << 1, 0, 128, 64];
//! let reader = AnyReader::new(Cursor::new(file))?;
//! let materials = reader.materials();
//! let volume = Volume { leaves: Leaves::new(reader.records()?), depth: 0, max_bytes: 1 << 32 };
//! let array = write_npy(volume, Cells::of_palette(&materials), &materials, Vec::new())?;
//! assert_eq!(array.len(), 128 + 1);
//! # Ok::<(), octvox_format::FormatError>(())
//! ```

mod binvox;
mod cells;
mod error;
mod leaves;
pub mod magicavoxel;
mod npy;
mod raw;
mod runs;
mod volume;

pub use binvox::write_binvox;
pub use cells::Cells;
pub use error::ExchangeError;
pub use leaves::{Leaf, Leaves};
pub use npy::write_npy;
pub use raw::write_raw;
pub use volume::Volume;
