//! Four, eight and sixteen lanes on the vectors of `wide`, with a word per lane as the truth value.

#[cfg(all(target_arch = "x86_64", target_feature = "avx2"))]
use super::Choice;
use super::Lanes;
#[cfg(not(all(target_arch = "x86_64", target_feature = "avx2")))]
use super::portable;
use wide::{f32x4, f32x8, i32x4, i32x8, u32x4, u32x8};
#[cfg(not(octvox_avx512))]
use wide::{f32x16, i32x16, u32x16};

/// Where the instruction set can transpose rows, that; else lane by lane.
#[cfg(all(target_arch = "x86_64", target_feature = "avx2"))]
use super::avx2::{
    choose_eight, choose_four, count_ones_eight, gather_rows_eight, gather_rows_four, permuted_eight,
};
#[cfg(not(all(target_arch = "x86_64", target_feature = "avx2")))]
use portable::{gather_rows as gather_rows_four, gather_rows as gather_rows_eight};

/// How many bits are set in each word, by adding neighbours of one, two and four bits.
macro_rules! count_ones {
    ($value:expr, $word:ty) => {{
        let value = $value;
        let pairs = value - (value.unbounded_shr_scalar(1) & <$word>::splat(0x5555_5555));
        let two = <$word>::splat(0x3333_3333);
        let nibbles = (pairs & two) + (pairs.unbounded_shr_scalar(2) & two);
        let bytes = (nibbles + nibbles.unbounded_shr_scalar(4)) & <$word>::splat(0x0F0F_0F0F);
        let halves = bytes + bytes.unbounded_shr_scalar(8);
        (halves + halves.unbounded_shr_scalar(16)) & <$word>::splat(0x3F)
    }};
}

