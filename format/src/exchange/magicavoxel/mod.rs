//! MagicaVoxel's `.vox`, which shares only its ending with ours (`MagicaVoxel-file-format-vox.txt` and
//! `-vox-extension.txt`, version 150).
//!
//! ```text
//!  "VOX "  version u32  chunk "MAIN", which has no content but all others as children
//!
//!  chunk   kind 4 bytes  content length u32  children length u32  content  children
//!
//!  SIZE    x y z u32                        a model, at most 256³, together with the XYZI behind it
//!  XYZI    n u32, n × { x y z index u8 }    its voxels; index 1 to 255
//!  RGBA    256 × { r g b a u8 }             the colour of index k is the one numbered k − 1
//!  MATL    index u32, dictionary            the material of an index
//!  LAYR    layer u32, dictionary, −1
//!  nTRN    node u32, dictionary, child u32, −1, layer u32, n u32, n × dictionary      a place: "_r", "_t"
//!  nGRP    node u32, dictionary, n u32, n × child u32
//!  nSHP    node u32, dictionary, n u32, n × { model u32, dictionary }
//!
//!  dictionary  n u32, n × { key, value }    text: length u32 and so many bytes
//! ```
//!
//! There z points up. In our octrees y does, as in most mesh files: MagicaVoxel's (x, y, z) is our (x, z, −y).
//!
//! The chunks are few and simple, so they are read here: what reads them must say where a file is damaged, must not be led
//! into endless scenes, and must write the same bytes every time.

mod chunks;
mod default_palette;
mod exporting;
mod importing;
mod material;
mod normals;
mod octree;
mod reduced_palette;
mod reduction;
mod scene;

pub use exporting::export;
pub use importing::{import, is_magicavoxel};

/// Longest edge of a model.
const MODEL_SIDE: u32 = 256;

/// Voxels that are read or written: those of a model count as often as it is shown. They need 1 GiB of memory.
const MAX_VOXELS: u64 = 1 << 26;
