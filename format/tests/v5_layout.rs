//! The bytes of a file of version 5 stand where its description says.

mod common;

use common::checksums::crc32;
use common::plain_v5::parse;
use octvox_format::v5::{Archive, Compression, Header, Levels, Planes, Subtree, Writer};
use octvox_format::{Material, MaterialPalette, NormalCode, WorldTransform};

const WORLD: WorldTransform = WorldTransform { origin: [1.0, -2.0, 0.5], voxel_size: 0.25 };

fn glass() -> Material {
    Material {
        diffuse: [1, 2, 3],
        reflectivity: 4,
        specular: [5, 6, 7],
        transparency: 8,
        shininess: 9.5,
        refraction_index: 1.5,
        absorption: [0.25, 0.5, 0.75],
        emission: [1.0, 2.0, 4.0],
    }
}

/// Two subtrees of an octree of 4³ cells: a single voxel of 2³ cells next to the origin, and four cells in the eighth
/// farthest from it.
fn file() -> Vec<u8> {
    let header = Header {
        cut_level: 1,
        normal_code: NormalCode::Spherical,
        compression: Compression::None,
        world: Some(WORLD),
        writer: "test".to_owned(),
        ..Header::new(2)
    };
    let materials = MaterialPalette::new(vec![Material::matte([10, 20, 30]), glass()]).unwrap();
    let mut writer = Writer::new(Vec::new(), &header, &materials).unwrap();
    let encoder = writer.encoder();
    let planes = [
        Planes { masks: vec![0], palette_indices: vec![1], normals: vec![[0x11, 0x12]] },
        Planes {
            masks: vec![0x0F],
            palette_indices: vec![2, 2, 1, 2, 1],
            normals: vec![[100, 200], [101, 199], [100, 200], [90, 255], [110, 0]],
        },
    ];
    for (planes, code) in planes.into_iter().zip([0, 7]) {
        let levels = Levels::subtree(1, 2, planes).unwrap();
        writer.subtree(&encoder.encode(&Subtree { code, levels }).unwrap()).unwrap();
    }
    let top = Planes { masks: vec![0x81], palette_indices: vec![1], normals: vec![[0x21, 0x22]] };
    writer.finish(&Levels::top(1, top).unwrap()).unwrap()
}

/// A head with its checksum, and what follows it.
fn section(head: [u8; 28], stored: &[u8]) -> Vec<u8> {
    let checksum = crc32(&[&head, stored].concat()).to_le_bytes();
    [&head, &checksum[..], stored].concat()
}

#[test]
fn every_byte_is_as_described() {
    let mut expected = Vec::new();
    #[rustfmt::skip]
    expected.extend([0x4D, 0x42, 5, 0, 2, 1, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0]);
    assert_eq!(expected.len(), 16);
    expected.extend([1.0_f64, -2.0, 0.5, 0.25].map(f64::to_le_bytes).as_flattened());
    assert_eq!(expected.len(), 48);
    expected.extend(b"test");
    expected.resize(92, 0);
    expected.extend(crc32(&expected).to_le_bytes());

    assert_eq!(expected.len(), 96);
    let mut materials = [[0; 40]; 2];
    materials[0][0..3].copy_from_slice(&[10, 20, 30]);
    materials[0][12..16].copy_from_slice(&1.0_f32.to_le_bytes());
    materials[1][0..8].copy_from_slice(&[1, 2, 3, 4, 5, 6, 7, 8]);
    materials[1][8..12].copy_from_slice(&9.5_f32.to_le_bytes());
    materials[1][12..16].copy_from_slice(&1.5_f32.to_le_bytes());
    materials[1][16..28].copy_from_slice([0.25_f32, 0.5, 0.75].map(f32::to_le_bytes).as_flattened());
    materials[1][28..40].copy_from_slice([1.0_f32, 2.0, 4.0].map(f32::to_le_bytes).as_flattened());
    #[rustfmt::skip]
    let head = [b'M', b'A', b'T', b'L', 80, 0, 0, 0,  0, 0, 0, 0, 0, 0, 0, 0,  0, 0, 0, 0,  2, 0, 0, 0,  0, 0, 0, 0];
    expected.extend(section(head, materials.as_flattened()));

    let first = expected.len();
    assert_eq!(first, 208);
    #[rustfmt::skip]
    let head = [b'T', b'R', b'E', b'E', 5, 0, 0, 0,  0, 0, 0, 0, 0, 0, 0, 0,  1, 0, 0, 0,  1, 0, 0, 0,  1, 0, 0, 0];
    // A table of one index, the mask, the normal; nothing of the second level.
    expected.extend(section(head, &[1, 0, 0, 0x11, 0x12]));

    let second = expected.len();
    #[rustfmt::skip]
    let head = [b'T', b'R', b'E', b'E', 20, 0, 0, 0,  7, 0, 0, 0, 0, 0, 0, 0,  1, 0, 0, 0,  5, 0, 0, 0,  2, 0, 0, 0];
    #[rustfmt::skip]
    expected.extend(section(head, &[
        1, 0, 2, 0,
        0x0F, 1, 100, 200,
        0, 255, 0, 255, 1, 0, 246, 10, 255, 0, 55, 56,
    ]));

    let top = expected.len();
    #[rustfmt::skip]
    let head = [b'T', b'O', b'P', b' ', 5, 0, 0, 0,  0, 0, 0, 0, 0, 0, 0, 0,  1, 0, 0, 0,  1, 0, 0, 0,  1, 0, 0, 0];
    expected.extend(section(head, &[1, 0, 0x81, 0x21, 0x22]));

    let index = expected.len();
    let counts: [u64; 6] = [1, 1, 2, 1, 4, 0];
    let mut raw = counts.map(u64::to_le_bytes).as_flattened().to_vec();
    for (start, code, length, voxels) in [(first, 0, 5, 1), (second, 7, 20, 5)] {
        raw.extend([code, start as u64].map(u64::to_le_bytes).as_flattened());
        raw.extend([length, 1, voxels].map(u32::to_le_bytes).as_flattened());
        raw.extend_from_slice(&expected[start + 28..start + 32]);
    }
    #[rustfmt::skip]
    let head = [b'I', b'N', b'D', b'X', 112, 0, 0, 0,  0, 0, 0, 0, 0, 0, 0, 0,  0, 0, 0, 0,  2, 0, 0, 0,  0, 0, 0, 0];
    expected.extend(section(head, &raw));

    let trailer = expected.len();
    expected.extend(b"END \x02\0\0\0");
    expected.extend([top as u64, index as u64, 7].map(u64::to_le_bytes).as_flattened());
    expected.extend(crc32(&expected[trailer..]).to_le_bytes());
    assert_eq!(expected.len() - trailer, 36);

    assert_eq!(file(), expected);
}

