//! MagicaVoxel's files: what is read is what is in them, what is written can be read, by another reader too.

mod common;

use common::{Tree, palette, well_made_trees};
use octvox_format::exchange::magicavoxel::{export, import, is_magicavoxel};
use octvox_format::exchange::{ExchangeError, Leaf, Leaves};
use octvox_format::v5::{Archive, summarize};
use octvox_format::{AnyReader, FormatError, Material, MaterialPalette, Palette};
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::io::Cursor;

/// A chunk without children, from the description of the format.
fn chunk(kind: &[u8; 4], content: &[u8]) -> Vec<u8> {
    [&kind[..], &(content.len() as u32).to_le_bytes(), &[0; 4], content].concat()
}

fn file(chunks: &[Vec<u8>]) -> Vec<u8> {
    let children = chunks.concat();
    let length = (children.len() as u32).to_le_bytes();
    [b"VOX \x96\0\0\0MAIN\0\0\0\0", &length[..], &children].concat()
}

fn model(size: [u32; 3], voxels: &[[u8; 4]]) -> Vec<u8> {
    let size = chunk(b"SIZE", size.map(u32::to_le_bytes).as_flattened());
    let voxels = [&(voxels.len() as u32).to_le_bytes(), voxels.as_flattened()].concat();
    [size, chunk(b"XYZI", &voxels)].concat()
}

fn colors(colors: &[[u8; 3]]) -> Vec<u8> {
    let mut content: Vec<u8> = colors.iter().flat_map(|[r, g, b]| [*r, *g, *b, 255]).collect();
    content.resize(1024, 0);
    chunk(b"RGBA", &content)
}

fn text(text: &str) -> Vec<u8> {
    [&(text.len() as u32).to_le_bytes()[..], text.as_bytes()].concat()
}

fn dictionary(entries: &[(&str, &str)]) -> Vec<u8> {
    let texts = entries.iter().flat_map(|(key, value)| [text(key), text(value)]);
    [&(entries.len() as u32).to_le_bytes()[..], &texts.collect::<Vec<_>>().concat()].concat()
}

fn words(words: &[u32]) -> Vec<u8> {
    words.iter().flat_map(|word| word.to_le_bytes()).collect()
}

fn transform(
    node: u32,
    child: u32,
    layer: u32,
    attributes: &[(&str, &str)],
    frame: &[(&str, &str)],
) -> Vec<u8> {
    let content =
        [words(&[node]), dictionary(attributes), words(&[child, u32::MAX, layer, 1]), dictionary(frame)];
    chunk(b"nTRN", &content.concat())
}

fn group(node: u32, children: &[u32]) -> Vec<u8> {
    let count = children.len() as u32;
    chunk(b"nGRP", &[words(&[node]), dictionary(&[]), words(&[count]), words(children)].concat())
}

fn shape(node: u32, model: u32) -> Vec<u8> {
    chunk(b"nSHP", &[words(&[node]), dictionary(&[]), words(&[1, model]), dictionary(&[])].concat())
}

/// Where in the world a file has voxels, in its own cells, and of which colour.
fn voxels(file: &[u8]) -> BTreeMap<[i64; 3], [u8; 3]> {
    let archive = Archive::of_bytes(file).unwrap();
    let world = archive.header().world.unwrap();
    assert_eq!(world.voxel_size, 1.0);
    let depth = archive.header().depth;
    let mut voxels = BTreeMap::new();
    for leaf in Leaves::new(archive.records()) {
        let leaf = leaf.unwrap();
        let (corner, side) = leaf.cube(depth);
        assert_eq!(side, 1);
        let cell = std::array::from_fn(|axis| i64::from(corner[axis]) + world.origin[axis] as i64);
        let color = archive.materials().material(leaf.voxel.palette_index).unwrap().diffuse;
        assert!(voxels.insert(cell, color).is_none());
    }
    let (summary, _) = summarize(octvox_format::v5::Reader::new(file).unwrap()).unwrap();
    assert_eq!(summary.leaf_voxels, voxels.len() as u128);
    voxels
}

