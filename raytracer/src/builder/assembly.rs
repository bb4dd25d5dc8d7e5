//! Nodes of two levels from the cells of an octree, in preorder.

use crate::LoadError;
use crate::bits::ones;
use crate::node::{MAX_INDEX, Node, Place};
use crate::payload::{PayloadList, PayloadWord};
use octvox_format::v5::LevelCount;

/// A cell of the octree, and how to get at its children.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Cell<C> {
    /// Nothing is there.
    Empty,
    /// It is the same throughout.
    Voxel(PayloadWord),
    /// It has children, and is seen from afar as a voxel, which is empty if that is not known.
    Node(PayloadWord, C),
}

/// The cells of an octree in preorder.
pub(crate) trait Cells {
    /// How to get at the children of a cell.
    type Children: Copy;

    /// The root, which comes first.
    fn root(&mut self) -> Result<Cell<Self::Children>, LoadError>;

    /// Which of eight siblings come, by octant. The others are empty.
    fn octants(siblings: Self::Children) -> u8;

    /// The next of the siblings that come. If it has children, these come next.
    fn next(&mut self, siblings: Self::Children) -> Result<Cell<Self::Children>, LoadError>;

    /// All eight siblings on the finest level: which of them are filled, by octant. These are appended to `voxels`.
    fn finest(&mut self, siblings: Self::Children, voxels: &mut Vec<PayloadWord>) -> Result<u8, LoadError>;

    /// A node whose cells are voxels, all at once: appends what belongs to it, as the [`Assembler`] would, and returns it.
    /// `None` takes and appends nothing, and leaves it to be made byte by byte. `own` and `children` are of its cell.
    #[inline]
    fn leaf(
        &mut self,
        _own: PayloadWord,
        _children: Self::Children,
        _lists: &mut Lists,
    ) -> Result<Option<Node>, LoadError> {
        Ok(None)
    }
}

/// How long the lists of an octree will be, if none of its voxels above the finest level is made of finer ones. They may
/// become longer, and are shorter if the file lies.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Capacity {
    nodes: u64,
    voxels: u64,
    lod: u64,
}

impl Capacity {
    /// For an octree of which a file tells how many voxels each level has.
    pub fn of_levels(depth: u8, levels: &[LevelCount]) -> Self {
        let above = &levels[..usize::from(depth)];
        // What the file tells has not been compared with what it holds.
        let add = |sum: u64, level: &LevelCount| sum.saturating_add(level.nodes);
        Self {
            nodes: above.iter().rev().skip(1).step_by(2).fold(0, add),
            voxels: levels.get(usize::from(depth)).map_or(0, |finest| finest.voxels),
            lod: above.iter().fold(0, add),
        }
    }
}

/// The lists that an octree is made of.
#[derive(Debug)]
pub(crate) struct Lists {
    /// Without the root.
    pub nodes: Vec<Node>,
    pub voxels: PayloadList,
    pub lod: PayloadList,
}

impl Lists {
    /// Empty lists for voxels of a palette of so many entries.
    pub fn new(palette_size: usize) -> Self {
        let payload = PayloadList::new(palette_size);
        Self { nodes: Vec::new(), voxels: payload.clone(), lod: payload }
    }

    /// Empty lists that have room, as far as there is any in memory.
    pub fn with_capacity(palette_size: usize, capacity: Capacity) -> Self {
        let mut lists = Self::new(palette_size);
        let [nodes, voxels, lod] = [capacity.nodes, capacity.voxels, capacity.lod]
            .map(|count| usize::try_from(count).unwrap_or(usize::MAX).min(MAX_INDEX));
        // Without room they grow as it is needed, and what cannot be had then was asked for by voxels that are there.
        let _ = lists.nodes.try_reserve_exact(nodes);
        lists.voxels.try_reserve(voxels);
        lists.lod.try_reserve(lod);
        lists
    }

    /// A leaf node to which the voxels and levels of detail belong that are appended next.
    pub fn next_leaf(&self, mask: u64) -> Result<Node, LoadError> {
        Ok(Node::leaf(mask, self.next_voxel()?, self.next_lod()?))
    }

    /// Appends a part of other lists, from one place in them to another. Returns how far that has moved.
    pub fn append(&mut self, other: &Self, from: Place, to: Place) -> Result<Place, LoadError> {
        // All that stands before the part in the other lists stands before it in these.
        let moved = self.end()?.minus(from);
        let indices = |from: u32, to: u32| from as usize..to as usize;
        let nodes = &other.nodes[indices(from.nodes, to.nodes)];
        self.nodes.extend(nodes.iter().map(|node| node.moved(moved)));
        self.voxels.append(&other.voxels, indices(from.voxels, to.voxels));
        self.lod.append(&other.lod, indices(from.lod, to.lod));
        // Whatever was moved there has an index.
        self.end()?;
        Ok(moved)
    }

