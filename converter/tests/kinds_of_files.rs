//! The same model in files of all kinds has the same voxels.

mod support;

use octvox_converter::{Mesh, Options, read_mesh};
use std::fmt::Write;
use support::{icosphere, voxels};

/// Coordinates as single precision holds them, which the binary kinds have.
fn positions(mesh: &Mesh) -> String {
    let line = |position: &[f64; 3]| {
        position.map(|coordinate| f64::from(coordinate as f32).to_string()).join(" ") + "\n"
    };
    mesh.positions().iter().map(line).collect()
}

fn obj(mesh: &Mesh) -> Vec<u8> {
    let mut text = String::new();
    positions(mesh).lines().for_each(|line| writeln!(text, "v {line}").unwrap());
    mesh.triangles().iter().for_each(|[a, b, c]| writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1).unwrap());
    text.into_bytes()
}

fn ply(mesh: &Mesh) -> Vec<u8> {
    let (vertices, faces) = (mesh.positions().len(), mesh.triangles().len());
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {faces}\nproperty list uchar int vertex_indices\nend_header\n"
    );
    text += &positions(mesh);
    mesh.triangles().iter().for_each(|[a, b, c]| writeln!(text, "3 {a} {b} {c}").unwrap());
    text.into_bytes()
}

fn stl(mesh: &Mesh) -> Vec<u8> {
    let mut bytes = vec![0; 80];
    bytes.extend((mesh.triangles().len() as u32).to_le_bytes());
    for triangle in mesh.triangles() {
        bytes.extend([0; 12]);
        for corner in triangle {
            let position = mesh.positions()[*corner as usize];
            position.iter().for_each(|coordinate| bytes.extend((*coordinate as f32).to_le_bytes()));
        }
        bytes.extend([0; 2]);
    }
    bytes
}

fn glb(mesh: &Mesh) -> Vec<u8> {
    let (vertices, indices) = (mesh.positions().len(), 3 * mesh.triangles().len());
    let mut data: Vec<u8> =
        mesh.positions().as_flattened().iter().flat_map(|number| (*number as f32).to_le_bytes()).collect();
    let split = data.len();
    data.extend(mesh.triangles().as_flattened().iter().flat_map(|index| index.to_le_bytes()));
    let mut json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
        "accessors":[
            {{"bufferView":0,"componentType":5126,"count":{vertices},"type":"VEC3","min":[-9,-9,-9],"max":[9,9,9]}},
            {{"bufferView":1,"componentType":5125,"count":{indices},"type":"SCALAR"}}],
        "bufferViews":[
            {{"buffer":0,"byteLength":{split}}},
            {{"buffer":0,"byteOffset":{split},"byteLength":{}}}],
        "buffers":[{{"byteLength":{}}}]}}"#,
        4 * indices,
        data.len()
    );
    while json.len() % 4 != 0 {
        json.push(' ');
    }
    let mut bytes = b"glTF".to_vec();
    for number in [2, 28 + json.len() + data.len(), json.len()] {
        bytes.extend((number as u32).to_le_bytes());
    }
    bytes.extend(b"JSON");
    bytes.extend(json.as_bytes());
    bytes.extend((data.len() as u32).to_le_bytes());
    bytes.extend(b"BIN\0");
    bytes.extend(data);
    bytes
}

#[test]
fn all_kinds_have_the_same_voxels() {
    let mesh = icosphere([0.5, -0.25, 0.0], 2.0, 2);
    let options = Options { depth: 5, ..Options::default() };
    let shape = |name: &str, bytes: Vec<u8>| {
        let mesh = read_mesh(name.as_ref(), &bytes).unwrap();
        assert!(mesh.warnings().is_empty(), "{name}: {:?}", mesh.warnings());
        // The colour of what has no material is white in glTF and grey elsewhere.
        let cells = voxels(&mesh, &options).into_iter();
        cells.map(|(cell, (_, normal))| (cell, normal)).collect::<Vec<_>>()
    };
    let expected = shape("sphere.obj", obj(&mesh));
    assert!(expected.len() > 1000);
    assert!(shape("sphere.ply", ply(&mesh)) == expected, "PLY");
    assert!(shape("sphere.stl", stl(&mesh)) == expected, "STL");
    assert!(shape("sphere.glb", glb(&mesh)) == expected, "GLB");
}
