//! The tables that people read.

use crate::inspection::{Inspection, Version5};
use octvox_cli::grouped;
use octvox_format::Record;

/// What a file holds, a line for each fact.
pub fn of_summary(inspection: &Inspection) -> String {
    let summary = &inspection.summary;
    let used = inspection.palette_uses().filter(|(index, _)| *index > 0).count();
    let valid = match summary.first_defect {
        None => "yes".to_owned(),
        Some(defect) => format!("no, senseless nodes: {}; {defect}", grouped(summary.defects)),
    };
    let palette_size = grouped(inspection.materials.len() as u64);
    let mut rows = vec![
        ("format", format!("version {}", inspection.version)),
        ("resolution", format!("{}³ (depth {})", summary.resolution(), summary.depth)),
        ("palette", format!("{palette_size} colours, {} in use", grouped(used as u64))),
        ("leaf voxels", grouped(summary.leaf_voxels)),
        ("nodes", grouped(summary.nodes)),
        ("stored voxels", grouped(summary.stored_voxels)),
        ("file", format!("{} bytes", grouped(summary.file_bytes))),
    ];
    rows.extend(inspection.version_5.iter().flat_map(|details| version_5_rows(inspection, details)));
    rows.push(("valid", valid));
    rows.into_iter().map(|(name, value)| format!("{name:<13}  {value}\n")).collect()
}

fn version_5_rows(inspection: &Inspection, details: &Version5) -> [(&'static str, String); 6] {
    let (header, parts) = (&details.header, &details.parts);
    let per_leaf =
        inspection.bytes_per_leaf_voxel().map_or("-".to_owned(), |bytes| format!("{bytes:.2} bytes"));
    let world = header.world.map_or("unknown".to_owned(), |world| {
        let [x, y, z] = world.origin;
        format!("origin {x}, {y}, {z}; voxel size {}", world.voxel_size)
    });
    let bytes = [parts.materials, parts.subtrees, parts.top, parts.index].map(grouped);
    let [materials, subtrees, top, index] = bytes;
    [
        ("a leaf voxel", per_leaf),
        ("sections", format!("materials {materials}, subtrees {subtrees}, top {top}, index {index} bytes")),
        ("subtrees", format!("{}, cut at level {}", grouped(details.subtrees as u64), header.cut_level)),
        (
            "coding",
            format!("compression {}, normals {}", header.compression.name(), header.normal_code.name()),
        ),
        ("world", world),
        // Whatever a file says, it must not move the cursor of a terminal.
        ("written by", header.writer.chars().filter(|character| !character.is_control()).collect()),
    ]
}

/// The filled voxels of each level.
pub fn of_levels(levels: &[u64]) -> String {
    let mut table = String::from("level  resolution  filled voxels\n");
    for (level, &filled) in levels.iter().enumerate() {
        table += &format!("{level:>5}  {:>10}  {:>13}\n", grouped(1_u32 << level), grouped(filled));
    }
    table
}

/// The palette indices in use.
pub fn of_palette(inspection: &Inspection) -> String {
    let mut table = String::from("palette  colour   stored voxels\n");
    for (index, stored_voxels) in inspection.palette_uses() {
        let color = inspection.color(index);
        let color = color.map_or("empty".to_owned(), |[r, g, b]| format!("#{r:02x}{g:02x}{b:02x}"));
        table += &format!("{index:>7}  {color:<7}  {:>13}\n", grouped(stored_voxels));
    }
    table
}

/// The first records.
pub fn of_records(records: &[Record]) -> String {
    let mut table = String::from("level  octant  palette  theta   phi  children\n");
    for Record { level, octant, voxel, has_children } in records {
        let (palette, theta, phi) = (voxel.palette_index, voxel.normal.theta, voxel.normal.phi);
        let children = if *has_children { "yes" } else { "no" };
        table += &format!("{level:>5}  {octant:>6}  {palette:>7}  {theta:>5}  {phi:>4}  {children}\n");
    }
    table
}
