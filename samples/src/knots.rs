//! `knots`: six woven rings around two linked trefoil knots, with cut gems in the openings.
//!
//! Every strand is a closed tube and no two touch, so the whole is watertight, with many thin gaps.

use crate::color::{WHITE, hex, mix};
use crate::curve::{Course, Frame, frames, sample_closed, strand, torus_knot};
use crate::detail::Detail;
use crate::material::Material;
use crate::mesh::{MaterialId, Mesh};
use crate::noise::random;
use crate::placement::{turn_x, turn_y};
use crate::primitives::{Ends, ellipsoid, rings, wire};
use crate::scene::Scene;
use crate::trigonometry::{circle, cosine};
use glam::{DAffine3, DMat3, DVec2, DVec3};

/// The bands of the woven sphere, one for each axis through opposite corners of an icosahedron.
const BANDS: [(&str, u32); 6] = [
    ("ruby", 0xc2183c),
    ("amber", 0xf08c1a),
    ("emerald", 0x0e9a5a),
    ("turquoise", 0x18b4c4),
    ("sapphire", 0x2350d0),
    ("amethyst", 0x8a3cc8),
];

/// The strands of the two knots, three each.
const STRANDS: [[(&str, u32); 3]; 2] = [
    [("coral", 0xff5a4f), ("rose", 0xff9eb0), ("saffron", 0xffc23d)],
    [("lagoon", 0x1fc7b6), ("sky", 0x7cc4ff), ("violet", 0x7a5cff)],
];

/// How far a band rises and falls from the sphere of radius 1 to pass over and under the others.
const WEAVE: f64 = 0.045;
const KNOT_MAJOR: f64 = 0.53;
const KNOT_MINOR: f64 = 0.245;
const STRAND_RADIUS: f64 = 0.038;
/// From the middle of a rope to the middle of its strands.
const STRAND_DISTANCE: f64 = 0.0495;
const ROPE_TWISTS: i32 = 14;
const CORE_RADIUS: f64 = 0.15;
const BEAD_RADIUS: f64 = 0.055;

/// Half the cross-section of a band, from the middle of its outer side around the edge: across and outward.
const SECTION: [(f64, f64); 6] =
    [(0.019, 0.012), (0.058, 0.012), (0.066, 0.024), (0.08, 0.022), (0.086, 0.0), (0.078, -0.02)];

/// Builds the scene.
pub fn build(detail: Detail) -> Scene {
    let mut scene = Scene::new("knots", "a sphere of six woven bands around two linked trefoil knots");
    let gem = |name: String, color| Material::matte(name, color).glossy(hex(0xb0b0b0), 60.0);
    let gold = scene.material(Material::matte("gold", hex(0xf4c04a)).glossy(hex(0xfff0b0), 80.0));
    let core = Material::matte("core", WHITE).glossy(hex(0xffffff), 100.0);
    let core = scene.shades(&core, 6, &[(0.0, 0xa80f3c), (0.5, 0xe8305a), (1.0, 0xff9aa8)]);

    for (axis, (name, color)) in axes().into_iter().zip(BANDS) {
        let dark = scene.material(gem(name.to_owned(), hex(color)));
        let light = scene.material(gem(format!("{name}_light"), mix(hex(color), WHITE, 0.45)));
        let pattern =
            |row: usize, column: usize| if (row + column.abs_diff(1)) % 4 < 2 { dark } else { light };
        scene.add(band(axis, detail, pattern, gold));
    }
    for (knot, colors) in STRANDS.into_iter().enumerate() {
        for (curve, (name, color)) in strands(knot, detail).iter().zip(colors) {
            let material = scene.material(gem(name.to_owned(), hex(color)));
            let frames = frames(curve, Course::Closed);
            scene.add(wire(&frames, Course::Closed, detail.segments(7), STRAND_RADIUS).of(material).smooth());
        }
    }
    for center in triangle_centers() {
        let bead = ellipsoid(DVec3::splat(BEAD_RADIUS), detail.segments(10), detail.segments(5));
        scene.add(bead.placed(pointing_to(center)).of(gold).smooth());
    }
    // A cut stone: every facet flat and of its own shade.
    let stone = ellipsoid(DVec3::splat(CORE_RADIUS), 16, 9).creased(0.001);
    scene.add(stone.assigned(|facet, _, _| core.at(random(7, facet as u32))));
    scene
}

