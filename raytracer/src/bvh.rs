//! A tree of boxes around the instances of a scene.

use crate::lanes::Lanes;
use glam::{DVec3, Vec3};
use std::ops::Range;

/// A hierarchy of boxes, so that a packet is held only against instances that it may meet.
#[derive(Debug, Clone)]
pub(crate) struct Bvh {
    /// The root first; empty if there is nothing.
    nodes: Vec<BoxNode>,
    /// Numbers of the things, in the order of the leaves.
    order: Vec<u32>,
}

#[derive(Debug, Clone)]
struct BoxNode {
    /// Low and high corner, with room for rounding.
    bounds: [Vec3; 2],
    content: Content,
}

#[derive(Debug, Clone)]
enum Content {
    /// Two nodes, side by side.
    Inner(u32),
    /// Things, a range of the order.
    Leaf(Range<u32>),
}

/// Rays of a packet in the scene, made ready for boxes.
pub(crate) struct BoxRays<L: Lanes> {
    origin: [L::Float; 3],
    reciprocal: [L::Float; 3],
    /// What rounding may move a plane by.
    margin: L::Float,
    active: L::Mask,
}

/// A box that waits to be looked into.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Waiting {
    node: u32,
    /// The lanes whose ray comes into it.
    lanes: u32,
    /// The least distance at which one does.
    entry: f32,
}

/// A coordinate's rounding error in single precision is less than this share of it.
const ROUNDING: f32 = 1.0 / (1 << 21) as f32;

/// The least component of a direction: its reciprocal is finite, and times any coordinate, too.
const LEAST_SLOPE: f32 = 1e-18;

impl<L: Lanes> BoxRays<L> {
    /// Origins and directions in the scene; the largest component of each direction is about one.
    pub fn new(origin: [L::Float; 3], direction: [L::Float; 3], active: L::Mask) -> Self {
        let reciprocal = direction.map(|slope| {
            let is_small = L::less(L::abs(slope), L::float(LEAST_SLOPE));
            L::float(1.0) / L::select(is_small, L::float(LEAST_SLOPE), slope)
        });
        let [x, y, z] = origin.map(L::abs);
        let margin = L::max(L::max(x, y), z) * L::float(ROUNDING);
        Self { origin, reciprocal, margin, active }
    }

    /// The lanes whose ray comes into a box before it ends, and the least distance at which one does.
    fn entry(&self, [low, high]: [Vec3; 2], end: L::Float) -> (u32, f32) {
        let (mut enter, mut leave) = (L::float(0.0), end);
        for axis in 0..3 {
            let plane = |plane: f32, margin: L::Float| {
                (L::float(plane) + margin - self.origin[axis]) * self.reciprocal[axis]
            };
            let low = plane(low[axis], L::float(0.0) - self.margin);
            let high = plane(high[axis], self.margin);
            enter = L::max(enter, L::min(low, high));
            leave = L::min(leave, L::max(low, high));
        }
        let comes_in = L::at_most(enter * L::float(1.0 - ROUNDING), leave * L::float(1.0 + ROUNDING));
        let lanes = L::bitmask(comes_in & self.active);
        (lanes, L::least(enter, lanes))
    }
}

impl Bvh {
    /// A tree around boxes, each a low and a high corner.
    pub fn new(boxes: &[[DVec3; 2]]) -> Self {
        let mut bvh = Self { nodes: Vec::new(), order: (0..boxes.len() as u32).collect() };
        if !boxes.is_empty() {
            bvh.nodes
                .push(BoxNode { bounds: [Vec3::ZERO; 2], content: Content::Leaf(0..boxes.len() as u32) });
            bvh.split(0, boxes);
        }
        bvh
    }

