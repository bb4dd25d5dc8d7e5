//! Plain text in the page.

/// Text as it stands in the page, between tags as well as in quotation marks.
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            '\t' | '\n' => escaped.push(character),
            // Control characters have no place in a page, not even escaped.
            _ if character.is_control() => escaped.push('\u{fffd}'),
            _ => escaped.push(character),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::escape;

    #[test]
    fn what_has_a_meaning_in_a_page_is_escaped() {
        assert_eq!(escape("a < b & \"c\" > 'd' ü ³"), "a &lt; b &amp; &quot;c&quot; &gt; &#39;d&#39; ü ³");
        assert_eq!(escape("a\u{1b}[1m\u{0}"), "a\u{fffd}[1m\u{fffd}");
    }
}
