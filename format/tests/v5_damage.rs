//! Files of version 5 that are damaged or hostile end in an error that says what and where.

mod common;

use common::checksums::{HEAD, repair, sections};
use common::{Settings, Tree, palette};
use octvox_format::v5::{Archive, Compression, LevelDefect, Reader, Seekable, Source, Writer, summarize};
use octvox_format::{AnyReader, FormatError, Limits, MaterialPalette, NormalCode, Record, Summary};
use proptest::prelude::*;
use std::io::{self, Cursor, ErrorKind, Read};
use std::sync::LazyLock;

fn tree() -> Tree {
    let inner = || Tree::node(2, [0, 1, 0, 2, 3, 0, 0, 1].map(Tree::leaf));
    let mut tree = Tree::node(1, [0, 1, 2, 3, 3, 2, 1, 0].map(Tree::leaf));
    tree.children[1] = inner();
    tree.children[6] = inner();
    tree
}

/// Small files of different shapes.
static SMALL_FILES: LazyLock<[Vec<u8>; 6]> = LazyLock::new(|| {
    let palette = palette();
    let compressed = Settings { compression: Compression::Zstandard, ..Settings::PLAIN };
    let cut = |cut_level, settings| Settings { cut_level, ..settings };
    [
        tree().file_v5(&palette, cut(0, Settings::PLAIN)),
        plain_file(),
        tree().file_v5(&palette, cut(2, compressed)),
        tree().file_v5(&palette, Settings { normal_code: NormalCode::Octahedral, ..cut(0, compressed) }),
        Tree::leaf(3).file_v5(&palette, Settings::PLAIN),
        Tree::leaf(0).file_v5(&octvox_format::Palette::default(), Settings::PLAIN),
    ]
});

/// A file that compression makes shorter: every section of it is compressed.
fn compressed_file() -> Vec<u8> {
    fn full(level: u8) -> Tree {
        if level == 4 { Tree::leaf(1) } else { Tree { children: vec![full(level + 1); 8], ..Tree::leaf(2) } }
    }
    full(0).file_v5(&palette(), Settings { compression: Compression::Zstandard, ..Settings::PLAIN })
}

fn plain_file() -> Vec<u8> {
    tree().file_v5(&palette(), Settings { cut_level: 1, ..Settings::PLAIN })
}

/// Reads a file from its beginning to its end.
fn stream(file: &[u8]) -> Result<Summary, FormatError> {
    summarize(Reader::new(file)?).map(|(summary, _)| summary)
}

/// Reads a file in every way that an archive offers.
fn search(file: &[u8]) -> Result<Vec<Record>, FormatError> {
    let archive = Archive::of_bytes(file)?;
    let depth = archive.header().depth;
    for number in 0..archive.subtree_count() {
        archive.subtree(number)?;
        archive.subtree_down_to(number, depth / 2)?;
    }
    archive.records_down_to(depth / 2).try_for_each(|record| record.map(|_| ()))?;
    archive.records().collect()
}

/// What is read from a file, written again.
fn rewrite(file: &[u8]) -> Result<Vec<u8>, FormatError> {
    let archive = Archive::of_bytes(file)?;
    let mut writer = Writer::new(Vec::new(), archive.header(), archive.materials())?;
    let encoder = writer.encoder();
    for number in 0..archive.subtree_count() {
        writer.subtree(&encoder.encode(&archive.subtree(number)?)?)?;
    }
    writer.finish(archive.top())
}

/// The file with other bytes from a place on, and right checksums.
fn changed(file: &[u8], place: usize, bytes: &[u8]) -> Vec<u8> {
    let mut file = file.to_vec();
    file[place..place + bytes.len()].copy_from_slice(bytes);
    repair(&mut file);
    file
}

#[test]
fn repairing_an_undamaged_file_changes_nothing() {
    for file in SMALL_FILES.iter().chain([&compressed_file()]) {
        assert_eq!(changed(file, 0, b"M"), *file);
    }
}

