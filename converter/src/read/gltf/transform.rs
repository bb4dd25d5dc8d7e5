//! Where nodes are.

use ::gltf::scene::Transform as NodeTransform;

/// An affine transformation in double precision: the images of the three axes and of the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Transform {
    axes: [[f64; 3]; 3],
    origin: [f64; 3],
}

impl Transform {
    pub(super) const IDENTITY: Self =
        Self { axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], origin: [0.0; 3] };

    fn of_node(node: &NodeTransform) -> Self {
        match *node {
            NodeTransform::Matrix { matrix } => {
                let column = |k: usize| [0, 1, 2].map(|row| f64::from(matrix[k][row]));
                Self { axes: [column(0), column(1), column(2)], origin: column(3) }
            }
            NodeTransform::Decomposed { translation, rotation, scale } => {
                let [x, y, z, w] = rotation.map(f64::from);
                // The rotation matrix of a unit quaternion, by columns.
                let axes = [
                    [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + z * w), 2.0 * (x * z - y * w)],
                    [2.0 * (x * y - z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + x * w)],
                    [2.0 * (x * z + y * w), 2.0 * (y * z - x * w), 1.0 - 2.0 * (x * x + y * y)],
                ];
                Self {
                    axes: [0, 1, 2].map(|k| axes[k].map(|component| component * f64::from(scale[k]))),
                    origin: translation.map(f64::from),
                }
            }
        }
    }

    /// This transformation after that of a node: that of the node within this one.
    pub(super) fn then(&self, node: &NodeTransform) -> Self {
        let node = Self::of_node(node);
        Self { axes: node.axes.map(|axis| self.direction(axis)), origin: self.point(node.origin) }
    }

    pub(super) fn point(&self, point: [f64; 3]) -> [f64; 3] {
        let moved = self.direction(point);
        [0, 1, 2].map(|row| moved[row] + self.origin[row])
    }

    fn direction(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let [a, b, c] = self.axes;
        [0, 1, 2].map(|row| a[row] * x + b[row] * y + c[row] * z)
    }

    /// A normal, of any length: those of a surface go with the inverse transposed matrix, here times its determinant.
    pub(super) fn normal(&self, [x, y, z]: [f64; 3]) -> [f32; 3] {
        let [a, b, c] = self.axes;
        let (bc, ca, ab) = (cross(b, c), cross(c, a), cross(a, b));
        let sign = if self.mirrors() { -1.0 } else { 1.0 };
        let normal = [0, 1, 2].map(|row| sign * (bc[row] * x + ca[row] * y + ab[row] * z));
        // Of length 1, since the scale may be too small or too large for single precision.
        let length = normal.iter().map(|component| component * component).sum::<f64>().sqrt();
        normal.map(|component| (component / length) as f32)
    }

    /// Whether left and right are exchanged.
    pub(super) fn mirrors(&self) -> bool {
        let [a, b, c] = self.axes;
        let bc = cross(b, c);
        a[0] * bc[0] + a[1] * bc[1] + a[2] * bc[2] < 0.0
    }
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
