//! Wavefront OBJ.
//!
//! The text is cut into chunks of whole statements. One pass counts what each holds, so that a second one can resolve
//! indices, which count from the start of the file or back from the face, in all chunks at the same time.

mod chunk;
mod group_materials;
mod statements;

use super::mtl::load_materials;
use super::textures::Textures;
use super::triangulation::Triangulation;
use super::weld::weld;
use crate::mesh::NO_NORMAL;
use crate::{ConvertError, Image, Material, Mesh};
use chunk::{Chunk, Counts, NONE};
use group_materials::GroupMaterials;
use rayon::prelude::*;
use statements::chunks;
use std::collections::{BTreeSet, HashMap, HashSet};
use std::path::Path;

/// Bytes of text that are read as one piece of work.
const CHUNK_BYTES: usize = 1 << 18;

/// Reads the text of an OBJ file; `path` is where it is from.
pub(super) fn read(path: &Path, text: &[u8]) -> Result<Mesh, ConvertError> {
    read_in_chunks(path, text, CHUNK_BYTES)
}

fn read_in_chunks(path: &Path, text: &[u8], chunk_bytes: usize) -> Result<Mesh, ConvertError> {
    let mut chunks = parse(path, text, chunk_bytes)?;
    let mut warnings = Vec::new();
    let materials = Materials::load(path, &chunks, &mut warnings);
    warn(path, &chunks, &mut warnings);
    check_places(path, &chunks)?;

    let vertices = Vertices::join(&mut chunks)?;
    let mut mesh = join_faces(&chunks, &vertices, materials)?;
    mesh.positions = vertices.positions;
    mesh.warnings = warnings;
    mesh.check().map(|()| mesh)
}

/// Reads all chunks; fails with the first error in the file.
fn parse(path: &Path, text: &[u8], chunk_bytes: usize) -> Result<Vec<Chunk>, ConvertError> {
    let texts = chunks(text, chunk_bytes);
    let counts: Vec<Counts> = texts.par_iter().map(|text| Counts::of(text)).collect();
    let mut total = Counts::default();
    let mut before = Vec::with_capacity(counts.len());
    for count in &counts {
        before.push(total);
        total = total.plus(*count);
    }
    let max = u32::MAX as usize / 3;
    for (kind, count) in [
        ("vertices", total.vertices),
        ("texture coordinates", total.texture_coordinates),
        ("normals", total.normals),
    ] {
        if count > max {
            return Err(ConvertError::TooLarge { kind, count, max });
        }
    }
    let groups = GroupMaterials::find(text);
    let read = |index: usize| Chunk::read(path, texts[index], before[index], counts[index], &groups);
    let chunks: Vec<Result<Chunk, ConvertError>> = (0..texts.len()).into_par_iter().map(read).collect();
    chunks.into_iter().collect()
}

/// Notes what is left out.
fn warn(path: &Path, chunks: &[Chunk], warnings: &mut Vec<String>) {
    let left_out: usize = chunks.iter().map(|chunk| chunk.lines_and_points).sum();
    if left_out > 0 {
        warnings.push(format!("{left_out} lines or points have no surface and are left out"));
    }
    let mut odd = chunks.iter().filter_map(|chunk| chunk.odd_texture_coordinates);
    if let Some((count, line)) = odd.next() {
        let count = count + odd.map(|(count, _)| count).sum::<usize>();
        warnings.push(format!(
            "{}:{}: {count} texture coordinates are no numbers and are taken as 0, this is the first",
            path.display(),
            line + 1
        ));
    }
}

/// Fails if a face uses a vertex that is no place.
fn check_places(path: &Path, chunks: &[Chunk]) -> Result<(), ConvertError> {
    let misplaced = chunks.iter().flat_map(|chunk| &chunk.misplaced);
    let misplaced: HashMap<u32, (usize, &String)> =
        misplaced.map(|(vertex, line, problem)| (*vertex, (*line, problem))).collect();
    if misplaced.is_empty() {
        return Ok(());
    }
    let mut used = chunks.iter().flat_map(|chunk| &chunk.corners);
    match used.find_map(|corner| misplaced.get(&corner[0])) {
        Some(&(line, problem)) => {
            Err(ConvertError::Statement { path: path.to_owned(), line: line + 1, problem: problem.clone() })
        }
        None => Ok(()),
    }
}

/// The lists of all chunks.
struct Vertices {
    /// Different positions, and the place among them of every vertex in the file.
    positions: Vec<[f64; 3]>,
    places: Vec<u32>,
    /// Empty if no vertex has one.
    colors: Vec<[f32; 3]>,
    texture_coordinates: Vec<[f32; 2]>,
    normals: Vec<[f32; 3]>,
}

