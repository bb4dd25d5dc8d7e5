//! A writer refuses what would not be a file.

mod common;

use common::palette;
use octvox_format::{FormatError, Limits, Voxel, Writer};
use std::io::{self, BufWriter, ErrorKind, Write};

const HEADER: u64 = 8 + 3 * common::COLORS as u64;
const FILLED: Voxel = Voxel { palette_index: 1, ..Voxel::EMPTY };

fn writer() -> Writer<Vec<u8>> {
    Writer::new(Vec::new(), &palette()).unwrap()
}

#[test]
fn an_unfinished_octree_is_refused() {
    let Err(FormatError::TreeIncomplete { offset, records, missing }) = writer().finish() else { panic!() };
    assert_eq!((offset, records, missing), (HEADER, 0, 1));

    let mut writer = writer();
    writer.node(FILLED).unwrap();
    writer.leaf(FILLED).unwrap();
    writer.node(FILLED).unwrap();
    writer.empty().unwrap();
    let Err(FormatError::TreeIncomplete { offset, records, missing }) = writer.finish() else { panic!() };
    assert_eq!((offset, records, missing), (HEADER + 16, 4, 7 + 6));
}

#[test]
fn a_voxel_too_many_is_refused_and_does_no_harm() {
    let mut writer = writer();
    writer.leaf(FILLED).unwrap();
    for result in [writer.leaf(FILLED), writer.node(FILLED), writer.empty()] {
        let Err(FormatError::TreeComplete { offset, records }) = result else { panic!() };
        assert_eq!((offset, records), (HEADER + 4, 1));
    }
    assert_eq!(writer.finish().unwrap().len() as u64, HEADER + 4);
}

#[test]
fn an_unknown_color_is_refused_and_does_no_harm() {
    for palette_index in [common::COLORS + 1, 32_768, u16::MAX] {
        let unknown = Voxel { palette_index, ..Voxel::EMPTY };
        let mut writer = writer();
        for result in [writer.leaf(unknown), writer.node(unknown)] {
            let Err(FormatError::PaletteIndexOutOfRange { offset, index, palette_size }) = result else {
                panic!()
            };
            assert_eq!((offset, index, palette_size), (HEADER, palette_index, common::COLORS));
        }
        assert_eq!(writer.records_written(), 0);
        writer.leaf(FILLED).unwrap();
        writer.finish().unwrap();
    }
}

#[test]
fn a_level_too_deep_is_refused_and_does_no_harm() {
    let mut writer = writer();
    for _ in 0..Limits::MAX_DEPTH {
        writer.node(FILLED).unwrap();
    }
    let Err(FormatError::TooDeep { offset, max_depth }) = writer.node(FILLED) else { panic!() };
    assert_eq!((offset, max_depth), (HEADER + 4 * 23, 23));
    for _ in 0..8 + 22 * 7 {
        writer.leaf(FILLED).unwrap();
    }
    writer.finish().unwrap();
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
        let mut writer = Writer::new(Full(room), &palette())?;
        writer.leaf(FILLED)?;
        writer.finish().map(|_| ())
    };
    let length = HEADER as usize + 4;
    write(length).unwrap();
    for room in 0..length {
        let Err(FormatError::Write { source, .. }) = write(room) else { panic!("{room}") };
        assert_eq!(source.kind(), ErrorKind::StorageFull);
    }
}

#[test]
fn a_full_disk_is_an_error_behind_a_buffer() {
    let buffered = BufWriter::with_capacity(1000, Full(HEADER as usize));
    let mut writer = Writer::new(buffered, &palette()).unwrap();
    writer.leaf(FILLED).unwrap();
    assert!(matches!(writer.finish(), Err(FormatError::Write { .. })));
}

#[test]
fn a_full_disk_is_noticed_before_the_end() {
    fn fill(writer: &mut Writer<Full>, level: u8) -> Result<(), FormatError> {
        if level == 6 {
            return writer.leaf(FILLED);
        }
        writer.node(FILLED)?;
        (0..8).try_for_each(|_| fill(writer, level + 1))
    }
    let mut writer = Writer::new(Full(1000), &palette()).unwrap();
    let Err(FormatError::Write { offset, .. }) = fill(&mut writer, 0) else { panic!() };
    assert_eq!(offset, HEADER + 4 * writer.records_written());
}
