//! Eight lanes of double precision, on the vectors of `wide`. Words and truth values are those of [`Eight`].

use super::{Choice, Eight, Lanes, MAX_LANES};
use conversions::{narrowed, select, truth, widened};
use std::ops::Range;
use wide::{f32x8, f64x8, u32x8, u64x8};

/// A packet of 4×2 rays in double precision.
#[derive(Debug, Clone, Copy)]
pub struct Doubles;

/// Operations on words and truth values, which are those of eight lanes in single precision.
macro_rules! as_in_eight {
    ($(fn $name:ident($($argument:ident: $kind:ty),*) -> $result:ty;)*) => {$(
        #[inline(always)]
        fn $name($($argument: $kind),*) -> $result {
            Eight::$name($($argument),*)
        }
    )*};
}

impl Lanes for Doubles {
    const COUNT: usize = 8;
    type Real = f64;
    type Rough = Eight;
    type Float = f64x8;
    type Word = u32x8;
    type Mask = u32x8;

    #[inline(always)]
    fn float(value: f32) -> f64x8 {
        f64x8::splat(value.into())
    }
    #[inline(always)]
    fn real(value: f64) -> f64x8 {
        f64x8::splat(value)
    }
    #[inline(always)]
    fn load(values: &[f32]) -> f64x8 {
        widened(f32x8::from(&values[..8]))
    }
    #[inline(always)]
    fn load_reals(values: &[f64]) -> f64x8 {
        f64x8::from(&values[..8])
    }
    #[inline(always)]
    fn store(value: f64x8, out: &mut [f32]) {
        out[..8].copy_from_slice(narrowed(value).as_array());
    }
    #[inline(always)]
    fn reals(value: f64x8) -> [f64; MAX_LANES] {
        let mut reals = [0.0; MAX_LANES];
        reals[..8].copy_from_slice(value.as_array());
        reals
    }
    #[inline(always)]
    fn to_bits(value: f64x8) -> u32x8 {
        // Without the bits that single precision does not have, the conversion rounds nothing.
        const KEPT: u64 = !((1 << (f64::MANTISSA_DIGITS - f32::MANTISSA_DIGITS)) - 1);
        let kept = f64x8::from_bits(value.to_bits() & u64x8::splat(KEPT));
        narrowed(kept).to_bits()
    }
    #[inline(always)]
    fn from_bits(value: u32x8) -> f64x8 {
        widened(f32x8::from_bits(value))
    }
    #[inline(always)]
    fn next_up(value: f64x8) -> f64x8 {
        f64x8::from_bits(value.to_bits() + u64x8::splat(1))
    }
    #[inline(always)]
    fn min(a: f64x8, b: f64x8) -> f64x8 {
        a.fast_min(b)
    }
    #[inline(always)]
    fn max(a: f64x8, b: f64x8) -> f64x8 {
        a.fast_max(b)
    }
    #[inline(always)]
    fn abs(value: f64x8) -> f64x8 {
        value.abs()
    }
    #[inline(always)]
    fn divisor(slope: f64x8) -> f64x8 {
        f64x8::splat(0.0) - slope
    }
    #[inline(always)]
    fn quotient(offset: f64x8, divisor: f64x8) -> f64x8 {
        offset / divisor
    }
    #[inline(always)]
    fn at_most(a: f64x8, b: f64x8) -> u32x8 {
        truth(a.simd_le(b))
    }
    #[inline(always)]
    fn less(a: f64x8, b: f64x8) -> u32x8 {
        truth(a.simd_lt(b))
    }
    #[inline(always)]
    fn same(a: f64x8, b: f64x8) -> u32x8 {
        truth(a.simd_eq(b))
    }
    #[inline(always)]
    fn select(mask: u32x8, yes: f64x8, no: f64x8) -> f64x8 {
        select(mask, yes, no)
    }

    as_in_eight! {
        fn word(value: u32) -> u32x8;
        fn first(count: usize) -> u32x8;
        fn load_words(values: &[u32]) -> u32x8;
        fn same_word(a: u32x8, b: u32x8) -> u32x8;
        fn greater(a: u32x8, b: u32x8) -> u32x8;
        fn test(a: u32x8, b: u32x8) -> u32x8;
        fn select_word(mask: u32x8, yes: u32x8, no: u32x8) -> u32x8;
        fn add(a: u32x8, b: u32x8) -> u32x8;
        fn sub(a: u32x8, b: u32x8) -> u32x8;
        fn shift_left(value: u32x8, count: u32x8) -> u32x8;
        fn shift_right(value: u32x8, count: u32x8) -> u32x8;
        fn bit(place: u32x8) -> u32x8;
        fn count_ones(value: u32x8) -> u32x8;
        fn highest_bit(value: u32x8) -> u32x8;
        fn highest_bit_of_all(value: u32x8) -> u32x8;
        fn permuted_word(value: u32x8, from: u32x8) -> u32x8;
        fn bitmask(mask: u32x8) -> u32;
    }