impl Vertices {
    /// Takes them out of the chunks.
    fn join(chunks: &mut [Chunk]) -> Result<Self, ConvertError> {
        if chunks.iter().any(|chunk| !chunk.colors.is_empty()) {
            chunks.iter_mut().for_each(|chunk| chunk.colors.resize(chunk.positions.len(), [1.0; 3]));
        }
        let colors = take(chunks, |chunk| &mut chunk.colors);
        let texture_coordinates = take(chunks, |chunk| &mut chunk.texture_coordinates);
        let normals = take(chunks, |chunk| &mut chunk.normals);
        let mut positions = take(chunks, |chunk| &mut chunk.positions);
        let places = weld(&mut positions)?;
        Ok(Self { positions, places, colors, texture_coordinates, normals })
    }
}

/// One of the lists of all chunks, joined.
fn take<T>(chunks: &mut [Chunk], list: impl Fn(&mut Chunk) -> &mut Vec<T>) -> Vec<T> {
    let mut joined = Vec::with_capacity(chunks.iter_mut().map(|chunk| list(chunk).len()).sum());
    chunks.iter_mut().for_each(|chunk| joined.extend(std::mem::take(list(chunk))));
    joined
}

/// Materials of the libraries that the file names.
struct Materials {
    materials: Vec<Material>,
    images: Vec<Image>,
    by_name: HashMap<String, usize>,
}

impl Materials {
    fn load(path: &Path, chunks: &[Chunk], warnings: &mut Vec<String>) -> Self {
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut materials = Vec::new();
        let mut textures = Textures::default();
        let used: BTreeSet<&str> =
            chunks.iter().flat_map(|chunk| &chunk.materials).map(|(_, name)| name.as_str()).collect();
        let mut seen = HashSet::new();
        for library in chunks.iter().flat_map(|chunk| &chunk.libraries).filter(|name| seen.insert(*name)) {
            materials.extend(load_materials(folder, library, &used, &mut textures, warnings));
        }
        let by_name: HashMap<String, usize> =
            materials.iter().enumerate().map(|(index, material)| (material.name.clone(), index)).collect();
        let undefined = used.into_iter().filter(|name| !by_name.contains_key(*name));
        warnings
            .extend(undefined.map(|name| format!("material {name} is not defined: its triangles are grey")));
        Self { materials, images: textures.images, by_name }
    }
}

/// A chunk's share of the lists of the mesh. Those that the mesh does not have are empty.
struct Share<'a> {
    triangles: &'a mut [[u32; 3]],
    materials: &'a mut [u32],
    normals: &'a mut [[[f32; 3]; 3]],
    colors: &'a mut [[[f32; 3]; 3]],
    texture_coordinates: &'a mut [[[f32; 2]; 3]],
}

/// Triangles with materials and what stands at their corners, in the order of the file; without positions.
fn join_faces(chunks: &[Chunk], vertices: &Vertices, materials: Materials) -> Result<Mesh, ConvertError> {
    let lengths: Vec<usize> =
        chunks.iter().map(|chunk| chunk.corners.len() - 2 * chunk.arities.len()).collect();
    let count = lengths.iter().sum();
    let max = u32::MAX as usize / 3;
    if count > max {
        return Err(ConvertError::TooLarge { kind: "triangles", count, max });
    }
    if count == 0 {
        return Err(ConvertError::NoFaces);
    }
    let has_colors = !vertices.colors.is_empty();
    let length_if = |present: bool| if present { count } else { 0 };
    let mut mesh = Mesh {
        triangles: vec![[0; 3]; count],
        triangle_materials: vec![0; count],
        corner_normals: vec![[NO_NORMAL; 3]; length_if(chunks.iter().any(|chunk| chunk.has_normals))],
        corner_colors: vec![[[1.0; 3]; 3]; length_if(has_colors)],
        corner_texture_coordinates: vec![
            [[0.0; 2]; 3];
            length_if(chunks.iter().any(|chunk| chunk.has_texture_coordinates))
        ],
        materials: materials.materials,
        images: materials.images,
        ..Mesh::default()
    };

    // What faces have whose material is not known. Vertex colours alone show as they are.
    let unknown = mesh.materials.len() as u32;
    mesh.materials.push(Material::matte("", if has_colors { [1.0; 3] } else { Material::DEFAULT_DIFFUSE }));
    let known = |name: &String| materials.by_name.get(name).map_or(unknown, |&index| index as u32);
    let mut current = unknown;
    let first_materials: Vec<u32> = chunks
        .iter()
        .map(|chunk| {
            let first = current;
            current = chunk.materials.last().map_or(current, |(_, name)| known(name));
            first
        })
        .collect();

    let mut triangles = &mut mesh.triangles[..];
    let mut triangle_materials = &mut mesh.triangle_materials[..];
    let mut normals = &mut mesh.corner_normals[..];
    let mut colors = &mut mesh.corner_colors[..];
    let mut texture_coordinates = &mut mesh.corner_texture_coordinates[..];
    let shares: Vec<Share<'_>> = lengths
        .iter()
        .map(|&length| Share {
            triangles: split_off(&mut triangles, length),
            materials: split_off(&mut triangle_materials, length),
            normals: split_off(&mut normals, length),
            colors: split_off(&mut colors, length),
            texture_coordinates: split_off(&mut texture_coordinates, length),
        })
        .collect();
    chunks
        .par_iter()
        .zip(first_materials)
        .zip(shares)
        .for_each(|((chunk, material), mut share)| fill(chunk, vertices, material, known, &mut share));
    if !mesh.triangle_materials.contains(&unknown) {
        mesh.materials.pop();
    }
    Ok(mesh)
}