#[test]
fn every_truncation_is_an_error_at_the_end_of_the_file() {
    for file in SMALL_FILES.iter().chain([&compressed_file()]) {
        stream(file).unwrap();
        search(file).unwrap();
        for length in 0..file.len() {
            let cut = &file[..length];
            let (FormatError::TruncatedHeader { offset, missing, .. }
            | FormatError::TruncatedSection { offset, missing, .. }) = stream(cut).unwrap_err()
            else {
                panic!("{length}")
            };
            assert_eq!(offset, length as u64);
            assert!(missing > 0);
            search(cut).unwrap_err();
        }
    }
}

#[test]
fn every_changed_byte_is_noticed() {
    for file in SMALL_FILES.iter().chain([&compressed_file()]) {
        for place in 0..file.len() {
            for change in [1, 16, 128, 255] {
                let mut changed = file.clone();
                changed[place] ^= change;
                assert!(stream(&changed).is_err(), "byte {place}");
                // An archive does not look between what it is asked for, but everything has been asked for.
                assert!(search(&changed).is_err(), "byte {place}");
            }
        }
    }
}

/// What a checksum does not notice, as somebody has computed it anew.
#[test]
fn a_changed_byte_with_a_right_checksum_gives_an_error_or_another_file() {
    let mut files = 0;
    for file in SMALL_FILES.iter() {
        for place in 0..file.len() {
            for change in [1, 2, 7, 16, 128, 255] {
                let mut changed = file.clone();
                changed[place] ^= change;
                repair(&mut changed);
                // A stream is compared with everything that is said of it, an archive only with what is needed.
                let streamed = stream(&changed);
                let Ok(records) = search(&changed) else {
                    assert!(streamed.is_err(), "byte {place}");
                    continue;
                };
                let again = rewrite(&changed).unwrap();
                assert_eq!(search(&again).unwrap(), records);
                assert_eq!(rewrite(&again).unwrap(), again);
                files += usize::from(streamed.is_ok());
            }
        }
    }
    assert!(files > 1000, "{files}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn several_changes_with_right_checksums_do_no_harm(
        number in 0_usize..6,
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
    ) {
        let mut file = SMALL_FILES[number].clone();
        let length = file.len();
        for (place, byte) in &changes {
            file[place.index(length)] = *byte;
        }
        repair(&mut file);
        let streamed = stream(&file);
        prop_assert!(search(&file).is_ok() || streamed.is_err());
    }

    #[test]
    fn arbitrary_bytes_do_no_harm(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let behind_header = [&plain_file()[..96], &bytes].concat();
        for file in [[b"MB\x05\x00", &bytes[..]].concat(), behind_header] {
            prop_assert!(stream(&file).is_err());
            prop_assert!(search(&file).is_err());
            prop_assert!(AnyReader::new(&file[..]).and_then(AnyReader::summarize).is_err());
        }
    }
}

/// Both ways of reading end in the same kind of error.
macro_rules! assert_damaged {
    ($file:expr, $error:pat $(if $guard:expr)?) => {
        let file: &[u8] = &$file;
        for error in [stream(file).unwrap_err(), search(file).unwrap_err()] {
            assert!(matches!(error, $error $(if $guard)?), "{error:?}");
        }
    };
}

#[test]
fn fields_of_the_header_have_bounds() {
    let file = plain_file();
    assert_damaged!(changed(&file, 2, &[6]), FormatError::UnsupportedVersion { version: 6 });
    assert_damaged!(changed(&file, 2, &[4]), FormatError::UnsupportedVersion { version: 4 });
    assert_damaged!(changed(&file, 4, &[24]), FormatError::TooDeep { offset: 4, max_depth: 23 });
    assert_damaged!(
        changed(&file, 5, &[3]),
        FormatError::FieldOutOfRange { offset: 5, value: 3, limit: 2, .. }
    );
    assert_damaged!(changed(&file, 6, &[2]), FormatError::FieldOutOfRange { offset: 6, .. });
    assert_damaged!(changed(&file, 7, &[2]), FormatError::FieldOutOfRange { offset: 7, .. });
    assert_damaged!(changed(&file, 12, &[1]), FormatError::FieldOutOfRange { offset: 12, .. });
    assert_damaged!(changed(&file, 47, &[0xFF]), FormatError::ImpossibleWorld { .. });
    assert_damaged!(changed(&file, 48, &[0xFF]), FormatError::DamagedField { offset: 48, .. });
    assert_damaged!(changed(&file, 48, &[0]), FormatError::WriterName { .. });
    assert_damaged!(
        changed(&file, 8, &[2]),
        FormatError::FieldOutOfRange { offset: 116, value: 3, limit: 2, .. }
    );
}

