//! Knobs of how a single ray is followed, which change no picture but by rounding.

use super::{Base, Choice, Ladder, Primary, Work, knob, with_last_exact};
use octvox_raytracer::{Arithmetic, Quality, Width};

impl Base {
    pub(super) fn arithmetic(&self) -> Option<Ladder> {
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

    pub(super) fn beams(&self) -> Option<Ladder> {
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

    pub(super) fn grid(&self) -> Option<Ladder> {
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

    pub(super) fn lanes(&self) -> Option<Ladder> {
        self.primary("lanes", "Rays of a packet", "rays", true, |choice| {
            let choices = Width::ALL.map(|width| Choice {
                label: if width == Width::One {
                    "single rays".into()
                } else {
                    format!("{} rays", width.lanes())
                },
                place: f64::from(width.lanes()),
                work: Work::Primary(Primary { width, ..Primary::default() }),
                is_default: width == Width::FASTEST,
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
