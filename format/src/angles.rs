//! Angles between directions, for the tests of the normal codes.

/// The vector, one long.
pub(crate) fn unit(vector: [f32; 3]) -> [f64; 3] {
    let vector = vector.map(f64::from);
    let length = vector.iter().map(|v| v * v).sum::<f64>().sqrt();
    vector.map(|v| v / length)
}

/// Angle between unit vectors in radians, exact for small angles too.
pub(crate) fn angle(a: [f64; 3], b: [f64; 3]) -> f64 {
    let chord = (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt();
    2.0 * (chord / 2.0).min(1.0).asin()
}

/// Fails if one of `directions` is nearer to `vector` than `chosen` is.
pub(crate) fn assert_nearest(vector: [f32; 3], chosen: [f64; 3], directions: &[[f64; 3]]) {
    let vector_direction = unit(vector);
    let chosen = angle(vector_direction, chosen);
    let best = directions.iter().map(|&other| angle(vector_direction, other)).fold(f64::MAX, f64::min);
    assert!(chosen <= best + 1e-12, "{vector:?}: {chosen} rad, but {best} rad is possible");
}
