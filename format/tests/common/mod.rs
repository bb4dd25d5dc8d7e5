//! What the tests share: the example of the thesis, octrees as plain recursive values, and a plain recursive way to
//! write and read them that shares nothing with the crate.

#![allow(dead_code, reason = "each test uses a part")]

pub mod checksums;
pub mod plain_v5;

use octvox_format::v5::{Compression, Header};
use octvox_format::{
    FormatError, NormalCode, Palette, Reader, Record, SphericalNormal, Voxel, Writer, to_version_5,
};
use proptest::prelude::*;
use std::io::Cursor;

/// The example of Bohnen 2009, figure 17: a black root whose children are black and white.
#[rustfmt::skip]
pub const FIGURE_17: [u8; 50] = [
    0x4D, 0x42, 0x04, 0x00, 0x02, 0x00, 0xFF, 0xFF, 0xFF, 0x00, 0x00, 0x00, 0x7C, 0x7C,
    0x05, 0x00, 0xA1, 0x76,
    0x04, 0x00, 0x3D, 0x42, 0x02, 0x00, 0x91, 0xBC, 0x04, 0x00, 0x1C, 0xAA, 0x02, 0x00, 0x74, 0x32,
    0x04, 0x00, 0x4A, 0x8F, 0x02, 0x00, 0x88, 0xE2, 0x04, 0x00, 0xF9, 0xC5, 0x02, 0x00, 0x61, 0x5D,
];

/// Colours in the palette of the random octrees.
pub const COLORS: u16 = 3;

/// A voxel and its children: none or eight.
#[derive(Debug, Clone)]
pub struct Tree {
    pub voxel: Voxel,
    pub children: Vec<Tree>,
}

impl Tree {
    pub fn leaf(palette_index: u16) -> Self {
        Self { voxel: Voxel { palette_index, ..Voxel::EMPTY }, children: Vec::new() }
    }

    pub fn node(palette_index: u16, children: [Self; 8]) -> Self {
        Self { children: children.into(), ..Self::leaf(palette_index) }
    }

    /// A chain of nodes down to `depth`, each in the last octant of its parent.
    pub fn chain(depth: u8) -> Self {
        let mut tree = Self::leaf(1);
        for _ in 0..depth {
            let mut children = vec![Self::leaf(0); 7];
            children.push(tree);
            tree = Self { children, ..Self::leaf(1) };
        }
        tree
    }

    pub fn depth(&self) -> u8 {
        self.children.iter().map(|child| child.depth() + 1).max().unwrap_or(0)
    }

    pub fn records(&self) -> Vec<Record> {
        fn visit(tree: &Tree, level: u8, octant: u8, records: &mut Vec<Record>) {
            let has_children = !tree.children.is_empty();
            records.push(Record { level, octant, voxel: tree.voxel, has_children });
            for (octant, child) in (0..).zip(&tree.children) {
                visit(child, level + 1, octant, records);
            }
        }
        let mut records = Vec::new();
        visit(self, 0, 0, &mut records);
        records
    }

    /// The octree that makes sense and is most like this one: a node is filled if and only if a child is, and what is empty
    /// has no normal.
    pub fn made_well(mut self) -> Self {
        self.children = self.children.into_iter().map(Self::made_well).collect();
        if self.children.iter().any(|child| !child.voxel.is_empty()) {
            self.voxel.palette_index = self.voxel.palette_index.max(1);
            return self;
        }
        let is_filled_leaf = self.children.is_empty() && !self.voxel.is_empty();
        Self { children: Vec::new(), voxel: if is_filled_leaf { self.voxel } else { Voxel::EMPTY } }
    }

    /// The octree down to a level.
    pub fn down_to(&self, level: u8) -> Self {
        let children = if level == 0 { &[] } else { self.children.as_slice() };
        Self { voxel: self.voxel, children: children.iter().map(|child| child.down_to(level - 1)).collect() }
    }

