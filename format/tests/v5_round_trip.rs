//! Version 5: what is written is what is read, whichever way.

mod common;

use common::plain_v5::parse;
use common::{Settings, Tree, palette, settings, well_made_trees};
use octvox_format::v5::{Archive, Header, Reader, Region, Seekable, Subtree, Writer, cell_of_code};
use octvox_format::{
    AnyReader, FormatError, Limits, MaterialPalette, NormalCode, Record, SphericalNormal, WorldTransform,
    rewrite_version_5, summarize, to_version_4, to_version_5,
};
use proptest::prelude::*;
use rayon::prelude::*;
use std::io::Cursor;

fn records(archive: &Archive<&[u8]>) -> Vec<Record> {
    archive.records().collect::<Result<_, _>>().unwrap()
}

/// The octree with normals in the code of a file, and as a reader of records returns them.
fn recoded(tree: &Tree, code: NormalCode, back: bool) -> Tree {
    let mut tree = tree.clone();
    if !tree.voxel.is_empty() && code == NormalCode::Octahedral {
        let normal = code.encode(tree.voxel.normal.decode());
        tree.voxel.normal = if back {
            SphericalNormal::encode(code.decode(normal))
        } else {
            SphericalNormal::from_bytes(normal)
        };
    }
    tree.children = tree.children.iter().map(|child| recoded(child, code, back)).collect();
    tree
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn the_file_is_as_described(tree in well_made_trees(), settings in settings()) {
        let plain = parse(&tree.file_v5(&palette(), settings));
        prop_assert_eq!(plain.depth, tree.depth());
        prop_assert_eq!(plain.cut_level, settings.cut_level.min(tree.depth()));
        prop_assert_eq!(plain.normal_code, settings.normal_code as u8);
        prop_assert_eq!(plain.compression, settings.compression as u8);
        let expected = recoded(&tree, settings.normal_code, false);
        prop_assert_eq!(plain.tree().records(), expected.records());
    }

    #[test]
    fn records_are_those_of_version_4(tree in well_made_trees(), settings in settings()) {
        let file = tree.file_v5(&palette(), settings);
        let expected = recoded(&tree, settings.normal_code, true).records();
        prop_assert_eq!(records(&Archive::of_bytes(&file).unwrap()), expected.clone());
        let any = AnyReader::new(Cursor::new(&file)).unwrap().records().unwrap();
        prop_assert_eq!(any.collect::<Result<Vec<_>, _>>().unwrap(), expected);
    }

    #[test]
    fn version_4_comes_back_byte_by_byte(tree in well_made_trees(), settings in settings()) {
        let settings = Settings { normal_code: NormalCode::Spherical, ..settings };
        let file = tree.file_v5(&palette(), settings);
        let back = to_version_4(&Archive::of_bytes(&file).unwrap(), Vec::new()).unwrap();
        prop_assert_eq!(back, tree.file(&palette()));
    }

    #[test]
    fn a_stream_and_an_archive_are_the_same(tree in well_made_trees(), settings in settings()) {
        let file = tree.file_v5(&palette(), settings);
        let archive = Archive::of_bytes(&file).unwrap();
        let searched = Archive::with_limits(Seekable::new(Cursor::new(&file)), Limits::default()).unwrap();
        let mut reader = Reader::new(&file[..]).unwrap();
        prop_assert_eq!(reader.header(), archive.header());
        prop_assert_eq!(reader.materials(), archive.materials());
        let decoder = reader.decoder();
        let mut streamed = Vec::new();
        while let Some(stored) = reader.next_subtree().unwrap() {
            prop_assert_eq!(stored.offset(), archive.index().subtrees[streamed.len()].offset);
            streamed.push(decoder.decode(&stored).unwrap());
        }
        let ending = reader.finish().unwrap();
        prop_assert_eq!(&ending.top, archive.top());
        prop_assert_eq!(&ending.index, archive.index());
        prop_assert_eq!(ending.file_bytes, file.len() as u64);
        let all = |number| archive.subtree(number).unwrap();
        prop_assert_eq!(&streamed, &(0..archive.subtree_count()).map(all).collect::<Vec<_>>());
        let parallel: Vec<Subtree> =
            (0..searched.subtree_count()).into_par_iter().map(|number| searched.subtree(number).unwrap()).collect();
        prop_assert_eq!(parallel, streamed);
    }

    #[test]
    fn written_again_it_is_the_same_file(tree in well_made_trees(), settings in settings()) {
        let file = tree.file_v5(&palette(), settings);
        let archive = Archive::of_bytes(&file).unwrap();
        let mut writer = Writer::new(Vec::new(), archive.header(), archive.materials()).unwrap();
        let encoder = writer.encoder();
        let encoded: Vec<_> = (0..archive.subtree_count())
            .into_par_iter()
            .map(|number| encoder.encode(&archive.subtree(number).unwrap()).unwrap())
            .collect();
        encoded.iter().for_each(|subtree| writer.subtree(subtree).unwrap());
        prop_assert_eq!(writer.finish(archive.top()).unwrap(), file);
    }

    #[test]
    fn rewritten_it_is_the_file_that_was_asked_for(tree in well_made_trees(), from in settings(), to in settings(), level in 0_u8..6) {
        let normal_code = from.normal_code;
        let file = tree.file_v5(&palette(), from);
        let shallow = tree.down_to(level);
        let header = Settings { normal_code, ..to }.header(shallow.depth());
        let rewritten = rewrite_version_5(&Archive::of_bytes(&file).unwrap(), Vec::new(), &header).unwrap();
        // Normals stay as they are, which they would not through the spherical code.
        prop_assert_eq!(rewritten, shallow.file_v5(&palette(), Settings { normal_code, ..to }));
    }

    #[test]
    fn both_versions_have_the_same_records_down_to_a_level(tree in well_made_trees(), level in 0_u8..6) {
        let expected = tree.down_to(level).records();
        for file in [tree.file(&palette()), tree.file_v5(&palette(), Settings::PLAIN)] {
            let records = AnyReader::new(Cursor::new(&file)).unwrap().records_down_to(level).unwrap();
            prop_assert_eq!(&records.collect::<Result<Vec<_>, _>>().unwrap(), &expected);
        }
    }

    #[test]
    fn down_to_a_level_is_the_octree_of_that_depth(tree in well_made_trees(), settings in settings(), level in 0_u8..6) {
        let file = tree.file_v5(&palette(), settings);
        let archive = Archive::of_bytes(&file).unwrap();
        let found: Vec<Record> = archive.records_down_to(level).collect::<Result<_, _>>().unwrap();
        prop_assert_eq!(found, recoded(&tree, settings.normal_code, true).down_to(level).records());
        // The levels that are left out of memory, and those left out when reading.
        for number in 0..archive.subtree_count() {
            let whole = archive.subtree(number).unwrap();
            prop_assert_eq!(archive.subtree_down_to(number, level).unwrap().levels, whole.levels.down_to(level));
        }
    }

    #[test]
    fn a_region_has_the_subtrees_that_meet_it(
        tree in well_made_trees(),
        settings in settings(),
        corners in prop::array::uniform2(prop::array::uniform3(0_u32..18)),
    ) {
        let file = tree.file_v5(&palette(), settings);
        let archive = Archive::of_bytes(&file).unwrap();
        let region = Region { low: corners[0], high: corners[1] };
        let found: Vec<usize> = archive.subtrees_in(region).collect();
        // Cell by cell.
        let side = 1 << (archive.header().depth - archive.header().cut_level);
        let is_met = |number: &usize| {
            let corner = cell_of_code(archive.index().subtrees[*number].code).map(|coordinate| coordinate * side);
            (0..3).all(|axis| {
                (corner[axis]..corner[axis] + side).any(|cell| (region.low[axis]..region.high[axis]).contains(&cell))
            })
        };
        prop_assert_eq!(found, (0..archive.subtree_count()).filter(is_met).collect::<Vec<_>>());
    }

    #[test]
    fn summaries_agree(tree in well_made_trees(), settings in settings()) {
        let old = summarize(octvox_format::Reader::new(&tree.file(&palette())[..]).unwrap()).unwrap();
        let file = tree.file_v5(&palette(), settings);
        let new = AnyReader::new(&file[..]).unwrap().summarize().unwrap();
        prop_assert_eq!(new.depth, old.depth);
        prop_assert_eq!(new.nodes, old.nodes);
        prop_assert_eq!(new.leaf_voxels, old.leaf_voxels);
        prop_assert_eq!(&new.levels, &old.levels);
        prop_assert_eq!(&new.palette_uses[1..], &old.palette_uses[1..]);
        prop_assert_eq!(new.palette_uses[0], 0);
        prop_assert_eq!(new.stored_voxels, old.levels.iter().sum::<u64>());
        prop_assert_eq!(new.file_bytes, file.len() as u64);
        prop_assert!(new.is_valid());
    }
}

