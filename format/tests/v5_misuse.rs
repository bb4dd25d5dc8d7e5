//! A writer of version 5 refuses what would not be a file.

mod common;

use octvox_format::v5::{EncodedSubtree, Encoder, Header, LevelDefect, Levels, Planes, Subtree, Writer};
use octvox_format::{FormatError, Material, MaterialPalette, WorldTransform};
use std::io::{self, ErrorKind, Write};

/// 2³ subtrees of 2³ cells.
fn header() -> Header {
    Header { cut_level: 1, ..Header::new(2) }
}

fn materials() -> MaterialPalette {
    MaterialPalette::new(vec![Material::matte([1, 2, 3]); 3]).unwrap()
}

fn writer() -> Writer<Vec<u8>> {
    Writer::new(Vec::new(), &header(), &materials()).unwrap()
}

fn planes(masks: &[u8], voxels: usize) -> Planes {
    Planes { masks: masks.to_vec(), palette_indices: vec![1; voxels], normals: vec![[0; 2]; voxels] }
}

fn subtree(code: u64) -> EncodedSubtree {
    let levels = Levels::subtree(1, 2, planes(&[0b11], 3)).unwrap();
    Encoder::new(&header()).encode(&Subtree { code, levels }).unwrap()
}

fn top(mask: u8) -> Levels {
    Levels::top(1, planes(&[mask], 1)).unwrap()
}

#[test]
fn subtrees_come_in_order_and_in_the_cube() {
    let mut writer = writer();
    writer.subtree(&subtree(3)).unwrap();
    for code in [3, 0] {
        let Err(FormatError::SubtreeOrder { offset, code: found, previous }) = writer.subtree(&subtree(code))
        else {
            panic!()
        };
        assert_eq!((offset, found, previous), (writer.offset(), code, 3));
    }
    for code in [8, 1 << 60, u64::MAX] {
        let result = writer.subtree(&subtree(code));
        assert!(matches!(result, Err(FormatError::SubtreeCode { cut_level: 1, .. })), "{code}");
    }
    // Nothing of that did harm.
    writer.subtree(&subtree(4)).unwrap();
    writer.finish(&top(0b11000)).unwrap();
}

#[test]
fn a_subtree_has_the_levels_of_the_file() {
    let mut writer = writer();
    for (cut_level, depth, planes) in
        [(0, 1, planes(&[1], 2)), (1, 1, planes(&[], 1)), (1, 3, planes(&[1, 1], 3))]
    {
        let levels = Levels::subtree(cut_level, depth, planes).unwrap();
        let encoded = writer.encoder().encode(&Subtree { code: 0, levels }).unwrap();
        assert!(matches!(writer.subtree(&encoded), Err(FormatError::SubtreeLevels { .. })));
    }
}

#[test]
fn an_index_beyond_the_palette_is_refused() {
    let beyond = Planes { palette_indices: vec![4], ..planes(&[0], 1) };
    let defect = LevelDefect::PaletteIndex { index: 4, materials: 3 };
    let mut writer = writer();
    let levels = Levels::subtree(1, 2, beyond.clone()).unwrap();
    let encoded = writer.encoder().encode(&Subtree { code: 0, levels }).unwrap();
    let Err(FormatError::DamagedLevels { defect: found, .. }) = writer.subtree(&encoded) else { panic!() };
    assert_eq!(found, defect);
    let Err(FormatError::DamagedLevels { defect: found, .. }) =
        writer.finish(&Levels::top(1, beyond).unwrap())
    else {
        panic!()
    };
    assert_eq!(found, defect);
}

#[test]
fn the_top_names_the_subtrees_that_there_are() {
    for (mask, expected) in [(0b1001, (2, 2, 1)), (0b1, (1, 2, 0)), (0b111, (3, 2, 0)), (0, (0, 2, 0))] {
        let mut writer = writer();
        writer.subtree(&subtree(0)).unwrap();
        writer.subtree(&subtree(2)).unwrap();
        let Err(FormatError::TopSubtrees { named, found, place, .. }) = writer.finish(&top(mask)) else {
            panic!("{mask:b}")
        };
        assert_eq!((named, found, place), expected, "{mask:b}");
    }
    writer().finish(&top(0)).unwrap();
    assert!(matches!(writer().finish(&top(1)), Err(FormatError::TopSubtrees { named: 1, found: 0, .. })));
    // An empty octree has no root.
    writer().finish(&Levels::top(1, Planes::default()).unwrap()).unwrap();
}

