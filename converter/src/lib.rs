//! Triangle meshes to sparse voxel octrees: `.vox` files of version 4 or 5.
//!
//! ```text
//!  load_mesh                    convert
//!  ───────────────────────      ───────────────────────────────────────────────────────────────────────────────────────
//!  obj, ply, stl, gltf ▶ mesh ▶ placement ▶ fixed_point ▶ binning ▶ scan_conversion ▶ voxel_filter ▶ color_census, palette
//!             triangulation                 normals       (blocks)  or conservative                            │
//!                                                                                                              ▼
//!                                output ◀ prune ◀ solid ◀ lod, lod_color ◀ coloring ◀ octree, block_tree, structure
//! ```
//!
//! - A mesh is placed in a cube of 2^depth cells per axis and its vertices are rounded to a fine grid; from then on
//!   integers decide which voxels are filled (`fixed_point`, `edge_function`, `column_depth`).
//! - The cube is cut into blocks of 64³ cells. Triangles are binned into blocks; each block is scan-converted, filtered,
//!   built and encoded on its own, in parallel. The top of the tree is put on last.
//! - Where a material has maps, each sample looks up colour, opacity and normal in them before it goes to its voxel (`texture`).
//!   Displacement maps move the mesh before anything else (`displacement`, `subdivision`).
//! - Nothing is ever a tree of pointers: an octree is a list of child masks per level, in Morton order (`structure`), and
//!   voxels stand in lists beside it.
//! - Between the stages blocks wait in memory as long as there is room, and in a temporary file beyond that (`storage`).
//!   Memory and disk are compared with an estimate before the work (`estimate`, `resources`).
//! - All sums that meet in a voxel are sums of integers, so the bytes of the file depend on mesh and options alone.
//!
//! [`MeshLook`] tells what a mesh looks like at a point of its surface, by the same normals, colours and textures, for
//! pictures of voxels to be held against.
//!
//! # Example
//!
//! ```
//! use octvox_cli::Progress;
//! use octvox_converter::{Mesh, Options, convert};
//!
//! let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
//! let tetrahedron = Mesh::new(positions, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])?;
//!
//! let mut file = Vec::new();
//! let options = Options { depth: 6, ..Options::default() };
//! let report = convert(&tetrahedron, &options, &Progress::hidden(), &mut file)?;
//! assert_eq!(report.resolution, 64);
//! assert_eq!(report.file_bytes, file.len() as u64);
//! # Ok::<(), octvox_converter::ConvertError>(())
//! ```

mod binning;
mod block;
mod block_tree;
mod color_census;
mod color_set;
mod color_space;
mod coloring;
mod column_depth;
mod conservative;
mod convert;
mod disjoint_sets;
mod displacement;
mod edge_function;
mod error;
mod estimate;
mod extent;
mod finish;
mod fixed_point;
mod image;
mod interpolation;
mod kd_tree;
mod lod;
mod lod_color;
mod look;
mod material;
mod mesh;
mod morton;
mod nearest_color;
mod normals;
mod octree;
mod options;
mod output;
mod palette;
mod palette_cut;
mod palette_kmeans;
mod palette_reduction;
mod parts;
mod placement;
mod prune;
mod read;
mod report;
mod resources;
mod scan_conversion;
mod solid;
mod storage;
mod structure;
mod subdivision;
mod subtree;
mod surface;
mod texture;
mod texture_map;
mod vector;
mod voxel;
mod voxel_filter;

pub use convert::convert;
pub use error::ConvertError;
pub use estimate::Estimate;
pub use image::Image;
pub use lod_color::LodColor;
pub use look::{Look, MeshLook};
pub use material::{DisplacementMap, Material, NormalMap, NormalMapKind};
pub use mesh::Mesh;
pub use octvox_format::WorldTransform;
pub use octvox_format::v5::Compression;
pub use options::{FileFormat, Options};
pub use read::{load_mesh, read_mesh};
pub use report::{Report, Seconds};
pub use texture_map::{Channel, TextureMap, Wrap};
