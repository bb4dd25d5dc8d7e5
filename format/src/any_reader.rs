//! The front door: a file of any version.

use crate::conversion::down_to;
use crate::header::{self, read_version};
use crate::input::Input;
use crate::v5::{self, Archive, Preorder, Seekable};
use crate::{
    FormatError, Limits, MaterialPalette, NormalCode, Reader, Record, Summary, WorldTransform, summarize,
};
use std::io::{Chain, Cursor, Read, Seek};

/// Input whose first bytes have been looked at.
type LookedAt<R> = Chain<Cursor<Vec<u8>>, R>;

/// A file of any version that this crate reads.
///
/// What all versions have is found here. For what only one has, match on it.
#[derive(Debug)]
pub enum AnyReader<R: Read> {
    /// Version 4: a stream of records.
    Version4(Reader<LookedAt<R>>),
    /// Version 5: a stream of subtrees. For random access, open an [`Archive`].
    Version5(v5::Reader<LookedAt<R>>),
}

impl<R: Read> AnyReader<R> {
    /// Reads what is at the beginning of a file, which need neither be buffered nor searchable.
    ///
    /// # Errors
    /// A [`FormatError`] if the file is of another kind or version, or if its beginning is damaged.
    pub fn new(input: R) -> Result<Self, FormatError> {
        Self::with_limits(input, Limits::default())
    }

    /// As [`AnyReader::new`], with bounds on what the file may hold.
    ///
    /// # Errors
    /// As [`AnyReader::new`].
    pub fn with_limits(mut input: R, limits: Limits) -> Result<Self, FormatError> {
        let mut beginning = Vec::new();
        input
            .by_ref()
            .take(4)
            .read_to_end(&mut beginning)
            .map_err(|source| FormatError::Read { offset: beginning.len() as u64, source })?;
        let version = read_version(&mut Input::new(&beginning[..]))?;
        let input = Cursor::new(beginning).chain(input);
        match version {
            header::VERSION => Ok(Self::Version4(Reader::with_limits(input, limits)?)),
            v5::VERSION => Ok(Self::Version5(v5::Reader::with_limits(input, limits)?)),
            _ => Err(FormatError::UnsupportedVersion { version }),
        }
    }

    /// The version of the format: 4 or 5.
    #[must_use]
    pub fn version(&self) -> u16 {
        match self {
            Self::Version4(_) => header::VERSION,
            Self::Version5(_) => v5::VERSION,
        }
    }

    /// The materials of the file. Those of version 4 have a diffuse colour only.
    #[must_use]
    pub fn materials(&self) -> MaterialPalette {
        match self {
            Self::Version4(reader) => reader.palette().into(),
            Self::Version5(reader) => reader.materials().clone(),
        }
    }

    /// Where the octree lies in the world. Version 4 does not tell.
    #[must_use]
    pub fn world(&self) -> Option<WorldTransform> {
        match self {
            Self::Version4(_) => None,
            Self::Version5(reader) => reader.header().world,
        }
    }

    /// Reads the file to its end, checks everything, and counts.
    ///
    /// # Errors
    /// The first error of the file.
    pub fn summarize(self) -> Result<Summary, FormatError> {
        match self {
            Self::Version4(reader) => summarize(reader),
            Self::Version5(reader) => v5::summarize(reader).map(|(summary, _)| summary),
        }
    }
}

impl<R: Read + Seek> AnyReader<R> {
    /// The records of the file in preorder, as version 4 has them: with empty children, and normals in the spherical code.
    /// Palette indices go up to 65,535.
    ///
    /// # Errors
    /// A [`FormatError`] if the end of a file of version 5 is damaged.
    pub fn records(self) -> Result<AnyRecords<R>, FormatError> {
        self.records_down_to(Limits::MAX_DEPTH)
    }

    /// The records of the octree down to `level`: those of the octree of that depth.
    ///
    /// # Errors
    /// As [`AnyReader::records`].
    pub fn records_down_to(self, level: u8) -> Result<AnyRecords<R>, FormatError> {
        let source = match self {
            Self::Version4(reader) => Source::Version4(Box::new(reader)),
            Self::Version5(reader) => {
                let archive = archive(reader)?;
                let preorder = Preorder::new(&archive, level, NormalCode::Spherical);
                Source::Version5(Box::new((archive, preorder)))
            }
        };
        Ok(AnyRecords { source, level })
    }
}

/// The same file, searched from its beginning.
fn archive<R: Read + Seek>(reader: v5::Reader<LookedAt<R>>) -> Result<Archive<Seekable<R>>, FormatError> {
    let limits = reader.limits();
    let (_, input) = reader.into_inner().into_inner();
    Archive::with_limits(Seekable::new(input), limits)
}

/// The records of a file of any version in preorder. The iterator ends after the first error.
#[derive(Debug)]
pub struct AnyRecords<R: Read> {
    source: Source<R>,
    /// The last level that is shown.
    level: u8,
}

#[derive(Debug)]
enum Source<R: Read> {
    Version4(Box<Reader<LookedAt<R>>>),
    Version5(Box<(Archive<Seekable<R>>, Preorder)>),
}

impl<R: Read + Seek> Iterator for AnyRecords<R> {
    type Item = Result<Record, FormatError>;

    fn next(&mut self) -> Option<Self::Item> {
        let level = self.level;
        match &mut self.source {
            Source::Version4(reader) => down_to(reader, level).next(),
            Source::Version5(source) => source.1.next_record(&source.0),
        }
    }
}

impl<R: Read + Seek> std::iter::FusedIterator for AnyRecords<R> {}
