//! Small pictures, compared with committed ones to the last bit of every pixel.
//!
//! After a change that is meant to be seen, `OCTVOX_UPDATE_GOLDEN=1` writes them anew; look at them before they are
//! committed.

use glam::DVec3;
use octvox_raytracer::{Camera, Octree, Quality, RenderOptions, render};
use octvox_tests::FIGURE_17;
use octvox_tests::golden::assert_is_golden;
use octvox_tests::meshes::{sphere, torus};
use octvox_tests::models::{Model, sample};
use octvox_tests::pictures::{framing, picture};
use octvox_tests::random::Random;
use octvox_tests::tree::Tree;
use std::io::Cursor;

const SIZE: [u32; 2] = [160, 120];

fn options(samples: u32, lod_pixels: f64) -> RenderOptions {
    RenderOptions {
        size: SIZE,
        quality: Quality { lod_pixels, ..Quality::of_samples(samples) },
        ..RenderOptions::default()
    }
}

fn assert_sample_is_golden(name: &str) {
    let octree = Model::of_depth(&sample(name), 8).octree;
    assert_is_golden(name, &picture(&octree, &options(4, 0.0)));
}

#[test]
fn shell() {
    assert_sample_is_golden("shell");
}

#[test]
fn lighthouse() {
    assert_sample_is_golden("lighthouse");
}

#[test]
fn knots() {
    assert_sample_is_golden("knots");
}

#[test]
fn globe() {
    assert_sample_is_golden("globe");
}

/// Single voxels, seen from close by: edges are where exact arithmetic has them.
#[test]
fn torus_from_close_by() {
    let octree = Model::of_depth(&torus(0.15, 96, 48).colored_mesh(), 5).octree;
    let camera = Camera { vertical_fov: 60.0, eye: DVec3::new(0.2, 0.3, 0.9), ..framing(&octree, SIZE) };
    assert_is_golden("torus-from-close-by", &render(&octree, &camera, &options(1, 0.0), |_| {}).unwrap().0);
}

/// Rays that end at cells of six pixels.
#[test]
fn sphere_with_levels_of_detail() {
    let octree = Model::of_depth(&sphere(5).colored_mesh(), 6).octree;
    assert_is_golden("sphere-with-levels-of-detail", &picture(&octree, &options(1, 6.0)));
}

/// Cells of all sizes, from an octree that no mesh has been converted to.
#[test]
fn random_octree() {
    let octree = Tree::random(&mut Random::new(2009), 6, 0.04, 0.15).octree();
    assert_is_golden("random-octree", &picture(&octree, &options(2, 0.0)));
}

#[test]
fn figure_17() {
    let octree = Octree::read(Cursor::new(FIGURE_17)).unwrap();
    assert_is_golden("figure-17", &picture(&octree, &options(2, 0.0)));
}
