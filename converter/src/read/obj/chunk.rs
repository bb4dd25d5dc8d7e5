//! The statements of a chunk of an OBJ file as lists of numbers.

use super::group_materials::GroupMaterials;
use super::statements::{Statements, without_comment, words};
use crate::ConvertError;
use crate::read::number::parse_number;
use std::path::Path;

/// Marks a corner without texture coordinate or normal.
pub(super) const NONE: u32 = u32::MAX;

/// How many of each there are in a part of the text.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Counts {
    pub lines: usize,
    pub vertices: usize,
    pub texture_coordinates: usize,
    pub normals: usize,
}

impl Counts {
    /// What a chunk holds.
    pub(super) fn of(text: &[u8]) -> Self {
        let mut counts = Self::default();
        let mut statements = Statements::new(text, 0);
        for statement in statements.by_ref() {
            match statement.split().0 {
                b"v" => counts.vertices += 1,
                b"vt" => counts.texture_coordinates += 1,
                b"vn" => counts.normals += 1,
                _ => {}
            }
        }
        counts.lines = statements.line();
        counts
    }

    pub(super) fn plus(self, other: Self) -> Self {
        Self {
            lines: self.lines + other.lines,
            vertices: self.vertices + other.vertices,
            texture_coordinates: self.texture_coordinates + other.texture_coordinates,
            normals: self.normals + other.normals,
        }
    }
}

/// What a chunk says.
#[derive(Debug, Default)]
pub(super) struct Chunk {
    pub positions: Vec<[f64; 3]>,
    /// Colours of the vertices, white for those that have none; empty if none has.
    pub colors: Vec<[f32; 3]>,
    pub texture_coordinates: Vec<[f32; 2]>,
    pub normals: Vec<[f32; 3]>,
    /// Number of corners of each face.
    pub arities: Vec<u32>,
    /// Indices of vertex, texture coordinate and normal in the whole file, from 0, of the corners of all faces; [`NONE`].
    pub corners: Vec<[u32; 3]>,
    /// Names of materials, and the first face of the chunk that each is for.
    pub materials: Vec<(usize, String)>,
    /// What `mtllib` statements name.
    pub libraries: Vec<String>,
    /// Number of `l` and `p` statements.
    pub lines_and_points: usize,
    /// Vertices that are no place: index in the whole file, line from 0, what is wrong.
    pub misplaced: Vec<(u32, usize, String)>,
    /// Texture coordinates that are no numbers: how many, and the line of the first from 0.
    pub odd_texture_coordinates: Option<(usize, usize)>,
    /// Whether there is a face with a normal at every corner; with a texture coordinate at every corner.
    pub has_normals: bool,
    pub has_texture_coordinates: bool,
}

impl Chunk {
    /// Reads a chunk.
    ///
    /// `before` counts what stands before it, `counts` what it holds.
    pub(super) fn read(
        path: &Path,
        text: &[u8],
        before: Counts,
        counts: Counts,
        groups: &GroupMaterials,
    ) -> Result<Self, ConvertError> {
        let mut chunk = Self::default();
        chunk.positions.reserve_exact(counts.vertices);
        chunk.texture_coordinates.reserve_exact(counts.texture_coordinates);
        chunk.normals.reserve_exact(counts.normals);
        let mut parser = Parser { path, chunk, before, line: 0 };
        for statement in Statements::new(text, before.lines) {
            parser.line = statement.line;
            let (keyword, rest) = statement.split();
            parser.statement(keyword, rest, groups)?;
        }
        Ok(parser.chunk)
    }
}

struct Parser<'a> {
    path: &'a Path,
    chunk: Chunk,
    before: Counts,
    line: usize,
}

