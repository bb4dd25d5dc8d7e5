//! What is found out about a file.

use anyhow::Context;
use octvox_cli::Progress;
use octvox_format::v5::{self, Archive, Header, Parts};
use octvox_format::{AnyReader, MaterialPalette, Record, Summary, summarize_with};
use std::fs::File;
use std::io::{self, Read, Seek};

/// What a file of any version holds.
pub struct Inspection {
    pub version: u16,
    pub materials: MaterialPalette,
    pub summary: Summary,
    pub version_5: Option<Version5>,
}

/// What only version 5 has.
pub struct Version5 {
    pub header: Header,
    pub subtrees: usize,
    pub parts: Parts,
}

impl Inspection {
    /// Reads a file to its end, and puts its first `wanted` records into `first`, as many as can be read.
    pub fn of(
        file: &File,
        progress: &Progress,
        wanted: u64,
        first: &mut Vec<Record>,
    ) -> anyhow::Result<Self> {
        let reader = AnyReader::new(Watched { input: file, progress: progress.clone() })?;
        let (version, materials) = (reader.version(), reader.materials());
        match reader {
            AnyReader::Version4(reader) => {
                let summary = summarize_with(reader, |record| {
                    if (first.len() as u64) < wanted {
                        first.push(*record);
                    }
                })?;
                Ok(Self { version, materials, summary, version_5: None })
            }
            AnyReader::Version5(reader) => {
                let header = reader.header().clone();
                let (summary, ending) = v5::summarize(reader)?;
                if wanted > 0 {
                    first_records(file, wanted, first)?;
                }
                let subtrees = ending.index.subtrees.len();
                let version_5 = Some(Version5 { header, subtrees, parts: ending.parts });
                Ok(Self { version, materials, summary, version_5 })
            }
        }
    }

    /// The palette indices in use, ascending, and how many voxels are stored with each.
    pub fn palette_uses(&self) -> impl Iterator<Item = (u16, u64)> {
        let uses = (0..=u16::MAX).zip(&self.summary.palette_uses);
        uses.filter(|(_, uses)| **uses > 0).map(|(index, uses)| (index, *uses))
    }

    /// The diffuse colour of a palette index; none for 0.
    pub fn color(&self, index: u16) -> Option<[u8; 3]> {
        self.materials.material(index).map(|material| material.diffuse)
    }

    /// Length of the file over the filled cells of the finest level; none if there are no such.
    pub fn bytes_per_leaf_voxel(&self) -> Option<f64> {
        let leaf_voxels = self.summary.leaf_voxels;
        (leaf_voxels > 0).then(|| self.summary.file_bytes as f64 / leaf_voxels as f64)
    }
}

/// The first records of a file of version 5, whose end must be read before its beginning.
fn first_records(mut file: &File, wanted: u64, first: &mut Vec<Record>) -> anyhow::Result<()> {
    file.rewind().context("its records cannot be shown, as it cannot be searched; save it as a file")?;
    let archive = Archive::open(file)?;
    for record in archive.records().take(usize::try_from(wanted).unwrap_or(usize::MAX)) {
        first.push(record?);
    }
    Ok(())
}

/// Input that moves the progress bar.
struct Watched<'a> {
    input: &'a File,
    progress: Progress,
}

impl Read for Watched<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.input.read(buffer)?;
        self.progress.add(count as u64);
        Ok(count)
    }
}