#[test]
fn sections_are_in_order() {
    let file = plain_file();
    let first = sections(&file)[1];
    assert_damaged!(
        changed(&file, first, b"WHAT"),
        FormatError::UnknownSection { found: [b'W', b'H', b'A', b'T'], .. }
    );
    assert_damaged!(changed(&file, first, b"MATL"), FormatError::UnexpectedSection { .. });
    assert_damaged!(changed(&file, first + 26, &[2]), FormatError::FieldOutOfRange { .. });
    assert_damaged!(changed(&file, first + 27, &[1]), FormatError::FieldOutOfRange { .. });
    assert_damaged!(
        changed(&file, first + 24, &[1, 1]),
        FormatError::FieldOutOfRange { value: 257, limit: 256, .. }
    );
    // Not compressed, although it says so.
    assert_damaged!(changed(&file, first + 26, &[1]), FormatError::Decompression { .. });
}

#[test]
fn masks_and_voxels_fit_together() {
    let file = plain_file();
    let start = sections(&file)[1];
    let defect = |file: &[u8]| {
        let Err(FormatError::DamagedLevels { offset, section: "subtree", defect }) = stream(file) else {
            panic!("{:?}", stream(file))
        };
        assert_eq!(offset, start as u64);
        assert!(search(file).is_err());
        defect
    };
    // The first subtree: a root with four children, of the materials 1 to 3. Behind the table the mask of the root.
    let mask = start + HEAD + 6;
    assert_eq!(file[start..mask][HEAD..], [1, 0, 2, 0, 3, 0]);
    assert_eq!(file[mask], 0b1001_1010);
    let one_more = defect(&changed(&file, mask, &[0b1001_1011]));
    assert_eq!(one_more, LevelDefect::VoxelCount { level: 2, named: 6, found: 5 });
    let one_less = defect(&changed(&file, mask, &[0b1000_1010]));
    assert_eq!(one_less, LevelDefect::VoxelCount { level: 2, named: 4, found: 5 });
    // Entry 3 of a table of three.
    assert_eq!(defect(&changed(&file, mask + 1, &[3])), LevelDefect::EmptyVoxel);
    let beyond = defect(&changed(&file, start + HEAD, &[4]));
    assert_eq!(beyond, LevelDefect::PaletteIndex { index: 4, materials: 3 });
    // Three masks more take as many bytes as one voxel less.
    let mut masks_for_voxel = changed(&file, start + 16, &[4, 0, 0, 0, 4]);
    masks_for_voxel = changed(&masks_for_voxel, mask, &[0b1000_1010]);
    assert_eq!(defect(&masks_for_voxel), LevelDefect::MaskCount { voxels: 1, found: 4 });
}

#[test]
fn a_subtree_without_voxels_is_refused() {
    let file = Tree::leaf(3).file_v5(&palette(), Settings::PLAIN);
    let start = sections(&file)[1];
    let mut empty = file.clone();
    empty.drain(start + HEAD..start + HEAD + 4);
    empty[start + 4] = 0;
    empty[start + 20] = 0;
    empty[start + 24] = 0;
    repair(&mut empty);
    assert!(matches!(stream(&empty), Err(FormatError::DamagedLevels { defect: LevelDefect::NoVoxels, .. })));
}

