//! The order of nodes in memory: those on the lowest level in the order of the file, and behind them all others level by
//! level.
//!
//! Nodes are complete in the order in which their last cell comes. Left like that, the few nodes above the lowest level
//! would be spread among the many on it, so that rays that end early would touch as much memory as those that do not.

use crate::node::Node;
use std::ops::Range;

/// Reorders the nodes of an octree of some depth and puts in the root, which is not among them. Returns the root's index.
pub(crate) fn sort(nodes: &mut Vec<Node>, root: Node, depth: u8) -> usize {
    let mut upper = vec![root];
    let mut moved: Vec<Range<usize>> = Vec::new();
    let mut parents = 0..1;
    // The root covers one level if the depth is odd.
    let mut level_of_cells = if depth.is_multiple_of(2) { 2 } else { 1 };
    // Parents of nodes on the lowest level are left; none, if the root is a leaf.
    while level_of_cells + 2 < depth {
        let next = upper.len();
        for parent in parents {
            let Some(children) = upper[parent].children() else { continue };
            upper[parent] = upper[parent].with_first_child(upper.len());
            upper.extend_from_slice(&nodes[children.clone()]);
            moved.push(children);
        }
        parents = next..upper.len();
        level_of_cells += 2;
    }
    moved.sort_unstable_by_key(|range| range.start);

    // Both the parents and what has moved are in the order of the file now.
    let mut gaps = moved.iter().peekable();
    let mut missing = 0;
    for parent in &mut upper[parents.clone()] {
        let Some(children) = parent.children() else { continue };
        while let Some(gap) = gaps.next_if(|gap| gap.start < children.start) {
            missing += gap.len();
        }
        *parent = parent.with_first_child(children.start - missing);
    }
    let lowest = remove(nodes, &moved);
    for parent in &mut upper[..parents.start] {
        if let Some(children) = parent.children() {
            *parent = parent.with_first_child(children.start + lowest);
        }
    }
    nodes.extend_from_slice(&upper);
    lowest
}

/// Takes ranges that do not overlap, in ascending order, out of a list, and returns its new length.
fn remove(nodes: &mut Vec<Node>, ranges: &[Range<usize>]) -> usize {
    let mut end = ranges.first().map_or(nodes.len(), |range| range.start);
    for (number, range) in ranges.iter().enumerate() {
        let next = ranges.get(number + 1).map_or(nodes.len(), |range| range.start);
        nodes.copy_within(range.end..next, end);
        end += next - range.end;
    }
    nodes.truncate(end);
    end
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    /// A random octree: nodes in the order in which they are completed, and the root. `level` is that of the cells.
    fn grow(random: &mut Random, level: u8, depth: u8, nodes: &mut Vec<Node>, number: &mut u32) -> Node {
        *number += 1;
        let mask = random.next() & random.next() & random.next() | 1;
        if level == depth {
            return Node::leaf(mask, *number, 0);
        }
        if random.between(0, 8) == 0 {
            return Node::uniform(*number, 0);
        }
        let mask = if level == 1 { mask & 0xFF } else { mask };
        let children: Vec<Node> =
            (0..mask.count_ones()).map(|_| grow(random, level + 2, depth, nodes, number)).collect();
        let first = nodes.len() as u32;
        nodes.extend(children);
        Node::inner(mask, first, *number)
    }

    fn assert_same(a: (&[Node], Node), b: (&[Node], Node)) {
        assert_eq!((a.1.cells(), a.1.lod, a.1.is_leaf()), (b.1.cells(), b.1.lod, b.1.is_leaf()));
        match (a.1.children(), b.1.children()) {
            (Some(of_a), Some(of_b)) => {
                for (child_a, child_b) in of_a.zip(of_b) {
                    assert_same((a.0, a.0[child_a]), (b.0, b.0[child_b]));
                }
            }
            _ => assert_eq!(a.1.first(), b.1.first()),
        }
    }

    #[test]
    fn sorting_leaves_the_octree_as_it_is_and_its_levels_together() {
        for (seed, depth) in [(1, 1), (2, 2), (3, 3), (4, 4), (5, 5), (6, 6), (7, 7), (8, 8), (9, 8)] {
            let mut nodes = Vec::new();
            let level = if depth % 2 == 0 { 2 } else { 1 };
            let root = grow(&mut Random::stream(seed, 0), level, depth, &mut nodes, &mut 0);
            let mut sorted = nodes.clone();
            let place = sort(&mut sorted, root, depth);
            assert_eq!(sorted.len(), nodes.len() + 1);
            assert_same((&nodes, root), (&sorted, sorted[place]));

            // From the root on, each level follows the one above it, and those on the lowest stand before it.
            let mut end = place + 1;
            let mut level_of_cells = level;
            let mut parents = place..end;
            while level_of_cells + 2 < depth {
                let children: Vec<usize> = parents.filter_map(|at| sorted[at].children()).flatten().collect();
                parents = end..end + children.len();
                assert!(children.into_iter().eq(parents.clone()));
                end = parents.end;
                level_of_cells += 2;
            }
            assert_eq!(end, sorted.len());
        }
    }
}
