//! STL: triangles, in bytes or as text. They know no neighbours, so vertices at the same place become one.

use super::number::parse_number;
use super::weld::weld_vertices;
use crate::{ConvertError, Mesh};
use rayon::prelude::*;
use std::path::Path;

/// What stands before the triangles of a binary file: a free text, and their number.
const HEADER_BYTES: usize = 84;
/// A triangle: the normal, three corners, and two bytes that every program uses in another way.
const TRIANGLE_BYTES: usize = 50;

/// Whether the bytes are a binary file: its length says so, since its free text may look like the other kind.
pub(super) fn is_binary(bytes: &[u8]) -> bool {
    triangle_count(bytes)
        .is_some_and(|count| bytes.len() as u64 == HEADER_BYTES as u64 + count * TRIANGLE_BYTES as u64)
}

/// The number of triangles that a binary file says it has.
fn triangle_count(bytes: &[u8]) -> Option<u64> {
    bytes.get(80..)?.first_chunk().map(|count| u64::from(u32::from_le_bytes(*count)))
}

/// Reads the bytes of an STL file; `path` is where it is from.
///
/// The normals of the triangles are left out: they are those of the corners' order.
pub(super) fn read(path: &Path, bytes: &[u8]) -> Result<Mesh, ConvertError> {
    let is_text = !is_binary(bytes) && bytes.trim_ascii_start().starts_with(b"solid");
    let positions = if is_text { read_text(path, bytes)? } else { read_binary(path, bytes)? };
    let (count, max) = (positions.len() / 3, u32::MAX as usize / 9);
    if count > max {
        return Err(ConvertError::TooLarge { kind: "triangles", count, max });
    }
    let triangles = (0..count as u32).map(|triangle| [0, 1, 2].map(|corner| 3 * triangle + corner)).collect();
    let mut mesh = Mesh::new(positions, triangles)?;
    weld_vertices(&mut mesh)?;
    Ok(mesh)
}

/// The corners of all triangles.
fn read_binary(path: &Path, bytes: &[u8]) -> Result<Vec<[f64; 3]>, ConvertError> {
    let wrong = |offset, problem| ConvertError::Bytes { path: path.to_owned(), offset, problem };
    let Some(count) = triangle_count(bytes) else {
        let problem = "the file ends within its header of 84 bytes; it is incomplete".to_owned();
        return Err(wrong(bytes.len(), problem));
    };
    let (triangles, _) = bytes[HEADER_BYTES..].as_chunks::<TRIANGLE_BYTES>();
    // What follows the triangles belongs to some program.
    let Some(triangles) = usize::try_from(count).ok().and_then(|count| triangles.get(..count)) else {
        let problem = format!(
            "{count} triangles are announced, but {} follow; the file is incomplete",
            triangles.len()
        );
        return Err(wrong(80, problem));
    };
    let number = |bytes: &[u8; 4]| f64::from(f32::from_le_bytes(*bytes));
    let corners = |triangle: &[u8; TRIANGLE_BYTES]| {
        let numbers = triangle[12..].as_chunks::<4>().0;
        [0, 3, 6].map(|first| [0, 1, 2].map(|axis| number(&numbers[first + axis])))
    };
    Ok(triangles.par_iter().flat_map_iter(corners).collect())
}

