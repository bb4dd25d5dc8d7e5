//! `voxtrace` without arguments: the whole chain on a sample.

use crate::picture_file::write_frame;
use anyhow::{Context, bail};
use glam::DVec3;
use octvox_cli::{CommonArgs, Progress, print_line, write_atomically};
use octvox_converter::{Options, convert, load_mesh};
use octvox_raytracer::{Camera, Octree, Quality, RenderOptions, render};
use std::path::{Path, PathBuf};
use std::time::Instant;

/// The sample that is shown.
const SAMPLE: &str = "samples/models/shell.obj";

/// Where it looks best from.
const CAMERA: Camera = Camera {
    eye: DVec3::new(1.5, 0.95, 1.75),
    target: DVec3::new(0.5, 0.41, 0.5),
    up: DVec3::Y,
    vertical_fov: 32.5,
};

/// Where the results go, below the current folder.
const FOLDER: &str = "out";

pub fn run(common: &CommonArgs) -> anyhow::Result<()> {
    let sample = find_sample()?;
    let folder = Path::new(FOLDER);
    std::fs::create_dir_all(folder).with_context(|| format!("{FOLDER}: cannot make the folder"))?;
    let name = sample.file_stem().unwrap_or_default();
    let vox = folder.join(name).with_extension("vox");
    let png = folder.join(name).with_extension("png");

    let start = Instant::now();
    let mesh = load_mesh(&sample)?;
    let progress = Progress::new(1, common.quiet);
    let report = write_atomically(&vox, |out| {
        convert(&mesh, &Options::default(), &progress, out).with_context(|| sample.display().to_string())
    })?;
    progress.finish();
    print_line(&format!(
        "converted {} ({} triangles) to {}: {}³ cells, {} voxels, {:.1} MB, {:.2} s",
        sample.display(),
        report.triangles,
        vox.display(),
        report.resolution,
        report.leaf_voxels,
        report.file_bytes as f64 / 1e6,
        start.elapsed().as_secs_f64()
    ))?;

    let start = Instant::now();
    let octree = Octree::open(&vox)?;
    let options =
        RenderOptions { size: [1312, 820], quality: Quality::of_samples(4), ..RenderOptions::default() };
    let [width, height] = options.size;
    let (frame, done) = render(&octree, &CAMERA, &options, |_| {})?;
    write_frame(&png, &frame)?;
    print_line(&format!(
        "rendered {}: {width}x{height} pixels, {} rays, {:.2} s",
        png.display(),
        done.rays.total(),
        start.elapsed().as_secs_f64()
    ))?;
    print_line("next:")?;
    let vox = vox.display();
    for hint in [
        format!(
            "cargo run --release -- render {vox} -o out/close.png --eye 0.72,0.72,1.45 --target 0.47,0.55,0.45 --fov 26"
        ),
        format!("cargo run --release -- bench {vox}"),
        "cargo run --release -p octvox-converter -- YOUR_MODEL.obj -r 1024 -o out/model.vox".to_string(),
    ] {
        print_line(&format!("  {hint}"))?;
    }
    Ok(())
}

/// The sample below the current folder, or in the source tree that this program was built from.
fn find_sample() -> anyhow::Result<PathBuf> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let places = [PathBuf::from(SAMPLE), source.join(SAMPLE)];
    match places.into_iter().find(|place| place.is_file()) {
        Some(place) => Ok(place),
        None => bail!("{SAMPLE}: not found here; run in the project's folder, or see --help"),
    }
}
