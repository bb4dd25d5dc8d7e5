//! `voxtrace render`: pictures of a model or a scene.

use crate::camera::CameraArguments;
use crate::model::{Model, ModelArguments, load};
use crate::picture_file::{PictureKind, write_frame, write_png};
use crate::region::{check_within, parse_frames, parse_region};
use anyhow::{Context, bail, ensure};
use octvox_cli::{CommonArgs, Progress, print_json, print_line};
use octvox_raytracer::scene::Scene;
use octvox_raytracer::{
    Aov, Arithmetic, Camera, Filter, Frame, Leave, Lens, Octree, Quality, RayCounts, Region, RenderOptions,
    RenderReport, SceneFile, TileDone, Tone, ToneMapping, render_scene,
};
use serde::Serialize;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    #[command(flatten)]
    model: ModelArguments,
    /// The picture to write: .png as displayed, .exr with amounts of light
    #[arg(short, long, value_name = "PICTURE")]
    output: PathBuf,
    #[command(flatten)]
    camera: CameraArguments,
    #[command(flatten)]
    quality: QualityArguments,
    /// Further pictures beside the first: PICTURE.depth.png and so on; in an .exr, further channels
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = parse_aov)]
    aov: Vec<Aov>,
    /// Render a part of the picture, X,Y,W,H in pixels from the upper left corner, and leave the rest transparent; see
    /// `voxtrace merge`
    #[arg(long, value_name = "X,Y,W,H", value_parser = parse_region)]
    region: Option<Region>,
    /// Frames of a scene that moves, such as 10..20 (without 20), each to a picture of its own: PICTURE.0010.png and so on
    /// [default: all]
    #[arg(long, value_name = "FRAMES", value_parser = parse_frames)]
    frames: Option<Range<u32>>,
    /// Stop after this time with the best picture by then, such as 2s or 500ms; rays are added until then wherever they
    /// are needed, or until no pixel needs more
    #[arg(long, value_name = "TIME", value_parser = parse_time)]
    time: Option<Duration>,
    /// Leave out shadows, where the scene is a model alone
    #[arg(long)]
    no_shadows: bool,
    /// Multiply all light by this
    #[arg(long, value_name = "FACTOR", value_parser = parse_positive)]
    exposure: Option<f32>,
    /// What becomes of light that is brighter than white: clip, reinhard or filmic [default: clip]
    #[arg(long, value_name = "NAME", value_parser = parse_mapping)]
    tone: Option<ToneMapping>,
    /// Print the effects that were simulated, and the rays sent for each
    #[arg(long)]
    stats: bool,
}

/// What a picture may approximate. What is not given is as the scene file says.
#[derive(clap::Args)]
struct QualityArguments {
    /// Rays through each pixel [default: 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    samples: Option<u32>,
    /// Rays through a pixel that is displayed unlike its neighbours [default: as many as through each]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=65_536))]
    most_samples: Option<u32>,
    /// Difference from which on a pixel is unlike its neighbours, as a share of the whole range; 0: any [default: 0.02]
    #[arg(long, value_name = "SHARE", value_parser = parse_share)]
    contrast: Option<f32>,
    /// How the rays about a pixel count: box, tent or gaussian [default: box]
    #[arg(long, value_name = "NAME", value_parser = parse_filter)]
    filter: Option<Filter>,
    /// End rays at cells that look no larger than this many pixels; 0: at the finest cells [default: 0.25, and
    /// with more than four rays through a pixel half the distance between them: 0.5 over the square root of their number]
    #[arg(long, value_name = "PIXELS", value_parser = parse_pixels)]
    lod: Option<f64>,
    /// How rays leave a surface: surface (past all of it), voxel (past its voxel alone) or raised (from above it)
    /// [default: surface]
    #[arg(long, value_name = "NAME", value_parser = parse_leave)]
    leave: Option<Leave>,
    /// Rays to each lamp that has an extent, for each point seen [default: 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    light_samples: Option<u32>,
    /// Rays for light from around, for each point seen [default: 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    ambient_samples: Option<u32>,
    /// How often light is followed further by mirrors and glass [default: 8]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=1024))]
    bounces: Option<u32>,
    /// Send no rays that bring less light than this; 0: send all [default: half a step of a picture of 8 bits]
    #[arg(long, value_name = "LIGHT", value_parser = parse_share)]
    cutoff: Option<f32>,
    /// Smooth voxels that look larger than this many pixels [default: leave cubes as they are]
    #[arg(long, value_name = "PIXELS", value_parser = parse_pixels)]
    smooth: Option<f64>,
    /// How precisely rays are followed: single or double [default: single]
    #[arg(long, value_name = "NAME", value_parser = parse_arithmetic)]
    arithmetic: Option<Arithmetic>,
}

