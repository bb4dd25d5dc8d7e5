//! Where the model lies in the cube of voxels.

use crate::{ConvertError, Mesh, Options};
use octvox_format::WorldTransform;

/// Places a mesh.
///
/// Without further options the longest axis of the bounding box (of the vertices that triangles use) fills the cube,
/// and the other two are centred. [`Options::bounds`] takes the place of the bounding box.
/// With [`Options::voxel_size`] the size of the cube is given; it is centred on the bounding box, or begins at the
/// minimum corner of the bounds.
///
/// # Errors
/// [`ConvertError::OutsideCube`] if a part of the model lies outside, [`ConvertError::ExtentTooLarge`].
pub(crate) fn place(mesh: &Mesh, options: &Options) -> Result<WorldTransform, ConvertError> {
    let model = Region::of_mesh(mesh);
    let region = match options.bounds {
        Some([x0, y0, z0, x1, y1, z1]) => Region { min: [x0, y0, z0], max: [x1, y1, z1] },
        None => model,
    };
    let resolution = f64::from(options.resolution());
    let extent = model.longest().max(region.longest());
    if !extent.is_finite() {
        return Err(ConvertError::ExtentTooLarge { extent });
    }
    let world = match options.voxel_size {
        Some(voxel_size) if options.bounds.is_some() => WorldTransform { origin: region.min, voxel_size },
        Some(voxel_size) => WorldTransform { origin: region.centred(voxel_size * resolution), voxel_size },
        None => {
            let voxel_size = region.longest() / resolution;
            // A model without extent, or one too small for floating point to divide, is a point in a unit cube.
            let voxel_size = if voxel_size.is_normal() { voxel_size } else { 1.0 / resolution };
            WorldTransform { origin: region.centred(voxel_size * resolution), voxel_size }
        }
    };
    check_holds(&world, &model, resolution)?;
    Ok(world)
}

/// Tolerates what rounding can cause, far less than a voxel.
fn check_holds(world: &WorldTransform, model: &Region, resolution: f64) -> Result<(), ConvertError> {
    let tolerance = 1e-3;
    let (low, high) = (world.to_cells(model.min), world.to_cells(model.max));
    for axis in 0..3 {
        if !(low[axis] >= -tolerance && high[axis] <= resolution + tolerance) {
            return Err(ConvertError::OutsideCube {
                axis: ['x', 'y', 'z'][axis],
                model_min: model.min[axis],
                model_max: model.max[axis],
                cube_min: world.origin[axis],
                cube_max: world.origin[axis] + resolution * world.voxel_size,
            });
        }
    }
    Ok(())
}

/// An axis-aligned box in world units.
#[derive(Debug, Clone, Copy)]
struct Region {
    min: [f64; 3],
    max: [f64; 3],
}

impl Region {
    /// Bounding box of the vertices that triangles use.
    fn of_mesh(mesh: &Mesh) -> Self {
        let empty = Self { min: [f64::INFINITY; 3], max: [f64::NEG_INFINITY; 3] };
        mesh.triangles.iter().flatten().fold(empty, |mut region, &vertex| {
            for (axis, &coordinate) in mesh.positions[vertex as usize].iter().enumerate() {
                region.min[axis] = region.min[axis].min(coordinate);
                region.max[axis] = region.max[axis].max(coordinate);
            }
            region
        })
    }

    fn longest(&self) -> f64 {
        (0..3).map(|axis| self.max[axis] - self.min[axis]).fold(0.0, f64::max)
    }

    /// Minimum corner of a cube with this side and the centre of this region.
    fn centred(&self, side: f64) -> [f64; 3] {
        // Half of what is left over, so that an axis that fills the cube begins exactly at its minimum.
        [0, 1, 2].map(|axis| self.min[axis] - (side - (self.max[axis] - self.min[axis])) / 2.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two opposite corners of a box are enough for its bounds; an unused vertex far away must not count.
    fn mesh(min: [f64; 3], max: [f64; 3]) -> Mesh {
        Mesh::new(vec![min, max, [1e9; 3]], vec![[0, 1, 1]]).unwrap()
    }

    #[test]
    fn the_longest_axis_fills_the_cube_and_the_others_are_centred() {
        let mesh = mesh([10.0, -1.0, 100.0], [14.0, 1.0, 101.0]);
        let world = place(&mesh, &Options { depth: 3, ..Options::default() }).unwrap();
        assert_eq!(world.voxel_size, 0.5);
        assert_eq!(world.to_cells([10.0, -1.0, 100.0]), [0.0, 2.0, 3.0]);
        assert_eq!(world.to_cells([14.0, 1.0, 101.0]), [8.0, 6.0, 5.0]);
    }

    #[test]
    fn both_ends_of_the_longest_axis_are_exact_far_from_the_origin() {
        for offset in [0.0, 1e7, -123_456_789.1, 148_376.0] {
            let mesh = mesh([offset, 0.0, 0.0], [offset + 1.0 / 3.0, 0.1, 0.1]);
            let world = place(&mesh, &Options { depth: 14, ..Options::default() }).unwrap();
            assert_eq!(world.to_cells(mesh.positions[0])[0], 0.0);
            assert_eq!(world.to_cells(mesh.positions[1])[0], 16384.0);
        }
    }

    #[test]
    fn a_point_lies_in_the_middle_of_a_unit_cube() {
        for size in [0.0, 5e-324, 1e-310] {
            let mesh = mesh([5.0 * size; 3], [6.0 * size; 3]);
            let world = place(&mesh, &Options { depth: 2, ..Options::default() }).unwrap();
            assert_eq!(world.to_cells([0.0; 3]), [2.0; 3]);
        }
    }

    #[test]
    fn bounds_and_voxel_size_fix_the_cube() {
        let mesh = mesh([1.0, 1.0, 1.0], [2.0, 3.0, 2.0]);
        let place = |bounds, voxel_size| {
            place(&mesh, &Options { depth: 3, bounds, voxel_size, ..Options::default() })
        };
        let bounds = [0.0, 0.0, 1.0, 4.0, 4.0, 3.0];
        let world = place(Some(bounds), None).unwrap();
        assert_eq!((world.origin, world.voxel_size), ([0.0, 0.0, 0.0], 0.5));
        let world = place(None, Some(1.0)).unwrap();
        assert_eq!((world.origin, world.voxel_size), ([-2.5, -2.0, -2.5], 1.0));
        let world = place(Some(bounds), Some(0.25)).unwrap_err();
        assert!(matches!(world, ConvertError::OutsideCube { axis: 'y', cube_max: 2.0, .. }), "{world}");
        let world = place(Some(bounds), Some(0.5)).unwrap();
        assert_eq!((world.origin, world.voxel_size), ([0.0, 0.0, 1.0], 0.5));
    }

    #[test]
    fn a_model_beyond_floating_point_is_refused() {
        let error = place(&mesh([-1e308; 3], [1e308; 3]), &Options::default()).unwrap_err();
        assert!(matches!(error, ConvertError::ExtentTooLarge { .. }), "{error}");
    }
}
