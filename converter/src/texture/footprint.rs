//! How much of a texture a voxel sees.

use super::coordinates::TexturePoint;
use crate::fixed_point::{GridPoint, SUBVOXELS};
use crate::vector::{cross, dot};

/// How texture coordinates change over a triangle: the gradients of u and of v in space, per voxel. Both lie in the plane of
/// the triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Gradients(pub [[f64; 3]; 2]);

impl Gradients {
    /// Texture coordinates that do not change: a sample sees the image itself.
    pub(crate) const STILL: Self = Self([[0.0; 3]; 2]);

    /// `None` if the triangle has no area.
    pub(crate) fn new(corners: &[GridPoint; 3], coordinates: &[TexturePoint; 3]) -> Option<Self> {
        let edge = |to: usize| {
            [0, 1, 2].map(|axis| f64::from(corners[to][axis] - corners[0][axis]) / f64::from(SUBVOXELS))
        };
        let (e, f) = (edge(1), edge(2));
        let normal = cross(e, f);
        let square = dot(normal, normal);
        if square == 0.0 {
            return None;
        }
        // The vectors (f × n) / n² and (n × e) / n² are 1 along one of the edges and 0 along the other.
        let (along_e, along_f) = (cross(f, normal), cross(normal, e));
        Some(Self([0, 1].map(|k| {
            let [a, b, c] = coordinates.map(|TexturePoint(corner)| f64::from(corner[k]));
            [0, 1, 2].map(|axis| ((b - a) * along_e[axis] + (c - a) * along_f[axis]) / square)
        })))
    }

    /// What a voxel sees of an image whose texels are `texels[0]` to a unit of u and `texels[1]` to a unit of v.
    pub(crate) fn footprint(&self, texels: [f64; 2]) -> Footprint {
        let Self([u, v]) = self;
        let [u, v] = [u.map(|component| component * texels[0]), v.map(|component| component * texels[1])];
        // The circle around a point of the surface becomes an ellipse in the image, x ↦ J x. Its axes are the
        // eigenvectors of J Jᵀ, and the squares of their lengths the eigenvalues.
        let (a, b, c) = (dot(u, u), dot(u, v), dot(v, v));
        let (mean, half) = ((a + c) / 2.0, (a - c) / 2.0);
        let spread = (half * half + b * b).sqrt();
        let (major, minor) = ((mean + spread).sqrt(), (mean - spread).max(0.0).sqrt());
        let direction = if half >= 0.0 { [half + spread, b] } else { [b, spread - half] };
        let length = (direction[0] * direction[0] + direction[1] * direction[1]).sqrt();
        let direction = if length > 0.0 { direction.map(|component| component / length) } else { [1.0, 0.0] };
        if !(major.is_finite() && direction[0].is_finite() && direction[1].is_finite()) {
            return Footprint { major: f64::MAX, minor: f64::MAX, direction: [1.0, 0.0] };
        }
        Footprint { major, minor, direction }
    }
}

/// The ellipse in an image that a circle of a voxel's width on the surface covers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Footprint {
    /// Its length, in texels.
    pub major: f64,
    /// Its width, in texels.
    pub minor: f64,
    /// Unit vector along its length: texels to the right and up.
    pub direction: [f64; 2],
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gradients_are_changes_per_voxel() {
        let gradients = |corners: &[GridPoint; 3], points: [[f32; 2]; 3]| {
            Gradients::new(corners, &points.map(TexturePoint))
        };
        let corners = [[0, 0, 0], [4096, 0, 0], [0, 0, 2048]];
        let Gradients([u, v]) = gradients(&corners, [[0.0, 0.5], [1.0, 0.5], [0.0, 1.5]]).unwrap();
        assert_eq!((u, v), ([0.25, 0.0, 0.0], [0.0, 0.0, 0.5]));
        assert_eq!(gradients(&[[0; 3], [7; 3], [14; 3]], [[0.0; 2]; 3]), None);
    }

    #[test]
    fn a_turned_and_stretched_texture_has_a_turned_ellipse() {
        // Along the diagonal the texture is 8 texels to a voxel, across it 2.
        let gradients = Gradients([[5.0, 3.0, 0.0], [3.0, 5.0, 0.0]]);
        let found = gradients.footprint([1.0; 2]);
        assert!((found.major - 8.0).abs() < 1e-9 && (found.minor - 2.0).abs() < 1e-9, "{found:?}");
        assert!((found.direction[0] - found.direction[1]).abs() < 1e-9, "{found:?}");
        // Twice the texels, twice the size.
        assert!((gradients.footprint([2.0; 2]).major - 16.0).abs() < 1e-9);
    }

    #[test]
    fn a_texture_along_one_axis_or_none() {
        let along = |u, v| Gradients([u, v]).footprint([1.0; 2]);
        let found = along([0.0; 3], [0.0, 0.0, 3.0]);
        assert_eq!((found.major, found.minor), (3.0, 0.0));
        assert_eq!(found.direction.map(f64::abs), [0.0, 1.0]);
        assert_eq!(along([0.0; 3], [0.0; 3]).major, 0.0);
        // Coordinates beyond all reason stay numbers.
        assert!(along([f64::MAX; 3], [0.0; 3]).major.is_finite());
    }
}
