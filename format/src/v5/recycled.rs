//! Memory that is used again, so that the next subtree does not ask the system for it.

use std::cell::RefCell;
use std::ops::{Deref, DerefMut};

/// More is given back to the system.
const LARGEST_KEPT: usize = 4 << 20;

thread_local! {
    static KEPT: RefCell<Vec<u8>> = const { RefCell::new(Vec::new()) };
}

/// An empty list of bytes with the memory of the last one that this thread has dropped.
///
/// Sections are decompressed into such lists: without, a sixth of the time of opening a file went into clearing pages.
#[derive(Debug)]
pub(crate) struct Recycled(Vec<u8>);

impl Recycled {
    pub fn new() -> Self {
        let mut bytes = KEPT.take();
        bytes.clear();
        Self(bytes)
    }
}

impl Drop for Recycled {
    fn drop(&mut self) {
        if self.0.capacity() <= LARGEST_KEPT {
            // At the end of a thread there is nobody left to use it.
            let _ = KEPT.try_with(|kept| kept.replace(std::mem::take(&mut self.0)));
        }
    }
}

impl Deref for Recycled {
    type Target = Vec<u8>;

    fn deref(&self) -> &Vec<u8> {
        &self.0
    }
}

impl DerefMut for Recycled {
    fn deref_mut(&mut self) -> &mut Vec<u8> {
        &mut self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_is_used_again_unless_there_is_much_of_it() {
        let capacity_after = |size: usize| {
            let mut first = Recycled::new();
            first.resize(size, 7);
            drop(first);
            let second = Recycled::new();
            assert!(second.is_empty());
            second.capacity()
        };
        assert!(capacity_after(1000) >= 1000);
        assert!(capacity_after(5 << 20) < 5 << 20);
    }

    #[test]
    fn two_at_once_are_apart() {
        let (mut first, mut second) = (Recycled::new(), Recycled::new());
        first.push(1);
        second.push(2);
        assert_eq!((first[0], second[0]), (1, 2));
    }
}
