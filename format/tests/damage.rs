//! Files that are damaged, foreign or hostile end in an error that says what and where.

mod common;

use common::{FIGURE_17, Tree, palette, read, write};
use octvox_format::{FormatError, Limits, Reader};
use proptest::prelude::*;
use std::io::{self, ErrorKind, Read};

/// Small files of different shapes.
fn small_files() -> Vec<Vec<u8>> {
    let palette = palette();
    let inner = || Tree::node(2, [0, 1, 0, 2, 3, 0, 0, 1].map(Tree::leaf));
    let mut two_levels = Tree::node(1, [0, 1, 2, 3, 3, 2, 1, 0].map(Tree::leaf));
    two_levels.children[0] = inner();
    two_levels.children[7] = inner();
    vec![
        FIGURE_17.to_vec(),
        Tree::leaf(3).file(&palette),
        Tree::leaf(0).file(&octvox_format::Palette::default()),
        two_levels.file(&palette),
        Tree::chain(3).file(&palette),
    ]
}

#[test]
fn every_truncation_is_an_error_at_the_end_of_the_file() {
    for file in small_files() {
        for length in 0..file.len() {
            let error = read(&file[..length]).unwrap_err();
            let (FormatError::TruncatedHeader { offset, missing, .. }
            | FormatError::TruncatedVoxels { offset, missing }) = error
            else {
                panic!("{length}: {error}")
            };
            assert_eq!(offset, length as u64);
            assert!(missing > 0);
        }
    }
}

#[test]
fn the_missing_voxels_are_enough_to_complete_the_file() {
    for file in small_files() {
        for length in 0..file.len() {
            let Err(FormatError::TruncatedVoxels { missing, .. }) = read(&file[..length]) else { continue };
            let mut completed = file[..length].to_vec();
            // A voxel that was cut is one of those that are missing.
            let voxels = file.len() - (file.len() - length).div_ceil(4) * 4;
            completed.truncate(voxels);
            completed.extend([0; 4].repeat(missing as usize));
            read(&completed).unwrap();
            completed.truncate(completed.len() - 4);
            read(&completed).unwrap_err();
        }
    }
}

