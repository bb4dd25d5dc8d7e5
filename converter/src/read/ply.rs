//! PLY, the Stanford polygon format: text, and binary of both byte orders.
//!
//! Vertices with normals (`nx ny nz`), colours (`red green blue`, integers or fractions) and texture coordinates (`s t`,
//! `u v`, `texture_u texture_v`); faces of any number of corners with texture coordinates at their corners (`texcoord`);
//! triangle strips. A comment `TextureFile` names the texture, as some programs write it. Other elements and properties
//! are passed over.

mod header;
mod values;

use super::textures::Textures;
use super::triangulation::Triangulation;
use super::weld::weld_vertices;
use crate::{ConvertError, Material, Mesh, TextureMap};
use header::{Element, Header, Kind, Scalar};
use rayon::prelude::*;
use std::path::Path;
use values::Values;

/// Reads the bytes of a PLY file; `path` is where it is from.
pub(super) fn read(path: &Path, bytes: &[u8]) -> Result<Mesh, ConvertError> {
    let header = Header::parse(path, bytes)?;
    let mut values = Values::new(path, bytes, &header);
    let mut vertices = Vertices::default();
    let mut faces = Faces::default();
    for element in &header.elements {
        let count = values.check_count(element)?;
        match element.name.as_str() {
            "vertex" => vertices.read(element, count, &mut values)?,
            "face" => faces.read(element, count, vertices.count(), &mut values)?,
            "tristrips" => faces.read_strips(element, count, vertices.count(), &mut values)?,
            // Nothing to be skipped, however many there are.
            _ if element.properties.is_empty() => {}
            _ => (0..count).try_for_each(|_| {
                element.properties.iter().try_for_each(|property| values.skip(property.kind))
            })?,
        }
    }
    let mut mesh = Mesh::default();
    add_texture(path, &header, &mut mesh);
    faces.cut(&vertices, &mut mesh)?;
    mesh.positions = vertices.positions;
    mesh.check()?;
    weld_vertices(&mut mesh)?;
    Ok(mesh)
}

/// The material of all faces, if the header names a texture.
fn add_texture(path: &Path, header: &Header, mesh: &mut Mesh) {
    let Some(name) = header.textures.first() else { return };
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut textures = Textures::default();
    if header.textures.len() > 1 {
        mesh.warnings.push(format!(
            "{}: {} textures are named, but only the first is used: {name}",
            path.display(),
            header.textures.len()
        ));
    }
    if let Some(image) = textures.load(folder, name, &mut mesh.warnings) {
        let diffuse_map = Some(TextureMap::new(image));
        mesh.materials.push(Material { diffuse_map, ..Material::matte(name, [1.0; 3]) });
        mesh.images = textures.images;
    }
}

/// What vertices have; lists are empty if they have it not.
#[derive(Default)]
struct Vertices {
    positions: Vec<[f64; 3]>,
    normals: Vec<[f32; 3]>,
    colors: Vec<[f32; 3]>,
    texture_coordinates: Vec<[f32; 2]>,
}

/// Names of the properties of position, normal, colour and texture coordinates.
const POSITION: [&[&str]; 3] = [&["x"], &["y"], &["z"]];
const NORMAL: [&[&str]; 3] = [&["nx"], &["ny"], &["nz"]];
const COLOR: [&[&str]; 3] =
    [&["red", "diffuse_red", "r"], &["green", "diffuse_green", "g"], &["blue", "diffuse_blue", "b"]];
const TEXTURE: [&[&str]; 2] = [&["s", "u", "texture_u", "texture_s"], &["t", "v", "texture_v", "texture_t"]];
/// Names of the lists of corners.
const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];

impl Vertices {
    fn count(&self) -> usize {
        self.positions.len()
    }

    fn read(&mut self, element: &Element, count: usize, values: &mut Values<'_>) -> Result<(), ConvertError> {
        let Some(position) = element.scalars(POSITION) else {
            return Err(values
                .wrong("the vertices have no coordinates; expected the properties x, y and z".to_owned()));
        };
        if self.count() > 0 {
            return Err(
                values.wrong("the vertices stand in two places; expected one element `vertex`".to_owned())
            );
        }
        let max = u32::MAX as usize / 3;
        if count > max {
            return Err(ConvertError::TooLarge { kind: "vertices", count, max });
        }
        let normal = element.scalars(NORMAL);
        let color = element.scalars(COLOR);
        let texture = element.scalars(TEXTURE);
        self.positions.reserve_exact(count);
        let mut row = vec![0.0; element.properties.len()];
        for _ in 0..count {
            values.read_row(element, &mut row)?;
            self.positions.push(position.map(|column| row[column]));
            if let Some(normal) = normal {
                self.normals.push(normal.map(|column| row[column] as f32));
            }
            if let Some(color) = color {
                self.colors.push(color.map(|column| element.color(column, row[column])));
            }
            if let Some(texture) = texture {
                self.texture_coordinates.push(texture.map(|column| row[column] as f32));
            }
        }
        Ok(())
    }
}

