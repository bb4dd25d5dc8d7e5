//! Which settings are worth their time: the Pareto front of time and error.

use super::record::{Errors, Setting, Study};

/// Settings this close to the front count as being on it: measured times are no more certain than that.
pub const NEAR: f64 = 1.05;

/// What errors are measured against.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reference {
    /// The truth of the study.
    Truth,
    /// The exact setting of the knob.
    Exact,
}

impl Reference {
    /// The better one of those that the study has.
    pub fn of(study: &Study) -> Self {
        match study.settings.iter().any(|setting| setting.against_truth.is_some()) {
            true => Self::Truth,
            false => Self::Exact,
        }
    }

    /// The errors of a setting against it.
    pub fn errors(self, setting: &Setting) -> Option<&Errors> {
        match self {
            Self::Truth => setting.against_truth.as_ref(),
            Self::Exact => setting.against_exact.as_ref(),
        }
    }

    /// As it continues "error against".
    pub fn name(self) -> &'static str {
        match self {
            Self::Truth => "the truth",
            Self::Exact => "the exact setting",
        }
    }
}

/// A setting as a point of the plot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Index of the setting in the study.
    pub setting: usize,
    /// Median time of a picture.
    pub seconds: f64,
    /// Mean FLIP.
    pub error: f64,
}

impl Point {
    /// Whether it is at least as good as another in both respects, and better in one.
    fn dominates(&self, other: &Self) -> bool {
        self.seconds <= other.seconds
            && self.error <= other.error
            && (self.seconds < other.seconds || self.error < other.error)
    }
}

/// The settings that none other dominates, among all that are points of the plot.
#[derive(Debug, Clone, PartialEq)]
pub struct Front {
    /// What the errors are measured against.
    pub reference: Reference,
    /// All settings of knobs that are on the plot, in the order of the study, but for those without an error.
    pub points: Vec<Point>,
    /// The front: indices of settings in order of time. Of equal points all are on it.
    pub settings: Vec<usize>,
}

/// The front of a study.
pub fn front(study: &Study) -> Front {
    let reference = Reference::of(study);
    let is_on_plot =
        |setting: &Setting| study.knobs.iter().any(|knob| knob.is_on_front && knob.name == setting.knob);
    let points = study.settings.iter().enumerate().filter(|(_, setting)| is_on_plot(setting)).filter_map(
        |(index, setting)| {
            let error = reference.errors(setting)?.flip;
            Some(Point { setting: index, seconds: setting.cost.seconds.median, error })
        },
    );
    Front::of(reference, points.collect())
}

impl Front {
    /// The front of some points. What is no number, infinite or negative is left out.
    fn of(reference: Reference, mut points: Vec<Point>) -> Self {
        let is_measured = |value: f64| value.is_finite() && value >= 0.0;
        points.retain(|point| is_measured(point.seconds) && is_measured(point.error));
        let mut sorted: Vec<&Point> = points.iter().collect();
        sorted.sort_by(|a, b| a.seconds.total_cmp(&b.seconds).then(a.error.total_cmp(&b.error)));
        // Whatever dominates a point stands before it, and something on the front is among that.
        let mut settings = Vec::new();
        let mut last: Option<&Point> = None;
        for point in sorted {
            if last.is_none_or(|last| !last.dominates(point)) {
                settings.push(point.setting);
                last = Some(point);
            }
        }
        Self { reference, points, settings }
    }

    /// The point of a setting, if it has one.
    pub fn point(&self, setting: usize) -> Option<&Point> {
        self.points.iter().find(|point| point.setting == setting)
    }

    /// Whether a setting is one of the front.
    pub fn contains(&self, setting: usize) -> bool {
        self.settings.contains(&setting)
    }

    /// How far a setting is from the front, as a factor: by how much less time its error could be had, or
    /// by how much less error in its time, whichever is the smaller; so 1 on the front. `None` for a
    /// setting that is not on the plot.
    pub fn distance(&self, setting: usize) -> Option<f64> {
        let point = self.point(setting)?;
        let least = |values: &mut dyn Iterator<Item = f64>| values.fold(f64::INFINITY, f64::min);
        let as_exact = self.points.iter().filter(|other| other.error <= point.error);
        let as_fast = self.points.iter().filter(|other| other.seconds <= point.seconds);
        let time = factor(point.seconds, least(&mut as_exact.map(|other| other.seconds)));
        let error = factor(point.error, least(&mut as_fast.map(|other| other.error)));
        Some(time.min(error))
    }
}

