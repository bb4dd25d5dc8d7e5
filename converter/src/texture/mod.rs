//! Textures: from the images of a mesh to what a sample of its surface looks like.
//!
//! ```text
//!  Image ▶ pyramid ──────────────────────┐
//!  coordinates ▶ footprint (of a voxel) ─┴▶ lookup ▶ appearance: colour, cut-out, normal (normal_map)
//! ```

mod appearance;
mod coordinates;
mod footprint;
mod lookup;
mod normal_map;
mod pyramid;

pub(crate) use appearance::{Appearance, Textures};
pub(crate) use coordinates::{Coordinates, TexturePoint};
