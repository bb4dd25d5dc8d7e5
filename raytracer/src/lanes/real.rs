//! The numbers of single lanes.

use std::fmt::Debug;
use std::ops::Sub;

/// The number that each lane of a vector holds: `f32` or `f64`.
pub trait Real:
    Copy + Debug + Default + PartialOrd + From<f32> + Into<f64> + Sub<Output = Self> + Send + Sync + 'static
{
    /// More than any number.
    const INFINITY: Self;
    /// Origins that are no farther from the cube than this, per axis, are taken as they are: their coordinates lose at
    /// most 2⁻²³ in single precision, 2⁻⁴⁴ in double. Others are moved to the cube in double precision first.
    const NEAR: f64;

    /// The nearest number of this kind.
    fn rounded(value: f64) -> Self;
    /// How many numbers of this kind are from zero to a number that is not below it.
    fn rank(self) -> u64;
    /// The number of this rank.
    fn of_rank(rank: u64) -> Self;
}

impl Real for f32 {
    const INFINITY: Self = Self::INFINITY;
    const NEAR: f64 = 2.0;

    #[inline(always)]
    fn rounded(value: f64) -> Self {
        value as Self
    }
    #[inline(always)]
    fn rank(self) -> u64 {
        self.to_bits().into()
    }
    #[inline(always)]
    fn of_rank(rank: u64) -> Self {
        Self::from_bits(rank as u32)
    }
}

impl Real for f64 {
    const INFINITY: Self = Self::INFINITY;
    const NEAR: f64 = 511.0;

    #[inline(always)]
    fn rounded(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn rank(self) -> u64 {
        self.to_bits()
    }
    #[inline(always)]
    fn of_rank(rank: u64) -> Self {
        Self::from_bits(rank)
    }
}
