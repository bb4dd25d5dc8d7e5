//! Voxel octrees to pictures, on the CPU, in packets of rays.
//!
//! An [`Octree`] is read from a `.vox` file and followed by rays: single ones ([`Octree::hit`]), many
//! ([`Octree::hits`]), or those of a whole picture ([`render`], [`Visibility`]). Results are the same, bit for bit, for
//! every packet width, number of threads and instruction set. [`check`] holds them against exact arithmetic, from which
//! [`Arithmetic::Double`] does not differ on a lattice.
//!
//! Coordinates are in *unit space*, in which the octree's cube is [0, 1]³, y up.
//!
//! ```no_run
//! use octvox_raytracer::{Camera, DEFAULT_FOV, Octree, RenderOptions, render};
//!
//! let octree = Octree::open("bunny.vox".as_ref())?;
//! let options = RenderOptions { size: [640, 480], ..RenderOptions::default() };
//! let camera = Camera::framing(&octree, 640.0 / 480.0, DEFAULT_FOV);
//! let (frame, report) = render(&octree, &camera, &options, |_| {})?;
//! println!("{} rays, {} pixels show the model", report.rays.total(), frame.hit_pixels);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

// From the file to memory.
mod bits;
mod builder;
mod error;
mod grid;
mod node;
mod octree;
mod payload;

// From rays to hits.
mod arithmetic;
mod cast;
pub mod lanes;
mod lod;
mod ray;
mod traversal;
mod width;

// From pixels to a picture.
mod beam;
mod bundle;
mod bvh;
mod camera;
mod color;
mod crossing;
mod crowd;
mod departure;
mod ends;
mod eye;
mod film;
mod frame;
mod lens;
mod optics;
mod parted;
mod passing;
mod plan;
mod primary;
mod pursuit;
mod quality;
mod render;
mod sampling;
pub mod scene;
mod scene_file;
mod secondary;
mod shared;
mod smoothing;
mod surface;
mod tile;
mod tone;
mod transport;
mod visibility;
mod world;

// Held against exact arithmetic.
mod check;
mod enclosure;
mod exact;
pub mod oracle;
mod picture_check;
mod random;
mod replay;

// Held against the triangles that the voxels were made of.
pub mod picture_error;
pub mod truth;

pub use arithmetic::Arithmetic;
pub use camera::{Camera, CameraError, DEFAULT_FOV};
pub use cast::Hit;
pub use check::{CheckOptions, CheckReport, DISPLACEMENT, check};
pub use color::{Light3, to_displayed, to_linear};
pub use error::LoadError;
pub use film::Region;
pub use frame::{Aov, FirstHit, Frame, MAX_PIXELS};
pub use lens::{Lens, Projection};
pub use octree::{Bounds, Octree};
pub use payload::{CodedNormal, Payload};
pub use plan::Plan;
pub use quality::{Filter, Leave, Quality};
pub use ray::Ray;
pub use render::{RenderOptions, RenderReport, TileDone, render, render_scene};
pub use replay::{Replay, ReplayedHit, ReplayedWidth, replay};
pub use scene_file::{ModelFile, SceneFile, SceneFileError, SceneProblem, Shot};
pub use secondary::{SecondaryKind, SecondaryRays};
pub use tile::TILE_SIZE;
pub use tone::{Tone, ToneMapping};
pub use transport::RayCounts;
pub use visibility::{Counts, Visibility, VisibilityOptions};
pub use width::Width;
