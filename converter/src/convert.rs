//! The way from a mesh to a file.

use crate::binning::Bins;
use crate::block::BlockGrid;
use crate::color_census::ColorCensus;
use crate::coloring::Coloring;
use crate::displacement::displaced;
use crate::octree::{Build, Octree};
use crate::options::FileFormat;
use crate::output::write_file;
use crate::palette::PaletteMap;
use crate::placement;
use crate::resources::room_in_memory;
use crate::solid::Inside;
use crate::storage::Storage;
use crate::subtree::{Rule, scan};
use crate::surface::Surface;
use crate::{ConvertError, Estimate, Material, Mesh, Options, Report, Seconds};
use octvox_cli::Progress;
use std::io::Write;
use std::time::Instant;

/// Converts a mesh and writes it to `out` as a `.vox` file.
///
/// The bytes depend on the mesh and the options alone, not on the number of threads, nor on the order of the triangles.
/// Work runs on the current rayon pool. `out` need not be buffered.
///
/// # Errors
/// What [`Options::check`] finds; [`ConvertError::OutsideCube`] and [`ConvertError::ExtentTooLarge`] if the mesh does not
/// fit; [`ConvertError::AllCutOut`] if no voxel is left of it; [`ConvertError::MemoryBound`] or [`ConvertError::DiskSpace`] if there is too little memory or disk for it;
/// [`ConvertError::TemporaryFile`]; [`ConvertError::Write`] if `out` fails.
pub fn convert(
    mesh: &Mesh,
    options: &Options,
    progress: &Progress,
    out: &mut impl Write,
) -> Result<Report, ConvertError> {
    options.check()?;
    mesh.check()?;
    let start = Instant::now();
    let displaced = if options.displace { displaced(mesh, options)? } else { None };
    let seconds = start.elapsed().as_secs_f64();
    let shape = displaced.as_ref().unwrap_or(mesh);
    let mut report =
        convert_blocks(shape, options, BlockGrid::new(options.depth), room_in_memory, progress, out)?;
    report.seconds.scan += seconds;
    report.seconds.total += seconds;
    // What the pieces of a displaced surface are cut from.
    report.triangles = mesh.triangles.len() as u64;
    report.degenerate_triangles = mesh.degenerate_triangles();
    let is_flat = |material: &&Material| material.displacement_map.is_some() && !options.displace;
    report.warnings.extend(mesh.materials.iter().filter(is_flat).map(|material| {
        format!("material {} has a displacement map; --displace moves the surface by it", material.name)
    }));
    Ok(report)
}

/// [`convert`] with a chosen cut into blocks, and `room` telling how many bytes of voxels may wait in memory. Options and
/// mesh have been checked.
pub(crate) fn convert_blocks(
    mesh: &Mesh,
    options: &Options,
    grid: BlockGrid,
    room: impl FnOnce(&Estimate, &Options) -> Result<u64, ConvertError>,
    progress: &Progress,
    out: &mut impl Write,
) -> Result<Report, ConvertError> {
    let start = Instant::now();
    let mut stopwatch = Stopwatch(start);
    let mut seconds = Seconds::default();

    let world = placement::place(mesh, options)?;
    let code = options.format.normal_code();
    let rule = if options.conservative { Rule::Touched } else { Rule::Thin };
    let estimate = Estimate::new(mesh, world, options);
    progress.say(&estimate.to_string());
    let surface = Surface::new(mesh, world, options)?;
    let bins = Bins::new(&surface.vertices, surface.triangles, grid, rule.contact());
    let storage = Storage::new(room(&estimate, options)?, options.folder_of_temporary_files());
    let subtrees = scan(&surface, &bins, grid, rule, code, &storage, progress)?;
    drop(bins);
    if subtrees.is_empty() {
        return Err(ConvertError::AllCutOut);
    }
    let inside =
        if options.solid { Inside::find(&subtrees, &surface, grid, &storage)? } else { Inside::default() };
    let finishes = surface.finishes.finishes.clone();
    drop(surface);
    seconds.scan = stopwatch.lap();

    let census = ColorCensus::take(&subtrees, finishes.len(), &storage)?;
    let palette = PaletteMap::new(&census, &finishes, options.palette_size, progress)?;
    seconds.palette = stopwatch.lap();

    let warnings = mesh.warnings.iter().chain(&inside.warning).cloned().collect();
    let coloring = Coloring { census: &census, palette: &palette, lod_color: options.lod_color };
    let build = Build { coloring, inside, grid, normal_code: code, prune: options.prune };
    let octree = Octree::build(subtrees, &build, &storage, progress)?;
    seconds.build = stopwatch.lap();

    let file_bytes = write_file(options.format, palette.entries(), &octree, world, &storage, progress, out)?;
    seconds.write = stopwatch.lap();
    seconds.total = start.elapsed().as_secs_f64();

    Ok(Report {
        triangles: mesh.triangles.len() as u64,
        degenerate_triangles: mesh.degenerate_triangles(),
        resolution: options.resolution(),
        format: options.format.version(),
        depth: options.depth,
        leaf_voxels: octree.leaf_voxels,
        nodes: octree.nodes,
        stored_voxels: match options.format {
            FileFormat::Version4 => 1 + 8 * octree.nodes,
            FileFormat::Version5 { .. } => octree.filled_voxels(),
        },
        thesis_voxels: 1 + 8 * octree.unpruned_nodes,
        colors_found: census.len() as u64,
        palette_size: palette.entries().len() as u64,
        palette_error: palette.error(),
        file_bytes,
        estimate,
        temporary_bytes: storage.file_bytes(),
        peak_memory_bytes: octvox_cli::peak_memory_bytes(),
        seconds,
        warnings,
        world,
    })
}

