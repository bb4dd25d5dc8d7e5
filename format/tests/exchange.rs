//! Octrees as the volumes of other programs: byte by byte, from the descriptions of their formats.

mod common;

use common::{Tree, palette, well_made_trees};
use octvox_format::exchange::{
    Cells, ExchangeError, Leaf, Leaves, Volume, write_binvox, write_npy, write_raw,
};
use octvox_format::{AnyReader, FormatError, Material, MaterialPalette, WorldTransform};
use proptest::prelude::*;
use std::io::{Cursor, ErrorKind, Write};

/// 4³ cells: octant 1 of the root is filled as a whole, with material 2; of octant 6 the octants 0 and 3, with 1 and 3.
fn tree() -> Tree {
    let mut tree = Tree::node(1, [0, 2, 0, 0, 0, 0, 0, 0].map(Tree::leaf));
    tree.children[6] = Tree::node(1, [1, 0, 0, 3, 0, 0, 0, 0].map(Tree::leaf));
    tree
}

fn leaves(tree: &Tree) -> impl Iterator<Item = Result<Leaf, FormatError>> + use<> {
    let reader = AnyReader::new(Cursor::new(tree.file(&palette()))).unwrap();
    Leaves::new(reader.records().unwrap())
}

fn volume(tree: &Tree, depth: u8) -> Volume<impl Iterator<Item = Result<Leaf, FormatError>> + use<>> {
    Volume { leaves: leaves(tree), depth, max_bytes: 1 << 20 }
}

/// The palette index of each cell, by x, y and z.
fn cells(tree: &Tree, depth: u8) -> Vec<Vec<Vec<u16>>> {
    fn fill(tree: &Tree, [x, y, z]: [usize; 3], side: usize, cells: &mut [Vec<Vec<u16>>]) {
        if tree.children.is_empty() {
            for plane in &mut cells[x..x + side] {
                for row in &mut plane[y..y + side] {
                    row[z..z + side].fill(tree.voxel.palette_index);
                }
            }
        }
        let half = side / 2;
        for (octant, child) in tree.children.iter().enumerate() {
            let corner = [x + half * (octant & 1), y + half * (octant >> 1 & 1), z + half * (octant >> 2)];
            fill(child, corner, half, cells);
        }
    }
    let side = 1 << depth;
    let mut cells = vec![vec![vec![0; side]; side]; side];
    fill(tree, [0; 3], side, &mut cells);
    cells
}

fn materials() -> MaterialPalette {
    MaterialPalette::from(&palette())
}

#[test]
fn a_raw_volume_has_x_fastest() {
    let file = write_raw(volume(&tree(), 2), Cells::Index8, &materials(), Vec::new()).unwrap();
    #[rustfmt::skip]
    let expected = [
        0, 0, 2, 2,  0, 0, 2, 2,  0, 0, 0, 0,  0, 0, 0, 0,
        0, 0, 2, 2,  0, 0, 2, 2,  0, 0, 0, 0,  0, 0, 0, 0,
        0, 0, 0, 0,  0, 0, 0, 0,  1, 0, 0, 0,  0, 3, 0, 0,
        0, 0, 0, 0,  0, 0, 0, 0,  0, 0, 0, 0,  0, 0, 0, 0,
    ];
    assert_eq!(file, expected);
}

#[test]
fn an_array_has_a_head_and_z_fastest() {
    let file = write_npy(volume(&tree(), 2), Cells::Index16, &materials(), Vec::new()).unwrap();
    let (head, body) = file.split_at(128);
    let text = b"\x93NUMPY\x01\x00\x76\x00{'descr': '<u2', 'fortran_order': False, 'shape': (4, 4, 4), }";
    assert_eq!(head[..text.len()], text[..]);
    assert!(head[text.len()..127].iter().all(|byte| *byte == b' ') && head[127] == b'\n');
    #[rustfmt::skip]
    let expected = [
        0, 0, 0, 0,  0, 0, 0, 0,  0, 0, 1, 0,  0, 0, 0, 0,
        0, 0, 0, 0,  0, 0, 0, 0,  0, 0, 0, 0,  0, 0, 3, 0,
        2, 2, 0, 0,  2, 2, 0, 0,  0, 0, 0, 0,  0, 0, 0, 0,
        2, 2, 0, 0,  2, 2, 0, 0,  0, 0, 0, 0,  0, 0, 0, 0_u16,
    ];
    assert_eq!(body, expected.map(u16::to_le_bytes).as_flattened());
}

#[test]
fn colors_have_an_opacity() {
    let glass = Material { transparency: 255, ..Material::matte([4, 5, 6]) };
    let half = Material { transparency: 100, ..Material::matte([7, 8, 9]) };
    let materials = MaterialPalette::new(vec![Material::matte([1, 2, 3]), glass, half]).unwrap();
    let tree = Tree::node(1, [0, 1, 2, 3, 0, 0, 0, 0].map(Tree::leaf));
    let file = write_npy(volume(&tree, 1), Cells::Rgba, &materials, Vec::new()).unwrap();
    assert!(file.windows(20).any(|text| text == b"'shape': (2, 2, 2, 4"));
    #[rustfmt::skip]
    let expected = [
        0, 0, 0, 0,  0, 0, 0, 0,  4, 5, 6, 1,  0, 0, 0, 0,
        1, 2, 3, 255,  0, 0, 0, 0,  7, 8, 9, 155,  0, 0, 0, 0,
    ];
    assert_eq!(file[128..], expected);
}

