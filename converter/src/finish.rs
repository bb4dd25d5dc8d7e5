//! Finishes: everything of a material but its diffuse colour and its textures.
//!
//! A voxel has a colour, the mean of its samples, and a finish, that of most of them. Materials that differ in nothing but
//! colour share a finish.

use crate::{ConvertError, Material};
use std::collections::HashMap;

/// The finishes of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Finishes {
    /// As materials of the file whose diffuse colour is black. There is at least one.
    pub finishes: Vec<octvox_format::Material>,
    /// For each material of the mesh, the number of its finish.
    pub of_material: Vec<u16>,
}

impl Finishes {
    /// The finishes of these materials, numbered in the order in which they come.
    ///
    /// # Errors
    /// [`ConvertError::TooLarge`] if there are more than 65,536.
    pub(crate) fn new(materials: &[Material]) -> Result<Self, ConvertError> {
        let mut numbers = HashMap::new();
        let mut result = Self { finishes: Vec::new(), of_material: Vec::with_capacity(materials.len()) };
        for material in materials {
            let finish = finish(material);
            let next = result.finishes.len();
            let number = *numbers.entry(key(&finish)).or_insert(next);
            let Ok(index) = u16::try_from(number) else {
                let max = usize::from(u16::MAX) + 1;
                return Err(ConvertError::TooLarge { kind: "finishes of materials", count: max + 1, max });
            };
            if number == next {
                result.finishes.push(finish);
            }
            result.of_material.push(index);
        }
        if result.finishes.is_empty() {
            result.finishes.push(finish(&Material::default()));
        }
        Ok(result)
    }

    /// The finish of a material of the mesh; of triangles without a material the first.
    #[inline]
    pub(crate) fn of(&self, material: Option<u32>) -> u16 {
        material.and_then(|material| self.of_material.get(material as usize)).copied().unwrap_or(0)
    }
}

/// The finish of a material, with its numbers held to what the file can store.
fn finish(material: &Material) -> octvox_format::Material {
    // The conversion to an integer saturates, and takes what is not a number to 0.
    let share = |share: f64| (255.0 * share).round() as u8;
    let amount = |amount: f64| if amount > 0.0 { amount.min(f64::from(f32::MAX)) as f32 } else { 0.0 };
    let specular = material.specular.map(share);
    let index = material.refraction_index as f32;
    octvox_format::Material {
        diffuse: [0; 3],
        reflectivity: share(material.reflectivity),
        specular,
        transparency: if material.opacity.is_nan() { 0 } else { share(1.0 - material.opacity) },
        // Without a highlight its size does not matter.
        shininess: if specular == [0; 3] { 0.0 } else { amount(material.shininess) },
        refraction_index: if index.is_normal() && index > 0.0 { index } else { 1.0 },
        absorption: material.absorption.map(amount),
        emission: material.emission.map(amount),
    }
}

/// What is equal for equal finishes.
fn key(finish: &octvox_format::Material) -> ([u8; 5], [u32; 8]) {
    let [red, green, blue] = finish.specular;
    let ([a, b, c], [d, e, f]) = (finish.absorption, finish.emission);
    (
        [red, green, blue, finish.reflectivity, finish.transparency],
        [finish.shininess, finish.refraction_index, a, b, c, d, e, f].map(f32::to_bits),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::TextureMap;

    #[test]
    fn colors_and_textures_do_not_make_a_finish() {
        let matte = Material::matte("a", [0.1; 3]);
        let painted = Material { diffuse_map: Some(TextureMap::new(3)), ..Material::matte("b", [1.0; 3]) };
        let glass = Material { opacity: 0.25, refraction_index: 1.5, ..matte.clone() };
        let metal = Material { specular: [1.0; 3], shininess: 80.0, reflectivity: 0.5, ..matte.clone() };
        let finishes = Finishes::new(&[matte, glass.clone(), painted, metal, glass]).unwrap();
        assert_eq!(finishes.of_material, [0, 1, 0, 2, 1]);
        assert_eq!(finishes.finishes[0], octvox_format::Material::matte([0; 3]));
        assert_eq!((finishes.finishes[1].transparency, finishes.finishes[1].refraction_index), (191, 1.5));
        let metal = finishes.finishes[2];
        assert_eq!((metal.specular, metal.shininess, metal.reflectivity), ([255; 3], 80.0, 128));
        assert_eq!((finishes.of(Some(3)), finishes.of(None)), (2, 0));
    }

    #[test]
    fn a_mesh_without_materials_has_one_finish() {
        let finishes = Finishes::new(&[]).unwrap();
        assert_eq!((finishes.finishes.len(), finishes.of(None)), (1, 0));
    }

    #[test]
    fn impossible_numbers_become_possible_ones() {
        for number in [f64::NAN, f64::INFINITY, -1.0, 1e300] {
            let material = Material {
                opacity: number,
                specular: [number, 1.0, 1.0],
                shininess: number,
                reflectivity: number,
                refraction_index: number,
                emission: [number; 3],
                absorption: [number; 3],
                ..Material::default()
            };
            let found = Finishes::new(&[material]).unwrap().finishes[0];
            let all = [found.absorption, found.emission, [found.shininess, found.refraction_index, 0.0]];
            assert!(all.as_flattened().iter().all(|&n| n.is_finite() && n >= 0.0), "{found:?}");
            assert!(found.refraction_index > 0.0);
        }
    }
}