const RED: [u8; 3] = [250, 0, 0];
const BLUE: [u8; 3] = [0, 0, 250];

#[test]
fn a_model_without_a_scene_is_at_the_origin() {
    let file = file(&[model([2, 3, 4], &[[0, 0, 0, 1], [1, 2, 3, 2]]), colors(&[RED, BLUE])]);
    assert!(is_magicavoxel(&file));
    // y becomes −z: the cell from 2 to 3 that from −3 to −2.
    let expected = BTreeMap::from([([0, 0, -1], RED), ([1, 3, -3], BLUE)]);
    assert_eq!(voxels(&import(&file).unwrap()), expected);
}

#[test]
fn models_are_turned_and_moved() {
    // One model, twice: moved by (10, 20, 30), and turned so that x becomes y and y becomes −x.
    let turned = (1_u8 | 1 << 4).to_string();
    let file = file(&[
        model([3, 2, 1], &[[2, 0, 0, 1]]),
        transform(0, 1, 0, &[], &[]),
        group(1, &[2, 4]),
        transform(2, 3, 0, &[], &[("_t", "10 20 30")]),
        shape(3, 0),
        transform(4, 5, 0, &[], &[("_r", &turned)]),
        shape(5, 0),
        colors(&[RED]),
    ]);
    // The middle of the model is between 1 and 2 along x at 1, along y at 1, along z at 0; the voxel's from it is
    // (1.5, −0.5, 0.5), and turned (0.5, 1.5, 0.5).
    let places = [[11, 19, 30], [0, 1, 0]].map(|[x, y, z]: [i64; 3]| ([x, z, -y - 1], RED));
    assert_eq!(voxels(&import(&file).unwrap()), BTreeMap::from(places));
}

#[test]
fn what_is_hidden_is_left_out() {
    let file = file(&[
        model([1, 1, 1], &[[0, 0, 0, 1]]),
        transform(0, 1, 0, &[], &[]),
        group(1, &[2, 4, 6]),
        transform(2, 7, 0, &[("_hidden", "1")], &[("_t", "1 0 0")]),
        transform(4, 7, 3, &[], &[("_t", "2 0 0")]),
        transform(6, 7, 1, &[], &[("_t", "3 0 0")]),
        shape(7, 0),
        chunk(b"LAYR", &[words(&[3]), dictionary(&[("_hidden", "1")]), words(&[u32::MAX])].concat()),
        colors(&[RED]),
    ]);
    assert_eq!(voxels(&import(&file).unwrap()), BTreeMap::from([([3, 0, -1], RED)]));
}

#[test]
fn of_several_voxels_in_a_cell_the_last_counts() {
    let file = file(&[model([1, 1, 1], &[[0, 0, 0, 1], [0, 0, 0, 2]]), colors(&[RED, BLUE])]);
    let imported = import(&file).unwrap();
    assert_eq!(voxels(&imported).into_values().collect::<Vec<_>>(), [BLUE]);
    assert_eq!(Archive::of_bytes(&imported).unwrap().materials().len(), 1);
}

#[test]
fn materials_are_read_and_the_default_palette_is_known() {
    let glass = [words(&[2]), dictionary(&[("_type", "_glass"), ("_trans", "1"), ("_ior", "0.25")])].concat();
    let file = file(&[model([2, 1, 1], &[[0, 0, 0, 1], [1, 0, 0, 2]]), chunk(b"MATL", &glass)]);
    let imported = import(&file).unwrap();
    let archive = Archive::of_bytes(&imported).unwrap();
    let expected = [
        Material::matte([255, 255, 255]),
        Material { transparency: 255, refraction_index: 1.25, ..Material::matte([255, 255, 204]) },
    ];
    assert_eq!(archive.materials().materials(), expected);
    let all: Vec<[u8; 4]> = (0..255).map(|x| [x, 0, 0, x + 1]).collect();
    let all = crate::file(&[model([256, 1, 1], &all)]);
    let found: Vec<[u8; 3]> = voxels(&import(&all).unwrap()).into_values().collect();
    let expected = dot_vox::DEFAULT_PALETTE[..255].iter().map(|color| [color.r, color.g, color.b]);
    assert!(expected.eq(found));
}