#[test]
fn a_changed_byte_gives_an_error_or_another_file() {
    const SEPARATOR: &[u8] = &[0x7C, 0x7C];
    for file in small_files() {
        for position in 0..file.len() {
            for change in 1..=u8::MAX {
                let mut changed = file.clone();
                changed[position] ^= change;
                let Ok((palette, records)) = read(&changed) else { continue };
                let voxels = 8 + 3 * palette.len();
                changed[voxels - 2..voxels].copy_from_slice(SEPARATOR);
                assert_eq!(write(&palette, &records).unwrap(), changed);
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn arbitrary_voxels_give_an_error_or_a_file(
        words in prop::collection::vec((0_u8..8, any::<u8>(), any::<u8>()), 0..200),
    ) {
        // Small indices, so that some come through, and enough zeros to complete the octree.
        let mut file = b"MB\x04\x00\x03\x00012345678||".to_vec();
        file.extend(words.iter().flat_map(|&(flagged_index, theta, phi)| [flagged_index, 0, theta, phi]));
        if let Err(FormatError::TruncatedVoxels { missing, .. }) = read(&file) {
            file.extend([0; 4].repeat(missing as usize));
        }
        match read(&file) {
            Ok((palette, records)) => prop_assert_eq!(write(&palette, &records).unwrap(), file),
            Err(FormatError::TrailingBytes { offset } | FormatError::TooDeep { offset, .. }) => {
                prop_assert!(offset < file.len() as u64);
            }
            Err(error) => prop_assert!(false, "{}", error),
        }
    }

    #[test]
    fn arbitrary_bytes_do_no_harm(bytes in prop::collection::vec(any::<u8>(), 0..100)) {
        let _ = read(&bytes);
        let _ = read(&[b"MB\x04\x00".as_slice(), &bytes].concat());
    }
}

#[test]
fn every_field_of_the_header_is_named_when_cut() {
    let fields = [(0..2, "magic number"), (2..4, "version"), (4..6, "palette size"), (6..12, "palette")];
    for (range, name) in fields.into_iter().chain([(12..14, "separator")]) {
        for length in range.clone() {
            let Err(FormatError::TruncatedHeader { field, missing, .. }) = read(&FIGURE_17[..length]) else {
                panic!("{length}")
            };
            assert_eq!((field, missing), (name, (range.end - length) as u64));
        }
    }
}

#[test]
fn foreign_files_are_recognised() {
    let magica_voxel = b"VOX \x96\x00\x00\x00MAIN";
    assert!(matches!(read(magica_voxel), Err(FormatError::MagicaVoxel)));
    assert!(matches!(read(b"VOXEL"), Err(FormatError::WrongMagic { found: [b'V', b'O'] })));
    assert!(matches!(read(b"VO"), Err(FormatError::WrongMagic { found: [b'V', b'O'] })));
    assert!(matches!(read(b"# obj"), Err(FormatError::WrongMagic { found: [b'#', b' '] })));
    assert!(matches!(read(b"MB\x05\x00"), Err(FormatError::UnsupportedVersion { version: 5 })));
    assert!(matches!(read(b"MB\x04\x01"), Err(FormatError::UnsupportedVersion { version: 0x104 })));
    assert!(FormatError::MagicaVoxel.to_string().contains("MagicaVoxel"));
}

#[test]
fn a_palette_beyond_the_indices_is_refused() {
    let header = |size: u16| [b"MB\x04\x00".as_slice(), &size.to_le_bytes()].concat();
    assert!(matches!(read(&header(32_767)), Err(FormatError::TruncatedHeader { missing: 98_301, .. })));
    assert!(matches!(read(&header(32_768)), Err(FormatError::PaletteSizeOutOfRange { size: 32_768 })));
}

#[test]
fn an_index_beyond_the_palette_is_found_where_it_stands() {
    let mut file = FIGURE_17;
    file[14 + 5 * 4] = 3 << 1;
    let Err(FormatError::PaletteIndexOutOfRange { offset, index, palette_size }) = read(&file) else {
        panic!()
    };
    assert_eq!((offset, index, palette_size), (34, 3, 2));

    // Without colours all voxels must be empty.
    let uncolored = b"MB\x04\x00\x00\x00||\x02\x00\x00\x00";
    let Err(FormatError::PaletteIndexOutOfRange { offset, index, palette_size }) = read(uncolored) else {
        panic!()
    };
    assert_eq!((offset, index, palette_size), (8, 1, 0));
}

#[test]
fn bytes_behind_the_octree_are_an_error_after_the_last_record() {
    for extra in 1..6 {
        let file = [FIGURE_17.as_slice(), &vec![0; extra]].concat();
        let mut reader = Reader::new(&file[..]).unwrap();
        for _ in 0..9 {
            reader.next().unwrap().unwrap();
        }
        assert!(matches!(reader.next(), Some(Err(FormatError::TrailingBytes { offset: 50 }))));
        assert!(reader.next().is_none());
    }
}

#[test]
fn nothing_follows_an_error() {
    let mut file = FIGURE_17;
    file[14 + 2 * 4] = 3 << 1;
    let mut reader = Reader::new(&file[..]).unwrap();
    assert!(reader.next().unwrap().is_ok());
    assert!(reader.next().unwrap().is_ok());
    assert!(reader.next().unwrap().is_err());
    assert!(reader.next().is_none());
    assert!(reader.next().is_none());
}

#[test]
fn one_level_too_deep_is_an_error_where_it_begins() {
    // Every node but the root is the eighth child of its parent.
    let header = 8 + 3 * u64::from(common::COLORS);
    for max_depth in [0, 1, 7, Limits::MAX_DEPTH, u8::MAX] {
        let limits = Limits { max_depth, ..Limits::default() };
        let allowed = max_depth.min(Limits::MAX_DEPTH);
        let count = |depth: u8| {
            let file = Tree::chain(depth).file(&palette());
            Reader::with_limits(&file[..], limits).unwrap().collect::<Result<Vec<_>, _>>()
        };
        assert_eq!(count(allowed).unwrap().len(), 1 + 8 * usize::from(allowed));
        let Err(FormatError::TooDeep { offset, max_depth }) = count(allowed + 1) else {
            panic!("{max_depth}")
        };
        assert_eq!((offset, max_depth), (header + 4 * 8 * u64::from(allowed), allowed));
    }
}

/// A node in the first octant at every level, for ever: what a reader that recurses would crash on.
#[test]
fn endless_depth_is_an_error() {
    let header = b"MB\x04\x00\x01\x00\x00\x00\x00||".as_slice();
    let mut reader = Reader::new(header.chain(io::repeat(1))).unwrap();
    // 01 01 is palette index 128.
    assert!(matches!(reader.next(), Some(Err(FormatError::PaletteIndexOutOfRange { index: 128, .. }))));

    let nodes = [3, 0, 0, 0].repeat(100_000);
    let mut reader = Reader::new(header.chain(&nodes[..])).unwrap();
    let levels: Vec<u8> = reader.by_ref().map_while(Result::ok).map(|record| record.level).collect();
    assert_eq!(levels, Vec::from_iter(0..23));
}

#[test]
fn one_record_too_many_is_an_error_where_it_begins() {
    let count = |max_records| {
        let limits = Limits { max_records, ..Limits::default() };
        Reader::with_limits(&FIGURE_17[..], limits).unwrap().collect::<Result<Vec<_>, _>>()
    };
    assert_eq!(count(9).unwrap().len(), 9);
    let Err(FormatError::TooManyRecords { offset, max_records }) = count(8) else { panic!() };
    assert_eq!((offset, max_records), (14 + 8 * 4, 8));
    assert!(matches!(count(0), Err(FormatError::TooManyRecords { offset: 14, max_records: 0 })));
}

/// Fails once the bytes before the failure are read.
struct Failing<'a>(&'a [u8]);

impl Read for Failing<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self.0.read(buffer)? {
            0 => Err(ErrorKind::PermissionDenied.into()),
            count => Ok(count),
        }
    }
}

#[test]
fn a_failure_of_the_system_is_reported_where_it_happens() {
    for length in 0..=FIGURE_17.len() {
        let result = Reader::new(Failing(&FIGURE_17[..length]))
            .and_then(|reader| reader.collect::<Result<Vec<_>, _>>());
        let Err(FormatError::Read { offset, source }) = result else { panic!("{length}") };
        assert_eq!((offset, source.kind()), (length as u64, ErrorKind::PermissionDenied));
    }
}
