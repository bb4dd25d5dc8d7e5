//! Measures setting after setting, and keeps what is compared with.

use super::chapters::{differences, hard_rays, normal_codes, thesis};
use super::commands::Commands;
use super::errors::Comparison;
use super::knobs::{Base, Choice, Ladder, Primary, Work};
use super::machine::this_machine;
use super::measure::{Measuring, Shown};
use super::record::{Chapter, Cost, Errors, Knob, Setting, Spread, Study};
use super::results::Results;
use super::subject::{Conversion, Prepared};
use crate::picture_file::write_png;
use anyhow::Context;
use octvox_cli::Progress;
use octvox_converter::Options;
use octvox_format::NormalCode;
use octvox_raytracer::FirstHit;
use octvox_raytracer::picture_error::{FlipMap, difference_picture};
use octvox_raytracer::truth::{Truth, TruthModel};
use std::path::PathBuf;

/// A study on its way.
pub struct Runner<'a> {
    measuring: Measuring<'a>,
    base: &'a Base,
    commands: Commands<'a>,
    results: Results,
    folder: PathBuf,
    comparison: Comparison,
    /// The octrees of the default conversion, and those of another one.
    default: Prepared,
    other: Option<(Conversion, Prepared)>,
    /// The default picture, which is a setting of most knobs, measured once.
    default_picture: Option<(Cost, Shown)>,
    /// What is to be seen, by triangles; found when it is first needed.
    truth: Option<Option<Shown>>,
    /// What the exact setting of everything shows; found when it is first needed.
    exact: Option<Shown>,
}

/// A thing that is shown, to be compared with.
const TRUTH_PICTURE: &str = "pictures/truth.png";

impl<'a> Runner<'a> {
    pub fn new(
        measuring: Measuring<'a>,
        base: &'a Base,
        commands: Commands<'a>,
        results: Results,
        folder: PathBuf,
        default: Prepared,
    ) -> Self {
        let size = measuring.size;
        let comparison = Comparison { size, pixel_at_one: measuring.view.camera.pixel_at_one(size[1]) };
        Self {
            measuring,
            base,
            commands,
            results,
            folder,
            comparison,
            default,
            other: None,
            default_picture: None,
            truth: None,
            exact: None,
        }
    }

    /// Measures what has not been measured of a knob.
    pub fn measure(&mut self, ladder: &Ladder, progress: &Progress) -> anyhow::Result<()> {
        let Ladder { knob, choices } = ladder;
        let is_done =
            |runner: &Self, choice: &Choice| runner.results.find(&knob.name, &choice.label).is_some();
        if choices.iter().all(|choice| is_done(self, choice)) {
            progress.add(choices.len() as u64);
            return Ok(());
        }
        // Settings on the front are held against one exact picture, those of other knobs against their own.
        let of_knob = if knob.is_on_front { None } else { choices.iter().find(|choice| choice.is_exact) };
        let of_knob = of_knob.map(|choice| self.show(choice)).transpose()?;
        for choice in choices {
            if !is_done(self, choice) {
                let setting = self.setting(knob, choice, of_knob.as_ref())?;
                self.results.add(setting)?;
            }
            progress.add(1);
        }
        // A grid that was tried out is no longer of use.
        self.default.octrees.iter_mut().for_each(|octree| octree.set_grid(Primary::default().grid));
        Ok(())
    }

    fn setting(&mut self, knob: &Knob, choice: &Choice, of_knob: Option<&Shown>) -> anyhow::Result<Setting> {
        let is_default_picture = self.base.is_default_picture(choice);
        let known = if is_default_picture { self.default_picture.take() } else { None };
        let measured = match known {
            Some(measured) => measured,
            None => self.measure_choice(choice)?,
        };
        let (cost, shown) = &measured;
        let (against_truth, map) = self.against_truth(shown)?.unzip();
        let against_exact = match of_knob {
            Some(exact) => self.comparison.between(shown, exact),
            None if knob.is_on_front => self.against_exact(shown)?,
            None => None,
        };
        let (against_exact, exact_map) = against_exact.unzip();
        let map = map.flatten().or(exact_map.flatten());
        let name = format!("{}-{}", knob.name, file_name(&choice.label));
        let (picture, difference) = self.write_pictures(&name, shown, map.as_ref())?;
        let setting = Setting {
            knob: knob.name.clone(),
            label: choice.label.clone(),
            place: choice.place,
            is_default: choice.is_default,
            is_exact: choice.is_exact,
            cost: *cost,
            against_exact,
            against_truth,
            picture,
            difference,
            command: self.commands.of(choice),
        };
        if is_default_picture {
            self.default_picture = Some(measured);
        }
        Ok(setting)
    }

