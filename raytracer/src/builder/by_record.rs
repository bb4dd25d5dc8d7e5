//! The plainest way to nodes of two levels, which the tests hold the builder against: one record after the other.
//!
//! A node's children are kept together, so they wait in a frame until the last has come. There is one frame for each
//! level of nodes.

use crate::node::Node;
use octvox_format::{Reader, Record, Voxel};

/// A node whose cells are still arriving.
#[derive(Debug, Default)]
struct Frame {
    /// Cells filled so far.
    mask: u64,
    /// What the node itself looks like from afar.
    own: Voxel,
    /// What its eight octree cells of the level between look like.
    bytes: [Voxel; 8],
    /// Child nodes so far, in order; stays empty in a leaf.
    children: Vec<Node>,
    /// Where the voxels of this node begin, if it is a leaf.
    first_voxel: u32,
    /// The cell of its parent that this node fills.
    place: u32,
}

/// The octree so far.
#[derive(Debug)]
struct Builder {
    depth: u8,
    nodes: Vec<Node>,
    voxels: Vec<Voxel>,
    lod: Vec<Voxel>,
    /// Open nodes, root first; frames are kept for reuse.
    frames: Vec<Frame>,
    open: usize,
    /// Octants of the open path, by level.
    path: [u8; 32],
}

/// The lists of an octree, the root last among the nodes if there is one.
pub(super) struct PlainOctree {
    pub nodes: Vec<Node>,
    pub voxels: Vec<Voxel>,
    pub lod: Vec<Voxel>,
}

/// Builds an octree of `depth` levels from the records of a file.
pub(super) fn build(file: &[u8], depth: u8) -> PlainOctree {
    let mut builder = Builder::new(depth);
    let mut root = Voxel::EMPTY;
    for record in Reader::new(file).unwrap() {
        let record = record.unwrap();
        if record.level == 0 {
            root = record.voxel;
        }
        builder.add(record);
    }
    builder.finish(root)
}

impl Builder {
    fn new(depth: u8) -> Self {
        let frames = (0..=usize::from(depth) / 2 + 1).map(|_| Frame::default()).collect();
        Self {
            // A single voxel is traced as eight finer ones.
            depth: depth.max(1),
            nodes: Vec::new(),
            voxels: Vec::new(),
            lod: Vec::new(),
            frames,
            open: 0,
            path: [0; 32],
        }
    }

    /// Level of the octree cells that the root's cells are on, less two; −1 where the root covers one level.
    fn root_level(&self) -> i32 {
        if self.depth.is_multiple_of(2) { 0 } else { -1 }
    }

    /// The level of the octree cell that is open frame `index`.
    fn level_of_frame(&self, index: usize) -> i32 {
        self.root_level() + 2 * index as i32
    }

    fn add(&mut self, record: Record) {
        let level = i32::from(record.level);
        if record.level > self.depth {
            panic!("too deep");
        }
        self.path[usize::from(record.level)] = record.octant;
        if self.open == 0 {
            self.open_frame(Voxel::EMPTY, 0);
        }
        // Nodes at this level and below have had all their cells.
        while self.open > 1 && self.level_of_frame(self.open - 1) >= level {
            self.close_frame();
        }
        let above = level - self.level_of_frame(self.open - 1);
        match above {
            0 => {
                // The root itself, where it covers two levels.
                self.frames[0].own = record.voxel;
                if !record.has_children {
                    self.fill(0..64, record.voxel);
                }
            }
            1 => {
                let byte = if level == 0 { 0 } else { u32::from(record.octant) };
                self.frames[self.open - 1].bytes[byte as usize] = record.voxel;
                if !record.has_children {
                    self.fill(byte * 8..byte * 8 + 8, record.voxel);
                }
            }
            2 => {
                let place = self.place(record.level);
                if record.has_children {
                    self.open_frame(record.voxel, place);
                } else {
                    self.fill(place..place + 1, record.voxel);
                }
            }
            _ => panic!("a level was left out"),
        }
    }

    /// The cell of the innermost open node that the path to `level` leads to.
    fn place(&self, level: u8) -> u32 {
        let high = if level >= 2 { self.path[usize::from(level) - 1] } else { 0 };
        u32::from(high) * 8 + u32::from(self.path[usize::from(level)])
    }

