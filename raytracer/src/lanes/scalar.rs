//! One lane: the plain types.

use super::Lanes;
use std::ops::Range;

/// A single ray.
#[derive(Debug, Clone, Copy)]
pub struct Single;

impl Lanes for Single {
    const COUNT: usize = 1;
    super::single_precision!();
    type Float = f32;
    type Word = u32;
    type Mask = bool;

    #[inline(always)]
    fn float(value: f32) -> f32 {
        value
    }
    #[inline(always)]
    fn word(value: u32) -> u32 {
        value
    }
    #[inline(always)]
    fn first(count: usize) -> bool {
        count > 0
    }
    #[inline(always)]
    fn load(values: &[f32]) -> f32 {
        values[0]
    }
    #[inline(always)]
    fn load_words(values: &[u32]) -> u32 {
        values[0]
    }
    #[inline(always)]
    fn store(value: f32, out: &mut [f32]) {
        out[0] = value;
    }
    #[inline(always)]
    fn store_words(value: u32, out: &mut [u32]) {
        out[0] = value;
    }
    #[inline(always)]
    fn to_bits(value: f32) -> u32 {
        value.to_bits()
    }
    #[inline(always)]
    fn from_bits(value: u32) -> f32 {
        f32::from_bits(value)
    }
    // Written as the vector instructions decide it, so that zeros of either sign come out the same.
    #[inline(always)]
    fn min(a: f32, b: f32) -> f32 {
        if a < b { a } else { b }
    }
    #[inline(always)]
    fn max(a: f32, b: f32) -> f32 {
        if a > b { a } else { b }
    }
    #[inline(always)]
    fn at_most(a: f32, b: f32) -> bool {
        a <= b
    }
    #[inline(always)]
    fn less(a: f32, b: f32) -> bool {
        a < b
    }
    #[inline(always)]
    fn same(a: f32, b: f32) -> bool {
        a == b
    }
    #[inline(always)]
    fn same_word(a: u32, b: u32) -> bool {
        a == b
    }
    #[inline(always)]
    fn greater(a: u32, b: u32) -> bool {
        a > b
    }
    #[inline(always)]
    fn test(a: u32, b: u32) -> bool {
        a & b != 0
    }
    #[inline(always)]
    fn select(mask: bool, yes: f32, no: f32) -> f32 {
        if mask { yes } else { no }
    }
    #[inline(always)]
    fn select_word(mask: bool, yes: u32, no: u32) -> u32 {
        if mask { yes } else { no }
    }
    #[inline(always)]
    fn add(a: u32, b: u32) -> u32 {
        a.wrapping_add(b)
    }
    #[inline(always)]
    fn sub(a: u32, b: u32) -> u32 {
        a.wrapping_sub(b)
    }
    #[inline(always)]
    fn shift_left(value: u32, count: u32) -> u32 {
        value.wrapping_shl(count)
    }
    #[inline(always)]
    fn shift_right(value: u32, count: u32) -> u32 {
        value.wrapping_shr(count)
    }
    #[inline(always)]
    fn bit(place: u32) -> u32 {
        1u32.rotate_left(place)
    }
    #[inline(always)]
    fn count_ones(value: u32) -> u32 {
        value.count_ones()
    }
    #[inline(always)]
    fn highest_bit(value: u32) -> u32 {
        31 - (value | 1).leading_zeros()
    }
    #[inline(always)]
    fn highest_bit_of_all(value: u32) -> u32 {
        Self::highest_bit(value)
    }
    #[inline(always)]
    fn spread<const AXIS: u32>(value: u32) -> u32 {
        (value & 1 | (value & 2) << 2) << AXIS
    }
    #[inline(always)]
    unsafe fn gather_rows(rows: &[[u32; 4]], index: u32, mask: bool, otherwise: [u32; 4]) -> [u32; 4] {
        if mask {
            debug_assert!((index as usize) < rows.len());
            // SAFETY: the mask is true, so the caller promises that the row is there.
            unsafe { *rows.get_unchecked(index as usize) }
        } else {
            otherwise
        }
    }
    #[inline(always)]
    fn for_each_level(levels: Range<u32>, level: u32, mask: bool, mut visit: impl FnMut(usize, bool)) {
        if mask && levels.contains(&level) {
            visit(level as usize, true);
        }
    }
    #[inline(always)]
    fn bitmask(mask: bool) -> u32 {
        u32::from(mask)
    }
}
