//! From a file to a mesh.

mod gltf;
mod mtl;
mod named_file;
mod number;
mod obj;
mod ply;
mod stl;
mod textures;
mod triangulation;
mod weld;

use crate::{ConvertError, Mesh};
use std::path::Path;

/// Reads a mesh and the files it names: OBJ (with MTL), PLY, STL, glTF 2.0 and GLB.
///
/// Which of them it is is told from the content first, then from the ending of the name. Polygons are cut into triangles.
/// Vertices at the same place become one, so that a surface stays connected across groups and materials. What is odd but
/// harmless is noted in [`Mesh::warnings`]. Work runs on the current rayon pool; the result does not depend on the number of
/// threads.
///
/// # Errors
/// [`ConvertError::Read`] if the file cannot be read; [`ConvertError::Statement`], [`ConvertError::FaceIndex`] and
/// [`ConvertError::Bytes`] with the place of what is wrong in it; [`ConvertError::Model`] if it is wrong as a whole or has
/// no surface; [`ConvertError::UnknownKind`] if it seems to be none of these; [`ConvertError::TooLarge`].
pub fn load_mesh(path: &Path) -> Result<Mesh, ConvertError> {
    let bytes = std::fs::read(path).map_err(|source| ConvertError::Read { path: path.to_owned(), source })?;
    read_mesh(path, &bytes)
}

/// Reads a mesh from the bytes of a file, as [`load_mesh`] does.
///
/// `path` is where they are from: its ending tells the kind, its folder is where other files are looked for, and errors
/// name it.
///
/// # Errors
/// As [`load_mesh`].
pub fn read_mesh(path: &Path, bytes: &[u8]) -> Result<Mesh, ConvertError> {
    let bytes = without_byte_order_mark(bytes);
    let mesh = match Kind::of(path, bytes) {
        Some(Kind::Obj) => obj::read(path, bytes),
        Some(Kind::Ply) => ply::read(path, bytes),
        Some(Kind::Stl) => stl::read(path, bytes),
        Some(Kind::Gltf) => gltf::read(path, bytes),
        // OBJ has no mark of its own, so it may be that under another name.
        None => obj::read(path, bytes).map_err(|error| match error {
            ConvertError::NoFaces => ConvertError::UnknownKind { path: path.to_owned() },
            error => error,
        }),
    };
    with_path(path, mesh)
}

/// Text without the mark that some editors put before UTF-8.
fn without_byte_order_mark(text: &[u8]) -> &[u8] {
    text.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(text)
}

/// Kinds of files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Obj,
    Ply,
    Stl,
    Gltf,
}

impl Kind {
    /// The kind of a file with a name and a content, if they tell.
    fn of(path: &Path, bytes: &[u8]) -> Option<Self> {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        let ending = ending.unwrap_or_default();
        let start = bytes.trim_ascii_start();
        if bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r") {
            Some(Self::Ply)
        } else if bytes.starts_with(b"glTF") || start.starts_with(b"{") {
            Some(Self::Gltf)
        } else if stl::is_binary(bytes) || (ending != "obj" && start.starts_with(b"solid")) {
            Some(Self::Stl)
        } else {
            match ending.as_str() {
                "obj" => Some(Self::Obj),
                "ply" => Some(Self::Ply),
                "stl" => Some(Self::Stl),
                "gltf" | "glb" => Some(Self::Gltf),
                _ => None,
            }
        }
    }
}

/// Names the file in errors that only know the mesh.
fn with_path(path: &Path, mesh: Result<Mesh, ConvertError>) -> Result<Mesh, ConvertError> {
    mesh.map_err(|error| match error {
        error @ (ConvertError::NoFaces | ConvertError::NotFinite { .. } | ConvertError::TooLarge { .. }) => {
            ConvertError::Model { path: path.to_owned(), problem: error.to_string() }
        }
        error => error,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_content_tells_the_kind_and_then_the_name() {
        let binary_stl = {
            let mut bytes = b"solid that is none".to_vec();
            bytes.resize(84 + 50, 0);
            bytes[80] = 1;
            bytes
        };
        for (name, bytes, kind) in [
            ("a.obj", &b"ply\nformat ascii 1.0\n"[..], Some(Kind::Ply)),
            ("a.ply", b"v 0 0 0\n", Some(Kind::Ply)),
            ("a.txt", b"v 0 0 0\n", None),
            ("a", b"", None),
            ("a.bin", b"glTF\x02\0\0\0", Some(Kind::Gltf)),
            ("a.obj", b"\n {\"asset\":{}}", Some(Kind::Gltf)),
            ("a.GLB", b"", Some(Kind::Gltf)),
            ("a.txt", b"solid cube\nfacet", Some(Kind::Stl)),
            ("a.obj", b"solid\nv 0 0 0", Some(Kind::Obj)),
            ("a.obj", &binary_stl, Some(Kind::Stl)),
            ("a.stl", &binary_stl[..90], Some(Kind::Stl)),
        ] {
            assert_eq!(Kind::of(name.as_ref(), bytes), kind, "{name} {bytes:?}");
        }
    }
}
