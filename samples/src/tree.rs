//! `tree` and `pine`: one broad-leaved tree and one conifer, of few triangles, to be planted many times over.

use crate::color::hex;
use crate::curve::{Course, frames};
use crate::detail::Detail;
use crate::material::Material;
use crate::mesh::Mesh;
use crate::noise::{layered_noise, noise, random, random_between};
use crate::placement::{shift, turn_y, turn_z};
use crate::primitives::{Ends, ellipsoid, rings, tube};
use crate::scene::{Scene, Shades};
use crate::trigonometry::{circle, cosine, power};
use glam::{DVec2, DVec3};

/// Builds the broad-leaved tree: a trunk that divides into branches, with a cluster of leaves around the end of each.
pub fn build_broad_leaved(detail: Detail) -> Scene {
    let mut scene = Scene::new("tree", "a broad-leaved tree");
    let bark = bark(&mut scene, &[(0.0, 0x4a3524), (1.0, 0x7d5e40)]);
    let leaves = scene.shades(
        &Material::matte("leaf", hex(0xffffff)),
        6,
        &[(0.0, 0x2d5226), (0.35, 0x45702e), (0.7, 0x6c923e), (1.0, 0xa2b45c)],
    );
    let fork = DVec3::new(0.04, 0.72, -0.02);
    scene.add(limb(detail, DVec3::ZERO, fork + DVec3::Y * 0.25, 0.095, 0.045, 3, &bark));
    for branch in 0..BRANCHES {
        let (from, end) = branch_ends(branch, fork);
        scene.add(limb(detail, from, end, 0.042, 0.016, 17 + branch, &bark));
        scene.add(cluster(detail, branch, end, 0.40, &leaves));
    }
    // The middle of the crown, above them.
    for (index, place) in [DVec3::new(-0.02, 1.42, 0.03), DVec3::new(0.18, 1.17, 0.2)].into_iter().enumerate()
    {
        scene.add(cluster(detail, 40 + index as u32, place, 0.45, &leaves));
    }
    scene
}

/// Builds the conifer: skirts of drooping boughs around a straight trunk.
pub fn build_conifer(detail: Detail) -> Scene {
    const SKIRTS: u32 = 9;
    let mut scene = Scene::new("pine", "a conifer");
    let bark = bark(&mut scene, &[(0.0, 0x3f2c20), (1.0, 0x6b4a34)]);
    let needles = scene.shades(
        &Material::matte("needle", hex(0xffffff)),
        6,
        &[(0.0, 0x15352a), (0.4, 0x25563a), (0.75, 0x3f7a4a), (1.0, 0x7ba65e)],
    );
    scene.add(limb(detail, DVec3::ZERO, DVec3::Y * 1.9, 0.085, 0.02, 5, &bark));
    for skirt in 0..SKIRTS {
        let rise = f64::from(skirt) / f64::from(SKIRTS);
        let spread = 0.56 * (1.0 - rise * rise * 0.35) * (1.0 - 0.8 * rise);
        let height = 0.26 + 1.72 * rise;
        let skirt = skirt_of_boughs(detail, skirt, spread, &needles);
        scene.add(skirt.placed(shift(0.0, height, 0.0)));
    }
    scene
}

fn bark(scene: &mut Scene, stops: &[(f64, u32)]) -> Shades {
    scene.shades(&Material::matte("bark", hex(0xffffff)), 3, stops)
}

/// Branches of the broad-leaved tree.
const BRANCHES: u32 = 11;

/// Where a branch leaves the trunk, and where it ends.
fn branch_ends(branch: u32, fork: DVec3) -> (DVec3, DVec3) {
    // Steps of the golden angle leave no gap in the crown.
    let around = circle(f64::from(branch) * 0.381_966 + random_between(401, branch, -0.04, 0.04));
    let rise = (f64::from(branch) + 0.5) / f64::from(BRANCHES);
    let reach = 0.56 * (1.0 - rise * rise).sqrt() + 0.08;
    let end = DVec3::new(around.x * reach, 0.86 + 0.56 * rise, -around.y * reach);
    (fork * (0.8 + 0.35 * rise), end)
}