/// Polygons as lists of corners.
#[derive(Default)]
struct Faces {
    corners: Vec<u32>,
    arities: Vec<u32>,
    /// A colour for each face, or none.
    colors: Vec<[f32; 3]>,
    /// Texture coordinates of the corners, or none.
    texture_coordinates: Vec<[f32; 2]>,
}

impl Faces {
    fn read(
        &mut self,
        element: &Element,
        count: usize,
        vertices: usize,
        values: &mut Values<'_>,
    ) -> Result<(), ConvertError> {
        let Some(list) = element.list(&CORNERS) else {
            return Err(values.wrong("the faces have no corners; expected a list vertex_indices".to_owned()));
        };
        let texture = element.list(&["texcoord"]);
        let color = element.scalars(COLOR);
        let mut row = vec![0.0; element.properties.len()];
        let (mut corners, mut coordinates) = (Vec::new(), Vec::new());
        for _ in 0..count {
            for (column, property) in element.properties.iter().enumerate() {
                match property.kind {
                    Kind::Scalar(scalar) => row[column] = values.next(scalar)?,
                    Kind::List { .. } if column == list => values.read_list(property.kind, &mut corners)?,
                    Kind::List { .. } if Some(column) == texture => {
                        values.read_list(property.kind, &mut coordinates)?;
                    }
                    Kind::List { .. } => values.skip(property.kind)?,
                }
            }
            if corners.len() < 3 {
                return Err(
                    values.wrong(format!("a face has {} corners; expected at least 3", corners.len()))
                );
            }
            self.arities.push(corners.len() as u32);
            for &corner in &corners {
                self.corners.push(vertex(corner, vertices, values)?);
            }
            if texture.is_some() {
                let given = coordinates.as_chunks::<2>().0.iter().map(|uv| uv.map(|number| number as f32));
                self.texture_coordinates.extend(given.chain(std::iter::repeat([0.0; 2])).take(corners.len()));
            }
            if let Some(color) = color {
                self.colors.push(color.map(|column| element.color(column, row[column])));
            }
        }
        Ok(())
    }

    /// Strips of triangles, each with its predecessor's last edge; −1 begins a new strip.
    fn read_strips(
        &mut self,
        element: &Element,
        count: usize,
        vertices: usize,
        values: &mut Values<'_>,
    ) -> Result<(), ConvertError> {
        let Some(list) = element.list(&CORNERS) else {
            return Err(values.wrong("the strips have no corners; expected a list vertex_indices".to_owned()));
        };
        let mut numbers = Vec::new();
        for _ in 0..count {
            for (column, property) in element.properties.iter().enumerate() {
                if column == list {
                    values.read_list(property.kind, &mut numbers)?;
                } else {
                    values.skip(property.kind)?;
                }
            }
            for strip in numbers.split(|&number| number == -1.0) {
                for (index, corners) in strip.windows(3).enumerate() {
                    let turned = if index % 2 == 0 { [0, 1, 2] } else { [1, 0, 2] };
                    for corner in turned {
                        self.corners.push(vertex(corners[corner], vertices, values)?);
                    }
                    self.arities.push(3);
                }
            }
        }
        Ok(())
    }

