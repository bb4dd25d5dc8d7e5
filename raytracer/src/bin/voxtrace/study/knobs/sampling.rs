//! Knobs of the rays from the eye: where they end, how many there are, how they count.

use super::{Base, Ladder, knob, with_last_exact};
use octvox_raytracer::{Filter, Quality};

impl Base {
    pub(super) fn level_of_detail(&self) -> Ladder {
        let choices = [8.0, 4.0, 2.0, 1.0, 0.5, 0.25, 0.0]
            .map(|lod_pixels| {
                let label =
                    if lod_pixels == 0.0 { "finest cells".into() } else { format!("{lod_pixels} pixels") };
                self.of_quality(label, lod_pixels, Quality { lod_pixels, ..self.quality })
            })
            .to_vec();
        let explanation = "A ray ends at the first cell that looks no larger than this many pixels. A coarse cell has the \
                           mean colour and normal of what is below it.";
        let reason = "A quarter of a pixel: coarser cells show at silhouettes, which they widen, and save next to no time; \
                      finer ones show nothing more, and cost where the octree is much finer than the picture.";
        Ladder {
            knob: knob("lod", "Level of detail", "pixels", false, explanation, reason, true),
            choices: with_last_exact(choices),
        }
    }

    pub(super) fn samples(&self) -> Ladder {
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

    pub(super) fn adaptive(&self) -> Ladder {
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

    pub(super) fn filter(&self) -> Ladder {
        let choices = (0..)
            .zip([Filter::Gaussian, Filter::Tent, Filter::Box])
            .map(|(place, filter)| {
                self.of_quality(filter.name(), f64::from(place), Quality { filter, ..self.rays(16) })
            })
            .collect();
        let explanation = "How the rays about a pixel count, with 16 of them. The truth is what a pixel's area shows, which \
                           the box is; wider filters trade that for calmer edges.";
        Ladder {
            knob: knob("filter", "Reconstruction filter", "filter", false, explanation, "", false),
            choices: with_last_exact(choices),
        }
    }
}
