//! Sets of numbers, a bit of a word for each.

/// The places of the bits that are set, from the lowest on.
#[inline(always)]
pub(crate) fn ones(bits: impl Into<u64>) -> impl Iterator<Item = u32> {
    let mut bits = bits.into();
    std::iter::from_fn(move || {
        let place = (bits != 0).then(|| bits.trailing_zeros())?;
        bits &= bits - 1;
        Some(place)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bit_comes_once_and_in_order() {
        assert_eq!(ones(0u8).next(), None);
        assert!(ones(0b1010_0001u8).eq([0, 5, 7]));
        assert!(ones(u64::MAX).eq(0..64));
        assert!(ones(1u64 << 63 | 2).eq([1, 63]));
    }
}
