//! Numbers for people: three significant digits, a comma between thousands, a unit that fits.

use octvox_cli::grouped;

/// What stands where there is no number.
pub const NOTHING: &str = "–";

/// Digits of figures.
const SIGNIFICANT: i32 = 3;

/// With three significant digits: 0.0500, 12.3, 12,300, 1.20×10⁻⁷.
pub fn figure(value: f64) -> String {
    with_digits(value, SIGNIFICANT)
}

/// As a mark on an axis: with no more digits than it has.
pub fn tick(value: f64) -> String {
    let text = with_digits(value, 6);
    let (digits, power) = text.split_at(text.find('×').unwrap_or(text.len()));
    let digits = match digits.contains('.') {
        true => digits.trim_end_matches('0').trim_end_matches('.'),
        false => digits,
    };
    match (digits, power.strip_prefix('×')) {
        ("1", Some(power)) => power.to_string(),
        _ => format!("{digits}{power}"),
    }
}

fn with_digits(value: f64, significant: i32) -> String {
    if value.is_nan() {
        return NOTHING.to_string();
    }
    if value == 0.0 {
        return "0".to_string();
    }
    let sign = if value < 0.0 { "−" } else { "" };
    if value.is_infinite() {
        return format!("{sign}∞");
    }
    // Rounded first, because rounding may add a digit: 9.999 is 10.0.
    let rounded = format!("{:.*e}", (significant - 1) as usize, value.abs());
    let (mantissa, exponent) = rounded.split_once('e').unwrap_or((&rounded, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if !(-4..15).contains(&exponent) {
        return format!("{sign}{mantissa}×10{}", superscript(exponent));
    }
    let decimals = (significant - 1 - exponent).max(0) as usize;
    let plain = format!("{:.decimals$}", rounded.parse::<f64>().unwrap_or(value));
    let (whole, fraction) = plain.split_at(plain.find('.').unwrap_or(plain.len()));
    let whole = grouped(whole.parse::<u64>().unwrap_or(0));
    format!("{sign}{whole}{fraction}")
}

fn superscript(number: i32) -> String {
    let raised = |digit| match digit {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '0' => '⁰',
        // The others stand in a row of their own.
        _ => char::from_u32('⁰' as u32 + digit as u32 - '0' as u32).unwrap_or(digit),
    };
    number.to_string().chars().map(raised).collect()
}

/// A time with the unit that fits: 12.3 ms, 4.56 s.
pub fn duration(seconds: f64) -> String {
    with_time_unit(seconds, figure)
}

/// A time as a mark on an axis: 10 ms, 2 s.
pub fn duration_tick(seconds: f64) -> String {
    with_time_unit(seconds, tick)
}

fn with_time_unit(seconds: f64, format: impl Fn(f64) -> String) -> String {
    // Not quite the unit, because a second less its last bit is a second.
    let (factor, unit) = match seconds.abs() {
        0.0 => return "0".to_string(),
        seconds if seconds < 0.999_999e-3 => (1e6, "µs"),
        seconds if seconds < 0.999_999 => (1e3, "ms"),
        _ => (1.0, "s"),
    };
    format!("{} {unit}", format(seconds * factor))
}

/// Memory with the unit that fits: 12.3 MiB.
pub fn memory(bytes: u64) -> String {
    let bytes = bytes as f64;
    match bytes {
        _ if bytes < 1024.0 => format!("{bytes} bytes"),
        _ if bytes < 1024.0 * 1024.0 => format!("{} KiB", figure(bytes / 1024.0)),
        _ if bytes < 1024.0 * 1024.0 * 1024.0 => format!("{} MiB", figure(bytes / (1024.0 * 1024.0))),
        _ => format!("{} GiB", figure(bytes / (1024.0 * 1024.0 * 1024.0))),
    }
}

/// A unit for all figures of a column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Unit {
    pub name: &'static str,
    /// How many of what was measured make one.
    pub size: f64,
}

impl Unit {
    pub const MEBIBYTES: Self = Self { name: "MiB", size: 1024.0 * 1024.0 };

    /// The unit of times in seconds.
    pub fn of_times(seconds: impl IntoIterator<Item = f64>) -> Self {
        let least = seconds.into_iter().filter(|&time| time > 0.0).fold(f64::INFINITY, f64::min);
        match least.is_finite() && least >= 0.1 {
            true => Self { name: "s", size: 1.0 },
            false => Self { name: "ms", size: 1e-3 },
        }
    }

    /// The unit of counts, which leaves about four digits of the greatest.
    pub fn of_counts(counts: impl IntoIterator<Item = f64>) -> Self {
        match counts.into_iter().fold(0.0, f64::max) {
            most if most >= 1e10 => Self { name: "billions", size: 1e9 },
            most if most >= 1e7 => Self { name: "millions", size: 1e6 },
            most if most >= 1e4 => Self { name: "thousands", size: 1e3 },
            _ => Self { name: "", size: 1.0 },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_have_three_digits() {
        let of =
            [0.0, 1.0, 0.05, 12.345, 999.6, 12_345.0, -0.5, 1.2e-7, 3e20, 9.999, f64::NAN, f64::INFINITY];
        let texts =
            ["0", "1.00", "0.0500", "12.3", "1,000", "12,300", "−0.500", "1.20×10⁻⁷", "3.00×10²⁰", "10.0"];
        assert_eq!(of.map(figure)[..10], texts);
        assert_eq!([figure(of[10]), figure(of[11])], ["–", "∞"]);
    }

    #[test]
    fn marks_have_no_needless_digits() {
        let of = [0.1, 0.25, 1.0, 50.0, 1000.0, 1e-5, 2e-5, 1.5e-9];
        assert_eq!(of.map(tick), ["0.1", "0.25", "1", "50", "1,000", "10⁻⁵", "2×10⁻⁵", "1.5×10⁻⁹"]);
    }

    #[test]
    fn units_fit() {
        assert_eq!(duration(0.012_34), "12.3 ms");
        assert_eq!(duration(4.0), "4.00 s");
        assert_eq!(duration(1234.0), "1,230 s");
        assert_eq!(duration_tick(1e-3), "1 ms");
        assert_eq!(duration_tick(0.000_2), "200 µs");
        assert_eq!(memory(512), "512 bytes");
        assert_eq!(memory(50_331_648), "48.0 MiB");
        assert_eq!(Unit::of_times([0.5, 20.0]).name, "s");
        assert_eq!(Unit::of_times([0.0, 0.01, 20.0]).name, "ms");
        assert_eq!(Unit::of_times([]).name, "ms");
        assert_eq!(Unit::of_counts([3.0, 2e7]).name, "millions");
    }
}
