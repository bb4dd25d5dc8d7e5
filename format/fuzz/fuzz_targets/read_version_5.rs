//! Any bytes as a file of version 5: an error, or a file that says the same when it is written again. The bytes are read as
//! they are and with right checksums, without which a fuzzer hardly ever gets past them.

#![no_main]

use libfuzzer_sys::fuzz_target;
use octvox_format::v5::{Archive, Reader, Subtree, Writer};
use octvox_format::{FormatError, Limits, Record};

#[path = "../../tests/common/checksums.rs"]
#[allow(dead_code, reason = "the tests use more of it")]
mod checksums;

const LIMITS: Limits = Limits { max_depth: 23, max_records: 1 << 18, max_section_bytes: 1 << 22 };

fuzz_target!(|bytes: &[u8]| {
    examine(bytes);
    let mut repaired = bytes.to_vec();
    checksums::repair(&mut repaired);
    examine(&repaired);
});

fn examine(file: &[u8]) {
    let streamed = stream(file);
    let Ok((subtrees, records)) = search(file) else {
        assert!(streamed.is_err());
        return;
    };
    if let Ok(streamed) = streamed {
        assert_eq!(streamed, subtrees);
    }
    let again = rewrite(file).unwrap();
    assert_eq!(search(&again).unwrap(), (subtrees, records));
    assert_eq!(rewrite(&again).unwrap(), again);
}

fn stream(file: &[u8]) -> Result<Vec<Subtree>, FormatError> {
    let mut reader = Reader::with_limits(file, LIMITS)?;
    let decoder = reader.decoder();
    let mut subtrees = Vec::new();
    while let Some(stored) = reader.next_subtree()? {
        subtrees.push(decoder.decode(&stored)?);
    }
    reader.finish()?;
    Ok(subtrees)
}

fn search(file: &[u8]) -> Result<(Vec<Subtree>, Vec<Record>), FormatError> {
    let archive = Archive::with_limits(file, LIMITS)?;
    let mut subtrees = Vec::new();
    for number in 0..archive.subtree_count() {
        let subtree = archive.subtree(number)?;
        let level = archive.header().depth / 2;
        assert_eq!(archive.subtree_down_to(number, level)?.levels, subtree.levels.down_to(level));
        subtrees.push(subtree);
    }
    let records = archive.records().collect::<Result<_, _>>()?;
    Ok((subtrees, records))
}

fn rewrite(file: &[u8]) -> Result<Vec<u8>, FormatError> {
    let archive = Archive::with_limits(file, LIMITS)?;
    let mut writer = Writer::new(Vec::new(), archive.header(), archive.materials())?;
    let encoder = writer.encoder();
    for number in 0..archive.subtree_count() {
        writer.subtree(&encoder.encode(&archive.subtree(number)?)?)?;
    }
    writer.finish(archive.top())
}
