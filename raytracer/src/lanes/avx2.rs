//! What AVX2 adds to `wide`: rows of words are gathered by whole rows and a transposition. The instruction that gathers words
//! would come back to each row for each of its words.

use std::arch::x86_64::{
    __m128i, __m256i, _mm_loadu_si128, _mm_unpackhi_epi32, _mm_unpackhi_epi64, _mm_unpacklo_epi32,
    _mm_unpacklo_epi64, _mm256_castsi128_si256, _mm256_inserti128_si256, _mm256_unpackhi_epi32,
    _mm256_unpackhi_epi64, _mm256_unpacklo_epi32, _mm256_unpacklo_epi64,
};

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
