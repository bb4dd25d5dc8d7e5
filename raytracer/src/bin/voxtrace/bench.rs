//! `voxtrace bench`: how fast rays are.

use crate::camera::CameraArguments;
use crate::counters::{Counters, Events};
use crate::model::ModelArguments;
use crate::render::{parse_arithmetic, parse_pixels};
use octvox_cli::{CommonArgs, instruction_set, print_json, print_line};
use octvox_raytracer::{
    Arithmetic, Camera, Counts, Octree, Quality, SecondaryKind, SecondaryRays, Visibility, VisibilityOptions,
    Width,
};
use serde::Serialize;
use std::time::Instant;

#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    #[command(flatten)]
    model: ModelArguments,
    #[command(flatten)]
    camera: CameraArguments,
    /// Rays that go together; in double precision always eight
    #[arg(long, value_name = "LIST", default_value = "1,4,8,16", value_delimiter = ',', value_parser = parse_width)]
    lanes: Vec<Width>,
    /// How precisely rays are followed: single, double, or both in turn
    #[arg(long, value_name = "LIST", default_value = "single", value_delimiter = ',', value_parser = parse_arithmetic)]
    arithmetic: Vec<Arithmetic>,
    /// Cells along each axis of the grid through which rays enter the octree; 0: they start at the root
    #[arg(long, value_name = "LIST", default_value = "64", value_delimiter = ',', value_parser = parse_grid)]
    grid: Vec<u8>,
    /// End rays at cells that look no larger than this many pixels; 0: at the finest cells
    #[arg(long, value_name = "LIST", default_values_t = [Quality::default().lod_pixels], value_delimiter = ',', value_parser = parse_pixels)]
    lod: Vec<f64>,
    /// Whether beams find out where rays begin: off, on, or both in turn
    #[arg(long, value_name = "LIST", default_value = "on", value_delimiter = ',', value_parser = parse_switch)]
    beams: Vec<bool>,
    /// What is measured: rays through pixels, or, after them, those to the brightest lamp, all around, or reflected
    #[arg(long, value_name = "LIST", default_value = "primary", value_delimiter = ',')]
    rays: Vec<Kind>,
    /// Read the processor's own counters: cycles, instructions and misses for each step of a packet
    #[arg(long)]
    counters: bool,
    /// How often each setting is measured; the best counts
    #[arg(long, value_name = "N", default_value_t = 7, value_parser = clap::value_parser!(u32).range(5..=1000))]
    repeat: u32,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
enum Kind {
    Primary,
    Shadow,
    Ambient,
    Reflection,
}

const EXAMPLES: &str = "\
Examples:
  voxtrace bench bunny.vox
  voxtrace bench bunny.vox --lanes 1,16 --grid 0,1,2,4,8,16,32,64,128,256
  voxtrace bench bunny.vox --lanes 8 --arithmetic single,double
  voxtrace bench bunny.vox --lanes 16 --rays primary,shadow,ambient,reflection
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
    rays: Kind,
    arithmetic: Arithmetic,
    lanes: u32,
    grid: u32,
    beams: bool,
    lod: f64,
    threads: usize,
    mrays_per_s: f64,
    ms: f64,
    hit_fraction: f64,
    steps_per_ray: f64,
    /// Of the lanes of all packet steps, how many had a ray that made the step.
    lane_utilisation: f64,
    /// For each packet step; nothing if the processor's counters were not asked for or cannot be read.
    counters: Option<PerPacketStep>,
}

#[derive(Serialize)]
struct PerPacketStep {
    cycles: f64,
    instructions: f64,
    cache_misses: f64,
    branch_misses: f64,
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

/// What a packet is: its arithmetic and how many rays go together.
type Packets = (Arithmetic, Width);

impl Arguments {
    /// The packets to be measured. In double precision there is one width.
    fn packets(&self) -> Vec<Packets> {
        let of = |arithmetic: Arithmetic| match arithmetic {
            Arithmetic::Single => &self.lanes[..],
            Arithmetic::Double => &[Width::Eight],
        };
        let each = |&arithmetic: &Arithmetic| of(arithmetic).iter().map(move |&width| (arithmetic, width));
        self.arithmetic.iter().flat_map(each).collect()
    }
}

/// One setting, ready to be measured.
enum Work<'a> {
    Primary { octree: &'a Octree, camera: &'a Camera, size: [u32; 2], options: VisibilityOptions },
    Secondary { octree: &'a Octree, rays: &'a SecondaryRays, arithmetic: Arithmetic, width: Width },
}

impl Work<'_> {
    fn run(&self, picture: &mut Visibility, count_steps: bool) -> anyhow::Result<Counts> {
        Ok(match *self {
            Work::Primary { octree, camera, size, options } => {
                picture.trace(octree, camera, size, &VisibilityOptions { count_steps, ..options })?
            }
            Work::Secondary { octree, rays, arithmetic, width } => {
                rays.trace(octree, arithmetic, width, count_steps, picture)
            }
        })
    }
}

/// The best of some repetitions in seconds, what the rays met, and what the processor counted.
struct Best {
    seconds: f64,
    counts: Counts,
    events: Option<Events>,
}

