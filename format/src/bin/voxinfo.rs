//! Looks into a `.vox` file: what it holds, whether it makes sense, and its first records.

use anyhow::Context;
use clap::Parser;
use octvox_cli::{CommonArgs, Progress, grouped, print_json, print_line};
use octvox_format::{Palette, Reader, Record, Summary, VERSION, summarize_with};
use serde::Serialize;
use std::fs::File;
use std::io::{self, Read};
use std::path::PathBuf;
use std::process::ExitCode;

/// Show what a .vox file holds.
///
/// The whole file is read and checked; one that is damaged is an error that names the place.
#[derive(Parser)]
#[command(name = "voxinfo", version, after_help = EXAMPLES)]
struct Arguments {
    /// The .vox file
    file: PathBuf,
    /// Fail if a node is empty but has filled children, or has only empty ones
    #[arg(long)]
    validate: bool,
    /// Show how many voxels are stored with each palette index
    #[arg(long)]
    histogram: bool,
    /// Show the first N records
    #[arg(long, value_name = "N")]
    records: Option<u64>,
    #[command(flatten)]
    common: CommonArgs,
}

const EXAMPLES: &str = "\
Examples:
  voxinfo bunny.vox                     what is in the file
  voxinfo bunny.vox --validate --quiet  exit status 1 if the octree makes no sense
  voxinfo bunny.vox --records 9         the root and what comes first below it
  voxinfo bunny.vox --json | jq .depth  for scripts";

fn main() -> ExitCode {
    octvox_cli::run(|| inspect(&Arguments::parse()))
}

fn inspect(arguments: &Arguments) -> anyhow::Result<()> {
    let name = || arguments.file.display().to_string();
    let file = File::open(&arguments.file).with_context(name)?;
    let length = file.metadata().with_context(name)?.len();
    let progress = Progress::new(length, arguments.common.quiet);
    progress.stage("reading", length);

    let reader = Reader::new(Watched { input: file, progress: progress.clone() }).with_context(name)?;
    let palette = reader.palette().clone();
    let mut first = Vec::new();
    let wanted = arguments.records.unwrap_or(0);
    let result = summarize_with(reader, |record| {
        if (first.len() as u64) < wanted {
            first.push(*record);
        }
    });
    progress.finish();
    if result.is_err() && !arguments.common.json && !first.is_empty() {
        // What can be read of a damaged file helps to find out what happened to it.
        print_line(record_table(&first).trim_end())?;
    }
    let summary = result.with_context(name)?;

    if arguments.common.json {
        print_json(&Report::new(arguments, &palette, &summary, &first))?;
    } else {
        let mut tables = vec![summary_table(&palette, &summary), level_table(&summary.levels)];
        tables.extend(arguments.histogram.then(|| histogram_table(&palette, &summary)));
        tables.extend(arguments.records.map(|_| record_table(&first)));
        print_line(tables.join("\n").trim_end())?;
    }
    judge(arguments, &summary)
}

/// With `--validate`, an octree that makes no sense is a failure.
fn judge(arguments: &Arguments, summary: &Summary) -> anyhow::Result<()> {
    match summary.first_defect {
        Some(defect) if arguments.validate => {
            let others = match summary.defects - 1 {
                0 => String::new(),
                others => format!(" ({} more such nodes)", grouped(others)),
            };
            anyhow::bail!("{}: {defect}{others}; convert the mesh again", arguments.file.display())
        }
        _ => Ok(()),
    }
}

/// The object that `--json` prints.
#[derive(Serialize)]
struct Report {
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
    world: Option<()>,
    #[serde(skip_serializing_if = "Option::is_none")]
    histogram: Option<Vec<PaletteUse>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    records: Option<Vec<RecordReport>>,
}

impl Report {
    fn new(arguments: &Arguments, palette: &Palette, summary: &Summary, first: &[Record]) -> Self {
        Self {
            format: VERSION,
            depth: summary.depth,
            resolution: summary.resolution(),
            palette_size: palette.len(),
            stored_voxels: summary.stored_voxels,
            leaf_voxels: summary.leaf_voxels,
            nodes: summary.nodes,
            levels: summary.levels.clone(),
            file_bytes: summary.file_bytes,
            valid: summary.is_valid(),
            world: None,
            histogram: arguments.histogram.then(|| palette_uses(palette, summary).collect()),
            records: arguments.records.map(|_| first.iter().map(RecordReport::from).collect()),
        }
    }
}

/// How often a palette index is used; the color is missing for index 0.
#[derive(Serialize)]
struct PaletteUse {
    palette: u16,
    color: Option<[u8; 3]>,
    stored_voxels: u64,
}

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

/// The palette indices in use, ascending.
fn palette_uses(palette: &Palette, summary: &Summary) -> impl Iterator<Item = PaletteUse> {
    let uses = (0..).zip(&summary.palette_uses).filter(|&(_, &stored_voxels)| stored_voxels > 0);
    uses.map(|(index, &stored_voxels)| PaletteUse {
        palette: index,
        color: palette.color(index),
        stored_voxels,
    })
}

fn summary_table(palette: &Palette, summary: &Summary) -> String {
    let used = summary.palette_uses.iter().skip(1).filter(|&&uses| uses > 0).count();
    let valid = match summary.first_defect {
        None => "yes".to_owned(),
        Some(defect) => format!("no, senseless nodes: {}; {defect}", grouped(summary.defects)),
    };
    let rows = [
        ("format", format!("version {VERSION}")),
        ("resolution", format!("{}³ (depth {})", summary.resolution(), summary.depth)),
        ("palette", format!("{} colours, {} in use", grouped(palette.len() as u64), grouped(used as u64))),
        ("leaf voxels", grouped(summary.leaf_voxels)),
        ("nodes", grouped(summary.nodes)),
        ("stored voxels", grouped(summary.stored_voxels)),
        ("file", format!("{} bytes", grouped(summary.file_bytes))),
        ("valid", valid),
    ];
    rows.map(|(name, value)| format!("{name:<13}  {value}\n")).concat()
}

fn level_table(levels: &[u64]) -> String {
    let mut table = String::from("level  resolution  filled voxels\n");
    for (level, &filled) in levels.iter().enumerate() {
        table += &format!("{level:>5}  {:>10}  {:>13}\n", grouped(1_u32 << level), grouped(filled));
    }
    table
}

fn histogram_table(palette: &Palette, summary: &Summary) -> String {
    let mut table = String::from("palette  colour   stored voxels\n");
    for PaletteUse { palette, color, stored_voxels } in palette_uses(palette, summary) {
        let color = color.map_or("empty".to_owned(), |[r, g, b]| format!("#{r:02x}{g:02x}{b:02x}"));
        table += &format!("{palette:>7}  {color:<7}  {:>13}\n", grouped(stored_voxels));
    }
    table
}

fn record_table(records: &[Record]) -> String {
    let mut table = String::from("level  octant  palette  theta   phi  children\n");
    for record in records.iter().map(RecordReport::from) {
        let RecordReport { level, octant, palette, theta, phi, has_children } = record;
        let children = if has_children { "yes" } else { "no" };
        table += &format!("{level:>5}  {octant:>6}  {palette:>7}  {theta:>5}  {phi:>4}  {children}\n");
    }
    table
}

/// Input that moves the progress bar.
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
