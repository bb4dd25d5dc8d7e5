//! Parts of an octree that are made in parallel.

use super::assembly::{Assembler, Assembly, Below, Cells, Lists, Look, PutPiece};
use crate::LoadError;
use crate::node::Place;
use rayon::Yield;
use std::collections::VecDeque;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Voxels of the file from which pieces are made before they are taken. Enough for all threads; little beside a large
/// octree, so that in the end there is not much more in memory than that.
const VOXELS_AHEAD: u64 = 1 << 21;

/// Consecutive parts of an octree below a cut: for each the nodes in one cell of a node, or in the eight of a byte.
#[derive(Debug)]
pub(crate) struct Pieces {
    /// What is below the nodes of all of them. The nodes themselves wait.
    assembly: Assembly,
    pieces: VecDeque<Piece>,
    /// Where the first of the pieces begins.
    start: Start,
}

#[derive(Debug)]
struct Piece {
    look: Look,
    /// Where the next piece begins.
    end: Start,
}

/// Where a piece begins in the lists of all, among the nodes that wait, and in the count of finest cells.
#[derive(Debug, Clone, Copy)]
struct Start {
    place: Place,
    waiting: usize,
    leaf_voxels: u64,
}

impl Pieces {
    /// None, to be made in an empty assembly.
    fn new(assembly: Assembly) -> Self {
        let start = Start { place: Place::START, waiting: 0, leaf_voxels: 0 };
        Self { assembly, pieces: VecDeque::new(), start }
    }

    /// Makes one more, from the cells of an octree's part in one cell on `level`.
    pub fn add(&mut self, depth: u8, level: u8, cells: impl Cells) -> Result<(), LoadError> {
        let look = Assembler::new(depth, &mut self.assembly, cells, Below::Cells).piece(level)?;
        let Assembly { lists, waiting, leaf_voxels } = &self.assembly;
        let end = Start { place: lists.end()?, waiting: waiting.len(), leaf_voxels: *leaf_voxels };
        self.pieces.push_back(Piece { look, end });
        Ok(())
    }

    /// Takes the first and puts it into an assembly.
    fn put_first(&mut self, assembly: &mut Assembly) -> Result<Look, LoadError> {
        let Some(Piece { look, end }) = self.pieces.pop_front() else { return Err(LoadError::Changed) };
        let moved = assembly.lists.append(&self.assembly.lists, self.start.place, end.place)?;
        let nodes = &self.assembly.waiting[self.start.waiting..end.waiting];
        assembly.waiting.extend(nodes.iter().map(|node| node.moved(moved)));
        assembly.count(end.leaf_voxels - self.start.leaf_voxels);
        self.start = end;
        Ok(look)
    }
}

/// Makes pieces on the current thread pool while `use_pieces` has them put into its assembly, in preorder. There is one
/// for each cell at the cut that has children.
///
/// `make` adds the pieces with a number to what is empty, from so many voxels as `sizes` says. The palette has so many
/// entries.
pub(crate) fn with_pieces<R: Send>(
    palette_size: usize,
    sizes: &[u64],
    make: impl Fn(usize, &mut Pieces) -> Result<(), LoadError> + Sync,
    use_pieces: impl FnOnce(&mut PutPiece<'_>) -> R + Send,
) -> R {
    // Memory of pieces that have been put in. To ask the system for it again and again takes a tenth of the time.
    let spare = Mutex::new(Vec::new());
    let make = &|number| {
        let assembly = lock(&spare).pop().unwrap_or_else(|| Assembly::new(Lists::new(palette_size)));
        let mut pieces = Pieces::new(assembly);
        make(number, &mut pieces).map(|()| pieces)
    };
    rayon::scope_fifo(|scope| {
        let mut waiting = VecDeque::new();
        let mut rest = sizes.iter().enumerate();
        let mut voxels_ahead = 0;
        let mut next_pieces = || {
            while voxels_ahead < VOXELS_AHEAD {
                let Some((number, &size)) = rest.next() else { break };
                let (sender, receiver) = channel();
                // Whoever does not want the pieces any more has met an error.
                scope.spawn_fifo(move |_| drop(sender.send(make(number))));
                waiting.push_back((receiver, size));
                voxels_ahead += size;
            }
            let Some((receiver, size)) = waiting.pop_front() else { return Err(LoadError::Changed) };
            voxels_ahead -= size;
            receive(&receiver)
        };
        let mut pieces = None::<Pieces>;
        use_pieces(&mut |assembly| loop {
            match &mut pieces {
                Some(pieces) if !pieces.pieces.is_empty() => return pieces.put_first(assembly),
                _ => {
                    if let Some(Pieces { mut assembly, .. }) = pieces.take() {
                        assembly.clear();
                        lock(&spare).push(assembly);
                    }
                    pieces = Some(next_pieces()?);
                }
            }
        })
    })
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Waits for pieces, and makes others meanwhile.
fn receive(receiver: &Receiver<Result<Pieces, LoadError>>) -> Result<Pieces, LoadError> {
    loop {
        match receiver.try_recv() {
            Ok(pieces) => return pieces,
            Err(TryRecvError::Empty) => {
                if rayon::yield_now() != Some(Yield::Executed) {
                    // Another thread is at it.
                    return receiver.recv().unwrap_or(Err(LoadError::Changed));
                }
            }
            // Its maker has panicked, which the scope passes on.
            Err(TryRecvError::Disconnected) => return Err(LoadError::Changed),
        }
    }
}