#[test]
fn binvox_has_y_fastest_and_counts_cells() {
    let world = Some(WorldTransform { origin: [-1.5, 0.25, 1e-7], voxel_size: 0.5 });
    let file = write_binvox(volume(&tree(), 2), world, Vec::new()).unwrap();
    let head = b"#binvox 1\ndim 4 4 4\ntranslate -1.5 0.25 0.0000001\nscale 2\ndata\n";
    assert_eq!(file[..head.len()], head[..]);
    // Cells (0, 2, 2) and (1, 3, 2); 2³ cells from (2, 0, 0) on.
    #[rustfmt::skip]
    let expected = [
        0, 10, 1, 1, 0, 16, 1, 1, 0, 4,
        1, 2, 0, 2, 1, 2, 0, 10, 1, 2, 0, 2, 1, 2, 0, 10,
    ];
    assert_eq!(file[head.len()..], expected);
}

#[test]
fn runs_of_binvox_are_at_most_255_long() {
    let file = write_binvox(volume(&Tree::leaf(1), 3), None, Vec::new()).unwrap();
    assert!(file.starts_with(b"#binvox 1\ndim 8 8 8\ntranslate 0 0 0\nscale 1\ndata\n"));
    assert!(file.ends_with(b"data\n\x01\xFF\x01\xFF\x01\x02"));
    let file = write_binvox(volume(&Tree::leaf(0), 3), None, Vec::new()).unwrap();
    assert!(file.ends_with(b"data\n\x00\xFF\x00\xFF\x00\x02"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn volumes_have_every_cell_in_its_place(tree in well_made_trees()) {
        let depth = tree.depth();
        let side = 1 << depth;
        let cells = cells(&tree, depth);
        let raw = write_raw(volume(&tree, depth), Cells::Index8, &materials(), Vec::new()).unwrap();
        let array = write_npy(volume(&tree, depth), Cells::Index8, &materials(), Vec::new()).unwrap();
        let file = write_binvox(volume(&tree, depth), None, Vec::new()).unwrap();
        let start = file.windows(5).position(|text| text == b"data\n").unwrap() + 5;
        let filled: Vec<u8> =
            file[start..].chunks(2).flat_map(|run| vec![run[0]; usize::from(run[1])]).collect();
        prop_assert_eq!(filled.len(), side * side * side);
        for (x, plane) in cells.iter().enumerate() {
            for (y, row) in plane.iter().enumerate() {
                for (z, &index) in row.iter().enumerate() {
                    prop_assert_eq!(u16::from(raw[x + side * (y + side * z)]), index);
                    prop_assert_eq!(u16::from(array[128 + z + side * (y + side * x)]), index);
                    prop_assert_eq!(filled[y + side * (z + side * x)] == 1, index > 0);
                }
            }
        }
    }
}

#[test]
fn a_volume_beyond_the_limit_is_refused() {
    let limited = |depth, max_bytes| Volume { max_bytes, ..volume(&tree(), depth) };
    for (depth, max_bytes) in [(2, 63), (10, 1 << 29), (21, 1 << 40), (23, u64::MAX)] {
        let result = write_raw(limited(depth, max_bytes), Cells::Index8, &materials(), Vec::new());
        let Err(FormatError::Exchange(ExchangeError::VolumeTooLarge { limit, .. })) = result else {
            panic!("{depth}: {:?}", result.err())
        };
        assert_eq!(limit, max_bytes);
    }
    assert!(write_raw(limited(2, 96), Cells::Index8, &materials(), Vec::new()).is_ok());
    // Not the cells, but the runs of the filled ones: 4 · 16 bytes for the large one alone.
    let result = write_binvox(limited(2, 63), None, Vec::new());
    assert!(matches!(result, Err(FormatError::Exchange(ExchangeError::VolumeTooLarge { bytes: 64, .. }))));
}

#[test]
fn voxels_below_the_volume_are_refused() {
    let result = write_raw(volume(&tree(), 1), Cells::Index8, &materials(), Vec::new());
    assert!(matches!(result, Err(FormatError::TooDeep { max_depth: 1, .. })));
}

#[test]
fn a_byte_cannot_name_256_materials() {
    let materials = MaterialPalette::new(vec![Material::matte([0; 3]); 256]).unwrap();
    assert_eq!(Cells::of_palette(&materials), Cells::Index16);
    let result = write_raw(volume(&tree(), 2), Cells::Index8, &materials, Vec::new());
    assert!(matches!(result, Err(FormatError::Exchange(ExchangeError::TooManyForBytes { materials: 256 }))));
}

/// Takes nothing.
struct Full;

impl Write for Full {
    fn write(&mut self, _: &[u8]) -> std::io::Result<usize> {
        Err(ErrorKind::StorageFull.into())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_full_disk_is_an_error() {
    let results = [
        write_raw(volume(&tree(), 2), Cells::Index8, &materials(), Full).err(),
        write_npy(volume(&tree(), 2), Cells::Index8, &materials(), Full).err(),
        write_binvox(volume(&tree(), 2), None, Full).err(),
    ];
    for error in results {
        let Some(FormatError::Write { source, .. }) = error else { panic!("{error:?}") };
        assert_eq!(source.kind(), ErrorKind::StorageFull);
    }
}
