//! Closed surfaces to build with. Each shares its vertices and has its faces counter-clockwise seen from outside.

use crate::curve::{Course, Frame};
use crate::mesh::{Mesh, Vertex};
use crate::trigonometry::{circle, power};
use glam::{DVec2, DVec3};

/// What happens at the first and the last row of a surface made of rings.
#[derive(Debug, Clone, Copy)]
pub enum Ends {
    /// The last row is joined to the first, as on a torus.
    Joined,
    /// Each is closed with triangles to a point.
    Points(DVec3, DVec3),
}

/// A surface of `rows` closed rings with `columns` points each. The columns run counter-clockwise, seen against the
/// direction in which the rows follow each other.
pub fn rings<V: Into<Vertex>>(
    rows: usize,
    columns: usize,
    ends: Ends,
    point: impl Fn(usize, usize) -> V,
) -> Mesh {
    let mut mesh = Mesh::default();
    for row in 0..rows {
        for column in 0..columns {
            mesh.vertex(point(row, column));
        }
    }
    let index = |row: usize, column: usize| row % rows * columns + column % columns;
    let bands = if matches!(ends, Ends::Joined) { rows } else { rows - 1 };
    for row in 0..bands {
        for column in 0..columns {
            mesh.face(&[
                index(row, column),
                index(row, column + 1),
                index(row + 1, column + 1),
                index(row + 1, column),
            ]);
        }
    }
    if let Ends::Points(first, last) = ends {
        let lowest: Vec<usize> = (0..columns).rev().map(|column| index(0, column)).collect();
        let highest: Vec<usize> = (0..columns).map(|column| index(rows - 1, column)).collect();
        // The caps take on the colour of the ring beside them.
        let (first_color, last_color) = (mesh.vertices[lowest[0]].color, mesh.vertices[highest[0]].color);
        mesh.fan((first, first_color), &lowest);
        mesh.fan((last, last_color), &highest);
    }
    mesh
}

/// A surface of revolution around the y axis through a profile of (radius, height) pairs, from bottom to top.
/// A radius of zero is only allowed at the ends, where it becomes a pole; other ends are closed with flat discs.
pub fn revolution(profile: &[DVec2], columns: usize) -> Mesh {
    let on_axis = |point: DVec2| DVec3::new(0.0, point.y, 0.0);
    let (Some(&bottom), Some(&top)) = (profile.first(), profile.last()) else { return Mesh::default() };
    let start = usize::from(bottom.x == 0.0);
    let end = profile.len() - usize::from(top.x == 0.0);
    let rows = &profile[start..end];
    rings(rows.len(), columns, Ends::Points(on_axis(bottom), on_axis(top)), |row, column| {
        let direction = circle(column as f64 / columns as f64);
        DVec3::new(rows[row].x * direction.x, rows[row].y, -rows[row].x * direction.y)
    })
}

/// An upright cylinder with its base on the plane y = 0; a cone stump if the radii differ.
pub fn cylinder(bottom_radius: f64, top_radius: f64, height: f64, columns: usize) -> Mesh {
    revolution(&[DVec2::new(bottom_radius, 0.0), DVec2::new(top_radius, height)], columns)
}

/// A tube along a curve. `section` gives a frame's row and the column's angle in turns a point in the plane of the frame.
pub fn tube<V: Into<Vertex>>(
    frames: &[Frame],
    course: Course,
    columns: usize,
    section: impl Fn(usize, f64) -> DVec2,
    paint: impl Fn(usize, f64, DVec3) -> V,
) -> Mesh {
    let ends = match course {
        Course::Closed => Ends::Joined,
        Course::Open => Ends::Points(frames[0].origin, frames[frames.len() - 1].origin),
    };
    rings(frames.len(), columns, ends, |row, column| {
        let turn = column as f64 / columns as f64;
        paint(row, turn, frames[row].point(section(row, turn)))
    })
}

/// A round tube of constant radius along a curve.
pub fn wire(frames: &[Frame], course: Course, columns: usize, radius: f64) -> Mesh {
    tube(frames, course, columns, |_, turn| circle(turn) * radius, |_, _, point| point)
}

/// An ellipsoid around the origin.
pub fn ellipsoid(radii: DVec3, columns: usize, rows: usize) -> Mesh {
    superellipsoid(radii, 1.0, columns, rows)
}

/// A superellipsoid around the origin (Barr 1981): an exponent of 1 gives an ellipsoid, towards 0 a box with rounded edges,
/// 2 an octahedron.
pub fn superellipsoid(radii: DVec3, exponent: f64, columns: usize, rows: usize) -> Mesh {
    let bend = |value: f64| power(value.abs(), exponent).copysign(value);
    let poles = Ends::Points(DVec3::new(0.0, -radii.y, 0.0), DVec3::new(0.0, radii.y, 0.0));
    rings(rows - 1, columns, poles, |row, column| {
        let latitude = circle((row + 1) as f64 / rows as f64 * 0.5 - 0.25);
        let longitude = circle(column as f64 / columns as f64);
        let radius = bend(latitude.x);
        radii * DVec3::new(radius * bend(longitude.x), bend(latitude.y), -radius * bend(longitude.y))
    })
}

