//! Where an archive lies: in memory, or in a file that can be searched.

use std::borrow::Cow;
use std::io::{self, Error, ErrorKind, Read, Seek, SeekFrom};
use std::sync::{Mutex, PoisonError};

/// Bytes that can be read from anywhere, by several threads at once.
pub trait Source {
    /// How many there are.
    ///
    /// # Errors
    /// What the system says.
    fn byte_length(&self) -> io::Result<u64>;

    /// So many bytes from an offset on, which are all there.
    ///
    /// # Errors
    /// What the system says; [`ErrorKind::UnexpectedEof`] if there are fewer.
    fn bytes_at(&self, offset: u64, length: usize) -> io::Result<Cow<'_, [u8]>>;
}

/// A file in memory, or mapped into it. Nothing is copied.
impl Source for &[u8] {
    fn byte_length(&self) -> io::Result<u64> {
        Ok(self.len() as u64)
    }

    fn bytes_at(&self, offset: u64, length: usize) -> io::Result<Cow<'_, [u8]>> {
        let start = usize::try_from(offset).ok();
        let range = start.and_then(|start| Some(start..start.checked_add(length)?));
        let bytes = range.and_then(|range| self.get(range));
        bytes.map(Cow::Borrowed).ok_or_else(|| ErrorKind::UnexpectedEof.into())
    }
}

/// No more memory is reserved before it is known that there are so many bytes.
const LARGEST_RESERVED: usize = 1 << 24;

/// A file that is searched. Threads take turns at reading, but not at decoding what they have read.
#[derive(Debug)]
pub struct Seekable<R>(Mutex<R>);

impl<R: Read + Seek> Seekable<R> {
    /// `input` need not be buffered.
    pub fn new(input: R) -> Self {
        Self(Mutex::new(input))
    }
}

impl<R: Read + Seek> Source for Seekable<R> {
    fn byte_length(&self) -> io::Result<u64> {
        // Every use begins with a jump, so one that has failed leaves nothing behind.
        self.0.lock().unwrap_or_else(PoisonError::into_inner).seek(SeekFrom::End(0))
    }

    fn bytes_at(&self, offset: u64, length: usize) -> io::Result<Cow<'_, [u8]>> {
        let mut input = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        input.seek(SeekFrom::Start(offset))?;
        let mut bytes = Vec::new();
        bytes.try_reserve_exact(length.min(LARGEST_RESERVED))?;
        input.by_ref().take(length as u64).read_to_end(&mut bytes)?;
        if bytes.len() < length {
            return Err(Error::from(ErrorKind::UnexpectedEof));
        }
        Ok(bytes.into())
    }
}
