//! Any bytes as a file of this kind: an error, or a mesh whose voxels make sense.

#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| octvox_converter_fuzz::check("model.stl", bytes));
