//! From a stream of voxels to a file.

use crate::preorder::Cursor;
use crate::voxel::VOXEL_BYTES;
use crate::{FormatError, Limits, Palette, Voxel, header};
use std::io::{BufWriter, Write};

/// Bytes that are written at once.
const BLOCK_BYTES: usize = 1 << 18;

/// Writes a file voxel by voxel, in preorder, in constant memory.
///
/// Each call adds the next voxel: [`node`](Writer::node) one whose eight children follow, [`leaf`](Writer::leaf) and
/// [`empty`](Writer::empty) one without. A call that does not fit is an error and writes nothing.
/// The file is complete only after [`finish`](Writer::finish).
#[derive(Debug)]
#[must_use = "a file is complete only after `finish`"]
pub struct Writer<W: Write> {
    output: BufWriter<W>,
    /// Where the voxels begin, in bytes.
    header_length: u64,
    last_index: u16,
    cursor: Cursor,
    records: u64,
}

impl<W: Write> Writer<W> {
    /// Begins a file with this palette. `output` need not be buffered.
    ///
    /// # Errors
    /// [`FormatError::Write`] if the header cannot be written.
    pub fn new(output: W, palette: &Palette) -> Result<Self, FormatError> {
        let mut output = BufWriter::with_capacity(BLOCK_BYTES, output);
        header::write(&mut output, palette).map_err(|source| FormatError::Write { offset: 0, source })?;
        Ok(Self {
            output,
            header_length: header::length(palette),
            last_index: palette.last_index(),
            cursor: Cursor::new(),
            records: 0,
        })
    }

    /// Adds a voxel whose children follow: eight, each with its whole subtree.
    ///
    /// # Errors
    /// [`FormatError::TooDeep`] if the children would be below level [`Limits::MAX_DEPTH`];
    /// and as [`Writer::leaf`].
    #[inline]
    pub fn node(&mut self, voxel: Voxel) -> Result<(), FormatError> {
        if self.cursor.level() >= Limits::MAX_DEPTH {
            return Err(FormatError::TooDeep { offset: self.offset(), max_depth: Limits::MAX_DEPTH });
        }
        self.write(voxel, true)?;
        self.cursor.descend();
        Ok(())
    }

    /// Adds a voxel without children.
    ///
    /// # Errors
    /// [`FormatError::TreeComplete`] if no voxel can follow, [`FormatError::PaletteIndexOutOfRange`] if the palette
    /// lacks the colour, [`FormatError::Write`] if the output fails.
    #[inline]
    pub fn leaf(&mut self, voxel: Voxel) -> Result<(), FormatError> {
        self.write(voxel, false)?;
        self.cursor.advance();
        Ok(())
    }

    /// Adds an empty voxel.
    ///
    /// # Errors
    /// As [`Writer::leaf`].
    #[inline]
    pub fn empty(&mut self) -> Result<(), FormatError> {
        self.leaf(Voxel::EMPTY)
    }

    /// Number of voxels added so far.
    #[must_use]
    pub fn records_written(&self) -> u64 {
        self.records
    }

    /// Ends the file and returns the output, to which everything has been written.
    ///
    /// # Errors
    /// [`FormatError::TreeIncomplete`] if voxels are missing, [`FormatError::Write`] if the output fails.
    pub fn finish(mut self) -> Result<W, FormatError> {
        let offset = self.offset();
        if !self.cursor.is_complete() {
            let missing = self.cursor.missing();
            return Err(FormatError::TreeIncomplete { offset, records: self.records, missing });
        }
        self.output.flush().map_err(|source| FormatError::Write { offset, source })?;
        self.output
            .into_inner()
            .map_err(|failure| FormatError::Write { offset, source: failure.into_error() })
    }

    fn offset(&self) -> u64 {
        self.header_length + VOXEL_BYTES * self.records
    }

    #[inline]
    fn write(&mut self, voxel: Voxel, has_children: bool) -> Result<(), FormatError> {
        if self.cursor.is_complete() {
            return Err(FormatError::TreeComplete { offset: self.offset(), records: self.records });
        }
        if voxel.palette_index > self.last_index {
            return Err(FormatError::PaletteIndexOutOfRange {
                offset: self.offset(),
                index: voxel.palette_index,
                palette_size: self.last_index,
            });
        }
        let offset = self.offset();
        self.output
            .write_all(&voxel.to_word(has_children))
            .map_err(|source| FormatError::Write { offset, source })?;
        self.records += 1;
        Ok(())
    }
}
