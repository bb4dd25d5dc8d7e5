//! Primary rays: what is seen through the pixels of a tile.

use crate::beam::{BEAM_SIZE, Beam, PlacedNode};
use crate::bundle::{Workspace, trace_together};
use crate::camera::{PixelBlock, View};
use crate::departure::Departures;
use crate::lanes::{Lanes, MAX_LANES};
use crate::octree::Octree;
use crate::ray::{Packet, Placement};
use crate::tile::{TILE_SIZE, Tile};
use crate::traversal::{Hits, Target, trace};

/// What one sees of a target from somewhere.
pub(crate) struct Primary<'a> {
    pub target: Target<'a>,
    pub view: View,
    /// Whether the rays of a beam go together.
    pub beams: bool,
    /// How far beyond the edge of a pixel its rays may be, in pixels.
    pub margin: f64,
}

/// A packet of primary rays, and what they met.
pub(crate) struct Seen<'a, L: Lanes> {
    pub block: &'a PixelBlock<L>,
    /// If the eye is far from the cube, how to read the distances of the hits.
    pub placements: Option<[Placement; MAX_LANES]>,
    pub hits: &'a Hits<L>,
    /// If they met something, the rays, and a place in each cell that was met: see [`trace`].
    place: Option<(&'a Packet<L>, [L::Word; 3])>,
}

impl<L: Lanes> Seen<'_, L> {
    /// Where the rays met something.
    pub fn departures(&self, octree: &Octree) -> Option<Departures> {
        self.place.map(|(packet, place)| Departures::new(octree, packet, self.hits, place))
    }
}

/// Where the beams of a tile begin.
pub(crate) struct Seeds {
    /// Nodes; none if no ray of the tile meets anything.
    nodes: Vec<PlacedNode>,
    /// They stand front to back for rays that are mirrored like this.
    mirrored: Option<[bool; 3]>,
}

impl Seeds {
    /// Whether no ray of the tile meets anything.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }
}

impl<'a> Primary<'a> {
    /// A target as seen from somewhere, with rays that end at cells that look no larger than `lod_pixels`.
    pub fn new(octree: &'a Octree, view: View, lod_pixels: f64, beams: bool) -> Self {
        Self { target: Target::new(octree, &view, lod_pixels), view, beams, margin: 0.0 }
    }

    /// Where the beams of a tile begin, for any number of samples in its pixels; `None` if there are no beams.
    pub fn seeds<L: Lanes>(&self, tile: &Tile, workspace: &mut Workspace<L>) -> Option<Seeds> {
        // From afar each ray has an origin of its own.
        if !self.beams || !self.view.is_near() {
            return None;
        }
        let whole = Beam::new::<L::Rough>(&self.view, [tile.x, tile.y], TILE_SIZE, self.margin);
        Some(Seeds {
            nodes: whole.seeds::<L::Rough>(&self.target, &mut workspace.descent),
            mirrored: whole.mirrored(),
        })
    }

    /// Follows one ray through each pixel of a tile, at `offset` from its upper left corner. `see` gets packet after packet.
    pub fn trace<L: Lanes, const LOD: bool, const COUNT: bool>(
        &self,
        tile: &Tile,
        seeds: Option<&Seeds>,
        offset: [f32; 2],
        workspace: &mut Workspace<L>,
        mut see: impl FnMut(&Seen<'_, L>),
    ) {
        let nothing = Hits::none();
        let mut blocks = Vec::with_capacity((BEAM_SIZE * BEAM_SIZE) as usize / L::COUNT);
        tile.for_each_square(|corner| {
            blocks.clear();
            tile.for_each_block::<L>(corner, offset, |block| blocks.push(block));
            let together = seeds
                .is_some_and(|seeds| self.trace_beam::<L, LOD, COUNT>(corner, &blocks, seeds, workspace));
            for (number, block) in blocks.iter().enumerate() {
                if together {
                    let traveller = workspace.travellers.get(number);
                    see(&Seen {
                        block,
                        placements: None,
                        hits: traveller.map_or(&nothing, |traveller| &traveller.hits),
                        place: traveller.map(|traveller| (&traveller.packet, traveller.place())),
                    });
                } else {
                    let (packet, placements) = self.view.packet(block);
                    let (hits, place) = trace::<L, LOD, COUNT>(&self.target, &packet, &mut workspace.path);
                    see(&Seen { block, placements, hits: &hits, place: Some((&packet, place)) });
                }
            }
        });
    }

    /// Follows one ray through each of some points of the picture. `see` gets packet after packet, with the number of its
    /// first point.
    pub fn trace_points<L: Lanes, const LOD: bool, const COUNT: bool>(
        &self,
        points: &[[f32; 2]],
        workspace: &mut Workspace<L>,
        mut see: impl FnMut(usize, &Seen<'_, L>),
    ) {
        for (number, points) in points.chunks(L::COUNT).enumerate() {
            let along = |axis: usize| {
                let mut values = [0.0; MAX_LANES];
                values.iter_mut().zip(points).for_each(|(value, point)| *value = point[axis]);
                L::load(&values)
            };
            let block =
                PixelBlock { corner: [0; 2], x: along(0), y: along(1), active: L::first(points.len()) };
            let (packet, placements) = self.view.packet(&block);
            let (hits, place) = trace::<L, LOD, COUNT>(&self.target, &packet, &mut workspace.path);
            let place = Some((&packet, place));
            see(number * L::COUNT, &Seen { block: &block, placements, hits: &hits, place });
        }
    }

    /// Follows the rays of a beam together as far as that is of use; returns whether that could be done.
    fn trace_beam<L: Lanes, const LOD: bool, const COUNT: bool>(
        &self,
        corner: [u32; 2],
        blocks: &[PixelBlock<L>],
        seeds: &Seeds,
        workspace: &mut Workspace<L>,
    ) -> bool {
        workspace.travellers.clear();
        if seeds.nodes.is_empty() {
            return true;
        }
        let beam = Beam::new::<L::Rough>(&self.view, corner, BEAM_SIZE, self.margin);
        let Some(mirrored) = beam.mirrored() else { return false };
        let root = [PlacedNode::root(self.target.octree)];
        let seeds = if seeds.mirrored == Some(mirrored) { &seeds.nodes[..] } else { &root };
        let Self { target, view, .. } = self;
        trace_together::<L, LOD, COUNT>(target, view, &beam, mirrored, seeds, blocks, workspace)
    }
}