#[test]
fn every_field_is_read_from_its_place() {
    let file = file();
    let archive = Archive::of_bytes(&file).unwrap();
    let header = archive.header();
    assert_eq!((header.depth, header.cut_level, header.resolution()), (2, 1, 4));
    assert_eq!((header.normal_code, header.compression), (NormalCode::Spherical, Compression::None));
    assert_eq!((header.world, header.writer.as_str()), (Some(WORLD), "test"));
    assert_eq!(archive.materials().materials(), [Material::matte([10, 20, 30]), glass()]);
    assert_eq!(archive.materials().material(2), Some(&glass()));
    assert_eq!(archive.materials().material(0), None);

    let subtree = archive.subtree(1).unwrap();
    assert_eq!((subtree.code, subtree.levels.first_level(), subtree.levels.level_count()), (7, 1, 2));
    assert_eq!(subtree.levels.level(1).masks, [0x0F]);
    assert_eq!(subtree.levels.level(2).palette_indices, [2, 1, 2, 1]);
    assert_eq!(subtree.levels.level(2).normals, [[101, 199], [100, 200], [90, 255], [110, 0]]);
    assert!(subtree.levels.level(0).normals.is_empty() && subtree.levels.level(3).normals.is_empty());
    assert_eq!(archive.top().masks(), [0x81]);
    assert_eq!(archive.top().normals(), [[0x21, 0x22]]);
    assert_eq!(archive.file_bytes(), file.len() as u64);
}

/// Tables of palette indices have up to 256 entries; beyond, the indices stand for themselves.
#[test]
fn palette_indices_are_stored_in_three_ways() {
    let materials = MaterialPalette::new(vec![Material::matte([0; 3]); 65_535]).unwrap();
    let header = Header { cut_level: 0, compression: Compression::None, ..Header::new(3) };
    for (distinct, table, index_bytes) in
        [(1, 1, 0), (2, 2, 1), (255, 255, 1), (256, 256, 1), (257, 0, 2), (500, 0, 2)]
    {
        // Far apart, so that differences wrap around; 65,535 is among them.
        let indices: Vec<u16> =
            (0..1 + 8 + 64 + 512_u32).map(|k| (65_535 - k % distinct * 131) as u16).collect();
        let planes = Planes { masks: vec![0xFF; 73], normals: vec![[7, 9]; 585], palette_indices: indices };
        let levels = Levels::subtree(0, 3, planes).unwrap();
        let mut writer = Writer::new(Vec::new(), &header, &materials).unwrap();
        let encoded = writer.encoder().encode(&Subtree { code: 0, levels: levels.clone() }).unwrap();
        assert_eq!(encoded.byte_length(), 32 + 2 * table + 73 + (2 + index_bytes) * 585);
        writer.subtree(&encoded).unwrap();
        let file = writer.finish(&Levels::top(0, Planes::default()).unwrap()).unwrap();
        assert_eq!(Archive::of_bytes(&file).unwrap().subtree(0).unwrap().levels, levels);
        let plain = parse(&file).subtrees.remove(0).1;
        let found: Vec<u16> = plain.iter().flatten().map(|voxel| voxel.index).collect();
        assert_eq!(found, levels.palette_indices());
    }
}
