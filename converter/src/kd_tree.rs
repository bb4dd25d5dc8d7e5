//! Points in space, found by their distance (Bentley 1975).

/// Points in a leaf when the tree is built.
const LEAF_POINTS: usize = 8;

/// A point of a tree.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Point {
    pub position: [f32; 3],
    /// Whatever its owner wants to have at hand.
    pub weight: f32,
    pub number: usize,
}

/// A k-d tree of points in three dimensions.
#[derive(Debug, Default)]
pub(crate) struct KdTree {
    /// The first is the root.
    nodes: Vec<Node>,
}

#[derive(Debug)]
enum Node {
    Leaf(Vec<Point>),
    /// Coordinates along `axis` are at most `at` in the lower child and at least `at` in the upper one.
    Split {
        axis: usize,
        at: f32,
        lower: usize,
        upper: usize,
    },
}

impl KdTree {
    pub(crate) fn new(mut points: Vec<Point>) -> Self {
        let mut tree = Self::default();
        tree.build(&mut points);
        tree
    }

    /// Builds a node of these points, and returns its number.
    fn build(&mut self, points: &mut [Point]) -> usize {
        let node = self.nodes.len();
        self.nodes.push(Node::Leaf(Vec::new()));
        let (axis, width) = widest_axis(points);
        if points.len() <= LEAF_POINTS || width == 0.0 {
            self.nodes[node] = Node::Leaf(points.to_vec());
            return node;
        }
        let middle = points.len() / 2;
        let by_place = |a: &Point, b: &Point| {
            a.position[axis].total_cmp(&b.position[axis]).then(a.number.cmp(&b.number))
        };
        let at = points.select_nth_unstable_by(middle, by_place).1.position[axis];
        let (lower, upper) = points.split_at_mut(middle);
        let (lower, upper) = (self.build(lower), self.build(upper));
        self.nodes[node] = Node::Split { axis, at, lower, upper };
        node
    }

    /// Calls `visit(Some(point), square of the distance)` with the points of one region after the other, near ones first,
    /// and `visit(None, square)` before each region, where it may return `false` to skip a region that is no nearer.
    pub(crate) fn visit_near(&self, from: [f32; 3], mut visit: impl FnMut(Option<&Point>, f32) -> bool) {
        if !self.nodes.is_empty() {
            self.visit(0, from, [0.0; 3], &mut visit);
        }
    }

    /// `offset` leads from the point to the node's region, along each axis.
    fn visit(
        &self,
        node: usize,
        from: [f32; 3],
        offset: [f32; 3],
        visit: &mut impl FnMut(Option<&Point>, f32) -> bool,
    ) {
        if !visit(None, square(offset)) {
            return;
        }
        match &self.nodes[node] {
            Node::Leaf(points) => {
                for point in points {
                    visit(Some(point), square([0, 1, 2].map(|axis| point.position[axis] - from[axis])));
                }
            }
            &Node::Split { axis, at, lower, upper } => {
                let beyond = at - from[axis];
                let (near, far) = if beyond > 0.0 { (lower, upper) } else { (upper, lower) };
                self.visit(near, from, offset, visit);
                let mut far_offset = offset;
                far_offset[axis] = beyond;
                self.visit(far, from, far_offset, visit);
            }
        }
    }
}

fn square(vector: [f32; 3]) -> f32 {
    vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2]
}

/// The axis along which the points are spread most, and how far.
fn widest_axis(points: &[Point]) -> (usize, f32) {
    let width = |axis: usize| {
        let coordinates = points.iter().map(|point| point.position[axis]);
        coordinates.clone().fold(f32::MIN, f32::max) - coordinates.fold(f32::MAX, f32::min)
    };
    (0..3)
        .map(|axis| (axis, width(axis)))
        .fold((0, 0.0), |best, other| if other.1 > best.1 { other } else { best })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn positions(count: std::ops::Range<usize>) -> impl Strategy<Value = Vec<[f32; 3]>> {
        // Small integers: many equal coordinates and distances.
        prop::collection::vec(prop::array::uniform3((-4i8..4).prop_map(f32::from)), count)
    }

    proptest! {
        #[test]
        fn finds_the_nearest_point(positions in positions(1..80), from in positions(1..2)) {
            let points = positions.iter().enumerate();
            let points = points.map(|(number, &position)| Point { position, weight: 0.0, number });
            let tree = KdTree::new(points.collect());

            let mut nearest = f32::MAX;
            tree.visit_near(from[0], |point, square| {
                if point.is_some() {
                    nearest = nearest.min(square);
                }
                square <= nearest
            });
            let square = |to: &[f32; 3]| (0..3).map(|axis| (to[axis] - from[0][axis]).powi(2)).sum::<f32>();
            prop_assert_eq!(nearest, positions.iter().map(square).fold(f32::MAX, f32::min));
        }
    }
}
