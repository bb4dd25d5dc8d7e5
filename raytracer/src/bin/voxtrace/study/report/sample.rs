//! A made-up study, to test reports with.

use super::super::record::{Chapter, Cost, Errors, Knob, Machine, Setting, Spread, Study, Table};
use std::path::Path;

/// What looks like a tag, and characters that stand for others or are outside of ASCII.
pub const AWKWARD: &str = "1024³ <fine> & \"crisp\" ü";

/// Settings of a knob: name, place, seconds, error against the truth.
type Row = (&'static str, f64, f64, f64);

const LOD: [Row; 9] = [
    ("8 pixels", 8.0, 0.0091, 0.141),
    ("4 pixels", 4.0, 0.0128, 0.0871),
    ("2 pixels", 2.0, 0.0201, 0.0522),
    ("1.5 pixels", 1.5, 0.0262, 0.0433),
    ("1 pixels", 1.0, 0.0352, 0.0311),
    ("0.7 pixels", 0.7, 0.0431, 0.0302),
    ("0.5 pixels", 0.5, 0.0501, 0.0297),
    ("0.25 pixels", 0.25, 0.0634, 0.0294),
    ("off", 0.0, 0.0712, 0.0293),
];

const RESOLUTION: [Row; 7] = [
    ("64³", 64.0, 0.0152, 0.182),
    ("128³", 128.0, 0.0191, 0.121),
    ("256³", 256.0, 0.0252, 0.0712),
    ("512³", 512.0, 0.0352, 0.0311),
    (AWKWARD, 1024.0, 0.0491, 0.0162),
    ("2048³", 2048.0, 0.0702, 0.0083),
    ("4096³", 4096.0, 0.112, 0.0061),
];

const SAMPLES: [Row; 8] = [
    ("1", 1.0, 0.0102, 0.0922),
    ("2", 2.0, 0.0183, 0.0533),
    ("4", 4.0, 0.0352, 0.0311),
    ("8", 8.0, 0.0691, 0.0242),
    ("16", 16.0, 0.136, 0.0191),
    ("64", 64.0, 0.541, 0.0152),
    ("256", 256.0, 2.14, 0.0043),
    ("1024", 1024.0, 8.61, 0.0011),
];

const SHADOWS: [Row; 6] = [
    ("off", 0.0, 0.0212, 0.131),
    ("1 ray", 1.0, 0.0352, 0.0311),
    ("4 rays", 4.0, 0.0782, 0.0262),
    ("16 rays", 16.0, 0.241, 0.0233),
    ("64 rays", 64.0, 0.903, 0.0222),
    ("256 rays", 256.0, 3.52, 0.0221),
];

const SMOOTHING: [Row; 4] = [
    ("off", 0.0, 0.0331, 0.0402),
    ("half", 0.5, 0.0341, 0.0352),
    ("full", 1.0, 0.0352, 0.0311),
    ("double", 2.0, 0.0371, 0.0391),
];

const BUDGET: [Row; 6] = [
    ("2 bounces", 2.0, 0.0282, 0.0612),
    ("3 bounces", 3.0, 0.0322, 0.0404),
    ("4 bounces", 4.0, 0.0352, 0.0311),
    ("6 bounces", 6.0, 0.0391, 0.0308),
    ("8 bounces", 8.0, 0.0402, 0.0307),
    ("32 bounces", 32.0, 0.0406, 0.0307),
];

/// A study of 40 settings without pictures.
pub fn study() -> Study {
    let knobs = vec![
        knob("lod", "Level of detail", "pixels", true),
        knob("resolution", "Resolution of the octree", "cells along a side", true),
        knob("samples", "Samples of a pixel", "samples", true),
        knob("shadows", "Soft shadows", "rays to a lamp", true),
        knob("smoothing", "Smoothing of normals", "strength", false),
        Knob { is_on_front: false, ..knob("bounces", "Bounces in glass & mirrors", "bounces", false) },
    ];
    let rows: [(&str, &[Row]); 6] = [
        ("lod", &LOD),
        ("resolution", &RESOLUTION),
        ("samples", &SAMPLES),
        ("shadows", &SHADOWS),
        ("smoothing", &SMOOTHING),
        ("bounces", &BUDGET),
    ];
    let settings = rows.iter().flat_map(|(knob, rows)| {
        rows.iter()
            .map(|row| Setting { is_exact: std::ptr::eq(row, &rows[rows.len() - 1]), ..of_row(knob, row) })
    });
    Study {
        title: "Shell & <friends>".to_string(),
        command: "voxtrace study samples/models/shell.obj -o out/study".to_string(),
        is_quick: true,
        machine: Machine {
            processor: "Example Processor 9000 (8 cores, 3.6 GHz)".to_string(),
            threads: 16,
            instruction_set: "x86-64-v3".to_string(),
            memory_bytes: 68_719_476_736,
            system: "Linux 6.1".to_string(),
            program: "voxtrace 0.1.0".to_string(),
        },
        size: [640, 400],
        truth: "The triangles themselves, followed by rays with 1,024 samples of a pixel. No voxels, no \
                approximation but that of the samples."
            .to_string(),
        truth_picture: None,
        knobs,
        settings: settings.collect(),
        chapters: vec![hard_rays(), empty_chapter()],
    }
}

fn knob(name: &str, title: &str, axis: &str, is_logarithmic: bool) -> Knob {
    Knob {
        name: name.to_string(),
        title: title.to_string(),
        axis: axis.to_string(),
        is_logarithmic,
        explanation: format!(
            "{title} is approximated more or less. All other knobs stand at their defaults, and the camera does \
             not move.\n\nCoarse settings are for a preview, and the last one leaves nothing out."
        ),
        default_reason: "A finer setting takes twice the time for an error that is hardly seen.".to_string(),
        is_on_front: true,
    }
}

fn of_row(knob: &str, &(label, place, seconds, error): &Row) -> Setting {
    let defaults = ["1 pixels", "512³", "4", "1 ray", "full", "4 bounces"];
    let mut setting = setting(knob, place);
    setting.label = label.to_string();
    setting.is_default = defaults.contains(&label);
    setting.cost.seconds =
        Spread { median: seconds, least: seconds * 0.97, most: seconds * 1.08, repetitions: 7 };
    setting.cost.instructions = Some((seconds * 4.1e10) as u64);
    setting.cost.rays = (seconds * 1.1e8) as u64;
    setting.cost.steps = (seconds * 9.3e8) as u64;
    setting.against_truth = Some(errors(error));
    // The last row of each is the exact one, which differs from itself by nothing.
    let exact = [0.0293, 0.0061, 0.0011, 0.0221, 0.0391, 0.0307]
        .into_iter()
        .find(|&exact| (exact - error).abs() < 1e-9)
        .map_or(error * 0.8, |_| 0.0);
    setting.against_exact = Some(Errors { other_voxels: None, ..errors(exact) });
    setting.command =
        format!("voxtrace render out/study/shell.vox --{knob} '{label}' --samples 4 -o {knob}.png");
    setting
}

/// A setting with some figures and the names of pictures.
pub fn setting(knob: &str, place: f64) -> Setting {
    Setting {
        knob: knob.to_string(),
        label: place.to_string(),
        place,
        is_default: false,
        is_exact: false,
        cost: Cost {
            seconds: Spread { median: 0.02, least: 0.019, most: 0.024, repetitions: 5 },
            instructions: None,
            rays: 1_048_576,
            steps: 9_876_543,
            bytes: 50_331_648 + (place * 1e4) as u64,
            relative: None,
            preparation: if knob == "resolution" { place * 0.003 } else { 0.0 },
        },
        against_exact: None,
        against_truth: None,
        picture: Some(format!("{knob}-{place}.png")),
        difference: Some(format!("{knob}-{place}-difference.png")),
        command: String::new(),
    }
}

fn errors(flip: f64) -> Errors {
    Errors {
        depth_voxels: flip * 21.3,
        depth_pixels: flip * 9.7,
        normal_degrees: flip * 310.0,
        color: flip * 143.0,
        ssim: 1.0 - flip,
        flip,
        silhouette: flip * 0.031,
        other_voxels: Some(flip * 0.41),
    }
}

fn empty_chapter() -> Chapter {
    Chapter { title: "Nothing yet".to_string(), introduction: String::new(), tables: Vec::new() }
}

fn hard_rays() -> Chapter {
    let row = |cells: [&str; 4]| cells.map(str::to_string).to_vec();
    Chapter {
        title: "Hard rays".to_string(),
        introduction: "Rays along faces & edges of cells, against exact arithmetic.".to_string(),
        tables: vec![
            Table {
                title: "Along faces".to_string(),
                note: "Errors are in 10⁻⁷ of the model's size; a dash is where nothing was met.".to_string(),
                columns: ["Rays", "Number", "Wrong", "Largest error"].map(str::to_string).to_vec(),
                rows: vec![
                    row(["along x < 0", "1,000,000", "0", "1.2 ulp"]),
                    row(["along y", "250,000", "0", "–"]),
                    row(["diagonal", "12,500", "3", "14.5 ulp"]),
                ],
            },
            Table { title: "Empty".to_string(), note: String::new(), columns: Vec::new(), rows: Vec::new() },
        ],
    }
}

/// Draws the pictures of a study: something round, and how far it is off.
pub fn draw_pictures(folder: &Path, study: &mut Study) {
    let [width, height] = study.size;
    let save = |name: &str, pixel: &dyn Fn(f64, f64) -> [f64; 3]| {
        let pixel = |x: u32, y: u32| {
            let scale = 1.0 / f64::from(height);
            let [x, y] = [x, y].map(|place| f64::from(place) * scale);
            image::Rgb(pixel(x, y).map(|value| (value.clamp(0.0, 1.0) * 255.0) as u8))
        };
        image::RgbImage::from_fn(width, height, pixel).save(folder.join(name)).unwrap();
    };
    let ball = |x: f64, y: f64, cells: f64| {
        let [x, y] = [x, y].map(|place| (place * cells).floor() / cells);
        let inside = 0.16 - (x - 0.8).powi(2) - (y - 0.5).powi(2);
        match inside > 0.0 {
            true => [0.3 + inside * 4.0, 0.35 + inside * 2.5, 0.5],
            false => [0.9 - y * 0.2, 0.93 - y * 0.2, 0.95],
        }
    };
    save("truth.png", &|x, y| ball(x, y, 1e6));
    study.truth_picture = Some("truth.png".to_string());
    for (index, setting) in study.settings.iter_mut().enumerate() {
        let cells = 3.0 / setting.against_truth.map_or(0.1, |errors| errors.flip);
        let names = [format!("{index}.png"), format!("{index}-difference.png")];
        save(&names[0], &|x, y| ball(x, y, cells));
        save(&names[1], &|x, y| {
            let (a, b) = (ball(x, y, 1e6), ball(x, y, cells));
            let difference = (a[0] - b[0]).abs() * 3.0;
            [difference, difference * 0.6, difference * 0.3]
        });
        let [picture, difference] = names;
        (setting.picture, setting.difference) = (Some(picture), Some(difference));
    }
}