    /// Makes the octrees of a setting and measures it.
    fn measure_choice(&mut self, choice: &Choice) -> anyhow::Result<(Cost, Shown)> {
        let named = || choice.label.clone();
        if choice.conversion == Conversion::default() {
            let (mut cost, shown) = self.measuring.measure(choice, &mut self.default).with_context(named)?;
            self.time_picture(choice, None, &mut cost)?;
            return Ok((Cost { preparation: self.default.seconds, ..cost }, shown));
        }
        let mut other = self.converted(&choice.conversion)?;
        let (mut cost, shown) = self.measuring.measure(choice, &mut other).with_context(named)?;
        self.time_picture(choice, Some(&other), &mut cost)?;
        cost.preparation = other.seconds;
        self.other = Some((choice.conversion, other));
        Ok((cost, shown))
    }

    /// Times the picture of a setting, in turns with the default one. `other` are its octrees if they are not the default.
    fn time_picture(
        &mut self,
        choice: &Choice,
        other: Option<&Prepared>,
        cost: &mut Cost,
    ) -> anyhow::Result<()> {
        if choice.work != Work::Picture {
            return Ok(());
        }
        let default = (&self.base.quality, &self.default);
        let both = [(&choice.quality, other.unwrap_or(&self.default)), default];
        let [seconds, default_seconds] = self.measuring.in_turns(both)?;
        let ratios = seconds.iter().zip(&default_seconds).map(|(own, default)| own / default);
        let relative = Spread::of(ratios.collect());
        // The default picture takes as long as itself.
        let median = if self.base.is_default_picture(choice) { 1.0 } else { relative.median };
        cost.relative = Some(Spread { median, ..relative });
        cost.seconds = Spread::of(seconds);
        self.results.add_default_seconds(default_seconds)
    }

    /// The octrees of a conversion that is not the default: those there are, or new ones.
    fn converted(&mut self, conversion: &Conversion) -> anyhow::Result<Prepared> {
        match self.other.take() {
            Some((found, prepared)) if found == *conversion => Ok(prepared),
            // Dropped before others are made, which may need the memory.
            _ => self.measuring.subject.prepare(conversion),
        }
    }

    fn show(&mut self, choice: &Choice) -> anyhow::Result<Shown> {
        if choice.conversion == Conversion::default() {
            return self.measuring.show(choice, &mut self.default);
        }
        let mut other = self.converted(&choice.conversion)?;
        let shown = self.measuring.show(choice, &mut other);
        self.other = Some((choice.conversion, other));
        shown
    }

    fn against_exact(&mut self, shown: &Shown) -> anyhow::Result<Option<(Errors, Option<FlipMap>)>> {
        if self.exact.is_none() {
            let exact = self.base.exact();
            self.exact = Some(self.show(&exact)?);
        }
        Ok(self.exact.as_ref().and_then(|exact| self.comparison.between(shown, exact)))
    }

    fn against_truth(&mut self, shown: &Shown) -> anyhow::Result<Option<(Errors, Option<FlipMap>)>> {
        if self.truth.is_none() {
            let truth = self.truth_with(None)?;
            if let Some(Shown::Picture { pixels, .. }) = &truth {
                self.write_picture(TRUTH_PICTURE, pixels)?;
            }
            self.truth = Some(truth);
        }
        let truth = self.truth.as_ref().and_then(Option::as_ref);
        Ok(truth.and_then(|truth| self.comparison.between(shown, truth)))
    }

    /// What the scene looks like by triangles, whose normals may be kept in a code; nothing if that is not known.
    fn truth_with(&self, normal_code: Option<NormalCode>) -> anyhow::Result<Option<Shown>> {
        let Measuring { subject, view, size, tone, .. } = &self.measuring;
        let Some(meshes) = subject.meshes() else { return Ok(None) };
        let scene = subject.scene(&self.default, view, *size)?;
        let crease = Options::default().crease_degrees;
        let mut models = Vec::new();
        for model in &scene.models {
            let of_model = |octree: &octvox_raytracer::Octree| std::ptr::eq(octree, model.octree);
            let Some(place) = self.default.octrees.iter().position(of_model) else { return Ok(None) };
            let Some(world) = self.default.worlds[place] else { return Ok(None) };
            let model = TruthModel::new(meshes[place], world, model.octree.resolution(), crease)?;
            models.push(match normal_code {
                Some(code) => model.with_normal_code(code),
                None => model,
            });
        }
        let truth = Truth::new(&scene, &models);
        let Ok(picture) = truth.picture(&view.camera, &view.lens, *size, self.truth_samples(), tone) else {
            return Ok(None);
        };
        let first_hits = truth.first_hits(&view.camera, &view.lens, *size)?;
        let first_hits = first_hits.into_iter().map(FirstHit::from).collect();
        Ok(Some(Shown::Picture { pixels: picture.pixels, first_hits, voxel: 0.0 }))
    }