#[test]
fn damaged_files_say_where() {
    let error = |file: &[u8]| match import(file) {
        Err(FormatError::Exchange(error)) => error,
        other => panic!("{other:?}"),
    };
    assert!(matches!(error(b"VOX"), ExchangeError::NotMagicaVoxel { .. }));
    assert!(matches!(error(b"VOX \x96\0\0\0"), ExchangeError::Truncated { offset: 8, .. }));
    assert!(matches!(error(&file(&[])), ExchangeError::Nothing));
    let outside = file(&[model([1, 1, 1], &[[0, 0, 0, 1], [0, 1, 0, 1]])]);
    assert!(matches!(error(&outside), ExchangeError::DamagedField { offset: 64, field: "voxel", .. }));
    let no_color = file(&[model([1, 1, 1], &[[0, 0, 0, 0]])]);
    assert!(matches!(error(&no_color), ExchangeError::DamagedField { field: "voxel", .. }));
    let flat = file(&[model([1, 0, 1], &[])]);
    assert!(matches!(error(&flat), ExchangeError::DamagedField { offset: 32, .. }));
    let many = file(&[chunk(b"SIZE", &words(&[1, 1, 1])), chunk(b"XYZI", &words(&[u32::MAX]))]);
    assert!(matches!(error(&many), ExchangeError::Truncated { part: "voxels of a model", .. }));
    let far = |place: &str| {
        file(&[
            model([1, 1, 1], &[[0, 0, 0, 1]]),
            transform(0, 1, 0, &[], &[]),
            group(1, &[2, 3]),
            transform(2, 4, 0, &[], &[("_t", "0 0 0")]),
            transform(3, 4, 0, &[], &[("_t", place)]),
            shape(4, 0),
        ])
    };
    assert!(matches!(
        error(&far("0 2000000000 0")),
        ExchangeError::SceneTooLong { extent: 2_000_000_001, .. }
    ));
    assert!(matches!(
        error(&far("0 3000000000 0")),
        ExchangeError::DamagedField { field: "translation", .. }
    ));
    assert!(import(&far("0 2097151 0")).is_ok());
    // A chain of groups that doubles with each.
    let mut chunks = vec![model([1, 1, 1], &[[0, 0, 0, 1]])];
    chunks.extend((0..40).map(|node| group(node, &[node + 1, node + 1])));
    assert!(matches!(error(&file(&chunks)), ExchangeError::SceneTooLarge { what: "nodes", .. }));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn changed_bytes_do_no_harm(changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..5), cut in any::<prop::sample::Index>()) {
        let mut file = file(&[
            model([3, 2, 1], &[[2, 0, 0, 1]]),
            transform(0, 1, 0, &[], &[("_r", "17"), ("_t", "1 2 3")]),
            shape(1, 0),
        ]);
        let length = file.len();
        prop_assert!(import(&file[..cut.index(length)]).is_err());
        changes.iter().for_each(|(place, byte)| file[place.index(length)] = *byte);
        if let Ok(imported) = import(&file) {
            prop_assert!(AnyReader::new(&imported[..]).and_then(AnyReader::summarize).is_ok());
        }
    }
}

fn leaves(tree: &Tree, palette: &Palette) -> impl Iterator<Item = Result<Leaf, FormatError>> {
    Leaves::new(AnyReader::new(Cursor::new(tree.file(palette))).unwrap().records().unwrap())
}

/// The filled cells of an octree, with the corner of their box at the origin.
fn cells(tree: &Tree, depth: u8) -> BTreeMap<[i64; 3], [u8; 3]> {
    let mut cells = BTreeMap::new();
    for leaf in leaves(tree, &palette()) {
        let leaf = leaf.unwrap();
        let (corner, side) = leaf.cube(depth);
        for place in 0..side.pow(3) {
            let inside = [place % side, place / side % side, place / side / side];
            let cell = std::array::from_fn(|axis| i64::from(corner[axis] + inside[axis]));
            cells.insert(cell, palette().color(leaf.voxel.palette_index).unwrap());
        }
    }
    from_the_origin(cells)
}