const EXAMPLES: &str = "\
Examples:
  voxtrace render bunny.vox -o bunny.png --samples 4
  voxtrace render bunny.obj -r 512 -o bunny.png --eye 0.8,0.7,1.1 --target 0.5,0.5,0.5
  voxtrace render bunny.vox -o bunny.png --aov depth,normal,steps,level
  voxtrace render scene.toml -o scene.exr --stats
  voxtrace render scene.toml -o still.png --time 2s
  voxtrace render turntable.toml -o turn.png --frames 10..20";

/// Rays through a pixel at the most, where only the time is bounded.
const ENDLESS: u32 = 4096;

#[derive(Serialize)]
struct Report {
    width: u32,
    height: u32,
    seconds: Seconds,
    plan: Vec<&'static str>,
    rays: RayCounts,
    /// For the JSON alone: it takes as long as some pictures do.
    #[serde(skip_serializing_if = "Option::is_none")]
    image_hash: Option<String>,
    hit_pixels: u64,
    /// If there is more than one frame: its number, and the picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    frame: Option<u32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    picture: Option<PathBuf>,
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

fn parse_filter(text: &str) -> Result<Filter, String> {
    Filter::from_name(text)
        .ok_or_else(|| format!("expected one of {}", Filter::ALL.map(Filter::name).join(", ")))
}

fn parse_leave(text: &str) -> Result<Leave, String> {
    Leave::from_name(text)
        .ok_or_else(|| format!("expected one of {}", Leave::ALL.map(Leave::name).join(", ")))
}

pub fn parse_arithmetic(text: &str) -> Result<Arithmetic, String> {
    Arithmetic::from_name(text)
        .ok_or_else(|| format!("expected one of {}", Arithmetic::ALL.map(Arithmetic::name).join(", ")))
}

fn parse_mapping(text: &str) -> Result<ToneMapping, String> {
    let names = || ToneMapping::ALL.map(ToneMapping::name).join(", ");
    ToneMapping::from_name(text).ok_or_else(|| format!("expected one of {}", names()))
}

fn parse_share(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(share) if (0.0..=1.0).contains(&share) => Ok(share),
        _ => Err("expected a number from 0 to 1".into()),
    }
}

fn parse_positive(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(number) if number > 0.0 && number <= 1e6 => Ok(number),
        _ => Err("expected a number above 0, up to 1000000".into()),
    }
}

fn parse_time(text: &str) -> Result<Duration, String> {
    let seconds = match text.strip_suffix("ms") {
        Some(milliseconds) => milliseconds.trim().parse::<f64>().map(|time| time / 1e3),
        None => text.strip_suffix('s').unwrap_or(text).trim().parse::<f64>(),
    };
    match seconds {
        Ok(seconds) if (0.0..=1e6).contains(&seconds) => Ok(Duration::from_secs_f64(seconds)),
        _ => Err("expected a time such as 2s or 500ms".into()),
    }
}

/// What is to be rendered, loaded.
enum Subject {
    Model(Box<Model>),
    Scene { file: Box<SceneFile>, octrees: Vec<Octree> },
}

/// A picture of it.
struct Shot<'a> {
    scene: Scene<'a>,
    camera: Camera,
    lens: Lens,
}

