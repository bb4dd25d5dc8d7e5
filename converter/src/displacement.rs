//! Surfaces moved by displacement maps.
//!
//! Triangles with a displacement map are cut into pieces of about two voxels, and the vertices of these are moved. Where
//! several triangles meet in a vertex, it moves by the mean of what they want, weighted by their angles there (those that
//! have no map want none): at the seam of a texture, where one side is black and the other white, or along a sharp edge. So
//! pieces that shared a vertex still do, and what was closed stays closed, whatever the map. How fine the pieces are decides
//! how much of the map is seen, not whether there are holes.

use crate::fixed_point::snap_vertices;
use crate::mesh::NO_NORMAL;
use crate::normals::{NORMAL_UNIT, corner_normals, normal_and_angles};
use crate::placement;
use crate::scan_conversion::GridTriangle;
use crate::subdivision::{Piece, Subdivision, subdivide};
use crate::texture::{Displacement, TexturePoint};
use crate::{ConvertError, Material, Mesh, NormalMapKind, Options, WorldTransform};
use rayon::prelude::*;

/// Longest edge of a piece, in voxels.
const PIECE: f64 = 2.0;

/// There are no more pieces than this; they take about two gigabytes.
const MAX_PIECES: usize = 1 << 24;

/// Ways in voxels are summed up in integers of this scale, so that the order of the triangles does not matter.
const SUM_SCALE: f64 = (1u64 << 24) as f64;

/// No vertex moves farther than this, in voxels.
const FARTHEST: f64 = (1u64 << 20) as f64;

/// The mesh with its surface moved as its displacement maps say; `None` if it has none.
///
/// Normals of moved triangles are computed from their new shape. A bump map that is also the displacement map is left out:
/// what it feigns is there now.
///
/// # Errors
/// Those of [`crate::placement::place`].
pub(crate) fn displaced(mesh: &Mesh, options: &Options) -> Result<Option<Mesh>, ConvertError> {
    let world = placement::place(mesh, options)?;
    let displacement = Displacement::new(mesh);
    if displacement.is_empty() {
        return Ok(None);
    }
    let subdivision = subdivide(
        &mesh.positions,
        &mesh.triangles,
        |triangle| displacement.map(triangle as usize).is_some(),
        PIECE * world.voxel_size,
        MAX_PIECES,
    );
    let ways = ways(mesh, world, options, &displacement, &subdivision);
    let longest = subdivision.longest;
    let mut result = refined(mesh, subdivision, |triangle| displacement.map(triangle as usize).is_some());
    for (position, way) in result.positions.iter_mut().zip(ways) {
        for (coordinate, way) in position.iter_mut().zip(way) {
            *coordinate += way * world.voxel_size;
        }
    }
    let longest = longest / world.voxel_size;
    if longest > PIECE {
        result.warnings.push(format!(
            "the displaced surface has details of {longest:.1} voxels or more; finer ones need more than {MAX_PIECES} pieces"
        ));
    }
    result.check()?;
    Ok(Some(result))
}

