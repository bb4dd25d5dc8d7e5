//! What the shader needs to know of a voxel, and how it is kept.

use crate::lanes::prefetch;
use bytemuck::{Pod, Zeroable};
use octvox_format::{NormalCode, SphericalNormal, Voxel};
use std::ops::Range;

/// What a voxel looks like: its palette index and its normal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Payload {
    word: PayloadWord,
    normal_code: NormalCode,
}

/// A normal in the code of its file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CodedNormal {
    /// The two bytes of the file.
    pub bytes: [u8; 2],
    /// How they are to be understood.
    pub code: NormalCode,
}

impl CodedNormal {
    /// The unit vector.
    #[must_use]
    #[inline]
    pub fn decode(self) -> [f32; 3] {
        self.code.decode(self.bytes)
    }
}

impl Payload {
    pub(crate) fn new(word: PayloadWord, normal_code: NormalCode) -> Self {
        Self { word, normal_code }
    }

    /// Index into the palette, counted from 1; 0 means empty.
    #[must_use]
    pub fn palette_index(self) -> u16 {
        self.word.palette_index()
    }

    /// The surface normal.
    #[must_use]
    pub fn normal(self) -> CodedNormal {
        CodedNormal { bytes: self.word.normal(), code: self.normal_code }
    }

    /// Index and normal as in a file of version 4; a normal of another code becomes the nearest of that file's.
    #[must_use]
    pub fn voxel(self) -> Voxel {
        let normal = self.normal();
        let normal = match normal.code {
            NormalCode::Spherical => SphericalNormal::from_bytes(normal.bytes),
            NormalCode::Octahedral => SphericalNormal::encode(normal.decode()),
        };
        Voxel { palette_index: self.palette_index(), normal }
    }

    /// Whether there is nothing to see.
    #[must_use]
    pub fn is_empty(self) -> bool {
        self.word.is_empty()
    }
}

/// A voxel's palette index, and its normal in the code of the octree, in 32 bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Pod, Zeroable)]
#[repr(transparent)]
pub(crate) struct PayloadWord(u32);

impl PayloadWord {
    pub const EMPTY: Self = Self(0);

    #[inline]
    pub fn new(palette_index: u16, [first, second]: [u8; 2]) -> Self {
        let [low, high] = palette_index.to_le_bytes();
        Self(u32::from_le_bytes([low, high, first, second]))
    }

    #[inline]
    pub fn palette_index(self) -> u16 {
        self.0 as u16
    }

    #[inline]
    pub fn normal(self) -> [u8; 2] {
        let [_, _, first, second] = self.0.to_le_bytes();
        [first, second]
    }

    #[inline]
    pub fn is_empty(self) -> bool {
        self.palette_index() == 0
    }
}

impl From<Voxel> for PayloadWord {
    #[inline]
    fn from(voxel: Voxel) -> Self {
        Self::new(voxel.palette_index, voxel.normal.to_bytes())
    }
}

/// The payload of many voxels, apart from the structure, read once per hit.
///
/// A palette index takes as few bytes as the palette allows. Index and normal stand side by side, so that a hit reads
/// one place.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum PayloadList {
    /// Of one colour: the normals alone.
    OneColor(Vec<[u8; 2]>),
    /// Of up to 255 colours: normal and palette index.
    FewColors(Vec<[u8; 3]>),
    /// Of any number of colours.
    ManyColors(Vec<PayloadWord>),
}

impl PayloadList {
    /// An empty list for voxels of a palette of so many entries.
    pub fn new(palette_size: usize) -> Self {
        match palette_size {
            0..=1 => Self::OneColor(Vec::new()),
            2..=255 => Self::FewColors(Vec::new()),
            _ => Self::ManyColors(Vec::new()),
        }
    }

    /// Number of voxels.
    pub fn len(&self) -> usize {
        match self {
            Self::OneColor(list) => list.len(),
            Self::FewColors(list) => list.len(),
            Self::ManyColors(list) => list.len(),
        }
    }

    /// The voxel at `index`, which is in the list.
    #[inline]
    pub fn get(&self, index: u32) -> PayloadWord {
        let index = index as usize;
        match self {
            Self::OneColor(list) => PayloadWord::new(1, list[index]),
            Self::FewColors(list) => {
                let [first, second, palette_index] = list[index];
                PayloadWord::new(palette_index.into(), [first, second])
            }
            Self::ManyColors(list) => list[index],
        }
    }

    /// Asks for the voxel at `index` to be brought near.
    #[inline]
    pub fn ask_for(&self, index: u32) {
        match self {
            Self::OneColor(list) => prefetch(list, index),
            Self::FewColors(list) => prefetch(list, index),
            Self::ManyColors(list) => prefetch(list, index),
        }
    }

    /// For each of so many entries of the palette, whether some voxel has it.
    pub fn used_entries(&self, palette_size: usize) -> Vec<bool> {
        let mut used = vec![false; palette_size];
        let mut mark = |index: usize| {
            if let Some(used) = index.checked_sub(1).and_then(|entry| used.get_mut(entry)) {
                *used = true;
            }
        };
        match self {
            Self::OneColor(list) => mark(usize::from(!list.is_empty())),
            Self::FewColors(list) => list.iter().for_each(|[_, _, index]| mark(usize::from(*index))),
            Self::ManyColors(list) => list.iter().for_each(|word| mark(usize::from(word.palette_index()))),
        }
        used
    }

