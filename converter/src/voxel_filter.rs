//! Samples into voxels: the mean of all that fall into one.

use crate::color_space::to_displayed;
use crate::scan_conversion::Sample;
use crate::storage::{Spill, append_list, take_list};
use crate::structure::Structure;
use crate::surface::value_to_light;
use octvox_format::NormalCode;

/// The filled cells of a block at the finest level, in Morton order.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Leaves {
    pub structure: Structure,
    /// In the code of the file.
    pub normals: Vec<[u8; 2]>,
    pub colors: LeafColors,
    pub finishes: LeafFinishes,
}

impl Leaves {
    /// Finish and colour of a leaf.
    #[inline]
    pub(crate) fn look(&self, leaf: usize) -> (u16, [u8; 3]) {
        let finish = match &self.finishes {
            LeafFinishes::Same(finish) => *finish,
            LeafFinishes::Each(finishes) => finishes[leaf],
        };
        let color = match &self.colors {
            LeafColors::Same(color) => *color,
            LeafColors::Each(colors) => colors[leaf],
        };
        (finish, color)
    }

    /// Whether all leaves have the same finish and colour.
    pub(crate) fn is_uniform(&self) -> bool {
        matches!((&self.finishes, &self.colors), (LeafFinishes::Same(_), LeafColors::Same(_)))
    }
}

/// The colours of the leaves of a block.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum LeafColors {
    /// All have the same.
    Same([u8; 3]),
    /// Each has its own.
    Each(Vec<[u8; 3]>),
}

/// The finishes of the leaves of a block, by number.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum LeafFinishes {
    /// All have the same.
    Same(u16),
    /// Each has its own.
    Each(Vec<u16>),
}

impl Spill for Leaves {
    fn memory_bytes(&self) -> usize {
        let colors = match &self.colors {
            LeafColors::Same(_) => 0,
            LeafColors::Each(colors) => size_of_val(&colors[..]),
        };
        let finishes = match &self.finishes {
            LeafFinishes::Same(_) => 0,
            LeafFinishes::Each(finishes) => size_of_val(&finishes[..]),
        };
        let structure = self.structure.levels.memory_bytes();
        size_of::<Self>() + structure + size_of_val(&self.normals[..]) + colors + finishes
    }

    fn append_to(&self, bytes: &mut Vec<u8>) {
        self.structure.levels.append_to(bytes);
        append_list(&self.normals, bytes);
        match &self.colors {
            LeafColors::Same(color) => append_list(&[*color], bytes),
            LeafColors::Each(colors) => append_list(colors, bytes),
        }
        match &self.finishes {
            LeafFinishes::Same(finish) => append_list(&[*finish], bytes),
            LeafFinishes::Each(finishes) => append_list(finishes, bytes),
        }
    }

    fn from_bytes(bytes: &mut &[u8]) -> Option<Self> {
        let structure = Structure { levels: Spill::from_bytes(bytes)? };
        let (normals, colors) = (take_list(bytes)?, take_list(bytes)?);
        let finishes = take_list(bytes)?;
        // A list of one means all leaves, however many there are.
        let colors =
            if let [color] = colors[..] { LeafColors::Same(color) } else { LeafColors::Each(colors) };
        let finishes = match finishes[..] {
            [finish] => LeafFinishes::Same(finish),
            _ => LeafFinishes::Each(finishes),
        };
        Some(Self { structure, normals, colors, finishes })
    }
}

/// Filters the samples of one block after the other; keeps its working memory.
///
/// All sums are of integers, so the order of the samples does not matter. Colours are averaged as linear light; if all
/// samples of a voxel have the same colour, it gets exactly that. Normals are summed up as vectors. If they cancel out
/// exactly, as on two sides of a thin wall, the voxel gets the largest of them in the order of (x, y, z). Finishes are not
/// mixed: a voxel has the one that most of its samples have, and of several the one with the lowest number.
#[derive(Debug)]
pub(crate) struct VoxelFilter<const N: usize> {
    block_depth: u32,
    code: NormalCode,
    /// A bit for each cell of the block.
    occupied: Vec<u64>,
    /// For each word of it, how many bits are set before.
    ranks: Vec<u32>,
    sums: Vec<[i64; N]>,
    counts: Vec<u32>,
}

