//! Palette indices for leaves, levels of detail and the inside.

use crate::color_census::ColorCensus;
use crate::lod_color::{Light, LodColor, majority_colors, mean_colors};
use crate::palette::PaletteMap;
use crate::structure::Structure;
use crate::voxel_filter::Leaves;

/// The palette, and how nodes get their entries.
pub(crate) struct Coloring<'a> {
    pub census: &'a ColorCensus,
    pub palette: &'a PaletteMap,
    pub lod_color: LodColor,
}

/// The palette indices of the leaves of a block.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Indices {
    /// All have the same.
    Same(u16),
    /// Each has its own.
    Each(Vec<u16>),
}

impl Indices {
    #[inline]
    pub(crate) fn get(&self, leaf: usize) -> u16 {
        match self {
            Self::Same(index) => *index,
            Self::Each(indices) => indices[leaf],
        }
    }
}

/// The palette indices of nodes.
pub(crate) enum NodeIndices {
    /// All have the same.
    Same(u16),
    /// Level by level.
    Each(Vec<Vec<u16>>),
}

impl NodeIndices {
    #[inline]
    pub(crate) fn get(&self, level: usize, node: usize) -> u16 {
        match self {
            Self::Same(index) => *index,
            Self::Each(levels) => levels[level][node],
        }
    }
}

impl Coloring<'_> {
    /// Those of the leaves of a block.
    pub(crate) fn leaves(&self, leaves: &Leaves) -> Indices {
        let index = |leaf| self.palette.index(self.census, leaves.look(leaf));
        if leaves.is_uniform() {
            Indices::Same(index(0))
        } else {
            Indices::Each((0..leaves.normals.len()).map(index).collect())
        }
    }

    /// Those of the nodes of a block, and the light of all its leaves.
    pub(crate) fn nodes(&self, leaves: &Leaves, indices: &Indices) -> (NodeIndices, Light) {
        match indices {
            Indices::Same(index) => {
                (NodeIndices::Same(*index), Light::of(leaves.look(0), leaves.normals.len() as u64))
            }
            Indices::Each(indices) => {
                self.filter(&leaves.structure, |leaf| (Light::of(leaves.look(leaf), 1), indices[leaf]))
            }
        }
    }

    /// Those of the nodes above leaves, or blocks, that have this light and these indices.
    pub(crate) fn filter(
        &self,
        structure: &Structure,
        leaf: impl Fn(usize) -> (Light, u16),
    ) -> (NodeIndices, Light) {
        match self.lod_color {
            LodColor::Mean => {
                let nearest = |finish, color| self.palette.nearest_index(self.census, (finish, color));
                let (levels, light) = mean_colors(structure, leaf, nearest);
                (NodeIndices::Each(levels), light)
            }
            LodColor::Majority => {
                let levels = majority_colors(structure, |number| leaf(number).1);
                (NodeIndices::Each(levels), Light::default())
            }
        }
    }

    /// That of the inside: the mean colour of the surface, with the finish that most of it has.
    pub(crate) fn inside(&self) -> u16 {
        let light = self.census.light();
        light.mean().map_or(1, |color| self.palette.nearest_index(self.census, (light.finish, color)))
    }
}
