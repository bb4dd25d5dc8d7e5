//! `voxtrace study`: what accuracy costs in time.
//!
//! ```text
//!  subject ──▶ knobs ──▶ measure ──▶ errors ──▶ results ──▶ front, report
//!  (meshes)   (settings) (time, picture) (against truth and exact)
//!                 chapters (tables) ─────────────┘
//! ```

mod chapters;
mod commands;
mod errors;
mod front;
mod knobs;
mod machine;
mod measure;
mod record;
mod report;
mod results;
mod runner;
mod subject;

use crate::camera::CameraArguments;
use crate::counters::Counters;
use crate::model::{self, ModelArguments};
use anyhow::{Context, ensure};
use commands::Commands;
use knobs::Base;
use measure::{Measuring, Repetitions};
use octvox_cli::{CommonArgs, Progress, print_json, print_line};
use octvox_converter::Options;
use octvox_raytracer::{Camera, Plan, Quality};
use record::{Knob, Study};
use results::Results;
use runner::Runner;
use std::path::{Path, PathBuf};
use subject::{Conversion, Prepared, Subject};

#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    #[command(flatten)]
    model: ModelArguments,
    /// Folder of the report; what has been measured in it already is not measured again
    #[arg(short, long, value_name = "FOLDER")]
    output: PathBuf,
    #[command(flatten)]
    camera: CameraArguments,
    /// The short study, of about a minute: small pictures, of one ray through each pixel by default, fewer settings, nothing
    /// finer than 1024³
    #[arg(long)]
    quick: bool,
    /// Forget what has been measured in the folder
    #[arg(long)]
    anew: bool,
    /// Cells along each axis that no mesh is converted to more than [default: 8192, with --quick 1024]
    #[arg(long, value_name = "CELLS", value_parser = model::parse_resolution)]
    finest: Option<u8>,
    /// Rays of the check at each resolution [default: 1e6, with --quick 1e4]
    #[arg(long, value_name = "N", value_parser = crate::check::parse_count)]
    check_rays: Option<u64>,
    /// A folder with the models of the thesis, for its table 6
    #[arg(long, value_name = "FOLDER")]
    thesis_models: Option<PathBuf>,
    /// The frame of a scene that is studied
    #[arg(long, value_name = "NUMBER", default_value_t = 0)]
    frame: u32,
}

const EXAMPLES: &str = "\
Examples:
  voxtrace study bunny.obj -o study --quick
  voxtrace study bunny.obj -o study                    the whole of it; goes on where it was stopped
  voxtrace study scene.toml -o study --size 640x360

The report is FOLDER/report.html; all figures are in FOLDER/results.csv, plots in FOLDER/plots.";

impl Arguments {
    fn size(&self, subject: &Subject) -> [u32; 2] {
        let default = if self.quick { [328, 160] } else { [656, 320] };
        self.camera.size.or(subject.size().filter(|_| !self.quick)).unwrap_or(default)
    }

    fn finest(&self) -> u8 {
        self.finest.unwrap_or(if self.quick { 10 } else { 13 })
    }

    /// The camera of the subject, but for what is asked for.
    fn camera_of(
        &self,
        subject: &Subject,
        prepared: &Prepared,
        size: [u32; 2],
        camera: Camera,
    ) -> anyhow::Result<Camera> {
        if subject.is_scene() {
            return self.camera.of_scene(camera);
        }
        self.camera.of_model(&prepared.octrees[0], prepared.worlds[0].as_ref(), size)
    }

    /// What tells this study from others in the same folder.
    fn fingerprint(&self, size: [u32; 2], view: &subject::View) -> String {
        let model = &self.model.model;
        let length = std::fs::metadata(model).map_or(0, |metadata| metadata.len());
        let [width, height] = size;
        let subject::View { camera, .. } = view;
        format!(
            "{}, {length} bytes, {width}x{height}, resolution {:?}, finest {}, frame {}, {}, {camera:?}, {} threads, {}",
            model.display(),
            self.model.resolution,
            self.finest(),
            self.frame,
            if self.quick { "quick" } else { "full" },
            rayon::current_num_threads(),
            env!("CARGO_PKG_VERSION"),
        )
    }
}

