//! Textures: from the images of a mesh to what a sample of its surface looks like.
//!
//! ```text
//!  Image ▶ pyramid ──────────────────────┐
//!  coordinates ▶ footprint (of a voxel) ─┴▶ lookup ▶ appearance: colour, cut-out, normal (normal_map)
//!                                                  ▶ displacement: how far the surface is moved before
//! ```

mod appearance;
mod coordinates;
mod displacement;
mod footprint;
mod lookup;
mod normal_map;
mod pyramid;

pub(crate) use appearance::{Appearance, Textures};
pub(crate) use coordinates::{Coordinates, TexturePoint};
pub(crate) use displacement::Displacement;
pub(crate) use footprint::Gradients;
