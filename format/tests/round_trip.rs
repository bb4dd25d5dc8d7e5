//! What is written is what is read, for every octree and however the bytes arrive.

mod common;

use common::{Tree, palette, read, trees, write};
use octvox_format::{Limits, Reader, Record, Voxel, Writer};
use proptest::prelude::*;
use std::io::{self, ErrorKind, Read};

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn the_reader_returns_the_preorder(tree in trees()) {
        let palette = palette();
        let (read_palette, records) = read(&tree.file(&palette)).unwrap();
        prop_assert_eq!(read_palette, palette);
        prop_assert_eq!(records, tree.records());
    }

    #[test]
    fn the_writer_writes_the_described_bytes(tree in trees()) {
        let palette = palette();
        prop_assert_eq!(write(&palette, &tree.records()).unwrap(), tree.file(&palette));
    }

    #[test]
    fn small_and_interrupted_reads_change_nothing(tree in trees(), sizes in prop::collection::vec(0_usize..9, 1..9)) {
        let file = tree.file(&palette());
        let trickle = Trickle { bytes: &file, sizes, turn: 0 };
        let records: Vec<Record> = Reader::new(trickle).unwrap().collect::<Result<_, _>>().unwrap();
        prop_assert_eq!(records, tree.records());
    }
}

/// Hands out a few bytes at a time, and an interruption where the size is 0.
struct Trickle<'a> {
    bytes: &'a [u8],
    sizes: Vec<usize>,
    turn: usize,
}

impl Read for Trickle<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let size = self.sizes[self.turn % self.sizes.len()];
        self.turn += 1;
        // If all sizes are 0, every other read succeeds all the same.
        if size == 0 && self.turn.is_multiple_of(2) {
            return Err(ErrorKind::Interrupted.into());
        }
        let size = size.clamp(1, buffer.len().max(1));
        self.bytes.read(&mut buffer[..size])
    }
}

/// A file of several blocks, whose voxels do not begin at multiples of four.
#[test]
fn voxels_may_lie_across_blocks() {
    const DEPTH: u8 = 6;
    fn write_full(writer: &mut Writer<Vec<u8>>, level: u8, count: &mut u16) {
        *count = count.wrapping_add(1);
        let [theta, phi] = count.to_le_bytes();
        let normal = octvox_format::SphericalNormal::from_bytes([theta, phi]);
        let voxel = Voxel { palette_index: 1 + *count % 3, normal };
        if level == DEPTH {
            return writer.leaf(voxel).unwrap();
        }
        writer.node(voxel).unwrap();
        (0..8).for_each(|_| write_full(writer, level + 1, count));
    }
    let mut writer = Writer::new(Vec::new(), &palette()).unwrap();
    write_full(&mut writer, 0, &mut 0);
    let expected = (8_u64.pow(u32::from(DEPTH) + 1) - 1) / 7;
    assert_eq!(writer.records_written(), expected);
    let file = writer.finish().unwrap();
    assert!(file.len() > 1_000_000);
    assert_ne!((file.len() - 4 * expected as usize) % 4, 0);

    let mut count = 0_u16;
    let mut records = 0;
    for record in Reader::new(&file[..]).unwrap() {
        let record = record.unwrap();
        count = count.wrapping_add(1);
        assert_eq!(record.voxel.normal.to_bytes(), count.to_le_bytes());
        records += 1;
    }
    assert_eq!(records, expected);
}

#[test]
fn the_deepest_octree_goes_through() {
    let tree = Tree::chain(Limits::MAX_DEPTH);
    let file = tree.file(&palette());
    let (palette, records) = read(&file).unwrap();
    assert_eq!(records.iter().map(|record| record.level).max(), Some(23));
    assert_eq!(records, tree.records());
    assert_eq!(write(&palette, &records).unwrap(), file);
}
