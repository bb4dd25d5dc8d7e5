//! What can be approximated more or less, and the settings that a study measures.

mod conversion;
mod effects;
mod rays;
mod sampling;

use super::record::Knob;
use super::subject::Conversion;
use octvox_raytracer::{Arithmetic, Plan, Quality, Width};

/// A knob and its settings, from coarse to exact.
pub struct Ladder {
    pub knob: Knob,
    pub choices: Vec<Choice>,
}

/// A setting that is to be measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Choice {
    pub label: String,
    /// Place on the knob's axis.
    pub place: f64,
    pub is_default: bool,
    pub is_exact: bool,
    pub conversion: Conversion,
    pub quality: Quality,
    pub work: Work,
}

/// What is measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Work {
    /// A whole picture.
    Picture,
    /// What the middle of each pixel shows, in floating point.
    Primary(Primary),
    /// The same in integers, without a rounding.
    Exact,
}

/// How it is found what the middle of each pixel shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Primary {
    pub width: Width,
    pub beams: bool,
    /// Level of the grid through which rays enter.
    pub grid: u8,
    pub arithmetic: Arithmetic,
}

impl Default for Primary {
    fn default() -> Self {
        Self { width: Width::FASTEST, beams: true, grid: Self::GRID, arithmetic: Arithmetic::Single }
    }
}

impl Primary {
    /// The level of the grid by default.
    const GRID: u8 = 6;
}

/// What a study begins from.
pub struct Base {
    /// The depths that meshes have by themselves, the least and the greatest; nothing without a mesh.
    pub depths: Option<[u8; 2]>,
    /// No mesh is converted to a deeper octree than this.
    pub finest: u8,
    /// What the picture needs.
    pub plan: Plan,
    /// Different colours of the palettes.
    pub colors: usize,
    /// The default quality.
    pub quality: Quality,
    pub is_quick: bool,
    /// Whether there is one model, seen through a pinhole: then what single rays meet can be compared.
    pub is_one_model: bool,
}

impl Base {
    /// All knobs that matter to the subject.
    pub fn ladders(&self) -> Vec<Ladder> {
        let knobs = [
            Some(self.everything()),
            self.resolution(),
            Some(self.level_of_detail()),
            Some(self.samples()),
            Some(self.adaptive()),
            Some(self.filter()),
            self.leave(),
            self.light_samples(),
            self.ambient_samples(),
            self.bounces(),
            self.cutoff(),
            self.smoothing(),
            self.palette(),
            self.normals(),
            self.lod_color(),
            self.arithmetic(),
            self.beams(),
            self.grid(),
            self.lanes(),
        ];
        knobs.into_iter().flatten().collect()
    }

    /// The exact setting of everything, as far as this study goes.
    pub fn exact(&self) -> Choice {
        let samples = if self.is_quick { 64 } else { 256 };
        let quality =
            Quality { lod_pixels: 0.0, cutoff: 0.0, arithmetic: Arithmetic::Double, ..self.rays(samples) };
        let levels = self.levels_to(if self.is_quick { 10 } else { 12 });
        Choice { is_exact: true, ..self.picture("exact", 0.0, self.finer(levels), quality) }
    }

    /// Whether a setting is the picture of all defaults, whichever knob it is of.
    pub fn is_default_picture(&self, choice: &Choice) -> bool {
        let is_default = choice.conversion == Conversion::default() && choice.quality == self.quality;
        is_default && choice.work == Work::Picture
    }

    /// Levels from the default of the octrees that are checked.
    pub fn levels_of_checks(&self) -> impl Iterator<Item = i8> {
        let depths: &[u8] = if self.is_quick { &[6, 8, 10] } else { &[6, 7, 8, 9, 10, 11, 12] };
        depths.iter().filter(|&&depth| depth <= self.finest).map(|&depth| self.levels_to(depth))
    }

    /// The default quality with so many rays through each pixel.
    fn rays(&self, samples: u32) -> Quality {
        self.adapting(samples, samples, self.quality.contrast)
    }

    /// The default quality with so many rays through each pixel, and more where it differs.
    fn adapting(&self, samples: u32, most_samples: u32, contrast: f32) -> Quality {
        let lod_pixels = Quality::adapting(samples, most_samples).lod_pixels;
        Quality { samples, most_samples, contrast, lod_pixels, ..self.quality }
    }