    /// Where the next elements will stand.
    pub fn end(&self) -> Result<Place, LoadError> {
        Ok(Place { nodes: self.next_node()?, voxels: self.next_voxel()?, lod: self.next_lod()? })
    }

    fn next_node(&self) -> Result<u32, LoadError> {
        checked_index(self.nodes.len(), "nodes")
    }

    fn next_voxel(&self) -> Result<u32, LoadError> {
        checked_index(self.voxels.len(), "voxels")
    }

    fn next_lod(&self) -> Result<u32, LoadError> {
        checked_index(self.lod.len(), "levels of detail")
    }
}

/// The index that the next element of a list will have.
fn checked_index(length: usize, what: &'static str) -> Result<u32, LoadError> {
    // A node adds at most 64 elements to a list, eight times that at the root.
    if length > MAX_INDEX - 512 {
        return Err(LoadError::TooLarge { what, found: length as u64, limit: MAX_INDEX as u64 });
    }
    Ok(length as u32)
}

/// A node whose cells are still arriving.
#[derive(Debug, Default)]
struct Frame {
    /// Cells filled so far.
    mask: u64,
    /// What the octree cells of the level between look like.
    bytes: [PayloadWord; 8],
}

impl Frame {
    /// Fills a cell. Where the octree does not tell what the cells of a byte look like from afar, the first of them
    /// stands in.
    fn fill(&mut self, place: u32, look: PayloadWord) {
        self.mask |= 1 << place;
        let byte = &mut self.bytes[place as usize / 8];
        if byte.is_empty() {
            *byte = look;
        }
    }
}

/// An octree, or parts of one, being made.
#[derive(Debug)]
pub(crate) struct Assembly {
    pub lists: Lists,
    /// Children of nodes that are not complete. They are put side by side into the list when the last has come.
    pub waiting: Vec<Node>,
    /// Finest cells that are filled, of which a voxel above the finest level has many. No more than can be counted: a solid
    /// octree of more than 21 levels has that.
    pub leaf_voxels: u64,
}

impl Assembly {
    /// Nothing so far.
    pub fn new(lists: Lists) -> Self {
        Self { lists, waiting: Vec::new(), leaf_voxels: 0 }
    }

    /// Counts finest cells.
    pub fn count(&mut self, cells: u64) {
        self.leaf_voxels = self.leaf_voxels.saturating_add(cells);
    }

    /// Nothing again, in the same memory.
    pub fn clear(&mut self) {
        let Self { lists: Lists { nodes, voxels, lod }, waiting, leaf_voxels } = self;
        nodes.clear();
        voxels.clear();
        lod.clear();
        waiting.clear();
        *leaf_voxels = 0;
    }
}

/// What is in a cell at a cut, which is a cell of a node or the eight of a byte.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Look {
    /// Which cells are filled, from the first on. As many nodes have been added to those that wait.
    pub mask: u8,
    /// What it looks like from afar.
    pub own: PayloadWord,
}

/// Puts the next piece into an assembly.
pub(crate) type PutPiece<'a> = dyn FnMut(&mut Assembly) -> Result<Look, LoadError> + 'a;

/// Where the nodes of an octree come from: all of them from its cells, or those below a cut from pieces.
pub(crate) enum Below<'a> {
    /// There is no cut.
    Cells,
    /// Cells on this level that have children are pieces, which come in preorder.
    Pieces(u8, &'a mut PutPiece<'a>),
}

/// Makes nodes from cells.
pub(crate) struct Assembler<'a, C> {
    /// At least 1: a single voxel is traced as eight finer ones.
    depth: u8,
    cells: C,
    below: Below<'a>,
    assembly: &'a mut Assembly,
    /// Voxels of the leaf that is being made.
    leaf: Vec<PayloadWord>,
}

impl<'a, C: Cells> Assembler<'a, C> {
    /// What is made is added to `assembly`.
    pub fn new(depth: u8, assembly: &'a mut Assembly, cells: C, below: Below<'a>) -> Self {
        Self { depth: depth.max(1), cells, below, assembly, leaf: Vec::new() }
    }

    /// The root of the whole octree, if it is not empty. What is below is in the assembly.
    pub fn root(mut self) -> Result<Option<Node>, LoadError> {
        let root = self.cells.root()?;
        let covers_one_level = !self.depth.is_multiple_of(2);
        let node = match root {
            Cell::Empty => None,
            _ if covers_one_level => self.root_of_one_level(root)?,
            Cell::Node(own, children) => self.node(own, children, 0)?,
            Cell::Voxel(own) => self.solid_root(own)?,
        };
        Ok(node.map(|(node, _)| node))
    }

