//! Octrees held against those that are built record by record.

use super::{by_record, level_order};
use crate::payload::{PayloadList, PayloadWord};
use crate::random::Random;
use crate::{LoadError, Octree};
use octvox_format::v5::{self, Compression, Header, Levels, Planes, Subtree};
use octvox_format::{
    FormatError, Limits, Material, MaterialPalette, NormalCode, Outline, Palette, SphericalNormal, Voxel,
    WorldTransform, Writer, to_version_5,
};
use std::io::Cursor;

/// An octree whose cells have children, are filled, or are empty by chance.
struct Forest {
    random: Random,
    depth: u8,
    colors: u16,
    /// Of 8 nodes so many are empty although they have filled children, and all may have empty children only.
    transparent: i32,
}

impl Forest {
    fn new(seed: u64, depth: u8, colors: u16, transparent: i32) -> Self {
        Self { random: Random::stream(seed, 0), depth, colors, transparent }
    }

    fn file(mut self) -> Vec<u8> {
        let palette = Palette::new((0..self.colors).map(|color| [color as u8, 1, 2]).collect()).unwrap();
        let mut writer = Writer::new(Vec::new(), &palette).unwrap();
        for record in self.grow(0) {
            let (voxel, has_children) = Voxel::from_word(record);
            if has_children { writer.node(voxel).unwrap() } else { writer.leaf(voxel).unwrap() }
        }
        writer.finish().unwrap()
    }

    fn chance(&mut self, of_eight: i32) -> bool {
        self.random.between(0, 8) < of_eight
    }

    fn voxel(&mut self) -> Voxel {
        let [theta, phi, low, high, ..] = self.random.next().to_le_bytes();
        let palette_index = 1 + u16::from_le_bytes([low, high]) % self.colors;
        Voxel { palette_index, normal: SphericalNormal { theta, phi: phi as i8 } }
    }

    /// A cell and what is below, in preorder.
    fn grow(&mut self, level: u8) -> Vec<[u8; 4]> {
        let nothing = vec![Voxel::EMPTY.to_word(false)];
        let voxel = self.voxel();
        // Near the root most cells have children, so that there are many subtrees.
        let branches = self.chance(if level < 5 { 5 } else { 3 }) || level == 0;
        if branches && level < self.depth {
            let children: Vec<_> = (0..8).map(|_| self.grow(level + 1)).collect();
            if self.transparent == 0 && children.iter().all(|child| *child == nothing) {
                return nothing;
            }
            let own = if self.chance(self.transparent) { Voxel::EMPTY } else { voxel };
            return [vec![own.to_word(true)], children.concat()].concat();
        }
        let is_filled = if level == self.depth { self.chance(4) } else { self.chance(1) };
        if is_filled { vec![voxel.to_word(false)] } else { nothing }
    }
}

fn words(list: &PayloadList) -> Vec<PayloadWord> {
    (0..list.len() as u32).map(|index| list.get(index)).collect()
}

fn assert_same(octree: &Octree, file: &[u8], what: &str) {
    let depth = Outline::read(file, Limits::MAX_DEPTH).unwrap().depth;
    let expected = by_record::build(file, depth);
    let mut nodes = expected.nodes;
    if let Some(root) = nodes.pop() {
        let place = level_order::sort(&mut nodes, root, octree.depth());
        assert_eq!(octree.root as usize, place, "{what}");
    }
    assert!(octree.nodes == nodes, "{what}");
    let plain = |voxels: &[Voxel]| voxels.iter().map(|voxel| PayloadWord::from(*voxel)).collect::<Vec<_>>();
    assert!(words(&octree.voxels) == plain(&expected.voxels), "{what}");
    assert!(words(&octree.lod) == plain(&expected.lod), "{what}");
}

#[test]
fn version_4_is_as_record_by_record() {
    for (seed, depth, colors) in
        [(1, 9, 1), (2, 8, 200), (3, 7, 300), (4, 6, 5), (5, 5, 5), (6, 3, 5), (7, 1, 5)]
    {
        for transparent in [0, 2, 8] {
            let file = Forest::new(seed, depth, colors, transparent).file();
            let what = format!("seed {seed}, transparent {transparent}");
            for threads in [1, 2, 5] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let octree = pool.install(|| Octree::read(Cursor::new(&file))).unwrap();
                assert_same(&octree, &file, &what);
            }
            assert_same(&Octree::from_bytes(&file).unwrap(), &file, &what);
        }
    }
}

