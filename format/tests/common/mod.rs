//! What the tests share: the example of the thesis, octrees as plain recursive values, and a plain recursive way to
//! write and read them that shares nothing with the crate.

#![allow(dead_code, reason = "each test uses a part")]

use octvox_format::{FormatError, Palette, Reader, Record, SphericalNormal, Voxel, Writer};
use proptest::prelude::*;

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