pub fn run(arguments: &Arguments, common: &CommonArgs) -> anyhow::Result<()> {
    PictureKind::of(&arguments.output)?;
    let start = Instant::now();
    let subject = Subject::load(&arguments.model, common)?;
    let load = start.elapsed().as_secs_f64();

    let all = subject.frames();
    let frames = arguments.frames.clone().unwrap_or(0..all);
    ensure!(
        frames.end <= all,
        "{}: has {all} frames, counted from 0, so there is no frame {}",
        arguments.model.model.display(),
        frames.end - 1
    );
    let is_sequence = all > 1;
    let options = options(arguments, &subject)?;
    if let Some(region) = &options.region {
        check_within(region, options.size)?;
    }
    if options.region.is_some() && !arguments.aov.is_empty() {
        // Their brightness depends on all of the picture.
        ensure!(
            PictureKind::of(&arguments.output)? == PictureKind::Exr,
            "--aov with --region is for .exr, whose channels can be merged"
        );
    }
    if let (Subject::Scene { .. }, true) = (&subject, arguments.no_shadows) {
        bail!("--no-shadows is for a model alone; a scene's lamps have `shadow = false`");
    }
    let mut reports = Vec::new();
    for number in frames {
        let output = if is_sequence { numbered(&arguments.output, number) } else { arguments.output.clone() };
        let shot = subject.shot(number, arguments, options.size)?;
        let (frame, done, trace) = render_with_progress(&shot, &options, common)?;
        let start = Instant::now();
        write_frame(&output, &frame)?;
        if PictureKind::of(&output)? == PictureKind::Png {
            for &aov in &arguments.aov {
                let pixels = frame.aov(aov).context("the frame was rendered without first hits")?;
                let path = output.with_extension(format!("{}.png", aov.name()));
                write_png(&path, options.size, &pixels)?;
            }
        }
        let write = start.elapsed().as_secs_f64();
        let seconds = Seconds { load: if reports.is_empty() { load } else { 0.0 }, trace, write };
        let [width, height] = options.size;
        let report = Report {
            width,
            height,
            seconds,
            plan: done.plan.names(),
            rays: done.rays,
            image_hash: common.json.then(|| format!("{:016x}", frame.hash())),
            hit_pixels: frame.hit_pixels,
            frame: is_sequence.then_some(number),
            picture: is_sequence.then(|| output.clone()),
        };
        if !common.json {
            print_report(&output, &report, arguments.stats)?;
        }
        reports.push(report);
    }
    match &reports[..] {
        _ if !common.json => Ok(()),
        [report] if !is_sequence => print_json(report),
        reports => print_json(&serde_json::json!({ "frames": reports })),
    }
}

impl Subject {
    fn load(arguments: &ModelArguments, common: &CommonArgs) -> anyhow::Result<Self> {
        if !arguments.is_scene() {
            return Ok(Self::Model(Box::new(arguments.load(common)?)));
        }
        ensure!(
            arguments.resolution.is_none(),
            "{}: is a scene, whose models have a resolution each; -r is for a mesh alone",
            arguments.model.display()
        );
        let file = Box::new(SceneFile::open(&arguments.model)?);
        let octree = |model: octvox_raytracer::ModelFile| {
            let place = || format!("{}:{}", arguments.model.display(), model.line);
            Ok(load(&model.path, model.depth, common).with_context(place)?.octree)
        };
        let octrees = file.models().map(octree).collect::<anyhow::Result<_>>()?;
        Ok(Self::Scene { file, octrees })
    }

    fn frames(&self) -> u32 {
        match self {
            Self::Model(_) => 1,
            Self::Scene { file, .. } => file.frames(),
        }
    }

    fn shot(&self, frame: u32, arguments: &Arguments, size: [u32; 2]) -> anyhow::Result<Shot<'_>> {
        match self {
            Self::Model(model) => {
                let camera = arguments.camera.camera(model)?;
                let mut scene = Scene::of_model(&model.octree, &camera);
                if arguments.no_shadows {
                    scene.lights.iter_mut().for_each(|light| light.shadow = false);
                }
                Ok(Shot { scene, camera, lens: Lens::default() })
            }
            Self::Scene { file, octrees } => {
                let aspect = f64::from(size[0]) / f64::from(size[1]);
                let shot = file.shot(frame, aspect, octrees)?;
                let camera = arguments.camera.of_scene(shot.camera)?;
                let mut scene = shot.scene;
                if shot.studio {
                    scene.light_as_studio(&camera);
                }
                Ok(Shot { scene, camera, lens: shot.lens })
            }
        }
    }
}

