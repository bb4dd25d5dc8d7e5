//! Tables 6 to 10 of Bohnen 2009 again, its figures beside those of today.

use super::super::measure::Repetitions;
use super::super::record::{Chapter, Table};
use octvox_cli::{Progress, grouped};
use octvox_converter::{FileFormat, Mesh, Options, convert};
use octvox_format::v5::Compression;
use octvox_raytracer::scene::Scene;
use octvox_raytracer::{
    Camera, DEFAULT_FOV, Lens, Octree, Quality, RenderOptions, Visibility, VisibilityOptions, Width,
    render_scene,
};

/// Columns and rows of the pictures in all of its tables.
const SIZE: [u32; 2] = [1312, 640];

/// Models of tables 7 to 10, in this order.
const MODELS: [&str; 4] = ["al", "bunny", "porsche", "world"];

/// Table 6: model, depth, millions of voxels, frames a second on eight cores of 2.8 GHz (MPRO) and on two of 2.16 GHz (MBP).
const TABLE_6: [(&str, u8, f64, f64, f64); 11] = [
    ("al", 11, 32.8, 12.6, 2.1),
    ("al", 12, 131.8, 10.8, 1.8),
    ("bunny", 11, 17.4, 13.3, 2.2),
    ("bunny", 12, 69.7, 11.0, 1.9),
    ("porsche", 12, 72.4, 12.4, 2.1),
    ("soccerball", 11, 48.2, 8.5, 1.4),
    ("teapot", 11, 18.4, 12.5, 2.1),
    ("world", 10, 1.3, 16.8, 2.9),
    ("world", 11, 5.4, 15.5, 2.7),
    ("world", 12, 21.4, 14.2, 2.5),
    ("world", 13, 85.5, 13.0, 2.3),
];

/// Table 7: frames a second on MBP at 1³, 2³, 4³ … 4096³.
const TABLE_7: [[f64; 4]; 13] = [
    [6.6, 6.5, 6.7, 6.5],
    [5.8, 5.8, 5.8, 5.9],
    [5.2, 5.4, 5.0, 5.0],
    [4.9, 4.5, 4.8, 4.7],
    [4.4, 4.1, 4.5, 4.2],
    [4.0, 3.8, 4.2, 3.9],
    [3.7, 3.6, 3.9, 3.7],
    [3.4, 3.3, 3.6, 3.5],
    [3.1, 3.0, 3.3, 3.2],
    [2.7, 2.8, 3.0, 2.9],
    [2.4, 2.5, 2.7, 2.7],
    [2.1, 2.2, 2.4, 2.5],
    [1.8, 1.9, 2.1, 2.3],
];

/// Table 8: frames a second on MBP at 1024³ with level of detail 1, in the final version, and with single rays.
const TABLE_8: [[f64; 4]; 3] = [[6.6, 6.5, 6.7, 6.5], [2.4, 2.5, 2.7, 2.7], [0.8, 0.9, 0.9, 0.9]];

/// Table 9: frames a second on MBP at 1024³ without a grid, and with one of 1³, 2³, 4³ … 256³.
const TABLE_9: [[f64; 4]; 10] = [
    [1.6, 1.6, 1.8, 1.9],
    [1.4, 1.5, 1.7, 1.8],
    [1.6, 1.7, 2.1, 2.3],
    [1.8, 1.9, 2.1, 2.3],
    [2.0, 2.1, 2.3, 2.5],
    [2.2, 2.3, 2.5, 2.7],
    [2.3, 2.4, 2.6, 2.8],
    [2.4, 2.5, 2.7, 2.7],
    [2.3, 2.4, 2.6, 2.6],
    [2.0, 2.0, 2.3, 2.2],
];

/// Table 10: voxels at 1³, 2³, 4³ … 4096³.
const TABLE_10: [[u64; 4]; 13] = [
    [1, 1, 1, 1],
    [9, 9, 9, 9],
    [73, 73, 73, 73],
    [265, 329, 201, 193],
    [1_265, 1_129, 841, 657],
    [5_473, 4_553, 3_937, 2_217],
    [24_385, 17_825, 16_553, 7_489],
    [110_257, 70_377, 68_633, 26_361],
    [474_561, 275_697, 277_113, 95_145],
    [1_979_673, 1_097_625, 1_116_641, 356_305],
    [8_101_857, 4_376_273, 4_504_929, 1_377_457],
    [32_803_289, 17_467_009, 18_095_137, 5_415_561],
    [131_827_905, 69_798_129, 72_457_401, 21_471_993],
];

/// What is not in the thesis.
const NOTHING: &str = "–";

/// A model at a resolution, ready to be timed.
struct Model {
    octree: Octree,
    thesis_voxels: u64,
    leaf_voxels: u64,
    camera: Camera,
    repetitions: Repetitions,
}

