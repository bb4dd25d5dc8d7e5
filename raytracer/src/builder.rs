//! From the records of a file, in preorder, to nodes of two levels.
//!
//! The order of the file is Morton order, and so is the order of cells in a node: voxels arrive in the order in
//! which they are kept. A node's children are kept together, so they wait in a frame until the last has come.
//! There is one frame for each level of nodes, whatever the file.

use crate::grid::Grid;
use crate::node::{MAX_INDEX, Node};
use crate::octree::{Bounds, MAX_DEPTH, Octree, cell_of_morton, finest_exponent, root_exponent};
use crate::{LoadError, Payload};
use octvox_format::{Reader, Record, Summary, Voxel};
use std::io::Read;

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
    voxels: Vec<Payload>,
    lod: Vec<Payload>,
    /// Open nodes, root first; frames are kept for reuse.
    frames: Vec<Frame>,
    open: usize,
    /// Octants of the open path, by level.
    path: [u8; 32],
}

/// Builds the octree from the records of `reader`, which `summary` has counted.
pub(crate) fn build<R: Read>(mut reader: Reader<R>, summary: &Summary) -> Result<Octree, LoadError> {
    if summary.depth > MAX_DEPTH {
        return Err(LoadError::TooDeep { depth: summary.depth, limit: MAX_DEPTH });
    }
    let limit = MAX_INDEX as u64;
    for (what, found) in [("nodes", summary.nodes), ("stored voxels", summary.stored_voxels)] {
        if found / 8 > limit {
            return Err(LoadError::TooLarge { what, found, limit });
        }
    }
    let mut builder = Builder::new(summary.depth);
    let mut root = Voxel::EMPTY;
    for record in reader.by_ref() {
        let record = record?;
        if record.level == 0 {
            root = record.voxel;
        }
        builder.add(record)?;
    }
    builder.finish(root, reader.into_palette())
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

    fn add(&mut self, record: Record) -> Result<(), LoadError> {
        let level = i32::from(record.level);
        if record.level > self.depth {
            return Err(LoadError::Changed);
        }
        self.path[usize::from(record.level)] = record.octant;
        if self.open == 0 {
            self.open_frame(Voxel::EMPTY, 0)?;
        }
        // Nodes at this level and below have had all their cells.
        while self.open > 1 && self.level_of_frame(self.open - 1) >= level {
            self.close_frame()?;
        }
        let above = level - self.level_of_frame(self.open - 1);
        match above {
            0 => {
                // The root itself, where it covers two levels.
                self.frames[0].own = record.voxel;
                if !record.has_children {
                    self.fill(0..64, record.voxel)?;
                }
            }
            1 => {
                let byte = if level == 0 { 0 } else { u32::from(record.octant) };
                self.frames[self.open - 1].bytes[byte as usize] = record.voxel;
                if !record.has_children {
                    self.fill(byte * 8..byte * 8 + 8, record.voxel)?;
                }
            }
            2 => {
                let place = self.place(record.level);
                if record.has_children {
                    self.open_frame(record.voxel, place)?;
                } else {
                    self.fill(place..place + 1, record.voxel)?;
                }
            }
            _ => return Err(LoadError::Changed),
        }
        Ok(())
    }

    /// The cell of the innermost open node that the path to `level` leads to.
    fn place(&self, level: u8) -> u32 {
        let high = if level >= 2 { self.path[usize::from(level) - 1] } else { 0 };
        u32::from(high) * 8 + u32::from(self.path[usize::from(level)])
    }

    fn open_frame(&mut self, own: Voxel, place: u32) -> Result<(), LoadError> {
        let first_voxel = index(&self.voxels, "voxels")?;
        let frame = &mut self.frames[self.open];
        frame.mask = 0;
        frame.own = own;
        frame.bytes = [Voxel::EMPTY; 8];
        frame.children.clear();
        frame.first_voxel = first_voxel;
        frame.place = place;
        self.open += 1;
        Ok(())
    }

    /// Whether the cells of the innermost open node are on the finest level.
    fn in_leaf(&self) -> bool {
        self.level_of_frame(self.open - 1) + 2 == i32::from(self.depth)
    }

    /// Fills cells of the innermost open node with one voxel.
    fn fill(&mut self, places: std::ops::Range<u32>, voxel: Voxel) -> Result<(), LoadError> {
        if voxel.is_empty() {
            return Ok(());
        }
        let payload = Payload::from(voxel);
        if self.in_leaf() {
            for place in places {
                self.frames[self.open - 1].mask |= 1 << place;
                self.voxels.push(payload);
            }
        } else {
            let node = Node::uniform(index(&self.voxels, "voxels")?, index(&self.lod, "levels of detail")?);
            self.voxels.push(payload);
            self.lod.push(payload);
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
        Ok(())
    }

    /// Ends the innermost open node and hands it to its parent.
    fn close_frame(&mut self) -> Result<(), LoadError> {
        let place = self.frames[self.open - 1].place;
        let node = self.take_frame()?;
        if let Some((node, own)) = node {
            let parent = &mut self.frames[self.open - 1];
            parent.mask |= 1 << place;
            parent.children.push(node);
            let byte = &mut parent.bytes[place as usize / 8];
            if byte.is_empty() {
                *byte = own;
            }
        }
        Ok(())
    }

    /// The innermost open node and what it looks like, or nothing if none of its cells is filled.
    fn take_frame(&mut self) -> Result<Option<(Node, Voxel)>, LoadError> {
        let is_leaf = self.in_leaf();
        let first_child = index(&self.nodes, "nodes")?;
        let lod = index(&self.lod, "levels of detail")?;
        self.open -= 1;
        let frame = &mut self.frames[self.open];
        if frame.mask == 0 {
            return Ok(None);
        }
        // Files written before levels of detail were computed have transparent nodes: the first voxel below
        // stands in.
        let stand_in = |voxel: Voxel, cells: u64| {
            if !voxel.is_empty() || !is_leaf {
                return Payload::from(voxel);
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
        let own = self.lod[start].voxel();
        let node = if is_leaf {
            Node::leaf(frame.mask, frame.first_voxel, lod)
        } else {
            self.nodes.append(&mut frame.children);
            Node::inner(frame.mask, first_child, lod)
        };
        Ok(Some((node, own)))
    }

    fn finish(mut self, root: Voxel, palette: octvox_format::Palette) -> Result<Octree, LoadError> {
        while self.open > 1 {
            self.close_frame()?;
        }
        let covers_one_level = self.root_level() < 0;
        if covers_one_level {
            self.frames[0].own = root;
            self.repeat_root()?;
        }
        let root = self.take_frame()?;
        index(&self.nodes, "nodes")?;
        let root_index = self.nodes.len() as u32;
        self.nodes.extend(root.map(|(node, _)| node));
        self.nodes.shrink_to_fit();
        self.voxels.shrink_to_fit();
        self.lod.shrink_to_fit();
        let mut octree = Octree {
            depth: self.depth,
            palette,
            nodes: self.nodes,
            root: root_index,
            voxels: self.voxels,
            lod: self.lod,
            leaf_voxels: 0,
            bounds: Bounds { low: [0; 3], high: [0; 3] },
            grid: Grid::none(),
            root_entrance: Grid::none(),
        };
        octree.measure();
        Ok(octree)
    }

    /// Repeats the first byte of a root that covers one level in its seven others.
    fn repeat_root(&mut self) -> Result<(), LoadError> {
        let is_leaf = self.in_leaf();
        let frame = &mut self.frames[0];
        let pattern = frame.mask & 0xFF;
        frame.mask = pattern * 0x0101_0101_0101_0101;
        frame.bytes = [frame.bytes[0]; 8];
        if is_leaf {
            let voxels = self.voxels[frame.first_voxel as usize..].to_vec();
            (1..8).for_each(|_| self.voxels.extend_from_slice(&voxels));
        } else {
            let children = frame.children.clone();
            (1..8).for_each(|_| frame.children.extend_from_slice(&children));
        }
        Ok(())
    }
}

/// The index that the next element of `list` will have.
fn index<T>(list: &[T], what: &'static str) -> Result<u32, LoadError> {
    // A node adds at most 64 elements to a list, eight times that at the root.
    if list.len() > MAX_INDEX - 512 {
        return Err(LoadError::TooLarge { what, found: list.len() as u64, limit: MAX_INDEX as u64 });
    }
    Ok(list.len() as u32)
}

impl Octree {
    /// Counts the finest cells and finds the box around them.
    fn measure(&mut self) {
        let mut measure =
            Measure { octree: self, bounds: Bounds { low: [u32::MAX; 3], high: [0; 3] }, cells: 0 };
        let Some(root) = self.nodes.get(self.root as usize) else { return };
        let mut root = *root;
        if root_exponent(self.depth) == 22 {
            // The seven repetitions are not there.
            root.mask = [root.mask[0] & 0xFF, 0];
        }
        let cell_size = 1u32 << (root_exponent(self.depth) - finest_exponent(self.depth));
        measure.visit(&root, [0; 3], cell_size);
        (self.bounds, self.leaf_voxels) = (measure.bounds, measure.cells);
    }
}

struct Measure<'a> {
    octree: &'a Octree,
    bounds: Bounds,
    cells: u64,
}

impl Measure<'_> {
    /// `corner` is the node's lowest finest cell, `size` the side of its cells. Recursion is at most twelve deep.
    fn visit(&mut self, node: &Node, corner: [u32; 3], size: u32) {
        let mut cells = node.cells();
        if node.is_leaf() {
            self.cells += u64::from(cells.count_ones()) * u64::from(size).pow(3);
        }
        while cells != 0 {
            let place = cells.trailing_zeros();
            cells &= cells - 1;
            let offset = cell_of_morton(place);
            let low: [u32; 3] = std::array::from_fn(|axis| corner[axis] + offset[axis] * size);
            if node.is_leaf() {
                for axis in 0..3 {
                    self.bounds.low[axis] = self.bounds.low[axis].min(low[axis]);
                    self.bounds.high[axis] = self.bounds.high[axis].max(low[axis] + size);
                }
            } else {
                let child = self.octree.nodes[node.index_of(place) as usize];
                self.visit(&child, low, size / 4);
            }
        }
    }
}
