//! What can go wrong between a mesh and its file.

use octvox_format::FormatError;
use std::path::PathBuf;

/// Why a mesh could not be read or converted.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ConvertError {
    /// The file cannot be opened or read.
    #[error("{path}: cannot read the model")]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// A statement of the file is not what the format allows.
    #[error("{path}:{line}: {problem}")]
    Statement {
        /// The file.
        path: PathBuf,
        /// Line of the statement, counted from 1.
        line: usize,
        /// What is wrong, and what is expected.
        problem: String,
    },
    /// A value of a binary file is not what the format allows.
    #[error("{path}: byte {offset}: {problem}")]
    Bytes {
        /// The file.
        path: PathBuf,
        /// Place of the value, counted from 0.
        offset: usize,
        /// What is wrong, and what is expected.
        problem: String,
    },
    /// A face refers to a vertex or normal that does not precede it.
    #[error(
        "{path}:{line}: the face refers to {kind} {index}, but {count} precede it; correct the index or add the missing lines"
    )]
    FaceIndex {
        /// The file.
        path: PathBuf,
        /// Line of the face, counted from 1.
        line: usize,
        /// `vertex`, `texture coordinate` or `normal`.
        kind: &'static str,
        /// The index as written: from 1, or negative from the end.
        index: i64,
        /// How many of that kind stand before the face.
        count: usize,
    },
    /// The file was read, but something in it that has no line is wrong.
    #[error("{path}: {problem}")]
    Model {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        problem: String,
    },
    /// Neither its content nor its name tells what kind of file it is, and there are no faces of an OBJ file in it.
    #[error(
        "{path}: neither the content nor the ending is that of a mesh; known are .obj, .ply, .stl, .gltf and .glb"
    )]
    UnknownKind {
        /// The file.
        path: PathBuf,
    },
    /// There is nothing to convert.
    #[error("the mesh has no faces; export it with its surface (`f` lines in OBJ)")]
    NoFaces,
    /// All of the surface is a hole of its opacity maps.
    #[error(
        "the opacity maps (alpha) cut out all of the surface; correct them, or take them out of the materials"
    )]
    AllCutOut,
    /// A vertex of a face has a coordinate that is infinite or not a number.
    #[error("vertex {vertex} (counted from 0) is at ({}, {}, {}), which is no place; correct its coordinates", .position[0], .position[1], .position[2])]
    NotFinite {
        /// Index of the vertex, from 0.
        vertex: usize,
        /// Its coordinates.
        position: [f64; 3],
    },
    /// A triangle of a mesh built in memory refers to something that the mesh lacks.
    #[error("triangle {triangle} refers to {kind} {index}, but the mesh has {count}")]
    IndexOutOfRange {
        /// Index of the triangle, from 0.
        triangle: usize,
        /// `vertex` or `material`.
        kind: &'static str,
        /// The index, from 0.
        index: u32,
        /// How many there are.
        count: usize,
    },
    /// An image has no pixels, or not as many as its size says.
    #[error(
        "image {name}: {width} × {height} pixels need as many colours, at least one, but there are {pixels}"
    )]
    ImageSize {
        /// The image.
        name: String,
        /// Pixels in a row.
        width: u32,
        /// Pixels in a column.
        height: u32,
        /// How many colours there are.
        pixels: usize,
    },
    /// An image cannot be decoded.
    #[error("image {name} cannot be read: {source}; save it as PNG, JPEG, BMP or TGA")]
    UnreadableImage {
        /// The image.
        name: String,
        /// What the decoder says.
        source: image::ImageError,
    },
    /// An image has too many pixels.
    #[error("image {name} has {width} × {height} pixels, more than {max}; make it smaller")]
    LargeImage {
        /// The image.
        name: String,
        /// Pixels in a row.
        width: u32,
        /// Pixels in a column.
        height: u32,
        /// How many pixels are possible.
        max: u64,
    },
    /// A texture map refers to an image that the mesh lacks.
    #[error(
        "material {material} refers to image {image}, but the mesh has {count}; add the images before the materials"
    )]
    MissingImage {
        /// Name of the material.
        material: String,
        /// Index of the image, from 0.
        image: usize,
        /// How many there are.
        count: usize,
    },
    /// Two lists that belong together have different lengths.
    #[error("the mesh has {found} {kind} for {expected}; give one for each or none")]
    LengthMismatch {
        /// What there is too much or too little of.
        kind: &'static str,
        /// How many there are.
        found: usize,
        /// How many there should be.
        expected: usize,
    },
    /// More triangles or vertices than 32-bit indices can count.
    #[error("the mesh has {count} {kind}, more than {max}; split it")]
    TooLarge {
        /// `vertices`, `triangles`.
        kind: &'static str,
        /// How many there are.
        count: usize,
        /// How many are possible.
        max: usize,
    },
    /// The model is larger than coordinates can express differences of.
    #[error("the model is {extent:e} units long, which is too large for its coordinates; scale it down")]
    ExtentTooLarge {
        /// Length of the longest axis.
        extent: f64,
    },
    /// The depth is out of range.
    #[error("depth {depth} is out of range; choose 0 (one cell) to {max} ({} cells per axis)", 1u32 << .max)]
    Depth {
        /// What was asked for.
        depth: u8,
        /// What is possible.
        max: u8,
    },
    /// The palette size is out of range.
    #[error("a palette of {size} colours is not possible; choose 1 to {max}")]
    PaletteSize {
        /// What was asked for.
        size: usize,
        /// What is possible.
        max: usize,
    },
    /// The palette cannot have an entry for each finish.
    #[error(
        "the model's surfaces have {finishes} different finishes (highlight, reflection, transparency …), but the palette \
         only {size} entries; allow a larger palette, or choose version 4, which keeps colours only"
    )]
    TooManyFinishes {
        /// Finishes that voxels have.
        finishes: usize,
        /// Entries of the palette.
        size: usize,
    },
    /// The crease angle is out of range.
    #[error("a crease angle of {degrees} degrees is not possible; choose 0 to 180")]
    CreaseAngle {
        /// What was asked for.
        degrees: f64,
    },
    /// The bounds are no box.
    #[error("the bounds {bounds:?} are no box; each minimum must be finite and below its maximum")]
    Bounds {
        /// What was asked for: xmin, ymin, zmin, xmax, ymax, zmax.
        bounds: [f64; 6],
    },
    /// The voxel size is no size.
    #[error("a voxel size of {size} is not possible; choose a positive number of world units")]
    VoxelSize {
        /// What was asked for.
        size: f64,
    },
    /// The model reaches out of the cube that is to be converted.
    #[error(
        "the model reaches from {model_min} to {model_max} along {axis}, but the cube from {cube_min} to {cube_max}; \
         choose wider bounds, larger voxels or a greater depth"
    )]
    OutsideCube {
        /// `x`, `y` or `z`.
        axis: char,
        /// Where the model begins on that axis, in world units.
        model_min: f64,
        /// Where the model ends.
        model_max: f64,
        /// Where the cube begins.
        cube_min: f64,
        /// Where the cube ends.
        cube_max: f64,
    },
    /// The memory bound leaves no room for the work.
    #[error(
        "{needed} bytes of memory are needed for this model at this resolution, but only {bound} are allowed; raise the \
         memory bound, lower the resolution, or use fewer threads"
    )]
    MemoryBound {
        /// What is needed, at least.
        needed: u64,
        /// What was asked for.
        bound: u64,
    },
    /// The disk has no room for the file and what is stored beside it for a while.
    #[error(
        "{folder}: about {needed} bytes are needed here for the file and temporary data, but {free} are free; choose another \
         disk, allow more memory, or lower the resolution"
    )]
    DiskSpace {
        /// Where the file and temporary data go.
        folder: PathBuf,
        /// What is needed, about.
        needed: u64,
        /// What is free.
        free: u64,
    },
    /// Voxels that memory has no room for cannot be stored or read back.
    #[error("{folder}: cannot use a temporary file")]
    TemporaryFile {
        /// Where it is.
        folder: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The mesh is to be filled, but has no inside.
    #[error(
        "the mesh has {open_edges} open edges, and its surface goes around no place far enough to tell inside from outside; \
         close its holes, or convert it without filling"
    )]
    OpenMesh {
        /// Edges that belong to an odd number of triangles.
        open_edges: u64,
    },
    /// The file cannot be encoded.
    #[error(transparent)]
    Format(#[from] FormatError),
    /// The output cannot be written.
    #[error("cannot write the voxels: {0}")]
    Write(#[source] std::io::Error),
}
