//! Volumes without anything around them.

use super::runs::{Order, Runs};
use super::volume::write_cells;
use super::{Cells, Leaf, Volume};
use crate::{FormatError, MaterialPalette};
use std::io::{BufWriter, Write};

/// Writes the cells of a volume one after the other, and returns the output. Neighbours along x stand side by side, and the
/// coordinate along z changes least often.
///
/// # Errors
/// [`ExchangeError::VolumeTooLarge`](super::ExchangeError::VolumeTooLarge) or
/// [`ExchangeError::TooManyForBytes`](super::ExchangeError::TooManyForBytes); the first error of the leaves;
/// [`FormatError::Write`].
pub fn write_raw<W: Write>(
    volume: Volume<impl Iterator<Item = Result<Leaf, FormatError>>>,
    cells: Cells,
    materials: &MaterialPalette,
    output: W,
) -> Result<W, FormatError> {
    volume.check(cells.byte_length())?;
    let runs = Runs::new(volume, Order::Zyx)?;
    let mut output = BufWriter::new(output);
    write_cells(&runs, cells, materials, &mut output)?;
    finish(output)
}

/// The output, to which everything has been written.
pub(super) fn finish<W: Write>(output: BufWriter<W>) -> Result<W, FormatError> {
    output.into_inner().map_err(|failure| FormatError::Write { offset: 0, source: failure.into_error() })
}