/// A box around the origin with edges of the given lengths.
pub fn cuboid(size: DVec3) -> Mesh {
    let half = size.truncate() * 0.5;
    let corner = |x: f64, y: f64| DVec2::new(x * half.x, y * half.y);
    prism(&[corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)], size.z)
}

/// A convex polygon in the plane of x and y, counter-clockwise seen from +z, drawn out to the given depth around z = 0.
pub fn prism(polygon: &[DVec2], depth: f64) -> Mesh {
    let mut mesh = Mesh::default();
    let count = polygon.len();
    for z in [depth * 0.5, -depth * 0.5] {
        for point in polygon {
            mesh.vertex(point.extend(z));
        }
    }
    mesh.face(&(0..count).collect::<Vec<_>>());
    mesh.face(&(count..2 * count).rev().collect::<Vec<_>>());
    for from in 0..count {
        let to = (from + 1) % count;
        mesh.face(&[to, from, from + count, to + count]);
    }
    mesh
}

/// A block with a curved top. `top` maps a grid over u and v from 0 to 1 to the surface, u towards +x and v towards +z;
/// the sides fall straight down to the plane y = `floor`.
pub fn slab<V: Into<Vertex>>(columns: usize, rows: usize, floor: f64, top: impl Fn(f64, f64) -> V) -> Mesh {
    let mut mesh = Mesh::default();
    for row in 0..=rows {
        for column in 0..=columns {
            mesh.vertex(top(column as f64 / columns as f64, row as f64 / rows as f64));
        }
    }
    let index = |column: usize, row: usize| row * (columns + 1) + column;
    for row in 0..rows {
        for column in 0..columns {
            mesh.face(&[
                index(column, row),
                index(column, row + 1),
                index(column + 1, row + 1),
                index(column + 1, row),
            ]);
        }
    }
    // Counter-clockwise seen from above, as the faces are.
    let rim: Vec<usize> = (0..rows)
        .map(|row| index(0, row))
        .chain((0..columns).map(|column| index(column, rows)))
        .chain((1..=rows).rev().map(|row| index(columns, row)))
        .chain((1..=columns).rev().map(|column| index(column, 0)))
        .collect();
    let foot: Vec<usize> = rim
        .iter()
        .map(|&vertex| {
            let Vertex { position, color } = mesh.vertices[vertex];
            mesh.vertex((DVec3::new(position.x, floor, position.z), color))
        })
        .collect();
    for (place, &vertex) in rim.iter().enumerate() {
        let next = (place + 1) % rim.len();
        mesh.face(&[foot[place], foot[next], rim[next], vertex]);
    }
    let middle = foot.iter().map(|&vertex| mesh.vertices[vertex].position).sum::<DVec3>() / foot.len() as f64;
    let outline: Vec<usize> = foot.into_iter().rev().collect();
    mesh.fan(middle, &outline);
    mesh
}

/// Maps the square [-1,1]² onto the unit disc, so that a square grid becomes a round one with even cells
/// (elliptical grid mapping, Nowell 2005).
pub fn square_to_disc(point: DVec2) -> DVec2 {
    let square = point * point;
    DVec2::new(point.x * (1.0 - square.y * 0.5).sqrt(), point.y * (1.0 - square.x * 0.5).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::{frames, sample_closed, torus_knot};
    use crate::topology::{open_edges, volume};

    fn assert_solid(name: &str, mesh: &Mesh, expected_volume: f64) {
        assert_eq!(open_edges(mesh), 0, "{name}");
        let found = volume(mesh);
        assert!((found / expected_volume - 1.0).abs() < 0.02, "{name}: {found}, expected {expected_volume}");
    }

    #[test]
    fn primitives_are_closed_and_face_outward() {
        let pi = std::f64::consts::PI;
        assert_solid("cuboid", &cuboid(DVec3::new(1.0, 2.0, 3.0)), 6.0);
        assert_solid("cylinder", &cylinder(1.0, 1.0, 2.0, 128), 2.0 * pi);
        assert_solid("cone", &cylinder(1.0, 0.0, 3.0, 128), pi);
        assert_solid("ellipsoid", &ellipsoid(DVec3::new(1.0, 2.0, 0.5), 96, 48), 4.0 / 3.0 * pi);
        assert_solid("octahedron", &superellipsoid(DVec3::ONE, 2.0, 96, 48), 4.0 / 3.0);
        let core = frames(&sample_closed(400, torus_knot(1, 0, 1.0, 0.0)), Course::Closed);
        assert_solid("torus", &wire(&core, Course::Closed, 64, 0.2), 2.0 * pi * pi * 0.04);
        let straight: Vec<DVec3> = (0..5).map(|step| DVec3::new(f64::from(step), 0.0, 1.0)).collect();
        let core = frames(&straight, Course::Open);
        assert_solid("rod", &wire(&core, Course::Open, 128, 0.5), pi);
        let hill = slab(40, 30, -1.0, |u, v| DVec3::new(2.0 * u, u * v, 3.0 * v));
        assert_solid("slab", &hill, 6.0 * 1.25);
    }

    #[test]
    fn the_disc_mapping_takes_the_rim_to_the_unit_circle() {
        for step in -10..=10 {
            let along = f64::from(step) / 10.0;
            for point in [DVec2::new(along, 1.0), DVec2::new(-1.0, along)] {
                assert!((square_to_disc(point).length() - 1.0).abs() < 1e-12);
            }
        }
    }
}
