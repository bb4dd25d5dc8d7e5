use super::*;
use crate::{Channel, Wrap};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use std::io::Cursor;

/// Corners of a square of two triangles, with normals along z, texture coordinates and colours (linear).
const POSITIONS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
const TEXTURE_COORDINATES: [[f32; 2]; 4] = [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];
const INDICES: [u16; 6] = [0, 1, 2, 0, 2, 3];

fn floats<const N: usize>(items: &[[f32; N]]) -> Vec<u8> {
    items.as_flattened().iter().flat_map(|number| number.to_le_bytes()).collect()
}

/// All numbers, one kind after the other: positions at 0, normals at 48, texture coordinates at 96, colours (of 16 bits) at
/// 128, indices at 160.
fn buffer() -> Vec<u8> {
    let colors: Vec<u8> = [65_535u16, 0, 0, 65_535].repeat(4).iter().flat_map(|n| n.to_le_bytes()).collect();
    let indices = INDICES.iter().flat_map(|index| index.to_le_bytes()).collect();
    [floats(&POSITIONS), floats(&[[0.0, 0.0, 1.0]; 4]), floats(&TEXTURE_COORDINATES), colors, indices]
        .concat()
}

fn data_uri(bytes: &[u8]) -> String {
    format!("data:application/octet-stream;base64,{}", BASE64_STANDARD.encode(bytes))
}

/// A document whose parts can be replaced; `buffer` is the text of its buffer's URI member, with a comma.
fn text(buffer: &str) -> String {
    r#"{
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{
            "attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2, "COLOR_0": 3}, "indices": 4, "material": 0
        }]}],
        "materials": [{"name": "paint"}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 0, "byteOffset": 48, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
            {"bufferView": 2, "componentType": 5123, "normalized": true, "count": 4, "type": "VEC4"},
            {"bufferView": 3, "componentType": 5123, "count": 6, "type": "SCALAR"}
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 96},
            {"buffer": 0, "byteOffset": 96, "byteLength": 32, "byteStride": 8},
            {"buffer": 0, "byteOffset": 128, "byteLength": 32, "byteStride": 8},
            {"buffer": 0, "byteOffset": 160, "byteLength": 12}
        ],
        "buffers": [{BUFFER "byteLength": 172}]
    }"#
    .replace("BUFFER", buffer)
}

