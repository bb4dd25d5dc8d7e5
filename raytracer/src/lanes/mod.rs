//! The vectors that the traversal is written over.
//!
//! A *lane* is one ray's place in a packet. [`Lanes`] names the few operations that the traversal and the camera
//! need, for 1, 4, 8 and 16 lanes in single precision and for 8 in double. Arithmetic comes from the `wide` crate. What it lacks (reading
//! rows of a table, population count, predicate masks) stands in one short file per instruction set, with a portable form beside it
//! that the tests hold against it.
//!
//! Every operation of a precision gives the same bits for every width and instruction set: each is a single correctly rounded
//! IEEE operation or an integer one, and none is a fused multiply-add or an approximate reciprocal.

#[cfg(all(target_arch = "x86_64", target_feature = "avx2"))]
mod avx2;
#[cfg(octvox_avx512)]
mod avx512;
mod doubles;
mod pair;
#[cfg(not(all(target_arch = "x86_64", target_feature = "avx2")))]
mod portable;
mod real;
mod scalar;
#[cfg(test)]
mod tests;
mod vectors;

pub use doubles::Doubles;
pub use pair::Pair;
pub use real::Real;
pub use scalar::Single;
pub use vectors::{Eight, Four};

#[cfg(octvox_avx512)]
pub use avx512::Sixteen;
#[cfg(not(octvox_avx512))]
pub use vectors::Sixteen;

use std::fmt::Debug;
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Not, Range, Sub};

/// The most lanes that any implementation has.
pub const MAX_LANES: usize = 32;

/// For each axis. What the standard library has for arrays is not always inlined, and vectors are slow to pass in memory.
#[inline(always)]
pub fn each<T>(mut of: impl FnMut(usize) -> T) -> [T; 3] {
    [of(0), of(1), of(2)]
}

/// For each word of a row; as [`each`].
#[inline(always)]
fn each_word<T>(mut of: impl FnMut(usize) -> T) -> [T; 4] {
    [of(0), of(1), of(2), of(3)]
}

/// Asks the processor to bring an element of a list near, if it can be asked. Any index will do.
#[inline(always)]
pub fn prefetch<T>(list: &[T], index: u32) {
    let place = list.as_ptr().wrapping_add(index as usize);
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        // SAFETY: this is a hint. Nothing is read, and there is no place where it could fault.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(place.cast()) }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = place;
}

/// The bit of each lane.
const LANE_BITS: [u32; MAX_LANES] = {
    let mut bits = [0; MAX_LANES];
    let mut lane = 0;
    while lane < MAX_LANES {
        bits[lane] = 1 << lane;
        lane += 1;
    }
    bits
};

/// Cells of a node in Morton order, low half first: per axis those whose lower and those whose upper digit is 0.
const DIGIT_ZERO: [[u64; 2]; 3] = {
    let mut cells = [[0; 2]; 3];
    let mut cell = 0;
    while cell < 64 {
        let mut axis = 0;
        while axis < 3 {
            let digits = [cell >> axis & 1, cell >> (axis + 3) & 1];
            cells[axis][0] |= (1 - digits[0]) << cell;
            cells[axis][1] |= (1 - digits[1]) << cell;
            axis += 1;
        }
        cell += 1;
    }
    cells
};

/// Four words of which [`Lanes::choose`] takes one, in the order in which the instruction that looks them up counts.
#[derive(Debug, Clone, Copy)]
#[repr(align(16))]
pub struct Choice([u32; 4]);

impl Choice {
    /// By number.
    pub const fn new([none, one, two, three]: [u32; 4]) -> Self {
        Self([none, three, two, one])
    }
}

