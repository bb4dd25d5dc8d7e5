//! The octree in memory: structure, payload apart from it, and the grid through which rays enter.

use crate::bits::ones;
use crate::builder::load;
use crate::grid::Grid;
use crate::node::Node;
use crate::payload::PayloadList;
use crate::{LoadError, Payload};
use glam::DVec3;
use octvox_format::v5::Seekable;
use octvox_format::{MaterialPalette, NormalCode, WorldTransform};
use std::fs::File;
use std::io::{Read, Seek};
use std::path::Path;

/// A voxel octree made ready for rays.
///
/// The cube is [1, 2]³ in the traversal's space (unit space plus one), so that the bits of a coordinate's
/// mantissa are the path from the root to a cell. A node covers two octree levels. Where the depth is odd the
/// root covers one, and its cells are in its first byte: rays enter below it. Only if the depth is one they cannot, and the
/// pattern is repeated in all eight bytes: the two bits that select the root's cell are then the highest bit of the
/// mantissa and the lowest of the exponent, and the latter may be anything.
#[derive(Debug)]
pub struct Octree {
    pub(crate) depth: u8,
    pub(crate) materials: MaterialPalette,
    pub(crate) normal_code: NormalCode,
    pub(crate) world: Option<WorldTransform>,
    pub(crate) nodes: Vec<Node>,
    pub(crate) root: u32,
    pub(crate) voxels: PayloadList,
    pub(crate) lod: PayloadList,
    pub(crate) leaf_voxels: u64,
    pub(crate) bounds: Bounds,
    pub(crate) grid: Grid,
    /// The smallest grid: where rays enter that may stop above the other.
    pub(crate) root_entrance: Grid,
}

/// A box of finest cells: `low` inclusive, `high` exclusive, per axis. Empty if `low` equals `high`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bounds {
    /// The smallest coordinates of a filled cell.
    pub low: [u32; 3],
    /// One more than the largest coordinates of a filled cell.
    pub high: [u32; 3],
}

impl Bounds {
    /// Low and high corner in the traversal's space, where the cube is [1, 2]³.
    #[inline(always)]
    pub(crate) fn corners(&self, depth: u8) -> [[f32; 3]; 2] {
        let size = (1u32 << depth) as f32;
        [self.low, self.high].map(|corner| corner.map(|cell| 1.0 + cell as f32 / size))
    }
}

impl Octree {
    /// Reads a `.vox` file of any version on the current thread pool, with the grid of the size that suits most models.
    ///
    /// # Errors
    /// If the file cannot be read or is not a valid `.vox`, with what and where.
    pub fn open(path: &Path) -> Result<Self, LoadError> {
        let in_file = |error| LoadError::InFile { path: path.to_path_buf(), error: Box::new(error) };
        let file = File::open(path).map_err(LoadError::Read).map_err(in_file)?;
        Self::read(file).map_err(in_file)
    }

    /// Reads a `.vox` of any version from its beginning to its end, and parts of it again. `input` need not be
    /// buffered. Beside the octree not much of it is in memory at a time.
    ///
    /// # Errors
    /// If `input` cannot be read or is not a valid `.vox`.
    pub fn read(input: impl Read + Seek + Send) -> Result<Self, LoadError> {
        load(Seekable::new(input))
    }