/// How far each vertex moves, in voxels.
fn ways(
    mesh: &Mesh,
    world: WorldTransform,
    options: &Options,
    displacement: &Displacement<'_>,
    subdivision: &Subdivision,
) -> Vec<[f64; 3]> {
    let normals = corner_normals(mesh, world, options.crease_degrees);
    let grid = snap_vertices(mesh, world, options.depth);
    let cells = |vertex: u32| world.to_cells(subdivision.positions[vertex as usize]);
    // For each corner of each piece: its way and its weight.
    let corners = |piece: &Piece| {
        let triangle = piece.triangle as usize;
        let (_, angles) = normal_and_angles(piece.vertices.map(cells));
        let Some(map) = displacement.map(triangle) else {
            return angles.map(|angle| ([0; 3], (f64::from(angle) * SUM_SCALE) as i64));
        };
        let corners = mesh.triangles[triangle].map(|vertex| grid[vertex as usize]);
        let coordinates = mesh.corner_texture_coordinates[triangle];
        let sorted =
            GridTriangle::<0, TexturePoint>::with_texture(corners, [[]; 3], coordinates.map(TexturePoint), 0);
        let height = displacement.height(map, &sorted, PIECE);
        [0, 1, 2].map(|corner| {
            let mean = |value: &dyn Fn(usize) -> f64| -> f64 {
                (0..3).map(|k| f64::from(piece.weights[corner][k]) * value(k)).sum()
            };
            let place = [0, 1].map(|axis| mean(&|k| f64::from(coordinates[k][axis])));
            let way = (height.at(place) / world.voxel_size).clamp(-FARTHEST, FARTHEST);
            let direction =
                [0, 1, 2].map(|axis| mean(&|k| f64::from(normals[triangle][k][axis]) / NORMAL_UNIT));
            let direction = crate::vector::unit(direction).unwrap_or([0.0; 3]);
            let angle = f64::from(angles[corner]);
            (
                direction.map(|component| (way * component * angle * SUM_SCALE) as i64),
                (angle * SUM_SCALE) as i64,
            )
        })
    };
    let mut sums = vec![([0i64; 3], 0i64); subdivision.positions.len()];
    for pieces in subdivision.pieces.chunks(1 << 18) {
        let corners: Vec<_> = pieces.par_iter().map(corners).collect();
        for (piece, corners) in pieces.iter().zip(corners) {
            for (vertex, (way, weight)) in piece.vertices.into_iter().zip(corners) {
                let (sum, weights) = &mut sums[vertex as usize];
                for (sum, way) in sum.iter_mut().zip(way) {
                    *sum = sum.saturating_add(way);
                }
                *weights += weight;
            }
        }
    }
    sums.into_par_iter()
        .map(|(sum, weights)| sum.map(|sum| if weights == 0 { 0.0 } else { sum as f64 / weights as f64 }))
        .collect()
}

/// The mesh made of the pieces, not moved yet.
fn refined(mesh: &Mesh, subdivision: Subdivision, is_moved: impl Fn(u32) -> bool + Sync) -> Mesh {
    let Subdivision { positions, pieces, longest: _ } = subdivision;
    let materials = mesh.materials.iter().map(without_feigned_displacement).collect();
    let corner_normals = between(&mesh.corner_normals, &pieces).map(|normals| {
        let moved = normals.into_par_iter().zip(&pieces);
        moved
            .map(|(normals, piece)| if is_moved(piece.triangle) { [NO_NORMAL; 3] } else { normals })
            .collect()
    });
    let triangle_materials = if mesh.triangle_materials.is_empty() {
        Vec::new()
    } else {
        pieces.iter().map(|piece| mesh.triangle_materials[piece.triangle as usize]).collect()
    };
    Mesh {
        positions,
        triangles: pieces.iter().map(|piece| piece.vertices).collect(),
        materials,
        triangle_materials,
        corner_normals: corner_normals.unwrap_or_default(),
        corner_colors: between(&mesh.corner_colors, &pieces).unwrap_or_default(),
        corner_texture_coordinates: between(&mesh.corner_texture_coordinates, &pieces).unwrap_or_default(),
        images: mesh.images.clone(),
        warnings: mesh.warnings.clone(),
    }
}

/// What is given for the corners of triangles, at the corners of their pieces.
fn between<const N: usize>(of_triangles: &[[[f32; N]; 3]], pieces: &[Piece]) -> Option<Vec<[[f32; N]; 3]>> {
    (!of_triangles.is_empty()).then(|| {
        let at_corners = |piece: &Piece| {
            let values = of_triangles[piece.triangle as usize];
            piece.weights.map(|weights| {
                std::array::from_fn(|k| {
                    let sum: f64 =
                        (0..3).map(|corner| f64::from(weights[corner]) * f64::from(values[corner][k])).sum();
                    sum as f32
                })
            })
        };
        pieces.par_iter().map(at_corners).collect()
    })
}