impl Model {
    fn new(mesh: &Mesh, depth: u8, repetitions: Repetitions) -> anyhow::Result<Self> {
        let format = FileFormat::Version5 { compression: Compression::None };
        let options = Options { depth, format, ..Options::default() };
        let mut file = Vec::new();
        let report = convert(mesh, &options, &Progress::hidden(), &mut file)?;
        let octree = Octree::from_bytes(&file)?;
        let aspect = f64::from(SIZE[0]) / f64::from(SIZE[1]);
        let camera = Camera::framing(&octree, aspect, DEFAULT_FOV);
        Ok(Self {
            octree,
            thesis_voxels: report.thesis_voxels,
            leaf_voxels: report.leaf_voxels,
            camera,
            repetitions,
        })
    }

    /// Pictures a second; the thesis's have neither shadows nor mirrors.
    fn frames(&self, quality: Quality, width: Width, shadows: bool) -> anyhow::Result<f64> {
        let mut scene = Scene::of_model(&self.octree, &self.camera);
        scene.lights.iter_mut().for_each(|light| light.shadow &= shadows);
        let quality = Quality { bounces: 0, ..quality };
        let options = RenderOptions { size: SIZE, quality, width, light: false, ..RenderOptions::default() };
        let time = self.repetitions.time(|| {
            render_scene(&scene, &self.camera, &Lens::default(), &options, |_| {})?;
            Ok(())
        })?;
        Ok(1.0 / time.median)
    }

    /// How often a second it can be told what the middle of each pixel shows.
    fn looks(&self, options: VisibilityOptions) -> anyhow::Result<f64> {
        let mut seen = Visibility::default();
        let time = self.repetitions.time(|| {
            seen.trace(&self.octree, &self.camera, SIZE, &options)?;
            Ok(())
        })?;
        Ok(1.0 / time.median)
    }
}

/// The tables of a mesh, whose `name` tells whether the thesis has it, up to an octree of a depth. Also those of other
/// meshes for table 6: names and files, loaded one after the other.
pub fn thesis(
    name: &str,
    mesh: &Mesh,
    deepest: u8,
    repetitions: Repetitions,
    others: &[(String, std::path::PathBuf)],
) -> anyhow::Result<Chapter> {
    let column = MODELS.iter().position(|model| name.to_lowercase().starts_with(model));
    let theirs =
        move |row: &[f64; 4]| column.map_or_else(|| NOTHING.into(), |column| format!("{:.1}", row[column]));
    let (mut rows_7, mut rows_10) = (Vec::new(), Vec::new());
    let mut previous = 0u64;
    let mut rows_6 = Vec::new();
    for depth in 0..=deepest {
        let model = Model::new(mesh, depth, repetitions)?;
        let resolution = format!("{}³", 1u32 << depth);
        let frames = model.frames(Quality::default(), Width::FASTEST, false)?;
        let exact = model.frames(Quality { lod_pixels: 0.0, ..Quality::default() }, Width::FASTEST, false)?;
        let row = usize::from(depth);
        rows_7.push(vec![
            resolution.clone(),
            TABLE_7.get(row).map_or_else(|| NOTHING.into(), theirs),
            format!("{exact:.1}"),
            format!("{frames:.1}"),
        ]);
        let count = TABLE_10.get(row).zip(column).map(|(row, column)| grouped(row[column]));
        let growth = if previous > 0 {
            format!("{:.2}", model.thesis_voxels as f64 / previous as f64)
        } else {
            NOTHING.into()
        };
        previous = model.thesis_voxels;
        rows_10.push(vec![
            resolution,
            count.unwrap_or_else(|| NOTHING.into()),
            grouped(model.thesis_voxels),
            growth,
            grouped(model.leaf_voxels),
        ]);
        rows_6.extend(row_6(name, depth, frames));
    }
    for (name, path) in others.iter().filter(|(other, _)| other != name) {
        let mesh = octvox_converter::load_mesh(path)?;
        for &(_, depth, ..) in TABLE_6.iter().filter(|row| is_of(name, row.0) && row.1 <= deepest) {
            let model = Model::new(&mesh, depth, repetitions)?;
            rows_6.extend(row_6(name, depth, model.frames(Quality::default(), Width::FASTEST, false)?));
        }
    }

    let threads = rayon::current_num_threads();
    let mut tables = Vec::new();
    let columns = |names: &[&str]| names.iter().map(|&name| name.into()).collect();
    if !rows_6.is_empty() {
        tables.push(Table {
            title: "Table 6: frames a second".into(),
            note: format!("Theirs: eight cores of 2.8 GHz, and two of 2.16 GHz. Today's: {threads} threads of this machine."),
            columns: columns(&["model", "resolution", "theirs, 8 cores", "theirs, 2 cores", "today"]),
            rows: rows_6,
        });
    }
    tables.push(Table {
        title: "Table 7: frames a second over the resolution".into(),
        note: "Theirs: two cores of 2.16 GHz.".into(),
        columns: columns(&["resolution", "theirs", "today, finest cells", "today, cells of a quarter pixel"]),
        rows: rows_7,
    });
    let model = Model::new(mesh, deepest.min(10), repetitions)?;
    tables.push(stages(&model, theirs)?);
    tables.push(grids(model, theirs)?);
    tables.push(Table {
        title: "Table 10: voxels".into(),
        note: "Filled and empty ones, eight for each node. Theirs are up to an eighth more: their scan conversion fills \
               somewhat thicker surfaces, their Bunny and World are not quite these."
            .into(),
        columns: columns(&["resolution", "theirs", "today", "times the row above", "filled finest cells"]),
        rows: rows_10,
    });
    let introduction = format!(
        "Tables of M. Bohnen, Ray Tracing von Volumendaten auf Basis des Augenblick-SDK, diploma thesis, Koblenz 2009: pictures \
         of {}×{} pixels with one ray through each, Phong shading, no shadows, no mirrors. The whole model is framed; from where theirs \
         were seen is not known.",
        SIZE[0], SIZE[1]
    );
    Ok(Chapter { title: "The tables of the thesis again".into(), introduction, tables })
}

