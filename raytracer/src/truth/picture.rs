//! Pictures of a scene seen by triangles.

use super::Truth;
use super::eye::Eye;
use super::shading::Sample;
use super::triangles::Waiting;
use crate::camera::{Camera, CameraError};
use crate::color::{Display, Light3};
use crate::lens::Lens;
use crate::plan::Plan;
use crate::quality::Quality;
use crate::scene::{Model, SurfaceMaterial};
use crate::tone::Tone;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// A picture, row by row from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct TruthPicture {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Red, green, blue, opacity of each pixel, as displayed (sRGB); opaque everywhere.
    pub pixels: Vec<[u8; 4]>,
    /// Light of each pixel before exposure and tone mapping.
    pub light: Vec<Light3>,
    /// Pixels of which a sample met something.
    pub hit_pixels: u64,
}

/// Why there is no picture of a scene by triangles.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Unsupported {
    /// The camera sees nothing.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// A model has no triangles.
    #[error(
        "model number {model} of the scene is not a mesh; only what has triangles can be compared with them"
    )]
    NoTriangles {
        /// Its number, from 0.
        model: usize,
    },
    /// The scene gives a model materials of its own.
    #[error(
        "the scene changes materials of model number {model}; triangles are seen with those of the mesh alone"
    )]
    Materials {
        /// Its number, from 0.
        model: usize,
    },
    /// An effect that is left out.
    #[error("the scene calls for {effect}, which is not simulated on triangles")]
    Effect {
        /// Its name.
        effect: &'static str,
    },
}

/// Points of each lamp with an extent that are asked for each pixel at least, by all of its samples together.
const LAMP_POINTS: u32 = 64;

impl Truth<'_> {
    /// The picture that a camera sees, with `samples` rays through each pixel, at the places of those of
    /// [`Quality::of_samples`]; `size` is columns and rows.
    ///
    /// # Errors
    /// If the scene calls for something that is not simulated on triangles, or the camera sees nothing.
    pub fn picture(
        &self,
        camera: &Camera,
        lens: &Lens,
        size: [u32; 2],
        samples: u32,
        tone: &Tone,
    ) -> Result<TruthPicture, Unsupported> {
        self.check(lens)?;
        let eye = Eye::new(camera, lens, size)?;
        let [width, height] = size;
        let samples = samples.max(1);
        let offsets: Vec<[f32; 2]> =
            (0..samples).map(|index| Quality::sample_offset(index, samples)).collect();
        let pixel = |waiting: &mut Waiting, place: usize| {
            let pixel = [place % width as usize, place / width as usize].map(|place| place as u32);
            let (mut light, mut is_hit) = (DVec3::ZERO, false);
            for (number, offset) in (0..).zip(&offsets) {
                let sample = Sample { pixel, number, lamp_points: LAMP_POINTS.div_ceil(samples) };
                // In single precision, as the ray tracer has them.
                let [x, y] = [0, 1].map(|axis| pixel[axis] as f32 + offset[axis]);
                let ray = eye.ray([x, y].map(f64::from));
                let met = self.first_met(&ray, waiting);
                is_hit |= met.is_some();
                light += match met {
                    Some(met) => {
                        let surface = self.surface(&ray, &met);
                        self.scattered(&surface, -ray.direction, sample, waiting)
                    }
                    None => {
                        let share = y / height as f32;
                        self.scene.background.at(share, ray.direction.as_vec3()).as_dvec3()
                    }
                };
            }
            ((light / f64::from(samples)).as_vec3(), is_hit)
        };
        let area = width as usize * height as usize;
        let (light, is_hit): (Vec<Vec3>, Vec<bool>) =
            (0..area).into_par_iter().map_init(Waiting::default, pixel).unzip();
        let display = Display::shared();
        Ok(TruthPicture {
            width,
            height,
            pixels: light.iter().map(|light| display.pixel(tone.apply(*light))).collect(),
            hit_pixels: is_hit.iter().filter(|is_hit| **is_hit).count() as u64,
            light,
        })
    }

    /// Whether triangles can show what the scene does.
    fn check(&self, lens: &Lens) -> Result<(), Unsupported> {
        for (model, here) in self.scene.models.iter().enumerate() {
            if !self.scene.instances.iter().any(|instance| instance.model == model) {
                continue;
            }
            if model >= self.models.len() {
                return Err(Unsupported::NoTriangles { model });
            }
            let of_file = Model::new(here.octree).surfaces;
            let is_same = |(a, b): (&SurfaceMaterial, &SurfaceMaterial)| {
                // What is absorbed depends on the scale of the scene.
                SurfaceMaterial { absorption: b.absorption, ..*a } == *b
            };
            if here.surfaces.len() != of_file.len() || !here.surfaces.iter().zip(&of_file).all(is_same) {
                return Err(Unsupported::Materials { model });
            }
        }
        let plan = Plan::new(self.scene, lens, &Quality::default());
        let effects = [
            (plan.refraction, "materials that let light pass"),
            (plan.reflection, "mirrors"),
            (plan.emission, "materials that shine"),
            (plan.occlusion, "ambient occlusion"),
            (plan.depth_of_field, "depth of field"),
        ];
        match effects.into_iter().find(|(is_needed, _)| *is_needed) {
            Some((_, effect)) => Err(Unsupported::Effect { effect }),
            None => Ok(()),
        }
    }
}