impl<const N: usize> VoxelFilter<N> {
    /// For blocks with a subtree of this depth. Normals are encoded in `code`.
    pub(crate) fn new(block_depth: u32, code: NormalCode) -> Self {
        let words = (1usize << (3 * block_depth)).div_ceil(64);
        Self {
            block_depth,
            code,
            occupied: vec![0; words],
            ranks: vec![0; words],
            sums: Vec::new(),
            counts: Vec::new(),
        }
    }

    /// The voxels of the samples, `None` if there are none. Samples without light (`N` = 3) have the colour `color`.
    pub(crate) fn filter(&mut self, samples: &[Sample<N>], color: [u8; 3]) -> Option<Leaves> {
        if samples.is_empty() {
            return None;
        }
        self.occupied.fill(0);
        for sample in samples {
            self.occupied[sample.cell as usize / 64] |= 1 << (sample.cell % 64);
        }
        let mut voxels = 0;
        for (rank, word) in self.ranks.iter_mut().zip(&self.occupied) {
            *rank = voxels;
            voxels += word.count_ones();
        }
        self.sum_up(samples, voxels as usize);
        self.resolve_opposing_normals(samples);
        Some(Leaves {
            structure: Structure::from_occupancy(&self.occupied, self.block_depth),
            normals: self.sums.iter().map(|sum| normal(sum, self.code)).collect(),
            colors: self.colors(color),
            finishes: self.finishes(samples),
        })
    }

    fn sum_up(&mut self, samples: &[Sample<N>], voxels: usize) {
        self.sums.clear();
        self.sums.resize(voxels, [0; N]);
        self.counts.clear();
        self.counts.resize(voxels, 0);
        for sample in samples {
            let voxel = self.voxel_of(sample.cell);
            for (sum, value) in self.sums[voxel].iter_mut().zip(sample.values) {
                *sum += i64::from(value);
            }
            self.counts[voxel] += 1;
        }
    }

    /// How many filled cells stand before this one.
    #[inline]
    fn voxel_of(&self, cell: u32) -> usize {
        let (word, bit) = (cell as usize / 64, cell % 64);
        let before = self.occupied[word] & ((1 << bit) - 1);
        (self.ranks[word] + before.count_ones()) as usize
    }

    fn resolve_opposing_normals(&mut self, samples: &[Sample<N>]) {
        let cancelled = |sum: &[i64; N]| sum[..3] == [0; 3];
        if !self.sums.iter().any(cancelled) {
            return;
        }
        let opposed: Vec<bool> = self.sums.iter().map(cancelled).collect();
        let mut largest = vec![[i16::MIN; 3]; opposed.len()];
        for sample in samples {
            let voxel = self.voxel_of(sample.cell);
            let [x, y, z] = [sample.values[0], sample.values[1], sample.values[2]];
            largest[voxel] = largest[voxel].max([x, y, z]);
        }
        for ((sum, opposed), largest) in self.sums.iter_mut().zip(opposed).zip(largest) {
            if opposed {
                sum[..3].copy_from_slice(&largest.map(i64::from));
            }
        }
    }

    fn finishes(&self, samples: &[Sample<N>]) -> LeafFinishes {
        let first = samples[0].finish;
        if samples.iter().all(|sample| sample.finish == first) {
            return LeafFinishes::Same(first);
        }
        let mut pairs: Vec<(u32, u16)> =
            samples.iter().map(|sample| (self.voxel_of(sample.cell) as u32, sample.finish)).collect();
        pairs.sort_unstable();
        let mut finishes = vec![0; self.counts.len()];
        let mut votes = vec![0; self.counts.len()];
        for equal in pairs.chunk_by(|a, b| a == b) {
            let (voxel, finish) = equal[0];
            if equal.len() > votes[voxel as usize] {
                votes[voxel as usize] = equal.len();
                finishes[voxel as usize] = finish;
            }
        }
        LeafFinishes::Each(finishes)
    }

