//! Sets of 24-bit colours.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};

/// Words of a page: the colours of one value of red.
const PAGE_WORDS: usize = 1 << 10;

/// A set of colours in which each has a number: its place in the order of red, green, blue.
///
/// A bit for each colour, in pages that exist only where there are colours, so that a set of few is small.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct ColorSet {
    pages: Vec<Option<Box<Page>>>,
    len: usize,
}

/// The colours of a value of red.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Page {
    members: [u64; PAGE_WORDS],
    /// For each word, how many colours of the set stand before.
    ranks: [u32; PAGE_WORDS],
}

impl ColorSet {
    /// From the bits of the pages: for each value of red, none, or a bit for each colour at its [`place`].
    pub(crate) fn new(pages: impl Iterator<Item = Option<Box<[u64; PAGE_WORDS]>>>) -> Self {
        let mut len = 0;
        let pages = pages
            .map(|members| {
                let members = *members?;
                let ranks = members.map(|word| {
                    let rank = len;
                    len += word.count_ones();
                    rank
                });
                Some(Box::new(Page { members, ranks }))
            })
            .collect();
        Self { pages, len: len as usize }
    }

    /// The set of these colours, which may repeat.
    pub(crate) fn of(colors: impl Iterator<Item = [u8; 3]>) -> Self {
        let mut pages: Vec<Option<Box<[u64; PAGE_WORDS]>>> = vec![None; 256];
        for color in colors {
            let (page, word, bit) = place(color);
            pages[page].get_or_insert_with(|| Box::new([0; PAGE_WORDS]))[word] |= bit;
        }
        Self::new(pages.into_iter())
    }

    /// Number of colours.
    pub(crate) fn len(&self) -> usize {
        self.len
    }

    /// Whether a colour is in the set.
    #[inline]
    pub(crate) fn contains(&self, color: [u8; 3]) -> bool {
        let (page, word, bit) = place(color);
        self.pages[page].as_ref().is_some_and(|page| page.members[word] & bit != 0)
    }

    /// The number of a colour that is in the set; 0 for some that are not.
    #[inline]
    pub(crate) fn number(&self, color: [u8; 3]) -> usize {
        let (page, word, bit) = place(color);
        self.pages[page].as_ref().map_or(0, |page| {
            page.ranks[word] as usize + (page.members[word] & (bit - 1)).count_ones() as usize
        })
    }

    /// The colours in the order of their numbers.
    pub(crate) fn colors(&self) -> Vec<[u8; 3]> {
        let mut colors = Vec::with_capacity(self.len);
        for (red, page) in self.pages.iter().enumerate() {
            for (word, &members) in page.iter().flat_map(|page| page.members.iter().enumerate()) {
                let mut rest = members;
                while rest != 0 {
                    let code = word * 64 + rest.trailing_zeros() as usize;
                    colors.push([red as u8, (code >> 8) as u8, code as u8]);
                    rest &= rest - 1;
                }
            }
        }
        colors
    }
}

/// Colours that are put together by several threads.
#[derive(Debug)]
pub(crate) struct SharedColorSet {
    pages: Vec<OnceLock<Box<[AtomicU64; PAGE_WORDS]>>>,
}

impl SharedColorSet {
    pub(crate) fn new() -> Self {
        let mut pages = Vec::new();
        pages.resize_with(256, OnceLock::new);
        Self { pages }
    }

    #[inline]
    pub(crate) fn insert(&self, color: [u8; 3]) {
        let (page, word, bit) = place(color);
        let page = self.pages[page].get_or_init(|| Box::new([const { AtomicU64::new(0) }; PAGE_WORDS]));
        // Reading first spares the cache line if the bit is set already, as it mostly is.
        if page[word].load(Ordering::Relaxed) & bit == 0 {
            page[word].fetch_or(bit, Ordering::Relaxed);
        }
    }

    pub(crate) fn finish(self) -> ColorSet {
        let words = |page: Box<[AtomicU64; PAGE_WORDS]>| Box::new(page.map(AtomicU64::into_inner));
        ColorSet::new(self.pages.into_iter().map(|page| page.into_inner().map(words)))
    }
}

/// Page, word and bit of a colour.
#[inline]
fn place([red, green, blue]: [u8; 3]) -> (usize, usize, u64) {
    let code = usize::from(green) << 8 | usize::from(blue);
    (usize::from(red), code / 64, 1 << (code % 64))
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
            let shared = SharedColorSet::new();
            colors.iter().for_each(|&color| shared.insert(color));
            prop_assert_eq!(&shared.finish(), &set);
            let expected: Vec<[u8; 3]> = colors.into_iter().collect::<BTreeSet<_>>().into_iter().collect();
            prop_assert_eq!(set.len(), expected.len());
            prop_assert_eq!(set.colors(), &expected[..]);
            for (number, &color) in expected.iter().enumerate() {
                prop_assert_eq!(set.number(color), number);
                prop_assert!(set.contains(color));
                let [red, green, blue] = color;
                let other = [red, green, blue ^ 1];
                prop_assert_eq!(set.contains(other), expected.contains(&other));
            }
        }
    }
}
