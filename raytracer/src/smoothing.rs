//! Voxels seen from so close that they look like cubes: the smooth surface that they are samples of.
//!
//! Every filled cell is taken for a point, its middle, with a normal. Near a place `p` the points define a plane: through
//! their mean, across their mean normal, both weighted by how near they are. The places that lie on their own plane are the
//! surface (A. Adamson and M. Alexa, "Approximating and intersecting surfaces from points", 2003). A ray is followed from
//! the voxel that it met to that surface; if it passes by, it has not met it. So normals and edges are smooth, and the
//! blur is as wide as a voxel, however large that looks.

use crate::octree::Octree;
use crate::scene::SurfaceMaterial;
use crate::surface::BACK;
use glam::{DVec3, Vec3};

/// Where a ray meets the smooth surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SmoothHit {
    /// Distance behind the point at which the ray came into the voxel, in unit space; below zero if before it.
    pub beyond: f64,
    /// Unit vector in unit space, on the side of the voxel's own.
    pub normal: Vec3,
    /// Mean of what the voxels about the place scatter.
    pub diffuse: Vec3,
}

/// Points farther from a place than this, in edges of a voxel, do not count there.
const REACH: f32 = 1.75;

/// Cells on each side of the voxel that are looked at.
const AROUND: u32 = 3;

/// The least cosine of the angle between normals of one surface: sharper edges stay as they are.
const ALIKE: f32 = 0.4;

/// The way of a ray that is looked at, before and behind the place where it came into the voxel, in edges.
const WAY: [f32; 2] = [-1.25, 2.0];

/// A voxel near the one that was met, in edges from that one's middle.
struct Sample {
    middle: Vec3,
    normal: Vec3,
    diffuse: Vec3,
}

/// The plane of a place.
struct Plane {
    /// How far the place is in front of it, in edges.
    height: f32,
    normal: Vec3,
    diffuse: Vec3,
}

/// Where a ray that met a voxel at `point`, in unit space, meets the smooth surface; nothing if it passes by. `direction` is
/// a unit vector, `facing` the voxel's normal, on whichever side.
pub(crate) fn meet(
    octree: &Octree,
    surfaces: &[SurfaceMaterial],
    cell: [u32; 3],
    point: DVec3,
    direction: Vec3,
    facing: Vec3,
) -> Option<SmoothHit> {
    let size = f64::from(octree.resolution());
    let middle = DVec3::from_array(cell.map(f64::from)) + 0.5;
    // From here on lengths are in edges, from the middle of the voxel.
    let start = (point * size - middle).as_vec3();
    let samples = samples(octree, surfaces, cell, facing);
    // As with the normals of silhouettes: one that faces away a little is not yet that of the back.
    let outward = if facing.dot(direction) > -BACK { -1.0 } else { 1.0 };
    let height =
        |way: f32| plane(&samples, start + direction * way).map(|plane| (plane.height * outward, plane));

    // From where the ray is in front of the surface, in steps, to the first place behind it.
    const STEPS: i32 = 13;
    let step = (WAY[1] - WAY[0]) / STEPS as f32;
    let mut before: Option<f32> = None;
    for number in 0..=STEPS {
        let way = WAY[0] + step * number as f32;
        let Some((above, plane)) = height(way) else {
            before = None;
            continue;
        };
        if above > 0.0 {
            before = Some(way);
            continue;
        }
        let Some(mut in_front) = before else {
            // The surface comes to its end before the ray is in front of it.
            if number == 0 && above > -0.5 {
                return Some(hit(way, size, &plane));
            }
            continue;
        };
        let mut behind = way;
        let mut found = plane;
        for _ in 0..6 {
            let between = (in_front + behind) / 2.0;
            match height(between) {
                Some((above, _)) if above > 0.0 => in_front = between,
                Some((_, plane)) => (behind, found) = (between, plane),
                None => break,
            }
        }
        return Some(hit(behind, size, &found));
    }
    None
}

fn hit(way: f32, size: f64, plane: &Plane) -> SmoothHit {
    SmoothHit { beyond: f64::from(way) / size, normal: plane.normal, diffuse: plane.diffuse }
}

/// The filled cells about one that are part of the same surface, their normals on one side.
fn samples(octree: &Octree, surfaces: &[SurfaceMaterial], cell: [u32; 3], facing: Vec3) -> Vec<Sample> {
    let mut samples = Vec::with_capacity(64);
    let low = cell.map(|at| at.saturating_sub(AROUND));
    let high = cell.map(|at| (at + AROUND).min(octree.resolution() - 1));
    octree.for_each_voxel(low, high, &mut |at, voxel| {
        let normal = Vec3::from_array(voxel.normal().decode());
        let alike = normal.dot(facing);
        if alike.abs() < ALIKE {
            return;
        }
        let offset = [0, 1, 2].map(|axis| at[axis] as f32 - cell[axis] as f32);
        let entry = usize::from(voxel.palette_index()).wrapping_sub(1);
        samples.push(Sample {
            middle: Vec3::from_array(offset),
            normal: if alike < 0.0 { -normal } else { normal },
            diffuse: surfaces.get(entry).map_or(Vec3::ZERO, |surface| surface.diffuse),
        });
    });
    samples
}

