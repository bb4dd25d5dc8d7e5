//! The materials of an octree as the 255 colours of a file.

use super::reduction::reduce;
use crate::{Material, MaterialPalette};
use std::collections::BTreeMap;

/// Colours that a file can have.
const MAX_COLORS: usize = 255;

/// What is left of a palette.
pub(super) struct ReducedPalette {
    /// Those of the indices from 1 on.
    materials: Vec<Material>,
    /// The new index of each old one in use.
    indices: BTreeMap<u16, u8>,
}

impl ReducedPalette {
    /// The materials that are used so often: all of them if they are not too many, else their diffuse colours, reduced to
    /// as many as there may be.
    pub fn new(uses: &BTreeMap<u16, u64>, materials: &MaterialPalette) -> Self {
        // A palette index that the palette does not have cannot have come out of a reader.
        let material = |index: &u16| materials.material(*index).copied().unwrap_or(Material::matte([0; 3]));
        if uses.len() <= MAX_COLORS {
            let materials = uses.keys().map(material).collect();
            return Self { materials, indices: uses.keys().copied().zip(1..=u8::MAX).collect() };
        }
        let mut of_color: BTreeMap<[u8; 3], u64> = BTreeMap::new();
        for (index, uses) in uses {
            *of_color.entry(material(index).diffuse).or_default() += uses;
        }
        let colors: Vec<([u8; 3], u64)> = of_color.into_iter().collect();
        let (reduced, places) = reduce(&colors, MAX_COLORS);
        // At most 255 places, counted from 0.
        let new_index: BTreeMap<[u8; 3], u8> =
            colors.iter().zip(places).map(|((color, _), place)| (*color, place as u8 + 1)).collect();
        let new = |index: &u16| (*index, new_index.get(&material(index).diffuse).copied().unwrap_or(1));
        Self {
            materials: reduced.into_iter().map(Material::matte).collect(),
            indices: uses.keys().map(new).collect(),
        }
    }

    /// The materials of the indices from 1 on.
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// The new index of an old one, which is in use.
    pub fn index_of(&self, palette_index: u16) -> u8 {
        self.indices.get(&palette_index).copied().unwrap_or(1)
    }

    /// 256 times red, green, blue and opacity.
    pub fn colors(&self) -> Vec<u8> {
        let colors = self.materials.iter().flat_map(|material| {
            let [red, green, blue] = material.diffuse;
            [red, green, blue, u8::MAX]
        });
        let mut bytes: Vec<u8> = colors.collect();
        bytes.resize(4 * 256, 0);
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_materials_stay_as_they_are() {
        let glass = Material { transparency: 9, ..Material::matte([1, 2, 3]) };
        let materials =
            MaterialPalette::new(vec![Material::matte([9; 3]), Material::matte([1, 2, 3]), glass]).unwrap();
        let palette = ReducedPalette::new(&BTreeMap::from([(2, 5), (3, 1)]), &materials);
        assert_eq!(palette.materials(), [Material::matte([1, 2, 3]), glass]);
        assert_eq!([2, 3].map(|index| palette.index_of(index)), [1, 2]);
        assert_eq!(palette.colors()[..8], [1, 2, 3, 255, 1, 2, 3, 255]);
        assert_eq!(palette.colors().len(), 1024);
    }

    #[test]
    fn equal_colors_do_not_count_twice() {
        let materials =
            (0..300).map(|k| Material { shininess: k as f32, ..Material::matte([(k % 100) as u8; 3]) });
        let materials = MaterialPalette::new(materials.collect()).unwrap();
        let palette = ReducedPalette::new(&(1..=300).map(|index| (index, 1)).collect(), &materials);
        for index in 1..=300_u16 {
            let found = palette.materials()[usize::from(palette.index_of(index)) - 1];
            assert_eq!(found, Material::matte([((index - 1) % 100) as u8; 3]));
        }
    }

    #[test]
    fn many_colors_become_255_near_ones() {
        let color = |k: u16| [(k % 40) as u8 * 6, (k / 40) as u8 * 6, 77];
        let materials = MaterialPalette::new((0..1600).map(|k| Material::matte(color(k))).collect()).unwrap();
        let palette =
            ReducedPalette::new(&(1..=1600).map(|index| (index, u64::from(index))).collect(), &materials);
        assert_eq!(palette.materials().len(), 255);
        for k in 0..1600 {
            let found = palette.materials()[usize::from(palette.index_of(k + 1)) - 1].diffuse;
            assert!((0..3).all(|channel| found[channel].abs_diff(color(k)[channel]) <= 24), "{k}: {found:?}");
        }
    }
}