    /// As [`Octree::read`], from a file in memory, of which nothing is copied.
    ///
    /// # Errors
    /// If `bytes` are not a valid `.vox`.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, LoadError> {
        load(bytes)
    }

    /// Enters the octree through a grid of `1 << level` cells per axis, or at the root if `level` is 0.
    pub fn set_grid(&mut self, level: u8) {
        self.grid = Grid::new(self, level.min(Grid::MAX_LEVEL));
    }

    /// Where rays enter whose footprint is no smaller than `footprint` anywhere, in unit space: through the grid, or
    /// at the root if they may stop at cells larger than those of the grid.
    pub(crate) fn entrance(&self, footprint: f64) -> &Grid {
        let is_coarser = footprint * f64::from(self.grid_size()) > 1.0;
        if is_coarser { &self.root_entrance } else { &self.grid }
    }

    /// Levels below the root; the finest cells are on this level.
    #[must_use]
    pub fn depth(&self) -> u8 {
        self.depth
    }

    /// Finest cells along each axis.
    #[must_use]
    pub fn resolution(&self) -> u32 {
        1 << self.depth
    }

    /// Filled cells at the finest level.
    #[must_use]
    pub fn leaf_voxels(&self) -> u64 {
        self.leaf_voxels
    }

    /// What the voxels are made of; of version 4, colours alone.
    #[must_use]
    pub fn palette(&self) -> &MaterialPalette {
        &self.materials
    }

    /// For each entry of the palette, whether some voxel has it, or stands for voxels seen from afar with it.
    #[must_use]
    pub fn used_palette_entries(&self) -> Vec<bool> {
        let mut used = self.voxels.used_entries(self.materials.len());
        for (used, seen_from_afar) in used.iter_mut().zip(self.lod.used_entries(self.materials.len())) {
            *used |= seen_from_afar;
        }
        used
    }

    /// Where the cube lies in the world, if the file tells.
    #[must_use]
    pub fn world(&self) -> Option<WorldTransform> {
        self.world
    }

    /// The smallest box around the filled cells.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// The smallest box around the filled cells in unit space, low corner and high corner.
    #[must_use]
    pub fn unit_bounds(&self) -> [[f64; 3]; 2] {
        let size = f64::from(self.resolution());
        [self.bounds.low, self.bounds.high].map(|corner| corner.map(|cell| f64::from(cell) / size))
    }

    /// Points that show where the model is, in unit space: of the corners of its filled cells on a coarse level those that are
    /// the first or the last along an axis. All others lie between some of these, so no picture shows less for it.
    pub(crate) fn outline(&self) -> Vec<DVec3> {
        const LEVEL: u8 = 5;
        let grid = Grid::new(self, LEVEL);
        let cells = 1usize << grid.level();
        let side = cells + 1;
        let index = |[x, y, z]: [usize; 3]| (z * side + y) * side + x;
        let mut is_corner = vec![false; side * side * side];
        for cell in grid.filled_cells() {
            for number in 0..8 {
                is_corner[index(std::array::from_fn(|axis| cell[axis] + (number >> axis & 1)))] = true;
            }
        }
        let mut is_end = [0, 1, 2].map(|_| vec![false; is_corner.len()]);
        for (axis, is_end) in is_end.iter_mut().enumerate() {
            for line in 0..side * side {
                let at = |along: usize| {
                    let mut place = [0; 3];
                    place[axis] = along;
                    place[(axis + 1) % 3] = line % side;
                    place[(axis + 2) % 3] = line / side;
                    index(place)
                };
                let found = |&along: &usize| is_corner[at(along)];
                let ends = (0..side).find(found).into_iter().chain((0..side).rfind(found));
                ends.for_each(|along| is_end[at(along)] = true);
            }
        }
        let places = (0..is_corner.len()).filter(|&place| is_end.iter().all(|is_end| is_end[place]));
        let [low, high] = self.unit_bounds().map(DVec3::from_array);
        // A coarse cell is rarely filled to its corners, the box around the voxels always is.
        places
            .map(|place| [place % side, place / side % side, place / side / side])
            .map(|corner| DVec3::from_array(corner.map(|part| part as f64 / cells as f64)).clamp(low, high))
            .collect()
    }

    /// Cells per axis of the grid through which rays enter; 0 if they start at the root.
    #[must_use]
    pub fn grid_size(&self) -> u32 {
        self.grid.size()
    }

    /// Bytes that tracing and shading use: structure, payload and grid.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.bytes_by_part().iter().sum()
    }

    /// Bytes of the structure, of the payload of voxels, of the payload of levels of detail, and of the grid.
    #[must_use]
    pub fn bytes_by_part(&self) -> [u64; 4] {
        [
            size_of_val(self.nodes.as_slice()) as u64,
            self.voxels.byte_length() as u64,
            self.lod.byte_length() as u64,
            self.grid.bytes() as u64,
        ]
    }

    /// Whether the finest cell at these coordinates is filled. Coordinates beyond the cube are not.
    #[must_use]
    pub fn is_filled(&self, cell: [u32; 3]) -> bool {
        self.find(cell).is_some()
    }

    /// The payload of the finest cell at these coordinates, if it is filled.
    #[must_use]
    pub fn voxel(&self, cell: [u32; 3]) -> Option<Payload> {
        self.find(cell).map(|index| Payload::new(self.voxels.get(index), self.normal_code))
    }

    /// Gives `visit` the coordinates and the payload of each filled finest cell from `low` to `high`, both inclusive.
    pub(crate) fn for_each_voxel(
        &self,
        low: [u32; 3],
        high: [u32; 3],
        visit: &mut impl FnMut([u32; 3], Payload),
    ) {
        let Some(root) = self.nodes.get(self.root as usize) else { return };
        // A root of one level has its cells in the first byte.
        let cells = if self.depth.is_multiple_of(2) { u64::MAX } else { 0xFF };
        self.for_each_voxel_of(root, cells, [0; 3], root_exponent(self.depth), [low, high], visit);
    }

    /// As [`Octree::for_each_voxel`], for some cells of a node of cells of size `1 << exponent`, whose low corner is `corner`.
    fn for_each_voxel_of(
        &self,
        node: &Node,
        cells: u64,
        corner: [u32; 3],
        exponent: u32,
        bounds: [[u32; 3]; 2],
        visit: &mut impl FnMut([u32; 3], Payload),
    ) {
        let finest = finest_exponent(self.depth);
        for place in ones(node.cells() & cells) {
            let steps = cell_of_morton(place);
            // A leaf node may have cells finer than the finest, where there are several to one.
            let first = std::array::from_fn(|axis| corner[axis] + (steps[axis] << exponent >> finest));
            let last: [u32; 3] = std::array::from_fn(|axis| {
                corner[axis] + ((steps[axis] + 1) << exponent >> finest).max(1) - 1
            });
            if (0..3).any(|axis| last[axis] < bounds[0][axis] || first[axis] > bounds[1][axis]) {
                continue;
            }
            let index = node.index_of(place);
            if !node.is_leaf() {
                let child = &self.nodes[index as usize];
                self.for_each_voxel_of(child, u64::MAX, first, exponent - 2, bounds, visit);
                continue;
            }
            let payload = Payload::new(self.voxels.get(index), self.normal_code);
            let along = |axis: usize| first[axis].max(bounds[0][axis])..=last[axis].min(bounds[1][axis]);
            for z in along(2) {
                for y in along(1) {
                    along(0).for_each(|x| visit([x, y, z], payload));
                }
            }
        }
    }

    /// Index of the voxel at these coordinates.
    fn find(&self, cell: [u32; 3]) -> Option<u32> {
        match self.locate(cell) {
            Location::Voxel { index, .. } => Some(index),
            Location::Empty { .. } => None,
        }
    }

    /// Exponent of the cells of the leaf node that holds a place in a filled cell. Of the place, the mantissa counts.
    pub(crate) fn leaf_exponent(&self, place: [u32; 3]) -> u32 {
        let mut node = &self.nodes[self.root as usize];
        let mut exponent = root_exponent(self.depth);
        while !node.is_leaf() {
            let cell = place.map(|bits| (bits & MANTISSA) >> exponent & 3);
            node = &self.nodes[node.index_of(morton_cell(cell)) as usize];
            exponent -= 2;
        }
        exponent
    }

    /// What is at a finest cell of the cube.
    pub(crate) fn locate(&self, cell: [u32; 3]) -> Location {
        let inside = cell.iter().all(|&coordinate| coordinate < self.resolution());
        let Some(mut node) = self.nodes.get(self.root as usize).filter(|_| inside) else {
            return Location::Empty { size_log2: u32::from(self.depth), node: self.root, place: 0 };
        };
        let mut index = self.root;
        // Mantissa bits of the cell, whose lower half is left over in cells finer than the finest.
        let mantissa = cell.map(|coordinate| coordinate << finest_exponent(self.depth));
        let mut exponent = root_exponent(self.depth);
        loop {
            let place = morton_cell(mantissa.map(|bits| bits >> exponent & 3));
            let cells = node.cells();
            if cells >> place & 1 == 0 {
                let byte_is_empty = cells >> (place & !7) & 0xFF == 0;
                let size_exponent = exponent + u32::from(byte_is_empty);
                let size_log2 = size_exponent - finest_exponent(self.depth);
                let place = if byte_is_empty { place & !7 } else { place };
                return Location::Empty { size_log2, node: index, place };
            }
            if node.is_leaf() {
                return Location::Voxel { index: node.index_of(place), node: index, place };
            }
            index = node.index_of(place);
            node = &self.nodes[index as usize];
            exponent -= 2;
        }
    }
}

