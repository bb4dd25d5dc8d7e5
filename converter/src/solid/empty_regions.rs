//! The connected empty regions of a block.
//!
//! Rows of cells along x are cut into runs of empty cells, and runs that touch within the block are joined
//! (Rosenfeld and Pfaltz 1966, in three dimensions). Cells are connected through faces.

use super::rows::Rows;
use crate::disjoint_sets::DisjointSets;

/// The empty cells of a block, sorted into regions.
#[derive(Debug)]
pub(crate) struct EmptyRegions {
    size: usize,
    /// Neighbouring empty cells of a row, row by row.
    runs: Vec<Run>,
    /// Where the runs of each row begin, and the end.
    starts: Vec<u32>,
    /// Number of regions.
    pub count: u32,
}

#[derive(Debug, Clone, Copy)]
struct Run {
    cells: u64,
    region: u32,
}

/// What a region has of a face of the block: bit u of word v is the cell at (u, v), where u is the first of the other two
/// axes and v the second.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Contact {
    pub region: u32,
    pub cells: Vec<u64>,
}

impl EmptyRegions {
    pub(crate) fn new(filled: &Rows) -> Self {
        let size = filled.size;
        let mut runs: Vec<Run> = Vec::new();
        let mut starts = vec![0u32];
        let mut sets = DisjointSets::default();
        for row in 0..size * size {
            let mut empty = !filled.words[row] & filled.full_row();
            while empty != 0 {
                let lowest = empty & empty.wrapping_neg();
                // Adding the lowest bit carries through its run.
                let cells = empty & !empty.wrapping_add(lowest);
                empty &= !cells;
                let region = sets.add();
                let before = [(row % size != 0).then(|| row - 1), row.checked_sub(size)];
                for neighbor in before.into_iter().flatten() {
                    for run in &runs[starts[neighbor] as usize..starts[neighbor + 1] as usize] {
                        if run.cells & cells != 0 {
                            sets.join(run.region, region);
                        }
                    }
                }
                runs.push(Run { cells, region });
            }
            starts.push(runs.len() as u32);
        }
        // A set's smallest number belongs to the first of its runs.
        let mut numbers = vec![0; sets.len()];
        let mut count = 0;
        for run in &mut runs {
            let first = sets.find(run.region);
            if first == run.region {
                numbers[first as usize] = count;
                count += 1;
            }
            run.region = numbers[first as usize];
        }
        Self { size, runs, starts, count }
    }

    /// The regions that touch a face of the block, ascending: the lower or the upper one along an axis.
    pub(crate) fn contacts(&self, axis: usize, upper: bool) -> Vec<Contact> {
        let size = self.size;
        let edge = if upper { size - 1 } else { 0 };
        let mut contacts: Vec<Contact> = Vec::new();
        let mut add = |region: u32, word: usize, cells: u64| {
            let place = contacts.partition_point(|contact| contact.region < region);
            if contacts.get(place).is_none_or(|contact| contact.region != region) {
                contacts.insert(place, Contact { region, cells: vec![0; size] });
            }
            contacts[place].cells[word] |= cells;
        };
        for other in 0..size * size {
            let (u, v) = (other % size, other / size);
            let row = match axis {
                0 => u + size * v,
                1 if u == 0 => edge + size * v,
                2 if u == 0 => v + size * edge,
                _ => continue,
            };
            for run in self.row(row) {
                match axis {
                    0 if run.cells >> edge & 1 == 1 => add(run.region, v, 1 << u),
                    0 => {}
                    _ => add(run.region, v, run.cells),
                }
            }
        }
        contacts
    }

    /// The cells of the regions that are marked.
    pub(crate) fn cells_of(&self, marked: impl Fn(u32) -> bool) -> Rows {
        let mut rows = Rows::empty(self.size);
        for (row, word) in rows.words.iter_mut().enumerate() {
            for run in self.row(row).iter().filter(|run| marked(run.region)) {
                *word |= run.cells;
            }
        }
        rows
    }

    /// A cell of each region: its first.
    pub(crate) fn first_cells(&self) -> Vec<[u32; 3]> {
        let mut cells = Vec::with_capacity(self.count as usize);
        for row in 0..self.size * self.size {
            for run in self.row(row) {
                // Regions are numbered in the order of their first runs.
                if run.region as usize == cells.len() {
                    cells.push([
                        run.cells.trailing_zeros(),
                        (row % self.size) as u32,
                        (row / self.size) as u32,
                    ]);
                }
            }
        }
        cells
    }

    fn row(&self, row: usize) -> &[Run] {
        &self.runs[self.starts[row] as usize..self.starts[row + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Regions by flooding cell by cell, numbered by their first cells.
    fn flood(filled: &Rows) -> (Vec<Option<u32>>, u32) {
        let size = filled.size as u32;
        let index = |[x, y, z]: [u32; 3]| (x + size * (y + size * z)) as usize;
        let mut regions = vec![None; (size * size * size) as usize];
        let mut count = 0;
        for start in 0..size * size * size {
            let start = [start % size, start / size % size, start / size / size];
            if filled.contains(start) || regions[index(start)].is_some() {
                continue;
            }
            let mut waiting = vec![start];
            while let Some(cell) = waiting.pop() {
                if filled.contains(cell) || regions[index(cell)].is_some() {
                    continue;
                }
                regions[index(cell)] = Some(count);
                for axis in 0..3 {
                    for step in [u32::MAX, 1] {
                        let mut neighbor = cell;
                        neighbor[axis] = neighbor[axis].wrapping_add(step);
                        if neighbor[axis] < size {
                            waiting.push(neighbor);
                        }
                    }
                }
            }
            count += 1;
        }
        (regions, count)
    }

    proptest! {
        #[test]
        fn regions_are_those_of_a_flood(depth in 0u32..4, seed: [u64; 8], density in 1usize..4) {
            let size = 1usize << depth;
            let mut rows = Rows::empty(size);
            let full = rows.full_row();
            for (k, word) in rows.words.iter_mut().enumerate() {
                // Ever more of the words that a cell must be set in.
                *word = (0..density).fold(full, |word, n| word & seed[(k * 3 + n) % 8].rotate_left((k * 7 + n * 13) as u32));
            }
            let regions = EmptyRegions::new(&rows);
            let (expected, count) = flood(&rows);
            prop_assert_eq!(regions.count, count);
            for region in 0..count {
                let cells = regions.cells_of(|other| other == region);
                for (k, found) in expected.iter().enumerate() {
                    let cell = [k % size, k / size % size, k / size / size].map(|c| c as u32);
                    prop_assert_eq!(cells.contains(cell), *found == Some(region));
                }
                prop_assert!(cells.contains(regions.first_cells()[region as usize]));
                for axis in 0..3 {
                    for upper in [false, true] {
                        let contacts = regions.contacts(axis, upper);
                        let contact = contacts.iter().find(|contact| contact.region == region);
                        for other in 0..size * size {
                            let (u, v) = (other % size, other / size);
                            let edge = if upper { size - 1 } else { 0 };
                            let cell = match axis {
                                0 => [edge, u, v],
                                1 => [u, edge, v],
                                _ => [u, v, edge],
                            };
                            let touches = contact.is_some_and(|contact| contact.cells[v] >> u & 1 == 1);
                            prop_assert_eq!(touches, cells.contains(cell.map(|c| c as u32)));
                        }
                    }
                }
            }
        }
    }
}