    /// Appends voxels, none of which is empty.
    pub fn extend(&mut self, words: &[PayloadWord]) {
        match self {
            Self::OneColor(list) => list.extend(words.iter().map(|word| word.normal())),
            Self::FewColors(list) => list.extend(words.iter().map(|word| {
                let [first, second] = word.normal();
                // The palette has no more than 255 entries.
                [first, second, word.palette_index() as u8]
            })),
            Self::ManyColors(list) => list.extend_from_slice(words),
        }
    }

    /// Appends the voxels in a range of parallel lists of palette indices and normals, none of which is empty. Returns
    /// whether the lists are that long.
    #[inline]
    pub fn extend_from_planes(&mut self, indices: &[u16], normals: &[[u8; 2]], range: Range<usize>) -> bool {
        let (Some(indices), Some(normals)) = (indices.get(range.clone()), normals.get(range)) else {
            return false;
        };
        let voxels = indices.iter().zip(normals);
        match self {
            Self::OneColor(list) => list.extend_from_slice(normals),
            Self::FewColors(list) => list
                // The palette has no more than 255 entries.
                .extend(voxels.map(|(index, [first, second])| [*first, *second, *index as u8])),
            Self::ManyColors(list) => {
                list.extend(voxels.map(|(index, normal)| PayloadWord::new(*index, *normal)));
            }
        }
        true
    }

    /// Makes room for so many more voxels, if there is any.
    pub fn try_reserve(&mut self, count: usize) {
        // What cannot be had is asked for again when it is needed.
        let _ = match self {
            Self::OneColor(list) => list.try_reserve_exact(count),
            Self::FewColors(list) => list.try_reserve_exact(count),
            Self::ManyColors(list) => list.try_reserve_exact(count),
        };
    }

    /// Appends some voxels of a list of the same palette.
    pub fn append(&mut self, other: &Self, range: Range<usize>) {
        match (self, other) {
            (Self::OneColor(list), Self::OneColor(other)) => list.extend_from_slice(&other[range]),
            (Self::FewColors(list), Self::FewColors(other)) => list.extend_from_slice(&other[range]),
            (Self::ManyColors(list), Self::ManyColors(other)) => list.extend_from_slice(&other[range]),
            _ => debug_assert!(false, "lists of different palettes"),
        }
    }

    /// Takes all voxels out, and keeps the memory.
    pub fn clear(&mut self) {
        match self {
            Self::OneColor(list) => list.clear(),
            Self::FewColors(list) => list.clear(),
            Self::ManyColors(list) => list.clear(),
        }
    }

    /// Gives back memory that is not needed.
    pub fn shrink_to_fit(&mut self) {
        match self {
            Self::OneColor(list) => list.shrink_to_fit(),
            Self::FewColors(list) => list.shrink_to_fit(),
            Self::ManyColors(list) => list.shrink_to_fit(),
        }
    }

    /// Bytes in memory.
    pub fn byte_length(&self) -> usize {
        match self {
            Self::OneColor(list) => size_of_val(list.as_slice()),
            Self::FewColors(list) => size_of_val(list.as_slice()),
            Self::ManyColors(list) => size_of_val(list.as_slice()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_voxel_comes_back() {
        let normal = SphericalNormal { theta: 200, phi: -7 };
        let voxel = Voxel { palette_index: 0x7FFF, normal };
        let payload = Payload::new(PayloadWord::from(voxel), NormalCode::Spherical);
        assert_eq!(payload.palette_index(), 0x7FFF);
        assert_eq!(payload.normal().decode(), normal.decode());
        assert_eq!(payload.voxel(), voxel);
        assert!(!payload.is_empty());
        assert!(PayloadWord::default().is_empty());
    }

    #[test]
    fn an_octahedral_normal_is_understood() {
        let up = NormalCode::Octahedral.encode([0.0, 0.6, 0.8]);
        let payload = Payload::new(PayloadWord::new(3, up), NormalCode::Octahedral);
        assert_eq!(payload.normal().decode(), NormalCode::Octahedral.decode(up));
        let [x, y, z] = payload.voxel().normal.decode();
        assert!(x.abs() < 0.02 && (y - 0.6).abs() < 0.02 && (z - 0.8).abs() < 0.02, "{x} {y} {z}");
    }

    #[test]
    fn lists_keep_what_the_palette_can_name() {
        for (palette_size, bytes_each) in [(1, 2), (2, 3), (255, 3), (256, 4), (65_535, 4)] {
            let words: Vec<_> = (0..100_usize)
                .map(|place| {
                    PayloadWord::new((1 + place * 997 % palette_size) as u16, [place as u8, !(place as u8)])
                })
                .collect();
            let mut list = PayloadList::new(palette_size);
            let mut end = PayloadList::new(palette_size);
            list.extend(&words[..30]);
            end.extend(&words[30..]);
            list.append(&end, 0..70);
            assert_eq!((list.len(), list.byte_length()), (100, 100 * bytes_each));
            assert!((0..).zip(&words).all(|(index, word)| list.get(index) == *word));
        }
    }
}
