//! Parts of an octree that are made in parallel.

use super::assembly::Lists;
use crate::LoadError;
use crate::node::Node;
use crate::payload::PayloadWord;
use rayon::prelude::*;
use std::collections::VecDeque;
use std::ops::Range;

/// Voxels of the file from which pieces are made at once. Enough for all threads; little beside a large octree, so
/// that in the end there is not much more in memory than that.
const BATCH_VOXELS: u64 = 1 << 21;

/// The part of an octree below a cut: the nodes in one cell of a node, or in the eight of a byte.
#[derive(Debug)]
pub(crate) struct Piece {
    /// What is below the nodes. Indices count from the beginning of these lists.
    pub lists: Lists,
    /// Which cells are filled, from the first of the piece on.
    pub mask: u8,
    /// The nodes of the filled cells.
    pub children: Vec<Node>,
    /// What the piece looks like from afar.
    pub own: PayloadWord,
}

/// The pieces of an octree in preorder, made in batches on the current thread pool.
pub(crate) struct Pieces<'a, M> {
    /// How many voxels each piece is made from.
    sizes: &'a [u64],
    make: M,
    /// Pieces handed out or ready.
    made: usize,
    ready: VecDeque<Result<Piece, LoadError>>,
}

impl<'a, M: Fn(usize) -> Result<Piece, LoadError> + Sync> Pieces<'a, M> {
    /// `make` makes the piece with a number, from so many voxels as `sizes` says.
    pub fn new(sizes: &'a [u64], make: M) -> Self {
        Self { sizes, make, made: 0, ready: VecDeque::new() }
    }

    /// The next piece. There is one for each cell at the cut that has children.
    pub fn next(&mut self) -> Result<Piece, LoadError> {
        if self.ready.is_empty() {
            let batch = self.next_batch();
            self.made = batch.end;
            self.ready = batch.into_par_iter().with_max_len(1).map(&self.make).collect();
        }
        self.ready.pop_front().unwrap_or(Err(LoadError::Changed))
    }

    fn next_batch(&self) -> Range<usize> {
        let mut voxels = 0;
        let sizes = &self.sizes[self.made..];
        let count = sizes.iter().take_while(|&&size| {
            let has_room = voxels < BATCH_VOXELS;
            voxels += size;
            has_room
        });
        self.made..self.made + count.count()
    }
}
