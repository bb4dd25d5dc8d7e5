//! From a file of version 4 to a stream of records.

use crate::preorder::Cursor;
use crate::voxel::VOXEL_BYTES;
use crate::{FormatError, Limits, Palette, Record, Voxel, header};
use std::io::{BufRead, BufReader, ErrorKind, Read};

/// Bytes that are read at once: few system calls, and the block stays in the second-level cache.
const BLOCK_BYTES: usize = 1 << 18;

/// Reads a file of version 4 as an iterator over its records, in preorder, in constant memory.
///
/// The iterator ends with `None` if the octree is complete and the file ends with it. It ends after the first error.
#[derive(Debug)]
pub struct Reader<R: Read> {
    input: BufReader<R>,
    palette: Palette,
    limits: Limits,
    cursor: Cursor,
    /// Records handed out.
    records: u64,
    /// No record comes any more.
    ended: bool,
    /// Why no record comes any more, until the iterator has said so.
    error: Option<FormatError>,
}

impl<R: Read> Reader<R> {
    /// Reads and checks the header. `input` need not be buffered.
    ///
    /// # Errors
    /// A [`FormatError`] if the file is of another kind or version, its palette is too large, or it ends in the header.
    pub fn new(input: R) -> Result<Self, FormatError> {
        Self::with_limits(input, Limits::default())
    }

    /// As [`Reader::new`], with bounds on what follows the header.
    ///
    /// # Errors
    /// As [`Reader::new`]. A limit that is reached is an error of the iterator.
    pub fn with_limits(input: R, limits: Limits) -> Result<Self, FormatError> {
        let mut input = BufReader::with_capacity(BLOCK_BYTES, input);
        let palette = header::read(&mut input)?;
        let limits = Limits { max_depth: limits.max_depth.min(Limits::MAX_DEPTH), ..limits };
        Ok(Self { input, palette, limits, cursor: Cursor::new(), records: 0, ended: false, error: None })
    }

    /// The colours of the file.
    #[must_use]
    pub fn palette(&self) -> &Palette {
        &self.palette
    }

    /// The colours of the file, after or instead of its records.
    #[must_use]
    pub fn into_palette(self) -> Palette {
        self.palette
    }

    /// Bytes from the beginning of the file to the next record; after the last record, the length of the file.
    #[must_use]
    pub fn offset(&self) -> u64 {
        header::length(&self.palette) + VOXEL_BYTES * self.records
    }

    /// The next record, or `None` with the reason in `self.error`.
    ///
    /// A `Result` would be assembled in memory byte by byte and read back as a whole, which stalls: it costs two
    /// thirds of the speed. An `Option<Record>` stays in a register.
    #[inline]
    fn next_record(&mut self) -> Option<Record> {
        if self.ended || self.cursor.is_complete() {
            return self.end();
        }
        if self.records >= self.limits.max_records {
            return self.fail(|offset, reader| {
                let max_records = reader.limits.max_records;
                FormatError::TooManyRecords { offset, max_records }
            });
        }
        let (voxel, has_children) = Voxel::from_word(self.next_word()?);
        if voxel.palette_index > self.palette.last_index() {
            return self.fail(|offset, reader| {
                let palette_size = reader.palette.last_index();
                FormatError::PaletteIndexOutOfRange { offset, index: voxel.palette_index, palette_size }
            });
        }
        let record = Record { level: self.cursor.level(), octant: self.cursor.octant(), voxel, has_children };
        if has_children {
            if record.level >= self.limits.max_depth {
                return self.fail(|offset, reader| {
                    let max_depth = reader.limits.max_depth;
                    FormatError::TooDeep { offset, max_depth }
                });
            }
            self.cursor.descend();
        } else {
            self.cursor.advance();
        }
        self.records += 1;
        Some(record)
    }

    /// The next four bytes, from the block if they are in it.
    #[inline]
    fn next_word(&mut self) -> Option<[u8; 4]> {
        if let Some(&word) = self.input.buffer().first_chunk() {
            self.input.consume(word.len());
            return Some(word);
        }
        self.next_word_across_blocks()
    }

    /// The next four bytes where a block ends.
    #[cold]
    fn next_word_across_blocks(&mut self) -> Option<[u8; 4]> {
        let mut word = [0; 4];
        let mut filled = 0;
        while filled < word.len() {
            match self.input.read(&mut word[filled..]) {
                Ok(0) => {
                    return self.fail(|offset, reader| {
                        let missing = reader.cursor.missing();
                        FormatError::TruncatedVoxels { offset: offset + filled as u64, missing }
                    });
                }
                Ok(count) => filled += count,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(source) => {
                    return self
                        .fail(|offset, _| FormatError::Read { offset: offset + filled as u64, source });
                }
            }
        }
        Some(word)
    }

    /// What follows the last record must be the end of the file.
    #[cold]
    fn end(&mut self) -> Option<Record> {
        while !self.ended {
            match self.input.fill_buf() {
                Ok([]) => self.ended = true,
                Ok(_) => return self.fail(|offset, _| FormatError::TrailingBytes { offset }),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(source) => return self.fail(|offset, _| FormatError::Read { offset, source }),
            }
        }
        None
    }

    /// Ends the iterator with an error, which is made from the offset of the next record.
    #[cold]
    #[inline(never)]
    fn fail<T>(&mut self, error: impl FnOnce(u64, &Self) -> FormatError) -> Option<T> {
        self.ended = true;
        self.error = Some(error(self.offset(), self));
        None
    }
}

impl<R: Read> Iterator for Reader<R> {
    type Item = Result<Record, FormatError>;

    #[inline]
    fn next(&mut self) -> Option<Self::Item> {
        match self.next_record() {
            Some(record) => Some(Ok(record)),
            None => self.error.take().map(Err),
        }
    }
}

impl<R: Read> std::iter::FusedIterator for Reader<R> {}