    /// Cuts the faces into triangles, with what stands at their corners.
    fn cut(self, vertices: &Vertices, mesh: &mut Mesh) -> Result<(), ConvertError> {
        let count = self.corners.len() - 2 * self.arities.len();
        let max = u32::MAX as usize / 3;
        if count > max {
            return Err(ConvertError::TooLarge { kind: "triangles", count, max });
        }
        mesh.triangles.reserve_exact(count);
        let mut triangulation = Triangulation::default();
        let mut polygon = Vec::new();
        let mut first = 0;
        for (face, &arity) in self.arities.iter().enumerate() {
            let corners = &self.corners[first..first + arity as usize];
            polygon.clear();
            polygon.extend(corners.iter().map(|&vertex| vertices.positions[vertex as usize]));
            triangulation.cut(&polygon, |triangle| {
                mesh.triangles.push(triangle.map(|corner| corners[corner]));
                if let Some(&color) = self.colors.get(face) {
                    mesh.corner_colors.push([color; 3]);
                }
                if !self.texture_coordinates.is_empty() {
                    let coordinate = |corner| self.texture_coordinates[first + corner];
                    mesh.corner_texture_coordinates.push(triangle.map(coordinate));
                }
            });
            first += arity as usize;
        }
        if !vertices.normals.is_empty() {
            mesh.corner_normals = at_corners(&mesh.triangles, &vertices.normals);
        }
        if !vertices.colors.is_empty() {
            mesh.corner_colors = at_corners(&mesh.triangles, &vertices.colors);
        } else if mesh.corner_colors.len() != count {
            // Faces have colours, strips have none.
            mesh.corner_colors.clear();
        }
        if mesh.corner_texture_coordinates.len() != count && !vertices.texture_coordinates.is_empty() {
            mesh.corner_texture_coordinates = at_corners(&mesh.triangles, &vertices.texture_coordinates);
        }
        if !mesh.materials.is_empty() {
            mesh.triangle_materials = vec![0; count];
        }
        Ok(())
    }
}

/// What the vertices at the corners of each triangle have.
fn at_corners<T: Copy + Send + Sync>(triangles: &[[u32; 3]], of_vertices: &[T]) -> Vec<[T; 3]> {
    triangles.par_iter().map(|triangle| triangle.map(|vertex| of_vertices[vertex as usize])).collect()
}

/// The index of a vertex.
fn vertex(number: f64, count: usize, values: &Values<'_>) -> Result<u32, ConvertError> {
    if number >= 0.0 && number < count as f64 && number.fract() == 0.0 {
        return Ok(number as u32);
    }
    Err(values.wrong(format!(
        "a face refers to vertex {number}, but {count} precede it, counted from 0; correct the index"
    )))
}

impl Element {
    /// A colour value from 0 to 1: integers are parts of the largest one.
    fn color(&self, column: usize, value: f64) -> f32 {
        let max = match self.properties[column].kind {
            Kind::Scalar(Scalar::Char) => f64::from(i8::MAX),
            Kind::Scalar(Scalar::UChar) => f64::from(u8::MAX),
            Kind::Scalar(Scalar::Short) => f64::from(i16::MAX),
            Kind::Scalar(Scalar::UShort) => f64::from(u16::MAX),
            // Some programs write numbers up to 255 in wider integers.
            Kind::Scalar(Scalar::Int | Scalar::UInt) => 255.0,
            _ => 1.0,
        };
        (value / max) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str = "ply\nformat FORMAT 1.0\ncomment made by hand\nelement vertex 5\nproperty float x\n\
        property double y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n\
        property float s\nproperty float t\nelement nothing 99999999999\nelement face 2\n\
        property list uchar int vertex_indices\nproperty ushort flags\nend_header\n";
    const VERTICES: [([f32; 3], [u8; 3], [f32; 2]); 5] = [
        ([0.0, 0.0, 0.0], [255, 0, 0], [0.0, 0.0]),
        ([1.0, 0.0, 0.0], [0, 255, 0], [1.0, 0.0]),
        ([1.0, 1.0, 0.0], [0, 0, 255], [1.0, 1.0]),
        ([0.0, 1.0, 0.0], [51, 51, 51], [0.0, 1.0]),
        ([0.0, 0.0, 0.0], [1, 2, 3], [0.5, 0.5]),
    ];
    const FACES: [&[i32]; 2] = [&[0, 1, 2, 3], &[4, 2, 3]];

    fn text() -> Vec<u8> {
        let mut text = HEADER.replace("FORMAT", "ascii");
        for ([x, y, z], [r, g, b], [s, t]) in VERTICES {
            text += &format!("{x} {y} {z}  {r} {g} {b}\t{s} {t}\n");
        }
        for face in FACES {
            let corners: Vec<String> = face.iter().map(ToString::to_string).collect();
            text += &format!("{} {} 7\r\n", face.len(), corners.join(" "));
        }
        text.into_bytes()
    }

    fn binary(is_big: bool) -> Vec<u8> {
        let format = if is_big { "binary_big_endian" } else { "binary_little_endian" };
        let mut bytes = HEADER.replace("FORMAT", format).into_bytes();
        let put = |bytes: &mut Vec<u8>, little: &[u8]| {
            let mut value = little.to_vec();
            if is_big {
                value.reverse();
            }
            bytes.extend(value);
        };
        for ([x, y, z], color, [s, t]) in VERTICES {
            put(&mut bytes, &x.to_le_bytes());
            put(&mut bytes, &f64::from(y).to_le_bytes());
            put(&mut bytes, &z.to_le_bytes());
            bytes.extend(color);
            put(&mut bytes, &s.to_le_bytes());
            put(&mut bytes, &t.to_le_bytes());
        }
        for face in FACES {
            bytes.push(face.len() as u8);
            face.iter().for_each(|corner| put(&mut bytes, &corner.to_le_bytes()));
            put(&mut bytes, &7u16.to_le_bytes());
        }
        bytes
    }

    fn read(bytes: &[u8]) -> Result<Mesh, ConvertError> {
        super::read(Path::new("model.ply"), bytes)
    }

    #[test]
    fn text_and_binary_files_of_both_orders_are_the_same_mesh() {
        for bytes in [text(), binary(false), binary(true)] {
            let mesh = read(&bytes).unwrap();
            assert_eq!(mesh.positions.len(), 4);
            assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [0, 2, 3]]);
            assert_eq!(mesh.corner_colors[0], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
            assert_eq!(mesh.corner_colors[1][2], [0.2; 3]);
            // Vertices at one place become one, what stands at corners stays.
            assert_eq!(mesh.corner_texture_coordinates[2], [[0.5, 0.5], [1.0, 1.0], [0.0, 1.0]]);
            assert!(mesh.corner_normals.is_empty() && mesh.warnings.is_empty());
        }
    }

