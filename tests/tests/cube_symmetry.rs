//! The 48 symmetries of the cube, applied to scene and ray, give the images of the hits.

use octvox_raytracer::Ray;
use octvox_raytracer::oracle::LatticeRay;
use octvox_tests::naive_walk::walk;
use octvox_tests::random::Random;
use octvox_tests::rays::{hits_of_every_width, is_of_hit, on_the_lattice};
use octvox_tests::symmetry::Symmetry;
use octvox_tests::tree::Tree;

/// Rays in general position, which meet no edge and no corner of the lattice: at those, the order of axes decides, which
/// is not symmetric.
#[test]
fn images_of_rays_hit_images_of_voxels() {
    for (seed, depth) in [(1, 2), (2, 3), (3, 4), (4, 5)] {
        let random = &mut Random::new(seed);
        let tree = Tree::random(random, depth, 0.1, 0.1);
        let is_general = |ray: &LatticeRay| {
            walk(depth, ray, |cell| tree.voxel_at(cell, depth).is_some()).in_general_position
        };
        let lattice_rays: Vec<LatticeRay> =
            std::iter::repeat_with(|| on_the_lattice(random)).filter(is_general).take(1000).collect();
        let rays: Vec<Ray> = lattice_rays.iter().map(LatticeRay::to_ray).collect();
        let hits = hits_of_every_width(&tree.octree(), &rays);
        assert!(hits.iter().flatten().count() > 200);

        for symmetry in Symmetry::all() {
            let octree = symmetry.tree(&tree).octree();
            let images: Vec<Ray> = rays
                .iter()
                .map(|ray| Ray {
                    origin: symmetry.point(ray.origin),
                    direction: symmetry.vector(ray.direction),
                })
                .collect();
            let image_hits = hits_of_every_width(&octree, &images);
            for ((ray, hit), image) in rays.iter().zip(&hits).zip(&image_hits) {
                match (hit, image) {
                    (None, None) => {}
                    (Some(hit), Some(image)) => {
                        assert!(is_of_hit(image, symmetry.cell(hit.cell, depth)), "{symmetry:?}, {ray:?}");
                        // Coordinates are mirrored exactly, so not even the rounding differs.
                        assert_eq!(image.distance, hit.distance, "{symmetry:?}, {ray:?}");
                        assert_eq!((image.size_log2, image.payload), (hit.size_log2, hit.payload));
                    }
                    _ => panic!("{symmetry:?}, {ray:?}: {hit:?} became {image:?}"),
                }
            }
        }
    }
}
