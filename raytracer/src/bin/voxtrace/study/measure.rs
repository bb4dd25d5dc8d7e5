//! One setting measured: what it costs, and what it shows.

use super::knobs::{Choice, Primary, Work};
use super::record::{Cost, Spread};
use super::subject::{Prepared, Subject, View};
use crate::counters::Counters;
use octvox_raytracer::{
    Arithmetic, Counts, FirstHit, Octree, Quality, RenderOptions, Tone, Visibility, VisibilityOptions, Width,
    render_scene,
};
use std::time::{Duration, Instant};

/// What is the same for all settings.
pub struct Measuring<'a> {
    pub subject: &'a Subject,
    pub view: &'a View,
    pub size: [u32; 2],
    pub tone: Tone,
    /// How often a picture is timed.
    pub repetitions: Repetitions,
    /// The processor's, where the machine lets them be read.
    pub counters: Option<Counters>,
}

/// How often something is timed: so often, and more often until some time has gone, but not beyond another.
#[derive(Debug, Clone, Copy)]
pub struct Repetitions {
    pub least: u32,
    pub most: u32,
    pub until: Duration,
    pub not_beyond: Duration,
}

impl Repetitions {
    /// For a study of about a minute.
    pub const QUICK: Self =
        Self { least: 3, most: 9, until: Duration::from_millis(120), not_beyond: Duration::from_millis(600) };
    /// For one that takes its time.
    pub const FULL: Self =
        Self { least: 5, most: 21, until: Duration::from_millis(500), not_beyond: Duration::from_secs(20) };

    /// Times some work.
    pub fn time(&self, mut work: impl FnMut() -> anyhow::Result<()>) -> anyhow::Result<Spread> {
        let [seconds] = self.seconds(|_| work())?;
        Ok(Spread::of(seconds))
    }

    /// What several pieces of work take, given by their numbers and done in turns, each time.
    pub fn seconds<const N: usize>(
        &self,
        mut work: impl FnMut(usize) -> anyhow::Result<()>,
    ) -> anyhow::Result<[Vec<f64>; N]> {
        let begin = Instant::now();
        let mut seconds = [const { Vec::new() }; N];
        for count in 1..=self.most {
            for (which, seconds) in seconds.iter_mut().enumerate() {
                let start = Instant::now();
                work(which)?;
                seconds.push(start.elapsed().as_secs_f64());
            }
            let gone = begin.elapsed();
            if count >= self.least && gone >= self.until || gone >= self.not_beyond {
                break;
            }
        }
        Ok(seconds)
    }
}

/// What a setting shows.
pub enum Shown {
    /// A picture.
    Picture {
        pixels: Vec<[u8; 4]>,
        first_hits: Vec<FirstHit>,
        /// The edge of the smallest voxel in the scene.
        voxel: f64,
    },
    /// For each pixel, row by row, distance, node and part of what its middle shows, as bits.
    Rays {
        hits: Vec<[u32; 3]>,
        /// The edge of a voxel in the scene.
        voxel: f64,
    },
}