#[test]
fn any_reader_reads_both_versions() {
    let tree = Tree::chain(3);
    let files = [tree.file(&palette()), tree.file_v5(&palette(), Settings::PLAIN)];
    for (file, version) in files.iter().zip([4, 5]) {
        let reader = AnyReader::new(Cursor::new(file)).unwrap();
        assert_eq!(reader.version(), version);
        assert_eq!(reader.materials(), MaterialPalette::from(&palette()));
        assert_eq!(reader.world(), None);
        assert_eq!(AnyReader::new(&file[..]).unwrap().summarize().unwrap().leaf_voxels, 1);
        let records: Vec<Record> = reader.records().unwrap().collect::<Result<_, _>>().unwrap();
        assert_eq!(records, tree.records());
    }
}

#[test]
fn the_header_comes_back() {
    let world = WorldTransform { origin: [-1.5, 0.0, 1e300], voxel_size: 5e-324 };
    let file = to_version_5(Cursor::new(Tree::chain(2).file(&palette())), Vec::new(), |depth| Header {
        world: Some(world),
        writer: "Zeichenstift 2 — für alle Fälle: 44 Byte".to_owned(),
        ..Header::new(depth)
    })
    .unwrap();
    let archive = Archive::of_bytes(&file).unwrap();
    assert_eq!(archive.header().world, Some(world));
    assert_eq!(archive.header().writer, "Zeichenstift 2 — für alle Fälle: 44 Byte");
    let plain = parse(&file);
    assert_eq!((plain.origin, plain.voxel_size), (world.origin, world.voxel_size));
    assert_eq!(plain.writer, archive.header().writer);
}