    /// The part of an octree in one cell of level `level`, of which the cells are. Its nodes wait in the assembly.
    pub fn piece(mut self, level: u8) -> Result<Look, LoadError> {
        let root = self.cells.root()?;
        let mut frame = Frame::default();
        if (self.depth - level).is_multiple_of(2) {
            self.cell(&mut frame, 0, root, level)?;
        } else {
            self.byte(&mut frame, 0, root, level)?;
        }
        // The other bytes are empty.
        Ok(Look { mask: frame.mask as u8, own: frame.bytes[0] })
    }

    /// A root that covers one level, in its first byte. If its cells are voxels, the pattern of that is in all eight: rays
    /// enter other octrees below the root.
    fn root_of_one_level(
        &mut self,
        root: Cell<C::Children>,
    ) -> Result<Option<(Node, PayloadWord)>, LoadError> {
        let (Cell::Voxel(own) | Cell::Node(own, _)) = root else { return Ok(None) };
        let mut frame = Frame::default();
        if self.depth > 1 {
            self.byte(&mut frame, 0, root, 0)?;
            return self.close_inner(&frame, own, 0);
        }
        self.byte_of_voxels(&mut frame, 0, root)?;
        self.leaf = self.leaf.repeat(8);
        frame.mask *= 0x0101_0101_0101_0101;
        frame.bytes = [frame.bytes[0]; 8];
        let node = self.close_leaf(&frame, own);
        // The seven repetitions are not there.
        self.assembly.leaf_voxels /= 8;
        node
    }

    /// A root that covers two levels and is the same throughout.
    fn solid_root(&mut self, own: PayloadWord) -> Result<Option<(Node, PayloadWord)>, LoadError> {
        let mut frame = Frame { mask: u64::MAX, bytes: [own; 8] };
        if self.depth == 2 {
            self.leaf = vec![own; 64];
            self.close_leaf(&frame, own)
        } else {
            self.uniform(&mut frame, 0..64, own, 0)?;
            self.close_inner(&frame, own, 0)
        }
    }

    /// The node of an octree cell on `level` and what it looks like, or nothing if none of its cells is filled.
    fn node(
        &mut self,
        own: PayloadWord,
        children: C::Children,
        level: u8,
    ) -> Result<Option<(Node, PayloadWord)>, LoadError> {
        let mut frame = Frame::default();
        if level + 2 == self.depth {
            if let Some(node) = self.cells.leaf(own, children, &mut self.assembly.lists)? {
                self.assembly.count(node.cells().count_ones().into());
                return Ok(Some((node, own)));
            }
            self.leaf.clear();
            for byte in ones(C::octants(children)) {
                let cell = self.cells.next(children)?;
                self.byte_of_voxels(&mut frame, byte, cell)?;
            }
            return self.close_leaf(&frame, own);
        }
        let first_waiting = self.assembly.waiting.len();
        for byte in ones(C::octants(children)) {
            let cell = self.cells.next(children)?;
            self.byte(&mut frame, byte, cell, level + 1)?;
        }
        self.close_inner(&frame, own, first_waiting)
    }

    /// A byte of a leaf's mask.
    #[inline]
    fn byte_of_voxels(
        &mut self,
        frame: &mut Frame,
        byte: u32,
        cell: Cell<C::Children>,
    ) -> Result<(), LoadError> {
        let (own, mask) = match cell {
            Cell::Empty => return Ok(()),
            Cell::Voxel(own) => {
                self.leaf.extend([own; 8]);
                (own, 0xFF)
            }
            Cell::Node(own, children) => (own, self.cells.finest(children, &mut self.leaf)?),
        };
        frame.mask |= u64::from(mask) << (8 * byte);
        frame.bytes[byte as usize] = own;
        Ok(())
    }

    /// A byte of an inner node's mask: an octree cell on `level`.
    fn byte(
        &mut self,
        frame: &mut Frame,
        byte: u32,
        cell: Cell<C::Children>,
        level: u8,
    ) -> Result<(), LoadError> {
        match cell {
            Cell::Empty => {}
            Cell::Voxel(own) => self.uniform(frame, 8 * byte..8 * byte + 8, own, level)?,
            Cell::Node(..) if self.is_cut(level) => self.put_piece(frame, 8 * byte)?,
            Cell::Node(own, children) => {
                frame.bytes[byte as usize] = own;
                for octant in ones(C::octants(children)) {
                    let cell = self.cells.next(children)?;
                    self.cell(frame, 8 * byte + octant, cell, level + 1)?;
                }
            }
        }
        Ok(())
    }

