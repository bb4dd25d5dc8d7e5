//! A plain way to read files of version 5, from the description of the format alone. It shares nothing with the crate, and
//! insists on everything.

use super::Tree;
use super::checksums::crc32;
use octvox_format::{SphericalNormal, Voxel};
use std::collections::VecDeque;

/// What a file holds.
pub struct PlainFile {
    pub depth: u8,
    pub cut_level: u8,
    pub normal_code: u8,
    pub compression: u8,
    pub origin: [f64; 3],
    pub voxel_size: f64,
    pub writer: String,
    pub materials: Vec<[u8; 40]>,
    /// Morton code and levels.
    pub subtrees: Vec<(u64, Levels)>,
    pub top: Levels,
}

type Levels = Vec<VecDeque<PlainVoxel>>;

#[derive(Clone, Copy)]
pub struct PlainVoxel {
    pub mask: u8,
    pub index: u16,
    pub normal: [u8; 2],
}

fn number(bytes: &[u8]) -> u64 {
    bytes.iter().rev().fold(0, |number, byte| number << 8 | u64::from(*byte))
}

struct Section<'a> {
    kind: &'a [u8],
    start: usize,
    head: &'a [u8],
    raw: Vec<u8>,
    end: usize,
}

fn section(file: &[u8], start: usize) -> Section<'_> {
    let head = &file[start..start + 32];
    let end = start + 32 + number(&head[4..8]) as usize;
    let stored = &file[start + 32..end];
    assert_eq!(number(&head[28..32]), u64::from(crc32(&[&head[..28], stored].concat())));
    assert_eq!(head[27], 0);
    let raw = match head[26] {
        0 => stored.to_vec(),
        1 => zstd::decode_all(stored).unwrap(),
        other => panic!("encoding {other}"),
    };
    Section { kind: &head[0..4], start, head, raw, end }
}

/// Levels as the section describes them; `masked` of `count` have masks.
fn levels(section: &Section<'_>, count: usize, masked: usize) -> Levels {
    let mut raw = VecDeque::from(section.raw.clone());
    let mut take = |count: usize| raw.drain(..count).collect::<Vec<u8>>();
    let table_length = number(&section.head[24..26]) as usize;
    let table: Vec<u16> = (0..table_length).map(|_| number(&take(2)) as u16).collect();
    assert!(table.is_sorted_by(|a, b| a < b));

    let mut levels: Levels = Vec::new();
    // For each voxel of the next level its parent's index (or entry) and normal.
    let mut parents = vec![(0_u16, [0_u8; 2]); (number(&section.head[20..24]) as usize).min(1)];
    for level in 0..count {
        let n = parents.len();
        let masks = if level < masked { take(n) } else { vec![0; n] };
        let index_bytes = match table_length {
            0 => take(2 * n),
            1 => Vec::new(),
            _ => take(n),
        };
        let normal_bytes = take(2 * n);
        let mut voxels = VecDeque::new();
        let mut children = Vec::new();
        for (k, (parent_index, parent_normal)) in parents.iter().enumerate() {
            let (kept, index) = match table_length {
                0 => {
                    let folded = i32::from(index_bytes[k]) + 256 * i32::from(index_bytes[n + k]);
                    let difference = if folded % 2 == 0 { folded / 2 } else { -(folded + 1) / 2 };
                    let index = (i32::from(*parent_index) + difference).rem_euclid(65_536) as u16;
                    (index, index)
                }
                1 => (0, table[0]),
                _ => {
                    let entry = (*parent_index + u16::from(index_bytes[k])) % 256;
                    (entry, table[usize::from(entry)])
                }
            };
            let add = |k: usize, byte: usize| {
                ((u16::from(parent_normal[byte]) + u16::from(normal_bytes[k])) % 256) as u8
            };
            let normal = [add(k, 0), add(n + k, 1)];
            voxels.push_back(PlainVoxel { mask: masks[k], index, normal });
            children.extend((0..masks[k].count_ones()).map(|_| (kept, normal)));
        }
        levels.push(voxels);
        parents = children;
    }
    assert!(raw.is_empty());
    assert_eq!(levels.iter().map(VecDeque::len).sum::<usize>() as u64, number(&section.head[20..24]));
    assert_eq!(
        levels[..masked].iter().map(VecDeque::len).sum::<usize>() as u64,
        number(&section.head[16..20])
    );
    levels
}

