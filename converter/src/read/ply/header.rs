//! The header of a PLY file: what elements follow, and of what they are made.

use crate::ConvertError;
use std::path::Path;

/// How values are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

/// The type of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scalar {
    Char,
    UChar,
    Short,
    UShort,
    Int,
    UInt,
    Float,
    Double,
}

impl Scalar {
    fn parse(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::Char,
            "uchar" | "uint8" => Self::UChar,
            "short" | "int16" => Self::Short,
            "ushort" | "uint16" => Self::UShort,
            "int" | "int32" => Self::Int,
            "uint" | "uint32" => Self::UInt,
            "float" | "float32" => Self::Float,
            "double" | "float64" => Self::Double,
            _ => return None,
        })
    }

    /// Length in a binary file, in bytes.
    pub(super) fn size(self) -> usize {
        match self {
            Self::Char | Self::UChar => 1,
            Self::Short | Self::UShort => 2,
            Self::Int | Self::UInt | Self::Float => 4,
            Self::Double => 8,
        }
    }
}

/// One number, or a list of them behind their count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Scalar(Scalar),
    List { count: Scalar, item: Scalar },
}

impl Kind {
    /// The fewest bytes it can have in a binary file.
    pub(super) fn min_size(self) -> usize {
        match self {
            Self::Scalar(scalar) | Self::List { count: scalar, .. } => scalar.size(),
        }
    }
}

#[derive(Debug)]
pub(super) struct Property {
    pub name: String,
    pub kind: Kind,
}

/// Things of one kind, such as vertices.
#[derive(Debug)]
pub(super) struct Element {
    pub name: String,
    pub count: u64,
    pub properties: Vec<Property>,
}

impl Element {
    /// Columns of numbers with certain names, each of which has alternatives; `None` if not all are there.
    pub(super) fn scalars<const N: usize>(&self, names: [&[&str]; N]) -> Option<[usize; N]> {
        let column = |names: &[&str]| {
            self.properties.iter().position(|property| {
                matches!(property.kind, Kind::Scalar(_)) && names.contains(&property.name.as_str())
            })
        };
        let columns = names.map(column);
        columns.iter().all(Option::is_some).then(|| columns.map(Option::unwrap_or_default))
    }

    /// The column of a list with one of these names.
    pub(super) fn list(&self, names: &[&str]) -> Option<usize> {
        self.properties.iter().position(|property| {
            matches!(property.kind, Kind::List { .. }) && names.contains(&property.name.as_str())
        })
    }
}

#[derive(Debug)]
pub(super) struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
    /// Files named by comments `TextureFile`.
    pub textures: Vec<String>,
    /// Where the values begin, in bytes, and in lines from 0.
    pub length: usize,
    pub lines: usize,
}

impl Header {
    /// Reads the header of a file.
    pub(super) fn parse(path: &Path, bytes: &[u8]) -> Result<Self, ConvertError> {
        let mut encoding = None;
        let mut elements: Vec<Element> = Vec::new();
        let mut textures = Vec::new();
        let mut length = 0;
        let mut lines = 0;
        let wrong = |line, problem| ConvertError::Statement { path: path.to_owned(), line, problem };
        for line in bytes.split_inclusive(|&byte| byte == b'\n') {
            lines += 1;
            length += line.len();
            let text = String::from_utf8_lossy(line);
            let words: Vec<&str> = text.split_whitespace().collect();
            let understood = match words[..] {
                ["ply"] => lines == 1,
                [] | ["obj_info", ..] => true,
                ["comment", "TextureFile", ..] => {
                    let name = text.trim_start().trim_start_matches("comment").trim_start();
                    textures.push(name.trim_start_matches("TextureFile").trim().to_owned());
                    true
                }
                ["comment", ..] => true,
                ["format", name, "1.0"] => {
                    encoding = match name {
                        "ascii" => Some(Encoding::Text),
                        "binary_little_endian" => Some(Encoding::LittleEndian),
                        "binary_big_endian" => Some(Encoding::BigEndian),
                        _ => None,
                    };
                    encoding.is_some()
                }
                ["element", name, count] => count.parse().is_ok_and(|count| {
                    elements.push(Element { name: name.to_owned(), count, properties: Vec::new() });
                    true
                }),
                ["property", ref kind @ .., name] => match (kind_of(kind), elements.last_mut()) {
                    (Some(kind), Some(element)) => {
                        element.properties.push(Property { name: name.to_owned(), kind });
                        true
                    }
                    _ => false,
                },
                ["end_header"] => {
                    let Some(encoding) = encoding else {
                        return Err(wrong(
                            lines,
                            "the header has no `format`; expected one before its end".to_owned(),
                        ));
                    };
                    return Ok(Self { encoding, elements, textures, length, lines });
                }
                _ => false,
            };
            if !understood {
                return Err(wrong(
                    lines,
                    format!("`{}` is no line of a PLY header of version 1.0", text.trim().escape_debug()),
                ));
            }
        }
        Err(wrong(lines + 1, "the header has no `end_header`; the file is incomplete".to_owned()))
    }
}

fn kind_of(words: &[&str]) -> Option<Kind> {
    match *words {
        [scalar] => Some(Kind::Scalar(Scalar::parse(scalar)?)),
        ["list", count, item] => {
            Some(Kind::List { count: Scalar::parse(count)?, item: Scalar::parse(item)? })
        }
        _ => None,
    }
}
