//! The text of an OBJ file, made into what the parser reads as the format means it.
//!
//! The parser (`tobj`) works line by line and knows no line numbers. It takes polylines for faces, fails at comments
//! behind a statement and at tabs behind `usemtl`, does not join continued lines, mixes up colours if only some vertices
//! have one, and normals if only some faces have them. So it gets the statements it needs, one on a line, checked.

use crate::ConvertError;
use crate::group_materials::GroupMaterials;
use std::collections::BTreeSet;
use std::io::{BufRead, Read};
use std::path::Path;

/// Name of the groups whose faces have a normal at each corner.
pub(crate) const WITH_NORMALS: &str = "with-normals";
/// Name of the groups whose faces have none.
const WITHOUT_NORMALS: &str = "without-normals";

/// Bytes handed to the parser at once.
const CHUNK: usize = 1 << 16;

/// A reader over the statements of an OBJ file.
///
/// When a statement is wrong, reading fails and [`ObjText::into_error`] tells why.
pub(crate) struct ObjText<'a> {
    path: &'a Path,
    bytes: &'a [u8],
    /// Where the next line begins, and its number from 1.
    next: usize,
    line: usize,
    /// Statements on their way to the parser, and how much of them it has taken.
    chunk: Vec<u8>,
    taken: usize,
    counts: Counts,
    colors: VertexColors,
    colored_vertices: usize,
    normals_at_corners: Option<bool>,
    used_materials: BTreeSet<String>,
    group_materials: GroupMaterials,
    lines_and_points: usize,
    error: Option<ConvertError>,
}

/// What to do about vertices without a colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum VertexColors {
    /// Take the vertices as they are.
    AsWritten,
    /// Give white to those that have none, since others have one.
    Completed,
}

/// How many of each have been read.
#[derive(Debug, Clone, Copy, Default)]
struct Counts {
    vertices: usize,
    texture_coordinates: usize,
    normals: usize,
}

impl<'a> ObjText<'a> {
    pub(crate) fn new(path: &'a Path, bytes: &'a [u8], colors: VertexColors) -> Self {
        Self {
            path,
            bytes,
            next: 0,
            line: 0,
            chunk: Vec::with_capacity(CHUNK + 256),
            taken: 0,
            counts: Counts::default(),
            colors,
            colored_vertices: 0,
            normals_at_corners: None,
            used_materials: BTreeSet::new(),
            group_materials: GroupMaterials::find(bytes),
            lines_and_points: 0,
            error: None,
        }
    }

    /// Whether some vertices have a colour and others have not, so that the text must be read as
    /// [`VertexColors::Completed`].
    pub(crate) fn has_mixed_colors(&self) -> bool {
        self.colored_vertices != 0 && self.colored_vertices != self.counts.vertices
    }

    /// Names of the materials that faces use.
    pub(crate) fn used_materials(&self) -> &BTreeSet<String> {
        &self.used_materials
    }

    /// Number of `l` and `p` statements, which have no surface.
    pub(crate) fn lines_and_points(&self) -> usize {
        self.lines_and_points
    }

    /// Why reading failed, if it was for the text.
    pub(crate) fn into_error(self) -> Option<ConvertError> {
        self.error
    }

