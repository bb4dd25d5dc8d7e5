//! What may be approximated, and how far.

use crate::arithmetic::Arithmetic;

/// Every approximation of a picture, each with an exact setting.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quality {
    /// A ray ends at a cell that looks no larger than this many pixels. Exact: 0, the finest cells.
    pub lod_pixels: f64,
    /// Rays through each pixel, at least 1. Exact: the more, the closer to the area that a pixel covers.
    pub samples: u32,
    /// Rays through a pixel that differs from its neighbours or in itself; no fewer than `samples`. Exact: `samples`
    /// itself, if that is large.
    pub most_samples: u32,
    /// Pixels whose displayed value is known to this share of the whole range, by the differences found, get no more than
    /// `samples` rays. Exact: 0.
    pub contrast: f32,
    /// How much each ray of a pixel and its surroundings counts. Exact: what the display does with a pixel.
    pub filter: Filter,
    /// Rays to each lamp that has an extent, for each point seen. Exact: the more the better.
    pub light_samples: u32,
    /// Rays for light from around, for each point seen. Exact: the more the better.
    pub ambient_samples: u32,
    /// How often light is followed further by mirrors and glass. Exact: the more the better.
    pub bounces: u32,
    /// Rays are not sent to lamps that add less light than this, nor into mirrors, glass and around if less than this share of
    /// what they see comes to the eye. Exact: 0.
    pub cutoff: f32,
    /// How rays leave a surface.
    pub leave: Leave,
    /// Voxels that look larger than this many pixels are smoothed. Cubes as they are: infinity.
    pub smooth_pixels: f64,
    /// How precisely rays of all kinds are followed. Exact: double.
    pub arithmetic: Arithmetic,
}

/// How much the rays count that go through the surroundings of a pixel's middle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Filter {
    /// All rays through the pixel alike.
    Box,
    /// Less and less towards the middles of the neighbours.
    Tent,
    /// As a Gaussian curve with a standard deviation of half a pixel, cut off at one and a half pixels.
    Gaussian,
}

/// How rays to lamps, into mirrors and around leave the voxels of a surface, whose neighbours are steps in their way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Leave {
    /// Past all voxels that belong to the same surface: those that are no higher above its tangent plane than scan conversion
    /// can have put them, and face much the same way.
    Surface,
    /// From outside the voxel itself.
    Voxel,
    /// From one and a half voxels above the surface, past whatever is there (Bohnen 2009, section 5.2, suggests to raise the
    /// origin).
    Raised,
}

impl Leave {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Surface, Self::Voxel, Self::Raised];

    /// Its name on the command line and in scene files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Surface => "surface",
            Self::Voxel => "voxel",
            Self::Raised => "raised",
        }
    }

    /// The one of this name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|leave| leave.name() == name)
    }
}

impl Filter {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Box, Self::Tent, Self::Gaussian];

    /// Its name on the command line and in scene files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Box => "box",
            Self::Tent => "tent",
            Self::Gaussian => "gaussian",
        }
    }

    /// The one of this name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|filter| filter.name() == name)
    }

    /// How far from the middle of a pixel its rays may be, in pixels.
    pub(crate) fn radius(self) -> f64 {
        match self {
            Self::Box => 0.5,
            Self::Tent => 1.0,
            Self::Gaussian => 1.5,
        }
    }

    /// Where a ray goes through, from the middle of its pixel, so that rays for evenly spread numbers in [0, 1) are as dense
    /// as they are to count: all of them count alike then. (M. Ernst et al., "Filter importance sampling", 2006.)
    fn offset(self, share: f64) -> f64 {
        match self {
            Self::Box => share - 0.5,
            Self::Tent if share < 0.5 => (2.0 * share).sqrt() - 1.0,
            Self::Tent => 1.0 - (2.0 - 2.0 * share).sqrt(),
            Self::Gaussian => {
                // Half of the curve is below 0; with a standard deviation of a half, √2 x is its error function's argument.
                let below = |x: f64| libm::erf(x * std::f64::consts::SQRT_2);
                let wanted = (2.0 * share - 1.0) * below(self.radius());
                let (mut low, mut high) = (-self.radius(), self.radius());
                for _ in 0..40 {
                    let middle = (low + high) / 2.0;
                    if below(middle) < wanted { low = middle } else { high = middle }
                }
                (low + high) / 2.0
            }
        }
    }
}

/// Half a step of a picture of eight bits, where steps are the finest: a change of less does not show.
const HALF_STEP: f32 = 1.0 / 255.0 / 12.92 / 2.0;

/// Cells at which rays end by default, in pixels, if a pixel has few of them: coarser ones show at silhouettes, which they widen,
/// and save little time (STUDY.md).
const LOD_OF_FEW_RAYS: f64 = 0.25;

/// Cells at which rays end by default, in pixels, if a pixel has up to so many of them.
fn lod_of_rays(most_samples: u32) -> f64 {
    LOD_OF_FEW_RAYS.min(0.5 / f64::from(most_samples.max(1)).sqrt())
}

