//! How far away, and turned how, what is seen is from what should be seen.

use crate::frame::FirstHit;
use glam::Vec3;

/// Differences of what two pictures see, pixel by pixel.
///
/// Where one of them sees past an edge, its depth is off by as much as the scene is deep, and a mean of squares would tell
/// of nothing else. So pixels at which both see something are parted by their difference of depth: up to four times the
/// median of those that differ, it is an error of place, and a root mean square is taken. What is beyond is counted. If
/// differences were normally distributed, that would be 0.7 % of them; since a difference along the ray grows where a
/// surface is seen aslant, it also takes a few percent of what is seen most aslant. Depths that differ by what single
/// precision rounds do not count for the median: of a ground that both pictures see alike there may be more than of anything
/// else. The rule knows no unit and no resolution, so errors of different resolutions are parted alike.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GeometryErrors {
    /// Root mean square difference of depth, in the scene, of the pixels that see the same; 0 if there are none.
    pub depth: f64,
    /// The same, each difference over the size of a pixel at that distance.
    pub depth_in_pixels: f64,
    /// Of the pixels where both see something, the share where depths differ by more than that: silhouettes.
    pub silhouette_share: f64,
    /// Mean angle between the normals where both see something, in degrees; 0 if that is nowhere.
    pub normal_degrees: f64,
    /// Of all pixels, the share where one sees something and the other does not.
    pub coverage_share: f64,
    /// Pixels where both see something.
    pub both: u64,
}

/// The largest difference of depth between what is the same, over the median.
const OUTLIER: f64 = 4.0;

/// The largest difference of depth, over the depth, that may be rounding.
const ROUNDING: f32 = 16.0 * f32::EPSILON;

/// How far two pictures of first hits are apart. `pixel_at_one` is the size of a pixel at distance one
/// ([`Camera::pixel_at_one`](crate::Camera::pixel_at_one)).
///
/// `None` if they have different numbers of pixels.
#[must_use]
pub fn depth_and_normal_errors(a: &[FirstHit], b: &[FirstHit], pixel_at_one: f64) -> Option<GeometryErrors> {
    if a.len() != b.len() {
        return None;
    }
    let sees = |hit: &FirstHit| hit.distance.is_finite();
    let both: Vec<(&FirstHit, &FirstHit)> = a.iter().zip(b).filter(|(a, b)| sees(a) && sees(b)).collect();
    let one = a.iter().zip(b).filter(|(a, b)| sees(a) != sees(b)).count();

    let apart = |(a, b): &(&FirstHit, &FirstHit)| f64::from(a.distance) - f64::from(b.distance);
    let rounding = |(a, _): &(&FirstHit, &FirstHit)| f64::from(ROUNDING * a.distance);
    let sizes = both.iter().map(|pair| (apart(pair).abs(), rounding(pair)));
    let mut sizes: Vec<f64> =
        sizes.filter(|(size, rounding)| size > rounding).map(|(size, _)| size).collect();
    let middle = sizes.len() / 2;
    let limit = if sizes.is_empty() {
        0.0
    } else {
        OUTLIER * *sizes.select_nth_unstable_by(middle, f64::total_cmp).1
    };
    let (mut squares, mut squares_in_pixels, mut same) = (0.0, 0.0, 0u64);
    let mut degrees = 0.0;
    for pair in &both {
        degrees += angle(pair.0.normal, pair.1.normal);
        let apart = apart(pair);
        if apart.abs() <= limit.max(rounding(pair)) {
            let distance = f64::from(pair.0.distance) + f64::from(pair.1.distance);
            let in_pixels = apart / (pixel_at_one * distance / 2.0).max(f64::MIN_POSITIVE);
            squares += apart * apart;
            squares_in_pixels += in_pixels * in_pixels;
            same += 1;
        }
    }
    let over = |sum: f64, count: u64| sum / count.max(1) as f64;
    let count = both.len() as u64;
    Some(GeometryErrors {
        depth: over(squares, same).sqrt(),
        depth_in_pixels: over(squares_in_pixels, same).sqrt(),
        silhouette_share: over((count - same) as f64, count),
        normal_degrees: over(degrees, count),
        coverage_share: over(one as f64, a.len() as u64),
        both: count,
    })
}