    /// Divides the things of a leaf at the middle one along the longest side, until each is alone.
    fn split(&mut self, node: usize, boxes: &[[DVec3; 2]]) {
        let Content::Leaf(range) = self.nodes[node].content.clone() else { return };
        let things = &mut self.order[range.start as usize..range.end as usize];
        let bounds = things.iter().fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], &thing| {
            let [other_low, other_high] = boxes[thing as usize];
            [low.min(other_low), high.max(other_high)]
        });
        let room = bounds[0].abs().max(bounds[1].abs()).max_element() * f64::from(ROUNDING);
        self.nodes[node].bounds = [(bounds[0] - room).as_vec3(), (bounds[1] + room).as_vec3()];
        if range.len() <= 1 {
            return;
        }
        let extent = bounds[1] - bounds[0];
        let axis = if extent.x >= extent.y.max(extent.z) {
            0
        } else if extent.y >= extent.z {
            1
        } else {
            2
        };
        let middle = |thing: &u32| boxes[*thing as usize][0][axis] + boxes[*thing as usize][1][axis];
        things.sort_unstable_by(|a, b| middle(a).total_cmp(&middle(b)).then(a.cmp(b)));
        let half = range.start + range.len() as u32 / 2;
        let first = self.nodes.len();
        for part in [range.start..half, half..range.end] {
            self.nodes.push(BoxNode { bounds: [Vec3::ZERO; 2], content: Content::Leaf(part) });
        }
        self.nodes[node].content = Content::Inner(first as u32);
        self.split(first, boxes);
        self.split(first + 1, boxes);
    }

    /// Gives `visit` the number of each thing whose box some ray may meet before its end, and a bit for each such ray;
    /// roughly the nearest first. `visit` returns the ends of the rays from then on.
    pub fn visit<L: Lanes>(
        &self,
        rays: &BoxRays<L>,
        mut end: L::Float,
        stack: &mut Vec<Waiting>,
        mut visit: impl FnMut(u32, u32) -> L::Float,
    ) {
        stack.clear();
        let push = |node: u32, end: L::Float, stack: &mut Vec<Waiting>| {
            let (lanes, entry) = rays.entry(self.nodes[node as usize].bounds, end);
            if lanes != 0 {
                stack.push(Waiting { node, lanes, entry });
            }
        };
        if !self.nodes.is_empty() {
            push(0, end, stack);
        }
        while let Some(Waiting { node, lanes, entry }) = stack.pop() {
            // Ends may have come nearer since the node was put there.
            if !L::any(L::at_most(L::float(entry * (1.0 - 4.0 * ROUNDING)), end) & rays.active) {
                continue;
            }
            match &self.nodes[node as usize].content {
                Content::Leaf(range) => {
                    for &thing in &self.order[range.start as usize..range.end as usize] {
                        end = visit(thing, lanes);
                    }
                }
                &Content::Inner(first) => {
                    let before = stack.len();
                    push(first, end, stack);
                    push(first + 1, end, stack);
                    // The nearer one is taken first.
                    if stack.len() == before + 2 && stack[before].entry < stack[before + 1].entry {
                        stack.swap(before, before + 1);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{Four, Sixteen};
    use crate::random::Random;

    fn visited<L: Lanes>(bvh: &Bvh, origins: &[Vec3], directions: &[Vec3]) -> Vec<u32> {
        let column = |of: &[Vec3], axis: usize| {
            let mut values = [1.0; crate::lanes::MAX_LANES];
            of.iter().zip(&mut values).for_each(|(vector, value)| *value = vector[axis]);
            L::load(&values)
        };
        let columns = |of: &[Vec3]| [column(of, 0), column(of, 1), column(of, 2)];
        let rays = BoxRays::<L>::new(columns(origins), columns(directions), L::first(origins.len()));
        let mut found = Vec::new();
        let endless = L::float(f32::INFINITY);
        bvh.visit::<L>(&rays, endless, &mut Vec::new(), |thing, lanes| {
            assert_ne!(lanes, 0);
            found.push(thing);
            endless
        });
        found.sort_unstable();
        found
    }

    /// Nothing that a ray meets is left out, wherever boxes and rays are.
    #[test]
    fn every_box_that_is_met_is_visited() {
        let random = &mut Random::stream(11, 0);
        let mut vector = |scale: f64| {
            DVec3::from_array([(); 3].map(|()| f64::from(random.between(-1000, 1000)) / 1000.0 * scale))
        };
        for offset in [0.0, 1e4] {
            let boxes: Vec<[DVec3; 2]> = (0..500)
                .map(|_| {
                    let low = vector(10.0) + offset;
                    [low, low + vector(0.5).abs()]
                })
                .collect();
            let bvh = Bvh::new(&boxes);
            let mut met = 0;
            for round in 0..200 {
                let rays: Vec<(DVec3, DVec3)> = (0..4)
                    .map(|lane| {
                        let aim = boxes[(round * 4 + lane) % 500];
                        let target = aim[0].lerp(aim[1], 0.5);
                        let axis = DVec3::AXES[round % 3];
                        let origin = if lane == 0 { target - axis * 30.0 } else { vector(20.0) + offset };
                        (origin.as_vec3().as_dvec3(), (target - origin).normalize().as_vec3().as_dvec3())
                    })
                    .collect();
                let origins: Vec<Vec3> = rays.iter().map(|ray| ray.0.as_vec3()).collect();
                let directions: Vec<Vec3> = rays.iter().map(|ray| ray.1.as_vec3()).collect();
                let found = visited::<Four>(&bvh, &origins, &directions);
                assert_eq!(found, visited::<Sixteen>(&bvh, &origins, &directions));
                assert!(found.len() < 250, "{} of 500 boxes", found.len());
                for (number, [low, high]) in boxes.iter().enumerate() {
                    let is_met = rays.iter().any(|(origin, direction)| {
                        let (a, b) = ((low - origin) / direction, (high - origin) / direction);
                        let (enter, leave) = (a.min(b), a.max(b));
                        enter.max_element().max(0.0) <= leave.min_element()
                    });
                    met += usize::from(is_met);
                    assert!(
                        !is_met || found.binary_search(&(number as u32)).is_ok(),
                        "box {number} left out"
                    );
                }
            }
            assert!(met > 800);
        }
    }

    #[test]
    fn nothing_is_visited_in_an_empty_tree() {
        assert!(visited::<Four>(&Bvh::new(&[]), &[Vec3::ZERO], &[Vec3::X]).is_empty());
    }
}
