//! Sets that can be joined (Tarjan 1975).

/// A partition of the numbers from 0.
#[derive(Debug, Clone, Default)]
pub(crate) struct DisjointSets {
    parents: Vec<u32>,
}

impl DisjointSets {
    /// Each number is a set of its own.
    pub(crate) fn new(count: usize) -> Self {
        Self { parents: (0..count as u32).collect() }
    }

    /// How many numbers there are.
    pub(crate) fn len(&self) -> usize {
        self.parents.len()
    }

    /// Adds a number, in a set of its own, and returns it.
    pub(crate) fn add(&mut self) -> u32 {
        let number = self.parents.len() as u32;
        self.parents.push(number);
        number
    }

    /// The smallest number of the set of this one.
    pub(crate) fn find(&mut self, mut number: u32) -> u32 {
        loop {
            let parent = self.parents[number as usize];
            if parent == number {
                return number;
            }
            // Halving the path on the way keeps later ones short.
            let grandparent = self.parents[parent as usize];
            self.parents[number as usize] = grandparent;
            number = grandparent;
        }
    }

    /// Makes one set of two.
    pub(crate) fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        // The smaller number stands for both.
        self.parents[a.max(b) as usize] = a.min(b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_is_joined_has_one_number(joins in prop::collection::vec((0u32..20, 0u32..20), 0..30)) {
            let mut sets = DisjointSets::new(20);
            // The same by relabelling everything at every join.
            let mut labels: Vec<u32> = (0..20).collect();
            for (a, b) in joins {
                sets.join(a, b);
                let [from, to] = [labels[a as usize].max(labels[b as usize]), labels[a as usize].min(labels[b as usize])];
                labels.iter_mut().filter(|label| **label == from).for_each(|label| *label = to);
            }
            for number in 0..20 {
                prop_assert_eq!(sets.find(number), labels[number as usize]);
            }
        }
    }
}
