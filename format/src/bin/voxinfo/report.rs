//! The object that `--json` prints.

use crate::inspection::{Inspection, Version5};
use octvox_format::Record;
use octvox_format::v5::Parts;
use serde::Serialize;

#[derive(Serialize)]
pub struct Report {
    format: u16,
    depth: u8,
    resolution: u32,
    palette_size: usize,
    stored_voxels: u64,
    leaf_voxels: u128,
    nodes: u64,
    levels: Vec<u64>,
    file_bytes: u64,
    valid: bool,
    /// Version 4 does not say where in the world the octree lies.
    world: Option<WorldReport>,
    #[serde(flatten)]
    version_5: Option<Version5Report>,
    #[serde(skip_serializing_if = "Option::is_none")]
    histogram: Option<Vec<PaletteUse>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    records: Option<Vec<RecordReport>>,
}

impl Report {
    /// What was found, with the histogram if it is wanted, and the records that are to be shown.
    pub fn new(inspection: &Inspection, histogram: bool, records: Option<&[Record]>) -> Self {
        let summary = &inspection.summary;
        let version_5 = inspection.version_5.as_ref();
        let world = version_5.and_then(|details| details.header.world);
        Self {
            format: inspection.version,
            depth: summary.depth,
            resolution: summary.resolution(),
            palette_size: inspection.materials.len(),
            stored_voxels: summary.stored_voxels,
            leaf_voxels: summary.leaf_voxels,
            nodes: summary.nodes,
            levels: summary.levels.clone(),
            file_bytes: summary.file_bytes,
            valid: summary.is_valid(),
            world: world.map(|world| WorldReport { origin: world.origin, voxel_size: world.voxel_size }),
            version_5: version_5.map(|details| Version5Report::new(inspection, details)),
            histogram: histogram.then(|| PaletteUse::all(inspection)),
            records: records.map(|records| records.iter().map(RecordReport::from).collect()),
        }
    }
}

#[derive(Serialize)]
struct WorldReport {
    origin: [f64; 3],
    voxel_size: f64,
}

/// What only version 5 has.
#[derive(Serialize)]
struct Version5Report {
    writer: String,
    compression: &'static str,
    normal_code: &'static str,
    cut_level: u8,
    subtrees: usize,
    bytes_per_leaf_voxel: Option<f64>,
    sections: SectionsReport,
}

impl Version5Report {
    fn new(inspection: &Inspection, details: &Version5) -> Self {
        let Parts { header, materials, subtrees, top, index, trailer } = details.parts;
        Self {
            writer: details.header.writer.clone(),
            compression: details.header.compression.name(),
            normal_code: details.header.normal_code.name(),
            cut_level: details.header.cut_level,
            subtrees: details.subtrees,
            bytes_per_leaf_voxel: inspection.bytes_per_leaf_voxel(),
            sections: SectionsReport { header, materials, subtrees, top, index, trailer },
        }
    }
}

/// Bytes of the file.
#[derive(Serialize)]
struct SectionsReport {
    header: u64,
    materials: u64,
    subtrees: u64,
    top: u64,
    index: u64,
    trailer: u64,
}

/// How often a palette index is used; the color is missing for index 0.
#[derive(Serialize)]
struct PaletteUse {
    palette: u16,
    color: Option<[u8; 3]>,
    stored_voxels: u64,
}

impl PaletteUse {
    fn all(inspection: &Inspection) -> Vec<Self> {
        let uses = inspection.palette_uses();
        uses.map(|(palette, stored_voxels)| Self { palette, color: inspection.color(palette), stored_voxels })
            .collect()
    }
}

/// A record. The normal is in the spherical code, whatever that of the file is.
#[derive(Serialize)]
struct RecordReport {
    level: u8,
    octant: u8,
    palette: u16,
    theta: u8,
    phi: i8,
    has_children: bool,
}

impl From<&Record> for RecordReport {
    fn from(record: &Record) -> Self {
        Self {
            level: record.level,
            octant: record.octant,
            palette: record.voxel.palette_index,
            theta: record.voxel.normal.theta,
            phi: record.voxel.normal.phi,
            has_children: record.has_children,
        }
    }
}