#[test]
fn subtrees_are_those_that_the_top_names() {
    let file = plain_file();
    let starts = sections(&file);
    assert_damaged!(
        changed(&file, starts[1] + 8, &[9]),
        FormatError::SubtreeCode { code: 9, .. } | FormatError::WrongIndex { .. }
    );
    assert!(matches!(stream(&changed(&file, starts[2] + 8, &[1])), Err(FormatError::SubtreeOrder { .. })));
    let top = starts[starts.len() - 2];
    assert_eq!(file[top..top + 4], *b"TOP ");
    // Behind a table of one entry.
    assert_eq!(file[top + HEAD + 2], 0b0111_1110);
    assert_damaged!(
        changed(&file, top + HEAD + 2, &[0b1111_1110]),
        FormatError::TopSubtrees { named: 7, found: 6, place: 0, .. }
    );
    assert_damaged!(
        changed(&file, top + HEAD + 2, &[0b1011_1110]),
        FormatError::TopSubtrees { named: 6, found: 6, place: 5, .. }
    );
}

#[test]
fn index_and_trailer_agree_with_the_sections() {
    let file = plain_file();
    let index = *sections(&file).last().unwrap();
    let counts = index + HEAD;
    let entries = counts + 3 * 16;
    // An archive believes how many voxels are on a level, as it does not read them all.
    let wrong_count = changed(&changed(&file, counts, &[2]), file.len() - 12, &[16]);
    assert_eq!(Archive::of_bytes(&file).unwrap().index().voxels(), 15);
    let Err(FormatError::WrongCount { level: 0, found: 1, told: 2, .. }) = stream(&wrong_count) else {
        panic!("{:?}", stream(&wrong_count))
    };
    assert_damaged!(
        changed(&file, entries + 8, &[0]),
        FormatError::WrongIndex { place: 0, .. } | FormatError::Gap { .. }
    );
    assert_damaged!(changed(&file, entries + 32 + 24, &[99]), FormatError::WrongIndex { place: 1, .. });
    let trailer = file.len() - 36;
    assert_damaged!(changed(&file, trailer, b"ENDE"), FormatError::NoTrailer { .. });
    assert_damaged!(changed(&file, trailer + 4, &[5]), FormatError::WrongTrailer { told: 5, found: 6, .. });
    assert_damaged!(changed(&file, trailer + 24, &[5]), FormatError::WrongTrailer { told: 5, found: 15, .. });
    assert!(
        stream(&changed(&file, trailer + 8, &[1])).is_err()
            && search(&changed(&file, trailer + 8, &[1])).is_err()
    );
}

#[test]
fn bytes_behind_the_end_are_an_error() {
    let file = [&plain_file()[..], &[0]].concat();
    let Err(FormatError::TrailingBytes { offset }) = stream(&file) else { panic!() };
    assert_eq!(offset as usize, file.len() - 1);
    assert!(matches!(search(&file), Err(FormatError::NoTrailer { .. })));
    // Between two sections, where only the places tell.
    let mut file = plain_file();
    let trailer = file.len() - 36;
    file.splice(trailer..trailer, *b"hidden");
    assert!(stream(&file).is_err());
    assert!(matches!(search(&file), Err(FormatError::Gap { .. })));
}

