//! What may be approximated, and how far.

/// Every approximation of a picture, each with an exact setting.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quality {
    /// A ray ends at a cell that looks no larger than this many pixels. Exact: 0, the finest cells.
    pub lod_pixels: f64,
    /// Rays through each pixel. Exact: the more, the closer to the area that a pixel covers.
    pub samples: u32,
}

impl Default for Quality {
    fn default() -> Self {
        Self::of_samples(1)
    }
}

impl Quality {
    /// So many rays through each pixel, which end at cells that look no larger than the distance from one to the next:
    /// what is finer, they cannot show.
    #[must_use]
    pub fn of_samples(samples: u32) -> Self {
        Self { lod_pixels: 1.0 / f64::from(samples.max(1)).sqrt(), samples }
    }

    /// Where sample number `index` is in its pixel, from the upper left corner.
    ///
    /// The additive recurrence with the plastic number's powers spreads any number of points evenly
    /// (M. Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018). The first is the middle.
    #[must_use]
    pub fn sample_offset(index: u32) -> [f32; 2] {
        const PLASTIC: f64 = 1.324_717_957_244_746;
        let step = [1.0 / PLASTIC, 1.0 / (PLASTIC * PLASTIC)];
        step.map(|step| (0.5 + f64::from(index) * step).fract() as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_begin_in_the_middle_and_spread_evenly() {
        assert_eq!(Quality::sample_offset(0), [0.5, 0.5]);
        let count = 64;
        let mut quarters = [0; 4];
        for [x, y] in (0..count).map(Quality::sample_offset) {
            quarters[usize::from(x >= 0.5) + 2 * usize::from(y >= 0.5)] += 1;
        }
        assert!(quarters.iter().all(|&found| (14..=18).contains(&found)), "{quarters:?}");
    }
}