    /// The file of version 5 of this octree, which makes sense.
    pub fn file_v5(&self, palette: &Palette, settings: Settings) -> Vec<u8> {
        to_version_5(Cursor::new(self.file(palette)), Vec::new(), |depth| settings.header(depth)).unwrap()
    }

    /// The file of this octree, byte by byte from the description of the format.
    pub fn file(&self, palette: &Palette) -> Vec<u8> {
        fn visit(tree: &Tree, file: &mut Vec<u8>) {
            let flagged_index = tree.voxel.palette_index * 2 + u16::from(!tree.children.is_empty());
            file.extend([(flagged_index % 256) as u8, (flagged_index / 256) as u8]);
            file.extend([tree.voxel.normal.theta, tree.voxel.normal.phi as u8]);
            tree.children.iter().for_each(|child| visit(child, file));
        }
        let colors = palette.colors();
        let mut file = vec![0x4D, 0x42, 0x04, 0x00, (colors.len() % 256) as u8, (colors.len() / 256) as u8];
        colors.iter().for_each(|color| file.extend(color));
        file.extend([0x7C, 0x7C]);
        visit(self, &mut file);
        file
    }
}

/// How a file of version 5 is made.
#[derive(Debug, Clone, Copy)]
pub struct Settings {
    /// As far as the depth allows.
    pub cut_level: u8,
    pub normal_code: NormalCode,
    pub compression: Compression,
}

impl Settings {
    pub const PLAIN: Self =
        Self { cut_level: 2, normal_code: NormalCode::Spherical, compression: Compression::None };

    pub fn header(self, depth: u8) -> Header {
        let Self { cut_level, normal_code, compression } = self;
        Header { cut_level: cut_level.min(depth), normal_code, compression, ..Header::new(depth) }
    }

    /// Every combination with this cut.
    pub fn all(cut_level: u8) -> impl Iterator<Item = Self> {
        let codes = [NormalCode::Spherical, NormalCode::Octahedral];
        codes.into_iter().flat_map(move |normal_code| {
            let compressions = [Compression::None, Compression::Zstandard];
            compressions.map(|compression| Self { cut_level, normal_code, compression })
        })
    }
}

/// Any settings for octrees of up to five levels.
pub fn settings() -> impl Strategy<Value = Settings> {
    let all: Vec<Settings> = (0..=5).flat_map(Settings::all).collect();
    prop::sample::select(all)
}

/// Random octrees as [`trees`], but all make sense.
pub fn well_made_trees() -> impl Strategy<Value = Tree> {
    trees().prop_map(Tree::made_well)
}

pub fn palette() -> Palette {
    Palette::new((0..COLORS as u8).map(|k| [k, 100 + k, 200 + k]).collect()).unwrap()
}

/// Random octrees up to depth 4, well-made or not, with at most some thousand voxels.
pub fn trees() -> impl Strategy<Value = Tree> {
    let voxel = (0..=COLORS, any::<u8>(), any::<i8>()).prop_map(|(palette_index, theta, phi)| Voxel {
        palette_index,
        normal: SphericalNormal { theta, phi },
    });
    let leaf = voxel.clone().prop_map(|voxel| Tree { voxel, children: Vec::new() });
    leaf.prop_recursive(4, 200, 8, move |subtree| {
        (voxel.clone(), prop::collection::vec(subtree, 8))
            .prop_map(|(voxel, children)| Tree { voxel, children })
    })
}

/// Reads a file to its end or its first error.
pub fn read(file: &[u8]) -> Result<(Palette, Vec<Record>), FormatError> {
    let mut reader = Reader::new(file)?;
    let records = reader.by_ref().collect::<Result<_, _>>()?;
    Ok((reader.into_palette(), records))
}

/// Writes records that have been read.
pub fn write(palette: &Palette, records: &[Record]) -> Result<Vec<u8>, FormatError> {
    let mut writer = Writer::new(Vec::new(), palette)?;
    for record in records {
        if record.has_children { writer.node(record.voxel) } else { writer.leaf(record.voxel) }?;
    }
    writer.finish()
}
