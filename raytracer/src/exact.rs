//! Pictures by integers: what each pixel shows, without a rounding on the way.

use crate::arithmetic::Arithmetic;
use crate::camera::{Camera, CameraError, View};
use crate::lanes::Lanes;
use crate::octree::{Location, Octree};
use crate::oracle::{FINE_BITS, Walk, follow};
use crate::ray::Ray;
use crate::tile::{TILE_PIXELS, Tile, tiles};
use crate::visibility::{Counts, Room, Visibility};
use crate::width::{Width, with_lanes};
use rayon::prelude::*;

/// What a ray met, as a [`Visibility`] has it.
struct Seen {
    distance: f64,
    node: u32,
    part: u32,
}

impl Visibility {
    /// Finds what each pixel's middle shows as [`Visibility::trace`] does, to the finest cells, by the exact walk
    /// ([`crate::oracle`]): slowly. What is found stands in the order of packets of a width, eight for
    /// [`Arithmetic::Double`].
    ///
    /// Eye and directions are those of double precision, each direction scaled by a power of two so that its largest
    /// component is from 1 to 2, and rounded to multiples of 2⁻⁴⁴. (In an octree of one level several parts name a voxel,
    /// here always the lowest.)
    ///
    /// # Errors
    /// If the camera sees nothing.
    pub fn trace_exact(
        &mut self,
        octree: &Octree,
        camera: &Camera,
        [width, height]: [u32; 2],
        order: Width,
    ) -> Result<Counts, CameraError> {
        let view = View::of_octree(camera, octree, [width, height])?;
        let tiles = tiles(width, height);
        let rooms = self.rooms(tiles.iter().map(|_| TILE_PIXELS));
        let trace_tile = |(tile, room): (Tile, Room<'_>)| with_lanes!(Arithmetic::Single, order, L => trace_tile::<L>(octree, &view, &tile, room));
        Ok(tiles.into_par_iter().zip(rooms).map(trace_tile).reduce(Counts::default, Counts::plus))
    }
}

fn trace_tile<L: Lanes>(octree: &Octree, view: &View, tile: &Tile, room: Room<'_>) -> Counts {
    let Room { distance, node, part } = room;
    distance.fill(f32::INFINITY);
    node.fill(0);
    part.fill(0);
    let mut counts = Counts::default();
    let mut first = 0;
    tile.for_each_square(|corner| {
        tile.for_each_block::<L>(corner, [0.5; 2], |block| {
            let active = L::bitmask(block.active);
            let (x, y) = (L::reals(block.x), L::reals(block.y));
            for lane in (0..L::COUNT).filter(|lane| active >> lane & 1 == 1) {
                let direction = view.direction(x[lane].into(), y[lane].into());
                counts.rays += 1;
                if let Some(seen) = see(octree, &Ray { origin: view.eye(), direction }) {
                    counts.hits += 1;
                    distance[first + lane] = seen.distance as f32;
                    node[first + lane] = seen.node;
                    part[first + lane] = seen.part;
                }
            }
            first += L::COUNT;
        });
    });
    counts
}

/// What a ray meets, rounded to the fine lattice.
fn see(octree: &Octree, ray: &Ray) -> Option<Seen> {
    // Near the cube as single precision has it, the numerator of a distance fits double precision.
    let near = ray.approach::<f32>()?;
    let on_lattice = |component: f64| (component * (1u64 << FINE_BITS) as f64).round_ties_even() as i128;
    let origin = near.origin.to_array().map(on_lattice);
    let direction = near.direction.to_array().map(on_lattice);
    let hit = follow(octree, &Walk::new(origin, direction, FINE_BITS, octree.depth()), |_| true)?;
    match octree.locate(hit.cell) {
        Location::Voxel { node, place, .. } => {
            // Where all cells of a node are one voxel, the first stands for it.
            let part = if octree.nodes[node as usize].is_uniform() { 0 } else { place };
            Some(Seen { distance: near.placement.distance(hit.distance), node, part })
        }
        Location::Empty { .. } => None,
    }
}