#[test]
fn a_header_for_fewer_levels_has_larger_cells() {
    let world = Some(WorldTransform { origin: [1.0, 2.0, 3.0], voxel_size: 0.25 });
    let header = Header { world, ..Header::new(10) };
    let coarse = header.down_to(8);
    assert_eq!((coarse.depth, coarse.cut_level, coarse.resolution()), (8, 1, 256));
    assert_eq!(coarse.world, Some(WorldTransform { origin: [1.0, 2.0, 3.0], voxel_size: 1.0 }));
    assert_eq!(header.down_to(12), header);
}

#[test]
fn the_octree_may_be_shallower_than_the_file() {
    // Pruned to a single voxel, which fills the cube.
    for (tree, leaf_voxels) in [(Tree::leaf(2), 1 << 30), (Tree::leaf(0), 0)] {
        for cut_level in [0, 1, 7, 10] {
            let header = |_| Header { cut_level, ..Header::new(10) };
            let file = to_version_5(Cursor::new(tree.file(&palette())), Vec::new(), header).unwrap();
            assert_eq!(parse(&file).tree().records(), tree.records());
            let archive = Archive::of_bytes(&file).unwrap();
            assert_eq!(archive.header().resolution(), 1024);
            assert_eq!(records(&archive), tree.records());
            assert_eq!(AnyReader::new(&file[..]).unwrap().summarize().unwrap().leaf_voxels, leaf_voxels);
        }
    }
}

#[test]
fn an_octree_is_cut_off_where_the_header_ends() {
    let tree = Tree::chain(3);
    let file = to_version_5(Cursor::new(tree.file(&palette())), Vec::new(), |_| Header::new(2)).unwrap();
    assert_eq!(parse(&file).tree().records(), tree.down_to(2).records());
}

#[test]
fn the_deepest_octree_goes_through() {
    let tree = Tree::chain(Limits::MAX_DEPTH);
    for cut_level in [0, 1, 11, Header::MAX_CUT_LEVEL] {
        for settings in Settings::all(cut_level) {
            let file = tree.file_v5(&palette(), settings);
            assert_eq!(parse(&file).tree().depth(), 23);
            let archive = Archive::of_bytes(&file).unwrap();
            assert_eq!(archive.index().subtrees[0].code, (1 << (3 * cut_level)) - 1);
            assert_eq!(records(&archive).len(), tree.records().len());
        }
    }
}

#[test]
fn an_octree_that_makes_no_sense_is_not_converted() {
    for tree in
        [Tree::node(0, [0, 0, 0, 3, 0, 0, 0, 0].map(Tree::leaf)), Tree::node(1, [0; 8].map(Tree::leaf))]
    {
        let result = to_version_5(Cursor::new(tree.file(&palette())), Vec::new(), Header::new);
        assert!(matches!(result, Err(FormatError::Senseless(_))));
    }
}