/// The corners of all triangles: only the lines `vertex x y z` count, three for each.
fn read_text(path: &Path, text: &[u8]) -> Result<Vec<[f64; 3]>, ConvertError> {
    let mut positions = Vec::new();
    let mut corners = 0;
    for (line, text) in text.split(|&byte| byte == b'\n').enumerate() {
        let wrong = |problem| ConvertError::Statement { path: path.to_owned(), line: line + 1, problem };
        let mut words = text.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        match words.next() {
            Some(b"vertex") => {
                let mut position = [0.0; 3];
                for coordinate in &mut position {
                    let word = words.next().unwrap_or_default();
                    *coordinate = parse_number(word).ok_or_else(|| {
                        let word = String::from_utf8_lossy(word);
                        wrong(format!("`{}` is no number; expected `vertex x y z`", word.escape_debug()))
                    })?;
                }
                positions.push(position);
                corners += 1;
            }
            Some(b"endloop") => {
                if corners != 3 {
                    return Err(wrong(format!("the triangle has {corners} corners; expected 3")));
                }
                corners = 0;
            }
            Some(b"facet" | b"outer" | b"endfacet" | b"solid" | b"endsolid") | None => {}
            // Programs add statements of their own, such as colours.
            Some(_) if corners == 0 => {}
            Some(word) => {
                let word = String::from_utf8_lossy(word);
                return Err(wrong(format!("`{}` between the corners of a triangle", word.escape_debug())));
            }
        }
    }
    if corners != 0 {
        let problem = "the last triangle has no `endloop`; the file is incomplete".to_owned();
        return Err(ConvertError::Model { path: path.to_owned(), problem });
    }
    Ok(positions)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two triangles with a common edge.
    const CORNERS: [[f32; 3]; 6] = [
        [0.0, 0.0, 0.0],
        [1.5, 0.0, 0.0],
        [0.0, 1.0, -2.0],
        [1.5, 0.0, 0.0],
        [1.0, 1.0, 0.25],
        [0.0, 1.0, -2.0],
    ];

    fn binary() -> Vec<u8> {
        let mut bytes = b"solid or not".to_vec();
        bytes.resize(80, b' ');
        bytes.extend(2u32.to_le_bytes());
        for triangle in CORNERS.as_chunks::<3>().0 {
            bytes.extend([0; 12]);
            triangle.as_flattened().iter().for_each(|number| bytes.extend(number.to_le_bytes()));
            bytes.extend([7, 7]);
        }
        bytes
    }

    fn text() -> String {
        let mut text = "solid two triangles\r\n".to_owned();
        for triangle in CORNERS.as_chunks::<3>().0 {
            text += "facet normal 0 0 0\n  outer loop\n";
            for [x, y, z] in triangle {
                text += &format!("    vertex {x:e} {y} {z}\r\n");
            }
            text += "  endloop\nendfacet\n";
        }
        text + "endsolid two triangles"
    }

    fn read(bytes: &[u8]) -> Result<Mesh, ConvertError> {
        super::read("model.stl".as_ref(), bytes)
    }

    #[test]
    fn both_kinds_are_the_same_mesh() {
        for bytes in [binary(), text().into_bytes()] {
            let mesh = read(&bytes).unwrap();
            assert_eq!(mesh.triangles(), [[0, 1, 2], [1, 3, 2]]);
            let expected = [0, 1, 2, 4].map(|corner: usize| CORNERS[corner].map(f64::from));
            assert_eq!(mesh.positions(), expected);
        }
        // What follows the triangles is passed over.
        let mut bytes = binary();
        bytes.extend([1; 60]);
        bytes[..5].copy_from_slice(b"other");
        assert_eq!(read(&bytes).unwrap().triangles().len(), 2);
    }

    #[test]
    fn errors_name_the_place() {
        let mut cut = binary();
        cut.truncate(170);
        cut[0] = b'S';
        for (bytes, expected) in [
            (cut, "model.stl: byte 80: 2 triangles are announced, but 1 follow"),
            (b"stl".to_vec(), "model.stl: byte 3: the file ends within its header"),
            (text().replace("1.5e0 0 0", "1.5e0 0").into(), "model.stl:5: `` is no number"),
            (
                text().replace("vertex 0e0 0 0", "vertex 0e0 zero 0").into(),
                "model.stl:4: `zero` is no number",
            ),
            (
                text().replacen("    vertex 1.5e0 0 0\r\n", "", 1).into(),
                "model.stl:6: the triangle has 2 corners",
            ),
            (
                text().replacen("    vertex 1.5e0 0 0\r\n", "colour 1\n", 1).into(),
                "model.stl:5: `colour` between",
            ),
            (text()[..95].into(), "model.stl: the last triangle has no `endloop`"),
            (b"solid nothing\nendsolid".to_vec(), "the mesh has no faces"),
        ] {
            let error = read(&bytes).unwrap_err().to_string();
            assert!(error.starts_with(expected), "{expected}: {error}");
        }
        assert!(matches!(
            read(text().replacen("1.5e0", "inf", 1).as_bytes()),
            Err(ConvertError::NotFinite { vertex: 1, .. })
        ));
    }
}
