//! How fast octvox finds what a pixel shows, beside Embree 3 with packets of 16 coherent rays: on the triangles of the same
//! model in the same place, and on the faces of its voxels.
//!
//! One thread; runs take turns, so that what disturbs one disturbs the others; medians.

mod embree;
mod faces;
mod view;

use anyhow::{Context, Result};
use clap::Parser;
use embree::Scene;
use octvox_cli::{Progress, instruction_set, print_json, print_line};
use octvox_converter::{Options, convert, load_mesh};
use octvox_raytracer::{Octree, Quality, RenderOptions, Visibility, VisibilityOptions, Width, render};
use serde::Serialize;
use std::path::PathBuf;
use std::time::Instant;
use view::{Picture, SIZE, View, views};

/// Compares octvox with Embree 3.
#[derive(Parser)]
#[command(after_help = "Example:\n  octvox-peers bunny.obj -r 1024")]
struct Arguments {
    /// The model, an .obj file
    model: PathBuf,
    /// Cells along each axis: a power of two
    #[arg(short, long, default_value_t = 1024)]
    resolution: u32,
    /// Runs of each tracer
    #[arg(long, default_value_t = 9, value_parser = clap::value_parser!(u32).range(5..))]
    repeat: u32,
    /// Print one JSON object instead of the table
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Report {
    model: String,
    resolution: u32,
    triangles: usize,
    quads: usize,
    leaf_voxels: u64,
    instruction_set: &'static str,
    lanes: u32,
    views: Vec<Measured>,
}

/// Medians for one view, in million rays per second on one thread.
#[derive(Serialize)]
struct Measured {
    view: &'static str,
    embree_triangles: f64,
    embree_quads: f64,
    octvox: f64,
    octvox_lod: f64,
    /// Without levels of detail: both end at the same faces.
    ratio_to_quads: f64,
    ratio_to_triangles: f64,
    lod_ratio_to_triangles: f64,
    /// Of the pixels in which one of two tracers hits, the share in which both do.
    agreement_with_quads: f64,
    agreement_with_triangles: f64,
    /// Median difference of distances where octvox and Embree's quads hit, in voxels.
    distance_from_quads: f64,
}

fn main() -> Result<()> {
    let arguments = Arguments::parse();
    // One thread, ours included.
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().context("cannot start the thread pool")?;

    let depth = arguments.resolution.trailing_zeros() as u8;
    let options = Options { depth, prune: false, ..Options::default() };
    options.check()?;
    anyhow::ensure!(arguments.resolution.is_power_of_two(), "-r: expected a power of two");
    let mesh = load_mesh(&arguments.model)?;
    let mut file = Vec::new();
    let world = convert(&mesh, &options, &Progress::hidden(), &mut file)?.world;
    let octree = Octree::from_bytes(&file)?;

    let triangles = faces::triangles(&mesh, &world, arguments.resolution);
    let quads = faces::exposed_faces(&octree, &file)?;
    let (triangle_count, quad_count) = (triangles.corners.len(), quads.corners.len());
    let [triangles, quads] = [Scene::of_triangles(&triangles)?, Scene::of_quads(&quads)?];

    let width = Width::FASTEST;
    let measure = |view: &View| measure(view, &octree, width, &triangles, &quads, arguments.repeat);
    let report = Report {
        model: arguments.model.display().to_string(),
        resolution: arguments.resolution,
        triangles: triangle_count,
        quads: quad_count,
        leaf_voxels: octree.leaf_voxels(),
        instruction_set: instruction_set(),
        lanes: width.lanes(),
        views: views().iter().map(measure).collect::<Result<_>>()?,
    };
    if arguments.json { print_json(&report) } else { print_table(&report) }
}

fn measure(
    view: &View,
    octree: &Octree,
    width: Width,
    triangles: &Scene,
    quads: &Scene,
    repeat: u32,
) -> Result<Measured> {
    let camera = &view.camera;
    let lod_pixels = Quality::default().lod_pixels;
    let [mut on_triangles, mut on_quads] = [Picture::new(), Picture::new()];
    let mut visibility = Visibility::default();
    let mut seconds: [Vec<f64>; 4] = Default::default();
    // The first round warms the caches up and does not count.
    for round in 0..=repeat {
        let mut timed = |tracer: usize, trace: &mut dyn FnMut() -> Result<()>| -> Result<()> {
            let start = Instant::now();
            trace()?;
            if round > 0 {
                seconds[tracer].push(start.elapsed().as_secs_f64());
            }
            Ok(())
        };
        let mut ours = |lod_pixels: f64| -> Result<()> {
            let options = VisibilityOptions { width, lod_pixels, ..VisibilityOptions::default() };
            visibility.trace(octree, camera, SIZE, &options)?;
            Ok(())
        };
        timed(0, &mut || {
            on_triangles.trace(triangles, camera);
            Ok(())
        })?;
        timed(2, &mut || ours(0.0))?;
        timed(1, &mut || {
            on_quads.trace(quads, camera);
            Ok(())
        })?;
        timed(3, &mut || ours(lod_pixels))?;
    }
    let rays = f64::from(SIZE[0] * SIZE[1]) / 1e6;
    let [embree_triangles, embree_quads, octvox, octvox_lod] = seconds.map(|seconds| rays / median(seconds));

    let quality = Quality { lod_pixels: 0.0, ..Quality::default() };
    let options = RenderOptions { size: SIZE, quality, width, first_hits: true, ..RenderOptions::default() };
    let (frame, _) = render(octree, camera, &options, |_| {})?;
    let ours: Vec<f32> = frame.first_hits.into_iter().flatten().map(|hit| hit.distance).collect();
    let both = ours.iter().zip(&on_quads.distance).filter(|(a, b)| a.is_finite() && b.is_finite());
    let differences = both.map(|(a, b)| f64::from((a - b).abs()) * f64::from(octree.resolution()));
    Ok(Measured {
        view: view.name,
        embree_triangles,
        embree_quads,
        octvox,
        octvox_lod,
        ratio_to_quads: octvox / embree_quads,
        ratio_to_triangles: octvox / embree_triangles,
        lod_ratio_to_triangles: octvox_lod / embree_triangles,
        agreement_with_quads: agreement(&ours, &on_quads.distance),
        agreement_with_triangles: agreement(&ours, &on_triangles.distance),
        distance_from_quads: median(differences.collect()),
    })
}

/// Of the pixels in which one of two pictures has a hit, the share in which both have.
fn agreement(first: &[f32], second: &[f32]) -> f64 {
    let hits = first.iter().zip(second).map(|(a, b)| [a.is_finite(), b.is_finite()]);
    let (mut one, mut both) = (0_u32, 0_u32);
    for [first, second] in hits {
        one += u32::from(first || second);
        both += u32::from(first && second);
    }
    f64::from(both) / f64::from(one.max(1))
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

fn print_table(report: &Report) -> Result<()> {
    print_line(&format!(
        "{}: {} triangles; at {}³ {} voxels with {} faces that show; {}, {} lanes",
        report.model,
        report.triangles,
        report.resolution,
        report.leaf_voxels,
        report.quads,
        report.instruction_set,
        report.lanes
    ))?;
    print_line("million rays per second, one thread")?;
    print_line(
        "view      Embree: triangles  voxel faces    octvox  with LOD    to triangles  with LOD  to voxel faces    same hits: triangles  voxel faces",
    )?;
    for view in &report.views {
        print_line(&format!(
            "{:<9} {:>17.2} {:>12.2} {:>9.2} {:>9.2} {:>14.2}x {:>8.2}x {:>14.2}x {:>23.2}% {:>11.2}%",
            view.view,
            view.embree_triangles,
            view.embree_quads,
            view.octvox,
            view.octvox_lod,
            view.ratio_to_triangles,
            view.lod_ratio_to_triangles,
            view.ratio_to_quads,
            100.0 * view.agreement_with_triangles,
            100.0 * view.agreement_with_quads,
        ))?;
    }
    Ok(())
}
