//! What is converted: a file of ours, or one of MagicaVoxel that has been made ours in memory.

use anyhow::Context;
use octvox_cli::Progress;
use octvox_format::exchange::magicavoxel::{import, is_magicavoxel};
use octvox_format::v5::{Archive, Header, Seekable};
use octvox_format::{AnyReader, FormatError, MaterialPalette, summarize};
use std::fs::File;
use std::io::{self, Cursor, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

/// Kinds of files that can be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InputKind {
    Version4,
    Version5,
    MagicaVoxel,
}

/// A file that is converted.
pub struct Input {
    source: Source,
    kind: InputKind,
    byte_length: u64,
    materials: MaterialPalette,
    /// What version 5 says of itself.
    header: Option<Header>,
}

/// Where its bytes are.
enum Source {
    File {
        path: PathBuf,
        progress: Progress,
    },
    /// A file of version 5.
    Memory(Vec<u8>),
}

impl Input {
    /// Reads what is at the beginning of a file, and all of one of MagicaVoxel.
    pub fn open(path: &Path, progress: &Progress) -> anyhow::Result<Self> {
        let mut file = File::open(path)?;
        let byte_length = file.metadata()?.len();
        let mut beginning = Vec::new();
        file.by_ref().take(4).read_to_end(&mut beginning)?;
        let source = if is_magicavoxel(&beginning) {
            file.read_to_end(&mut beginning)?;
            Source::Memory(import(&beginning)?)
        } else {
            file.rewind().context("cannot be searched; save it as a file")?;
            Source::File { path: path.to_path_buf(), progress: progress.clone() }
        };
        let reader = AnyReader::new(source.bytes()?)?;
        let (version, materials) = (reader.version(), reader.materials());
        let header = match &reader {
            AnyReader::Version4(_) => None,
            AnyReader::Version5(reader) => Some(reader.header().clone()),
        };
        let kind = match (&source, version) {
            (Source::Memory(_), _) => InputKind::MagicaVoxel,
            (Source::File { .. }, 4) => InputKind::Version4,
            (Source::File { .. }, _) => InputKind::Version5,
        };
        drop(reader);
        Ok(Self { source, kind, byte_length, materials, header })
    }

    pub fn kind(&self) -> InputKind {
        self.kind
    }

    pub fn byte_length(&self) -> u64 {
        self.byte_length
    }

    pub fn materials(&self) -> &MaterialPalette {
        &self.materials
    }

    /// What version 5 says of itself.
    pub fn header(&self) -> Option<&Header> {
        self.header.as_ref()
    }

    /// The finest level. A file of version 4 is read to its end to find out.
    pub fn depth(&self) -> Result<u8, FormatError> {
        match (&self.header, AnyReader::new(self.bytes()?)?) {
            (None, AnyReader::Version4(reader)) => Ok(summarize(reader)?.depth),
            (Some(header), _) => Ok(header.depth),
            // The file has become another one in the meantime.
            (None, AnyReader::Version5(reader)) => Ok(reader.header().depth),
        }
    }

    /// The file from its beginning.
    pub fn bytes(&self) -> Result<Box<dyn Bytes + '_>, FormatError> {
        self.source.bytes()
    }

    /// The file, searched.
    pub fn archive(&self) -> Result<Archive<Seekable<Box<dyn Bytes + '_>>>, FormatError> {
        Archive::open(self.bytes()?)
    }

    pub fn reader(&self) -> Result<AnyReader<Box<dyn Bytes + '_>>, FormatError> {
        AnyReader::new(self.bytes()?)
    }
}

impl Source {
    fn bytes(&self) -> Result<Box<dyn Bytes + '_>, FormatError> {
        Ok(match self {
            Self::Memory(file) => Box::new(Cursor::new(&file[..])),
            Self::File { path, progress } => {
                let input = File::open(path).map_err(|source| FormatError::Read { offset: 0, source })?;
                Box::new(Watched { input, progress: progress.clone() })
            }
        })
    }
}

/// Bytes that can be searched.
pub trait Bytes: Read + Seek {}

impl<T: Read + Seek> Bytes for T {}

/// A file that moves the progress bar.
struct Watched {
    input: File,
    progress: Progress,
}

impl Read for Watched {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.input.read(buffer)?;
        self.progress.add(count as u64);
        Ok(count)
    }
}

impl Seek for Watched {
    fn seek(&mut self, place: SeekFrom) -> io::Result<u64> {
        self.input.seek(place)
    }
}
