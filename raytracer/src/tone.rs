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

impl ToneMapping {
    /// All there are.
    pub const ALL: [Self; 1] = [Self::Clip];

    /// Its name in scene files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Clip => "clip",
        }
    }

    /// The one with a name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|mapping| mapping.name() == name)
    }
}
