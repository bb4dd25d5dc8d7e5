//! From records in preorder to subtrees and the top of the tree above them.

use super::{Header, LevelDefect, Levels, Planes, Subtree};
use crate::{Limits, Record};

/// Cuts an octree, whose records arrive in preorder, into subtrees.
///
/// In memory stay the levels above the cut and one subtree. The octree must make sense: a node is filled if and only if
/// one of its children is.
#[derive(Debug)]
pub(crate) struct Splitter {
    depth: u8,
    cut_level: u8,
    /// The voxels so far of each level: above the cut all of them, below those of the open subtree.
    levels: Vec<Planes>,
    /// The octants of the last voxel and its ancestors, by level.
    path: [u8; Limits::MAX_DEPTH as usize + 1],
    /// Morton code of the open subtree's cell.
    open: Option<u64>,
}

impl Splitter {
    /// For an octree that is no deeper than the header says.
    pub fn new(header: &Header) -> Self {
        Self {
            depth: header.depth,
            cut_level: header.cut_level,
            levels: vec![Planes::default(); usize::from(header.depth) + 1],
            path: [0; Limits::MAX_DEPTH as usize + 1],
            open: None,
        }
    }

    /// Takes the next record, and its normal in the code of the file. If it does not belong to the open subtree any more,
    /// that is complete and is returned.
    pub fn add(&mut self, record: &Record, normal: [u8; 2]) -> Result<Option<Subtree>, LevelDefect> {
        if record.voxel.is_empty() {
            return Ok(None);
        }
        let complete = if record.level <= self.cut_level { self.close()? } else { None };
        let level = usize::from(record.level);
        self.path[level] = record.octant;
        if level > 0
            && let Some(mask) = self.levels[level - 1].masks.last_mut()
        {
            *mask |= 1 << record.octant;
        }
        let planes = &mut self.levels[level];
        if record.level < self.depth {
            planes.masks.push(0);
        }
        planes.palette_indices.push(record.voxel.palette_index);
        planes.normals.push(normal);
        if record.level == self.cut_level {
            let octants = &self.path[1..=level];
            self.open = Some(octants.iter().fold(0, |code, octant| code << 3 | u64::from(*octant)));
        }
        Ok(complete)
    }

    /// The last subtree, and the top of the tree.
    pub fn finish(mut self) -> Result<(Option<Subtree>, Levels), LevelDefect> {
        let last = self.close()?;
        let above = usize::from(self.cut_level);
        let top = Levels::top(self.cut_level, join(&mut self.levels[..above]))?;
        Ok((last, top))
    }

    /// Takes the open subtree, if there is one.
    fn close(&mut self) -> Result<Option<Subtree>, LevelDefect> {
        let Some(code) = self.open.take() else { return Ok(None) };
        let planes = join(&mut self.levels[usize::from(self.cut_level)..]);
        Ok(Some(Subtree { code, levels: Levels::subtree(self.cut_level, self.depth, planes)? }))
    }
}

/// The voxels of some levels, which are empty then but keep their memory.
fn join(levels: &mut [Planes]) -> Planes {
    let mut joined = Planes::default();
    for level in levels {
        joined.masks.append(&mut level.masks);
        joined.palette_indices.append(&mut level.palette_indices);
        joined.normals.append(&mut level.normals);
    }
    joined
}