#[test]
fn the_top_has_the_levels_above_the_cut() {
    let others = [
        Levels::top(0, Planes::default()).unwrap(),
        Levels::top(2, planes(&[1, 0], 2)).unwrap(),
        Levels::subtree(0, 0, planes(&[], 1)).unwrap(),
    ];
    for other in others {
        assert!(matches!(writer().finish(&other), Err(FormatError::TopLevels { .. })));
    }
}

#[test]
fn a_header_that_cannot_be_is_refused() {
    let refused = |header: &Header| Writer::new(Vec::new(), header, &materials()).unwrap_err();
    assert!(matches!(refused(&Header::new(24)), FormatError::TooDeep { max_depth: 23, .. }));
    let header = |cut_level, depth| Header { cut_level, ..Header::new(depth) };
    assert!(matches!(refused(&header(3, 2)), FormatError::FieldOutOfRange { value: 3, limit: 2, .. }));
    assert!(matches!(refused(&header(22, 23)), FormatError::FieldOutOfRange { value: 22, limit: 21, .. }));
    for world in [[0.0; 4], [0.0, 0.0, 0.0, -1.0], [f64::NAN, 0.0, 0.0, 1.0], [0.0, 0.0, 0.0, f64::INFINITY]]
    {
        let [x, y, z, voxel_size] = world;
        let world = Some(WorldTransform { origin: [x, y, z], voxel_size });
        assert!(matches!(refused(&Header { world, ..Header::new(2) }), FormatError::ImpossibleWorld { .. }));
    }
    for name in ["a name that has forty-five bytes, one too many", "zero\0inside"] {
        let header = Header { writer: name.to_owned(), ..Header::new(2) };
        assert!(matches!(refused(&header), FormatError::WriterName { limit: 44, .. }));
    }
}

#[test]
fn an_impossible_material_is_refused() {
    assert!(matches!(
        MaterialPalette::new(vec![Material::matte([0; 3]); 65_536]),
        Err(FormatError::TooManyMaterials { count: 65_536, limit: 65_535 })
    ));
    let matte = Material::matte([0; 3]);
    let impossible = [
        (Material { shininess: -1.0, ..matte }, "shininess"),
        (Material { refraction_index: 0.0, ..matte }, "refraction index"),
        (Material { refraction_index: f32::INFINITY, ..matte }, "refraction index"),
        (Material { absorption: [0.0, f32::NAN, 0.0], ..matte }, "absorption"),
        (Material { emission: [0.0, 0.0, -0.5], ..matte }, "emission"),
    ];
    for (material, name) in impossible {
        let Err(FormatError::ImpossibleMaterial { index, field, .. }) =
            MaterialPalette::new(vec![matte, material])
        else {
            panic!("{name}")
        };
        assert_eq!((index, field), (2, name));
    }
}

#[test]
fn more_materials_than_version_4_can_name_are_refused() {
    let palette = |count| MaterialPalette::new(vec![Material::matte([5, 6, 7]); count]).unwrap();
    assert_eq!(palette(32_767).to_palette().unwrap().color(32_767), Some([5, 6, 7]));
    let error = palette(32_768).to_palette().unwrap_err();
    assert_eq!(
        error.to_string(),
        "32768 materials are too many for the file, which can have 32767; merge some"
    );
}

/// Takes so many bytes and no more.
struct Full(usize);

impl Write for Full {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let taken = bytes.len().min(self.0);
        self.0 -= taken;
        if taken == 0 { Err(ErrorKind::StorageFull.into()) } else { Ok(taken) }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_full_disk_is_an_error() {
    let write = |room| {
        let mut writer = Writer::new(Full(room), &header(), &materials())?;
        writer.subtree(&subtree(5))?;
        writer.finish(&top(1 << 5)).map(|_| ())
    };
    let length = (0..).find(|room| write(*room).is_ok()).unwrap();
    assert!(length > 96 + 4 * 32 + 36);
    for room in 0..length {
        let Err(FormatError::Write { source, .. }) = write(room) else { panic!("{room}") };
        assert_eq!(source.kind(), ErrorKind::StorageFull);
    }
}
