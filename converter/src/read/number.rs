//! Decimal numbers in text.

/// Reads a number as `str::parse` does, to the last bit, but several times as fast if it is short.
///
/// Integers up to 2^53 and powers of ten up to 10^22 are exact in double precision, so that their product or quotient is
/// rounded only once, as it should be (Clinger 1990).
pub(super) fn parse_number(word: &[u8]) -> Option<f64> {
    short_decimal(word).or_else(|| str::from_utf8(word).ok()?.parse().ok())
}

const POWERS_OF_TEN: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18,
    1e19, 1e20, 1e21, 1e22,
];

/// As many digits always fit into 64 bits.
const MAX_DIGITS: usize = 19;

/// The number, if it is one that this way is exact for.
fn short_decimal(word: &[u8]) -> Option<f64> {
    let (is_negative, rest) = sign(word);
    let (whole, rest) = digits(0, rest);
    let (decimal, places, rest) = match rest {
        [b'.', rest @ ..] => {
            let (decimal, after) = digits(whole.0, rest);
            ((decimal.0, whole.1 + decimal.1), decimal.1, after)
        }
        _ => (whole, 0, rest),
    };
    let (decimal, count) = decimal;
    if count == 0 || count > MAX_DIGITS || decimal > 1 << 53 {
        return None;
    }
    let power = exponent(rest)? - places as i64;
    let factor = *POWERS_OF_TEN.get(usize::try_from(power.unsigned_abs()).ok()?)?;
    let number = if power < 0 { decimal as f64 / factor } else { decimal as f64 * factor };
    Some(if is_negative { -number } else { number })
}

/// Whether there is a minus, and what follows the sign.
fn sign(text: &[u8]) -> (bool, &[u8]) {
    match text {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        _ => (false, text),
    }
}

/// Appends digits to a number: the number (wrapped if there are too many) and how many digits there are, and what follows.
fn digits(mut number: u64, text: &[u8]) -> ((u64, usize), &[u8]) {
    let mut count = 0;
    while let Some(byte) = text.get(count).filter(|byte| byte.is_ascii_digit()) {
        number = number.wrapping_mul(10).wrapping_add(u64::from(byte - b'0'));
        count += 1;
    }
    ((number, count), &text[count..])
}

/// The exponent at the end of a number, 0 if there is none.
fn exponent(text: &[u8]) -> Option<i64> {
    let [b'e' | b'E', rest @ ..] = text else { return text.is_empty().then_some(0) };
    let (is_negative, rest) = sign(rest);
    let ((exponent, count), rest) = digits(0, rest);
    let exponent = i64::try_from(exponent).ok()?;
    // Four digits are more than any double needs.
    (rest.is_empty() && (1..=4).contains(&count)).then_some(if is_negative { -exponent } else { exponent })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn check(word: &str) {
        let expected: Option<f64> = word.parse().ok();
        assert_eq!(parse_number(word.as_bytes()).map(f64::to_bits), expected.map(f64::to_bits), "{word:?}");
    }

    #[test]
    fn special_words() {
        for word in [
            "",
            "-",
            "+",
            ".",
            "e",
            "1e",
            "1e+",
            "-.e1",
            "0",
            "-0",
            "+0.0",
            "1.",
            ".5",
            "-.5e-1",
            "1e5",
            "1E-5",
            "1..2",
            "1.2.3",
            "--1",
            "1e5.0",
            "nan",
            "-inf",
            "infinity",
            "1_0",
            "0x10",
            "1e22",
            "1e23",
            "9007199254740993",
            "9007199254740993e-1",
            "18446744073709551616",
            "99999999999999999999",
            "0.00000000000000000000000000001",
            "123456789012345678901234567890e-10",
            "1e99999999999999999999",
            "4.9e-324",
            "1e-9999",
            "\u{661}",
        ] {
            check(word);
        }
        assert_eq!(parse_number(b"\xff"), None);
    }

    proptest! {
        #[test]
        fn any_number_is_what_the_standard_library_says(
            text in "[+-]?[0-9]{0,20}(\\.[0-9]{0,20})?([eE][+-]?[0-9]{0,3})?",
            short in "-?[0-9]{1,3}\\.[0-9]{1,9}",
            number in any::<f64>(),
        ) {
            check(&text);
            check(&short);
            check(&number.to_string());
            check(&format!("{number:e}"));
        }
    }
}
