//! From amounts of light to what a display can show.

use crate::color::Light3;

/// How bright light is displayed, and what becomes of light that is brighter than white.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tone {
    /// All light is multiplied by this first, above zero.
    pub exposure: f32,
    /// What becomes of light that is brighter than white.
    pub mapping: ToneMapping,
}

/// What becomes of light that is brighter than white.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ToneMapping {
    /// It is white: no light is changed, the display clips.
    Clip,
    /// Luminance is compressed so that four times white just becomes white; hue and saturation stay, unless a component
    /// passes white (E. Reinhard et al., "Photographic tone reproduction for digital images", 2002, equation 4).
    Reinhard,
    /// Each component goes through the curve of film, with a toe and a shoulder: a fit of the reference rendering of the
    /// Academy Color Encoding System (K. Narkowicz, "ACES filmic tone mapping curve", 2015). White becomes 0.8.
    Filmic,
}

impl Default for Tone {
    fn default() -> Self {
        Self { exposure: 1.0, mapping: ToneMapping::Clip }
    }
}

impl ToneMapping {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Clip, Self::Reinhard, Self::Filmic];

    /// Its name on the command line and in scene files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Clip => "clip",
            Self::Reinhard => "reinhard",
            Self::Filmic => "filmic",
        }
    }

    /// The one of this name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|mapping| mapping.name() == name)
    }
}

impl Tone {
    /// The light to display, of which 1 is white. [`ToneMapping::Clip`] leaves what is beyond it to the display, the
    /// others end there.
    ///
    /// Only operations that IEEE 754 rounds correctly, so the result is the same on every instruction set.
    #[must_use]
    #[inline]
    pub fn apply(&self, light: Light3) -> Light3 {
        let light = light * self.exposure;
        match self.mapping {
            ToneMapping::Clip => light,
            ToneMapping::Reinhard => reinhard(light),
            ToneMapping::Filmic => Light3::from_array(light.to_array().map(filmic)),
        }
    }
}

/// Luminance of red, green and blue light of the primaries of sRGB (ITU-R BT.709).
const LUMINANCE: [f32; 3] = [0.2126, 0.7152, 0.0722];

/// The luminance that becomes white.
const WHITE: f32 = 4.0;

fn reinhard(light: Light3) -> Light3 {
    let [red, green, blue] = light.to_array().map(|part| between(part, 0.0, f32::MAX));
    let luminance = LUMINANCE[0] * red + LUMINANCE[1] * green + LUMINANCE[2] * blue;
    let luminance = between(luminance, 0.0, f32::MAX);
    // The curve over the luminance itself, which leaves no division by that of black.
    let share = (1.0 + luminance / (WHITE * WHITE)) / (1.0 + luminance);
    Light3::from_array([red, green, blue].map(|part| between(part * share, 0.0, 1.0)))
}

fn filmic(light: f32) -> f32 {
    // The curve reaches white at 7.24; further on its terms would leave the range of numbers.
    let light = between(light, 0.0, 8.0);
    let displayed = (light * (2.51 * light + 0.03)) / (light * (2.43 * light + 0.59) + 0.14);
    between(displayed, 0.0, 1.0)
}

/// A value held within bounds; what is no number is the lower one. Unlike [`f32::max`], the sign of zero is certain.
fn between(value: f32, low: f32, high: f32) -> f32 {
    if value > low { if value < high { value } else { high } } else { low }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn displayed(mapping: ToneMapping, exposure: f32, light: f32) -> f32 {
        let light = Tone { exposure, mapping }.apply(Light3::splat(light));
        assert!(light.x == light.y && light.y == light.z, "{mapping:?} colours a gray: {light}");
        light.x
    }

    #[test]
    fn clip_returns_its_input() {
        let tone = Tone::default();
        let odd = [0.0, -0.0, 1e-45, 0.1, 1.0, 1.000_000_1, 77.7, f32::MAX, f32::INFINITY, -3.0];
        for light in odd {
            assert_eq!(tone.apply(Light3::splat(light)).x.to_bits(), light.to_bits());
        }
        assert_eq!(displayed(ToneMapping::Clip, 4.0, 0.5), 2.0);
    }

    #[test]
    fn brighter_light_is_displayed_no_darker() {
        for mapping in ToneMapping::ALL {
            for exposure in [0.25, 1.0, 3.0] {
                let values: Vec<f32> =
                    (0..4000).map(|step| displayed(mapping, exposure, step as f32 / 100.0)).collect();
                assert!(values.is_sorted(), "{mapping:?}");
                assert!(values[1] < values[50] && values[50] < values[100], "{mapping:?}");
            }
        }
    }

    #[test]
    fn black_stays_black_and_nothing_is_beyond_white() {
        for mapping in [ToneMapping::Reinhard, ToneMapping::Filmic] {
            for dark in [0.0, -0.0, -1.0, f32::NEG_INFINITY, f32::NAN] {
                assert_eq!(displayed(mapping, 1.0, dark).to_bits(), 0, "{mapping:?} of {dark}");
            }
            for bright in [100.0, 1e20, f32::MAX, f32::INFINITY] {
                assert_eq!(displayed(mapping, 1.0, bright), 1.0, "{mapping:?} of {bright}");
            }
            let red = Tone { exposure: 1.0, mapping }.apply(Light3::new(f32::MAX, 0.5, 0.0));
            assert!(red.x == 1.0 && (0.0..=1.0).contains(&red.y) && red.z == 0.0, "{mapping:?}: {red}");
        }
        assert_eq!(displayed(ToneMapping::Clip, 1.0, 0.0), 0.0);
    }

    #[test]
    fn the_curves_pass_through_known_points() {
        let near = |found: f32, expected: f32| assert!((found - expected).abs() < 1e-6, "{found}");
        near(displayed(ToneMapping::Reinhard, 1.0, 4.0), 1.0);
        near(displayed(ToneMapping::Reinhard, 1.0, 1.0), 17.0 / 32.0);
        near(displayed(ToneMapping::Reinhard, 2.0, 0.5), 17.0 / 32.0);
        near(displayed(ToneMapping::Filmic, 1.0, 1.0), 2.54 / 3.16);
    }

    #[test]
    fn names_come_back() {
        for mapping in ToneMapping::ALL {
            assert_eq!(ToneMapping::from_name(mapping.name()), Some(mapping));
        }
        assert_eq!(ToneMapping::from_name("aces"), None);
    }
}
