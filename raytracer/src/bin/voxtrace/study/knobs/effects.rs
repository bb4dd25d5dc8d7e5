//! Knobs of what happens where a ray has met something; only those that the subject's plan needs.

use super::{Base, Choice, Ladder, knob, with_last_exact};
use octvox_raytracer::{Leave, Quality};

impl Base {
    pub(super) fn leave(&self) -> Option<Ladder> {
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

    pub(super) fn light_samples(&self) -> Option<Ladder> {
        self.plan.soft_shadows.then(|| {
            let explanation = "Rays to each lamp that has an extent, for each point seen.";
            let reason = "One, as rays through the pixel multiply it.";
            let knob =
                knob("light-samples", "Soft shadows", "rays to a lamp", true, explanation, reason, false);
            Ladder { knob, choices: self.counts(|light_samples| Quality { light_samples, ..self.quality }) }
        })
    }

    pub(super) fn ambient_samples(&self) -> Option<Ladder> {
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

    pub(super) fn bounces(&self) -> Option<Ladder> {
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

    pub(super) fn cutoff(&self) -> Option<Ladder> {
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

    pub(super) fn smoothing(&self) -> Option<Ladder> {
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
}
