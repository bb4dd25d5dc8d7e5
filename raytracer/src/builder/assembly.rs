//! Nodes of two levels from the cells of an octree, in preorder.

use super::pieces::Piece;
use crate::LoadError;
use crate::node::{MAX_INDEX, Node, Place};
use crate::payload::{PayloadList, PayloadWord};

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
}

/// The lists that an octree is made of.
#[derive(Debug)]
pub(crate) struct Lists {
    /// Without the root, which comes last.
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

    /// Appends those of a piece and returns where they begin.
    fn append(&mut self, piece: &Self) -> Result<Place, LoadError> {
        let place = Place { nodes: self.next_node()?, voxels: self.next_voxel()?, lod: self.next_lod()? };
        self.nodes.extend(piece.nodes.iter().map(|node| node.moved(place)));
        self.voxels.append(&piece.voxels);
        self.lod.append(&piece.lod);
        // Whatever was moved there has an index.
        self.next_node()?;
        self.next_voxel()?;
        self.next_lod()?;
        Ok(place)
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

/// The places of the bits that are set, from the lowest on.
fn ones(mut bits: u8) -> impl Iterator<Item = u32> {
    std::iter::from_fn(move || {
        let place = (bits != 0).then(|| bits.trailing_zeros())?;
        bits &= bits - 1;
        Some(place)
    })
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

/// Where the nodes of an octree come from: all of them from its cells, or those below a cut from pieces.
pub(crate) enum Below<'a> {
    /// There is no cut.
    Cells,
    /// Cells on this level that have children are pieces, which come in preorder.
    Pieces(u8, &'a mut dyn FnMut() -> Result<Piece, LoadError>),
}

/// Makes nodes from cells.
pub(crate) struct Assembler<'a, C> {
    /// At least 1: a single voxel is traced as eight finer ones.
    depth: u8,
    cells: C,
    below: Below<'a>,
    lists: Lists,
    /// Children of open nodes. They are put side by side into the list when the last has come.
    waiting: Vec<Node>,
    /// Voxels of the leaf that is being made.
    leaf: Vec<PayloadWord>,
}

impl<'a, C: Cells> Assembler<'a, C> {
    pub fn new(depth: u8, palette_size: usize, cells: C, below: Below<'a>) -> Self {
        let lists = Lists::new(palette_size);
        Self { depth: depth.max(1), cells, below, lists, waiting: Vec::new(), leaf: Vec::new() }
    }

    /// The whole octree: its lists, and its root if it is not empty.
    pub fn octree(mut self) -> Result<(Lists, Option<Node>), LoadError> {
        let root = self.cells.root()?;
        let covers_one_level = !self.depth.is_multiple_of(2);
        let node = match root {
            Cell::Empty => None,
            _ if covers_one_level => self.repeated_root(root)?,
            Cell::Node(own, children) => self.node(own, children, 0)?,
            Cell::Voxel(own) => self.solid_root(own)?,
        };
        Ok((self.lists, node.map(|(node, _)| node)))
    }

    /// The part of an octree in one cell of level `level`, of which `cells` are.
    pub fn piece(mut self, level: u8) -> Result<Piece, LoadError> {
        let root = self.cells.root()?;
        let mut frame = Frame::default();
        if (self.depth - level).is_multiple_of(2) {
            self.cell(&mut frame, 0, root, level)?;
        } else {
            self.byte(&mut frame, 0, root, level)?;
        }
        // The other bytes are empty.
        let (mask, own) = (frame.mask as u8, frame.bytes[0]);
        Ok(Piece { lists: self.lists, mask, own, children: self.waiting })
    }

    /// A root that covers one level: the pattern of its first byte is in all eight.
    fn repeated_root(&mut self, root: Cell<C::Children>) -> Result<Option<(Node, PayloadWord)>, LoadError> {
        let (Cell::Voxel(own) | Cell::Node(own, _)) = root else { return Ok(None) };
        let mut frame = Frame::default();
        if self.depth == 1 {
            self.byte_of_voxels(&mut frame, 0, root)?;
            self.leaf = self.leaf.repeat(8);
        } else {
            self.byte(&mut frame, 0, root, 0)?;
            self.waiting = self.waiting.repeat(8);
        }
        frame.mask *= 0x0101_0101_0101_0101;
        frame.bytes = [frame.bytes[0]; 8];
        if self.depth == 1 { self.close_leaf(&frame, own) } else { self.close_inner(&frame, own, 0) }
    }

    /// A root that covers two levels and is the same throughout.
    fn solid_root(&mut self, own: PayloadWord) -> Result<Option<(Node, PayloadWord)>, LoadError> {
        let mut frame = Frame { mask: u64::MAX, bytes: [own; 8] };
        if self.depth == 2 {
            self.leaf = vec![own; 64];
            self.close_leaf(&frame, own)
        } else {
            self.uniform(&mut frame, 0..64, own)?;
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
            self.leaf.clear();
            for byte in ones(C::octants(children)) {
                let cell = self.cells.next(children)?;
                self.byte_of_voxels(&mut frame, byte, cell)?;
            }
            return self.close_leaf(&frame, own);
        }
        let first_waiting = self.waiting.len();
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
            Cell::Voxel(own) => self.uniform(frame, 8 * byte..8 * byte + 8, own)?,
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
            Cell::Voxel(own) => self.uniform(frame, place..place + 1, own)?,
            Cell::Node(..) if self.is_cut(level) => self.put_piece(frame, place)?,
            Cell::Node(own, children) => {
                if let Some((node, look)) = self.node(own, children, level)? {
                    self.waiting.push(node);
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
        let Below::Pieces(_, next_piece) = &mut self.below else { return Ok(()) };
        let piece = next_piece()?;
        let start = self.lists.append(&piece.lists)?;
        self.waiting.extend(piece.children.iter().map(|node| node.moved(start)));
        frame.mask |= u64::from(piece.mask) << place;
        let byte = &mut frame.bytes[place as usize / 8];
        if byte.is_empty() {
            *byte = piece.own;
        }
        Ok(())
    }

    /// Fills cells of an inner node with one voxel.
    fn uniform(
        &mut self,
        frame: &mut Frame,
        places: std::ops::Range<u32>,
        voxel: PayloadWord,
    ) -> Result<(), LoadError> {
        let node = Node::uniform(self.lists.next_voxel()?, self.lists.next_lod()?);
        self.lists.voxels.extend(&[voxel]);
        self.lists.lod.extend(&[voxel]);
        for place in places {
            self.waiting.push(node);
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
        let node = Node::leaf(frame.mask, self.lists.next_voxel()?, self.lists.next_lod()?);
        let mut first = 0;
        let bytes = std::array::from_fn(|byte| {
            let voxels = (frame.mask >> (8 * byte) & 0xFF).count_ones() as usize;
            let look = frame.bytes[byte];
            let look = if voxels > 0 && look.is_empty() { self.leaf[first] } else { look };
            first += voxels;
            look
        });
        self.lists.voxels.extend(&self.leaf);
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
        let node = Node::inner(frame.mask, self.lists.next_node()?, self.lists.next_lod()?);
        self.lists.nodes.extend(self.waiting.drain(first_waiting..));
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
        self.lists.lod.extend(&words[..count]);
        words[0]
    }
}