    #[inline(always)]
    fn store_words(value: u32x8, out: &mut [u32]) {
        Eight::store_words(value, out);
    }
    #[inline(always)]
    fn spread<const AXIS: u32>(value: u32x8) -> u32x8 {
        Eight::spread::<AXIS>(value)
    }
    #[inline(always)]
    fn choose(words: &Choice, masks: [u32x8; 3]) -> u32x8 {
        Eight::choose(words, masks)
    }
    #[inline(always)]
    unsafe fn gather_rows(rows: &[[u32; 4]], index: u32x8, mask: u32x8, otherwise: [u32x8; 4]) -> [u32x8; 4] {
        // SAFETY: the promise is handed on as it came.
        unsafe { Eight::gather_rows(rows, index, mask, otherwise) }
    }
    #[inline(always)]
    fn for_each_level(levels: Range<u32>, level: u32x8, mask: u32x8, visit: impl FnMut(usize, u32x8)) {
        Eight::for_each_level(levels, level, mask, visit);
    }
}

/// Between the two precisions, and between truth values of 64 bits and of 32.
#[cfg(octvox_avx512)]
mod conversions {
    use std::arch::x86_64::{
        __m256, __m256i, __m512d, _mm256_maskz_set1_epi32, _mm256_movepi32_mask, _mm512_castpd_si512,
        _mm512_cvtpd_ps, _mm512_cvtps_pd, _mm512_mask_blend_pd, _mm512_movepi64_mask,
    };
    use wide::{f32x8, f64x8, u32x8};

    /// Calls an instruction of AVX-512 on vectors of `wide`.
    macro_rules! instruction {
        ($($call:tt)*) => {
            // SAFETY: this module is compiled only where every instruction set it uses is enabled, and the
            // instructions called through this macro touch registers only.
            unsafe { $($call)* }
        };
    }

    #[inline(always)]
    fn doubles(value: f64x8) -> __m512d {
        value.into()
    }

    /// The same numbers in double precision.
    #[inline(always)]
    pub fn widened(value: f32x8) -> f64x8 {
        let value: __m256 = value.into();
        instruction!(_mm512_cvtps_pd(value)).into()
    }

    /// The nearest numbers in single precision.
    #[inline(always)]
    pub fn narrowed(value: f64x8) -> f32x8 {
        instruction!(_mm512_cvtpd_ps(doubles(value))).into()
    }

    /// A word for each comparison: all ones or zero.
    #[inline(always)]
    pub fn truth(compared: f64x8) -> u32x8 {
        let compared = instruction!(_mm512_movepi64_mask(_mm512_castpd_si512(doubles(compared))));
        instruction!(_mm256_maskz_set1_epi32(compared, -1)).into()
    }

    /// Where the mask is true `yes`, elsewhere `no`.
    #[inline(always)]
    pub fn select(mask: u32x8, yes: f64x8, no: f64x8) -> f64x8 {
        let mask: __m256i = mask.into();
        instruction!(_mm512_mask_blend_pd(_mm256_movepi32_mask(mask), doubles(no), doubles(yes))).into()
    }
}

/// Between the two precisions, and between truth values of 64 bits and of 32, lane by lane.
#[cfg(not(octvox_avx512))]
mod conversions {
    use wide::{f32x8, f64x8, u32x8, u64x8};

    /// The same numbers in double precision.
    #[inline(always)]
    pub fn widened(value: f32x8) -> f64x8 {
        f64x8::new(value.to_array().map(f64::from))
    }

    /// The nearest numbers in single precision.
    #[inline(always)]
    pub fn narrowed(value: f64x8) -> f32x8 {
        f32x8::new(value.to_array().map(|value| value as f32))
    }

    /// A word for each comparison: all ones or zero.
    #[inline(always)]
    pub fn truth(compared: f64x8) -> u32x8 {
        u32x8::new(compared.to_bits().to_array().map(|bits| bits as u32))
    }

    /// Where the mask is true `yes`, elsewhere `no`.
    #[inline(always)]
    pub fn select(mask: u32x8, yes: f64x8, no: f64x8) -> f64x8 {
        // The sign bit in front makes all ones of all ones.
        let mask = u64x8::new(mask.to_array().map(|word| i64::from(word.cast_signed()).cast_unsigned()));
        f64x8::from_bits(mask).select(yes, no)
    }
}