fn embedded() -> String {
    text(&format!(r#""uri": "{}","#, data_uri(&buffer())))
}

/// The same as a binary file.
fn glb() -> Vec<u8> {
    let mut json = text("").into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let buffer = buffer();
    let mut bytes = b"glTF".to_vec();
    for number in [2, (12 + 8 + json.len() + 8 + buffer.len()) as u32, json.len() as u32] {
        bytes.extend(number.to_le_bytes());
    }
    bytes.extend(b"JSON");
    bytes.extend(json);
    bytes.extend((buffer.len() as u32).to_le_bytes());
    bytes.extend(b"BIN\0");
    bytes.extend(buffer);
    bytes
}

fn read(bytes: &[u8]) -> Result<Mesh, ConvertError> {
    super::read("model.gltf".as_ref(), bytes)
}

fn with(from: &str, to: &str) -> Mesh {
    let text = embedded();
    assert!(text.contains(from), "{from}");
    read(text.replace(from, to).as_bytes()).unwrap()
}

#[test]
fn all_containers_are_the_same_mesh() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("my data.bin"), buffer()).unwrap();
    let external = text(r#""uri": "my%20data.bin","#);
    let external = super::read(&folder.path().join("model.gltf"), external.as_bytes()).unwrap();
    let embedded = read(embedded().as_bytes()).unwrap();
    assert_eq!(format!("{embedded:?}"), format!("{external:?}"));
    assert_eq!(format!("{embedded:?}"), format!("{:?}", read(&glb()).unwrap()));

    assert_eq!(embedded.positions, POSITIONS.map(|position| position.map(f64::from)));
    assert_eq!(embedded.triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(embedded.corner_normals, [[[0.0, 0.0, 1.0]; 3]; 2]);
    assert_eq!(embedded.corner_colors, [[[1.0, 0.0, 0.0]; 3]; 2]);
    // Up in the mesh: the corner at (0, 0) shows the bottom left of the image.
    assert_eq!(embedded.corner_texture_coordinates[1], [[0.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    assert_eq!(embedded.materials[0].name, "paint");
    assert!(embedded.warnings.is_empty(), "{:?}", embedded.warnings);
}

#[test]
fn nodes_move_and_mirror_what_they_hold() {
    // Turned by 90 degrees about x, twice as large along the new y, and moved by a parent.
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let nodes = format!(
        r#""nodes": [{{"children": [1], "translation": [10, 0, 0], "scale": [1, 2, 1]}},
            {{"mesh": 0, "rotation": [{half}, 0, 0, {half}]}}]"#
    );
    let mesh = with(r#""nodes": [{"mesh": 0}]"#, &nodes);
    let corner = mesh.positions[2];
    assert!((corner[0] - 11.0).abs() < 1e-6 && corner[1].abs() < 1e-6 && (corner[2] - 1.0).abs() < 1e-6);
    let normal = mesh.corner_normals[0][0];
    assert!((normal[1] + 1.0).abs() < 1e-6, "{normal:?}");

    let mirrored = with(r#""nodes": [{"mesh": 0}]"#, r#""nodes": [{"mesh": 0, "scale": [-1, 1, 0.5]}]"#);
    assert_eq!(mirrored.positions[1], [-1.0, 0.0, 0.0]);
    assert_eq!(mirrored.triangles, [[0, 2, 1], [0, 3, 2]]);
    // Still counterclockwise seen from the side of its normal.
    assert_eq!(mirrored.corner_normals[0], [[0.0, 0.0, 1.0]; 3]);
    let matrix = with(
        r#""nodes": [{"mesh": 0}]"#,
        r#""nodes": [{"mesh": 0, "matrix": [-1,0,0,0, 0,1,0,0, 0,0,0.5,0, 0,0,0,1]}]"#,
    );
    assert_eq!(format!("{matrix:?}"), format!("{mirrored:?}"));
}

#[test]
fn strips_and_fans_keep_their_orientation() {
    // The strip 0 1 2 0 2 3 has four triangles, the odd ones turned.
    let primitive = r#""indices": 4, "material": 0"#;
    let strip = with(primitive, r#""indices": 4, "mode": 5"#);
    assert_eq!(strip.triangles, [[0, 1, 2], [1, 0, 2], [2, 0, 2], [0, 3, 2]]);
    let fan = with(primitive, r#""mode": 6"#);
    assert_eq!(fan.triangles, [[1, 2, 0], [2, 3, 0]]);
    let points = with(
        r#""meshes": [{"primitives": ["#,
        r#""meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": 0}, "#,
    );
    assert_eq!(points.triangles.len(), 2);
    assert!(points.warnings[0].contains("points and lines have no surface"), "{:?}", points.warnings);
}

#[test]
fn sparse_values_replace_those_of_the_view() {
    // Index 3 (the second half of the view of indices, 2 and 3 as bytes 5..) and a position of normals.
    let mesh = with(
        r#"{"bufferView": 0, "componentType": 5126,"#,
        r#"{"bufferView": 0, "sparse": {"count": 1, "indices": {"bufferView": 3, "byteOffset": 10, "componentType": 5123},
            "values": {"bufferView": 0, "byteOffset": 48}}, "componentType": 5126,"#,
    );
    // The last index is 3; the first normal is (0, 0, 1).
    assert_eq!(mesh.positions[3], [0.0, 0.0, 1.0]);
}

#[test]
fn materials_are_mapped() {
    let mut png = Cursor::new(Vec::new());
    image::DynamicImage::ImageRgba8(image::ImageBuffer::from_pixel(2, 1, image::Rgba([255, 128, 0, 102])))
        .write_to(&mut png, image::ImageFormat::Png)
        .unwrap();
    let material = format!(
        r#""extensionsUsed": ["KHR_texture_transform", "KHR_materials_transmission", "KHR_materials_ior", "KHR_materials_volume"],
        "images": [{{"uri": "{}"}}, {{"uri": "lost.png"}}], "samplers": [{{"wrapS": 33071, "wrapT": 33648}}],
        "textures": [{{"source": 0, "sampler": 0}}, {{"source": 1}}],
        "materials": [{{
            "pbrMetallicRoughness": {{
                "baseColorFactor": [0.2158605, 1, 0, 0.5], "metallicFactor": 0, "roughnessFactor": 0.5,
                "baseColorTexture": {{"index": 0, "extensions": {{"KHR_texture_transform": {{"offset": [0.25, 0.5], "scale": [2, 4]}}}}}}
            }},
            "emissiveFactor": [0, 0.5, 0], "normalTexture": {{"index": 1}}, "alphaMode": "BLEND",
            "extensions": {{
                "KHR_materials_transmission": {{"transmissionFactor": 0.75}}, "KHR_materials_ior": {{"ior": 1.25}},
                "KHR_materials_volume": {{"attenuationDistance": 2, "attenuationColor": [1, 0.36787944, 1]}}
            }}
        }}]"#,
        data_uri(&png.into_inner())
    );
    let mesh = with(r#""materials": [{"name": "paint"}]"#, &material);
    let material = &mesh.materials[0];
    // Light of 0.216 is displayed as 128 of 255 (the sRGB standard's transfer function).
    assert_eq!(material.diffuse, [128.0 / 255.0, 1.0, 0.0]);
    let map = material.diffuse_map.unwrap();
    assert_eq!(map.wrap, [Wrap::Clamp, Wrap::Mirror]);
    assert_eq!((map.offset, map.scale), ([0.25, 1.0 - 0.5 - 4.0], [2.0, 4.0]));
    assert_eq!(mesh.images[map.image].pixels(), [[255, 128, 0, 102]; 2]);
    // Alpha 0.5 of the factor, 0.4 of the texture, and a quarter of what is not transmitted.
    assert!((material.opacity - 0.5 * 0.4 * 0.25).abs() < 1e-9, "{}", material.opacity);
    assert_eq!(material.opacity_map.unwrap().channel, Channel::Alpha);
    assert_eq!(material.refraction_index, 1.25);
    assert!((material.absorption[1] - 0.5).abs() < 1e-6 && material.absorption[0] == 0.0);
    assert_eq!(material.emission, [0.0, 0.5, 0.0]);
    assert_eq!(material.shininess, 30.0);
    assert!(mesh.warnings.len() == 1 && mesh.warnings[0].contains("lost.png"), "{:?}", mesh.warnings);
    assert_eq!(material.normal_map, None);

    let plain = with(r#""material": 0"#, r#""mode": 4"#);
    assert_eq!(plain.materials[0].diffuse, [1.0; 3]);
}

#[test]
fn what_is_wrong_is_an_error_with_its_place() {
    let error = |from: &str, to: &str| {
        let text = embedded();
        assert!(text.contains(from), "{from}");
        read(text.replace(from, to).as_bytes()).unwrap_err().to_string()
    };
    let node = r#""nodes": [{"mesh": 0}]"#;
    for (from, to, expected) in [
        (
            r#""count": 6"#,
            r#""count": 7"#,
            "mesh 0, primitive 0: accessor 4 of 7 values reaches beyond buffer view 3",
        ),
        (
            r#""byteOffset": 48,"#,
            r#""byteOffset": 52,"#,
            "accessor 1 of 4 values reaches beyond buffer view 0",
        ),
        (r#""byteOffset": 160"#, r#""byteOffset": 164"#, "buffer view 3 of 12 bytes from 164 on"),
        (
            r#""count": 4, "type": "VEC3", "min""#,
            r#""count": 3, "type": "VEC3", "min""#,
            "index 3 is out of range",
        ),
        (
            r#""count": 4, "type": "VEC2""#,
            r#""count": 3, "type": "VEC2""#,
            "accessor 2 has 3 values for 4 vertices",
        ),
        (
            r#""componentType": 5126, "count": 4, "type": "VEC2""#,
            r#""componentType": 5126, "count": 4, "type": "SCALAR""#,
            "accessor 2 has 1 components; expected 2",
        ),
        (r#""byteLength": 172"#, r#""byteLength": 180"#, "buffer 0 has 172 bytes, but 180 are announced"),
        (node, r#""nodes": [{"mesh": 0, "children": [1]}, {"children": [0]}]"#, "node 0 has two parents"),
        (node, r#""nodes": [{"name": "empty"}]"#, "the mesh has no faces"),
        ("base64,", "base64,?", "buffer 0: the data URI is damaged"),
        ("data:application", "nowhere:application", "buffer 0: "),
        (r#""version": "2.0""#, r#""version": 2"#, "no valid glTF 2.0 file"),
        (
            r#""POSITION": 0"#,
            r#""POSITION": 5"#,
            "mesh 0, primitive 0: POSITION is accessor 5, but the file has 5",
        ),
    ] {
        let error = error(from, to);
        assert!(error.contains(expected), "{expected}: {error}");
    }
    let huge = error(
        r#"{"bufferView": 0, "componentType": 5126, "count": 4,"#,
        r#"{"componentType": 5126, "count": 99999999999,"#,
    );
    assert!(huge.contains("accessors[0].bufferView: Missing data"), "{huge}");
}

#[test]
fn a_length_below_that_of_the_header_is_an_error() {
    for length in [0u32, 11] {
        let mut bytes = glb();
        bytes[8..12].copy_from_slice(&length.to_le_bytes());
        let error = read(&bytes).unwrap_err().to_string();
        assert!(error.contains(&format!("announces {length} bytes")), "{error}");
    }
}

#[test]
fn every_truncation_and_flipped_byte_is_an_error_or_a_mesh() {
    let glb = glb();
    for length in (0..glb.len()).step_by(7) {
        let _ = read(&glb[..length]);
    }
    for index in (0..glb.len()).step_by(3) {
        for flip in [0x01, 0x10] {
            let mut bytes = glb.clone();
            bytes[index] ^= flip;
            let _ = read(&bytes);
        }
    }
}
