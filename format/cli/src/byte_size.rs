//! Amounts of bytes as people write them.

/// Bytes from a number with or without a unit: `1500000`, `800K`, `512M`, `2G`, `1.5GiB`. Units are powers of 1024.
///
/// # Errors
/// What is wrong with the text, for a person.
pub fn parse_byte_size(text: &str) -> Result<u64, String> {
    let expected = || format!("`{text}` is no amount of bytes; expected a number such as 800M or 2G");
    let lower = text.trim().to_ascii_lowercase();
    let number = lower.trim_end_matches(|letter: char| letter.is_ascii_alphabetic());
    let shift = match lower[number.len()..].trim_end_matches('b').trim_end_matches('i') {
        "" => 0,
        "k" => 10,
        "m" => 20,
        "g" => 30,
        "t" => 40,
        _ => return Err(expected()),
    };
    // Whole numbers are taken exactly.
    let bytes = match number.trim().parse::<u64>() {
        Ok(number) => number.checked_mul(1 << shift),
        Err(_) => number
            .trim()
            .parse::<f64>()
            .ok()
            .map(|number| number * f64::from(1_u32 << (shift / 2)) * f64::from(1_u32 << (shift / 2)))
            .filter(|bytes| (1.0..u64::MAX as f64).contains(bytes))
            .map(|bytes| bytes as u64),
    };
    bytes.filter(|bytes| *bytes > 0).ok_or_else(expected)
}

#[cfg(test)]
mod tests {
    use super::parse_byte_size;

    #[test]
    fn numbers_with_and_without_units() {
        for (text, bytes) in [
            ("1", 1),
            ("4096", 4096),
            ("2k", 2048),
            ("512M", 512 << 20),
            ("2G", 2 << 30),
            (" 2 GiB ", 2 << 30),
            ("3gb", 3 << 30),
            ("1.5M", 3 << 19),
            ("1T", 1 << 40),
        ] {
            assert_eq!(parse_byte_size(text), Ok(bytes), "{text}");
        }
    }

    #[test]
    fn nonsense_is_refused() {
        let beyond = format!("{}T", u64::MAX);
        for text in
            ["", "G", "0", "0G", "-1", "-2G", "2X", "2GG", "two", "nan", "infG", "1e99", "1 2G", &beyond]
        {
            let error = parse_byte_size(text).unwrap_err();
            assert!(error.contains("800M or 2G"), "{text}: {error}");
        }
    }
}
