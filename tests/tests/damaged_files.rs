//! Files that are damaged: an error, or an octree that can be traced, but never a panic.

use glam::DVec3;
use octvox_format::FormatError;
use octvox_raytracer::{LoadError, Octree, Quality, Ray, RenderOptions};
use octvox_tests::models::Model;
use octvox_tests::pictures::picture;
use octvox_tests::random::Random;
use octvox_tests::rays::hits_of_every_width;
use octvox_tests::tree::Tree;
use octvox_tests::{FIGURE_17, meshes};
use std::io::Cursor;

fn load(file: &[u8]) -> Result<Octree, LoadError> {
    Octree::read(Cursor::new(file))
}

/// Small files of several shapes: the thesis' one, a single voxel, nothing, odd and even depth, pruned, converted.
fn small_files() -> Vec<Vec<u8>> {
    let random = &mut Random::new(1);
    let converted = Model::of_depth(&meshes::sphere(2).colored_mesh(), 3).file;
    let mut files = vec![FIGURE_17.to_vec(), Tree::empty().file(), converted];
    files.extend(
        [(0, 1.0), (1, 0.5), (2, 0.3), (3, 0.1)]
            .map(|(depth, fill)| Tree::random(random, depth, fill, 0.2).file()),
    );
    files
}

/// A few rays and a small picture of whatever was loaded.
fn trace(octree: &Octree) {
    let random = &mut Random::new(2);
    let rays: Vec<Ray> = (0..32)
        .map(|_| {
            let origin = random.point(-0.5, 1.5);
            Ray { origin, direction: random.point(0.0, 1.0) - origin }
        })
        .chain([DVec3::X, -DVec3::Y, DVec3::Z].map(|direction| Ray { origin: DVec3::splat(0.5), direction }))
        .collect();
    for hit in hits_of_every_width(octree, &rays).iter().flatten() {
        assert!(octree.is_filled(hit.cell));
        assert_eq!(octree.voxel(hit.cell), Some(hit.payload));
        // Every index leads to a colour.
        assert!(octree.palette().color(hit.payload.palette_index()).is_some());
    }
    for lod_pixels in [0.0, 3.0, 1e3] {
        let quality = Quality { lod_pixels, ..Quality::default() };
        let _ = picture(octree, &RenderOptions { size: [8, 8], quality, ..RenderOptions::default() });
    }
}

#[test]
fn every_truncation_is_an_error() {
    for file in small_files() {
        for length in 0..file.len() {
            let error = load(&file[..length]).unwrap_err();
            assert!(
                matches!(
                    error,
                    LoadError::Format(
                        FormatError::TruncatedHeader { .. } | FormatError::TruncatedVoxels { .. }
                    )
                ),
                "{length} of {}: {error}",
                file.len()
            );
            assert!(error.to_string().contains(&format!("byte {length}")), "{error}");
        }
        trace(&load(&file).unwrap());
    }
}

/// Every other value of every byte: refused, or traced.
#[test]
fn every_changed_byte_is_an_error_or_a_model() {
    let (mut refused, mut traced) = (0, 0);
    for file in small_files().into_iter().filter(|file| file.len() < 600) {
        for position in 0..file.len() {
            for change in 1..=u8::MAX {
                let mut changed = file.clone();
                changed[position] ^= change;
                match load(&changed) {
                    Ok(octree) => {
                        traced += 1;
                        // Of the many that differ in a colour or a normal only, a part is enough.
                        if position < 6 || change.is_power_of_two() {
                            trace(&octree);
                        }
                    }
                    Err(error) => {
                        refused += 1;
                        assert!(error.to_string().contains("byte "), "{error}");
                    }
                }
            }
        }
    }
    assert!(refused > 1000 && traced > 1000, "{refused} refused, {traced} traced");
}

/// Larger files with a few bytes changed at random.
#[test]
fn random_damage_is_an_error_or_a_model() {
    let file = Model::of_depth(&meshes::torus(0.2, 24, 12).colored_mesh(), 5).file;
    let random = &mut Random::new(3);
    let mut traced = 0;
    for _ in 0..400 {
        let mut damaged = file.clone();
        for _ in 0..random.between(1, 4) {
            let position = random.between(0, damaged.len() as i32 - 1) as usize;
            damaged[position] = random.bits() as u8;
        }
        if random.chance(0.3) {
            damaged.truncate(random.between(0, file.len() as i32) as usize);
        }
        if let Ok(octree) = load(&damaged) {
            traced += 1;
            trace(&octree);
        }
    }
    assert!(traced > 50, "{traced}");
}

/// Transparent nodes above filled leaves, as files from before levels of detail have them, and nodes with eight empty
/// children: strange, but they can be traced.
#[test]
fn strange_octrees_are_traced() {
    let random = &mut Random::new(4);
    for depth in 1..6 {
        let mut tree = Tree::random(random, depth, 0.1, 0.1);
        fn make_transparent(tree: &mut Tree) {
            if !tree.children.is_empty() {
                tree.voxel = octvox_format::Voxel::EMPTY;
                tree.children.iter_mut().for_each(make_transparent);
            }
        }
        make_transparent(&mut tree);
        let octree = tree.octree();
        assert_eq!(octree.leaf_voxels(), tree.leaf_voxels(tree.depth()));
        trace(&octree);
    }
    let hollow = Tree::node((0..8).map(|_| Tree::node(vec![Tree::empty(); 8])).collect()).octree();
    assert_eq!((hollow.depth(), hollow.leaf_voxels()), (2, 0));
    trace(&hollow);
}

#[test]
fn foreign_files_are_named() {
    let magica_voxel = load(b"VOX \x96\x00\x00\x00MAIN").unwrap_err();
    assert!(magica_voxel.to_string().contains("MagicaVoxel"), "{magica_voxel}");
    for foreign in [&b"# obj"[..], b"\x89PNG\r\n", b"", b"M", b"\0\0\0\0"] {
        load(foreign).unwrap_err();
    }
}
