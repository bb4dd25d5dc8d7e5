//! Numbers for people.

/// The number with a comma between groups of three digits: 131,827,905.
#[must_use]
pub fn grouped(number: impl Into<u128>) -> String {
    let digits = number.into().to_string();
    let mut text = String::with_capacity(digits.len() + digits.len() / 3);
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::grouped;

    #[test]
    fn groups_have_three_digits() {
        let texts = [0_u32, 12, 123, 1234, 123_456, 131_827_905].map(grouped);
        assert_eq!(texts, ["0", "12", "123", "1,234", "123,456", "131,827,905"]);
        assert_eq!(grouped(u64::MAX), "18,446,744,073,709,551,615");
    }
}