    /// Levels from the default to an octree of this depth, or the finest allowed. No scene becomes finer than its author has
    /// it: its cubes may be meant to be seen.
    fn levels_to(&self, depth: u8) -> i8 {
        self.depths.map_or(0, |[_, deepest]| {
            let finest = if self.is_one_model { self.finest } else { deepest };
            depth.min(finest) as i8 - deepest as i8
        })
    }

    fn finer(&self, levels: i8) -> Conversion {
        Conversion { levels, ..Conversion::default() }
    }

    fn picture(
        &self,
        label: impl Into<String>,
        place: f64,
        conversion: Conversion,
        quality: Quality,
    ) -> Choice {
        let choice = Choice {
            label: label.into(),
            place,
            is_default: false,
            is_exact: false,
            conversion,
            quality,
            work: Work::Picture,
        };
        Choice { is_default: self.is_default_picture(&choice), ..choice }
    }

    /// A setting that differs from the default by its quality.
    fn of_quality(&self, label: impl Into<String>, place: f64, quality: Quality) -> Choice {
        self.picture(label, place, Conversion::default(), quality)
    }

    fn everything(&self) -> Ladder {
        // Depth, rays through each pixel, rays where it differs, from which difference on.
        let quick: &[(&str, u8, u32, u32, f32)] = &[
            ("preview", 6, 1, 1, 0.02),
            ("7 levels", 7, 1, 1, 0.02),
            ("8 levels", 8, 1, 1, 0.02),
            ("default", 10, 1, 1, 0.02),
            ("edges", 10, 1, 8, 0.1),
            ("smooth", 10, 1, 16, 0.05),
            ("fine", 10, 2, 32, 0.02),
            ("still", 10, 4, 64, 0.01),
            ("uniform", 10, 64, 64, 0.02),
        ];
        let full: &[(&str, u8, u32, u32, f32)] = &[
            ("preview", 6, 1, 1, 0.02),
            ("7 levels", 7, 1, 1, 0.02),
            ("8 levels", 8, 1, 1, 0.02),
            ("9 levels", 9, 1, 1, 0.02),
            ("default", 10, 1, 1, 0.02),
            ("edges", 10, 1, 8, 0.1),
            ("smooth", 10, 1, 16, 0.05),
            ("fine", 10, 2, 32, 0.02),
            ("finer", 11, 4, 64, 0.02),
            ("still", 11, 4, 64, 0.005),
            ("uniform", 11, 64, 64, 0.02),
            ("uniform, finer", 12, 64, 64, 0.02),
        ];
        let rows = if self.is_quick { quick } else { full };
        let mut choices: Vec<Choice> = Vec::new();
        for &(name, depth, samples, most, contrast) in rows {
            let quality =
                if name == "default" { self.quality } else { self.adapting(samples, most, contrast) };
            let levels = if name == "default" { 0 } else { self.levels_to(depth) };
            let choice = self.picture(name, choices.len() as f64, self.finer(levels), quality);
            // Where the resolution is as it is, some of them are the same.
            if choices
                .iter()
                .all(|other| (other.conversion, other.quality) != (choice.conversion, choice.quality))
            {
                choices.push(choice);
            }
        }
        choices.push(Choice { place: choices.len() as f64, ..self.exact() });
        let explanation = "Resolution, rays through a pixel, where more of them are sent, and arithmetic, together: from \
                           a preview to all that this study can do.";
        let reason = "One ray through each pixel, and cells of a quarter of it, is the fastest picture in which nothing \
                      looks coarser than the display; whoever wants smooth edges asks for more rays.";
        Ladder {
            knob: knob("everything", "From preview to exact", "setting", false, explanation, reason, true),
            choices,
        }
    }
}

fn knob(
    name: &str,
    title: &str,
    axis: &str,
    is_logarithmic: bool,
    explanation: &str,
    default_reason: &str,
    is_on_front: bool,
) -> Knob {
    Knob {
        name: name.into(),
        title: title.into(),
        axis: axis.into(),
        is_logarithmic,
        explanation: explanation.into(),
        default_reason: default_reason.into(),
        is_on_front,
    }
}

/// Says of the last setting that it is the exact one.
fn with_last_exact(mut choices: Vec<Choice>) -> Vec<Choice> {
    if let Some(last) = choices.last_mut() {
        last.is_exact = true;
    }
    choices
}
