//! Voxels that wait for the next stage: in memory as long as there is room, beyond that in a temporary file.

use crate::ConvertError;
use bytemuck::Pod;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

/// What can be stored in a file for a while.
pub(crate) trait Spill: Sized {
    /// Bytes that it takes in memory, about.
    fn memory_bytes(&self) -> usize;
    /// Appends everything that [`Spill::from_bytes`] needs.
    fn append_to(&self, bytes: &mut Vec<u8>);
    /// What [`Spill::append_to`] has appended; `None` if it is something else.
    fn from_bytes(bytes: &mut &[u8]) -> Option<Self>;
}

/// Takes care of values that are [`Stored`], from all threads.
#[derive(Debug)]
pub(crate) struct Storage {
    /// Bytes that values may still take in memory.
    room: AtomicU64,
    folder: PathBuf,
    /// Created when it is first needed. It has no name, so that it is gone however the process ends.
    file: Mutex<Option<File>>,
    /// Length of the file.
    length: AtomicU64,
}

/// A value that is kept by a [`Storage`].
#[derive(Debug)]
pub(crate) enum Stored<T> {
    Memory(T),
    File { offset: u64, length: usize },
}

impl Storage {
    /// Values take `memory` bytes at most; what is beyond goes into a temporary file in `folder`.
    pub(crate) fn new(memory: u64, folder: PathBuf) -> Self {
        Self { room: memory.into(), folder, file: Mutex::new(None), length: AtomicU64::new(0) }
    }

    /// Keeps a value.
    ///
    /// # Errors
    /// [`ConvertError::TemporaryFile`] if there is room neither in memory nor in the folder.
    pub(crate) fn put<T: Spill>(&self, value: T) -> Result<Stored<T>, ConvertError> {
        let bytes = value.memory_bytes() as u64;
        let take = |room: u64| room.checked_sub(bytes);
        if self.room.fetch_update(Ordering::Relaxed, Ordering::Relaxed, take).is_ok() {
            return Ok(Stored::Memory(value));
        }
        let mut bytes = Vec::with_capacity(value.memory_bytes());
        value.append_to(&mut bytes);
        drop(value);
        let offset = self.append(&bytes).map_err(|source| self.failed(source))?;
        Ok(Stored::File { offset, length: bytes.len() })
    }

    /// Gives a value back, and its room in memory free.
    ///
    /// # Errors
    /// [`ConvertError::TemporaryFile`] if it cannot be read.
    pub(crate) fn take<T: Spill>(&self, stored: Stored<T>) -> Result<T, ConvertError> {
        match stored {
            Stored::Memory(value) => {
                self.room.fetch_add(value.memory_bytes() as u64, Ordering::Relaxed);
                Ok(value)
            }
            Stored::File { offset, length } => self.read(offset, length),
        }
    }

    /// Shows a value.
    ///
    /// # Errors
    /// [`ConvertError::TemporaryFile`] if it cannot be read.
    pub(crate) fn with<T: Spill, R>(
        &self,
        stored: &Stored<T>,
        look: impl FnOnce(&T) -> R,
    ) -> Result<R, ConvertError> {
        match stored {
            Stored::Memory(value) => Ok(look(value)),
            Stored::File { offset, length } => self.read(*offset, *length).map(|value| look(&value)),
        }
    }

    /// Bytes in the temporary file.
    pub(crate) fn file_bytes(&self) -> u64 {
        self.length.load(Ordering::Relaxed)
    }

    fn append(&self, bytes: &[u8]) -> io::Result<u64> {
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        let file = match &mut *file {
            Some(file) => file,
            none => none.insert(tempfile::tempfile_in(&self.folder)?),
        };
        let offset = file.seek(SeekFrom::End(0))?;
        file.write_all(bytes)?;
        self.length.store(offset + bytes.len() as u64, Ordering::Relaxed);
        Ok(offset)
    }

    fn read<T: Spill>(&self, offset: u64, length: usize) -> Result<T, ConvertError> {
        let mut bytes = vec![0; length];
        self.read_at(offset, &mut bytes).map_err(|source| self.failed(source))?;
        T::from_bytes(&mut &bytes[..]).ok_or_else(|| self.failed(io::ErrorKind::InvalidData.into()))
    }

    fn read_at(&self, offset: u64, bytes: &mut [u8]) -> io::Result<()> {
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        let file = file.as_mut().ok_or(io::ErrorKind::NotFound)?;
        file.seek(SeekFrom::Start(offset))?;
        file.read_exact(bytes)
    }

