//! Volumes as arrays of NumPy: a head in text, then the cells (`numpy.lib.format`, version 1.0).

use super::raw::finish;
use super::runs::{Order, Runs};
use super::volume::write_cells;
use super::{Cells, Leaf, Volume};
use crate::{FormatError, MaterialPalette};
use std::io::{BufWriter, Write};

/// The head, together with what stands before it, is a multiple of so many bytes.
const ALIGNMENT: usize = 64;

/// Writes a volume as an array, and returns the output: `array[x, y, z]`, or `array[x, y, z, channel]` for
/// [`Cells::Rgba`], in C order.
///
/// # Errors
/// As [`write_raw`](super::write_raw).
pub fn write_npy<W: Write>(
    volume: Volume<impl Iterator<Item = Result<Leaf, FormatError>>>,
    cells: Cells,
    materials: &MaterialPalette,
    output: W,
) -> Result<W, FormatError> {
    volume.check(cells.byte_length())?;
    let runs = Runs::new(volume, Order::Xyz)?;
    let mut output = BufWriter::new(output);
    output
        .write_all(&head(runs.resolution(), cells))
        .map_err(|source| FormatError::Write { offset: 0, source })?;
    write_cells(&runs, cells, materials, &mut output)?;
    finish(output)
}

fn head(side: u64, cells: Cells) -> Vec<u8> {
    let [name, axes] = match cells {
        Cells::Index8 => ["|u1", ""],
        Cells::Index16 => ["<u2", ""],
        Cells::Rgba => ["|u1", ", 4"],
    };
    let mut text =
        format!("{{'descr': '{name}', 'fortran_order': False, 'shape': ({side}, {side}, {side}{axes}), }}");
    const BEFORE: usize = 10;
    let length = (BEFORE + text.len() + 1).next_multiple_of(ALIGNMENT) - BEFORE;
    text += &" ".repeat(length - text.len() - 1);
    text.push('\n');
    let mut head = b"\x93NUMPY\x01\x00".to_vec();
    // Hardly more than a hundred.
    head.extend((text.len() as u16).to_le_bytes());
    head.extend(text.as_bytes());
    head
}