/// A jewel-coloured band with gold edges along the great circle around `axis`.
fn band(axis: DVec3, detail: Detail, inlay: impl Fn(usize, usize) -> MaterialId, gold: MaterialId) -> Mesh {
    let curve = ring_curve(axis);
    let points = sample_closed(detail.segments(100), curve);
    let frames: Vec<Frame> = frames(&points, Course::Closed)
        .into_iter()
        .map(|frame| {
            let right = axis.reject_from_normalized(frame.forward).normalize();
            Frame { right, up: frame.forward.cross(right), ..frame }
        })
        .collect();
    // Counter-clockwise: up the right half, and back down its mirror image.
    let right = SECTION.iter().rev().map(|&(across, outward)| DVec2::new(across, outward));
    let left = SECTION.iter().map(|&(across, outward)| DVec2::new(-across, outward));
    let section: Vec<DVec2> = right.chain(left).collect();
    let columns = section.len();
    let point = |row: usize, column: usize| frames[row].point(section[column]);
    let inlaid = SECTION.len() - 2..=SECTION.len();
    rings(frames.len(), columns, Ends::Joined, point).assigned(|face, _, _| {
        let (row, column) = (face / columns, face % columns);
        if inlaid.contains(&column) {
            inlay(row / usize::from(detail.0), column - inlaid.start())
        } else {
            gold
        }
    })
}

/// The directions in which three neighbouring axes have their mean: the middles of the triangular openings.
fn triangle_centers() -> Vec<DVec3> {
    let corners: Vec<DVec3> = axes().into_iter().flat_map(|axis| [axis, -axis]).collect();
    let mut centers = Vec::new();
    for (first, a) in corners.iter().enumerate() {
        for (second, b) in corners.iter().enumerate().skip(first + 1) {
            for c in &corners[second + 1..] {
                // Neighbouring corners of an icosahedron are 63.4 degrees apart, the next ones 116.6.
                if a.dot(*b).min(b.dot(*c)).min(c.dot(*a)) > 0.0 {
                    centers.push((a + b + c).normalize());
                }
            }
        }
    }
    centers
}

/// Unit vectors along the six axes through opposite corners of an icosahedron, turned so that the view from +z
/// shows no two rings in line.
fn axes() -> [DVec3; 6] {
    let golden = (1.0 + 5f64.sqrt()) / 2.0;
    let tilt = turn_y(0.05) * turn_x(0.04);
    [
        DVec3::new(0.0, 1.0, golden),
        DVec3::new(0.0, -1.0, golden),
        DVec3::new(1.0, golden, 0.0),
        DVec3::new(-1.0, golden, 0.0),
        DVec3::new(golden, 0.0, 1.0),
        DVec3::new(golden, 0.0, -1.0),
    ]
    .map(|axis| tilt.transform_vector3(axis).normalize())
}

/// The great circle around `axis`, waving in and out so that it passes alternately over and under the other five.
///
/// The six circles cut the sphere into triangles and pentagons (an icosidodecahedron). Walking along a circle, the face
/// ahead on the left is of the other kind after each crossing, so "over where it is a pentagon" weaves all of them.
fn ring_curve(axis: DVec3) -> impl Fn(f64) -> DVec3 {
    let all = axes();
    let crossing = all
        .iter()
        .map(|other| axis.cross(*other))
        .find(|crossing| crossing.length() > 0.1)
        .unwrap_or(DVec3::X)
        .normalize();
    let ahead = axis.cross(crossing);
    let nearness_to_pentagon = |side: DVec3| {
        let inside_face = (crossing + 0.4 * (ahead + side)).normalize();
        all.iter().map(|center| center.dot(inside_face).abs()).fold(0.0, f64::max)
    };
    let over = nearness_to_pentagon(axis) > nearness_to_pentagon(-axis);
    let height = if over { WEAVE } else { -WEAVE };
    move |turn| {
        let (cosine_here, sine_here) = circle(turn).into();
        (crossing * cosine_here + ahead * sine_here) * (1.0 + height * cosine(5.0 * turn))
    }
}

