//! The root mean square difference.

/// Root mean square difference of displayed red, green and blue, from 0 to 255, of the pixels that are not transparent in
/// both pictures; 0 if there are none.
///
/// Not a number if one picture has more pixels than the other.
#[must_use]
pub fn rmse(a: &[[u8; 4]], b: &[[u8; 4]]) -> f64 {
    if a.len() != b.len() {
        return f64::NAN;
    }
    let (mut squares, mut count) = (0u64, 0u64);
    for (a, b) in a.iter().zip(b).filter(|(a, b)| a[3] != 0 || b[3] != 0) {
        for channel in 0..3 {
            squares += u64::from(a[channel].abs_diff(b[channel])).pow(2);
        }
        count += 3;
    }
    (squares as f64 / count.max(1) as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_known_differences() {
        let (black, white) = ([0, 0, 0, 255], [255; 4]);
        assert_eq!(rmse(&[black; 9], &[black; 9]), 0.0);
        assert_eq!(rmse(&[black; 9], &[white; 9]), 255.0);
        assert_eq!(rmse(&[[10, 20, 30, 255]], &[[13, 24, 30, 255]]), (25.0f64 / 3.0).sqrt());
        // What is outside the region does not count, also not by its number of pixels.
        assert_eq!(rmse(&[black, [0; 4]], &[white, [0; 4]]), 255.0);
        assert_eq!(rmse(&[black, [0; 4]], &[black, [6, 6, 6, 255]]), 18f64.sqrt());
        assert_eq!(rmse(&[], &[]), 0.0);
        assert!(rmse(&[black], &[]).is_nan());
    }
}
