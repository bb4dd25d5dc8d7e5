//! How far displacement maps move a surface.

use super::coordinates::TexturePoint;
use super::footprint::Gradients;
use super::lookup::Lookup;
use super::pyramid::{Encoding, Pyramid};
use crate::scan_conversion::GridTriangle;
use crate::{DisplacementMap, Mesh};
use std::collections::BTreeMap;

/// The displacement maps of a mesh.
#[derive(Debug)]
pub(crate) struct Displacement<'a> {
    mesh: &'a Mesh,
    pyramids: BTreeMap<usize, Pyramid<'a>>,
}

/// The height of a triangle's surface.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Height<'a> {
    lookup: Lookup<'a>,
    multiplier: f64,
}

impl<'a> Displacement<'a> {
    pub(crate) fn new(mesh: &'a Mesh) -> Self {
        let mut pyramids = BTreeMap::new();
        if !mesh.corner_texture_coordinates.is_empty() {
            for map in mesh.materials.iter().filter_map(|material| material.displacement_map) {
                let image = map.map.image;
                let pyramid = || Pyramid::new(&mesh.images[image], Encoding::Numbers, false);
                pyramids.entry(image).or_insert_with(pyramid);
            }
        }
        Self { mesh, pyramids }
    }

    /// Whether nothing moves.
    pub(crate) fn is_empty(&self) -> bool {
        self.pyramids.is_empty()
    }

    /// The map that moves a triangle, if there is one and the triangle has coordinates for it.
    pub(crate) fn map(&self, triangle: usize) -> Option<&'a DisplacementMap> {
        if self.pyramids.is_empty() {
            return None;
        }
        let material = &self.mesh.materials[*self.mesh.triangle_materials.get(triangle)? as usize];
        let coordinates = &self.mesh.corner_texture_coordinates[triangle];
        let is_finite = coordinates.as_flattened().iter().all(|coordinate| coordinate.is_finite());
        material.displacement_map.as_ref().filter(|_| is_finite)
    }

    /// The height over a triangle, as the mean over areas `width` voxels wide.
    pub(crate) fn height(
        &self,
        map: &'a DisplacementMap,
        triangle: &GridTriangle<0, TexturePoint>,
        width: f64,
    ) -> Height<'_> {
        let gradients = Gradients::new(triangle.corners(), triangle.coordinates());
        let Gradients(gradients) = gradients.unwrap_or(Gradients([[0.0; 3]; 2]));
        let gradients = Gradients(gradients.map(|gradient| gradient.map(|component| component * width)));
        let lookup = Lookup::new(&self.pyramids[&map.map.image], &map.map, &gradients);
        Height { lookup, multiplier: map.multiplier }
    }
}

impl Height<'_> {
    /// The way outward at these texture coordinates, in world units.
    pub(crate) fn at(&self, coordinates: [f64; 2]) -> f64 {
        self.multiplier * f64::from(self.lookup.see(coordinates).number())
    }
}