    /// The next line without its end.
    fn next_line(&mut self) -> Option<&'a [u8]> {
        let line = self.bytes.get(self.next..).filter(|rest| !rest.is_empty())?;
        // The fastest search for a byte that the standard library offers; a slice cannot fail to be read.
        let length = { line }.skip_until(b'\n').unwrap_or(line.len());
        self.next += length;
        self.line += 1;
        Some(line[..length].strip_suffix(b"\n").unwrap_or(line))
    }

    /// Fills the chunk with statements.
    fn refill(&mut self) -> Result<(), ConvertError> {
        self.chunk.clear();
        self.taken = 0;
        while self.chunk.len() < CHUNK {
            let Some(line) = self.next_line() else { break };
            if without_end(line).last() == Some(&b'\\') {
                let first = self.line;
                let joined = self.join_continued(line);
                self.statement(&joined, first)?;
            } else {
                self.statement(line, self.line)?;
            }
        }
        Ok(())
    }

    /// The line and those that continue it.
    fn join_continued(&mut self, first: &[u8]) -> Vec<u8> {
        let mut joined = Vec::new();
        let mut line = first;
        loop {
            match without_end(line) {
                [start @ .., b'\\'] => joined.extend_from_slice(start),
                _ => {
                    joined.extend_from_slice(line);
                    return joined;
                }
            }
            joined.push(b' ');
            match self.next_line() {
                Some(next) => line = next,
                None => return joined,
            }
        }
    }

    /// Passes a statement on if the parser needs it.
    fn statement(&mut self, line: &[u8], number: usize) -> Result<(), ConvertError> {
        let line = line.trim_ascii_start();
        let keyword_length = line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len());
        let (keyword, rest) = line.split_at(keyword_length);
        match keyword {
            b"v" => self.vertex(rest, number),
            b"vn" => self.normal(rest, number),
            b"vt" => {
                self.counts.texture_coordinates += 1;
                Ok(())
            }
            b"f" => self.face(rest, number),
            b"usemtl" => {
                let name = String::from_utf8_lossy(rest).trim().to_owned();
                if name.is_empty() {
                    return self.malformed(number, "`usemtl` without the name of a material".to_owned());
                }
                self.use_material(name);
                Ok(())
            }
            b"g" => {
                let material =
                    self.group_materials.of(rest).map(|name| String::from_utf8_lossy(name).into_owned());
                material.into_iter().for_each(|name| self.use_material(name));
                Ok(())
            }
            b"mtllib" => {
                let name = String::from_utf8_lossy(rest);
                self.pass(&[b"mtllib ", name.trim().as_bytes()]);
                Ok(())
            }
            b"l" | b"p" => {
                self.lines_and_points += 1;
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn use_material(&mut self, name: String) {
        self.pass(&[b"usemtl ", name.as_bytes()]);
        self.used_materials.insert(name);
    }

    fn vertex(&mut self, rest: &[u8], number: usize) -> Result<(), ConvertError> {
        let (mut rest, count) = numbers(rest);
        let colored = match count {
            // Coordinates; coordinates and weight.
            3 | 4 => false,
            6 => true,
            // Some programs write opacity behind the colour.
            7 => {
                let opacity = words(rest).last().map_or(0, <[u8]>::len);
                rest = &rest[..rest.len() - opacity];
                true
            }
            count => {
                return self.malformed(
                    number,
                    format!("a vertex has {count} numbers; expected 3 coordinates, a weight or a colour of 3 after them"),
                );
            }
        };
        if colored {
            // The parser would silently leave out what is no number, and shift the colours of all vertices after it.
            let is_number = |word: &[u8]| str::from_utf8(word).is_ok_and(|word| word.parse::<f64>().is_ok());
            if let Some(word) = words(rest).skip(3).find(|word| !is_number(word)) {
                return self.malformed(number, format!("`{}` is no number", String::from_utf8_lossy(word)));
            }
        }
        self.counts.vertices += 1;
        self.colored_vertices += usize::from(colored);
        if colored || self.colors == VertexColors::AsWritten {
            self.pass(&[b"v ", rest]);
        } else {
            // A weight can't stand beside a colour; weights other than 1 belong to curves.
            let coordinates = words(rest).take(3).collect::<Vec<_>>().join(&b' ');
            self.pass(&[b"v ", &coordinates, b" 1 1 1"]);
        }
        Ok(())
    }

    fn normal(&mut self, rest: &[u8], number: usize) -> Result<(), ConvertError> {
        let (rest, count) = numbers(rest);
        if count < 3 {
            return self.malformed(number, format!("a normal has {count} numbers; expected 3"));
        }
        self.counts.normals += 1;
        self.pass(&[b"vn ", rest]);
        Ok(())
    }

    fn face(&mut self, rest: &[u8], number: usize) -> Result<(), ConvertError> {
        let mut corners = 0;
        let mut with_normal = 0;
        let mut end = 0;
        while let Some(start) = next_word(rest, end) {
            let has_normal;
            (has_normal, end) = self.corner(rest, start, number)?;
            with_normal += usize::from(has_normal);
            corners += 1;
        }
        if corners < 3 {
            return self.malformed(number, format!("a face has {corners} corners; expected at least 3"));
        }
        let has_normals = with_normal == corners;
        if self.normals_at_corners != Some(has_normals) {
            self.normals_at_corners = Some(has_normals);
            let name = if has_normals { WITH_NORMALS } else { WITHOUT_NORMALS };
            self.pass(&[b"g ", name.as_bytes()]);
        }
        self.pass(&[b"f ", &rest[..end]]);
        Ok(())
    }

    /// Checks the corner of a face (`v`, `v/vt`, `v//vn` or `v/vt/vn`) that begins at `start`. Tells whether it has a
    /// normal, and where it ends.
    fn corner(&self, face: &[u8], start: usize, line: usize) -> Result<(bool, usize), ConvertError> {
        let counts = [
            ("vertex", self.counts.vertices),
            ("texture coordinate", self.counts.texture_coordinates),
            ("normal", self.counts.normals),
        ];
        let mut end = start;
        let mut has_normal = false;
        for (place, (kind, count)) in counts.into_iter().enumerate() {
            let field = end;
            let index = read_index(face, &mut end);
            let is_missing = end == field && place > 0;
            if index.is_none() && !is_missing {
                break;
            }
            if let Some(index) = index {
                if index == 0 || index.unsigned_abs() > count as u64 {
                    return Err(ConvertError::FaceIndex {
                        path: self.path.to_owned(),
                        line,
                        kind,
                        index,
                        count,
                    });
                }
                has_normal = place == 2;
            }
            match face.get(end) {
                Some(b'/') => end += 1,
                None => return Ok((has_normal, end)),
                Some(byte) if byte.is_ascii_whitespace() || *byte == b'#' => return Ok((has_normal, end)),
                Some(_) => break,
            }
        }
        let corner = words(&face[start..]).next().unwrap_or_default();
        let corner = String::from_utf8_lossy(corner);
        self.malformed(line, format!("`{corner}` is no corner of a face; expected v, v/vt, v//vn or v/vt/vn"))
    }

    /// Appends a line for the parser.
    fn pass(&mut self, parts: &[&[u8]]) {
        for part in parts {
            self.chunk.extend_from_slice(part);
        }
        self.chunk.push(b'\n');
    }

    fn malformed<T>(&self, line: usize, problem: String) -> Result<T, ConvertError> {
        Err(ConvertError::Statement { path: self.path.to_owned(), line, problem })
    }
}

impl BufRead for ObjText<'_> {
    fn fill_buf(&mut self) -> std::io::Result<&[u8]> {
        if self.taken == self.chunk.len() {
            if self.error.is_some() {
                return Err(std::io::ErrorKind::InvalidData.into());
            }
            if let Err(error) = self.refill() {
                self.error = Some(error);
                return Err(std::io::ErrorKind::InvalidData.into());
            }
        }
        Ok(&self.chunk[self.taken..])
    }

    fn consume(&mut self, amount: usize) {
        self.taken = (self.taken + amount).min(self.chunk.len());
    }
}