/// The centre lines of a knot's strands. The two knots are trefoils on the same torus, half a pass apart.
fn strands(knot: usize, detail: Detail) -> [Vec<DVec3>; 3] {
    let place = turn_y(0.05) * turn_x(0.2) * turn_y(0.06 + knot as f64 / 6.0);
    let trefoil = torus_knot(2, 3, KNOT_MAJOR, KNOT_MINOR);
    let path = sample_closed(detail.segments(130), |turn| place.transform_point3(trefoil(turn)));
    let core = frames(&path, Course::Closed);
    [0.0, 1.0, 2.0].map(|third| strand(&core, STRAND_DISTANCE, ROPE_TWISTS, third / 3.0))
}

/// Moves the origin to `point` and turns the y axis away from the center.
fn pointing_to(point: DVec3) -> DAffine3 {
    let outward = point.normalize();
    let right = outward.any_orthonormal_vector();
    DAffine3::from_mat3_translation(DMat3::from_cols(right, outward, right.cross(outward)), point)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The farthest a band reaches from its middle line.
    fn band_reach() -> f64 {
        SECTION.iter().map(|&(across, outward)| DVec2::new(across, outward).length()).fold(0.0, f64::max)
    }

    fn least_distance(first: &[DVec3], second: &[DVec3]) -> f64 {
        let distances = first.iter().flat_map(|a| second.iter().map(|b| a.distance(*b)));
        distances.fold(f64::INFINITY, f64::min)
    }

    /// The vertices of each band.
    fn bands(detail: Detail) -> [Vec<DVec3>; 6] {
        axes().map(|axis| {
            let band = band(axis, detail, |_, _| MaterialId(0), MaterialId(0));
            band.vertices.iter().map(|vertex| vertex.position).collect()
        })
    }

    #[test]
    fn each_band_passes_over_and_under_in_turn() {
        for axis in axes() {
            let ring = ring_curve(axis);
            // Crossings are a tenth of a turn apart, the first at 0.
            let heights =
                [0, 1, 2, 3, 4, 5, 6, 7, 8, 9].map(|tenth| ring(f64::from(tenth) / 10.0).length() - 1.0);
            for pair in heights.windows(2) {
                assert!(pair[0] * pair[1] < 0.0, "{heights:?}");
            }
        }
    }

    #[test]
    fn at_a_crossing_one_band_is_wholly_over_the_other() {
        // Bands of half the width w that cross at 63.4 degrees overlap no farther from the crossing than w / sin 31.7°.
        let overlap = band_reach() / 0.525;
        let bands = bands(Detail(3));
        for (first, first_axis) in axes().into_iter().enumerate() {
            for (second, second_axis) in axes().into_iter().enumerate().skip(first + 1) {
                for side in [1.0, -1.0] {
                    let crossing = first_axis.cross(second_axis).normalize() * side;
                    let radii = |band: &[DVec3]| {
                        let near =
                            band.iter().filter(|vertex| vertex.normalize().distance(crossing) < overlap);
                        near.map(|vertex| vertex.length())
                            .fold((f64::INFINITY, 0f64), |(least, most), radius| {
                                (least.min(radius), most.max(radius))
                            })
                    };
                    let (first, second) = (radii(&bands[first]), radii(&bands[second]));
                    let gap = (first.0 - second.1).max(second.0 - first.1);
                    assert!(gap > 0.005, "{first:?} {second:?}");
                }
            }
        }
    }

    #[test]
    fn the_parts_do_not_touch() {
        let fine = Detail(3);
        let bands = bands(fine);
        let strands: Vec<Vec<DVec3>> = (0..2).flat_map(|knot| strands(knot, fine)).collect();
        for (index, curve) in strands.iter().enumerate() {
            for other in &strands[index + 1..] {
                let distance = least_distance(curve, other);
                assert!(distance > 2.0 * STRAND_RADIUS, "{index}: {distance}");
            }
            for point in curve {
                assert!(point.length() > CORE_RADIUS + STRAND_RADIUS, "{}", point.length());
                assert!(point.length() < 1.0 - WEAVE - band_reach() - STRAND_RADIUS, "{}", point.length());
            }
        }
        let beads = triangle_centers();
        assert_eq!(beads.len(), 20);
        for (index, band) in bands.iter().enumerate() {
            let distance = least_distance(band, &beads);
            assert!(distance > BEAD_RADIUS, "{index}: {distance}");
        }
    }
}