#[test]
fn version_5_is_as_version_4() {
    let cuts =
        [(8, 1), (8, 2), (8, 3), (7, 0), (7, 2), (7, 3), (7, 5), (5, 3), (5, 4), (5, 5), (6, 4), (1, 1)];
    for (depth, cut_level) in cuts {
        // Version 5 has no transparent nodes.
        let older = Forest::new(u64::from(depth), depth, 20, 0).file();
        for compression in [Compression::None, Compression::Zstandard] {
            let normal_code = NormalCode::Spherical;
            let header = |depth| Header { cut_level, compression, normal_code, ..Header::new(depth) };
            let newer = to_version_5(Cursor::new(&older), Vec::new(), header).unwrap();
            let octree = Octree::read(Cursor::new(&newer)).unwrap();
            assert_same(&octree, &older, &format!("depth {depth}, cut at {cut_level}"));
        }
    }
}

#[test]
fn version_5_keeps_its_normals_and_its_place() {
    let older = Forest::new(1, 7, 3, 0).file();
    let world = Some(WorldTransform { origin: [1.0, 2.0, 3.0], voxel_size: 0.5 });
    let newer = to_version_5(Cursor::new(&older), Vec::new(), |depth| Header { world, ..Header::new(depth) })
        .unwrap();
    let [older, newer] = [older, newer].map(|file| Octree::from_bytes(&file).unwrap());
    assert_eq!((older.world(), newer.world()), (None, world));
    assert_eq!((older.leaf_voxels(), older.bounds()), (newer.leaf_voxels(), newer.bounds()));
    let size = older.resolution();
    for cell in 0..size.pow(2) {
        let cell = [cell % size, cell / size, cell % 97];
        match (older.voxel(cell), newer.voxel(cell)) {
            (Some(older), Some(newer)) => {
                assert_eq!(older.palette_index(), newer.palette_index());
                let normal = NormalCode::Octahedral.encode(older.normal().decode());
                assert_eq!(newer.normal().bytes, normal);
            }
            (None, None) => {}
            other => panic!("{cell:?}: {other:?}"),
        }
    }
}

/// The octree of a file that is one subtree.
fn octree_of(depth: u8, planes: Planes) -> Octree {
    let materials = MaterialPalette::new(vec![Material::matte([1, 2, 3])]).unwrap();
    let header = Header { cut_level: 0, ..Header::new(depth) };
    let mut writer = v5::Writer::new(Vec::new(), &header, &materials).unwrap();
    let subtree = Subtree { code: 0, levels: Levels::subtree(0, depth, planes).unwrap() };
    writer.subtree(&writer.encoder().encode(&subtree).unwrap()).unwrap();
    let file = writer.finish(&Levels::top(0, Planes::default()).unwrap()).unwrap();
    Octree::from_bytes(&file).unwrap()
}

#[test]
fn a_solid_cube_of_any_depth_is_filled() {
    let normal = [0, 0];
    for depth in 0..6 {
        let planes = Planes {
            masks: vec![0; usize::from(depth > 0)],
            palette_indices: vec![1],
            normals: vec![normal],
        };
        let octree = octree_of(depth, planes);
        let size = octree.resolution();
        assert_eq!(octree.leaf_voxels(), u64::from(size).pow(3));
        assert_eq!(octree.bounds().high, [size; 3]);
        assert!(octree.is_filled([size - 1, 0, size / 2]));
    }
}

/// All but one of eight children are solid, and so on down to the finest level: 2^66 filled cells in all.
#[test]
fn more_cells_than_can_be_counted() {
    let depth = crate::octree::MAX_DEPTH;
    let below = std::iter::repeat_n([0, 0, 0, 0, 0, 0, 0, 0xFF], usize::from(depth) - 1);
    let masks: Vec<u8> = std::iter::once(0xFF).chain(below.flatten()).collect();
    let voxels = masks.len() + 8;
    let planes = Planes { masks, palette_indices: vec![1; voxels], normals: vec![[0, 0]; voxels] };
    let octree = octree_of(depth, planes);
    assert_eq!(octree.leaf_voxels(), u64::MAX);
    assert_eq!(octree.bounds().high, [octree.resolution(); 3]);
}

#[test]
fn an_error_in_a_subtree_is_that_of_the_reader() {
    let file = Forest::new(1, 8, 3, 0).file();
    for place in (17 + 4..file.len()).step_by(4 * 1009) {
        let place = 17 + (place - 17) / 4 * 4;
        let mut damaged = file.clone();
        damaged[place + 1] = 0xFF;
        let Err(LoadError::Format(error)) = Octree::from_bytes(&damaged) else { panic!("byte {place}") };
        assert!(
            matches!(error, FormatError::PaletteIndexOutOfRange { offset, .. } if offset == place as u64),
            "{error}"
        );
    }
}