#[test]
fn limits_hold() {
    let file =
        tree().file_v5(&palette(), Settings { normal_code: NormalCode::Octahedral, ..Settings::PLAIN });
    let read = |limits| -> [Result<(), FormatError>; 2] {
        let streamed = Reader::with_limits(&file[..], limits).and_then(|mut reader| {
            let decoder = reader.decoder();
            while let Some(subtree) = reader.next_subtree()? {
                decoder.decode(&subtree)?;
            }
            reader.finish().map(|_| ())
        });
        let searched = Archive::with_limits(&file[..], limits).and_then(|archive| {
            (0..archive.subtree_count()).try_for_each(|number| archive.subtree(number).map(|_| ()))
        });
        [streamed, searched]
    };
    let limits = Limits { max_depth: 2, max_records: 15, max_section_bytes: 48 + 14 * 32 };
    assert!(read(limits).iter().all(Result::is_ok));
    for result in read(Limits { max_depth: 1, ..limits }) {
        assert!(matches!(result, Err(FormatError::TooDeep { offset: 4, max_depth: 1 })));
    }
    for result in read(Limits { max_records: 14, ..limits }) {
        assert!(matches!(result, Err(FormatError::TooManyRecords { max_records: 14, .. })));
    }
    for result in read(Limits { max_section_bytes: 119, ..limits }) {
        assert!(matches!(
            result,
            Err(FormatError::SectionTooLarge { section: "material palette", bytes: 120, .. })
        ));
    }
}

/// A section that tells more than what it is compressed to can hold must not take memory for it.
#[test]
fn a_short_section_cannot_demand_much_memory() {
    let mut file = compressed_file();
    let start = sections(&file)[1];
    assert_eq!((&file[start..start + 4], file[start + 26]), (&b"TREE"[..], 1));
    // As many masks and voxels as can be told.
    file[start + 16..start + 24].fill(0xFF);
    repair(&mut file);
    assert!(matches!(stream(&file), Err(FormatError::SectionTooLarge { bytes: 12_884_901_887.., .. })));
    // A little less than the limit, which the frame does not hold.
    file[start + 16..start + 24].copy_from_slice(&[0, 0, 0, 10, 0, 0, 0, 10]);
    repair(&mut file);
    assert!(matches!(stream(&file), Err(FormatError::Decompression { .. })));
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
    let file = plain_file();
    for length in 0..=file.len() {
        let result = Reader::new(Failing(&file[..length])).and_then(summarize);
        let Err(FormatError::Read { offset, source }) = result else { panic!("{length}") };
        assert_eq!((offset, source.kind()), (length as u64, ErrorKind::PermissionDenied));
    }
}

/// A file that becomes shorter while it is read.
struct Shrinking<'a>(&'a [u8]);

impl Source for Shrinking<'_> {
    fn byte_length(&self) -> io::Result<u64> {
        Ok(self.0.len() as u64)
    }

    fn bytes_at(&self, offset: u64, length: usize) -> io::Result<std::borrow::Cow<'_, [u8]>> {
        let is_subtree = offset > 300 && offset < 400;
        if is_subtree {
            Err(ErrorKind::UnexpectedEof.into())
        } else {
            self.0.bytes_at(offset, length).map(|bytes| bytes.into_owned().into())
        }
    }
}

#[test]
fn records_end_after_an_error() {
    let file = plain_file();
    let archive = Archive::with_limits(Shrinking(&file), Limits::default()).unwrap();
    let results: Vec<_> = archive.records().collect();
    assert!(results.len() > 1);
    let (last, others) = results.split_last().unwrap();
    assert!(matches!(last, Err(FormatError::Read { .. })));
    assert!(others.iter().all(Result::is_ok));
}

#[test]
fn what_is_not_there_is_not_found() {
    let file = plain_file();
    let archive = Archive::with_limits(Seekable::new(Cursor::new(&file)), Limits::default()).unwrap();
    assert!(matches!(archive.subtree(6), Err(FormatError::NoSubtree { number: 6, count: 6 })));
    assert_eq!(archive.materials(), &MaterialPalette::from(&palette()));
}

#[test]
fn nothing_follows_an_error() {
    let file = plain_file();
    let start = sections(&file)[2];
    let mut damaged = file.clone();
    damaged[start + HEAD] ^= 1;
    let mut reader = Reader::new(&damaged[..]).unwrap();
    assert!(reader.next_subtree().unwrap().is_some());
    assert!(matches!(reader.next_subtree(), Err(FormatError::ChecksumMismatch { section: "subtree", .. })));
    assert!(reader.next_subtree().unwrap().is_none());
    assert!(matches!(reader.finish(), Err(FormatError::AfterError { .. })));
}
