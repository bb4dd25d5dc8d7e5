//! Two packets in step: while one waits for memory, the other calculates.

use super::{Choice, Lanes, each, each_word};
use std::marker::PhantomData;
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Not, Sub};

/// Twice the lanes of `L`: its first half, then its second.
#[derive(Debug, Clone, Copy)]
pub struct Pair<L>(PhantomData<L>);

/// A value of each half.
#[derive(Debug, Clone, Copy)]
pub struct Both<T>(T, T);

macro_rules! operators {
    ($($trait:ident $method:ident),*) => {$(
        impl<T: $trait<Output = T>> $trait for Both<T> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0.$method(other.0), self.1.$method(other.1))
            }
        }
    )*};
}

operators!(Add add, Sub sub, Mul mul, Div div, BitAnd bitand, BitOr bitor, BitXor bitxor);

impl<T: Not<Output = T>> Not for Both<T> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0, !self.1)
    }
}

/// Operations that each half does by itself.
macro_rules! by_halves {
    ($(fn $name:ident($($argument:ident: $kind:ident),*) -> $result:ident;)*) => {$(
        #[inline(always)]
        fn $name($($argument: Self::$kind),*) -> Self::$result {
            Both(L::$name($($argument.0),*), L::$name($($argument.1),*))
        }
    )*};
}

impl<L: Lanes<Real = f32>> Lanes for Pair<L> {
    const COUNT: usize = 2 * L::COUNT;
    super::single_precision!();
    type Float = Both<L::Float>;
    type Word = Both<L::Word>;
    type Mask = Both<L::Mask>;

    #[inline(always)]
    fn float(value: f32) -> Self::Float {
        Both(L::float(value), L::float(value))
    }
    #[inline(always)]
    fn word(value: u32) -> Self::Word {
        Both(L::word(value), L::word(value))
    }
    #[inline(always)]
    fn first(count: usize) -> Self::Mask {
        Both(L::first(count.min(L::COUNT)), L::first(count.saturating_sub(L::COUNT)))
    }
    #[inline(always)]
    fn load(values: &[f32]) -> Self::Float {
        Both(L::load(values), L::load(&values[L::COUNT..]))
    }
    #[inline(always)]
    fn load_words(values: &[u32]) -> Self::Word {
        Both(L::load_words(values), L::load_words(&values[L::COUNT..]))
    }
    #[inline(always)]
    fn store(value: Self::Float, out: &mut [f32]) {
        L::store(value.0, out);
        L::store(value.1, &mut out[L::COUNT..]);
    }
    #[inline(always)]
    fn store_words(value: Self::Word, out: &mut [u32]) {
        L::store_words(value.0, out);
        L::store_words(value.1, &mut out[L::COUNT..]);
    }

    by_halves! {
        fn to_bits(value: Float) -> Word;
        fn from_bits(value: Word) -> Float;
        fn min(a: Float, b: Float) -> Float;
        fn max(a: Float, b: Float) -> Float;
        fn at_most(a: Float, b: Float) -> Mask;
        fn less(a: Float, b: Float) -> Mask;
        fn same(a: Float, b: Float) -> Mask;
        fn same_word(a: Word, b: Word) -> Mask;
        fn greater(a: Word, b: Word) -> Mask;
        fn test(a: Word, b: Word) -> Mask;
        fn select(mask: Mask, yes: Float, no: Float) -> Float;
        fn select_word(mask: Mask, yes: Word, no: Word) -> Word;
        fn add(a: Word, b: Word) -> Word;
        fn sub(a: Word, b: Word) -> Word;
        fn shift_left(value: Word, count: Word) -> Word;
        fn shift_right(value: Word, count: Word) -> Word;
        fn bit(place: Word) -> Word;
        fn count_ones(value: Word) -> Word;
        fn highest_bit(value: Word) -> Word;
        fn highest_bit_of_all(value: Word) -> Word;
    }

    #[inline(always)]
    fn spread<const AXIS: u32>(value: Self::Word) -> Self::Word {
        Both(L::spread::<AXIS>(value.0), L::spread::<AXIS>(value.1))
    }
    #[inline(always)]
    fn cells_ahead(cell: [Self::Word; 3], mirror: [Self::Word; 3]) -> [Self::Word; 2] {
        let first = L::cells_ahead(each(|axis| cell[axis].0), each(|axis| mirror[axis].0));
        let second = L::cells_ahead(each(|axis| cell[axis].1), each(|axis| mirror[axis].1));
        [Both(first[0], second[0]), Both(first[1], second[1])]
    }
    #[inline(always)]
    fn choose(words: &Choice, masks: [Self::Mask; 3]) -> Self::Word {
        Both(
            L::choose(words, each(|number| masks[number].0)),
            L::choose(words, each(|number| masks[number].1)),
        )
    }
    #[inline(always)]
    unsafe fn gather_rows(
        rows: &[[u32; 4]],
        index: Self::Word,
        mask: Self::Mask,
        otherwise: [Self::Word; 4],
    ) -> [Self::Word; 4] {
        // SAFETY: the promise holds for each half because it holds for all lanes.
        let (first, second) = unsafe {
            (
                L::gather_rows(rows, index.0, mask.0, each_word(|column| otherwise[column].0)),
                L::gather_rows(rows, index.1, mask.1, each_word(|column| otherwise[column].1)),
            )
        };
        each_word(|column| Both(first[column], second[column]))
    }
    #[inline(always)]
    fn bitmask(mask: Self::Mask) -> u32 {
        L::bitmask(mask.0) | L::bitmask(mask.1) << L::COUNT
    }
    #[inline(always)]
    fn from_bitmask(bits: u32) -> Self::Mask {
        Both(L::from_bitmask(bits), L::from_bitmask(bits >> L::COUNT))
    }
}
