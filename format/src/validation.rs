//! Whether an octree makes sense, beyond being complete.

use crate::{Limits, Record};

/// A node that readers accept but that a well-made file does not have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Defect {
    /// The node is empty although a child is filled, so that it vanishes where levels of detail are used.
    #[error("byte {offset}: the node on level {level} is empty but has a filled child")]
    EmptyNode {
        /// Where the node begins in the file.
        offset: u64,
        /// Its level.
        level: u8,
    },
    /// All eight children of the node are empty; it should be empty itself and have no children.
    #[error("byte {offset}: the node on level {level} has eight empty children")]
    EmptyChildren {
        /// Where the node begins in the file.
        offset: u64,
        /// Its level.
        level: u8,
    },
}

impl Defect {
    /// Where the node begins in the file, in bytes.
    #[must_use]
    pub fn offset(&self) -> u64 {
        match *self {
            Self::EmptyNode { offset, .. } | Self::EmptyChildren { offset, .. } => offset,
        }
    }
}

/// A node whose children are being read.
#[derive(Debug, Clone, Copy, Default)]
struct OpenNode {
    offset: u64,
    octant: u8,
    filled: bool,
    has_filled_child: bool,
}

/// Collects the defects of an octree from its records, in constant memory.
#[derive(Debug, Default)]
pub(crate) struct Validator {
    /// The ancestors of the next record, by level.
    open: [OpenNode; Limits::MAX_DEPTH as usize],
    /// Number of defects.
    pub defects: u64,
    /// The defect that comes first in the file.
    pub first: Option<Defect>,
}

impl Validator {
    /// Takes the next record in preorder, which begins `offset` bytes after the beginning of the file.
    #[inline]
    pub fn add(&mut self, record: Record, offset: u64) {
        let Record { level, octant, voxel, has_children } = record;
        let filled = !voxel.is_empty();
        if filled && level > 0 {
            self.open[usize::from(level) - 1].has_filled_child = true;
        }
        if has_children {
            self.open[usize::from(level)] = OpenNode { offset, octant, filled, has_filled_child: false };
        } else if octant == 7 {
            self.close_nodes(level);
        }
    }

    /// Judges the nodes that are complete with the last record of `level`.
    fn close_nodes(&mut self, mut level: u8) {
        while level > 0 {
            level -= 1;
            let node = self.open[usize::from(level)];
            let offset = node.offset;
            if !node.has_filled_child {
                self.report(Defect::EmptyChildren { offset, level });
            } else if !node.filled {
                self.report(Defect::EmptyNode { offset, level });
            }
            if node.octant < 7 {
                return;
            }
        }
    }

    #[cold]
    fn report(&mut self, defect: Defect) {
        self.defects += 1;
        if self.first.is_none_or(|first| defect.offset() < first.offset()) {
            self.first = Some(defect);
        }
    }
}