impl Read for ObjText<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let count = self.fill_buf()?.read(buffer)?;
        self.consume(count);
        Ok(count)
    }
}

/// The first `v` or `vn` statement with a number that is none, or is infinite: its line, counted from 1, and what is
/// wrong with it.
pub(crate) fn first_bad_number(bytes: &[u8]) -> Option<(usize, String)> {
    bytes.split(|&byte| byte == b'\n').enumerate().find_map(|(index, line)| {
        let keyword = words(line).next()?;
        if keyword != b"v" && keyword != b"vn" {
            return None;
        }
        words(numbers(line).0).skip(1).find_map(|word| {
            let word = String::from_utf8_lossy(word);
            let problem = match word.parse::<f64>() {
                Ok(number) if number.is_finite() => return None,
                Ok(_) => format!("`{word}` is no coordinate; expected a finite number"),
                Err(_) => format!("`{word}` is no number"),
            };
            Some((index + 1, problem))
        })
    })
}

fn words(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    text.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// A statement's numbers without the comment behind them, and how many there are.
fn numbers(text: &[u8]) -> (&[u8], usize) {
    // One pass, written out: it runs over most bytes of the file.
    let (mut count, mut in_word, mut end) = (0, false, 0);
    for (index, &byte) in text.iter().enumerate() {
        if byte == b'#' {
            break;
        }
        let is_blank = byte.is_ascii_whitespace();
        count += usize::from(!is_blank && !in_word);
        in_word = !is_blank;
        if in_word {
            end = index + 1;
        }
    }
    (&text[..end], count)
}

/// Where the next word begins, from `at` on; `None` at the end or at a comment.
fn next_word(text: &[u8], at: usize) -> Option<usize> {
    let blanks = text[at..].iter().position(|byte| !byte.is_ascii_whitespace())?;
    (text[at + blanks] != b'#').then_some(at + blanks)
}

/// A line without the carriage return that CRLF leaves.
fn without_end(line: &[u8]) -> &[u8] {
    line.strip_suffix(b"\r").unwrap_or(line)
}

/// Reads an index, digits with or without a sign, at `at`, and goes behind it; `None` if there is none that fits.
fn read_index(text: &[u8], at: &mut usize) -> Option<i64> {
    let start = *at;
    let sign = match text.get(start) {
        Some(b'-') => -1,
        Some(b'+') => 1,
        _ => 0,
    };
    *at += usize::from(sign != 0);
    let mut digits = 0;
    // Negative, since the smallest number has no positive counterpart.
    let mut index = Some(0i64);
    while let Some(digit) = text.get(*at).filter(|byte| byte.is_ascii_digit()) {
        index = index.and_then(|index| index.checked_mul(10)?.checked_sub(i64::from(digit - b'0')));
        *at += 1;
        digits += 1;
    }
    index.filter(|_| digits > 0).and_then(|index| if sign < 0 { Some(index) } else { index.checked_neg() })
}