    /// A cell of an inner node, on `level`.
    fn cell(
        &mut self,
        frame: &mut Frame,
        place: u32,
        cell: Cell<C::Children>,
        level: u8,
    ) -> Result<(), LoadError> {
        match cell {
            Cell::Empty => {}
            Cell::Voxel(own) => self.uniform(frame, place..place + 1, own, level)?,
            Cell::Node(..) if self.is_cut(level) => self.put_piece(frame, place)?,
            Cell::Node(own, children) => {
                if let Some((node, look)) = self.node(own, children, level)? {
                    self.assembly.waiting.push(node);
                    frame.fill(place, look);
                }
            }
        }
        Ok(())
    }

    fn is_cut(&self, level: u8) -> bool {
        matches!(self.below, Below::Pieces(cut_level, _) if cut_level == level)
    }

    /// Puts in the next piece, whose first cell is at `place`.
    fn put_piece(&mut self, frame: &mut Frame, place: u32) -> Result<(), LoadError> {
        let Below::Pieces(_, put_piece) = &mut self.below else { return Ok(()) };
        let piece = put_piece(self.assembly)?;
        frame.mask |= u64::from(piece.mask) << place;
        let byte = &mut frame.bytes[place as usize / 8];
        if byte.is_empty() {
            *byte = piece.own;
        }
        Ok(())
    }

    /// Fills cells of an inner node with one voxel, which is on `level`.
    fn uniform(
        &mut self,
        frame: &mut Frame,
        places: std::ops::Range<u32>,
        voxel: PayloadWord,
        level: u8,
    ) -> Result<(), LoadError> {
        self.assembly.count(8_u64.saturating_pow((self.depth - level).into()));
        let node = Node::uniform(self.assembly.lists.next_voxel()?, self.assembly.lists.next_lod()?);
        self.assembly.lists.voxels.extend(&[voxel]);
        self.assembly.lists.lod.extend(&[voxel]);
        for place in places {
            self.assembly.waiting.push(node);
            frame.fill(place, voxel);
        }
        Ok(())
    }

    /// Ends a node whose cells are voxels. What does not say how it looks from afar looks like its first voxel.
    fn close_leaf(
        &mut self,
        frame: &Frame,
        own: PayloadWord,
    ) -> Result<Option<(Node, PayloadWord)>, LoadError> {
        if frame.mask == 0 {
            return Ok(None);
        }
        let node = self.assembly.lists.next_leaf(frame.mask)?;
        self.assembly.count(frame.mask.count_ones().into());
        let mut first = 0;
        let bytes = std::array::from_fn(|byte| {
            let voxels = (frame.mask >> (8 * byte) & 0xFF).count_ones() as usize;
            let look = frame.bytes[byte];
            let look = if voxels > 0 && look.is_empty() { self.leaf[first] } else { look };
            first += voxels;
            look
        });
        self.assembly.lists.voxels.extend(&self.leaf);
        let own = if own.is_empty() { self.leaf[0] } else { own };
        let look = self.add_levels_of_detail(&Frame { mask: frame.mask, bytes }, own);
        Ok(Some((node, look)))
    }

    /// Ends a node whose cells are the nodes that wait from `first_waiting` on.
    fn close_inner(
        &mut self,
        frame: &Frame,
        own: PayloadWord,
        first_waiting: usize,
    ) -> Result<Option<(Node, PayloadWord)>, LoadError> {
        if frame.mask == 0 {
            return Ok(None);
        }
        let node = Node::inner(frame.mask, self.assembly.lists.next_node()?, self.assembly.lists.next_lod()?);
        self.assembly.lists.nodes.extend(self.assembly.waiting.drain(first_waiting..));
        Ok(Some((node, self.add_levels_of_detail(frame, own))))
    }

    /// Adds what a node and its filled bytes look like, and returns the former.
    fn add_levels_of_detail(&mut self, frame: &Frame, own: PayloadWord) -> PayloadWord {
        let mut words = [own; 9];
        let mut count = 1;
        for byte in 0..8 {
            if frame.mask >> (8 * byte) & 0xFF != 0 {
                words[count] = frame.bytes[byte];
                count += 1;
            }
        }
        if own.is_empty() {
            words[0] = words[1];
        }
        self.assembly.lists.lod.extend(&words[..count]);
        words[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_that_a_file_makes_up_are_no_sums() {
        let levels = [LevelCount { voxels: u64::MAX, nodes: u64::MAX }; 6];
        let Capacity { nodes, voxels, lod } = Capacity::of_levels(5, &levels);
        assert_eq!([nodes, voxels, lod], [u64::MAX; 3]);
        let counts = [1, 3, 9, 20, 60].map(|nodes| LevelCount { voxels: nodes, nodes });
        let Capacity { nodes, voxels, lod } = Capacity::of_levels(4, &counts);
        assert_eq!([nodes, voxels, lod], [1 + 9, 60, 1 + 3 + 9 + 20]);
    }
}