    fn open_frame(&mut self, own: Voxel, place: u32) {
        let first_voxel = self.voxels.len() as u32;
        let frame = &mut self.frames[self.open];
        frame.mask = 0;
        frame.own = own;
        frame.bytes = [Voxel::EMPTY; 8];
        frame.children.clear();
        frame.first_voxel = first_voxel;
        frame.place = place;
        self.open += 1;
    }

    /// Whether the cells of the innermost open node are on the finest level.
    fn in_leaf(&self) -> bool {
        self.level_of_frame(self.open - 1) + 2 == i32::from(self.depth)
    }

    /// Fills cells of the innermost open node with one voxel.
    fn fill(&mut self, places: std::ops::Range<u32>, voxel: Voxel) {
        if voxel.is_empty() {
            return;
        }
        if self.in_leaf() {
            for place in places {
                self.frames[self.open - 1].mask |= 1 << place;
                self.voxels.push(voxel);
            }
        } else {
            let node = Node::uniform(self.voxels.len() as u32, self.lod.len() as u32);
            self.voxels.push(voxel);
            self.lod.push(voxel);
            let frame = &mut self.frames[self.open - 1];
            for place in places {
                frame.mask |= 1 << place;
                frame.children.push(node);
                let byte = &mut frame.bytes[place as usize / 8];
                if byte.is_empty() {
                    *byte = voxel;
                }
            }
        }
    }

    /// Ends the innermost open node and hands it to its parent.
    fn close_frame(&mut self) {
        let place = self.frames[self.open - 1].place;
        let node = self.take_frame();
        if let Some((node, own)) = node {
            let parent = &mut self.frames[self.open - 1];
            parent.mask |= 1 << place;
            parent.children.push(node);
            let byte = &mut parent.bytes[place as usize / 8];
            if byte.is_empty() {
                *byte = own;
            }
        }
    }

    /// The innermost open node and what it looks like, or nothing if none of its cells is filled.
    fn take_frame(&mut self) -> Option<(Node, Voxel)> {
        let is_leaf = self.in_leaf();
        let first_child = self.nodes.len() as u32;
        let lod = self.lod.len() as u32;
        self.open -= 1;
        let frame = &mut self.frames[self.open];
        if frame.mask == 0 {
            return None;
        }
        // Files written before levels of detail were computed have transparent nodes: the first voxel below
        // stands in.
        let stand_in = |voxel: Voxel, cells: u64| {
            if !voxel.is_empty() || !is_leaf {
                return voxel;
            }
            let before = frame.mask & ((1u64 << cells.trailing_zeros()) - 1);
            self.voxels[frame.first_voxel as usize + before.count_ones() as usize]
        };
        let start = self.lod.len();
        self.lod.push(stand_in(frame.own, frame.mask));
        for byte in 0..8 {
            let cells = frame.mask & 0xFF << (8 * byte);
            if cells != 0 {
                self.lod.push(stand_in(frame.bytes[byte], cells));
            }
        }
        // Of an inner node, the first filled byte got a voxel from the first child at the latest.
        if self.lod[start].is_empty() {
            self.lod[start] = self.lod[start + 1];
        }
        let own = self.lod[start];
        let node = if is_leaf {
            Node::leaf(frame.mask, frame.first_voxel, lod)
        } else {
            self.nodes.append(&mut frame.children);
            Node::inner(frame.mask, first_child, lod)
        };
        Some((node, own))
    }

    fn finish(mut self, root: Voxel) -> PlainOctree {
        while self.open > 1 {
            self.close_frame();
        }
        let covers_one_level = self.root_level() < 0;
        if covers_one_level {
            self.frames[0].own = root;
            if self.in_leaf() {
                self.repeat_root();
            }
        }
        let root = self.take_frame();
        self.nodes.extend(root.map(|(node, _)| node));
        PlainOctree { nodes: self.nodes, voxels: self.voxels, lod: self.lod }
    }

    /// Repeats the first byte of a root that covers one level in its seven others, where its cells are voxels.
    fn repeat_root(&mut self) {
        let frame = &mut self.frames[0];
        let pattern = frame.mask & 0xFF;
        frame.mask = pattern * 0x0101_0101_0101_0101;
        frame.bytes = [frame.bytes[0]; 8];
        let voxels = self.voxels[frame.first_voxel as usize..].to_vec();
        (1..8).for_each(|_| self.voxels.extend_from_slice(&voxels));
    }
}
