//! `voxtrace render`: a picture.

use crate::camera::CameraArguments;
use crate::model::ModelArguments;
use crate::picture_file::{write_frame, write_png};
use anyhow::{Context, bail};
use octvox_cli::{CommonArgs, Progress, print_json, print_line};
use octvox_raytracer::{Aov, Quality, RayCounts, RenderOptions, render};
use serde::Serialize;
use std::path::PathBuf;
use std::time::Instant;

#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    #[command(flatten)]
    model: ModelArguments,
    /// The picture to write, a PNG file
    #[arg(short, long, value_name = "PICTURE.png")]
    output: PathBuf,
    #[command(flatten)]
    camera: CameraArguments,
    /// Rays through each pixel
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=4096))]
    samples: u32,
    /// End rays at cells that look no larger than this many pixels; 0: at the finest cells [default: the distance between
    /// the rays of a pixel: 1 over the square root of their number]
    #[arg(long, value_name = "PIXELS", value_parser = parse_pixels)]
    lod: Option<f64>,
    /// Further pictures beside the first: PICTURE.depth.png and so on
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = parse_aov)]
    aov: Vec<Aov>,
}

const EXAMPLES: &str = "\
Examples:
  voxtrace render bunny.vox -o bunny.png --samples 4
  voxtrace render bunny.obj -r 512 -o bunny.png --eye 0.8,0.7,1.1 --target 0.5,0.5,0.5
  voxtrace render bunny.vox -o bunny.png --aov depth,normal,steps,level";

#[derive(Serialize)]
struct Report {
    width: u32,
    height: u32,
    seconds: Seconds,
    plan: Vec<&'static str>,
    rays: RayCounts,
    image_hash: String,
    hit_pixels: u64,
}

#[derive(Serialize)]
struct Seconds {
    load: f64,
    trace: f64,
    write: f64,
}

pub fn parse_pixels(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(pixels) if (0.0..=1e6).contains(&pixels) => Ok(pixels),
        _ => Err("expected a number of pixels from 0 to 1000000".into()),
    }
}

fn parse_aov(text: &str) -> Result<Aov, String> {
    let names = || Aov::ALL.map(Aov::name).join(", ");
    Aov::ALL.into_iter().find(|aov| aov.name() == text).ok_or_else(|| format!("expected some of {}", names()))
}

pub fn run(arguments: &Arguments, common: &CommonArgs) -> anyhow::Result<()> {
    let output = &arguments.output;
    if !output.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png")) {
        bail!("{}: pictures are written as PNG, name a file that ends in .png", output.display());
    }
    let start = Instant::now();
    let model = arguments.model.load(common)?;
    let load = start.elapsed().as_secs_f64();

    let camera = arguments.camera.camera(&model)?;
    let quality = Quality::of_samples(arguments.samples);
    let lod_pixels = arguments.lod.unwrap_or(quality.lod_pixels);
    let options = RenderOptions {
        size: arguments.camera.size,
        quality: Quality { lod_pixels, ..quality },
        first_hits: !arguments.aov.is_empty(),
        ..RenderOptions::default()
    };
    let [width, height] = options.size;
    let progress = Progress::new(u64::from(width) * u64::from(height), common.quiet);
    progress.stage("rendering", u64::from(width) * u64::from(height));
    let start = Instant::now();
    let (frame, done) = render(&model.octree, &camera, &options, |pixels| progress.add(pixels))?;
    let trace = start.elapsed().as_secs_f64();
    progress.finish();

    let start = Instant::now();
    write_frame(output, &frame)?;
    for &aov in &arguments.aov {
        let pixels = frame.aov(aov).context("the frame was rendered without first hits")?;
        write_png(&output.with_extension(format!("{}.png", aov.name())), [width, height], &pixels)?;
    }
    let write = start.elapsed().as_secs_f64();

    let report = Report {
        width,
        height,
        seconds: Seconds { load, trace, write },
        plan: done.plan.names(),
        rays: done.rays,
        image_hash: format!("{:016x}", frame.hash()),
        hit_pixels: frame.hit_pixels,
    };
    if common.json {
        return print_json(&report);
    }
    print_line(&format!(
        "{}: {width}x{height}, {} rays, {:.1} million a second",
        output.display(),
        done.rays.total(),
        done.rays.total() as f64 / trace / 1e6
    ))?;
    print_line(&format!("seconds: load {load:.3}, trace {trace:.3}, write {write:.3}"))
}