macro_rules! lanes {
    ($(#[$doc:meta])* $name:ident, $count:literal, $float:ty, $word:ty, $int:ty, $gather_rows:expr, $choose:expr, $count_ones:expr $(, $permuted:expr)?) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy)]
        pub struct $name;

        impl Lanes for $name {
            const COUNT: usize = $count;
            super::single_precision!();
            type Float = $float;
            type Word = $word;
            type Mask = $word;

            #[inline(always)]
            fn float(value: f32) -> $float {
                <$float>::splat(value)
            }
            #[inline(always)]
            fn word(value: u32) -> $word {
                <$word>::splat(value)
            }
            #[inline(always)]
            fn first(count: usize) -> $word {
                let mut words = [0; $count];
                words.iter_mut().take(count).for_each(|word| *word = u32::MAX);
                <$word>::new(words)
            }
            #[inline(always)]
            fn load(values: &[f32]) -> $float {
                <$float>::from(&values[..$count])
            }
            #[inline(always)]
            fn load_words(values: &[u32]) -> $word {
                <$word>::from(&values[..$count])
            }
            #[inline(always)]
            fn store(value: $float, out: &mut [f32]) {
                out[..$count].copy_from_slice(value.as_array());
            }
            #[inline(always)]
            fn store_words(value: $word, out: &mut [u32]) {
                out[..$count].copy_from_slice(value.as_array());
            }
            #[inline(always)]
            fn to_bits(value: $float) -> $word {
                value.to_bits()
            }
            #[inline(always)]
            fn from_bits(value: $word) -> $float {
                <$float>::from_bits(value)
            }
            #[inline(always)]
            fn min(a: $float, b: $float) -> $float {
                a.fast_min(b)
            }
            #[inline(always)]
            fn max(a: $float, b: $float) -> $float {
                a.fast_max(b)
            }
            #[inline(always)]
            fn at_most(a: $float, b: $float) -> $word {
                a.simd_le(b).to_bits()
            }
            #[inline(always)]
            fn less(a: $float, b: $float) -> $word {
                a.simd_lt(b).to_bits()
            }
            #[inline(always)]
            fn same(a: $float, b: $float) -> $word {
                a.simd_eq(b).to_bits()
            }
            #[inline(always)]
            fn same_word(a: $word, b: $word) -> $word {
                a.simd_eq(b)
            }
            #[inline(always)]
            fn greater(a: $word, b: $word) -> $word {
                // Below 2³¹ the signed comparison, which every instruction set has, is the unsigned one.
                a.cast_signed().simd_gt(b.cast_signed()).cast_unsigned()
            }
            #[inline(always)]
            fn test(a: $word, b: $word) -> $word {
                !(a & b).simd_eq(<$word>::splat(0))
            }
            #[inline(always)]
            fn select(mask: $word, yes: $float, no: $float) -> $float {
                // Of floats that are stored where `no` is from, the compiler would make a masked store, which takes some
                // processors twenty times as long.
                <$float>::from_bits(mask.select(yes.to_bits(), no.to_bits()))
            }
            #[inline(always)]
            fn select_word(mask: $word, yes: $word, no: $word) -> $word {
                mask.select(yes, no)
            }
            #[inline(always)]
            fn add(a: $word, b: $word) -> $word {
                a + b
            }
            #[inline(always)]
            fn sub(a: $word, b: $word) -> $word {
                a - b
            }
            #[inline(always)]
            fn shift_left(value: $word, count: $word) -> $word {
                value.unbounded_shl(count)
            }
            #[inline(always)]
            fn shift_right(value: $word, count: $word) -> $word {
                value.unbounded_shr(count)
            }
            #[inline(always)]
            fn bit(place: $word) -> $word {
                <$word>::splat(1).unbounded_shl(place & <$word>::splat(31))
            }
            #[inline(always)]
            fn count_ones(value: $word) -> $word {
                $count_ones(value)
            }
            #[inline(always)]
            fn highest_bit(value: $word) -> $word {
                // Below 2²⁴ the conversion to float is exact, and its exponent is the answer.
                let exponent = <$float>::from_int(value.cast_signed()).to_bits().unbounded_shr_scalar(23);
                exponent - <$word>::splat(127)
            }
            #[inline(always)]
            fn highest_bit_of_all(value: $word) -> $word {
                // Without the bit below it the highest one is not rounded up. As a sign it stands for the largest exponent;
                // zero has the least one.
                let highest = value & !value.unbounded_shr_scalar(1);
                let exponent = <$float>::from_int(highest.cast_signed()).to_bits().unbounded_shr_scalar(23);
                exponent.max(<$word>::splat(127)).min(<$word>::splat(158)) - <$word>::splat(127)
            }
            #[inline(always)]
            fn spread<const AXIS: u32>(value: $word) -> $word {
                let lower = value.unbounded_shl_scalar(AXIS) & <$word>::splat(1 << AXIS);
                let upper = value.unbounded_shl_scalar(AXIS + 2) & <$word>::splat(8 << AXIS);
                lower | upper
            }
            #[cfg(all(target_arch = "x86_64", target_feature = "avx2"))]
            #[inline(always)]
            fn choose(words: &Choice, masks: [$word; 3]) -> $word {
                $choose(words, masks)
            }
            #[inline(always)]
            fn prefetch_rows(rows: &[[u32; 4]], index: $word) {
                for index in index.to_array() {
                    super::prefetch(rows, index);
                }
            }
            $(
                #[cfg(all(target_arch = "x86_64", target_feature = "avx2"))]
                #[inline(always)]
                fn permuted(value: $float, from: $word) -> $float {
                    <$float>::from_bits($permuted(value.to_bits(), from))
                }
                #[cfg(all(target_arch = "x86_64", target_feature = "avx2"))]
                #[inline(always)]
                fn permuted_word(value: $word, from: $word) -> $word {
                    $permuted(value, from)
                }
            )?
            #[inline(always)]
            unsafe fn gather_rows(
                rows: &[[u32; 4]],
                index: $word,
                mask: $word,
                otherwise: [$word; 4],
            ) -> [$word; 4] {
                // SAFETY: the caller promises that the index is that of a row wherever the mask is true, and there is a
                // first row.
                let columns = unsafe { $gather_rows(rows, (index & mask).to_array()) };
                super::each_word(|column| mask.select(columns[column].into(), otherwise[column]))
            }
            #[inline(always)]
            fn bitmask(mask: $word) -> u32 {
                mask.to_bitmask()
            }
        }
    };
}

/// The conversion that `wide` names after each type.
trait FromInt<Int> {
    fn from_int(value: Int) -> Self;
}

impl FromInt<i32x4> for f32x4 {
    #[inline(always)]
    fn from_int(value: i32x4) -> Self {
        Self::from_i32x4(value)
    }
}

impl FromInt<i32x8> for f32x8 {
    #[inline(always)]
    fn from_int(value: i32x8) -> Self {
        Self::from_i32x8(value)
    }
}

#[cfg(not(octvox_avx512))]
impl FromInt<i32x16> for f32x16 {
    #[inline(always)]
    fn from_int(value: i32x16) -> Self {
        Self::from_i32x16(value)
    }
}

lanes!(
    /// A packet of 2×2 rays.
    Four, 4, f32x4, u32x4, i32x4, gather_rows_four, choose_four,
    |value: u32x4| count_ones!(value, u32x4)
);
lanes!(
    /// A packet of 4×2 rays.
    Eight, 8, f32x8, u32x8, i32x8, gather_rows_eight, choose_eight, count_ones_eight, permuted_eight
);

/// Two choices of eight.
#[cfg(all(target_arch = "x86_64", target_feature = "avx2", not(octvox_avx512)))]
#[inline(always)]
fn choose_sixteen(words: &Choice, masks: [u32x16; 3]) -> u32x16 {
    let halves = masks.map(bytemuck::cast::<u32x16, [u32x8; 2]>);
    bytemuck::cast(
        [0, 1].map(|half| choose_eight(words, [halves[0][half], halves[1][half], halves[2][half]])),
    )
}

/// Two counts of eight.
#[cfg(not(octvox_avx512))]
#[inline(always)]
fn count_ones_sixteen(value: u32x16) -> u32x16 {
    bytemuck::cast(bytemuck::cast::<u32x16, [u32x8; 2]>(value).map(count_ones_eight))
}

#[cfg(not(all(target_arch = "x86_64", target_feature = "avx2")))]
#[inline(always)]
fn count_ones_eight(value: u32x8) -> u32x8 {
    count_ones!(value, u32x8)
}

/// Two gathers of eight.
///
/// # Safety
/// All indices are less than `rows.len()`.
#[inline(always)]
pub unsafe fn gather_rows_sixteen(rows: &[[u32; 4]], index: [u32; 16]) -> [[u32; 16]; 4] {
    // Through memory: taken out of a vector, they would wait for the unit that transposes.
    let index = std::hint::black_box(&index);
    let index: [[u32; 8]; 2] = bytemuck::cast(*index);
    // SAFETY: each half of the indices is that of rows because all of them are.
    let halves = unsafe { [gather_rows_eight(rows, index[0]), gather_rows_eight(rows, index[1])] };
    super::each_word(|column| bytemuck::cast([halves[0][column], halves[1][column]]))
}

#[cfg(not(octvox_avx512))]
lanes!(
    /// A packet of 4×4 rays.
    Sixteen, 16, f32x16, u32x16, i32x16, gather_rows_sixteen, choose_sixteen, count_ones_sixteen
);