pub fn parse(file: &[u8]) -> PlainFile {
    assert_eq!(file[0..4], [0x4D, 0x42, 5, 0]);
    assert_eq!(number(&file[92..96]), u64::from(crc32(&file[..92])));
    assert_eq!(file[10..16], [0; 6]);
    let float = |start: usize| f64::from_le_bytes(file[start..start + 8].try_into().unwrap());
    let (depth, cut_level) = (file[4], file[5]);
    let (level_count, cut) = (usize::from(depth - cut_level) + 1, usize::from(cut_level));

    let palette = section(file, 96);
    assert_eq!(palette.kind, b"MATL");
    assert_eq!(number(&palette.head[20..24]), number(&file[8..10]));
    assert_eq!(palette.raw.len() as u64, 40 * number(&file[8..10]));

    let mut subtrees = Vec::new();
    let mut entries = Vec::new();
    let mut next = section(file, palette.end);
    while next.kind == b"TREE" {
        let code = number(&next.head[8..16]);
        entries.extend_from_slice(&next.head[8..16]);
        entries.extend((next.start as u64).to_le_bytes());
        entries.extend_from_slice(&next.head[4..8]);
        entries.extend_from_slice(&next.head[16..24]);
        entries.extend_from_slice(&next.head[28..32]);
        subtrees.push((code, levels(&next, level_count, level_count - 1)));
        next = section(file, next.end);
    }
    assert!(subtrees.is_sorted_by(|(a, _), (b, _)| a < b));
    assert_eq!(next.kind, b"TOP ");
    let top = levels(&next, cut, cut);
    let index = section(file, next.end);
    assert_eq!(index.kind, b"INDX");
    assert_eq!(index.raw[16 * (usize::from(depth) + 1)..], entries);

    let mut voxels = 0;
    for level in 0..=usize::from(depth) {
        let lists = top
            .get(level)
            .into_iter()
            .chain(subtrees.iter().filter_map(|(_, l)| l.get(level.checked_sub(cut)?)));
        let all: Vec<_> = lists.flatten().collect();
        let counts = &index.raw[16 * level..16 * level + 16];
        assert_eq!(number(&counts[..8]), all.len() as u64);
        assert_eq!(number(&counts[8..]), all.iter().filter(|voxel| voxel.mask != 0).count() as u64);
        voxels += all.len() as u64;
    }
    let trailer = &file[index.end..];
    assert_eq!(trailer.len(), 36);
    assert_eq!(trailer[0..4], *b"END ");
    assert_eq!(number(&trailer[4..8]), subtrees.len() as u64);
    assert_eq!(number(&trailer[8..16]), next.start as u64);
    assert_eq!(number(&trailer[16..24]), index.start as u64);
    assert_eq!(number(&trailer[24..32]), voxels);
    assert_eq!(number(&trailer[32..36]), u64::from(crc32(&trailer[..32])));

    let name = &file[48..92];
    let length = name.iter().position(|byte| *byte == 0).unwrap_or(44);
    assert!(name[length..].iter().all(|byte| *byte == 0));
    PlainFile {
        depth,
        cut_level,
        normal_code: file[6],
        compression: file[7],
        origin: [16, 24, 32].map(float),
        voxel_size: float(40),
        writer: String::from_utf8(name[..length].to_vec()).unwrap(),
        materials: palette.raw.chunks(40).map(|bytes| bytes.try_into().unwrap()).collect(),
        subtrees,
        top,
    }
}

impl PlainFile {
    /// The octree, with the bytes of the normals as if they were spherical.
    pub fn tree(mut self) -> Tree {
        let mut subtrees: VecDeque<_> = std::mem::take(&mut self.subtrees).into();
        let tree = if self.cut_level == 0 {
            let root = subtrees.pop_front();
            assert!(root.as_ref().is_none_or(|(code, _): &(u64, _)| *code == 0));
            root.map(|(_, mut levels)| voxel(&mut levels, 0))
        } else if self.top[0].is_empty() {
            None
        } else {
            Some(self.top_voxel(0, 0, &mut subtrees))
        };
        assert!(subtrees.is_empty());
        tree.unwrap_or_else(|| Tree::leaf(0))
    }

    fn top_voxel(&mut self, level: usize, code: u64, subtrees: &mut VecDeque<(u64, Levels)>) -> Tree {
        if level == usize::from(self.cut_level) {
            let (found, mut levels) = subtrees.pop_front().unwrap();
            assert_eq!(found, code);
            return voxel(&mut levels, 0);
        }
        let own = self.top[level].pop_front().unwrap();
        let child = |octant| self.top_voxel(level + 1, 8 * code + u64::from(octant), subtrees);
        own.with_children(child)
    }
}

fn voxel(levels: &mut Levels, level: usize) -> Tree {
    let own = levels[level].pop_front().unwrap();
    own.with_children(|_| voxel(levels, level + 1))
}

impl PlainVoxel {
    fn with_children(self, mut child: impl FnMut(u8) -> Tree) -> Tree {
        let voxel = Voxel { palette_index: self.index, normal: SphericalNormal::from_bytes(self.normal) };
        let mut filled =
            |octant: u8| if self.mask >> octant & 1 == 1 { child(octant) } else { Tree::leaf(0) };
        let children = if self.mask == 0 { Vec::new() } else { (0..8).map(&mut filled).collect() };
        Tree { voxel, children }
    }
}
