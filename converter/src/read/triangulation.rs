//! Polygons into triangles.

/// More corners than this are cut as a fan: cutting ears takes time that grows with the square of their number.
const MAX_EAR_CORNERS: usize = 4096;

/// Cuts polygons into triangles; keeps its working memory from one polygon to the next.
#[derive(Debug, Default)]
pub(in crate::read) struct Triangulation {
    flat: Vec<[f64; 2]>,
    remaining: Vec<usize>,
}

impl Triangulation {
    /// Calls `emit` with the corners (indices into `polygon`) of each triangle of a polygon of three or more corners.
    ///
    /// A convex polygon is cut as a fan around its first corner. Ears are cut from a concave one, seen along its normal;
    /// one that crosses itself has no ears left at some point, and the rest of it is cut as a fan.
    /// All triangles turn the way the polygon does.
    pub(in crate::read) fn cut(&mut self, polygon: &[[f64; 3]], mut emit: impl FnMut([usize; 3])) {
        let corners = polygon.len();
        if corners > 3 && corners <= MAX_EAR_CORNERS {
            self.project(polygon);
            if !self.is_convex() {
                self.cut_ears(&mut emit);
                return;
            }
        }
        for corner in 2..corners {
            emit([0, corner - 1, corner]);
        }
    }

    /// Projects the polygon along the largest axis of its normal, so that it turns counterclockwise.
    fn project(&mut self, polygon: &[[f64; 3]]) {
        // Newell's normal: also right for a polygon that is not quite flat.
        let mut normal = [0.0; 3];
        let origin = polygon[0];
        let relative = |p: &[f64; 3]| [p[0] - origin[0], p[1] - origin[1], p[2] - origin[2]];
        for (index, a) in polygon.iter().enumerate() {
            let (a, b) = (relative(a), relative(&polygon[(index + 1) % polygon.len()]));
            for (axis, component) in normal.iter_mut().enumerate() {
                let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                *component += a[u] * b[v] - a[v] * b[u];
            }
        }
        let axis =
            (0..3).fold(0, |best, axis| if normal[axis].abs() > normal[best].abs() { axis } else { best });
        let (u, v) = if normal[axis] < 0.0 {
            ((axis + 2) % 3, (axis + 1) % 3)
        } else {
            ((axis + 1) % 3, (axis + 2) % 3)
        };
        self.flat.clear();
        self.flat.extend(polygon.iter().map(relative).map(|p| [p[u], p[v]]));
    }

    fn is_convex(&self) -> bool {
        let count = self.flat.len();
        (0..count).all(|i| turn(self.flat[i], self.flat[(i + 1) % count], self.flat[(i + 2) % count]) >= 0.0)
    }

    fn cut_ears(&mut self, emit: &mut impl FnMut([usize; 3])) {
        self.remaining.clear();
        self.remaining.extend(0..self.flat.len());
        let mut start = 0;
        while self.remaining.len() > 3 {
            let count = self.remaining.len();
            let Some(ear) = (0..count).map(|step| (start + step) % count).find(|&ear| self.is_ear(ear))
            else {
                break;
            };
            let [before, tip, after] = self.around(ear);
            emit([before, tip, after]);
            self.remaining.remove(ear);
            // Going on behind the cut avoids a fan of slivers around one corner.
            start = (ear + 1) % (count - 1);
        }
        for corner in 2..self.remaining.len() {
            emit([self.remaining[0], self.remaining[corner - 1], self.remaining[corner]]);
        }
    }

    /// The corner at a place among the remaining ones, between its neighbours.
    fn around(&self, place: usize) -> [usize; 3] {
        let count = self.remaining.len();
        [
            self.remaining[(place + count - 1) % count],
            self.remaining[place],
            self.remaining[(place + 1) % count],
        ]
    }

    fn is_ear(&self, place: usize) -> bool {
        let [before, tip, after] = self.around(place);
        let [a, b, c] = [before, tip, after].map(|corner| self.flat[corner]);
        turn(a, b, c) > 0.0
            && self.remaining.iter().all(|&corner| {
                let p = self.flat[corner];
                // A corner at the same place as one of the ear's is no obstacle (bridges to holes run twice).
                let inside = turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
                !inside || p == a || p == b || p == c
            })
    }
}

/// Twice the area of a triangle, positive if it turns counterclockwise.
fn turn(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cut(polygon: &[[f64; 3]]) -> Vec<[usize; 3]> {
        let mut triangles = Vec::new();
        Triangulation::default().cut(polygon, |triangle| triangles.push(triangle));
        triangles
    }

    /// Signed area seen along x, by the shoelace formula.
    fn area(polygon: &[[f64; 3]], corners: &[usize]) -> f64 {
        let at = |k: usize| polygon[corners[k % corners.len()]];
        (0..corners.len()).map(|k| at(k)[1] * at(k + 1)[2] - at(k + 1)[1] * at(k)[2]).sum::<f64>() / 2.0
    }

    #[test]
    fn a_concave_polygon_is_covered_once() {
        // An arrow, a comb and a spiral in a plane x = const, in both senses of rotation.
        let shapes: [&[[f64; 2]]; 3] = [
            &[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [3.0, 1.0]],
            &[
                [0.0, 0.0],
                [5.0, 0.0],
                [5.0, 3.0],
                [4.0, 3.0],
                [4.0, 1.0],
                [3.0, 1.0],
                [3.0, 3.0],
                [2.0, 3.0],
                [2.0, 1.0],
                [0.0, 1.0],
            ],
            &[
                [0.0, 0.0],
                [6.0, 0.0],
                [6.0, 5.0],
                [1.0, 5.0],
                [1.0, 2.0],
                [3.0, 2.0],
                [3.0, 3.0],
                [2.0, 3.0],
                [2.0, 4.0],
                [5.0, 4.0],
                [5.0, 1.0],
                [0.0, 1.0],
            ],
        ];
        for shape in shapes {
            for reversed in [false, true] {
                let mut polygon: Vec<[f64; 3]> = shape.iter().map(|p| [7.0, p[0], p[1]]).collect();
                if reversed {
                    polygon.reverse();
                }
                let whole = area(&polygon, &(0..polygon.len()).collect::<Vec<_>>());
                let parts: Vec<f64> = cut(&polygon).iter().map(|triangle| area(&polygon, triangle)).collect();
                assert_eq!(parts.len(), polygon.len() - 2);
                // No part turns the other way, so none covers what is outside or twice.
                assert!(parts.iter().all(|part| part * whole > 0.0), "{parts:?}");
                assert!((parts.iter().sum::<f64>() - whole).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_polygon_without_area_still_yields_its_triangles() {
        let line: Vec<[f64; 3]> = (0..6).map(|k| [f64::from(k), 0.0, 0.0]).collect();
        assert_eq!(cut(&line).len(), 4);
        assert_eq!(cut(&[[1.0; 3]; 5]).len(), 3);
        assert_eq!(cut(&[[f64::MAX; 3], [f64::MIN; 3], [0.0; 3], [f64::MAX, 0.0, 1.0]]).len(), 2);
    }
}