/// Measures one stage after the other.
struct Stopwatch(Instant);

impl Stopwatch {
    /// Seconds since the last lap.
    fn lap(&mut self) -> f64 {
        let now = Instant::now();
        let seconds = now.duration_since(self.0).as_secs_f64();
        self.0 = now;
        seconds
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Compression;

    /// A fan of large and small triangles with colours of their own.
    fn fan() -> Mesh {
        let mut positions = vec![[0.0, 0.0, 0.0]];
        let mut triangles = Vec::new();
        for k in 0..40u32 {
            let angle = f64::from(k * k);
            let reach = 1.0 / f64::from(k + 1);
            positions.push([reach * angle.cos(), reach * angle.sin(), reach * (3.0 * angle).sin()]);
            triangles.push([0, k, k + 1]);
        }
        let materials = (0..40).map(|k| Material::matte("", [f64::from(k) / 40.0; 3])).collect();
        Mesh::new(positions, triangles)
            .and_then(|mesh| mesh.with_materials(materials, (0..40).collect()))
            .unwrap()
    }

    /// With walls through many blocks.
    fn tetrahedron() -> Mesh {
        let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.1, 0.2], [0.1, 1.0, 0.3], [0.3, 0.2, 1.0]];
        Mesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]).unwrap()
    }

    #[test]
    fn the_cut_into_blocks_does_not_matter() {
        let mesh = fan();
        for (depth, conservative) in [(5, false), (5, true), (7, false)] {
            let options = Options { depth, conservative, ..Options::default() };
            let bytes = |block_depth| {
                let grid = BlockGrid::with_block_depth(depth, block_depth);
                let mut bytes = Vec::new();
                convert_blocks(&mesh, &options, grid, |_, _| Ok(u64::MAX), &Progress::hidden(), &mut bytes)
                    .unwrap();
                bytes
            };
            let expected = bytes(6);
            assert!(expected.len() > 1000);
            for block_depth in 0..6 {
                assert!(bytes(block_depth) == expected, "depth {depth}, blocks of {block_depth} levels");
            }
        }
    }

    #[test]
    fn what_has_room_in_memory_does_not_matter() {
        let versions = [FileFormat::Version4, FileFormat::Version5 { compression: Compression::None }];
        for (format, solid) in versions.into_iter().flat_map(|format| [(format, false), (format, true)]) {
            let mesh = if solid { tetrahedron() } else { fan() };
            let options = Options { depth: 7, format, solid, ..Options::default() };
            let convert = |room| {
                let grid = BlockGrid::with_block_depth(7, 4);
                let mut bytes = Vec::new();
                let progress = Progress::hidden();
                let report =
                    convert_blocks(&mesh, &options, grid, |_, _| Ok(room), &progress, &mut bytes).unwrap();
                (bytes, report.temporary_bytes)
            };
            let (expected, temporary) = convert(u64::MAX);
            assert_eq!(temporary, 0);
            let mut last = 0;
            for room in [3000, 0] {
                let (bytes, temporary) = convert(room);
                assert!(bytes == expected, "{room}, solid: {solid}");
                assert!(temporary > last, "{room}: {temporary} bytes");
                last = temporary;
            }
        }
    }

    #[test]
    fn the_cut_into_blocks_does_not_matter_to_the_inside() {
        let mesh = tetrahedron();
        let options = Options { depth: 6, solid: true, ..Options::default() };
        let convert = |block_depth, room| {
            let grid = BlockGrid::with_block_depth(6, block_depth);
            let mut bytes = Vec::new();
            let progress = Progress::hidden();
            let report =
                convert_blocks(&mesh, &options, grid, |_, _| Ok(room), &progress, &mut bytes).unwrap();
            (bytes, report.leaf_voxels, report.thesis_voxels)
        };
        let expected = convert(6, u64::MAX);
        for block_depth in 0..6 {
            for room in [u64::MAX, 0] {
                assert!(convert(block_depth, room) == expected, "blocks of {block_depth} levels, {room}");
            }
        }
    }

    #[test]
    fn a_writer_that_fails_is_an_error() {
        struct Full(usize);
        impl Write for Full {
            fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
                self.0 = self.0.checked_sub(bytes.len()).ok_or(std::io::ErrorKind::StorageFull)?;
                Ok(bytes.len())
            }
            fn flush(&mut self) -> std::io::Result<()> {
                Ok(())
            }
        }
        for room in [0, 20, 300] {
            let error =
                convert(&fan(), &Options::default(), &Progress::hidden(), &mut Full(room)).unwrap_err();
            assert!(matches!(error, ConvertError::Write(_)), "{error}");
        }
    }

    #[test]
    fn options_out_of_range_are_refused() {
        let refused = |options: Options| {
            convert(&fan(), &options, &Progress::hidden(), &mut Vec::new()).unwrap_err().to_string()
        };
        let options = Options::default;
        assert!(
            refused(Options { depth: 15, ..options() }).contains("0 (one cell) to 14 (16384 cells per axis)")
        );
        for size in [0, 32_768] {
            assert!(refused(Options { palette_size: size, ..options() }).contains("choose 1 to 32767"));
        }
        for degrees in [-1.0, 181.0, f64::NAN] {
            assert!(refused(Options { crease_degrees: degrees, ..options() }).contains("choose 0 to 180"));
        }
        for size in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-320, 1e308] {
            assert!(refused(Options { voxel_size: Some(size), ..options() }).contains("positive number"));
        }
        for bounds in [[0.0; 6], [0.0, 0.0, 0.0, 1.0, 1.0, f64::NAN], [-1e308, 0.0, 0.0, 1e308, 1.0, 1.0]] {
            assert!(refused(Options { bounds: Some(bounds), ..options() }).contains("are no box"));
        }
    }
}
