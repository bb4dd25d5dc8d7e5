//! Sets of 24-bit colours.

/// One bit for each of the 2^24 colours.
pub(crate) const WORDS: usize = 1 << 18;

/// A set of colours in which each has a number: its place in the order of red, green, blue.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct ColorSet {
    /// A bit for each colour.
    members: Vec<u64>,
    /// For each word of it, how many bits are set before.
    ranks: Vec<u32>,
    len: usize,
}

impl ColorSet {
    /// From a bit for each colour, at its [`place`]; there are [`WORDS`] words.
    pub(crate) fn new(members: Vec<u64>) -> Self {
        let mut len = 0;
        let ranks = members
            .iter()
            .map(|word| {
                let rank = len;
                len += word.count_ones();
                rank
            })
            .collect();
        Self { members, ranks, len: len as usize }
    }

    /// The set of these colours, which may repeat.
    pub(crate) fn of(colors: impl Iterator<Item = [u8; 3]>) -> Self {
        let mut members = vec![0; WORDS];
        for color in colors {
            let (word, bit) = place(color);
            members[word] |= bit;
        }
        Self::new(members)
    }

    /// Number of colours.
    pub(crate) fn len(&self) -> usize {
        self.len
    }

    /// The number of a colour that is in the set.
    #[inline]
    pub(crate) fn number(&self, color: [u8; 3]) -> usize {
        let (word, bit) = place(color);
        self.ranks[word] as usize + (self.members[word] & (bit - 1)).count_ones() as usize
    }

    /// The colours in the order of their numbers.
    pub(crate) fn colors(&self) -> Vec<[u8; 3]> {
        let mut colors = Vec::with_capacity(self.len);
        for (word, &members) in self.members.iter().enumerate() {
            let mut rest = members;
            while rest != 0 {
                let code = word * 64 + rest.trailing_zeros() as usize;
                colors.push([(code >> 16) as u8, (code >> 8) as u8, code as u8]);
                rest &= rest - 1;
            }
        }
        colors
    }
}

/// Word and bit of a colour.
#[inline]
pub(crate) fn place([red, green, blue]: [u8; 3]) -> (usize, u64) {
    let code = usize::from(red) << 16 | usize::from(green) << 8 | usize::from(blue);
    (code / 64, 1 << (code % 64))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::BTreeSet;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20))]
        #[test]
        fn numbers_are_places_in_order(colors in prop::collection::vec(any::<[u8; 3]>(), 0..200)) {
            let set = ColorSet::of(colors.iter().chain(&colors).copied());
            let expected: Vec<[u8; 3]> = colors.into_iter().collect::<BTreeSet<_>>().into_iter().collect();
            prop_assert_eq!(set.len(), expected.len());
            prop_assert_eq!(set.colors(), &expected[..]);
            for (number, &color) in expected.iter().enumerate() {
                prop_assert_eq!(set.number(color), number);
            }
        }
    }
}