/// The angle between two vectors in degrees, precise for small ones, too.
fn angle(a: [f32; 3], b: [f32; 3]) -> f64 {
    let [a, b] = [a, b].map(|normal| Vec3::from_array(normal).as_dvec3());
    a.cross(b).length().atan2(a.dot(b)).to_degrees()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(distance: f32, normal: [f32; 3]) -> FirstHit {
        FirstHit { distance, normal, steps: 0, level: 0 }
    }

    #[test]
    fn what_is_the_same_is_parted_from_silhouettes() {
        let up = [0.0, 1.0, 0.0];
        // Ninety pixels off by 0.01 or 0.03, ten that see past an edge, twenty that only one sees, eighty that none does.
        let a: Vec<_> = (0..200).map(|k| if k < 120 { at(2.0, up) } else { FirstHit::NONE }).collect();
        let b: Vec<_> = (0..200)
            .map(|k| match k {
                0..60 => at(2.0 + 1.0 / 128.0, up),
                60..90 => at(2.0 - 3.0 / 128.0, [0.5, 0.75f32.sqrt(), 0.0]),
                90..100 => at(7.0, [0.0, -1.0, 0.0]),
                _ => FirstHit::NONE,
            })
            .collect();
        let errors = depth_and_normal_errors(&a, &b, 0.001).unwrap();
        let depth = (60.0f64 * 1.0 + 30.0 * 9.0).sqrt() / 90f64.sqrt() / 128.0;
        assert!((errors.depth - depth).abs() < 1e-9, "{errors:?}");
        assert!((errors.depth_in_pixels / (depth / 0.002) - 1.0).abs() < 0.01, "{errors:?}");
        assert!((errors.normal_degrees - (30.0 * 30.0 + 10.0 * 180.0) / 100.0).abs() < 1e-4, "{errors:?}");
        assert_eq!((errors.silhouette_share, errors.coverage_share, errors.both), (0.1, 0.1, 100));
        assert_eq!(depth_and_normal_errors(&a, &b[1..], 0.001), None);
    }

    /// A ground that takes most of the picture, and a model before it.
    #[test]
    fn rounding_is_no_difference() {
        let ground = |k: usize| 5.0 + k as f32 / 64.0;
        let a: Vec<_> = (0..100).map(|k| at(if k < 80 { ground(k) } else { 2.0 }, [0.0; 3])).collect();
        let b: Vec<_> =
            (0..100).map(|k| at(if k < 80 { ground(k).next_up() } else { 2.25 }, [0.0; 3])).collect();
        let errors = depth_and_normal_errors(&a, &b, 0.1).unwrap();
        assert_eq!(errors.silhouette_share, 0.0);
        assert!((errors.depth - 0.25 * 0.2f64.sqrt()).abs() < 1e-6, "{errors:?}");
    }

    #[test]
    fn few_differences_are_not_all_silhouettes() {
        let a = vec![at(1.0, [1.0, 0.0, 0.0]); 100];
        let mut b = a.clone();
        assert_eq!(depth_and_normal_errors(&a, &b, 0.1).unwrap().depth, 0.0);
        b[3].distance = 1.5;
        let errors = depth_and_normal_errors(&a, &b, 0.1).unwrap();
        assert_eq!((errors.depth, errors.silhouette_share), (0.05, 0.0));
        let nothing = depth_and_normal_errors(&[], &[], 0.1).unwrap();
        assert_eq!((nothing.depth, nothing.normal_degrees, nothing.coverage_share), (0.0, 0.0, 0.0));
    }
}