impl Default for Quality {
    fn default() -> Self {
        Self::of_samples(1)
    }
}

impl Quality {
    /// So many rays through each pixel, which end at cells that look no larger than a quarter of the pixel and than half the
    /// distance from one ray to the next.
    #[must_use]
    pub fn of_samples(samples: u32) -> Self {
        Self::adapting(samples, samples)
    }

    /// The `lod_pixels` that go by default with as many rays as there are.
    #[must_use]
    pub fn lod_of_its_rays(&self) -> f64 {
        lod_of_rays(self.most_samples)
    }

    /// So many rays through each pixel, and up to so many through those that need them. Rays end at cells that look no larger
    /// than a quarter of the pixel and than half the distance between the most rays of one.
    #[must_use]
    pub fn adapting(samples: u32, most_samples: u32) -> Self {
        Self {
            lod_pixels: lod_of_rays(most_samples),
            samples,
            most_samples,
            contrast: 0.02,
            filter: Filter::Box,
            light_samples: 1,
            ambient_samples: 1,
            bounces: 8,
            cutoff: HALF_STEP,
            leave: Leave::Surface,
            smooth_pixels: f64::INFINITY,
            arithmetic: Arithmetic::Single,
        }
    }

    /// Where sample number `index` goes through, from the upper left corner of its pixel.
    pub(crate) fn sample_place(&self, index: u32) -> [f32; 2] {
        let place = Self::sample_offset(index, self.samples);
        if self.filter == Filter::Box {
            return place;
        }
        place.map(|share| (0.5 + self.filter.offset(f64::from(share))) as f32)
    }

    /// Points that are spread evenly in a pixel: number `index` of those of which `samples` come first, from its upper left
    /// corner.
    ///
    /// The additive recurrence with the plastic number's powers spreads any number of points evenly that follow each other
    /// (M. Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018). They are taken from its middle on to
    /// both sides in turn, so that those that come first, and those with an even number of others, have their mean in the
    /// middle of the pixel: otherwise the picture would be shifted. A single one is the middle.
    #[must_use]
    pub fn sample_offset(index: u32, samples: u32) -> [f32; 2] {
        const PLASTIC: f64 = 1.324_717_957_244_746;
        let step = [1.0 / PLASTIC, 1.0 / (PLASTIC * PLASTIC)];
        // 0, 1, −1, 2, −2 … or, of an even number, ½, −½, 1½, −1½ …
        let is_odd = samples % 2 == 1;
        let number = f64::from((index + u32::from(is_odd)) / 2) + if is_odd { 0.0 } else { 0.5 };
        let number = if index % 2 == u32::from(is_odd) { number } else { -number };
        step.map(|step| (0.5 + number * step).rem_euclid(1.0) as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn filters_spread_rays_as_they_count() {
        for filter in [Filter::Box, Filter::Tent, Filter::Gaussian] {
            let count = 4000;
            let places: Vec<f64> =
                (0..count).map(|k| filter.offset((f64::from(k) + 0.5) / f64::from(count))).collect();
            let spread = (places.iter().map(|x| x * x).sum::<f64>() / f64::from(count)).sqrt();
            let expected = match filter {
                Filter::Box => 1.0 / 12f64.sqrt(),
                Filter::Tent => 1.0 / 6f64.sqrt(),
                // Cutting off three standard deviations away takes a little.
                Filter::Gaussian => 0.493,
            };
            assert!((spread - expected).abs() < 2e-3, "{filter:?}: {spread}");
            assert!(places.iter().all(|x| x.abs() <= filter.radius()));
            assert!(filter.offset(0.5).abs() < 1e-9);
        }
    }

    #[test]
    fn samples_begin_in_the_middle_and_spread_evenly() {
        assert_eq!(Quality::sample_offset(0, 1), [0.5, 0.5]);
        let count = 64;
        let mut quarters = [0; 4];
        for [x, y] in (0..count).map(|index| Quality::sample_offset(index, count)) {
            quarters[usize::from(x >= 0.5) + 2 * usize::from(y >= 0.5)] += 1;
        }
        assert!(quarters.iter().all(|&found| (14..=18).contains(&found)), "{quarters:?}");
    }

    #[test]
    fn samples_do_not_shift_the_picture() {
        for samples in 1..=65 {
            // Those that come first, and with some that follow.
            for count in [samples, samples + 8, samples + 64] {
                let all: Vec<_> = (0..count).map(|index| Quality::sample_offset(index, samples)).collect();
                for axis in 0..2 {
                    let mean = all.iter().map(|place| f64::from(place[axis])).sum::<f64>() / f64::from(count);
                    assert!((mean - 0.5).abs() < 1e-6, "{count} of {samples}: {mean}");
                    assert!(all.iter().all(|place| (0.0..1.0).contains(&place[axis])));
                }
                let differ = |a: &[f32; 2], b: &[f32; 2]| a != b;
                assert!((1..all.len()).all(|at| all[..at].iter().all(|other| differ(other, &all[at]))));
            }
        }
    }
}
