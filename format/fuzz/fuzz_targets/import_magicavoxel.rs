//! Any bytes as a file of MagicaVoxel: an error, or an octree that makes sense and goes out and in again.

#![no_main]

use libfuzzer_sys::fuzz_target;
use octvox_format::AnyReader;
use octvox_format::exchange::Leaves;
use octvox_format::exchange::magicavoxel::{export, import};
use octvox_format::v5::Archive;

fuzz_target!(|bytes: &[u8]| {
    let Ok(file) = import(bytes) else { return };
    let summary = AnyReader::new(&file[..]).and_then(AnyReader::summarize).unwrap();
    assert!(summary.is_valid());
    let archive = Archive::of_bytes(&file).unwrap();
    let depth = archive.header().depth;
    let Ok(exported) = export(Leaves::new(archive.records()), depth, archive.materials(), Vec::new()) else {
        assert!(depth > 11);
        return;
    };
    let again = import(&exported).unwrap();
    let counted = AnyReader::new(&again[..]).and_then(AnyReader::summarize).unwrap();
    assert_eq!(counted.leaf_voxels, summary.leaf_voxels);
});
