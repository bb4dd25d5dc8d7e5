//! `obj2vox`: a mesh in, a `.vox` file out.

use anyhow::Context;
use clap::Parser;
use octvox_cli::{CommonArgs, Progress, grouped};
use octvox_converter::{Compression, FileFormat, LodColor, Options, Report, convert, load_mesh};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

/// Converts a triangle mesh (OBJ with MTL, PLY, STL, glTF 2.0 or GLB) to a sparse voxel octree.
///
/// The content of the file tells its kind, and where it does not, the ending of its name. Textures and materials that are
/// missing are warnings.
///
/// The longest axis of the model fills the cube, unless --bounds or --voxel-size say otherwise.
#[derive(Debug, Parser)]
#[command(
    name = "obj2vox",
    version,
    after_help = "Example: obj2vox bunny.obj -o bunny.vox -r 1024\n\
                  reads bunny.obj and the materials it names, and writes an octree of 1024 cells per axis."
)]
struct Args {
    /// The mesh to convert: .obj, .ply, .stl, .gltf or .glb
    #[arg(value_name = "MODEL.obj")]
    model: PathBuf,
    /// The file to write [default: the model's name with the extension .vox, in the current folder]
    #[arg(short, long, value_name = "MODEL.vox")]
    output: Option<PathBuf>,
    /// Cells per axis, a power of two from 1 to 16384
    #[arg(short, long, value_name = "N", default_value = "1024", value_parser = parse_resolution, conflicts_with = "depth")]
    resolution: u8,
    /// Depth of the octree, 0 to 14: the resolution as a power of two
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(0..=i64::from(Options::MAX_DEPTH)))]
    depth: Option<u8>,
    /// Version of the file format: 4 as in Bohnen 2009, or 5 with materials, finer normals and the way back to the world
    #[arg(long, value_name = "VERSION", default_value = "4", value_parser = ["4", "5"])]
    format: String,
    /// How version 5 makes its subtrees shorter [default: zstd]
    #[arg(long, value_name = "METHOD", value_parser = ["none", "zstd"])]
    compression: Option<String>,
    /// Largest number of palette entries, 1 to 32767; similar colours are merged if there are more
    #[arg(long, value_name = "N", default_value = "32767", value_parser = clap::value_parser!(u16).range(1..=32767))]
    palette: u16,
    /// Fill every voxel that a triangle touches, instead of the thinnest surface that is closed
    #[arg(long)]
    conservative: bool,
    /// Move the surface as the displacement maps of its materials say
    #[arg(long)]
    displace: bool,
    /// Fill the inside of closed models, and of those with holes that leave no doubt where it is
    #[arg(long)]
    solid: bool,
    /// Colour of the coarser levels: the mean of the light below, or the one that most children have
    #[arg(long, value_name = "RULE", default_value = "mean", value_parser = ["mean", "majority"])]
    lod_color: String,
    /// Keep eight equal leaves instead of replacing them by their parent
    #[arg(long)]
    no_prune: bool,
    /// Largest angle in degrees between faces that look like one curved surface; matters where the model has no normals
    #[arg(long, value_name = "DEGREES", default_value = "60")]
    crease: f64,
    /// The region that fills the cube, in world units; the model must lie in it
    #[arg(
        long,
        value_name = "XMIN,YMIN,ZMIN,XMAX,YMAX,ZMAX",
        value_delimiter = ',',
        num_args = 1,
        allow_hyphen_values = true
    )]
    bounds: Option<Vec<f64>>,
    /// Length of a voxel's edge in world units; the cube is centred on the model, or begins at the minimum of --bounds
    #[arg(long, value_name = "S")]
    voxel_size: Option<f64>,
    /// Memory that may be taken, such as 800M or 2G; what has no room waits in a temporary file beside the output
    /// [default: three quarters of the free memory]
    #[arg(long, value_name = "BYTES", value_parser = octvox_cli::parse_byte_size)]
    memory: Option<u64>,
    /// Begin even if memory or disk seem to be too small
    #[arg(long)]
    force: bool,
    #[command(flatten)]
    common: CommonArgs,
}

fn parse_resolution(text: &str) -> Result<u8, String> {
    let max = 1u32 << Options::MAX_DEPTH;
    match text.parse::<u32>() {
        Ok(cells) if cells.is_power_of_two() && cells <= max => Ok(cells.trailing_zeros() as u8),
        _ => Err(format!("must be a power of two from 1 to {max}")),
    }
}

fn main() -> ExitCode {
    octvox_cli::run(|| run(&Args::parse()))
}