    fn failed(&self, source: io::Error) -> ConvertError {
        ConvertError::TemporaryFile { folder: self.folder.clone(), source }
    }
}

/// A list for each level of an octree.
impl<T: Pod> Spill for Vec<Vec<T>> {
    fn memory_bytes(&self) -> usize {
        self.iter().map(|level| size_of::<Vec<T>>() + level.capacity() * size_of::<T>()).sum()
    }

    fn append_to(&self, bytes: &mut Vec<u8>) {
        // At most 23 levels.
        bytes.push(self.len() as u8);
        self.iter().for_each(|level| append_list(level, bytes));
    }

    fn from_bytes(bytes: &mut &[u8]) -> Option<Self> {
        let count = bytes.split_off_first()?;
        (0..*count).map(|_| take_list(bytes)).collect()
    }
}

/// Appends a list and its length.
pub(crate) fn append_list<T: Pod>(list: &[T], bytes: &mut Vec<u8>) {
    bytes.extend_from_slice(&(list.len() as u64).to_le_bytes());
    bytes.extend_from_slice(bytemuck::cast_slice(list));
}

/// Takes the list that [`append_list`] has appended.
pub(crate) fn take_list<T: Pod>(bytes: &mut &[u8]) -> Option<Vec<T>> {
    let (length, rest) = bytes.split_first_chunk()?;
    let length = usize::try_from(u64::from_le_bytes(*length)).ok()?;
    let (stored, rest) = rest.split_at_checked(length.checked_mul(size_of::<T>())?)?;
    *bytes = rest;
    let mut list = vec![T::zeroed(); length];
    bytemuck::cast_slice_mut(&mut list).copy_from_slice(stored);
    Some(list)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayon::prelude::*;

    impl Spill for Vec<u16> {
        fn memory_bytes(&self) -> usize {
            2 * self.len()
        }

        fn append_to(&self, bytes: &mut Vec<u8>) {
            append_list(self, bytes);
        }

        fn from_bytes(bytes: &mut &[u8]) -> Option<Self> {
            take_list(bytes)
        }
    }

    fn list(k: u16) -> Vec<u16> {
        (0..k).map(|j| j * k).collect()
    }

    #[test]
    fn values_come_back_from_memory_and_file() {
        for (memory, spilled) in [(0, 100), (2 * 1000, 1), (u64::MAX, 0)] {
            let folder = tempfile::tempdir().unwrap();
            let storage = Storage::new(memory, folder.path().to_owned());
            let stored: Vec<_> =
                (0..=100u16).into_par_iter().map(|k| storage.put(list(k)).unwrap()).collect();
            let in_file = stored.iter().filter(|stored| matches!(stored, Stored::File { .. })).count();
            assert!(in_file >= spilled && (in_file > 0) == (memory != u64::MAX), "{in_file}");
            assert_eq!(storage.file_bytes() > 0, in_file > 0);
            // Nothing to clean up, even if the process is killed.
            #[cfg(unix)]
            assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
            stored.par_iter().zip(0..=100u16).for_each(|(stored, k)| {
                assert!(storage.with(stored, |value| *value == list(k)).unwrap());
            });
            let taken: Vec<_> = stored.into_par_iter().map(|stored| storage.take(stored).unwrap()).collect();
            assert!(taken.into_iter().eq((0..=100).map(list)));
            assert_eq!(storage.room.into_inner(), memory);
        }
    }

    #[test]
    fn a_folder_that_cannot_be_written_is_named() {
        let storage = Storage::new(0, "no/such/folder".into());
        let error = storage.put(list(3)).unwrap_err();
        assert!(error.to_string().contains("no/such/folder"), "{error}");
    }

    #[test]
    fn bytes_of_something_else_are_refused() {
        let mut bytes = Vec::new();
        append_list(&[1u16, 2, 3], &mut bytes);
        for length in 0..bytes.len() {
            assert_eq!(take_list::<u16>(&mut &bytes[..length]), None);
        }
        assert_eq!(take_list::<u16>(&mut &bytes[..]), Some(vec![1, 2, 3]));
    }

    #[test]
    fn levels_come_back() {
        let levels = vec![vec![[1u8, 2]], vec![], vec![[3, 4], [5, 6]]];
        let mut bytes = Vec::new();
        levels.append_to(&mut bytes);
        let mut rest = &bytes[..];
        assert_eq!(Vec::<Vec<[u8; 2]>>::from_bytes(&mut rest), Some(levels));
        assert!(rest.is_empty());
        assert_eq!(Vec::<Vec<[u8; 2]>>::from_bytes(&mut &bytes[..bytes.len() - 1]), None);
    }
}
