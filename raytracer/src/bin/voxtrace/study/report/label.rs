//! Where the labels of points stand, so that none covers another.

/// A rectangle: left, top, right, bottom.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Area(pub [f64; 4]);

impl Area {
    pub fn around([x, y]: [f64; 2], half_width: f64, half_height: f64) -> Self {
        Self([x - half_width, y - half_height, x + half_width, y + half_height])
    }

    /// The smallest that holds two points.
    pub fn spanned(a: [f64; 2], b: [f64; 2]) -> Self {
        Self([a[0].min(b[0]), a[1].min(b[1]), a[0].max(b[0]), a[1].max(b[1])])
    }

    pub fn overlaps(&self, other: &Self) -> bool {
        let ([left, top, right, bottom], other) = (self.0, other.0);
        left < other[2] && other[0] < right && top < other[3] && other[1] < bottom
    }

    pub fn contains(&self, other: &Self) -> bool {
        let ([left, top, right, bottom], other) = (self.0, other.0);
        left <= other[0] && top <= other[1] && other[2] <= right && other[3] <= bottom
    }

    pub fn middle(&self) -> [f64; 2] {
        let [left, top, right, bottom] = self.0;
        [(left + right) / 2.0, (top + bottom) / 2.0]
    }
}

/// A label that looks for a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Label {
    /// The point that it names.
    pub point: [f64; 2],
    /// Width and height of the text.
    pub size: [f64; 2],
    /// Whether it stands anywhere rather than nowhere.
    pub is_needed: bool,
}

/// What labels had better not cover.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Obstacle {
    pub area: Area,
    /// How much worse than a unit of distance from the point it is to cover it.
    pub weight: f64,
}

/// Distances of labels from their points that are tried.
const DISTANCES: [f64; 5] = [9.0, 18.0, 32.0, 50.0, 72.0];

/// Labels whose best place is worse than this stand nowhere, unless they are needed.
const WORST: f64 = 45.0;

/// The places of labels, in their order, those first that matter most.
///
/// Each one takes the best of the places around its point, at several distances: near the point, covering
/// little else, never outside the plot and never over a label that stands already.
pub fn place(labels: &[Label], obstacles: &[Obstacle], bounds: &Area) -> Vec<Option<Area>> {
    let mut placed: Vec<Option<Area>> = Vec::with_capacity(labels.len());
    for label in labels {
        let is_free =
            |area: &Area| bounds.contains(area) && !placed.iter().flatten().any(|other| other.overlaps(area));
        let best = candidates(label)
            .filter(|(area, _)| is_free(area))
            .map(|(area, distance)| {
                let covered = obstacles.iter().filter(|obstacle| obstacle.area.overlaps(&area));
                (area, distance + covered.map(|obstacle| obstacle.weight).sum::<f64>())
            })
            .filter(|(_, cost)| label.is_needed || *cost < WORST)
            .min_by(|a, b| a.1.total_cmp(&b.1));
        placed.push(best.map(|(area, _)| area));
    }
    placed
}

/// Places around a point, each with its distance.
fn candidates(label: &Label) -> impl Iterator<Item = (Area, f64)> {
    // The upper right is free of the front of a plot whose front falls, so it comes first.
    const DIRECTIONS: [[f64; 2]; 8] = [
        [0.7, -0.7],
        [1.0, 0.0],
        [0.0, -1.0],
        [0.7, 0.7],
        [-0.7, -0.7],
        [0.0, 1.0],
        [-1.0, 0.0],
        [-0.7, 0.7],
    ];
    let Label { point: [x, y], size: [width, height], .. } = *label;
    DISTANCES.into_iter().flat_map(move |distance| {
        DIRECTIONS.into_iter().map(move |[dx, dy]| {
            // The nearest edge or corner of the text is at the distance.
            let side = |direction: f64| if direction == 0.0 { 0.0 } else { direction.signum() };
            let middle =
                [x + dx * distance + side(dx) * width / 2.0, y + dy * distance + side(dy) * height / 2.0];
            (Area::around(middle, width / 2.0, height / 2.0), distance)
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const BOUNDS: Area = Area([0.0, 0.0, 400.0, 300.0]);

    fn label(point: [f64; 2]) -> Label {
        Label { point, size: [80.0, 16.0], is_needed: true }
    }

    #[test]
    fn a_label_stands_beside_its_point_and_not_on_another() {
        let points = [[200.0, 150.0], [230.0, 140.0]];
        let obstacles = points.map(|point| Obstacle { area: Area::around(point, 5.0, 5.0), weight: 30.0 });
        let places = place(&points.map(label), &obstacles, &BOUNDS);
        for area in places.iter().flatten() {
            assert!(obstacles.iter().all(|obstacle| !obstacle.area.overlaps(area)));
        }
        assert_eq!(places.iter().flatten().count(), 2);
    }

    #[test]
    fn a_label_without_room_stands_nowhere() {
        let narrow = Area([0.0, 0.0, 60.0, 300.0]);
        assert_eq!(place(&[label([30.0, 30.0])], &[], &narrow), [None]);
        let everything = [Obstacle { area: BOUNDS, weight: 100.0 }];
        let unneeded = Label { is_needed: false, ..label([30.0, 30.0]) };
        assert_eq!(place(&[unneeded], &everything, &BOUNDS), [None]);
        assert!(place(&[label([30.0, 30.0])], &everything, &BOUNDS)[0].is_some());
    }

    proptest! {
        #[test]
        fn labels_never_overlap(points in prop::collection::vec((0.0..400.0, 0.0..300.0), 0..30)) {
            let labels: Vec<Label> = points.into_iter().map(|(x, y)| label([x, y])).collect();
            let places: Vec<Area> = place(&labels, &[], &BOUNDS).into_iter().flatten().collect();
            for (index, area) in places.iter().enumerate() {
                prop_assert!(BOUNDS.contains(area));
                prop_assert!(places[..index].iter().all(|other| !other.overlaps(area)));
            }
        }
    }
}
