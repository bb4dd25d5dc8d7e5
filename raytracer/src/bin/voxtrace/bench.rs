//! `voxtrace bench`: how fast primary visibility is.

use crate::camera::CameraArguments;
use crate::model::ModelArguments;
use crate::render::parse_pixels;
use octvox_cli::{CommonArgs, instruction_set, print_json, print_line};
use octvox_raytracer::{Visibility, VisibilityOptions, Width};
use serde::Serialize;
use std::time::Instant;

#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    #[command(flatten)]
    model: ModelArguments,
    #[command(flatten)]
    camera: CameraArguments,
    /// Rays that go together
    #[arg(long, value_name = "LIST", default_value = "1,4,8,16", value_delimiter = ',', value_parser = parse_width)]
    lanes: Vec<Width>,
    /// Cells along each axis of the grid through which rays enter the octree; 0: they start at the root
    #[arg(long, value_name = "LIST", default_value = "64", value_delimiter = ',', value_parser = parse_grid)]
    grid: Vec<u8>,
    /// End rays at cells that look no larger than this many pixels; 0: at the finest cells
    #[arg(long, value_name = "LIST", default_value = "0", value_delimiter = ',', value_parser = parse_pixels)]
    lod: Vec<f64>,
    /// Whether beams find out where rays begin: off, on, or both in turn
    #[arg(long, value_name = "LIST", default_value = "on", value_delimiter = ',', value_parser = parse_switch)]
    beams: Vec<bool>,
    /// How often each setting is measured; the best counts
    #[arg(long, value_name = "N", default_value_t = 7, value_parser = clap::value_parser!(u32).range(5..=1000))]
    repeat: u32,
}

const EXAMPLES: &str = "\
Examples:
  voxtrace bench bunny.vox
  voxtrace bench bunny.vox --lanes 1,16 --grid 0,1,2,4,8,16,32,64,128,256
  voxtrace bench bunny.obj -r 1024 --eye 0.5,0.5,1.9 --target 0.5,0.5,0.5 --threads 1 --json";

#[derive(Serialize)]
struct Report {
    model: String,
    resolution: u32,
    leaf_voxels: u64,
    bytes_per_leaf: f64,
    instruction_set: &'static str,
    views: Vec<Measured>,
}

#[derive(Serialize)]
struct Measured {
    lanes: u32,
    grid: u32,
    beams: bool,
    lod: f64,
    threads: usize,
    mrays_per_s: f64,
    ms: f64,
    hit_fraction: f64,
    steps_per_ray: f64,
}

fn parse_width(text: &str) -> Result<Width, String> {
    text.parse().ok().and_then(Width::from_lanes).ok_or_else(|| "expected some of 1, 4, 8, 16, 32".into())
}

/// The size of a grid as its level; 0 and 1 are both the root.
fn parse_grid(text: &str) -> Result<u8, String> {
    match text.parse::<u32>() {
        Ok(0) => Ok(0),
        Ok(size) if size.is_power_of_two() && size <= 256 => Ok(size.trailing_zeros() as u8),
        _ => Err("expected 0 or a power of two up to 256".into()),
    }
}

fn parse_switch(text: &str) -> Result<bool, String> {
    match text {
        "on" => Ok(true),
        "off" => Ok(false),
        _ => Err("expected on or off".into()),
    }
}

pub fn run(arguments: &Arguments, common: &CommonArgs) -> anyhow::Result<()> {
    let mut model = arguments.model.load(common)?;
    let camera = arguments.camera.camera(&model)?;
    let size = arguments.camera.size;
    let mut views = Vec::new();
    let mut picture = Visibility::default();
    let mut bytes_per_leaf = 0.0;
    for &grid in &arguments.grid {
        model.octree.set_grid(grid);
        bytes_per_leaf = model.octree.bytes() as f64 / model.octree.leaf_voxels().max(1) as f64;
        for (&lod_pixels, &beams) in
            arguments.lod.iter().flat_map(|lod| arguments.beams.iter().map(move |beams| (lod, beams)))
        {
            for &width in &arguments.lanes {
                let mut options = VisibilityOptions { width, lod_pixels, beams, count_steps: true };
                // Counting comes first: it also brings the octree into the caches.
                let counts = picture.trace(&model.octree, &camera, size, &options)?;
                options.count_steps = false;
                let mut best = f64::INFINITY;
                for _ in 0..arguments.repeat {
                    let start = Instant::now();
                    picture.trace(&model.octree, &camera, size, &options)?;
                    best = best.min(start.elapsed().as_secs_f64());
                }
                let rays = counts.rays as f64;
                views.push(Measured {
                    lanes: width.lanes(),
                    grid: model.octree.grid_size(),
                    beams,
                    lod: lod_pixels,
                    threads: rayon::current_num_threads(),
                    mrays_per_s: rays / best / 1e6,
                    ms: best * 1e3,
                    hit_fraction: counts.hits as f64 / rays,
                    steps_per_ray: counts.steps as f64 / rays,
                });
            }
        }
    }
    let report = Report {
        model: arguments.model.model.display().to_string(),
        resolution: model.octree.resolution(),
        leaf_voxels: model.octree.leaf_voxels(),
        bytes_per_leaf,
        instruction_set: instruction_set(),
        views,
    };
    if common.json { print_json(&report) } else { print_table(&report) }
}

fn print_table(report: &Report) -> anyhow::Result<()> {
    print_line(&format!(
        "{}: {}³, {} leaf voxels, {:.2} bytes each, {}",
        report.model, report.resolution, report.leaf_voxels, report.bytes_per_leaf, report.instruction_set
    ))?;
    print_line("lanes  grid  beams   lod  threads    ms/picture  million rays/s   ratio   hits  steps/ray")?;
    let first = report.views.first().map_or(1.0, |view| view.mrays_per_s);
    for view in &report.views {
        print_line(&format!(
            "{:>5} {:>5} {:>6} {:>5} {:>8} {:>13.2} {:>15.2} {:>7.2} {:>5.1}% {:>10.2}",
            view.lanes,
            view.grid,
            if view.beams { "on" } else { "off" },
            view.lod,
            view.threads,
            view.ms,
            view.mrays_per_s,
            view.mrays_per_s / first,
            100.0 * view.hit_fraction,
            view.steps_per_ray,
        ))?;
    }
    Ok(())
}