fn without_feigned_displacement(material: &Material) -> Material {
    let mut material = material.clone();
    if let (Some(normal), Some(displacement)) = (&material.normal_map, &material.displacement_map)
        && matches!(normal.kind, NormalMapKind::Height { .. })
        && normal.map.image == displacement.map.image
    {
        material.normal_map = None;
    }
    material
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{DisplacementMap, Image, NormalMap, TextureMap};
    use std::collections::BTreeMap;

    /// A box with sharp edges whose faces show the whole of a noisy image each, so that no two agree at an edge.
    fn noisy_box(multiplier: f64) -> Mesh {
        let corner = |k: u32| [0, 1, 2].map(|axis| f64::from(k >> axis & 1) * 20.0);
        let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        let triangles: Vec<[u32; 3]> =
            quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        let coordinates =
            [[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]], [[0.0, 0.0], [1.0, 1.0], [0.0, 1.0]]].repeat(6);
        let noise = (0..64u32).map(|k| [k.wrapping_mul(2_654_435_761).to_be_bytes()[0]; 4]).collect();
        let map = TextureMap::new(0);
        let material = Material {
            displacement_map: Some(DisplacementMap { map, multiplier }),
            normal_map: Some(NormalMap { map, kind: NormalMapKind::Height { multiplier: 1.0 } }),
            ..Material::default()
        };
        // The last face has a material without a map.
        let materials = (0..12).map(|triangle| u32::from(triangle > 9)).collect();
        Mesh::new((0..8).map(corner).collect(), triangles)
            .and_then(|mesh| mesh.with_images(vec![Image::new("noise", 8, 8, noise).unwrap()]))
            .and_then(|mesh| mesh.with_materials(vec![material, Material::default()], materials))
            .and_then(|mesh| mesh.with_corner_texture_coordinates(coordinates))
            .unwrap()
    }

    fn options() -> Options {
        Options { voxel_size: Some(1.0), depth: 6, displace: true, ..Options::default() }
    }

    #[test]
    fn pieces_of_a_closed_mesh_meet_along_whole_edges() {
        let found = displaced(&noisy_box(4.0), &options()).unwrap().unwrap();
        assert!(found.triangles.len() > 1000);
        let mut edges: BTreeMap<[u32; 2], i32> = BTreeMap::new();
        for &[a, b, c] in &found.triangles {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                *edges.entry([from.min(to), from.max(to)]).or_default() += if from < to { 1 } else { -1 };
            }
        }
        assert!(edges.values().all(|&count| count == 0));
        // They have moved, outward for the most part, and no farther than white is high.
        let farthest = found.positions.iter().flatten().map(|&c| (-c).max(c - 20.0)).fold(0.0, f64::max);
        assert!((2.0..=4.0).contains(&farthest), "{farthest}");
        // The face without a map has stayed where it is, but for its edges.
        let inner = found
            .positions
            .iter()
            .filter(|p| p[2] > 19.0 && p[0] > 1.0 && p[0] < 19.0 && p[1] > 1.0 && p[1] < 19.0);
        assert!(inner.clone().all(|position| (position[2] - 20.0).abs() < 1e-9));
        assert_eq!(found.materials[0].normal_map, None);
    }

    #[test]
    fn the_order_of_triangles_does_not_move_anything_elsewhere() {
        let mesh = noisy_box(3.0);
        let mut turned = mesh.clone();
        turned.triangles.reverse();
        turned.triangle_materials.reverse();
        turned.corner_texture_coordinates.reverse();
        for (triangle, coordinates) in turned.triangles.iter_mut().zip(&mut turned.corner_texture_coordinates)
        {
            triangle.rotate_left(1);
            coordinates.rotate_left(1);
        }
        let places = |mesh: &Mesh| {
            let found = displaced(mesh, &options()).unwrap().unwrap();
            let mut places: Vec<_> =
                found.positions.iter().map(|p| p.map(|c| (c * 1e6).round() as i64)).collect();
            places.sort_unstable();
            places
        };
        assert_eq!(places(&mesh), places(&turned));
    }

    #[test]
    fn without_a_map_nothing_is_done() {
        let mesh = Mesh { materials: vec![Material::default(); 2], ..noisy_box(1.0) };
        assert!(displaced(&mesh, &options()).unwrap().is_none());
        let mesh = Mesh { corner_texture_coordinates: Vec::new(), ..noisy_box(1.0) };
        assert!(displaced(&mesh, &options()).unwrap().is_none());
    }
}
