//! Any bytes as a file of version 4: an error, or a file that comes back when it is written again, and that goes through
//! version 5 if it makes sense.

#![no_main]

use libfuzzer_sys::fuzz_target;
use octvox_format::v5::{Archive, Header};
use octvox_format::{Limits, NormalCode, Palette, Reader, Record, Voxel, Writer, summarize, to_version_5};
use std::io::Cursor;

fuzz_target!(|bytes: &[u8]| {
    let Some((palette, records)) = read(bytes) else { return };
    let written = write(&palette, &records);
    let voxels = 8 + 3 * palette.len();
    assert_eq!(written[..voxels - 2], bytes[..voxels - 2]);
    assert_eq!(written[voxels..], bytes[voxels..]);

    let summary = summarize(Reader::new(bytes).unwrap()).unwrap();
    assert_eq!(summary.stored_voxels, records.len() as u64);
    let header = |depth: u8| Header {
        cut_level: bytes[0] % (depth + 1).min(Header::MAX_CUT_LEVEL),
        normal_code: NormalCode::Spherical,
        ..Header::new(depth)
    };
    let converted = to_version_5(Cursor::new(bytes), Vec::new(), header);
    assert_eq!(converted.is_ok(), summary.is_valid());
    if let Ok(file) = converted {
        let archive = Archive::of_bytes(&file).unwrap();
        let found: Vec<Record> = archive.records().map(Result::unwrap).collect();
        // What is empty has no normal in version 5.
        let without_normal = |voxel: Voxel| if voxel.is_empty() { Voxel::EMPTY } else { voxel };
        let expected =
            records.into_iter().map(|record| Record { voxel: without_normal(record.voxel), ..record });
        assert!(found.into_iter().eq(expected));
    }
});

fn read(bytes: &[u8]) -> Option<(Palette, Vec<Record>)> {
    let mut reader = Reader::with_limits(bytes, Limits { max_records: 1 << 16, ..Limits::default() }).ok()?;
    let records = reader.by_ref().collect::<Result<_, _>>().ok()?;
    Some((reader.into_palette(), records))
}

fn write(palette: &Palette, records: &[Record]) -> Vec<u8> {
    let mut writer = Writer::new(Vec::new(), palette).unwrap();
    for record in records {
        if record.has_children { writer.node(record.voxel) } else { writer.leaf(record.voxel) }.unwrap();
    }
    writer.finish().unwrap()
}
