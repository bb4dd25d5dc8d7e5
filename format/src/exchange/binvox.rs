//! binvox (Patrick Min): a head in text, then runs of filled and empty cells. Colours have no place in it.

use super::raw::finish;
use super::runs::{Order, Runs};
use super::{Leaf, Volume};
use crate::{FormatError, WorldTransform};
use std::io::{self, BufWriter, Write};

/// Writes which cells of a volume are filled, and returns the output. Neighbours along y stand side by side, and the
/// coordinate along x changes least often. `world` is the place of the volume's own cells.
///
/// ```text
///  #binvox 1
///  dim 16 16 16
///  translate x y z        the corner with the smallest coordinates, in the world
///  scale s                length of an edge of the cube
///  data
///  { value u8, count u8 } until all cells have been named; 1 is filled, 0 is empty
/// ```
///
/// If the place in the world is not known, the cube is that from (0, 0, 0) to (1, 1, 1).
///
/// # Errors
/// [`ExchangeError::VolumeTooLarge`](super::ExchangeError::VolumeTooLarge) if the limit is not enough for the filled cells in
/// memory, or for the file, which has two bytes for each 255 cells at least; the first error of the leaves; [`FormatError::Write`].
pub fn write_binvox<W: Write>(
    volume: Volume<impl Iterator<Item = Result<Leaf, FormatError>>>,
    world: Option<WorldTransform>,
    output: W,
) -> Result<W, FormatError> {
    let cells = 1_u128 << (3 * u32::from(volume.depth.min(40)));
    volume.check_bytes(cells / u128::from(LONGEST_RUN) * 2)?;
    let runs = Runs::new(volume, Order::Xzy)?;
    let mut output = BufWriter::new(output);
    write(&runs, world, &mut output).map_err(|source| FormatError::Write { offset: 0, source })?;
    finish(output)
}

fn write(runs: &Runs, world: Option<WorldTransform>, output: &mut impl Write) -> io::Result<()> {
    let side = runs.resolution();
    let unit = WorldTransform { origin: [0.0; 3], voxel_size: 1.0 / side as f64 };
    let WorldTransform { origin: [x, y, z], voxel_size } = world.unwrap_or(unit);
    let scale = voxel_size * side as f64;
    write!(output, "#binvox 1\ndim {side} {side} {side}\ntranslate {x} {y} {z}\nscale {scale}\ndata\n")?;
    let mut filled = 0..0;
    for run in runs.runs() {
        if run.start > filled.end {
            write_run(output, 1, filled.end - filled.start)?;
            write_run(output, 0, run.start - filled.end)?;
            filled = run.start..run.start;
        }
        filled.end += u64::from(run.length);
    }
    write_run(output, 1, filled.end - filled.start)?;
    write_run(output, 0, runs.cell_count() - filled.end)
}

/// Cells that the two bytes of a run can stand for.
const LONGEST_RUN: u8 = u8::MAX;

fn write_run(output: &mut impl Write, value: u8, mut count: u64) -> io::Result<()> {
    while count > 0 {
        let now = count.min(u64::from(LONGEST_RUN)) as u8;
        output.write_all(&[value, now])?;
        count -= u64::from(now);
    }
    Ok(())
}
