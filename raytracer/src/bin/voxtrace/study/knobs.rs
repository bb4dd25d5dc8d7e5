//! What can be approximated more or less, and the settings that a study measures.

use super::record::Knob;
use super::subject::{Conversion, Normals};
use octvox_converter::LodColor;
use octvox_raytracer::{Arithmetic, Filter, Leave, Plan, Quality, Width};

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
        Self { width: Width::Sixteen, beams: true, grid: Self::GRID, arithmetic: Arithmetic::Single }
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

    /// Levels from the default to an octree of this depth, or the finest allowed.
    fn levels_to(&self, depth: u8) -> i8 {
        self.depths.map_or(0, |[_, deepest]| depth.min(self.finest) as i8 - deepest as i8)
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
        let reason = "One ray through each pixel, and cells of half a pixel, is the fastest picture in which nothing \
                      looks coarser than the display; whoever wants smooth edges asks for more rays.";
        Ladder {
            knob: knob("everything", "From preview to exact", "setting", false, explanation, reason, true),
            choices,
        }
    }

    fn resolution(&self) -> Option<Ladder> {
        let [_, deepest] = self.depths?;
        let last = if self.is_quick { 10 } else { 13 }.min(self.finest);
        let choices: Vec<_> = (6..=last.max(deepest))
            .map(|depth| {
                let levels = depth as i8 - deepest as i8;
                let label = format!("{}³", 1u32 << depth);
                self.picture(label, f64::from(1u32 << depth), self.finer(levels), self.quality)
            })
            .collect();
        let explanation = "Cells along each axis of the octree that the mesh is converted to; of several meshes, of the \
                           finest. Rays end at cells of half a pixel, so beyond the picture's own resolution the time stays.";
        let reason = "1024³ is finer than the pixels of most pictures, converts in a second or two, and fits in tens of \
                      megabytes; beyond, only close-ups gain.";
        Some(Ladder {
            knob: knob("resolution", "Resolution", "cells along an axis", true, explanation, reason, true),
            choices: with_last_exact(choices),
        })
    }

    fn level_of_detail(&self) -> Ladder {
        let choices = [8.0, 4.0, 2.0, 1.0, 0.5, 0.25, 0.0]
            .map(|lod_pixels| {
                let label =
                    if lod_pixels == 0.0 { "finest cells".into() } else { format!("{lod_pixels} pixels") };
                self.of_quality(label, lod_pixels, Quality { lod_pixels, ..self.quality })
            })
            .to_vec();
        let explanation = "A ray ends at the first cell that looks no larger than this many pixels. A coarse cell has the \
                           mean colour and normal of what is below it.";
        let reason = "Half a pixel for one ray: coarser cells show at silhouettes, which they widen, and save little \
                      time; finer ones cost more where the octree is much finer than the picture.";
        Ladder {
            knob: knob("lod", "Level of detail", "pixels", false, explanation, reason, true),
            choices: with_last_exact(choices),
        }
    }

    fn samples(&self) -> Ladder {
        let counts: &[u32] = if self.is_quick { &[1, 2, 4, 16, 64] } else { &[1, 2, 4, 8, 16, 32, 64, 128] };
        let choices = counts
            .iter()
            .map(|&count| {
                let label = if count == 1 { "1 ray".into() } else { format!("{count} rays") };
                let quality = if count == self.quality.samples { self.quality } else { self.rays(count) };
                self.of_quality(label, f64::from(count), quality)
            })
            .collect();
        let explanation =
            "Rays through every pixel alike; levels of detail become finer with the distance between them.";
        let reason = "One, because a picture in a moment is what a tracer of voxels is for.";
        Ladder {
            knob: knob("samples", "Rays through a pixel", "rays", true, explanation, reason, true),
            choices: with_last_exact(choices),
        }
    }

    fn adaptive(&self) -> Ladder {
        let contrasts: &[f32] = if self.is_quick {
            &[0.2, 0.05, 0.02, 0.0]
        } else {
            &[0.3, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.0]
        };
        let most = if self.is_quick { 32 } else { 64 };
        let choices = contrasts
            .iter()
            .map(|&contrast| {
                let label =
                    if contrast == 0.0 { "all pixels".into() } else { format!("{contrast} of the range") };
                self.of_quality(
                    label,
                    f64::from(contrast),
                    self.adapting(self.quality.samples, most, contrast),
                )
            })
            .collect();
        let explanation = format!(
            "Up to {most} rays through pixels that differ from their neighbours, or in themselves, by more than this; others \
             have {}. The last setting, 0, stops nowhere.",
            self.quality.samples
        );
        let axis = "share of the displayed range";
        Ladder {
            knob: knob("contrast", "More rays where pixels differ", axis, false, &explanation, "", true),
            choices: with_last_exact(choices),
        }
    }

    fn filter(&self) -> Ladder {
        let choices = (0..)
            .zip(Filter::ALL)
            .map(|(place, filter)| {
                self.of_quality(filter.name(), f64::from(place), Quality { filter, ..self.rays(16) })
            })
            .collect();
        let explanation = "How the rays about a pixel count, with 16 of them. The truth is what a pixel's area shows, which \
                           the box is; wider filters trade that for calmer edges.";
        Ladder {
            knob: knob("filter", "Reconstruction filter", "filter", false, explanation, "", false),
            choices,
        }
    }

    fn leave(&self) -> Option<Ladder> {
        self.plan.shadows.then(|| {
            let choices = (0..)
                .zip([Leave::Voxel, Leave::Raised, Leave::Surface])
                .map(|(place, leave)| {
                    self.of_quality(leave.name(), f64::from(place), Quality { leave, ..self.quality })
                })
                .collect();
            let explanation = "How rays to lamps leave the voxels of a surface: from outside the voxel alone, so that steps \
                               shadow each other; from one and a half voxels above it, so that contacts come loose; past \
                               all voxels that scan conversion can have put on the same surface.";
            let reason = "Of the three only the surface has neither shadows on itself nor gaps at contacts.";
            let knob = knob("leave", "How shadows leave a surface", "method", false, explanation, reason, false);
            Ladder { knob, choices: with_last_exact(choices) }
        })
    }

    fn light_samples(&self) -> Option<Ladder> {
        self.plan.soft_shadows.then(|| {
            let explanation = "Rays to each lamp that has an extent, for each point seen.";
            let reason = "One, as rays through the pixel multiply it.";
            let knob =
                knob("light-samples", "Soft shadows", "rays to a lamp", true, explanation, reason, false);
            Ladder { knob, choices: self.counts(|light_samples| Quality { light_samples, ..self.quality }) }
        })
    }

    fn ambient_samples(&self) -> Option<Ladder> {
        (self.plan.occlusion || self.plan.glow).then(|| {
            let explanation = "Rays for light from around, for each point seen.";
            let reason = "One, as rays through the pixel multiply it.";
            let knob = knob("ambient-samples", "Light from around", "rays", true, explanation, reason, false);
            Ladder {
                knob,
                choices: self.counts(|ambient_samples| Quality { ambient_samples, ..self.quality }),
            }
        })
    }

    /// Settings of a number of rays, by powers of four.
    fn counts(&self, quality: impl Fn(u32) -> Quality) -> Vec<Choice> {
        let most = if self.is_quick { 2 } else { 4 };
        let counts = (0..=most).map(|power| 4u32.pow(power));
        let choices =
            counts.map(|count| self.of_quality(count.to_string(), f64::from(count), quality(count)));
        with_last_exact(choices.collect())
    }

    fn bounces(&self) -> Option<Ladder> {
        (self.plan.reflection || self.plan.refraction).then(|| {
            let choices = [0, 1, 2, 3, 4, 8, 16, 32].map(|bounces| {
                self.of_quality(bounces.to_string(), f64::from(bounces), Quality { bounces, ..self.quality })
            });
            let explanation = "How often light is followed further by mirrors and glass.";
            let reason = "A shell of glass takes four, two of them eight; beyond, a pixel rarely changes.";
            let knob = knob("bounces", "Depth of reflection", "bounces", false, explanation, reason, false);
            Ladder { knob, choices: with_last_exact(choices.to_vec()) }
        })
    }

    fn cutoff(&self) -> Option<Ladder> {
        self.plan.shadows.then(|| {
            let step = f64::from(Quality::default().cutoff);
            let choices = [64.0, 16.0, 4.0, 1.0, 0.0].map(|times| {
                let quality = Quality { cutoff: (times * step) as f32, ..self.quality };
                let label = if times == 0.0 { "all rays".into() } else { format!("{times} × half a step") };
                self.of_quality(label, times, quality)
            });
            let explanation = "Rays are not sent to lamps, into mirrors and glass, and around, that can add less than this \
                               to the picture, in halves of the smallest step of a displayed value.";
            let reason = "Half a step of a displayed value: less does not show in a picture of eight bits.";
            let knob = knob("cutoff", "Rays that matter too little", "half steps", false, explanation, reason, false);
            Ladder { knob, choices: with_last_exact(choices.to_vec()) }
        })
    }

    fn smoothing(&self) -> Option<Ladder> {
        self.depths.map(|_| {
            // Voxels are large only where the octree is coarse.
            let coarse = self.finer(self.levels_to(6));
            let choices = [f64::INFINITY, 8.0, 4.0, 2.0].map(|smooth_pixels| {
                let is_off = smooth_pixels == f64::INFINITY;
                let label = if is_off { "cubes".into() } else { format!("above {smooth_pixels} pixels") };
                let place = if is_off { 16.0 } else { smooth_pixels };
                self.picture(label, place, coarse, Quality { smooth_pixels, ..self.rays(4) })
            });
            let explanation = "An octree of 64³ cells, with four rays through a pixel: voxels that look larger than this are \
                               smoothed by their normals. On the axis, 16 stands for cubes as they are.";
            let knob = knob("smooth", "Smooth close-ups", "pixels", true, explanation, "", false);
            Ladder { knob, choices: choices.to_vec() }
        })
    }

    fn palette(&self) -> Option<Ladder> {
        (self.depths.is_some() && self.colors > 16).then(|| {
            let sizes = [16, 64, 256, 1024, 4096, 32_767].map(|palette_size| {
                let conversion = Conversion { palette_size, ..Conversion::default() };
                self.picture(palette_size.to_string(), palette_size as f64, conversion, self.quality)
            });
            let explanation =
                "The most entries that a palette may have; the colours of the mesh are reduced to them.";
            let reason = "All that the file has room for: entries cost next to nothing.";
            let knob = knob("palette", "Size of the palette", "entries", true, explanation, reason, false);
            Ladder { knob, choices: with_last_exact(sizes.to_vec()) }
        })
    }

    fn normals(&self) -> Option<Ladder> {
        self.depths.map(|_| {
            let codes = [
                ("of faces", Normals::Faces),
                ("16 bits, spherical", Normals::Spherical),
                ("16 bits, octahedral", Normals::Octahedral),
            ];
            let choices = (0..).zip(codes).map(|(place, (label, normals))| {
                let conversion = Conversion { normals, ..Conversion::default() };
                self.picture(label, f64::from(place), conversion, self.quality)
            });
            let explanation = "What normals the voxels have. No file keeps them in floating point; what that would gain is \
                               in the table of normal codes below. Spherical ones are of format version 4, which knows no \
                               materials either.";
            let reason = "The octahedron spreads its 65,536 normals more evenly than two angles do.";
            let knob = knob("normals", "Normals", "code", false, explanation, reason, false);
            Ladder { knob, choices: choices.collect() }
        })
    }

    fn lod_color(&self) -> Option<Ladder> {
        (self.depths.is_some() && self.colors > 1).then(|| {
            let rules = [("of most children", LodColor::Majority), ("mean of the light", LodColor::Mean)];
            let choices = (0..).zip(rules).map(|(place, (label, lod_color))| {
                let conversion = Conversion { lod_color, ..Conversion::default() };
                let quality = Quality { lod_pixels: 4.0, ..self.quality };
                let choice = self.picture(label, f64::from(place), conversion, quality);
                Choice { is_default: lod_color == LodColor::default(), ..choice }
            });
            let explanation = "How coarse cells get their colours, where rays end at cells of four pixels.";
            let reason = "The mean of the light is what a pixel sees of a surface from afar.";
            let knob =
                knob("lod-color", "Colours of coarse cells", "rule", false, explanation, reason, false);
            Ladder { knob, choices: choices.collect() }
        })
    }

    fn arithmetic(&self) -> Option<Ladder> {
        self.primary("arithmetic", "Arithmetic", "arithmetic", false, |choice| {
            let of = |label: &str, place: f64, work: Work, is_default: bool| Choice {
                label: label.into(),
                place,
                work,
                is_default,
                is_exact: false,
                ..choice.clone()
            };
            let lanes = |arithmetic| Work::Primary(Primary { arithmetic, ..Primary::default() });
            let choices = vec![
                of("single precision", 0.0, lanes(Arithmetic::Single), true),
                of("double precision", 1.0, lanes(Arithmetic::Double), false),
                of("integers", 2.0, Work::Exact, false),
            ];
            let explanation = "How the distance to a plane is found, for what the middle of each pixel shows, at the finest \
                               cells: in single precision, in double precision, or exactly, by integers on a lattice of \
                               2⁻⁴⁴ of the cube. Other voxels are those that a ray meets instead of the exact one.";
            let reason = "Single precision moves a ray by a ten-thousandth of a voxel at 1024³, which no pixel shows, and \
                          costs a fraction of the others.";
            (choices, explanation, reason)
        })
    }

    fn beams(&self) -> Option<Ladder> {
        self.primary("beams", "Beams", "beams", false, |choice| {
            let choices = [true, false].map(|beams| Choice {
                label: if beams { "on".into() } else { "off".into() },
                place: f64::from(u8::from(!beams)),
                work: Work::Primary(Primary { beams, ..Primary::default() }),
                is_default: beams,
                is_exact: false,
                ..choice.clone()
            });
            let explanation = "Whether the rays of 8×8 pixels share the way down to where voxels become smaller than the beam. \
                               They meet the same voxels, to the last bit.";
            let reason = "The same picture in less time.";
            (choices.to_vec(), explanation, reason)
        })
    }

    fn grid(&self) -> Option<Ladder> {
        let levels: &[u8] = if self.is_quick { &[0, 3, 6, 8] } else { &[0, 1, 2, 3, 4, 5, 6, 7, 8] };
        self.primary("grid", "Entrance grid", "cells along an axis; 0.5 stands for none", true, |choice| {
            let choices = levels.iter().map(|&grid| Choice {
                label: if grid == 0 { "none".into() } else { format!("{}³", 1u32 << grid) },
                place: if grid == 0 { 0.5 } else { f64::from(1u32 << grid) },
                work: Work::Primary(Primary { grid, ..Primary::default() }),
                is_default: grid == Primary::GRID,
                is_exact: false,
                ..choice.clone()
            });
            let explanation = "Cells of the uniform grid through which rays enter the octree. They meet the same voxels, to \
                               the last bit.";
            let reason = "64³ cells take a megabyte and are as fast as any.";
            (choices.collect(), explanation, reason)
        })
    }

    fn lanes(&self) -> Option<Ladder> {
        self.primary("lanes", "Rays of a packet", "rays", true, |choice| {
            let choices = Width::ALL.map(|width| Choice {
                label: if width == Width::One {
                    "single rays".into()
                } else {
                    format!("{} rays", width.lanes())
                },
                place: f64::from(width.lanes()),
                work: Work::Primary(Primary { width, ..Primary::default() }),
                is_default: width == Width::Sixteen,
                is_exact: false,
                ..choice.clone()
            });
            let explanation = "How many rays go together. They meet the same voxels, to the last bit.";
            let reason = "As many as the widest registers hold.";
            (choices.to_vec(), explanation, reason)
        })
    }

    /// A knob that only matters to what single rays meet, at the finest cells; the last of its choices is the exact one.
    fn primary(
        &self,
        name: &str,
        title: &str,
        axis: &str,
        is_logarithmic: bool,
        choices: impl FnOnce(&Choice) -> (Vec<Choice>, &'static str, &'static str),
    ) -> Option<Ladder> {
        self.is_one_model.then(|| {
            let quality = Quality { lod_pixels: 0.0, ..self.quality };
            let (choices, explanation, reason) = choices(&Choice {
                work: Work::Primary(Primary::default()),
                ..self.of_quality("", 0.0, quality)
            });
            let knob = knob(name, title, axis, is_logarithmic, explanation, reason, false);
            Ladder { knob, choices: with_last_exact(choices) }
        })
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
