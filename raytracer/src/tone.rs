//! From amounts of light to what a display can show.

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
    /// It is white.
    Clip,
}

impl Default for Tone {
    fn default() -> Self {
        Self { exposure: 1.0, mapping: ToneMapping::Clip }
    }
}

impl Tone {
    /// Light as it is to be displayed.
    pub fn apply(&self, light: crate::Light3) -> crate::Light3 {
        light * self.exposure
    }
}
