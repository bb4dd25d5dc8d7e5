//! The OBJ reader against another one, the crate `tobj`.

use octvox_converter::{Mesh, load_mesh};
use proptest::prelude::*;
use std::fmt::Write;
use std::path::Path;

const OPTIONS: tobj::LoadOptions =
    tobj::LoadOptions { single_index: false, triangulate: false, ignore_points: true, ignore_lines: true };

/// What a corner of a face has.
#[derive(Debug, Clone, PartialEq)]
struct Corner {
    position: [f64; 3],
    texture_coordinate: [f32; 2],
    normal: [f32; 3],
}

/// A face with the name of its material.
type Face = (String, Vec<Corner>);

/// What faces name at their corners beside vertices. Where one is missing `tobj` makes it up.
#[derive(Debug, Clone, Copy)]
struct Names {
    texture_coordinates: bool,
    normals: bool,
}

/// The faces as `tobj` reads them, in the order of the file.
fn faces(path: &Path, names: Names) -> Vec<Face> {
    let (models, materials) = tobj::load_obj(path, &OPTIONS).unwrap();
    let materials = materials.unwrap_or_default();
    let mut faces = Vec::new();
    for model in models {
        let mesh = model.mesh;
        let name = mesh.material_id.map_or(String::new(), |id| materials[id].name.clone());
        let arities = if mesh.face_arities.is_empty() {
            vec![3; mesh.indices.len() / 3]
        } else {
            mesh.face_arities.clone()
        };
        let mut first = 0;
        for arity in arities {
            let corner = |k: usize| {
                let position = |axis| mesh.positions[mesh.indices[k] as usize * 3 + axis];
                let texture_coordinate = mesh.texcoord_indices.get(k).filter(|_| names.texture_coordinates);
                let texture_coordinate = texture_coordinate.map_or([0.0; 2], |&index| {
                    [0, 1].map(|axis| mesh.texcoords[index as usize * 2 + axis] as f32)
                });
                let normal = mesh.normal_indices.get(k).filter(|_| names.normals);
                let normal = normal.map_or([0.0; 3], |&index| {
                    [0, 1, 2].map(|axis| mesh.normals[index as usize * 3 + axis] as f32)
                });
                Corner { position: [0, 1, 2].map(position), texture_coordinate, normal }
            };
            faces.push((name.clone(), (first..first + arity as usize).map(corner).collect()));
            first += arity as usize;
        }
    }
    faces
}

/// Fails if the mesh is not made of these faces.
fn check(mesh: &Mesh, faces: &[Face]) {
    let triangle = |index: usize| -> Face {
        let corner = |k: usize| Corner {
            position: mesh.positions()[mesh.triangles()[index][k] as usize],
            texture_coordinate: mesh.corner_texture_coordinates().get(index).map_or([0.0; 2], |uv| uv[k]),
            normal: mesh.corner_normals().get(index).map_or([0.0; 3], |normals| normals[k]),
        };
        let material = &mesh.materials()[mesh.triangle_materials()[index] as usize];
        (material.name.clone(), (0..3).map(corner).collect())
    };
    let mut next = 0;
    for face in faces {
        let count = face.1.len() - 2;
        if count == 1 {
            assert_eq!(triangle(next), *face);
        } else {
            // However it is cut, its triangles have its corners, and every corner is in one.
            let triangles: Vec<Face> = (next..next + count).map(triangle).collect();
            for corner in &face.1 {
                assert!(triangles.iter().any(|(_, corners)| corners.contains(corner)), "{corner:?}");
            }
            for (name, corners) in &triangles {
                assert!(*name == face.0 && corners.iter().all(|corner| face.1.contains(corner)));
            }
        }
        next += count;
    }
    assert_eq!(next, mesh.triangles().len());
}

#[test]
fn the_samples_are_read_alike() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../samples/models");
    for name in ["globe", "knots", "lighthouse", "shell"] {
        let path = folder.join(name).with_extension("obj");
        // Some faces of the globe have texture coordinates, none of the others.
        let mesh = load_mesh(&path).unwrap().with_corner_texture_coordinates(Vec::new()).unwrap();
        check(&mesh, &faces(&path, Names { texture_coordinates: false, normals: true }));
    }
}

/// A coordinate as some program may write it.
fn number() -> impl Strategy<Value = String> {
    prop_oneof![
        "-?[0-9]{1,3}(\\.[0-9]{1,17})?",
        (-1e3..1e3f64).prop_map(|number| format!("{number:e}")),
        Just("0".to_owned()),
    ]
}

/// Faces that refer to twelve of everything, counted from the start or back from the end, in groups of materials.
fn face(names: Names) -> impl Strategy<Value = String> {
    let index = prop_oneof![1..=12, -12..=-1];
    let corners = prop::collection::vec((index.clone(), index.clone(), index), 3..7);
    (corners, 0..6).prop_map(move |(corners, group)| {
        let mut text = match group {
            0 => "usemtl a\n".to_owned(),
            1 => "g some group\nusemtl b\n".to_owned(),
            2 => "o thing\ng\n".to_owned(),
            _ => String::new(),
        };
        text += "f";
        for (vertex, texture_coordinate, normal) in corners {
            let _ = match (names.texture_coordinates, names.normals) {
                (false, false) => write!(text, " {vertex}"),
                (true, false) => write!(text, " {vertex}/{texture_coordinate}"),
                (false, true) => write!(text, " {vertex}//{normal}"),
                (true, true) => write!(text, " {vertex}/{texture_coordinate}/{normal}"),
            };
        }
        text + "\n"
    })
}

fn file() -> impl Strategy<Value = (Names, Vec<String>, Vec<String>)> {
    (any::<bool>(), any::<bool>()).prop_flat_map(|(texture_coordinates, normals)| {
        let names = Names { texture_coordinates, normals };
        let numbers = prop::collection::vec(number(), 12 * 8);
        (Just(names), numbers, prop::collection::vec(face(names), 1..30))
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn generated_files_are_read_alike((names, numbers, faces) in file()) {
        let mut text = "mtllib model.mtl\n".to_owned();
        for numbers in numbers.chunks(8) {
            text += &format!("v {} {} {}\n", numbers[0], numbers[1], numbers[2]);
            text += &format!("vt {} {}\n", numbers[3], numbers[4]);
            text += &format!("vn {} {} {}\n", numbers[5], numbers[6], numbers[7]);
        }
        text += &faces.concat();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("model.obj");
        std::fs::write(folder.path().join("model.mtl"), "newmtl a\nKd 1 0 0\nnewmtl b\nKd 0 1 0\n").unwrap();
        std::fs::write(&path, text).unwrap();
        check(&load_mesh(&path).unwrap(), &self::faces(&path, names));
    }
}
