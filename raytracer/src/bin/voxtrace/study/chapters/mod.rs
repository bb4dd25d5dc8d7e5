//! What a study tells besides its knobs: tables under headings.

mod differences;
mod hard_rays;
mod normal_codes;
mod thesis;

pub use differences::differences;
pub use hard_rays::hard_rays;
pub use normal_codes::normal_codes;
pub use thesis::thesis;

/// A share as a number of parts in a million.
fn parts_per_million(count: u64, of: u64) -> String {
    format!("{:.2}", count as f64 / of.max(1) as f64 * 1e6)
}

/// A time per piece in nanoseconds.
fn nanoseconds(seconds: f64, pieces: usize) -> String {
    format!("{:.1}", seconds / pieces.max(1) as f64 * 1e9)
}