/// Whether a file is of a model of table 6.
fn is_of(name: &str, model: &str) -> bool {
    name.to_lowercase().starts_with(model)
}

fn row_6(name: &str, depth: u8, frames: f64) -> Option<Vec<String>> {
    let &(model, _, _, eight, two) = TABLE_6.iter().find(|row| is_of(name, row.0) && row.1 == depth)?;
    let resolution = format!("{}³", 1u32 << depth);
    Some(vec![model.into(), resolution, format!("{eight:.1}"), format!("{two:.1}"), format!("{frames:.1}")])
}

/// Table 8: one stage after the other.
fn stages(model: &Model, theirs: impl Fn(&[f64; 4]) -> String) -> anyhow::Result<Table> {
    // So many pixels that the root is small enough.
    const ROOT: f64 = 1e6;
    let finest = Quality { lod_pixels: 0.0, ..Quality::default() };
    let coarsest = Quality { lod_pixels: ROOT, ..finest };
    let single = VisibilityOptions { width: Width::One, beams: false, ..VisibilityOptions::default() };
    let rows = [
        ("rays end at the root, shaded", theirs(&TABLE_8[0]), model.frames(coarsest, Width::FASTEST, false)?),
        ("what is seen, single rays, no beams", NOTHING.into(), model.looks(single)?),
        (
            "what is seen, packets, no beams",
            NOTHING.into(),
            model.looks(VisibilityOptions { width: Width::FASTEST, ..single })?,
        ),
        ("what is seen, packets and beams", NOTHING.into(), model.looks(VisibilityOptions::default())?),
        ("shaded", theirs(&TABLE_8[1]), model.frames(finest, Width::FASTEST, false)?),
        ("shaded, single rays", theirs(&TABLE_8[2]), model.frames(finest, Width::One, false)?),
        ("with shadows", NOTHING.into(), model.frames(finest, Width::FASTEST, true)?),
        (
            "with shadows, cells of a quarter pixel",
            NOTHING.into(),
            model.frames(Quality::default(), Width::FASTEST, true)?,
        ),
    ];
    let rows = rows.map(|(stage, theirs, today)| vec![stage.into(), theirs, format!("{today:.1}")]);
    Ok(Table {
        title: format!("Table 8: stages, at {}³", model.octree.resolution()),
        note: "Theirs: two cores of 2.16 GHz, packets of four.".into(),
        columns: ["stage", "theirs", "today"].map(String::from).to_vec(),
        rows: rows.to_vec(),
    })
}

/// Table 9: the grid through which rays enter.
fn grids(mut model: Model, theirs: impl Fn(&[f64; 4]) -> String) -> anyhow::Result<Table> {
    let mut rows = Vec::new();
    let without_beams = VisibilityOptions { beams: false, ..VisibilityOptions::default() };
    for level in 0..=8u8 {
        model.octree.set_grid(level);
        // Today a grid of one cell is none.
        let row = if level == 0 { 0 } else { usize::from(level) + 1 };
        rows.push(vec![
            if level == 0 { "none".into() } else { format!("{}³", 1u32 << level) },
            theirs(&TABLE_9[row]),
            format!("{:.1}", model.looks(without_beams)?),
            format!("{:.1}", model.looks(VisibilityOptions::default())?),
        ]);
    }
    Ok(Table {
        title: format!("Table 9: the grid, at {}³", model.octree.resolution()),
        note: "How often a second it is told what each pixel shows, at the finest cells. A node covers two levels and stands \
               in the cache from one ray to the next, so a grid saves a few steps only, and one beyond the caches costs some: \
               the plateau."
            .into(),
        columns: ["grid", "theirs", "today, no beams", "today, beams"].map(String::from).to_vec(),
        rows,
    })
}
