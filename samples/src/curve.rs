//! Curves in space and the frames that travel along them.

use crate::trigonometry::{angle, circle};
use glam::{DVec2, DVec3};

/// A point of a curve with three perpendicular directions: right, up and forward, where right × up = forward.
#[derive(Debug, Clone, Copy)]
pub struct Frame {
    pub origin: DVec3,
    pub right: DVec3,
    pub up: DVec3,
    pub forward: DVec3,
}

impl Frame {
    /// The point at `x` to the right and `y` up.
    pub fn point(&self, offset: DVec2) -> DVec3 {
        self.origin + self.right * offset.x + self.up * offset.y
    }

    fn turned(self, turns: f64) -> Self {
        let (cosine, sine) = circle(turns).into();
        let right = self.right * cosine + self.up * sine;
        Self { right, up: self.forward.cross(right), ..self }
    }
}

/// Whether a curve's end is joined to its start.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Course {
    Open,
    Closed,
}

/// Frames along a polyline that turn no more than the curve makes them: parallel transport by double reflection
/// (Wang, Jüttler, Zheng and Liu 2008). On a closed curve what is left over is spread evenly, so that the last frame
/// leads into the first.
pub fn frames(points: &[DVec3], course: Course) -> Vec<Frame> {
    let count = points.len();
    let tangent = |index: usize| {
        let (before, after) = match course {
            Course::Closed => (points[(index + count - 1) % count], points[(index + 1) % count]),
            Course::Open => (points[index.saturating_sub(1)], points[(index + 1).min(count - 1)]),
        };
        (after - before).normalize_or(DVec3::Y)
    };
    let forward = tangent(0);
    let right = forward.any_orthonormal_vector();
    let first = Frame { origin: points[0], right, up: forward.cross(right), forward };
    let mut frames = vec![first];
    for (index, &point) in points.iter().enumerate().skip(1) {
        frames.push(transported(&frames[index - 1], point, tangent(index)));
    }
    if course == Course::Closed {
        let arrived = transported(&frames[count - 1], first.origin, first.forward);
        let excess = angle(DVec2::new(arrived.right.dot(first.right), arrived.right.dot(first.up)));
        for (index, frame) in frames.iter_mut().enumerate() {
            *frame = frame.turned(-excess * index as f64 / count as f64);
        }
    }
    frames
}

/// `frame`, carried to a new point and tangent by two reflections.
fn transported(frame: &Frame, origin: DVec3, forward: DVec3) -> Frame {
    let step = origin - frame.origin;
    let reflect = |vector: DVec3, mirror: DVec3| {
        let square = mirror.length_squared();
        if square > 0.0 { vector - mirror * (2.0 * mirror.dot(vector) / square) } else { vector }
    };
    let halfway = reflect(frame.right, step);
    let right = reflect(halfway, forward - reflect(frame.forward, step));
    // Rounding must not add up over a long curve.
    let right = right.reject_from_normalized(forward).normalize_or(frame.right);
    Frame { origin, right, up: forward.cross(right), forward }
}

/// `count` points of a closed curve given over one turn.
pub fn sample_closed(count: usize, curve: impl Fn(f64) -> DVec3) -> Vec<DVec3> {
    (0..count).map(|index| curve(index as f64 / count as f64)).collect()
}

/// One of the strands of a rope: a line that winds `twists` times around a closed curve, at the distance `radius`,
/// starting `phase` turns from the right.
pub fn strand(core: &[Frame], radius: f64, twists: i32, phase: f64) -> Vec<DVec3> {
    let advance = f64::from(twists) / core.len() as f64;
    core.iter()
        .enumerate()
        .map(|(index, frame)| frame.point(circle(phase + advance * index as f64) * radius))
        .collect()
}

/// The torus knot that runs `around` times around the y axis while it winds `through` times through the hole:
/// a curve over one turn, on a torus with radii `major` and `minor`.
pub fn torus_knot(around: u32, through: u32, major: f64, minor: f64) -> impl Fn(f64) -> DVec3 {
    move |turn| {
        let winding = circle(turn * f64::from(through));
        let heading = circle(turn * f64::from(around));
        let distance = major + minor * winding.x;
        DVec3::new(distance * heading.x, minor * winding.y, -distance * heading.y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_orthonormal_and_close() {
        let points = sample_closed(300, torus_knot(2, 3, 1.0, 0.4));
        let frames = frames(&points, Course::Closed);
        for (index, frame) in frames.iter().enumerate() {
            assert!((frame.right.cross(frame.up) - frame.forward).length() < 1e-9);
            let next = &frames[(index + 1) % frames.len()];
            // A step of a 300th of the knot bends by a few degrees; a jump at the seam would show.
            assert!(frame.right.dot(next.right) > 0.98, "{index}");
        }
    }

    #[test]
    fn a_plane_circle_does_not_twist() {
        let points = sample_closed(64, |turn| circle(turn).extend(0.0));
        let frames = frames(&points, Course::Closed);
        let height = frames[0].right.z;
        assert!(frames.iter().all(|frame| (frame.right.z - height).abs() < 1e-9));
    }

    #[test]
    fn a_strand_keeps_its_distance() {
        let core = frames(&sample_closed(100, |turn| circle(turn).extend(0.0)), Course::Closed);
        for (point, frame) in strand(&core, 0.1, 5, 0.3).iter().zip(&core) {
            assert!((point.distance(frame.origin) - 0.1).abs() < 1e-12);
        }
    }
}
