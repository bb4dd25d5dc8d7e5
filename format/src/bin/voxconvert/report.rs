//! The object that `--json` prints.

use crate::arguments::Target;
use crate::input::{Input, InputKind};
use octvox_cli::peak_memory_bytes;
use serde::Serialize;
use std::time::Duration;

#[derive(Serialize)]
pub struct Report {
    /// `version 4`, `version 5` or `magicavoxel`.
    input: &'static str,
    /// The same, or `binvox`, `npy`, `raw`.
    output: &'static str,
    depth: u8,
    pub resolution: u32,
    palette_size: usize,
    input_bytes: u64,
    file_bytes: u64,
    peak_memory_bytes: Option<u64>,
    seconds: f64,
}

impl Report {
    pub fn new(input: &Input, target: Target, depth: u8, file_bytes: u64, elapsed: Duration) -> Self {
        Self {
            input: match input.kind() {
                InputKind::Version4 => "version 4",
                InputKind::Version5 => "version 5",
                InputKind::MagicaVoxel => "magicavoxel",
            },
            output: target.name(),
            depth,
            resolution: 1 << depth,
            palette_size: input.materials().len(),
            input_bytes: input.byte_length(),
            file_bytes,
            peak_memory_bytes: peak_memory_bytes(),
            seconds: elapsed.as_secs_f64(),
        }
    }
}