/// The plane of a place, if there are points about it.
fn plane(samples: &[Sample], place: Vec3) -> Option<Plane> {
    let (mut weights, mut middle, mut normal, mut diffuse) = (0.0, Vec3::ZERO, Vec3::ZERO, Vec3::ZERO);
    for sample in samples {
        let nearness = 1.0 - sample.middle.distance_squared(place) / (REACH * REACH);
        if nearness > 0.0 {
            let weight = nearness * nearness;
            weights += weight;
            middle += sample.middle * weight;
            normal += sample.normal * weight;
            diffuse += sample.diffuse * weight;
        }
    }
    let normal = normal.try_normalize()?;
    let middle = middle / weights;
    // A place whose points all lie to one side is beyond the edge of the surface.
    const BEYOND: f32 = 1.0;
    let offset = place - middle;
    let height = normal.dot(offset);
    let aside = (offset - normal * height).length();
    (aside <= BEYOND).then_some(Plane { height, normal, diffuse: diffuse / weights })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Model;
    use octvox_format::{Palette, SphericalNormal, Voxel, Writer};

    const SIDE: u32 = 32;
    const RADIUS: f64 = 11.3;

    fn offset([x, y, z]: [u32; 3]) -> DVec3 {
        DVec3::new(f64::from(x), f64::from(y), f64::from(z)) + 0.5 - f64::from(SIDE) / 2.0
    }

    /// A ball of cells that its surface cuts, with its normals.
    fn ball() -> Octree {
        fn write(writer: &mut Writer<Vec<u8>>, corner: [u32; 3], size: u32) {
            if size == 1 {
                let offset = offset(corner);
                let is_cut =
                    (offset.length() - RADIUS).abs() <= 0.5 * offset.abs().max_element() / offset.length();
                let normal = SphericalNormal::encode(offset.as_vec3().to_array());
                let voxel = Voxel { palette_index: 1, normal };
                return writer.leaf(if is_cut { voxel } else { Voxel::EMPTY }).unwrap();
            }
            let voxel = Voxel { palette_index: 1, normal: SphericalNormal { theta: 0, phi: 0 } };
            writer.node(voxel).unwrap();
            for octant in 0..8 {
                let low = std::array::from_fn(|axis| corner[axis] + (octant >> axis & 1) * size / 2);
                write(writer, low, size / 2);
            }
        }
        let mut writer = Writer::new(Vec::new(), &Palette::new(vec![[9, 9, 9]]).unwrap()).unwrap();
        write(&mut writer, [0; 3], SIDE);
        Octree::from_bytes(&writer.finish().unwrap()).unwrap()
    }

    #[test]
    fn every_voxel_of_a_box_is_visited_once() {
        let octree = ball();
        let (low, high) = ([3, 9, 2], [20, 17, 31]);
        let mut visited = Vec::new();
        octree.for_each_voxel(low, high, &mut |cell, payload| {
            assert_eq!(Some(payload), octree.voxel(cell));
            visited.push(cell);
        });
        visited.sort_unstable();
        let mut expected = Vec::new();
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                expected.extend((low[2]..=high[2]).map(|z| [x, y, z]).filter(|cell| octree.is_filled(*cell)));
            }
        }
        assert!(expected.len() > 200);
        assert_eq!(visited, expected);
    }

    /// Rays meet the ball where it was before it was made of cubes, and pass by where it was not.
    #[test]
    fn a_ball_is_round_again() {
        let octree = ball();
        let model = Model::new(&octree);
        let size = f64::from(SIDE);
        let (mut met, mut missed, mut bulging, mut cubes) = (0, 0, 0, 0);
        let (mut worst, mut squares, mut worst_angle) = (0.0f64, 0.0f64, 0.0f32);
        for step in 0..4000 {
            // Parallel rays through a disk somewhat larger than the ball.
            let (angle, radius) = (f64::from(step) * 2.4, (f64::from(step) / 4000.0).sqrt() * (RADIUS + 1.5));
            let direction = DVec3::new(0.36, -0.48, 0.8);
            let right = direction.cross(DVec3::Y).normalize();
            let aside = right * (radius * angle.cos()) + direction.cross(right) * (radius * angle.sin());
            let is_inside = radius < RADIUS;
            let mut origin = aside / size + 0.5 - direction;
            let mut found = None;
            cubes += usize::from(octree.hit(&crate::Ray { origin, direction }).is_some() != is_inside);
            while let Some(hit) = octree.hit(&crate::Ray { origin, direction }) {
                let point = origin + direction * hit.distance;
                let facing = Vec3::from_array(hit.payload.normal().decode());
                found = meet(&octree, &model.surfaces, hit.cell, point, direction.as_vec3(), facing)
                    .map(|smooth| ((point + direction * smooth.beyond - 0.5) * size, smooth.normal));
                if found.is_some() {
                    break;
                }
                let cell = DVec3::from_array(hit.cell.map(f64::from));
                let far = DVec3::select(direction.cmpgt(DVec3::ZERO), cell + 1.0, cell) / size;
                let leaves = ((far - origin) / direction).min_element();
                origin += direction * (leaves + 1e-6);
            }
            let Some((place, normal)) = found else {
                missed += usize::from(is_inside);
                continue;
            };
            met += 1;
            bulging += usize::from(!is_inside);
            if radius < RADIUS * 0.9 {
                let off = (place.length() - RADIUS).abs();
                worst = worst.max(off);
                squares += off * off;
                worst_angle = worst_angle.max(normal.angle_between(place.as_vec3().normalize()));
            }
        }
        assert!(met > 3000, "{met}");
        // The middles of cells are within half an edge of the ball on either side; means of a dozen of them are closer.
        let spread = (squares / f64::from(met)).sqrt();
        println!("{worst} edges off at most, {spread} on average, {}°", worst_angle.to_degrees());
        println!("{missed} missed, {bulging} wrongly met, {cubes} wrong with cubes");
        assert!(worst < 0.5 && spread < 0.15, "{worst}, {spread} edges off");
        assert!(worst_angle.to_degrees() < 5.0, "{}° off", worst_angle.to_degrees());
        assert!(2 * (missed + bulging) < cubes, "{missed} missed, {bulging} wrongly met, {cubes} with cubes");
    }
}
