//! The counts of a summary against counts over the octree in memory.

mod common;

use common::{COLORS, FIGURE_17, Tree, palette, trees};
use octvox_format::{Defect, Limits, Reader, Record, Summary, summarize, summarize_with};
use proptest::prelude::*;

fn summary_of(tree: &Tree) -> Summary {
    summarize(Reader::new(&tree.file(&palette())[..]).unwrap()).unwrap()
}

/// Filled cells at the finest level of an octree whose root covers `8^height` of them.
fn filled_cells(tree: &Tree, height: u8) -> u128 {
    if !tree.children.is_empty() {
        return tree.children.iter().map(|child| filled_cells(child, height - 1)).sum();
    }
    if tree.voxel.is_empty() { 0 } else { 8_u128.pow(u32::from(height)) }
}

/// The records, counted from 0, of nodes that make no sense.
fn defects(tree: &Tree, record: &mut u64) -> Vec<u64> {
    let own = *record;
    *record += 1;
    if tree.children.is_empty() {
        return Vec::new();
    }
    let any_filled = tree.children.iter().any(|child| !child.voxel.is_empty());
    let mut found = Vec::new();
    if !any_filled || tree.voxel.is_empty() {
        found.push(own);
    }
    found.extend(tree.children.iter().flat_map(|child| defects(child, record)));
    found
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn counts_agree_with_the_octree(tree in trees()) {
        let summary = summary_of(&tree);
        let records = tree.records();
        let count = |test: &dyn Fn(&Record) -> bool| records.iter().filter(|record| test(record)).count() as u64;

        prop_assert_eq!(summary.depth, tree.depth());
        prop_assert_eq!(summary.resolution(), 2_u32.pow(u32::from(tree.depth())));
        prop_assert_eq!(summary.stored_voxels, count(&|_| true));
        prop_assert_eq!(summary.nodes, count(&|record| record.has_children));
        prop_assert_eq!(summary.leaf_voxels, filled_cells(&tree, tree.depth()));
        prop_assert_eq!(summary.levels.len(), usize::from(tree.depth()) + 1);
        for (level, filled) in (0..).zip(&summary.levels) {
            prop_assert_eq!(*filled, count(&|record| record.level == level && !record.voxel.is_empty()));
        }
        prop_assert_eq!(summary.palette_uses.len(), usize::from(COLORS) + 1);
        for (index, uses) in (0..).zip(&summary.palette_uses) {
            prop_assert_eq!(*uses, count(&|record| record.voxel.palette_index == index));
        }
        prop_assert_eq!(summary.file_bytes, tree.file(&palette()).len() as u64);
    }

    #[test]
    fn defects_agree_with_the_octree(tree in trees()) {
        let summary = summary_of(&tree);
        let expected = defects(&tree, &mut 0);
        prop_assert_eq!(summary.defects, expected.len() as u64);
        prop_assert_eq!(summary.is_valid(), expected.is_empty());
        let header = 8 + 3 * u64::from(COLORS);
        let first_offset = expected.first().map(|record| header + 4 * record);
        prop_assert_eq!(summary.first_defect.map(|defect| defect.offset()), first_offset);
    }
}

#[test]
fn the_example_of_the_thesis_is_valid() {
    let summary = summarize(Reader::new(&FIGURE_17[..]).unwrap()).unwrap();
    let expected = Summary {
        depth: 1,
        stored_voxels: 9,
        nodes: 1,
        leaf_voxels: 8,
        levels: vec![1, 8],
        palette_uses: vec![0, 4, 5],
        file_bytes: 50,
        defects: 0,
        first_defect: None,
    };
    assert_eq!(summary, expected);
}

#[test]
fn every_defect_is_named_and_placed() {
    let header = 8 + 3 * u64::from(COLORS);
    let empty_children = || Tree::node(1, [0; 8].map(Tree::leaf));
    let summary = summary_of(&empty_children());
    assert_eq!(summary.first_defect, Some(Defect::EmptyChildren { offset: header, level: 0 }));

    let mut tree = Tree::node(1, [1, 0, 0, 0, 0, 0, 0, 1].map(Tree::leaf));
    tree.children[6] = Tree::node(0, [0, 0, 1, 0, 0, 0, 0, 0].map(Tree::leaf));
    tree.children[7] = empty_children();
    let summary = summary_of(&tree);
    assert_eq!(summary.first_defect, Some(Defect::EmptyNode { offset: header + 4 * 7, level: 1 }));
    assert_eq!(summary.defects, 2);

    // Both the empty node and its parent, which comes first in the file although it ends later.
    let mut tree = Tree::node(0, [0, 1, 0, 0, 0, 0, 0, 0].map(Tree::leaf));
    tree.children[0] = Tree::node(0, [0; 8].map(Tree::leaf));
    let summary = summary_of(&tree);
    assert_eq!(summary.first_defect, Some(Defect::EmptyNode { offset: header, level: 0 }));
    assert_eq!(summary.defects, 2);
}

#[test]
fn a_large_leaf_counts_all_its_cells() {
    // Filled above by seven large leaves on every level but the finest, where there are eight.
    let mut tree = Tree::chain(Limits::MAX_DEPTH);
    fn fill(tree: &mut Tree) {
        tree.voxel.palette_index = 1;
        tree.children.iter_mut().for_each(fill);
    }
    fill(&mut tree);
    let summary = summary_of(&tree);
    assert_eq!(summary.leaf_voxels, 1 << 69);
    assert_eq!(summary.resolution(), 1 << 23);
    assert!(summary.is_valid());
}

#[test]
fn every_record_is_shown() {
    let mut shown = Vec::new();
    let reader = Reader::new(&FIGURE_17[..]).unwrap();
    let summary = summarize_with(reader, |record| shown.push(*record)).unwrap();
    assert_eq!(shown, common::read(&FIGURE_17).unwrap().1);
    assert_eq!(summary.stored_voxels, 9);
}

#[test]
fn an_error_of_the_file_is_passed_on() {
    let reader = Reader::new(&FIGURE_17[..49]).unwrap();
    assert!(summarize(reader).is_err());
}
