//! The text of an OBJ file as statements, in chunks that can be read independently.

use std::borrow::Cow;
use std::io::BufRead;

/// Cuts a text into chunks of whole statements, each about `size` bytes long.
pub(super) fn chunks(text: &[u8], size: usize) -> Vec<&[u8]> {
    let mut chunks = Vec::new();
    let mut rest = text;
    while !rest.is_empty() {
        let mut end = size.min(rest.len());
        loop {
            end += line_length(&rest[end..]);
            if end == rest.len() || !is_continued(&rest[..end]) {
                break;
            }
        }
        let (chunk, after) = rest.split_at(end);
        chunks.push(chunk);
        rest = after;
    }
    chunks
}

/// A statement, with the lines that continue it.
pub(super) struct Statement<'a> {
    /// Number of its first line, counted from 0.
    pub line: usize,
    text: Cow<'a, [u8]>,
}

impl Statement<'_> {
    /// The first word, and what follows it.
    pub(super) fn split(&self) -> (&[u8], &[u8]) {
        let text = self.text.trim_ascii_start();
        text.split_at(text.iter().position(u8::is_ascii_whitespace).unwrap_or(text.len()))
    }
}

/// The statements of a text.
pub(super) struct Statements<'a> {
    rest: &'a [u8],
    line: usize,
}

impl<'a> Statements<'a> {
    /// `line` is the number of the text's first line.
    pub(super) fn new(text: &'a [u8], line: usize) -> Self {
        Self { rest: text, line }
    }

    /// The number of the next line.
    pub(super) fn line(&self) -> usize {
        self.line
    }

    fn next_line(&mut self) -> Option<&'a [u8]> {
        let (line, rest) = self.rest.split_at(line_length(self.rest));
        self.rest = rest;
        self.line += 1;
        (!line.is_empty()).then_some(line)
    }

    /// A line and those that continue it.
    #[cold]
    fn join_continued(&mut self, first: &[u8]) -> Vec<u8> {
        let mut joined = Vec::new();
        let mut line = first;
        while is_continued(line) {
            let end = without_end(line);
            joined.extend_from_slice(&end[..end.len() - 1]);
            joined.push(b' ');
            match self.next_line() {
                Some(next) => line = next,
                None => return joined,
            }
        }
        joined.extend_from_slice(line);
        joined
    }
}

impl<'a> Iterator for Statements<'a> {
    type Item = Statement<'a>;

    #[inline]
    fn next(&mut self) -> Option<Statement<'a>> {
        if self.rest.is_empty() {
            return None;
        }
        let number = self.line;
        let line = self.next_line()?;
        let text = if is_continued(line) { self.join_continued(line).into() } else { line.into() };
        Some(Statement { line: number, text })
    }
}

/// Words separated by blanks.
pub(super) fn words(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    text.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// What stands before a comment.
pub(super) fn without_comment(text: &[u8]) -> &[u8] {
    text.split(|&byte| byte == b'#').next().unwrap_or_default()
}

/// Length of the first line, with its end.
fn line_length(text: &[u8]) -> usize {
    // The fastest search for a byte that the standard library offers; a slice cannot fail to be read.
    { text }.skip_until(b'\n').unwrap_or(text.len())
}

/// A line without its end, of either kind.
fn without_end(line: &[u8]) -> &[u8] {
    let line = line.strip_suffix(b"\n").unwrap_or(line);
    line.strip_suffix(b"\r").unwrap_or(line)
}

/// Whether the next line belongs to the statement that this text ends with.
fn is_continued(text: &[u8]) -> bool {
    without_end(text).last() == Some(&b'\\')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statements_do_not_depend_on_the_cut_into_chunks() {
        let text = b"v 1 2\\\r\n 3\n\n  f 1 \\\n\\\n2 # end\r\nlast \\";
        let expected = [(0, "v", " 1 2  3\n"), (2, "", ""), (3, "f", " 1   2 # end\r\n"), (6, "last", "  ")];
        for size in 1..=text.len() {
            let mut line = 0;
            let mut found = Vec::new();
            for chunk in chunks(text, size) {
                let mut statements = Statements::new(chunk, line);
                for statement in statements.by_ref() {
                    let (keyword, rest) = statement.split();
                    found.push((
                        statement.line,
                        String::from_utf8_lossy(keyword).into_owned(),
                        String::from_utf8_lossy(rest).into_owned(),
                    ));
                }
                line = statements.line();
            }
            assert_eq!(chunks(text, size).concat(), text);
            let found: Vec<_> =
                found.iter().map(|(line, keyword, rest)| (*line, keyword.as_str(), rest.as_str())).collect();
            assert_eq!(found, expected, "{size}");
        }
        assert!(chunks(b"", 10).is_empty());
    }
}
