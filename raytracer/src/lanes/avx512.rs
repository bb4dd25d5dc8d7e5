//! Sixteen lanes on AVX-512: arithmetic from `wide`, predicates in mask registers, and the instructions that
//! `wide` does not name.

use super::vectors::gather_rows_sixteen;
use super::{Lanes, each, each_word};
use crate::octree::cell_of_morton;
use std::arch::x86_64::{
    __m512, __m512i, _CMP_EQ_OQ, _CMP_LE_OQ, _CMP_LT_OQ, _mm512_add_epi32, _mm512_cmp_ps_mask,
    _mm512_cmpeq_epi32_mask, _mm512_cmpgt_epu32_mask, _mm512_lzcnt_epi32, _mm512_mask_blend_epi32,
    _mm512_mask_blend_ps, _mm512_max_ps, _mm512_min_ps, _mm512_permutexvar_epi32, _mm512_popcnt_epi32,
    _mm512_reduce_min_ps, _mm512_rolv_epi32, _mm512_set1_epi32, _mm512_sllv_epi32, _mm512_srlv_epi32,
    _mm512_sub_epi32, _mm512_test_epi32_mask,
};
use std::ops::{BitAnd, BitOr, Not};
use wide::{f32x16, u32x16};

/// A packet of 4×4 rays.
#[derive(Debug, Clone, Copy)]
pub struct Sixteen;

/// A mask register: bit `i` is lane `i`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Mask16(u16);

impl BitAnd for Mask16 {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl BitOr for Mask16 {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl Not for Mask16 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}

/// Two bits, spread to places 0 and 3, repeated so that the four low bits of any word are an index.
const SPREAD: [u32; 16] = [0, 1, 8, 9, 0, 1, 8, 9, 0, 1, 8, 9, 0, 1, 8, 9];

const fn shifted(mut words: [u32; 16], places: u32) -> [u32; 16] {
    let mut lane = 0;
    while lane < 16 {
        words[lane] <<= places;
        lane += 1;
    }
    words
}

/// For each coordinate `0..4` along an axis, the cells of half a node that are at most there; for indices `12..16`, if the axis
/// is mirrored.
const fn at_most(axis: usize, half: usize) -> [u32; 16] {
    let mut cells = [0; 16];
    let mut cell = 0;
    while cell < 32 {
        let position = cell_of_morton(cell + 32 * half as u32)[axis];
        let mut place = 0;
        while place < 4 {
            if position <= place {
                cells[place as usize] |= 1 << cell;
            }
            if 3 - position <= place {
                cells[place as usize + 12] |= 1 << cell;
            }
            place += 1;
        }
        cell += 1;
    }
    cells
}

/// Calls an instruction of AVX-512 on vectors of `wide`.
macro_rules! instruction {
    ($($call:tt)*) => {
        // SAFETY: this file is compiled only where every instruction set it uses is enabled, and the
        // instructions called through this macro touch registers only.
        unsafe { $($call)* }
    };
}

#[inline(always)]
fn floats(value: f32x16) -> __m512 {
    value.into()
}

#[inline(always)]
fn words(value: u32x16) -> __m512i {
    value.into()
}

impl Lanes for Sixteen {
    const COUNT: usize = 16;
    super::single_precision!();
    type Float = f32x16;
    type Word = u32x16;
    type Mask = Mask16;

