//! The bytes of a file stand where the crate's description says.

mod common;

use common::{FIGURE_17, read, write};
use octvox_format::{Palette, Record, SphericalNormal, Voxel, Writer};

#[test]
fn the_example_of_the_thesis_is_read() {
    let (palette, records) = read(&FIGURE_17).unwrap();
    assert_eq!(palette.colors(), [[255; 3], [0; 3]]);

    let voxel = |palette_index, theta, phi| Voxel { palette_index, normal: SphericalNormal { theta, phi } };
    let root = Record { level: 0, octant: 0, voxel: voxel(2, 0xA1, 0x76), has_children: true };
    assert_eq!(records[0], root);
    let children = [
        voxel(2, 0x3D, 0x42),
        voxel(1, 0x91, -0x44),
        voxel(2, 0x1C, -0x56),
        voxel(1, 0x74, 0x32),
        voxel(2, 0x4A, -0x71),
        voxel(1, 0x88, -0x1E),
        voxel(2, 0xF9, -0x3B),
        voxel(1, 0x61, 0x5D),
    ];
    for (octant, voxel) in (0..).zip(children) {
        let child = Record { level: 1, octant, voxel, has_children: false };
        assert_eq!(records[1 + usize::from(octant)], child);
    }
    assert_eq!(records.len(), 9);
}

#[test]
fn the_example_of_the_thesis_is_written() {
    let (palette, records) = read(&FIGURE_17).unwrap();
    assert_eq!(write(&palette, &records).unwrap(), FIGURE_17);
}

#[test]
fn every_field_has_its_offset() {
    // So many colours that the size has a high byte, and each byte of the file a value of its own.
    let n = 258;
    let colors: Vec<[u8; 3]> = (0..n).map(|k| [(k % 251) as u8, 252, 253]).collect();
    let voxel = |palette_index| Voxel { palette_index, normal: SphericalNormal { theta: 0xA1, phi: -2 } };
    let mut writer = Writer::new(Vec::new(), &Palette::new(colors.clone()).unwrap()).unwrap();
    writer.node(voxel(258)).unwrap();
    for index in 1..9 {
        writer.leaf(voxel(index)).unwrap();
    }
    let file = writer.finish().unwrap();

    assert_eq!(file[0..2], [0x4D, 0x42]);
    assert_eq!(file[2..4], [0x04, 0x00]);
    assert_eq!(file[4..6], [0x02, 0x01]);
    assert_eq!(file[6..6 + 3 * n], *colors.as_flattened());
    assert_eq!(file[6 + 3 * n..8 + 3 * n], [0x7C, 0x7C]);
    // 258 << 1 | 1 = 0x0205
    assert_eq!(file[8 + 3 * n..12 + 3 * n], [0x05, 0x02, 0xA1, 0xFE]);
    for (child, index) in file[12 + 3 * n..].chunks(4).zip(1..9) {
        assert_eq!(child, [index << 1, 0x00, 0xA1, 0xFE]);
    }
    assert_eq!(file.len(), 12 + 3 * n + 8 * 4);
}

#[test]
fn the_separator_is_ignored() {
    let mut file = FIGURE_17;
    file[12..14].copy_from_slice(&[0x00, 0xFF]);
    assert_eq!(read(&file).unwrap(), read(&FIGURE_17).unwrap());
}

#[test]
fn an_empty_voxel_is_four_zeros() {
    let mut writer = Writer::new(Vec::new(), &Palette::default()).unwrap();
    writer.empty().unwrap();
    assert_eq!(writer.finish().unwrap(), [0x4D, 0x42, 4, 0, 0, 0, 0x7C, 0x7C, 0, 0, 0, 0]);
}

#[test]
fn the_largest_palette_can_be_used() {
    let colors: Vec<[u8; 3]> =
        (0..Palette::MAX_COLORS).map(|k| [(k % 256) as u8, (k / 256) as u8, 9]).collect();
    let palette = Palette::new(colors).unwrap();
    let voxel = Voxel { palette_index: 32_767, normal: SphericalNormal::default() };
    let mut writer = Writer::new(Vec::new(), &palette).unwrap();
    writer.leaf(voxel).unwrap();
    let file = writer.finish().unwrap();
    let (read_palette, records) = read(&file).unwrap();
    assert_eq!(read_palette, palette);
    assert_eq!(records[0].voxel, voxel);
}
