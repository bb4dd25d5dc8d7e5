//! Which effects a scene calls for, found out before the first ray.

use crate::lens::Lens;
use crate::quality::Quality;
use crate::scene::Scene;
use serde::Serialize;

/// The effects that a picture of a scene needs. What is not in the plan costs nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Plan {
    /// Some lamp makes shadows.
    pub shadows: bool,
    /// Some lamp that makes shadows has an extent.
    pub soft_shadows: bool,
    /// Some material that is used mirrors.
    pub reflection: bool,
    /// Some material that is used lets light pass.
    pub refraction: bool,
    /// Some material that is used shines.
    pub emission: bool,
    /// What is near keeps off light from around.
    pub occlusion: bool,
    /// What shines lights others.
    pub glow: bool,
    /// Things out of focus are blurred.
    pub depth_of_field: bool,
    /// Large voxels are smoothed.
    pub smoothing: bool,
    /// Pixels that need more rays get more.
    pub adaptive_sampling: bool,
}

impl Plan {
    /// What a scene calls for. Materials count if a voxel has them, of a model that stands in the scene.
    #[must_use]
    pub fn new(scene: &Scene<'_>, lens: &Lens, quality: &Quality) -> Self {
        let mut plan = Self {
            shadows: scene.lights.iter().any(|light| light.shadow),
            soft_shadows: scene.lights.iter().any(|light| light.shadow && light.is_soft()),
            occlusion: scene.ambient.occlusion.is_some(),
            depth_of_field: lens.aperture > 0.0,
            smoothing: quality.smooth_pixels < f64::INFINITY,
            adaptive_sampling: quality.most_samples > quality.samples,
            ..Self::default()
        };
        let of_ground = scene.ground.iter().flat_map(|ground| ground.surfaces);
        let of_models = scene
            .models
            .iter()
            .enumerate()
            .filter(|(number, _)| scene.instances.iter().any(|instance| instance.model == *number))
            .flat_map(|(_, model)| {
                let is_plain = model.surfaces.iter().all(|surface| surface.is_plain());
                let used = if is_plain { Vec::new() } else { model.octree.used_palette_entries() };
                model.surfaces.iter().zip(used).filter(|(_, used)| *used).map(|(surface, _)| *surface)
            });
        for surface in of_ground.chain(of_models) {
            plan.reflection |=
                surface.is_mirror() || surface.is_transparent() && surface.refraction_index != 1.0;
            plan.refraction |= surface.is_transparent();
            plan.emission |= surface.is_emissive();
        }
        plan.glow = plan.emission && scene.ambient.glow;
        // What lets light pass mirrors some of it; no ray is followed that may not go on.
        if quality.bounces == 0 {
            plan.reflection = false;
            plan.refraction = false;
        }
        plan
    }

    /// The names of the effects.
    #[must_use]
    pub fn names(&self) -> Vec<&'static str> {
        let optional = [
            (self.shadows, "shadows"),
            (self.soft_shadows, "soft shadows"),
            (self.reflection, "reflection"),
            (self.refraction, "refraction"),
            (self.emission, "emission"),
            (self.occlusion, "ambient occlusion"),
            (self.glow, "glow"),
            (self.depth_of_field, "depth of field"),
            (self.smoothing, "smoothing"),
            (self.adaptive_sampling, "adaptive sampling"),
        ];
        let named = optional.into_iter().filter(|(is_needed, _)| *is_needed).map(|(_, name)| name);
        std::iter::once("phong").chain(named).collect()
    }

    /// Whether rays are sent into mirrors or glass.
    pub(crate) fn branches(&self) -> bool {
        self.reflection || self.refraction
    }

    /// Whether rays are sent all around.
    pub(crate) fn around(&self) -> bool {
        self.occlusion || self.glow
    }

    /// The set of effects that a picture is compiled for: no larger than needed where speed counts most.
    pub(crate) fn effects(&self) -> u8 {
        if self.branches() || self.around() {
            effect::ALL
        } else if self.shadows {
            effect::SHADOWS
        } else {
            effect::NONE
        }
    }
}

/// Sets of effects that rays are sent for from what the eye sees. What is compiled for one does not ask for others.
pub(crate) mod effect {
    /// Nothing is sent.
    pub const NONE: u8 = 0;
    /// To lamps.
    pub const SHADOWS: u8 = 1;
    /// To lamps, into mirrors and glass, all around: whatever the plan says.
    pub const ALL: u8 = 2;
}

/// Calls a function that is generic over a set of [`effect`]s with a set known at run time.
macro_rules! with_effects {
    ($effects:expr, $name:ident => $call:expr) => {
        match $effects {
            $crate::plan::effect::NONE => {
                const $name: u8 = $crate::plan::effect::NONE;
                $call
            }
            $crate::plan::effect::SHADOWS => {
                const $name: u8 = $crate::plan::effect::SHADOWS;
                $call
            }
            _ => {
                const $name: u8 = $crate::plan::effect::ALL;
                $call
            }
        }
    };
}
pub(crate) use with_effects;