/// Takes the first `length` elements, or none if there are none at all.
fn split_off<'a, T>(slice: &mut &'a mut [T], length: usize) -> &'a mut [T] {
    let (first, rest) = std::mem::take(slice).split_at_mut_checked(length).unwrap_or_default();
    *slice = rest;
    first
}

/// Cuts the faces of a chunk into triangles. `material` is the one of its first face, if it does not say itself.
fn fill(
    chunk: &Chunk,
    vertices: &Vertices,
    mut material: u32,
    known: impl Fn(&String) -> u32,
    share: &mut Share<'_>,
) {
    let place = |corner: [u32; 3]| vertices.places[corner[0] as usize];
    let mut triangulation = Triangulation::default();
    let mut polygon = Vec::new();
    let mut changes = chunk.materials.iter().peekable();
    let mut rest = &chunk.corners[..];
    let mut next = 0;
    for (face, &arity) in chunk.arities.iter().enumerate() {
        while let Some((_, name)) = changes.next_if(|(first, _)| *first == face) {
            material = known(name);
        }
        let corners;
        (corners, rest) = rest.split_at(arity as usize);
        let has_normals = !share.normals.is_empty() && corners.iter().all(|corner| corner[2] != NONE);
        let has_texture_coordinates =
            !share.texture_coordinates.is_empty() && corners.iter().all(|corner| corner[1] != NONE);
        polygon.clear();
        polygon.extend(corners.iter().map(|&corner| vertices.positions[place(corner) as usize]));
        triangulation.cut(&polygon, |triangle| {
            let corners = triangle.map(|corner| corners[corner]);
            share.triangles[next] = corners.map(place);
            share.materials[next] = material;
            if has_normals {
                share.normals[next] = corners.map(|corner| vertices.normals[corner[2] as usize]);
            }
            if let Some(colors) = share.colors.get_mut(next) {
                *colors = corners.map(|corner| vertices.colors[corner[0] as usize]);
            }
            if has_texture_coordinates {
                share.texture_coordinates[next] =
                    corners.map(|corner| vertices.texture_coordinates[corner[1] as usize]);
            }
            next += 1;
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cut_into_chunks_does_not_matter() {
        let text = b"v 0 0 0\nv 1 0 0\nv 1 1 0 0.5 0.5 0.5\nvt 0 0\nvn 0 0 1\nf 1 2 3\nusemtl a\nf 1/1/1 2/1/1 3/-1/-1\n\
            usemtl b\nv 0 \\\n 1 0\nusemtl c\nf -4 -3 \\\n-2 -1\nl 1 2\nvt x\nf 1//1 2//1 \\\r\n4//1\nv nan 0 0\nusemtl a\nf 2 3 4";
        let path = Path::new("model.obj");
        let expected = format!("{:?}", read(path, text).unwrap());
        for size in 1..text.len() {
            assert_eq!(format!("{:?}", read_in_chunks(path, text, size).unwrap()), expected, "{size}");
        }
    }

    #[test]
    fn the_first_error_counts_whatever_the_chunks_are() {
        let text = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 \\\n3\nf 1 2 4\nv x\nf 9 9 9\n";
        for size in 1..text.len() {
            let error = read_in_chunks(Path::new("model.obj"), text, size).unwrap_err().to_string();
            assert!(
                error.starts_with("model.obj:6: the face refers to vertex 4, but 3 precede it"),
                "{error}"
            );
        }
    }
}
