//! Knobs of the way from a mesh to an octree.

use super::super::subject::{Conversion, Normals};
use super::{Base, Choice, Ladder, knob, with_last_exact};
use octvox_converter::LodColor;
use octvox_raytracer::Quality;

impl Base {
    pub(super) fn resolution(&self) -> Option<Ladder> {
        let [_, deepest] = self.depths?;
        let finest = if self.is_quick { 10 } else { 13 }.min(self.finest);
        let last = if self.is_one_model { finest.max(deepest) } else { deepest };
        let choices: Vec<_> = (deepest.min(6)..=last)
            .map(|depth| {
                let levels = depth as i8 - deepest as i8;
                let label = format!("{}³", 1u32 << depth);
                self.picture(label, f64::from(1u32 << depth), self.finer(levels), self.quality)
            })
            .collect();
        let explanation = "Cells along each axis of the octree that the mesh is converted to; of several meshes, of the \
                           finest. Rays end at cells of a quarter of a pixel, so beyond the picture's own resolution the time stays.";
        let reason = if self.is_one_model {
            "1024³ is finer than the pixels of most pictures, converts in a second or two, and fits in tens of megabytes; \
             beyond, only close-ups gain."
        } else {
            "As fine as the scene has it."
        };
        Some(Ladder {
            knob: knob("resolution", "Resolution", "cells along an axis", true, explanation, reason, true),
            choices: with_last_exact(choices),
        })
    }

    pub(super) fn palette(&self) -> Option<Ladder> {
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

    pub(super) fn normals(&self) -> Option<Ladder> {
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
            Ladder { knob, choices: with_last_exact(choices.collect()) }
        })
    }

    pub(super) fn lod_color(&self) -> Option<Ladder> {
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
            Ladder { knob, choices: with_last_exact(choices.collect()) }
        })
    }
}