impl Measuring<'_> {
    /// Measures a setting whose octrees are ready, but for the time of a picture: see [`Measuring::in_turns`].
    pub fn measure(&mut self, choice: &Choice, prepared: &mut Prepared) -> anyhow::Result<(Cost, Shown)> {
        match choice.work {
            Work::Picture => self.picture(choice, prepared),
            Work::Primary(primary) => self.primary(&primary, prepared),
            Work::Exact => self.exact(prepared),
        }
    }

    /// What a setting shows, without measuring what it costs.
    pub fn show(&mut self, choice: &Choice, prepared: &mut Prepared) -> anyhow::Result<Shown> {
        let repetitions =
            std::mem::replace(&mut self.repetitions, Repetitions { most: 0, ..Repetitions::QUICK });
        let shown = self.measure(choice, prepared);
        self.repetitions = repetitions;
        Ok(shown?.1)
    }

    fn picture(&mut self, choice: &Choice, prepared: &Prepared) -> anyhow::Result<(Cost, Shown)> {
        let scene = self.subject.scene(prepared, self.view, self.size)?;
        let View { camera, lens } = self.view;
        let options = self.options(&choice.quality);
        // Looking at what is met comes first: it also brings the octree into the caches.
        let looking = RenderOptions { first_hits: true, ..options.clone() };
        let (frame, report) = render_scene(&scene, camera, lens, &looking, |_| {})?;
        let render = || render_scene(&scene, camera, lens, &options, |_| {}).map(drop);
        let instructions = self.instructions(|| Ok(render()?))?;
        let first_hits = frame.first_hits.unwrap_or_default();
        let cost = Cost {
            seconds: Spread::of(Vec::new()),
            relative: None,
            instructions,
            rays: report.rays.total(),
            steps: first_hits.iter().map(|hit| u64::from(hit.steps)).sum(),
            bytes: prepared.octrees.iter().map(|octree| octree.bytes()).sum(),
            preparation: 0.0,
        };
        let edges = scene.instances.iter().map(|instance| {
            instance.placement.scale / f64::from(scene.models[instance.model].octree.resolution())
        });
        let voxel = edges.fold(f64::INFINITY, f64::min);
        Ok((cost, Shown::Picture { pixels: frame.pixels, first_hits, voxel }))
    }

    /// Makes the picture of a setting in turns with another one, and tells what each took, in the order given. What slows the
    /// machine for a while slows both.
    pub fn in_turns(&self, both: [(&Quality, &Prepared); 2]) -> anyhow::Result<[Vec<f64>; 2]> {
        let View { camera, lens } = self.view;
        let scenes = [
            self.subject.scene(both[0].1, self.view, self.size)?,
            self.subject.scene(both[1].1, self.view, self.size)?,
        ];
        let options = both.map(|(quality, _)| self.options(quality));
        self.repetitions.seconds(|which| {
            render_scene(&scenes[which], camera, lens, &options[which], |_| {})?;
            Ok(())
        })
    }

    fn options(&self, quality: &Quality) -> RenderOptions {
        RenderOptions {
            size: self.size,
            quality: *quality,
            tone: self.tone,
            light: false,
            ..RenderOptions::default()
        }
    }

    fn primary(&mut self, primary: &Primary, prepared: &mut Prepared) -> anyhow::Result<(Cost, Shown)> {
        let Primary { width, beams, grid, arithmetic } = *primary;
        prepared.octrees[0].set_grid(grid);
        let octree = &prepared.octrees[0];
        let options = VisibilityOptions { arithmetic, width, beams, lod_pixels: 0.0, count_steps: false };
        let counting = VisibilityOptions { count_steps: true, ..options };
        let (camera, size) = (&self.view.camera, self.size);
        let mut seen = Visibility::default();
        let counts = seen.trace(octree, camera, size, &counting)?;
        let trace = || Ok(seen.trace(octree, camera, size, &options).map(drop)?);
        let cost = self.cost_of_rays(octree, counts, trace)?;
        let hits = seen.by_pixel(arithmetic, width, size);
        Ok((cost, Shown::Rays { hits, voxel: 1.0 / f64::from(octree.resolution()) }))
    }

    fn exact(&mut self, prepared: &Prepared) -> anyhow::Result<(Cost, Shown)> {
        let octree = &prepared.octrees[0];
        let (camera, size, order) = (&self.view.camera, self.size, Width::FASTEST);
        let mut seen = Visibility::default();
        let counts = seen.trace_exact(octree, camera, size, order)?;
        let trace = || Ok(seen.trace_exact(octree, camera, size, order).map(drop)?);
        let cost = self.cost_of_rays(octree, counts, trace)?;
        let hits = seen.by_pixel(Arithmetic::Single, order, size);
        Ok((cost, Shown::Rays { hits, voxel: 1.0 / f64::from(octree.resolution()) }))
    }

    /// What it costs to follow single rays.
    fn cost_of_rays(
        &mut self,
        octree: &Octree,
        counts: Counts,
        mut trace: impl FnMut() -> anyhow::Result<()>,
    ) -> anyhow::Result<Cost> {
        Ok(Cost {
            seconds: self.time(&mut trace)?,
            relative: None,
            instructions: self.instructions(&mut trace)?,
            rays: counts.rays,
            steps: counts.steps,
            bytes: octree.bytes(),
            preparation: 0.0,
        })
    }

    /// Times some work, unless nothing is timed now.
    fn time(&self, work: impl FnMut() -> anyhow::Result<()>) -> anyhow::Result<Spread> {
        if self.repetitions.most == 0 {
            return Ok(Spread::of(Vec::new()));
        }
        self.repetitions.time(work)
    }

    /// How many instructions some work takes, where that can be counted.
    fn instructions(&mut self, work: impl FnOnce() -> anyhow::Result<()>) -> anyhow::Result<Option<u64>> {
        match &mut self.counters {
            Some(counters) if self.repetitions.most > 0 => {
                let (result, events) = counters.count(work)?;
                result?;
                Ok(Some(events.instructions))
            }
            _ => Ok(None),
        }
    }
}