    fn colors(&self, color: [u8; 3]) -> LeafColors {
        if N < 6 {
            return LeafColors::Same(color);
        }
        let colors: Vec<[u8; 3]> = self
            .sums
            .iter()
            .zip(&self.counts)
            .map(|(sum, &count)| {
                let mean = |sum: i64| {
                    let count = i64::from(count);
                    value_to_light((2 * sum + count).div_euclid(2 * count) as i16)
                };
                to_displayed([mean(sum[3]), mean(sum[4]), mean(sum[5])])
            })
            .collect();
        if colors.iter().all(|other| *other == colors[0]) {
            LeafColors::Same(colors[0])
        } else {
            LeafColors::Each(colors)
        }
    }
}

fn normal(sum: &[i64], code: NormalCode) -> [u8; 2] {
    code.encode([sum[0] as f32, sum[1] as f32, sum[2] as f32])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color_space::to_linear;
    use crate::surface::light_to_value;

    fn sample(cell: u32, normal: [i16; 3], color: [u8; 3]) -> Sample<6> {
        let [x, y, z] = normal;
        let [red, green, blue] = to_linear(color).map(light_to_value);
        Sample { cell, finish: 0, values: [x, y, z, red, green, blue] }
    }

    fn filter(samples: &[Sample<6>]) -> Leaves {
        VoxelFilter::new(2, NormalCode::Spherical).filter(samples, [0; 3]).unwrap()
    }

    #[test]
    fn samples_of_a_voxel_are_averaged_in_any_order() {
        let (x, y) = ([16_384, 0, 0], [0, 16_384, 0]);
        let mut samples = [
            sample(63, x, [255; 3]),
            sample(5, y, [10, 20, 30]),
            sample(63, y, [0; 3]),
            sample(0, x, [0, 0, 255]),
            sample(5, y, [10, 20, 30]),
        ];
        let leaves = filter(&samples);
        // Half of the light is displayed as 188.
        assert_eq!(leaves.colors, LeafColors::Each(vec![[0, 0, 255], [10, 20, 30], [188; 3]]));
        let expected = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]]
            .map(|normal| NormalCode::Spherical.encode(normal));
        assert_eq!(leaves.normals, expected);
        assert_eq!(leaves.structure.levels, [vec![0b1000_0001], vec![0b0010_0001, 0b1000_0000]]);
        samples.reverse();
        assert_eq!(filter(&samples), leaves);
    }

    #[test]
    fn equal_colors_stay_exactly_as_they_are() {
        for value in 0..=u8::MAX {
            let color = [value, 255 - value, value / 2];
            let leaves = filter(&[sample(1, [1, 2, 3], color); 7]);
            assert_eq!(leaves.colors, LeafColors::Same(color));
        }
    }

    #[test]
    fn normals_that_cancel_out_leave_the_largest() {
        let opposed =
            |z| [sample(9, [0, 0, z], [1; 3]), sample(9, [0, 0, -z], [1; 3]), sample(3, [0, 5, 0], [1; 3])];
        let expected = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|normal| NormalCode::Spherical.encode(normal));
        assert_eq!(filter(&opposed(16_384)).normals, expected);
        assert_eq!(filter(&opposed(-16_384)).normals, expected);
    }

    #[test]
    fn most_samples_give_the_finish_and_of_several_the_lowest() {
        let with = |cell, finish| Sample { finish, ..sample(cell, [1, 0, 0], [9; 3]) };
        assert_eq!(filter(&[with(2, 7), with(1, 7)]).finishes, LeafFinishes::Same(7));
        let mut samples = [
            with(8, 3),
            with(8, 1),
            with(8, 3),
            with(20, 9),
            with(20, 2),
            with(33, 5),
            with(33, 4),
            with(33, 4),
            with(33, 5),
        ];
        assert_eq!(filter(&samples).finishes, LeafFinishes::Each(vec![3, 2, 4]));
        samples.reverse();
        assert_eq!(filter(&samples).finishes, LeafFinishes::Each(vec![3, 2, 4]));
    }

    #[test]
    fn a_filter_forgets_the_last_block() {
        let mut filter = VoxelFilter::new(2, NormalCode::Spherical);
        let block = [sample(1, [1, 0, 0], [9; 3]), sample(40, [0, 1, 0], [8; 3])];
        let first = filter.filter(&block, [0; 3]);
        assert_eq!(filter.filter(&[], [0; 3]), None);
        filter.filter(&[sample(63, [1, 1, 1], [7; 3])], [0; 3]);
        assert_eq!(filter.filter(&block, [0; 3]), first);
    }
}
