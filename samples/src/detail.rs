//! How finely curved surfaces are divided.

/// A multiplier for the number of segments along every curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Detail(pub u8);

impl Detail {
    /// The detail of the files in the repository.
    pub const COMMITTED: Self = Self(1);

    /// The number of segments for a curve that has `base` of them at detail 1.
    pub fn segments(self, base: usize) -> usize {
        base * usize::from(self.0)
    }
}
