//! How many rays go together, chosen at run time.

/// Number of lanes of a packet.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Width {
    /// Single rays.
    One,
    /// 2×2 pixels.
    Four,
    /// 4×2 pixels.
    Eight,
    /// 4×4 pixels.
    Sixteen,
    /// 8×4 pixels, as two packets of sixteen in step.
    ThirtyTwo,
}

impl Width {
    /// All widths, narrowest first.
    pub const ALL: [Self; 5] = [Self::One, Self::Four, Self::Eight, Self::Sixteen, Self::ThirtyTwo];

    /// The width that is fastest with the instruction set of this build: one vector of single precision.
    pub const FASTEST: Self = if cfg!(octvox_avx512) { Self::Sixteen } else { Self::Eight };

    /// The number of lanes.
    #[must_use]
    pub fn lanes(self) -> u32 {
        match self {
            Self::One => 1,
            Self::Four => 4,
            Self::Eight => 8,
            Self::Sixteen => 16,
            Self::ThirtyTwo => 32,
        }
    }

    /// The width of this many lanes, if there is one.
    #[must_use]
    pub fn from_lanes(lanes: u32) -> Option<Self> {
        Self::ALL.into_iter().find(|width| width.lanes() == lanes)
    }
}

/// Calls a function that is generic over [`crate::lanes::Lanes`] with the type of an [`Arithmetic`](crate::Arithmetic) and a
/// [`Width`]. Double precision has one width.
macro_rules! with_lanes {
    ($arithmetic:expr, $width:expr, $lanes:ident => $call:expr) => {
        match ($arithmetic, $width) {
            ($crate::Arithmetic::Double, _) => {
                type $lanes = $crate::lanes::Doubles;
                $call
            }
            (_, $crate::Width::One) => {
                type $lanes = $crate::lanes::Single;
                $call
            }
            (_, $crate::Width::Four) => {
                type $lanes = $crate::lanes::Four;
                $call
            }
            (_, $crate::Width::Eight) => {
                type $lanes = $crate::lanes::Eight;
                $call
            }
            (_, $crate::Width::Sixteen) => {
                type $lanes = $crate::lanes::Sixteen;
                $call
            }
            (_, $crate::Width::ThirtyTwo) => {
                type $lanes = $crate::lanes::Pair<$crate::lanes::Sixteen>;
                $call
            }
        }
    };
}
pub(crate) use with_lanes;