fn run(args: &Args) -> anyhow::Result<()> {
    let start = Instant::now();
    args.common.start_thread_pool()?;
    let output = match &args.output {
        Some(output) => output.clone(),
        None => default_output(&args.model)?,
    };
    anyhow::ensure!(
        !is_same_file(&args.model, &output),
        "{}: is the model itself; name another output with -o",
        output.display()
    );
    let options = options(args, &output)?;
    options.check()?;

    let progress = Progress::new(1, args.common.quiet);
    let result = read_and_convert(args, &options, &output, &progress);
    // Before anything else is printed.
    progress.finish();
    let mut report = result?;
    report.seconds.total = start.elapsed().as_secs_f64();
    report.peak_memory_bytes = octvox_cli::peak_memory_bytes();

    for warning in &report.warnings {
        eprintln!("warning: {warning}");
    }
    if args.common.json { octvox_cli::print_json(&report) } else { print_table(&report, &output) }
}

fn read_and_convert(
    args: &Args,
    options: &Options,
    output: &Path,
    progress: &Progress,
) -> anyhow::Result<Report> {
    let start = Instant::now();
    progress.stage("read", 1);
    let mesh = load_mesh(&args.model)?;
    let read = start.elapsed().as_secs_f64();
    let mut report = octvox_cli::write_file_atomically(output, |mut file| {
        convert(&mesh, options, progress, &mut file).with_context(|| args.model.display().to_string())
    })?;
    report.seconds.read = read;
    Ok(report)
}

fn options(args: &Args, output: &Path) -> anyhow::Result<Options> {
    let bounds = match &args.bounds {
        None => None,
        Some(numbers) => Some(<[f64; 6]>::try_from(numbers.as_slice()).map_err(|_| {
            anyhow::anyhow!("--bounds has {} numbers; expected xmin,ymin,zmin,xmax,ymax,zmax", numbers.len())
        })?),
    };
    Ok(Options {
        depth: args.depth.unwrap_or(args.resolution),
        palette_size: args.palette.into(),
        prune: !args.no_prune,
        conservative: args.conservative,
        displace: args.displace,
        solid: args.solid,
        lod_color: if args.lod_color == "mean" { LodColor::Mean } else { LodColor::Majority },
        crease_degrees: args.crease,
        format: file_format(args)?,
        bounds,
        voxel_size: args.voxel_size,
        memory: args.memory.or_else(three_quarters_of_free_memory),
        folder: output.parent().map(Path::to_path_buf),
        force: args.force,
    })
}

fn three_quarters_of_free_memory() -> Option<u64> {
    octvox_cli::available_memory_bytes().map(|bytes| bytes / 4 * 3)
}

fn file_format(args: &Args) -> anyhow::Result<FileFormat> {
    let compression = args.compression.as_deref();
    if args.format == "4" {
        anyhow::ensure!(compression.is_none(), "--compression is for version 5; add --format 5");
        return Ok(FileFormat::Version4);
    }
    let compression = if compression == Some("none") { Compression::None } else { Compression::Zstandard };
    Ok(FileFormat::Version5 { compression })
}

/// Whether both names lead to one file that is there.
fn is_same_file(model: &Path, output: &Path) -> bool {
    matches!((model.canonicalize(), output.canonicalize()), (Ok(model), Ok(output)) if model == output)
}

fn default_output(model: &Path) -> anyhow::Result<PathBuf> {
    let name = model.file_stem().with_context(|| format!("{}: is no file; name a mesh", model.display()))?;
    Ok(PathBuf::from(name).with_extension("vox"))
}

fn print_table(report: &Report, output: &Path) -> anyhow::Result<()> {
    let seconds = &report.seconds;
    let mut lines = vec![
        format!("{}", output.display()),
        format!("  triangles      {:>15}", grouped(report.triangles)),
        format!("  resolution     {:>15}", format!("{}³", report.resolution)),
        format!("  leaf voxels    {:>15}", grouped(report.leaf_voxels)),
        format!("  estimated      {:>15}", grouped(report.estimate.leaf_voxels)),
        format!("  stored voxels  {:>15}", grouped(report.stored_voxels)),
        format!("  bytes          {:>15}", grouped(report.file_bytes)),
        format!("  palette        {:>15}", palette_summary(report)),
    ];
    if report.temporary_bytes > 0 {
        lines.push(format!(
            "  temporary      {:>15}",
            format!("{} MiB", grouped(report.temporary_bytes >> 20))
        ));
    }
    if let Some(bytes) = report.peak_memory_bytes {
        lines.push(format!("  peak memory    {:>15}", format!("{} MiB", grouped(bytes >> 20))));
    }
    lines.push(format!(
        "  seconds        {:>15.3}  (read {:.3}, scan {:.3}, palette {:.3}, build {:.3}, write {:.3})",
        seconds.total, seconds.read, seconds.scan, seconds.palette, seconds.build, seconds.write
    ));
    octvox_cli::print_line(&lines.join("\n"))
}

fn palette_summary(report: &Report) -> String {
    if report.palette_size == report.colors_found {
        grouped(report.palette_size)
    } else {
        format!("{} of {}", grouped(report.palette_size), grouped(report.colors_found))
    }
}
