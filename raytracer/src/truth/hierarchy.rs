//! A binary hierarchy of boxes, which leaves out triangles that a ray certainly misses.

use glam::DVec3;

/// A box of the hierarchy, with its first child behind it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Node {
    pub bounds: Bounds,
    /// How far behind a node its second child is, or where the triangles of a leaf begin.
    pub next: usize,
    /// Triangles of a leaf; zero in a node with children.
    pub count: usize,
}

/// A leaf has no more triangles than this.
const LEAF: usize = 4;

/// Planes at which a box may be cut, and one more.
const BINS: usize = 16;

/// From so many triangles on, the two halves of a node are built at the same time.
const WORTH_A_TASK: usize = 4096;

/// The hierarchy over some triangles, the root first; empty if there are none. Sorts the triangles, which are given by
/// their boxes and numbers, so that those of a leaf are side by side.
pub(super) fn hierarchy(triangles: &mut [(Bounds, usize)]) -> Vec<Node> {
    let mut nodes = Vec::with_capacity(triangles.len() / 2 + 1);
    if !triangles.is_empty() {
        append(&mut nodes, triangles, 0);
    }
    nodes
}

/// Puts the node of some triangles, and all below it, behind the nodes there are; `first` triangles are before them.
/// Children are told relative to their parents, so it does not matter what stands before.
fn append(nodes: &mut Vec<Node>, triangles: &mut [(Bounds, usize)], first: usize) {
    let node = nodes.len();
    let bounds = union(triangles);
    nodes.push(Node { bounds, next: first, count: triangles.len() });
    if triangles.len() <= LEAF {
        return;
    }
    let is_large = triangles.len() >= WORTH_A_TASK;
    let middle = split(triangles);
    let (below, above) = triangles.split_at_mut(middle);
    let behind = first + below.len();
    if is_large {
        let apart = |triangles: &mut [(Bounds, usize)], first| {
            let mut nodes = Vec::with_capacity(triangles.len() / 2 + 1);
            append(&mut nodes, triangles, first);
            nodes
        };
        let (below, above) = rayon::join(|| apart(below, first), || apart(above, behind));
        nodes[node] = Node { bounds, next: 1 + below.len(), count: 0 };
        nodes.extend(below);
        nodes.extend(above);
    } else {
        append(nodes, below, first);
        nodes[node] = Node { bounds, next: nodes.len() - node, count: 0 };
        append(nodes, above, behind);
    }
}

/// Sorts triangles so that the first few of them are better in a box of their own, by the surface area heuristic along the
/// axis on which their middles are farthest apart; returns how many.
fn split(triangles: &mut [(Bounds, usize)]) -> usize {
    let twice_middle = |bounds: &Bounds| bounds.low + bounds.high;
    let Bounds { low, high } = Bounds::around(triangles.iter().map(|(bounds, _)| twice_middle(bounds)));
    let axis = (high - low).max_position();
    let scale = BINS as f64 / (high - low)[axis];
    let bin = |bounds: &Bounds| (((twice_middle(bounds) - low)[axis] * scale) as usize).min(BINS - 1);
    let mut bins = [(Bounds::EMPTY, 0); BINS];
    for (bounds, _) in &*triangles {
        let (whole, count) = &mut bins[bin(bounds)];
        *whole = whole.union(bounds);
        *count += 1;
    }
    let count = |bins: &[(Bounds, usize)]| bins.iter().map(|(_, count)| count).sum::<usize>();
    let cost = |bins: &[(Bounds, usize)]| union(bins).area() * count(bins) as f64;
    let cuts = (1..BINS).filter(|&cut| (1..triangles.len()).contains(&count(&bins[..cut])));
    let best = cuts
        .map(|cut| (cut, cost(&bins[..cut]) + cost(&bins[cut..])))
        .min_by(|(_, one), (_, other)| one.total_cmp(other));
    // If all middles are in one place, any half is as good.
    let Some((cut, _)) = best else { return triangles.len() / 2 };
    let mut below = 0;
    for k in 0..triangles.len() {
        if bin(&triangles[k].0) < cut {
            triangles.swap(k, below);
            below += 1;
        }
    }
    below
}

/// The box around some boxes.
fn union<T>(boxes: &[(Bounds, T)]) -> Bounds {
    boxes.iter().fold(Bounds::EMPTY, |whole, (bounds, _)| whole.union(bounds))
}

/// A box with its sides along the axes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bounds {
    pub low: DVec3,
    pub high: DVec3,
}

impl Bounds {
    const EMPTY: Self = Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };

    pub fn around(points: impl IntoIterator<Item = DVec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |bounds, point| bounds.union(&Self { low: point, high: point }))
    }

    fn union(&self, other: &Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// Half of the surface.
    fn area(&self) -> f64 {
        let DVec3 { x, y, z } = self.high - self.low;
        x * y + y * z + z * x
    }
}