fn from_the_origin(cells: BTreeMap<[i64; 3], [u8; 3]>) -> BTreeMap<[i64; 3], [u8; 3]> {
    let low: [i64; 3] = std::array::from_fn(|axis| cells.keys().map(|cell| cell[axis]).min().unwrap_or(0));
    cells
        .into_iter()
        .map(|(cell, color)| (std::array::from_fn(|axis| cell[axis] - low[axis]), color))
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn what_is_exported_can_be_imported(tree in well_made_trees()) {
        let depth = tree.depth();
        let file = export(leaves(&tree, &palette()), depth, &MaterialPalette::from(&palette()), Vec::new()).unwrap();
        let expected = cells(&tree, depth);
        if expected.is_empty() {
            prop_assert!(matches!(import(&file), Err(FormatError::Exchange(ExchangeError::Nothing))));
        } else {
            prop_assert_eq!(from_the_origin(voxels(&import(&file).unwrap())), expected);
        }
    }

    #[test]
    fn another_reader_finds_the_same(tree in well_made_trees()) {
        let depth = tree.depth();
        let file = export(leaves(&tree, &palette()), depth, &MaterialPalette::from(&palette()), Vec::new()).unwrap();
        let scene = dot_vox::load_bytes(&file).unwrap();
        // At most 256³, so there is one model, or none.
        let mut found = BTreeMap::new();
        for voxel in scene.models.iter().flat_map(|model| &model.voxels) {
            let color = scene.palette[usize::from(voxel.i)];
            let cell = [i64::from(voxel.x), i64::from(voxel.z), -i64::from(voxel.y)];
            found.insert(cell, [color.r, color.g, color.b]);
        }
        prop_assert_eq!(from_the_origin(found), cells(&tree, depth));
    }
}

#[test]
fn large_octrees_become_several_models() {
    // Two cells in opposite corners of 512³.
    let mut tree = Tree::chain(9);
    let mut first = Tree::leaf(2);
    for _ in 0..8 {
        let mut children = vec![first];
        children.extend((1..8).map(|_| Tree::leaf(0)));
        first = Tree { children, ..Tree::leaf(1) };
    }
    tree.children[0] = first;
    let file = export(leaves(&tree, &palette()), 9, &MaterialPalette::from(&palette()), Vec::new()).unwrap();
    let scene = dot_vox::load_bytes(&file).unwrap();
    assert_eq!(scene.models.len(), 2);
    let found = from_the_origin(voxels(&import(&file).unwrap()));
    assert_eq!(found, cells(&tree, 9));
    assert_eq!(found.keys().copied().collect::<Vec<_>>(), [[0; 3], [511; 3]]);
}

#[test]
fn an_octree_that_is_too_fine_is_refused() {
    let refused = |tree: &Tree, depth| {
        let result = export(leaves(tree, &palette()), depth, &MaterialPalette::from(&palette()), Vec::new());
        matches!(result, Err(FormatError::Exchange(ExchangeError::TooFineForMagicaVoxel { .. })))
    };
    assert!(refused(&Tree::chain(12), 12));
    assert!(refused(&Tree::leaf(1), 11));
    assert!(!refused(&Tree::chain(11), 11));
}

#[test]
fn the_smallest_file_is_as_described() {
    let tree = Tree::node(1, [0, 3, 0, 0, 0, 0, 0, 1].map(Tree::leaf));
    let written =
        export(leaves(&tree, &palette()), 1, &MaterialPalette::from(&palette()), Vec::new()).unwrap();
    let [first, _, third] = [1, 2, 3].map(|index| palette().color(index).unwrap());
    let expected = file(&[
        // Octants 1 and 7: (1, 0, 0) and (1, 1, 1), of which z becomes 1 − y.
        model([2, 2, 2], &[[1, 1, 0, 2], [1, 0, 1, 1]]),
        transform(0, 1, 0, &[], &[]),
        group(1, &[2]),
        transform(2, 3, 0, &[], &[("_t", "0 0 1")]),
        shape(3, 0),
        colors(&[first, third]),
    ]);
    assert_eq!(written, expected);
}
