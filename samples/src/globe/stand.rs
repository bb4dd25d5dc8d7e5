//! The stand: a brass meridian that holds the planet at its poles, on a turned wooden foot.

use super::{CENTER, TILT};
use crate::color::hex;
use crate::curve::{Course, Frame};
use crate::detail::Detail;
use crate::material::Material;
use crate::mesh::{MaterialId, Mesh};
use crate::placement::{shift, turn_x};
use crate::primitives::{cylinder, ellipsoid, revolution, tube};
use crate::scene::Scene;
use crate::trigonometry::circle;
use glam::{DVec2, DVec3};

/// Distance of the meridian's middle from the planet's centre.
const MERIDIAN: f64 = 1.17;
const MERIDIAN_THICKNESS: f64 = 0.05;
const MERIDIAN_WIDTH: f64 = 0.12;

/// The materials of the stand.
pub struct Paints {
    brass: MaterialId,
    mark: MaterialId,
    dark_wood: MaterialId,
    wood: MaterialId,
    felt: MaterialId,
}

impl Paints {
    /// Adds the materials to the scene.
    pub fn new(scene: &mut Scene) -> Self {
        let mut add = |name: &str, color, specular, shininess| {
            scene.material(Material::matte(name, hex(color)).glossy(hex(specular), shininess))
        };
        Self {
            brass: add("brass", 0xd9a441, 0xfff0b8, 70.0),
            mark: add("mark", 0x4a3214, 0x403020, 20.0),
            dark_wood: add("dark_wood", 0x5a2c1a, 0x706050, 45.0),
            wood: add("wood", 0x9c5a2c, 0x706050, 45.0),
            felt: add("felt", 0x1f6b4a, 0x101010, 5.0),
        }
    }
}

/// The arc from pole to pole and on to the foot, with pins; in the planet's own frame, its poles on the y axis.
pub fn meridian(detail: Detail, paints: &Paints) -> Mesh {
    const MARKS: usize = 42;
    const OVERLAP: f64 = 0.012;
    let rows = detail.segments(2 * MARKS) + 1;
    let frames: Vec<Frame> = (0..rows)
        .map(|row| {
            // From a little beyond the north over -x and the south to the lowest point, where the foot stands.
            let sweep = 0.5 + TILT + 2.0 * OVERLAP;
            let outward = circle(0.25 - OVERLAP + sweep * row as f64 / (rows - 1) as f64).extend(0.0);
            Frame {
                origin: outward * MERIDIAN,
                right: DVec3::Z,
                up: outward,
                forward: DVec3::Z.cross(outward),
            }
        })
        .collect();
    let section: [DVec2; 12] = [
        (1.0, -0.7),
        (1.0, 0.7),
        (0.92, 1.0),
        (0.4, 1.0),
        (-0.4, 1.0),
        (-0.92, 1.0),
        (-1.0, 0.7),
        (-1.0, -0.7),
        (-0.92, -1.0),
        (-0.4, -1.0),
        (0.4, -1.0),
        (0.92, -1.0),
    ]
    .map(|(x, y)| DVec2::new(x * MERIDIAN_WIDTH / 2.0, y * MERIDIAN_THICKNESS / 2.0));
    let columns = section.len();
    let band = tube(
        &frames,
        Course::Open,
        columns,
        |_, turn| section[(turn * columns as f64).round() as usize % columns],
        |_, _, point| point,
    );
    // Degree marks on both flat sides.
    let band = band.creased(0.06).assigned(|face, center, _| {
        let row = face / columns / usize::from(detail.0);
        let is_side = center.z.abs() > MERIDIAN_WIDTH / 2.0 * 0.98;
        if is_side && row.is_multiple_of(2) && face < (rows - 1) * columns {
            paints.mark
        } else {
            paints.brass
        }
    });
    let pin = |side: f64| -> Mesh {
        let columns = detail.segments(20);
        let shaft = cylinder(0.022, 0.022, 0.28, columns).placed(shift(0.0, 1.01, 0.0));
        let washer = revolution(&[(0.05, 0.0), (0.06, 0.012), (0.04, 0.03)].map(DVec2::from), columns);
        let knob = ellipsoid(DVec3::new(0.042, 0.05, 0.042), columns, detail.segments(12));
        let parts: Mesh = [
            shaft,
            washer.clone().placed(shift(0.0, 1.06, 0.0)),
            washer.placed(shift(0.0, MERIDIAN + MERIDIAN_THICKNESS / 2.0, 0.0)),
            knob.placed(shift(0.0, 1.30, 0.0)),
        ]
        .into_iter()
        .collect();
        parts.placed(turn_x(side)).of(paints.brass)
    };
    [band, pin(0.0), pin(0.5)].into_iter().collect()
}

/// Column and base, standing on the plane y = 0 below the planet's centre.
pub fn foot(detail: Detail, paints: &Paints) -> Mesh {
    let columns = detail.segments(48);
    let turned = |profile: &[(f64, f64)], material: MaterialId| {
        let profile: Vec<DVec2> = profile.iter().copied().map(DVec2::from).collect();
        revolution(&profile, columns).of(material).creased(0.085)
    };
    let top = CENTER - MERIDIAN;
    [
        turned(&[(0.70, 0.0), (0.70, 0.012)], paints.felt),
        turned(
            &[
                (0.72, 0.012),
                (0.75, 0.03),
                (0.755, 0.055),
                (0.74, 0.08),
                (0.70, 0.095),
                (0.69, 0.11),
                (0.66, 0.12),
                (0.60, 0.135),
                (0.50, 0.145),
                (0.40, 0.165),
                (0.30, 0.20),
                (0.22, 0.235),
            ],
            paints.dark_wood,
        ),
        ring(detail, 0.62, 0.135, 0.016, paints.brass),
        ring(detail, 0.40, 0.17, 0.012, paints.brass),
        turned(&[(0.20, 0.22), (0.215, 0.235), (0.215, 0.255), (0.20, 0.27)], paints.brass),
        turned(
            &[
                (0.15, 0.26),
                (0.11, 0.28),
                (0.095, 0.30),
                (0.12, 0.325),
                (0.165, 0.36),
                (0.175, 0.395),
                (0.15, 0.43),
                (0.105, 0.46),
                (0.08, 0.485),
                (0.085, 0.50),
            ],
            paints.wood,
        ),
        turned(
            &[(0.10, 0.495), (0.115, 0.505), (0.115, 0.525), (0.09, 0.54), (0.075, top - 0.01)],
            paints.brass,
        ),
    ]
    .into_iter()
    .collect()
}

/// A torus around the y axis.
fn ring(detail: Detail, radius: f64, height: f64, thickness: f64, material: MaterialId) -> Mesh {
    let count = detail.segments(48);
    let frames: Vec<Frame> = (0..count)
        .map(|index| {
            let direction = circle(index as f64 / count as f64);
            let outward = DVec3::new(direction.x, 0.0, -direction.y);
            let origin = outward * radius + DVec3::Y * height;
            Frame { origin, right: -outward, up: DVec3::Y, forward: (-outward).cross(DVec3::Y) }
        })
        .collect();
    let section = |_: usize, turn: f64| circle(turn) * thickness;
    tube(&frames, Course::Closed, detail.segments(8), section, |_, _, point| point).of(material).smooth()
}