/// A piece of wood that bends a little and grows thinner, wider at its foot if that is on the ground.
fn limb(detail: Detail, from: DVec3, to: DVec3, thick: f64, thin: f64, seed: u32, bark: &Shades) -> Mesh {
    let steps = detail.segments(7);
    let along = |step: usize| step as f64 / steps as f64;
    let length = from.distance(to);
    let points: Vec<DVec3> = (0..=steps)
        .map(|step| {
            let t = along(step);
            let bend = DVec3::new(noise(seed, DVec3::X * t * 2.0), 0.0, noise(seed + 1, DVec3::X * t * 2.0));
            // Branches sag and then rise, a trunk stands straight.
            let sag = if from.y > 0.0 { -0.10 * length * (t * (1.0 - t)) * 4.0 } else { 0.0 };
            from.lerp(to, t) + bend * (0.12 * length * t * (1.0 - t)) + DVec3::Y * sag
        })
        .collect();
    let core = frames(&points, Course::Open);
    let radius = |row: usize| {
        let t = along(row);
        let foot = if from.y == 0.0 { 0.9 * power(1.0 - t, 8.0) } else { 0.0 };
        (thick + (thin - thick) * t) * (1.0 + foot)
    };
    let section = |row: usize, turn: f64| {
        let roots =
            if from.y == 0.0 { 0.28 * power(1.0 - along(row), 6.0) * cosine(turn * 5.0) } else { 0.0 };
        circle(turn) * radius(row) * (1.0 + roots)
    };
    let columns = detail.segments(10);
    let wood = tube(&core, Course::Open, columns, section, |_, _, point| point);
    wood.creased(0.2).assigned(|face, center, _| {
        let grain = noise(seed + 2, DVec3::new(center.x * 30.0, center.y * 5.0, center.z * 30.0));
        bark.at(0.5 + 0.6 * grain + 0.1 * (face % 2) as f64)
    })
}

/// Leaves around the end of a branch: a knobbly ball, lighter above and where it stands out.
fn cluster(detail: Detail, index: u32, place: DVec3, radius: f64, leaves: &Shades) -> Mesh {
    let seed = 431 + index * 7;
    let swell = |point: DVec3| {
        let direction = point.normalize();
        layered_noise(seed, direction * 2.1, 2) + 0.55 * noise(seed + 3, direction * 6.5)
    };
    let ball = ellipsoid(DVec3::ONE, detail.segments(16), detail.segments(9));
    let ball = ball.displaced(|point| point * (1.0 + 0.30 * swell(point))).creased(0.06);
    let own = random_between(439, index, -0.12, 0.12);
    let ball = ball.assigned(|face, center, normal| {
        let speckle = random_between(443 + index, face as u32, -0.16, 0.16);
        leaves.at(0.42 + own + 0.24 * normal.y + 0.35 * swell(center) + speckle)
    });
    let size = radius * random_between(449, index, 0.8, 1.05);
    ball.placed(shift(place.x, place.y, place.z) * turn_y(random(457, index)))
        .displaced(|point| place + (point - place) * DVec3::new(size, size * 0.78, size))
}

/// A ring of boughs around the y axis, from the trunk at y = 0.2 out and down.
fn skirt_of_boughs(detail: Detail, skirt: u32, spread: f64, needles: &Shades) -> Mesh {
    const BOUGHS: f64 = 9.0;
    const ROWS: usize = 6;
    let columns = detail.segments(36);
    let thickness = 0.30 * spread + 0.08;
    let ends = Ends::Points(DVec3::new(0.0, 0.05, 0.0), DVec3::new(0.0, thickness + 0.16, 0.0));
    let twist = random(461, skirt);
    let mesh = rings(ROWS, columns, ends, |row, column| {
        let turn = column as f64 / columns as f64;
        // Each bough is of its own length.
        let bough = ((turn * BOUGHS).floor() as u32) % BOUGHS as u32;
        let length = random_between(463 + skirt, bough, 0.82, 1.12);
        let finger = 0.5 - 0.5 * cosine(turn * BOUGHS);
        // The rows go out below and come back above.
        let (out, lift) =
            [(0.30, 0.02), (0.66, -0.02), (1.0, -0.05), (0.96, 0.03), (0.62, 0.13), (0.28, 0.30)][row];
        let reach = out * (1.0 - 0.42 * out * (1.0 - finger)) * (1.0 + (length - 1.0) * out * finger);
        let droop = -0.30 * spread * out * out * (0.55 + 0.45 * finger);
        let around = circle(turn + twist) * (reach * spread);
        DVec3::new(around.x, thickness * (0.5 + 1.4 * lift) + droop, -around.y)
    });
    let mesh = mesh.placed(turn_z(random_between(467, skirt, -0.008, 0.008))).creased(0.07);
    mesh.assigned(|face, center, normal| {
        let out = DVec2::new(center.x, center.z).length() / spread;
        let speckle = random_between(479 + skirt, face as u32, -0.14, 0.14);
        needles.at(0.08 + 0.30 * normal.y + 0.52 * out * out + speckle)
    })
}