impl Parser<'_> {
    fn statement(
        &mut self,
        keyword: &[u8],
        rest: &[u8],
        groups: &GroupMaterials,
    ) -> Result<(), ConvertError> {
        match keyword {
            b"v" => self.vertex(rest)?,
            b"vt" => self.texture_coordinate(rest),
            b"vn" => self.normal(rest)?,
            b"f" => self.face(rest)?,
            b"usemtl" => {
                let name = trimmed(rest);
                if name.is_empty() {
                    return self.malformed("`usemtl` without the name of a material".to_owned());
                }
                self.use_material(name);
            }
            b"g" => {
                if let Some(name) = groups.of(rest) {
                    self.use_material(trimmed(name));
                }
            }
            b"mtllib" => self.chunk.libraries.push(trimmed(rest)),
            b"l" | b"p" => self.chunk.lines_and_points += 1,
            _ => {}
        }
        Ok(())
    }

    fn use_material(&mut self, name: String) {
        self.chunk.materials.push((self.chunk.arities.len(), name));
    }

    fn vertex(&mut self, rest: &[u8]) -> Result<(), ConvertError> {
        let rest = without_comment(rest);
        let mut numbers = [0.0; 6];
        let mut count = 0;
        let mut wrong = None;
        for word in words(rest) {
            if let Some(number) = numbers.get_mut(count) {
                match parse_number(word) {
                    Some(value) => *number = value,
                    None => wrong = wrong.or(Some(word)),
                }
            }
            count += 1;
        }
        // Coordinates; with a weight; with a colour; with an opacity behind it, which some programs write.
        if !matches!(count, 3 | 4 | 6 | 7) {
            return self.malformed(format!(
                "a vertex has {count} numbers; expected 3 coordinates, a weight or a colour of 3 after them"
            ));
        }
        if let Some(word) = wrong {
            return self.no_number(word);
        }
        let [x, y, z, red, green, blue] = numbers;
        let mut position = [x, y, z];
        if count == 4 {
            let weight = red;
            if weight == 0.0 {
                return self
                    .malformed("a vertex has the weight 0; expected another number, or none".to_owned());
            }
            position = position.map(|coordinate| coordinate / weight);
        }
        if position.iter().any(|coordinate| !coordinate.is_finite()) {
            self.misplaced(rest);
        }
        let chunk = &mut self.chunk;
        if count >= 6 || !chunk.colors.is_empty() {
            chunk.colors.resize(chunk.positions.len(), [1.0; 3]);
            chunk.colors.push(if count >= 6 { [red, green, blue].map(|c| c as f32) } else { [1.0; 3] });
        }
        chunk.positions.push(position);
        Ok(())
    }

    /// Notes that the vertex is no place. Only a face that uses it makes that an error.
    #[cold]
    fn misplaced(&mut self, numbers: &[u8]) {
        let is_finite = |word: &&[u8]| parse_number(word).is_some_and(f64::is_finite);
        let word = words(numbers).find(|word| !is_finite(word)).unwrap_or(numbers.trim_ascii());
        let problem =
            format!("`{}` is no coordinate; expected a finite number", String::from_utf8_lossy(word));
        let vertex = self.before.vertices + self.chunk.positions.len();
        self.chunk.misplaced.push((vertex as u32, self.line, problem));
    }

    fn texture_coordinate(&mut self, rest: &[u8]) {
        let mut coordinates = [Some(0.0); 2];
        for (coordinate, word) in coordinates.iter_mut().zip(words(without_comment(rest))) {
            *coordinate = parse_number(word).filter(|number| number.is_finite());
        }
        let coordinates = match coordinates {
            [Some(u), Some(v)] => [u as f32, v as f32],
            _ => {
                self.chunk.odd_texture_coordinates.get_or_insert((0, self.line)).0 += 1;
                [0.0; 2]
            }
        };
        self.chunk.texture_coordinates.push(coordinates);
    }

    fn normal(&mut self, rest: &[u8]) -> Result<(), ConvertError> {
        let mut normal = [0.0; 3];
        let mut count = 0;
        for (component, word) in normal.iter_mut().zip(words(without_comment(rest))) {
            match parse_number(word) {
                Some(number) => *component = number as f32,
                None => return self.no_number(word),
            }
            count += 1;
        }
        if count < 3 {
            return self.malformed(format!("a normal has {count} numbers; expected 3"));
        }
        self.chunk.normals.push(normal);
        Ok(())
    }

    fn face(&mut self, rest: &[u8]) -> Result<(), ConvertError> {
        let first = self.chunk.corners.len();
        let counts = [
            self.before.vertices + self.chunk.positions.len(),
            self.before.texture_coordinates + self.chunk.texture_coordinates.len(),
            self.before.normals + self.chunk.normals.len(),
        ];
        let mut end = 0;
        while let Some(start) = next_word(rest, end) {
            let corner;
            (corner, end) = self.corner(rest, start, counts)?;
            self.chunk.corners.push(corner);
        }
        let corners = &self.chunk.corners[first..];
        if corners.len() < 3 {
            return self.malformed(format!("a face has {} corners; expected at least 3", corners.len()));
        }
        let Ok(arity) = u32::try_from(corners.len()) else {
            return self.malformed(format!("a face has {} corners; cut it up", corners.len()));
        };
        self.chunk.has_texture_coordinates |= corners.iter().all(|corner| corner[1] != NONE);
        self.chunk.has_normals |= corners.iter().all(|corner| corner[2] != NONE);
        self.chunk.arities.push(arity);
        Ok(())
    }

    /// Reads the corner of a face (`v`, `v/vt`, `v//vn` or `v/vt/vn`) that begins at `start`: its indices, and where it
    /// ends. `counts` tells how many vertices, texture coordinates and normals precede it.
    fn corner(
        &self,
        face: &[u8],
        start: usize,
        counts: [usize; 3],
    ) -> Result<([u32; 3], usize), ConvertError> {
        let mut corner = [NONE; 3];
        let mut end = start;
        for (place, count) in counts.into_iter().enumerate() {
            let field = end;
            let index = read_index(face, &mut end);
            let is_missing = end == field && place > 0;
            if index.is_none() && !is_missing {
                break;
            }
            if let Some(index) = index {
                if index == 0 || index.unsigned_abs() > count as u64 {
                    let kind = ["vertex", "texture coordinate", "normal"][place];
                    let line = self.line + 1;
                    return Err(ConvertError::FaceIndex {
                        path: self.path.to_owned(),
                        line,
                        kind,
                        index,
                        count,
                    });
                }
                let from_start = if index > 0 { index - 1 } else { count as i64 + index };
                corner[place] = from_start as u32;
            }
            match face.get(end) {
                Some(b'/') => end += 1,
                None => return Ok((corner, end)),
                Some(byte) if byte.is_ascii_whitespace() || *byte == b'#' => return Ok((corner, end)),
                Some(_) => break,
            }
        }
        let corner = words(&face[start..]).next().unwrap_or_default();
        let corner = String::from_utf8_lossy(corner);
        self.malformed(format!("`{corner}` is no corner of a face; expected v, v/vt, v//vn or v/vt/vn"))
    }

    fn no_number<T>(&self, word: &[u8]) -> Result<T, ConvertError> {
        self.malformed(format!("`{}` is no number", String::from_utf8_lossy(word)))
    }

    #[cold]
    fn malformed<T>(&self, problem: String) -> Result<T, ConvertError> {
        Err(ConvertError::Statement { path: self.path.to_owned(), line: self.line + 1, problem })
    }
}

fn trimmed(text: &[u8]) -> String {
    String::from_utf8_lossy(text).trim().to_owned()
}

/// Where the next word begins, from `at` on; `None` at the end or at a comment.
fn next_word(text: &[u8], at: usize) -> Option<usize> {
    let blanks = text[at..].iter().position(|byte| !byte.is_ascii_whitespace())?;
    (text[at + blanks] != b'#').then_some(at + blanks)
}

/// Reads an index, digits with or without a sign, at `at`, and goes behind it; `None` if there is none that fits.
fn read_index(text: &[u8], at: &mut usize) -> Option<i64> {
    let sign = match text.get(*at) {
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