    #[inline(always)]
    fn float(value: f32) -> f32x16 {
        f32x16::splat(value)
    }
    #[inline(always)]
    fn word(value: u32) -> u32x16 {
        u32x16::splat(value)
    }
    #[inline(always)]
    fn first(count: usize) -> Mask16 {
        Mask16(((1u32 << count.min(16)) - 1) as u16)
    }
    #[inline(always)]
    fn load(values: &[f32]) -> f32x16 {
        f32x16::from(&values[..16])
    }
    #[inline(always)]
    fn load_words(values: &[u32]) -> u32x16 {
        u32x16::from(&values[..16])
    }
    #[inline(always)]
    fn store(value: f32x16, out: &mut [f32]) {
        out[..16].copy_from_slice(value.as_array());
    }
    #[inline(always)]
    fn store_words(value: u32x16, out: &mut [u32]) {
        out[..16].copy_from_slice(value.as_array());
    }
    #[inline(always)]
    fn to_bits(value: f32x16) -> u32x16 {
        value.to_bits()
    }
    #[inline(always)]
    fn from_bits(value: u32x16) -> f32x16 {
        f32x16::from_bits(value)
    }
    #[inline(always)]
    fn min(a: f32x16, b: f32x16) -> f32x16 {
        instruction!(_mm512_min_ps(floats(a), floats(b))).into()
    }
    #[inline(always)]
    fn max(a: f32x16, b: f32x16) -> f32x16 {
        instruction!(_mm512_max_ps(floats(a), floats(b))).into()
    }
    #[inline(always)]
    fn at_most(a: f32x16, b: f32x16) -> Mask16 {
        Mask16(instruction!(_mm512_cmp_ps_mask::<_CMP_LE_OQ>(floats(a), floats(b))))
    }
    #[inline(always)]
    fn less(a: f32x16, b: f32x16) -> Mask16 {
        Mask16(instruction!(_mm512_cmp_ps_mask::<_CMP_LT_OQ>(floats(a), floats(b))))
    }
    #[inline(always)]
    fn same(a: f32x16, b: f32x16) -> Mask16 {
        Mask16(instruction!(_mm512_cmp_ps_mask::<_CMP_EQ_OQ>(floats(a), floats(b))))
    }
    #[inline(always)]
    fn same_word(a: u32x16, b: u32x16) -> Mask16 {
        Mask16(instruction!(_mm512_cmpeq_epi32_mask(words(a), words(b))))
    }
    #[inline(always)]
    fn greater(a: u32x16, b: u32x16) -> Mask16 {
        Mask16(instruction!(_mm512_cmpgt_epu32_mask(words(a), words(b))))
    }
    #[inline(always)]
    fn test(a: u32x16, b: u32x16) -> Mask16 {
        Mask16(instruction!(_mm512_test_epi32_mask(words(a), words(b))))
    }
    #[inline(always)]
    fn select(mask: Mask16, yes: f32x16, no: f32x16) -> f32x16 {
        instruction!(_mm512_mask_blend_ps(mask.0, floats(no), floats(yes))).into()
    }
    #[inline(always)]
    fn select_word(mask: Mask16, yes: u32x16, no: u32x16) -> u32x16 {
        instruction!(_mm512_mask_blend_epi32(mask.0, words(no), words(yes))).into()
    }
    #[inline(always)]
    fn add(a: u32x16, b: u32x16) -> u32x16 {
        instruction!(_mm512_add_epi32(words(a), words(b))).into()
    }
    #[inline(always)]
    fn sub(a: u32x16, b: u32x16) -> u32x16 {
        instruction!(_mm512_sub_epi32(words(a), words(b))).into()
    }
    #[inline(always)]
    fn shift_left(value: u32x16, count: u32x16) -> u32x16 {
        instruction!(_mm512_sllv_epi32(words(value), words(count))).into()
    }
    #[inline(always)]
    fn shift_right(value: u32x16, count: u32x16) -> u32x16 {
        instruction!(_mm512_srlv_epi32(words(value), words(count))).into()
    }
    #[inline(always)]
    fn bit(place: u32x16) -> u32x16 {
        // A rotation takes its count modulo 32 by itself.
        instruction!(_mm512_rolv_epi32(_mm512_set1_epi32(1), words(place))).into()
    }
    #[inline(always)]
    fn count_ones(value: u32x16) -> u32x16 {
        instruction!(_mm512_popcnt_epi32(words(value))).into()
    }
    #[inline(always)]
    fn highest_bit(value: u32x16) -> u32x16 {
        instruction!(_mm512_sub_epi32(_mm512_set1_epi32(31), _mm512_lzcnt_epi32(words(value)))).into()
    }
    #[inline(always)]
    fn highest_bit_of_all(value: u32x16) -> u32x16 {
        Self::highest_bit(value | u32x16::splat(1))
    }
    #[inline(always)]
    fn spread<const AXIS: u32>(value: u32x16) -> u32x16 {
        // The permutation reads four bits of its index, so nothing has to be masked off.
        let table = const { u32x16::new(shifted(SPREAD, AXIS)) };
        instruction!(_mm512_permutexvar_epi32(words(value), words(table))).into()
    }
    #[inline(always)]
    fn cells_ahead(cell: [u32x16; 3], mirror: [u32x16; 3]) -> [u32x16; 2] {
        // The permutation reads four bits of its index: two of the coordinate, and two of the mirror.
        let low_bits = u32x16::splat(3);
        let place = each(|axis| (cell[axis] & low_bits) | (mirror[axis] & !low_bits));
        let look_up = |axis: usize, table: [u32; 16]| -> u32x16 {
            instruction!(_mm512_permutexvar_epi32(words(place[axis]), words(u32x16::new(table)))).into()
        };
        // The halves of a node differ along z alone.
        let plane = look_up(0, const { at_most(0, 0) }) & look_up(1, const { at_most(1, 0) });
        [plane & look_up(2, const { at_most(2, 0) }), plane & look_up(2, const { at_most(2, 1) })]
    }
    #[inline(always)]
    fn permuted(value: f32x16, from: u32x16) -> f32x16 {
        f32x16::from_bits(Self::permuted_word(value.to_bits(), from))
    }
    #[inline(always)]
    fn permuted_word(value: u32x16, from: u32x16) -> u32x16 {
        instruction!(_mm512_permutexvar_epi32(words(from), words(value))).into()
    }
    #[inline(always)]
    unsafe fn gather_rows(
        rows: &[[u32; 4]],
        index: u32x16,
        mask: Mask16,
        otherwise: [u32x16; 4],
    ) -> [u32x16; 4] {
        let index = Self::select_word(mask, index, u32x16::splat(0));
        // SAFETY: the caller promises that the index is that of a row wherever the mask is true, and there is a first row.
        let columns = unsafe { gather_rows_sixteen(rows, index.to_array()) };
        each_word(|column| Self::select_word(mask, columns[column].into(), otherwise[column]))
    }
    #[inline(always)]
    fn least(value: f32x16, lanes: u32) -> f32 {
        let infinity = floats(f32x16::splat(f32::INFINITY));
        instruction!(_mm512_reduce_min_ps(_mm512_mask_blend_ps(lanes as u16, infinity, floats(value))))
    }
    #[inline(always)]
    fn bitmask(mask: Mask16) -> u32 {
        u32::from(mask.0)
    }
    #[inline(always)]
    fn from_bitmask(bits: u32) -> Mask16 {
        Mask16(bits as u16)
    }
}
