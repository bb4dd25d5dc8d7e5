//! What AVX2 adds to `wide`. Rows of words are gathered by whole rows and a transposition: the instruction that gathers words
//! would come back to each row for each of its words. Small tables are looked up in registers.

use super::Choice;
use std::arch::x86_64::{
    __m128i, __m256i, _mm_castps_si128, _mm_castsi128_ps, _mm_loadu_si128, _mm_permutevar_ps,
    _mm_unpackhi_epi32, _mm_unpackhi_epi64, _mm_unpacklo_epi32, _mm_unpacklo_epi64, _mm256_add_epi8,
    _mm256_and_si256, _mm256_broadcastsi128_si256, _mm256_castps_si256, _mm256_castsi128_si256,
    _mm256_castsi256_ps, _mm256_inserti128_si256, _mm256_madd_epi16, _mm256_maddubs_epi16,
    _mm256_permutevar_ps, _mm256_permutevar8x32_epi32, _mm256_set1_epi8, _mm256_set1_epi16, _mm256_setr_epi8,
    _mm256_shuffle_epi8, _mm256_srli_epi32, _mm256_unpackhi_epi32, _mm256_unpackhi_epi64,
    _mm256_unpacklo_epi32, _mm256_unpacklo_epi64,
};
use wide::{u32x4, u32x8};

/// # Safety
/// `index` is less than `rows.len()`.
#[inline(always)]
unsafe fn row(rows: &[[u32; 4]], index: u32) -> __m128i {
    debug_assert!((index as usize) < rows.len());
    // SAFETY: the caller promises that the row is there; it may be anywhere in memory.
    unsafe { _mm_loadu_si128(rows.as_ptr().add(index as usize).cast()) }
}

/// The columns of blocks of four rows.
macro_rules! columns {
    ($rows:expr, $low:ident, $high:ident, $low_pair:ident, $high_pair:ident) => {{
        let rows = $rows;
        let early = [$low(rows[0], rows[1]), $low(rows[2], rows[3])];
        let late = [$high(rows[0], rows[1]), $high(rows[2], rows[3])];
        [
            $low_pair(early[0], early[1]),
            $high_pair(early[0], early[1]),
            $low_pair(late[0], late[1]),
            $high_pair(late[0], late[1]),
        ]
    }};
}

/// The word whose number is how many of the masks are true: the sum of the masks is that, below zero, and its two lowest bits
/// are looked up among four words.
#[inline(always)]
pub fn choose_eight(words: &Choice, masks: [u32x8; 3]) -> u32x8 {
    let [first, second, third] = masks;
    let below_zero: __m256i = (first + second + third).into();
    let table: __m128i = u32x4::new(words.0).into();
    // SAFETY: this file is compiled only with AVX2 enabled, and these touch registers only.
    let chosen = unsafe {
        let table = _mm256_castsi256_ps(_mm256_broadcastsi128_si256(table));
        _mm256_castps_si256(_mm256_permutevar_ps(table, below_zero))
    };
    chosen.into()
}

/// As [`choose_eight`].
#[inline(always)]
pub fn choose_four(words: &Choice, masks: [u32x4; 3]) -> u32x4 {
    let [first, second, third] = masks;
    let below_zero: __m128i = (first + second + third).into();
    let table: __m128i = u32x4::new(words.0).into();
    // SAFETY: this file is compiled only with AVX2 enabled, and these touch registers only.
    let chosen = unsafe { _mm_castps_si128(_mm_permutevar_ps(_mm_castsi128_ps(table), below_zero)) };
    chosen.into()
}

/// Lane `i` is lane `from[i] % 8` of the value.
#[inline(always)]
pub fn permuted_eight(value: u32x8, from: u32x8) -> u32x8 {
    // SAFETY: this file is compiled only with AVX2 enabled, and this touches registers only.
    unsafe { _mm256_permutevar8x32_epi32(value.into(), from.into()) }.into()
}

/// How many bits are set in each word: halves of bytes are looked up, and their sums added up.
#[inline(always)]
pub fn count_ones_eight(value: u32x8) -> u32x8 {
    // SAFETY: this file is compiled only with AVX2 enabled, and these touch registers only.
    let counts = unsafe {
        let table = _mm256_setr_epi8(
            0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4, 0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4,
        );
        let (low_halves, value) = (_mm256_set1_epi8(15), value.into());
        let low = _mm256_shuffle_epi8(table, _mm256_and_si256(value, low_halves));
        let high = _mm256_and_si256(_mm256_srli_epi32::<4>(value), low_halves);
        let bytes = _mm256_add_epi8(low, _mm256_shuffle_epi8(table, high));
        let pairs = _mm256_maddubs_epi16(bytes, _mm256_set1_epi8(1));
        _mm256_madd_epi16(pairs, _mm256_set1_epi16(1))
    };
    counts.into()
}

/// The words of `rows[index[i]]`.
///
/// # Safety
/// All indices are less than `rows.len()`.
#[inline(always)]
pub unsafe fn gather_rows_four(rows: &[[u32; 4]], index: [u32; 4]) -> [[u32; 4]; 4] {
    // SAFETY: this file is compiled only with AVX2 enabled; the caller promises that the rows are there.
    let columns: [__m128i; 4] = unsafe {
        let row = |lane: usize| row(rows, index[lane]);
        columns!(
            [row(0), row(1), row(2), row(3)],
            _mm_unpacklo_epi32,
            _mm_unpackhi_epi32,
            _mm_unpacklo_epi64,
            _mm_unpackhi_epi64
        )
    };
    bytemuck::cast(columns)
}

/// As [`gather_rows_four`].
///
/// # Safety
/// All indices are less than `rows.len()`.
#[inline(always)]
pub unsafe fn gather_rows_eight(rows: &[[u32; 4]], index: [u32; 8]) -> [[u32; 8]; 4] {
    // SAFETY: this file is compiled only with AVX2 enabled; the caller promises that the rows are there.
    let columns: [__m256i; 4] = unsafe {
        let two = |lane: usize| {
            let low = _mm256_castsi128_si256(row(rows, index[lane]));
            _mm256_inserti128_si256::<1>(low, row(rows, index[lane + 4]))
        };
        columns!(
            [two(0), two(1), two(2), two(3)],
            _mm256_unpacklo_epi32,
            _mm256_unpackhi_epi32,
            _mm256_unpacklo_epi64,
            _mm256_unpackhi_epi64
        )
    };
    bytemuck::cast(columns)
}