pub fn run(arguments: &Arguments, common: &CommonArgs) -> anyhow::Result<()> {
    let subject = Subject::load(&arguments.model, arguments.frame)?;
    let size = arguments.size(&subject);
    let prepared = subject.prepare(&Conversion::default())?;
    let (scene, view) = subject.shot(&prepared, size)?;
    let view = subject::View { camera: arguments.camera_of(&subject, &prepared, size, view.camera)?, ..view };
    let (own_quality, tone) = subject.quality_and_tone();
    let mut quality = own_quality;
    if arguments.quick {
        // A scene may ask for a hundred rays through each pixel.
        quality =
            Quality { samples: 1, most_samples: 1, lod_pixels: Quality::default().lod_pixels, ..quality };
    }
    let finest = arguments.finest();
    ensure!(finest <= Options::MAX_DEPTH, "--finest: no more than {}", 1u32 << Options::MAX_DEPTH);
    let base = Base {
        depths: subject.depths(),
        finest,
        plan: Plan::new(&scene, &view.lens, &quality),
        colors: prepared.octrees.iter().map(|octree| octree.palette().len()).sum(),
        quality,
        is_quick: arguments.quick,
        is_one_model: !subject.is_scene(),
    };
    drop(scene);
    let fingerprint = arguments.fingerprint(size, &view);
    let results = Results::open(&arguments.output, &fingerprint, arguments.anew)?;
    let repetitions = if arguments.quick { Repetitions::QUICK } else { Repetitions::FULL };
    let measuring = Measuring {
        subject: &subject,
        view: &view,
        size,
        tone,
        repetitions,
        counters: Counters::open().ok(),
    };
    let ladders = base.ladders();
    let settings: usize = ladders.iter().map(|ladder| ladder.choices.len()).sum();
    let progress = Progress::new(0, common.quiet);
    progress.stage("measuring", settings as u64);
    let commands = Commands {
        model: arguments.model.model.display().to_string(),
        view: arguments.camera.without_size(),
        size,
        frame: subject.is_scene().then_some(arguments.frame),
        quality: own_quality,
        base: &base,
    };
    let mut runner = Runner::new(measuring, &base, commands, results, arguments.output.clone(), prepared);
    let knobs: Vec<Knob> = ladders.iter().map(|ladder| ladder.knob.clone()).collect();
    for ladder in &ladders {
        runner.measure(ladder, &progress)?;
    }
    progress.stage("tables", 4);
    let thesis_models = arguments.thesis_models.as_deref().map(models_in).transpose()?.unwrap_or_default();
    let check_rays = arguments.check_rays.unwrap_or(if arguments.quick { 10_000 } else { 1_000_000 });
    runner.chapters(check_rays, &thesis_models, &progress)?;
    progress.finish();

    let study: Study = runner.finish(commands::this_command(), knobs)?;
    report::write(&arguments.output, &study)?;
    tell(&study, &arguments.output, common)
}

/// What the study comes down to.
fn tell(study: &Study, folder: &Path, common: &CommonArgs) -> anyhow::Result<()> {
    let front = front::front(study);
    let on_front =
        front.settings.iter().filter_map(|&number| Some((&study.settings[number], front.point(number)?)));
    let defaults = study.settings.iter().enumerate().filter(|(_, setting)| setting.is_default);
    let farthest = defaults.filter_map(|(number, _)| front.distance(number)).fold(1.0, f64::max);
    let report = folder.join("report.html");
    if common.json {
        let points: Vec<_> = on_front
            .map(|(setting, point)| {
                serde_json::json!({
                    "knob": setting.knob,
                    "setting": setting.label,
                    "seconds": point.seconds,
                    "error": point.error,
                })
            })
            .collect();
        return print_json(&serde_json::json!({
            "report": report,
            "settings": study.settings.len(),
            "front": points,
            "farthest_default": farthest,
        }));
    }
    print_line(&format!("{}: {} settings; the front:", report.display(), study.settings.len()))?;
    for (setting, point) in on_front {
        print_line(&format!(
            "{:>10.2} ms  {:>8.5}  {} {}",
            point.seconds * 1e3,
            point.error,
            setting.knob,
            setting.label
        ))?;
    }
    print_line(&format!("the farthest default is {farthest:.2} times as far as the front"))
}

/// The meshes of a folder, by name.
fn models_in(folder: &Path) -> anyhow::Result<Vec<(String, PathBuf)>> {
    let named = || format!("{}: cannot be read", folder.display());
    let mut models = Vec::new();
    for entry in std::fs::read_dir(folder).with_context(named)? {
        let path = entry.with_context(named)?.path();
        if path.extension().is_some_and(|extension| extension == "obj") {
            models.push((path.file_name().unwrap_or_default().to_string_lossy().into_owned(), path));
        }
    }
    models.sort();
    Ok(models)
}