fn options(arguments: &Arguments, subject: &Subject) -> anyhow::Result<RenderOptions> {
    let (of_file, tone, size) = match subject {
        Subject::Model(_) => (Quality::default(), Tone::default(), None),
        Subject::Scene { file, .. } => (file.quality(), file.tone(), file.size()),
    };
    let given = &arguments.quality;
    let mut quality = of_file;
    let follows = of_file.lod_pixels == of_file.lod_of_its_rays();
    if let Some(samples) = given.samples {
        quality.samples = samples;
        quality.most_samples = quality.most_samples.max(samples);
        if of_file.most_samples == of_file.samples {
            quality.most_samples = samples;
        }
    }
    if let Some(most) = given.most_samples {
        ensure!(
            most >= quality.samples,
            "--most-samples {most} is less than the {} rays through each pixel",
            quality.samples
        );
        quality.most_samples = most;
    } else if arguments.time.is_some() && quality.most_samples == quality.samples {
        quality.most_samples = ENDLESS.max(quality.samples);
    }
    if follows {
        // From the number of rays that there is now.
        quality.lod_pixels = quality.lod_of_its_rays();
    }
    quality.contrast = given.contrast.unwrap_or(quality.contrast);
    quality.filter = given.filter.unwrap_or(quality.filter);
    quality.lod_pixels = given.lod.unwrap_or(quality.lod_pixels);
    quality.light_samples = given.light_samples.unwrap_or(quality.light_samples);
    quality.ambient_samples = given.ambient_samples.unwrap_or(quality.ambient_samples);
    quality.bounces = given.bounces.unwrap_or(quality.bounces);
    quality.cutoff = given.cutoff.unwrap_or(quality.cutoff);
    quality.leave = given.leave.unwrap_or(quality.leave);
    quality.smooth_pixels = given.smooth.unwrap_or(quality.smooth_pixels);
    quality.arithmetic = given.arithmetic.unwrap_or(quality.arithmetic);
    Ok(RenderOptions {
        size: arguments.camera.size.or(size).unwrap_or(CameraArguments::DEFAULT_SIZE),
        region: arguments.region,
        quality,
        tone: Tone {
            exposure: arguments.exposure.unwrap_or(tone.exposure),
            mapping: arguments.tone.unwrap_or(tone.mapping),
        },
        first_hits: !arguments.aov.is_empty(),
        light: PictureKind::of(&arguments.output)? == PictureKind::Exr,
        time_limit: arguments.time,
        ..RenderOptions::default()
    })
}

/// Also gives the seconds that it took.
fn render_with_progress(
    shot: &Shot<'_>,
    options: &RenderOptions,
    common: &CommonArgs,
) -> anyhow::Result<(Frame, RenderReport, f64)> {
    let size = options.region.map_or(options.size, |region| region.size);
    let pixels = size.map(u64::from).iter().product();
    let progress = Progress::new(pixels, common.quiet);
    progress.stage("rendering", pixels);
    let start = Instant::now();
    let sent = AtomicU64::new(0);
    let tell = |done: TileDone| {
        let sent = sent.fetch_add(done.rays, Ordering::Relaxed) + done.rays;
        progress.note(format!(
            "  {:.1} million rays a second",
            sent as f64 / start.elapsed().as_secs_f64() / 1e6
        ));
        progress.add(done.pixels);
    };
    let (frame, report) = render_scene(&shot.scene, &shot.camera, &shot.lens, options, tell)?;
    let seconds = start.elapsed().as_secs_f64();
    progress.finish();
    Ok((frame, report, seconds))
}

fn print_report(output: &Path, report: &Report, stats: bool) -> anyhow::Result<()> {
    let Report { width, height, rays, seconds, .. } = report;
    let Seconds { load, trace, write } = seconds;
    print_line(&format!(
        "{}: {width}x{height}, {} rays, {:.1} million a second",
        output.display(),
        rays.total(),
        rays.total() as f64 / trace / 1e6
    ))?;
    if stats {
        print_line(&format!("plan: {}", report.plan.join(", ")))?;
        let RayCounts { primary, shadow, reflection, refraction, ambient } = rays;
        print_line(&format!(
            "rays: primary {primary}, shadow {shadow}, reflection {reflection}, refraction {refraction}, \
             ambient {ambient}"
        ))?;
    }
    print_line(&format!("seconds: load {load:.3}, trace {trace:.3}, write {write:.3}"))
}

/// The picture of a frame: its number stands before the extension.
fn numbered(output: &Path, frame: u32) -> PathBuf {
    let extension = output.extension().unwrap_or_default().to_string_lossy();
    output.with_extension(format!("{frame:04}.{extension}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times() {
        assert_eq!(parse_time("2s"), Ok(Duration::from_secs(2)));
        assert_eq!(parse_time("500ms"), Ok(Duration::from_millis(500)));
        assert_eq!(parse_time("0.25"), Ok(Duration::from_millis(250)));
        for text in ["", "s", "-1s", "2m", "NaN", "inf", "1e9s"] {
            assert!(parse_time(text).is_err(), "{text}");
        }
    }

    #[test]
    fn frames_have_their_number_before_the_extension() {
        assert_eq!(numbered(Path::new("a/turn.png"), 7), Path::new("a/turn.0007.png"));
        assert_eq!(numbered(Path::new("x.y.exr"), 12345), Path::new("x.y.12345.exr"));
    }
}