/// A packet's worth of vectors: `COUNT` floats, as many 32-bit words, and one truth value for each lane.
pub trait Lanes: Copy + Send + Sync + 'static {
    /// Number of lanes.
    const COUNT: usize;

    /// The number of one lane.
    type Real: Real;
    /// As many lanes in single precision, for what is only roughly asked of whole nodes: whether they reach into a beam,
    /// how large they look. The same as these, if these are of single precision.
    type Rough: Lanes<Word = Self::Word, Mask = Self::Mask>;
    /// One number per lane.
    type Float: Copy
        + Debug
        + Add<Output = Self::Float>
        + Sub<Output = Self::Float>
        + Mul<Output = Self::Float>
        + Div<Output = Self::Float>;
    /// One `u32` per lane.
    type Word: Copy
        + Debug
        + BitAnd<Output = Self::Word>
        + BitOr<Output = Self::Word>
        + BitXor<Output = Self::Word>;
    /// One truth value per lane.
    type Mask: Copy
        + Debug
        + BitAnd<Output = Self::Mask>
        + BitOr<Output = Self::Mask>
        + Not<Output = Self::Mask>;

    /// The same float in every lane.
    fn float(value: f32) -> Self::Float;
    /// The same number in every lane.
    fn real(value: Self::Real) -> Self::Float;
    /// The same word in every lane.
    fn word(value: u32) -> Self::Word;
    /// The first `count` lanes true.
    fn first(count: usize) -> Self::Mask;
    /// Lane `i` is `values[i]`.
    ///
    /// # Panics
    /// If there are fewer than `COUNT` values.
    fn load(values: &[f32]) -> Self::Float;
    /// Lane `i` is `values[i]`.
    ///
    /// # Panics
    /// If there are fewer than `COUNT` values.
    fn load_reals(values: &[Self::Real]) -> Self::Float;
    /// Lane `i` is `values[i]`.
    ///
    /// # Panics
    /// If there are fewer than `COUNT` values.
    fn load_words(values: &[u32]) -> Self::Word;
    /// Writes lane `i` to `out[i]`, rounded to single precision.
    ///
    /// # Panics
    /// If `out` has fewer than `COUNT` places.
    fn store(value: Self::Float, out: &mut [f32]);
    /// Writes lane `i` to `out[i]`.
    ///
    /// # Panics
    /// If `out` has fewer than `COUNT` places.
    fn store_words(value: Self::Word, out: &mut [u32]);
    /// The lanes, in an array that has room for any number of them, rounded to single precision.
    fn floats(value: Self::Float) -> [f32; MAX_LANES] {
        let mut floats = [0.0; MAX_LANES];
        Self::store(value, &mut floats);
        floats
    }
    /// The lanes, in an array that has room for any number of them.
    fn reals(value: Self::Float) -> [Self::Real; MAX_LANES];
    /// The lanes, in an array that has room for any number of them.
    fn words(value: Self::Word) -> [u32; MAX_LANES] {
        let mut words = [0; MAX_LANES];
        Self::store_words(value, &mut words);
        words
    }

    /// The bits of each number in single precision, rounded towards zero.
    fn to_bits(value: Self::Float) -> Self::Word;
    /// The numbers that have these bits in single precision.
    fn from_bits(value: Self::Word) -> Self::Float;
    /// The next number above a positive one or zero.
    fn next_up(value: Self::Float) -> Self::Float;

    /// The smaller of two floats; neither is NaN. Of two zeros, the second.
    fn min(a: Self::Float, b: Self::Float) -> Self::Float;
    /// The larger of two floats; neither is NaN. Of two zeros, the second.
    fn max(a: Self::Float, b: Self::Float) -> Self::Float;
    /// Without the sign bit.
    fn abs(value: Self::Float) -> Self::Float;

    /// What [`Lanes::quotient`] takes to divide by `-slope`: in single precision the reciprocal of that, in double itself.
    fn divisor(slope: Self::Float) -> Self::Float;
    /// `offset / -slope`: in single precision a product with the reciprocal, rounded twice, in double rounded once.
    fn quotient(offset: Self::Float, divisor: Self::Float) -> Self::Float;

    /// `a <= b`.
    fn at_most(a: Self::Float, b: Self::Float) -> Self::Mask;
    /// `a < b`.
    fn less(a: Self::Float, b: Self::Float) -> Self::Mask;
    /// `a == b`.
    fn same(a: Self::Float, b: Self::Float) -> Self::Mask;
    /// `a == b`.
    fn same_word(a: Self::Word, b: Self::Word) -> Self::Mask;
    /// `a > b`, for words below 2³¹.
    fn greater(a: Self::Word, b: Self::Word) -> Self::Mask;
    /// Whether `a & b` has a bit set.
    fn test(a: Self::Word, b: Self::Word) -> Self::Mask;

    /// Where the mask is true `yes`, elsewhere `no`.
    fn select(mask: Self::Mask, yes: Self::Float, no: Self::Float) -> Self::Float;
    /// Where the mask is true `yes`, elsewhere `no`.
    fn select_word(mask: Self::Mask, yes: Self::Word, no: Self::Word) -> Self::Word;

    /// Sum modulo 2³².
    fn add(a: Self::Word, b: Self::Word) -> Self::Word;
    /// Difference modulo 2³².
    fn sub(a: Self::Word, b: Self::Word) -> Self::Word;
    /// `value << count` for counts of at most 31.
    fn shift_left(value: Self::Word, count: Self::Word) -> Self::Word;
    /// `value >> count` for counts of at most 31.
    fn shift_right(value: Self::Word, count: Self::Word) -> Self::Word;
    /// The bit `1 << (place % 32)`.
    fn bit(place: Self::Word) -> Self::Word;
    /// How many bits are set.
    fn count_ones(value: Self::Word) -> Self::Word;
    /// The place of the highest set bit of a word in `1..1 << 24`.
    fn highest_bit(value: Self::Word) -> Self::Word;
    /// The place of the highest set bit of any word; of zero, any place below 32.
    fn highest_bit_of_all(value: Self::Word) -> Self::Word;
    /// Spreads bits 0 and 1 of each lane to bits `AXIS` and `AXIS + 3`; other bits are ignored.
    ///
    /// These are the two bits of one axis in the Morton order of 4×4×4 cells.
    fn spread<const AXIS: u32>(value: Self::Word) -> Self::Word;

    /// The cells of a node that a ray in one of them can still come to, if coordinates fall along it: those whose coordinates
    /// are all at most the ray's. Low and high half of a mask like the node's.
    ///
    /// Of each coordinate of `cell` the two low bits count. Axes of which `mirror` is all ones are counted from the other end
    /// in the node; else it is zero.
    #[inline(always)]
    fn cells_ahead(cell: [Self::Word; 3], mirror: [Self::Word; 3]) -> [Self::Word; 2] {
        let mut ahead = [Self::word(u32::MAX); 2];
        for axis in 0..3 {
            let [upper, lower] = [2, 1].map(|digit| Self::test(cell[axis], Self::word(digit)));
            for (half, ahead) in ahead.iter_mut().enumerate() {
                let zero =
                    |digit: usize| Self::word((DIGIT_ZERO[axis][digit] >> (32 * half)) as u32) ^ mirror[axis];
                let below = Self::select_word(lower, Self::word(u32::MAX), zero(0));
                *ahead = *ahead & Self::select_word(upper, below | zero(1), below & zero(1));
            }
        }
        ahead
    }

    /// The words of `rows[index]` where the mask is true, elsewhere `otherwise`.
    ///
    /// # Safety
    /// In each lane where the mask is true, `index` is less than `rows.len()`; and there is a row.
    unsafe fn gather_rows(
        rows: &[[u32; 4]],
        index: Self::Word,
        mask: Self::Mask,
        otherwise: [Self::Word; 4],
    ) -> [Self::Word; 4];

    /// The word whose number is how many of the masks are true; none is true after one that is false.
    #[inline(always)]
    fn choose(words: &Choice, masks: [Self::Mask; 3]) -> Self::Word {
        let Choice([none, three, two, one]) = *words;
        let chosen = Self::select_word(masks[0], Self::word(one), Self::word(none));
        let chosen = Self::select_word(masks[1], Self::word(two), chosen);
        Self::select_word(masks[2], Self::word(three), chosen)
    }

    /// Asks the processor to bring rows `rows[index]` near, if it can be asked. Any index will do.
    #[inline(always)]
    fn prefetch_rows(rows: &[[u32; 4]], index: Self::Word) {
        for index in Self::words(index).into_iter().take(Self::COUNT) {
            prefetch(rows, index);
        }
    }

    /// Lane `i` is lane `from[i]` of a value, counted modulo the number of lanes.
    #[inline(always)]
    fn permuted(value: Self::Float, from: Self::Word) -> Self::Float {
        let (reals, from) = (Self::reals(value), Self::words(from));
        Self::load_reals(&from.map(|lane| reals[lane as usize % Self::COUNT]))
    }
    /// As [`Lanes::permuted`].
    #[inline(always)]
    fn permuted_word(value: Self::Word, from: Self::Word) -> Self::Word {
        let (words, from) = (Self::words(value), Self::words(from));
        Self::load_words(&from.map(|lane| words[lane as usize % Self::COUNT]))
    }

    /// Calls `visit` with each of `levels` and the lanes of `mask` whose `level` it is; lanes of other levels are left
    /// out. A level that no lane is on may be left out too.
    #[inline(always)]
    fn for_each_level(
        levels: Range<u32>,
        level: Self::Word,
        mask: Self::Mask,
        mut visit: impl FnMut(usize, Self::Mask),
    ) {
        for number in levels {
            visit(number as usize, mask & Self::same_word(level, Self::word(number)));
        }
    }

    /// The least of the floats in the lanes whose bit is set, none of them NaN; infinity if there is none. Rounded to single
    /// precision.
    fn least(value: Self::Float, lanes: u32) -> f32 {
        let floats = Self::floats(value);
        let chosen = (0..Self::COUNT).filter(|lane| lanes >> lane & 1 == 1);
        chosen.fold(f32::INFINITY, |least, lane| if floats[lane] < least { floats[lane] } else { least })
    }

    /// Bit `i` is lane `i`.
    fn bitmask(mask: Self::Mask) -> u32;
    /// Lane `i` is bit `i`.
    fn from_bitmask(bits: u32) -> Self::Mask {
        Self::test(Self::word(bits), Self::load_words(&LANE_BITS))
    }
    /// Whether any lane is true.
    fn any(mask: Self::Mask) -> bool {
        Self::bitmask(mask) != 0
    }
}

/// What lanes in single precision have in common.
macro_rules! single_precision {
    () => {
        type Real = f32;
        type Rough = Self;

        #[inline(always)]
        fn real(value: f32) -> Self::Float {
            Self::float(value)
        }
        #[inline(always)]
        fn load_reals(values: &[f32]) -> Self::Float {
            Self::load(values)
        }
        #[inline(always)]
        fn reals(value: Self::Float) -> [f32; $crate::lanes::MAX_LANES] {
            Self::floats(value)
        }
        #[inline(always)]
        fn next_up(value: Self::Float) -> Self::Float {
            Self::from_bits(Self::add(Self::to_bits(value), Self::word(1)))
        }
        #[inline(always)]
        fn abs(value: Self::Float) -> Self::Float {
            Self::from_bits(Self::to_bits(value) & Self::word(0x7FFF_FFFF))
        }
        #[inline(always)]
        fn divisor(slope: Self::Float) -> Self::Float {
            Self::float(-1.0) / slope
        }
        #[inline(always)]
        fn quotient(offset: Self::Float, divisor: Self::Float) -> Self::Float {
            offset * divisor
        }
    };
}
use single_precision;
