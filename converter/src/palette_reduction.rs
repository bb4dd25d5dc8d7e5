//! Many colours to few: a palette whose error is as small as can be found in seconds.
//!
//! ```text
//!  colours ▶ groups of similar ones ▶ cut up where they differ most ▶ k-means on the groups ▶ k-means on the colours
//!            (if there are many)      palette_cut                     palette_kmeans           ▶ 8 bits, nearest entries
//! ```
//!
//! The error is the mean square distance in Oklab over all voxels, which k-means makes smaller with every pass. How it
//! compares with other ways is measured in `converter/PALETTE.md`.

use crate::color_set::ColorSet;
use crate::color_space::{oklab_to_displayed, to_oklab};
use crate::nearest_color::NearestColor;
use crate::palette_cut::{WeightedColor, cut};
use crate::palette_kmeans::refine;
use octvox_cli::Progress;
use rayon::prelude::*;
use std::ops::Range;

/// More colours than this are grouped first.
const MAX_GROUPS: usize = 1 << 18;
/// Passes over the groups. Further ones would gain less than 1 % each.
const GROUP_PASSES: usize = 8;

/// Colours that may share entries, ascending, each with the number of voxels that have it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Family<'a> {
    pub colors: &'a [[u8; 3]],
    pub voxels: &'a [u64],
}

/// What has become of a family.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Reduced {
    /// Ascending.
    pub palette: Vec<[u8; 3]>,
    /// For each colour of the family, the nearest entry of its palette.
    pub entries: Vec<u16>,
}

/// Reduces families to `size` entries in all, or a few less. There must be no more families than that, and `size` is less
/// than 65,536.
pub(crate) fn reduce(families: &[Family<'_>], size: usize, progress: &Progress) -> Vec<Reduced> {
    progress.stage("palette", GROUP_PASSES as u64 + 3);
    let (mut groups, ranges) = group(families);
    let mut palettes = cut(&mut groups, &ranges, size);
    progress.add(1);
    for _ in 0..GROUP_PASSES {
        for (palette, range) in palettes.iter_mut().zip(&ranges) {
            let groups = &groups[range.clone()];
            *palette = refine(palette, groups.len(), |index| groups[index]);
        }
        progress.add(1);
    }
    let reduced = palettes.iter().zip(families).map(|(palette, family)| {
        let color = |index: usize| WeightedColor {
            oklab: to_oklab(family.colors[index]),
            voxels: family.voxels[index],
        };
        nearest_entries(&refine(palette, family.colors.len(), color), family.colors)
    });
    let reduced = reduced.collect();
    progress.add(2);
    reduced
}

/// Rounds the palette to 8 bits, and finds the nearest entry for each colour.
fn nearest_entries(palette: &[[f32; 3]], colors: &[[u8; 3]]) -> Reduced {
    let mut palette: Vec<[u8; 3]> = palette.iter().map(|&color| oklab_to_displayed(color)).collect();
    palette.sort_unstable();
    palette.dedup();
    let oklab: Vec<[f32; 3]> = palette.iter().map(|&color| to_oklab(color)).collect();
    let nearest = NearestColor::new(&oklab, colors.len());
    let entries = colors.par_iter().map(|&color| nearest.nearest(to_oklab(color)) as u16).collect();
    Reduced { palette, entries }
}

/// Groups the colours of each family by their highest bits, so that there are no more than [`MAX_GROUPS`]: the mean of
/// each group, and which groups are a family's. Few colours are groups of their own.
fn group(families: &[Family<'_>]) -> (Vec<WeightedColor>, Vec<Range<usize>>) {
    let mut dropped_bits = 0;
    while number_of_groups(families, dropped_bits) > MAX_GROUPS {
        dropped_bits += 1;
    }
    let mut groups = Vec::new();
    let ranges = families
        .iter()
        .map(|family| {
            let first = groups.len();
            groups.extend(group_family(*family, dropped_bits));
            first..groups.len()
        })
        .collect();
    (groups, ranges)
}

fn number_of_groups(families: &[Family<'_>], dropped_bits: u32) -> usize {
    if dropped_bits == 0 {
        return families.iter().map(|family| family.colors.len()).sum();
    }
    families.iter().map(|family| coarse_set(family.colors, dropped_bits).len()).sum()
}

fn coarse_set(colors: &[[u8; 3]], dropped_bits: u32) -> ColorSet {
    ColorSet::of(colors.iter().map(|&color| coarse(color, dropped_bits)))
}

fn coarse(color: [u8; 3], dropped_bits: u32) -> [u8; 3] {
    color.map(|channel| channel >> dropped_bits)
}

fn group_family(family: Family<'_>, dropped_bits: u32) -> Vec<WeightedColor> {
    let colors: Vec<WeightedColor> = family
        .colors
        .par_iter()
        .zip(family.voxels)
        .map(|(&color, &voxels)| WeightedColor { oklab: to_oklab(color), voxels })
        .collect();
    if dropped_bits == 0 {
        return colors;
    }
    let set = coarse_set(family.colors, dropped_bits);
    let mut sums = vec![([0.0; 3], 0); set.len()];
    for (color, weighted) in family.colors.iter().zip(colors) {
        let (sum, voxels) = &mut sums[set.number(coarse(*color, dropped_bits))];
        for (sum, coordinate) in sum.iter_mut().zip(weighted.oklab) {
            *sum += f64::from(coordinate) * weighted.voxels as f64;
        }
        *voxels += weighted.voxels;
    }
    let mean = |(sum, voxels): ([f64; 3], u64)| WeightedColor {
        oklab: sum.map(|coordinate| (coordinate / voxels.max(1) as f64) as f32),
        voxels,
    };
    sums.into_iter().map(mean).collect()
}
