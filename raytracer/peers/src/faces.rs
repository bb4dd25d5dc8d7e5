//! The model as faces: its triangles as they are, or the faces of its voxels that show.

use crate::embree::Faces;
use anyhow::Result;
use octvox_converter::{Mesh, WorldTransform};
use octvox_format::Reader;
use octvox_raytracer::Octree;
use std::collections::HashMap;

/// The triangles of a mesh in unit space, where the converter puts them.
pub fn triangles(mesh: &Mesh, world: &WorldTransform, resolution: u32) -> Faces<3> {
    let size = world.voxel_size * f64::from(resolution);
    let to_unit =
        |point: &[f64; 3]| std::array::from_fn(|axis| ((point[axis] - world.origin[axis]) / size) as f32);
    Faces { vertices: mesh.positions().iter().map(to_unit).collect(), corners: mesh.triangles().to_vec() }
}

/// The faces between filled and empty cells as quads in unit space. `file` is that of `octree`, not pruned.
pub fn exposed_faces(octree: &Octree, file: &[u8]) -> Result<Faces<4>> {
    let size = octree.resolution() as f32;
    let mut faces = Faces { vertices: Vec::new(), corners: Vec::new() };
    // Where the lattice points are in the list of vertices.
    let mut known = HashMap::new();
    for cell in filled_cells(octree.depth(), file)? {
        for axis in 0..3 {
            for upper in [false, true] {
                let mut neighbor = cell;
                // Below 0 this wraps to a cell beyond the cube, which is not filled either.
                neighbor[axis] = if upper { cell[axis] + 1 } else { cell[axis].wrapping_sub(1) };
                if octree.is_filled(neighbor) {
                    continue;
                }
                let mut corner = cell;
                corner[axis] += u32::from(upper);
                let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
                faces.corners.push([[0, 0], [1, 0], [1, 1], [0, 1]].map(|[along_u, along_v]| {
                    let mut point = corner;
                    point[u] += along_u;
                    point[v] += along_v;
                    *known.entry(point).or_insert_with(|| {
                        faces.vertices.push(point.map(|coordinate| coordinate as f32 / size));
                        (faces.vertices.len() - 1) as u32
                    })
                }));
            }
        }
    }
    Ok(faces)
}

/// The filled cells of the finest level.
fn filled_cells(depth: u8, file: &[u8]) -> Result<Vec<[u32; 3]>> {
    let mut octants = [0; 32];
    let mut cells = Vec::new();
    for record in Reader::new(file)? {
        let record = record?;
        let level = usize::from(record.level);
        octants[level] = u32::from(record.octant);
        if record.level == depth && !record.voxel.is_empty() {
            let coordinate = |axis: u32| {
                octants[1..=level].iter().fold(0, |low: u32, octant| low << 1 | octant >> axis & 1)
            };
            cells.push([coordinate(0), coordinate(1), coordinate(2)]);
        }
    }
    Ok(cells)
}