    #[test]
    fn strips_turn_every_other_triangle() {
        let text = "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n\
            property float nx\nproperty float ny\nproperty float nz\nelement tristrips 1\n\
            property list int int vertex_indices\nend_header\n\
            0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n1 1 0 0 0 1\n2 2 0 0 0 1\n8 0 1 2 3 -1 1 4 3";
        let mesh = read(text.as_bytes()).unwrap();
        assert_eq!(mesh.triangles, [[0, 1, 2], [2, 1, 3], [1, 4, 3]]);
        assert_eq!(mesh.corner_normals, [[[0.0, 0.0, 1.0]; 3]; 3]);
    }

    #[test]
    fn errors_name_the_place() {
        let text = |from: &str, to: &str| {
            let text = String::from_utf8(text()).unwrap();
            assert!(text.contains(from));
            text.replacen(from, to, 1).into_bytes()
        };
        for (bytes, expected) in [
            (text("format ascii", "format morse"), "model.ply:2: `format morse 1.0`"),
            (text("element vertex 5", "element vertex -5"), "model.ply:4: "),
            (text("property float x", "property complex x"), "model.ply:5: "),
            (text("property float x", "property float w"), "model.ply:18: the vertices have no coordinates"),
            (text("1 1 0  0 0 255", "1 1 0  0 zero 255"), "model.ply:20: `zero` is no number"),
            (text("1 1 0  0 0 255", "1 nan 0  0 0 255"), "model.ply: vertex 2 (counted from 0) is at"),
            (text("4 0 1 2 3", "4 0 1 5 3"), "model.ply:23: a face refers to vertex 5, but 5 precede it"),
            (text("4 0 1 2 3", "4 0 1 0.5 3"), "model.ply:23: a face refers to vertex 0.5"),
            (text("4 0 1 2 3", "-1 0 1 2 3"), "model.ply:23: a list of -1"),
            (text("4 0 1 2 3 7", "2 0 1 7"), "model.ply:23: a face has 2 corners"),
            (text("element vertex 5", "element vertex 99999"), "model.ply:18: 99999 of `vertex` do not fit"),
            (text("3 4 2 3 7", "3 4 2"), "model.ply:25: the file ends"),
            (b"ply\nformat ascii 1.0\n".to_vec(), "model.ply:3: the header has no `end_header`"),
            (b"ply\nend_header\n".to_vec(), "model.ply:2: "),
            (b"ply\nformat ascii 1.0\nend_header\n".to_vec(), "model.ply: the mesh has no faces"),
        ] {
            let error = crate::read::with_path("model.ply".as_ref(), read(&bytes)).unwrap_err().to_string();
            assert!(error.starts_with(expected), "{expected}: {error}");
        }
        let end = binary(true).len();
        let error = read(&binary(true)[..end - 3]).unwrap_err().to_string();
        assert!(error.contains("the file ends"), "{error}");
    }

    #[test]
    fn every_truncation_and_flipped_byte_is_an_error_or_a_mesh() {
        for bytes in [text(), binary(false)] {
            for length in 0..bytes.len() {
                let _ = read(&bytes[..length]);
                for flip in [0x01, 0x10, 0x80] {
                    let mut bytes = bytes.clone();
                    bytes[length] ^= flip;
                    let _ = read(&bytes);
                }
            }
        }
    }
}
