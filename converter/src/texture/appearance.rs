//! What the samples of a textured triangle look like.

use super::coordinates::TexturePoint;
use super::footprint::Gradients;
use super::lookup::Lookup;
use super::normal_map::{NormalLookup, Tangents};
use super::pyramid::{Encoding, Pyramid};
use crate::scan_conversion::GridTriangle;
use crate::surface::{light_to_value, value_to_light};
use crate::texture_map::{Channel, TextureMap};
use crate::{Material, Mesh};
use std::collections::{BTreeMap, BTreeSet};

/// The textures of a mesh.
#[derive(Debug)]
pub(crate) struct Textures<'a> {
    mesh: &'a Mesh,
    pyramids: BTreeMap<(usize, Encoding), Pyramid<'a>>,
}

impl<'a> Textures<'a> {
    /// Builds the pyramids of all images that are used.
    pub(crate) fn new(mesh: &'a Mesh) -> Self {
        let mut pyramids = BTreeMap::new();
        if !mesh.corner_texture_coordinates.is_empty() {
            let opacities = mesh.materials.iter().filter_map(|material| material.opacity_map);
            let cut_out: BTreeSet<usize> =
                opacities.filter(|map| map.channel == Channel::Alpha).map(|map| map.image).collect();
            for (map, encoding) in mesh.materials.iter().flat_map(maps) {
                pyramids.entry((map.image, encoding)).or_insert_with(|| {
                    Pyramid::new(&mesh.images[map.image], encoding, cut_out.contains(&map.image))
                });
            }
        }
        Self { mesh, pyramids }
    }

    /// Whether no triangle has a texture.
    pub(crate) fn is_empty(&self) -> bool {
        self.pyramids.is_empty()
    }

    /// The material of a triangle that has maps, and coordinates for them.
    pub(crate) fn material(&self, triangle: usize) -> Option<&'a Material> {
        if self.pyramids.is_empty() {
            return None;
        }
        let material = &self.mesh.materials[*self.mesh.triangle_materials.get(triangle)? as usize];
        let coordinates = &self.mesh.corner_texture_coordinates[triangle];
        let is_textured = maps(material).next().is_some()
            && coordinates.as_flattened().iter().all(|coordinate| coordinate.is_finite());
        is_textured.then_some(material)
    }

    /// What the samples of a triangle with this material look like.
    pub(crate) fn appearance(
        &self,
        material: &'a Material,
        triangle: &GridTriangle<6, TexturePoint>,
    ) -> Appearance<'_> {
        // A triangle without area may still stand for a part that has no other voxel: it sees the image itself.
        let gradients = Gradients::new(triangle.corners(), triangle.coordinates());
        let gradients = gradients.unwrap_or(Gradients::STILL);
        self.appearance_of(material, &gradients, Tangents::new(&gradients))
    }

    /// The same with textures as sharp as their images. `gradients` tell how they lie on the triangle, if it has an area.
    pub(crate) fn finest_appearance(
        &self,
        material: &'a Material,
        gradients: Option<&Gradients>,
    ) -> Appearance<'_> {
        self.appearance_of(material, &Gradients::STILL, gradients.and_then(Tangents::new))
    }

    fn appearance_of(
        &self,
        material: &'a Material,
        gradients: &Gradients,
        tangents: Option<Tangents>,
    ) -> Appearance<'_> {
        let lookup = |map: &'a TextureMap, encoding| {
            Lookup::new(&self.pyramids[&(map.image, encoding)], map, gradients)
        };
        Appearance {
            diffuse: material.diffuse_map.as_ref().map(|map| lookup(map, Encoding::Color)),
            opacity: material.opacity_map.as_ref().map(|map| lookup(map, Encoding::Numbers)),
            alpha_cutoff: material.alpha_cutoff as f32,
            normal: material.normal_map.as_ref().and_then(|normal| {
                let tangents = tangents?;
                let lookup = lookup(&normal.map, Encoding::Numbers);
                Some(NormalLookup { lookup, kind: normal.kind, tangents })
            }),
        }
    }
}

/// The maps that samples are looked up in.
fn maps(material: &Material) -> impl Iterator<Item = (&TextureMap, Encoding)> {
    let diffuse = material.diffuse_map.as_ref().map(|map| (map, Encoding::Color));
    let opacity = material.opacity_map.as_ref().map(|map| (map, Encoding::Numbers));
    let normal = material.normal_map.as_ref().map(|normal| (&normal.map, Encoding::Numbers));
    [diffuse, opacity, normal].into_iter().flatten()
}

/// What the samples of a textured triangle look like.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Appearance<'a> {
    diffuse: Option<Lookup<'a>>,
    opacity: Option<Lookup<'a>>,
    alpha_cutoff: f32,
    normal: Option<NormalLookup<'a>>,
}

impl Appearance<'_> {
    /// Normal and light of a sample with these texture coordinates, from those without textures; `None` if it is cut out.
    pub(crate) fn of(&self, values: [i16; 6], coordinates: [f64; 2]) -> Option<[i16; 6]> {
        if let Some(opacity) = &self.opacity
            && opacity.see(coordinates).number() < self.alpha_cutoff
        {
            return None;
        }
        let [x, y, z, light @ ..] = values;
        let [x, y, z] = match &self.normal {
            Some(map) => map.tilted([x, y, z], coordinates),
            None => [x, y, z],
        };
        let [red, green, blue] = match &self.diffuse {
            Some(map) => {
                let seen = map.see(coordinates).color();
                [0, 1, 2].map(|channel| {
                    let light = f32::from(value_to_light(light[channel])) * seen[channel];
                    // The conversion to an integer saturates.
                    light_to_value((light + 0.5) as u16)
                })
            }
            None => light,
        };
        Some([x, y, z, red, green, blue])
    }
}