fn measure(work: &Work<'_>, repeat: u32, counters: Option<&mut Counters>) -> anyhow::Result<Best> {
    let mut picture = Visibility::default();
    // Counting comes first: it also brings the octree into the caches.
    let counts = work.run(&mut picture, true)?;
    let mut seconds = f64::INFINITY;
    for _ in 0..repeat {
        let start = Instant::now();
        work.run(&mut picture, false)?;
        seconds = seconds.min(start.elapsed().as_secs_f64());
    }
    let events = match counters {
        Some(counters) => {
            let (result, events) = counters.count(|| work.run(&mut picture, false))?;
            result?;
            Some(events)
        }
        None => None,
    };
    Ok(Best { seconds, counts, events })
}

pub fn run(arguments: &Arguments, common: &CommonArgs) -> anyhow::Result<()> {
    let mut model = arguments.model.load(common)?;
    let camera = arguments.camera.camera(&model)?;
    let size = arguments.camera.size();
    let mut counters = if arguments.counters { open_counters() } else { None };
    let packets = arguments.packets();
    let mut views = Vec::new();
    let mut bytes_per_leaf = 0.0;
    for &grid in &arguments.grid {
        model.octree.set_grid(grid);
        let octree = &model.octree;
        bytes_per_leaf = octree.bytes() as f64 / octree.leaf_voxels().max(1) as f64;
        let mut add = |rays: Kind, lod: f64, beams: bool, packets: Packets, work: &Work<'_>| {
            let best = measure(work, arguments.repeat, counters.as_mut())?;
            views.push(Measured::new(rays, octree.grid_size(), lod, beams, packets, &best));
            anyhow::Ok(())
        };
        for (&kind, &lod_pixels) in
            arguments.rays.iter().flat_map(|kind| arguments.lod.iter().map(move |lod| (kind, lod)))
        {
            let secondary = match kind {
                Kind::Primary => None,
                Kind::Shadow => Some(SecondaryKind::Shadow),
                Kind::Ambient => Some(SecondaryKind::Ambient),
                Kind::Reflection => Some(SecondaryKind::Reflection),
            };
            if let Some(secondary) = secondary {
                let rays = SecondaryRays::new(octree, &camera, size, lod_pixels, secondary)?;
                for &(arithmetic, width) in &packets {
                    let work = Work::Secondary { octree, rays: &rays, arithmetic, width };
                    add(kind, lod_pixels, false, (arithmetic, width), &work)?;
                }
                continue;
            }
            for (&beams, &(arithmetic, width)) in
                arguments.beams.iter().flat_map(|beams| packets.iter().map(move |packets| (beams, packets)))
            {
                let options = VisibilityOptions { arithmetic, width, lod_pixels, beams, count_steps: false };
                let work = Work::Primary { octree, camera: &camera, size, options };
                add(kind, lod_pixels, beams, (arithmetic, width), &work)?;
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

/// The processor's counters, or a warning why there are none.
fn open_counters() -> Option<Counters> {
    match Counters::open() {
        Ok(counters) => Some(counters),
        Err(error) => {
            eprintln!("warning: the processor's counters cannot be read here: {error}");
            None
        }
    }
}

impl Measured {
    fn new(rays: Kind, grid: u32, lod: f64, beams: bool, (arithmetic, width): Packets, best: &Best) -> Self {
        let Best { seconds, counts, events } = best;
        let of_rays = |count: u64| if counts.rays == 0 { 0.0 } else { count as f64 / counts.rays as f64 };
        let packet_steps = (counts.lane_steps / u64::from(width.lanes())).max(1) as f64;
        Self {
            rays,
            arithmetic,
            lanes: width.lanes(),
            grid,
            beams,
            lod,
            threads: rayon::current_num_threads(),
            mrays_per_s: counts.rays as f64 / seconds / 1e6,
            ms: seconds * 1e3,
            hit_fraction: of_rays(counts.hits),
            steps_per_ray: of_rays(counts.steps),
            lane_utilisation: counts.steps as f64 / counts.lane_steps.max(1) as f64,
            counters: events.map(|events| PerPacketStep {
                cycles: events.cycles as f64 / packet_steps,
                instructions: events.instructions as f64 / packet_steps,
                cache_misses: events.cache_misses as f64 / packet_steps,
                branch_misses: events.branch_misses as f64 / packet_steps,
            }),
        }
    }
}

fn print_table(report: &Report) -> anyhow::Result<()> {
    print_line(&format!(
        "{}: {}³, {} leaf voxels, {:.2} bytes each, {}",
        report.model, report.resolution, report.leaf_voxels, report.bytes_per_leaf, report.instruction_set
    ))?;
    let with_counters = report.views.iter().any(|view| view.counters.is_some());
    print_line(&format!(
        "      rays  arithmetic  lanes  grid  beams   lod  threads    ms/picture  million rays/s   ratio   hits  steps/ray  lanes used{}",
        if with_counters {
            "  per packet step: cycles  instructions  cache misses  branch misses"
        } else {
            ""
        }
    ))?;
    let first = report.views.first().map_or(1.0, |view| view.mrays_per_s);
    for view in &report.views {
        let counters = view.counters.as_ref().map_or(String::new(), |counters| {
            format!(
                " {:>24.1} {:>13.1} {:>13.3} {:>14.3}",
                counters.cycles, counters.instructions, counters.cache_misses, counters.branch_misses
            )
        });
        print_line(&format!(
            "{:>10} {:>11} {:>6} {:>5} {:>6} {:>5} {:>8} {:>13.2} {:>15.2} {:>7.2} {:>5.1}% {:>10.2} {:>10.0}%{counters}",
            format!("{:?}", view.rays).to_lowercase(),
            view.arithmetic.name(),
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
            100.0 * view.lane_utilisation,
        ))?;
    }
    Ok(())
}