/// What is at a finest cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Location {
    /// A voxel with this index, in a cell of this node.
    Voxel { index: u32, node: u32, place: u32 },
    /// Nothing, nor in the aligned cube of `1 << size_log2` finest cells per axis around it, which is a cell of
    /// this node or a byte of such, named by its first cell.
    Empty { size_log2: u32, node: u32, place: u32 },
}

/// Bits of a float's fraction.
pub(crate) const MANTISSA_BITS: u32 = 23;

/// The bits of a coordinate in [1, 2) that differ from place to place.
pub(crate) const MANTISSA: u32 = (1 << MANTISSA_BITS) - 1;

/// The deepest octree that can be traced: one bit of a coordinate stays free, to keep rays that run parallel to a
/// plane off it.
pub(crate) const MAX_DEPTH: u8 = MANTISSA_BITS as u8 - 1;

/// The place of the lower of the two mantissa bits that select a cell of the root.
pub(crate) const fn root_exponent(depth: u8) -> u32 {
    if depth.is_multiple_of(2) && depth > 0 { MANTISSA_BITS - 2 } else { MANTISSA_BITS - 1 }
}

/// The place of the mantissa bit that tells neighbouring finest cells apart.
pub(crate) const fn finest_exponent(depth: u8) -> u32 {
    MANTISSA_BITS - depth as u32
}

/// Morton order of the 4×4×4 cells of a node, from two bits per axis.
pub(crate) const fn morton_cell([x, y, z]: [u32; 3]) -> u32 {
    const fn spread(bits: u32) -> u32 {
        bits & 1 | (bits & 2) << 2
    }
    spread(x) | spread(y) << 1 | spread(z) << 2
}

/// The two bits per axis that [`morton_cell`] packed.
pub(crate) const fn cell_of_morton(place: u32) -> [u32; 3] {
    const fn gather(bits: u32) -> u32 {
        bits & 1 | bits >> 2 & 2
    }
    [gather(place), gather(place >> 1), gather(place >> 2)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn morton_order_and_back() {
        for place in 0..64 {
            assert_eq!(morton_cell(cell_of_morton(place)), place);
        }
        assert_eq!(morton_cell([1, 0, 0]), 1);
        assert_eq!(morton_cell([0, 1, 0]), 2);
        assert_eq!(morton_cell([0, 0, 1]), 4);
        assert_eq!(morton_cell([2, 0, 0]), 8);
    }
}