/// How many times a least value fits into a value: 1 also where both are 0.
fn factor(value: f64, least: f64) -> f64 {
    if value <= least { 1.0 } else { value / least }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn of(points: &[(f64, f64)]) -> Front {
        let point = |(setting, &(seconds, error))| Point { setting, seconds, error };
        Front::of(Reference::Truth, points.iter().enumerate().map(point).collect())
    }

    #[test]
    fn a_point_is_on_the_front_unless_another_is_faster_and_closer() {
        let front = of(&[(4.0, 0.1), (1.0, 0.8), (2.0, 0.8), (2.0, 0.4), (8.0, 0.1), (3.0, 0.5)]);
        assert_eq!(front.settings, [1, 3, 0]);
        assert!(front.contains(3) && !front.contains(5));
        assert_eq!(front.distance(3), Some(1.0));
        // 0.5 in 3 s: 0.4 is had in 2 s, which is 1.5 times less, but only 1.25 times closer.
        assert_eq!(front.distance(5), Some(1.25));
        // As close as the one of 4 s in 8 s; nothing is closer.
        assert_eq!(front.distance(4), Some(1.0));
        assert_eq!(front.distance(6), None);
    }

    #[test]
    fn equal_points_are_on_the_front_together() {
        let front = of(&[(2.0, 0.5), (1.0, 0.9), (2.0, 0.5), (2.0, 0.6)]);
        assert_eq!(front.settings, [1, 0, 2]);
        assert_eq!(front.distance(2), Some(1.0));
    }

    #[test]
    fn nothing_is_divided_by_no_error_or_no_time() {
        let front = of(&[(2.0, 0.0), (4.0, 0.0), (3.0, 0.1), (0.0, 0.4), (0.0, 0.0)]);
        assert_eq!(front.settings, [4]);
        assert_eq!(front.distance(4), Some(1.0));
        assert_eq!(front.distance(0), Some(1.0));
        assert_eq!(front.distance(3), Some(1.0));
        assert_eq!(front.distance(2), Some(f64::INFINITY));
    }

    #[test]
    fn what_was_not_measured_is_no_point() {
        let front = of(&[(f64::NAN, 0.1), (1.0, f64::INFINITY), (2.0, 0.3), (-1.0, 0.0)]);
        assert_eq!(front.settings, [2]);
        assert_eq!(front.points.len(), 1);
        assert_eq!(front.distance(0), None);
        assert_eq!(of(&[]).settings, [0_usize; 0]);
    }

    proptest! {
        /// Coarse values, so that equal times and errors are common.
        #[test]
        fn the_front_is_that_of_comparing_all_with_all(
            values in prop::collection::vec((0_u8..8, 0_u8..8), 1..24)
        ) {
            let points: Vec<(f64, f64)> =
                values.iter().map(|&(time, error)| (f64::from(time), f64::from(error))).collect();
            let front = of(&points);
            for (index, &(time, error)) in points.iter().enumerate() {
                let is_beaten = points.iter().any(|&other| {
                    other != (time, error) && other.0 <= time && other.1 <= error
                });
                prop_assert_eq!(front.contains(index), !is_beaten);
                let distance = front.distance(index).unwrap();
                prop_assert!(distance >= 1.0 && (is_beaten || distance == 1.0));
                // The definition, over all pairs.
                let ratios = |of: &dyn Fn((f64, f64)) -> Option<f64>| {
                    points.iter().filter_map(|&other| of(other)).fold(1.0, f64::max)
                };
                let ratio = |a: f64, b: f64| if a == b { 1.0 } else { a / b };
                let faster = ratios(&|other| (other.1 <= error).then(|| ratio(time, other.0)));
                let closer = ratios(&|other| (other.0 <= time).then(|| ratio(error, other.1)));
                prop_assert_eq!(distance, f64::min(faster, closer));
            }
            prop_assert!(front.settings.windows(2).all(|pair| points[pair[0]].0 <= points[pair[1]].0));
        }
    }
}
