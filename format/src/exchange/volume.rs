//! A value for each cell of a volume, one after the other.

use super::runs::Runs;
use super::{Cells, ExchangeError};
use crate::{FormatError, MaterialPalette};
use std::io::{self, Write};

/// The cells of an octree at one of its levels, filled or not.
#[derive(Debug, Clone)]
pub struct Volume<I> {
    /// The filled ones, [`Leaves`](super::Leaves), none of them below the level `depth`.
    pub leaves: I,
    /// The level: the volume has `1 << depth` cells along each axis.
    pub depth: u8,
    /// Neither what is made of the volume nor the memory for it may take more bytes.
    pub max_bytes: u64,
}

impl<I> Volume<I> {
    /// Whether a value of so many bytes for each cell is within the limit.
    pub(crate) fn check(&self, cell_bytes: usize) -> Result<(), ExchangeError> {
        self.check_bytes((cell_bytes as u128) << (3 * self.depth.min(40)))
    }

    /// Whether so many bytes are within the limit.
    pub(crate) fn check_bytes(&self, bytes: u128) -> Result<(), ExchangeError> {
        if bytes > u128::from(self.max_bytes) {
            return Err(ExchangeError::VolumeTooLarge {
                resolution: 1 << self.depth.min(40),
                bytes,
                limit: self.max_bytes,
            });
        }
        Ok(())
    }
}

/// Bytes that are written at once.
const BLOCK_BYTES: usize = 1 << 16;

/// Writes the cells of a volume, which has been found to be within its limit.
pub(crate) fn write_cells(
    runs: &Runs,
    cells: Cells,
    materials: &MaterialPalette,
    output: &mut impl Write,
) -> Result<(), FormatError> {
    let table = cells.table(materials)?;
    let write =
        |place: u64, source| FormatError::Write { offset: place * cells.byte_length() as u64, source };
    let mut place = 0;
    for run in runs.runs() {
        repeat(output, &[0; 4][..cells.byte_length()], run.start - place)
            .map_err(|error| write(place, error))?;
        // A palette index that the palette does not have cannot have come out of a reader.
        let value = table.get(usize::from(run.palette_index)).copied().unwrap_or_default();
        repeat(output, &value[..cells.byte_length()], u64::from(run.length))
            .map_err(|error| write(run.start, error))?;
        place = run.start + u64::from(run.length);
    }
    repeat(output, &[0; 4][..cells.byte_length()], runs.cell_count() - place)
        .map_err(|error| write(place, error))
}

/// Writes a value so many times.
fn repeat(output: &mut impl Write, value: &[u8], count: u64) -> io::Result<()> {
    if count == 1 {
        return output.write_all(value);
    }
    let in_block = (BLOCK_BYTES / value.len()) as u64;
    let block = value.repeat(count.min(in_block) as usize);
    let mut left = count;
    while left > 0 {
        let now = left.min(in_block);
        output.write_all(&block[..now as usize * value.len()])?;
        left -= now;
    }
    Ok(())
}