    /// Rays through each pixel of the truth.
    fn truth_samples(&self) -> u32 {
        if self.base.is_quick { 64 } else { 256 }
    }

    /// Writes the picture of a setting, and where it differs; gives their names in the folder.
    fn write_pictures(
        &self,
        name: &str,
        shown: &Shown,
        map: Option<&FlipMap>,
    ) -> anyhow::Result<(Option<String>, Option<String>)> {
        let Shown::Picture { pixels, .. } = shown else { return Ok((None, None)) };
        let picture = format!("pictures/{name}.png");
        self.write_picture(&picture, pixels)?;
        let difference = map.map(|map| {
            let difference = format!("pictures/{name}-difference.png");
            let pixels = difference_picture(&map.per_pixel, self.comparison.size);
            self.write_picture(&difference, &pixels).map(|()| difference)
        });
        Ok((Some(picture), difference.transpose()?))
    }

    fn write_picture(&self, name: &str, pixels: &[[u8; 4]]) -> anyhow::Result<()> {
        let path = self.folder.join(name);
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder)
                .with_context(|| format!("{}: cannot be made", folder.display()))?;
        }
        write_png(&path, self.comparison.size, pixels)
    }

    /// The tables.
    pub fn chapters(
        &mut self,
        check_rays: u64,
        thesis_models: &[(String, PathBuf)],
        progress: &Progress,
    ) -> anyhow::Result<()> {
        let is_mesh = self.base.depths.is_some() && self.base.is_one_model;
        let repetitions = self.measuring.repetitions;
        let subject = self.measuring.subject;
        if is_mesh && self.results.chapter("How often rounding shows").is_none() {
            let levels = self.base.levels_of_checks();
            let chapter = differences(subject, levels, check_rays, || progress.add(0))?;
            self.results.add_chapter(chapter)?;
        }
        progress.add(1);
        if self.results.chapter("Hard rays").is_none() {
            let chapter = hard_rays(&self.default.octrees[0], repetitions)?;
            self.results.add_chapter(chapter)?;
        }
        progress.add(1);
        if self.results.chapter("Normal codes").is_none() {
            let mut coded = Vec::new();
            for code in [NormalCode::Spherical, NormalCode::Octahedral] {
                let shown = self.truth_with(Some(code))?;
                let errors = shown.map(|shown| self.against_truth(&shown)).transpose()?.flatten();
                coded.extend(errors.map(|(errors, _)| (code, errors)));
            }
            self.results.add_chapter(normal_codes(&coded))?;
        }
        progress.add(1);
        if is_mesh && self.results.chapter("The tables of the thesis again").is_none() {
            let meshes = subject.meshes().unwrap_or_default();
            let deepest = self.base.finest.min(if self.base.is_quick { 9 } else { 12 });
            let chapter: Chapter = thesis(subject.name(), meshes[0], deepest, repetitions, thesis_models)?;
            self.results.add_chapter(chapter)?;
        }
        progress.add(1);
        Ok(())
    }

    /// All that was found.
    pub fn finish(mut self, command: String, knobs: Vec<Knob>) -> anyhow::Result<Study> {
        let truth_picture = self.folder.join(TRUTH_PICTURE).is_file().then(|| TRUTH_PICTURE.to_owned());
        let (mut settings, chapters) = self.results.take(&knobs);
        // All times of pictures are told in those of the default one, whose own is that of the whole study.
        let default = Spread::of(self.results.default_seconds().to_vec()).median;
        for Setting { cost, .. } in &mut settings {
            cost.seconds = cost.relative.map_or(cost.seconds, |relative| relative.times(default));
        }
        let truth = if settings.iter().any(|setting| setting.against_truth.is_some()) {
            let triangles: usize =
                self.measuring.subject.meshes().iter().flatten().map(|mesh| mesh.triangles().len()).sum();
            format!(
                "A ray tracer on the {triangles} triangles themselves, in double precision, with {} rays through each pixel.",
                self.truth_samples()
            )
        } else {
            "There is none: what the subject calls for is not simulated on triangles, or not all of it is made of them. \
             Errors are against the exact setting."
                .into()
        };
        Ok(Study {
            title: self.measuring.subject.name().to_owned(),
            command,
            is_quick: self.base.is_quick,
            machine: this_machine(),
            size: self.measuring.size,
            truth,
            truth_picture,
            knobs,
            settings,
            chapters,
        })
    }
}

/// A label as part of a file's name.
fn file_name(label: &str) -> String {
    let plain = |letter: char| match letter {
        '³' => '3',
        '.' => '.',
        letter if letter.is_ascii_alphanumeric() => letter,
        _ => '-',
    };
    label.chars().map(plain).collect()
}
