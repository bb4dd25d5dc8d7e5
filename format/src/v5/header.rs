//! What stands at the beginning of a file.

use super::section::crc32;
use crate::header::{MAGIC, read_version};
use crate::input::Input;
use crate::{FormatError, Limits, NormalCode, WorldTransform};
use byteorder::{ByteOrder, LittleEndian};
use std::io::Read;

/// Length of the header, in bytes.
pub(crate) const HEADER_BYTES: usize = 96;
/// The version of the format that is described in this module.
pub const VERSION: u16 = 5;

const NAME: std::ops::Range<usize> = 48..92;
const CHECKED: usize = 92;

/// What is said of a file before its voxels.
///
/// ```text
///  offset  bytes  field
///  0       2      magic           4D 42 ("MB")
///  2       2      version         05 00
///  4       1      depth           0 to 23
///  5       1      cut level       0 to 21, at most the depth
///  6       1      normal code     0 spherical, 1 octahedral
///  7       1      compression     0 none, 1 Zstandard
///  8       2      materials       their number
///  10      6      reserved        zeros
///  16      24     world origin    x, y, z: f64
///  40      8      voxel size      f64; 0, like the origin, if the place in the world is unknown
///  48      44     writer          name of the program, UTF-8, filled up with zeros
///  92      4      checksum        CRC-32 of bytes 0 to 91
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Header {
    /// Levels below the root: the octree has `1 << depth` cells along each axis.
    pub depth: u8,
    /// The level at which the octree is cut into subtrees.
    pub cut_level: u8,
    /// How normals are to be understood.
    pub normal_code: NormalCode,
    /// What may be done to sections to make them shorter.
    pub compression: Compression,
    /// Where the octree lies in the world, if that is known.
    pub world: Option<WorldTransform>,
    /// Name of the program that wrote the file, at most [`Header::MAX_WRITER_BYTES`] long, without zeros.
    pub writer: String,
}

/// How sections are made shorter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Compression {
    /// Not at all.
    None,
    /// With Zstandard, each on its own, where that makes it shorter.
    #[default]
    Zstandard,
}

impl Compression {
    /// `none` or `zstd`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Zstandard => "zstd",
        }
    }
}

impl Header {
    /// The largest level at which an octree can be cut: the Morton code of a cell takes three bits for each level.
    pub const MAX_CUT_LEVEL: u8 = 21;
    /// Bytes for the name of the writer.
    pub const MAX_WRITER_BYTES: usize = NAME.end - NAME.start;
    /// Levels of a subtree below its root if nothing else is asked for. Such a subtree of a surface has some ten thousand
    /// voxels: enough for compression to be good, few enough for a region to be cut out well.
    pub const SUBTREE_DEPTH: u8 = 7;

    /// A header for an octree of so many levels below its root, with octahedral normals and compressed with Zstandard.
    #[must_use]
    pub fn new(depth: u8) -> Self {
        Self {
            depth,
            cut_level: depth.saturating_sub(Self::SUBTREE_DEPTH),
            normal_code: NormalCode::default(),
            compression: Compression::default(),
            world: None,
            writer: concat!("octvox ", env!("CARGO_PKG_VERSION")).to_owned(),
        }
    }

    /// The header of the octree down to `level`, whose cells are larger, with subtrees of the usual size at most.
    #[must_use]
    pub fn down_to(&self, level: u8) -> Self {
        if level >= self.depth {
            return self.clone();
        }
        let depth = level;
        let growth = f64::from(1_u32 << u32::from(self.depth - depth).min(31));
        let larger =
            |world: WorldTransform| WorldTransform { voxel_size: world.voxel_size * growth, ..world };
        let cut_level = self.cut_level.min(depth.saturating_sub(Self::SUBTREE_DEPTH));
        Self { depth, cut_level, world: self.world.map(larger), ..self.clone() }
    }

    /// Cells along each axis at the finest level.
    #[must_use]
    pub fn resolution(&self) -> u32 {
        1_u32.checked_shl(u32::from(self.depth)).unwrap_or(u32::MAX)
    }

    /// Whether a file can have this header.
    pub(crate) fn check(&self) -> Result<(), FormatError> {
        if self.depth > Limits::MAX_DEPTH {
            return Err(FormatError::TooDeep { offset: 4, max_depth: Limits::MAX_DEPTH });
        }
        check_field(5, "cut level", self.cut_level, self.depth.min(Self::MAX_CUT_LEVEL))?;
        if let Some(world) = self.world
            && !world.is_valid()
        {
            return Err(FormatError::ImpossibleWorld { origin: world.origin, voxel_size: world.voxel_size });
        }
        if self.writer.len() > Self::MAX_WRITER_BYTES || self.writer.contains('\0') {
            let limit = Self::MAX_WRITER_BYTES;
            return Err(FormatError::WriterName { name: self.writer.clone(), limit });
        }
        Ok(())
    }

    /// The header as in the file. It has been checked.
    pub(crate) fn to_bytes(&self, materials: u16) -> [u8; HEADER_BYTES] {
        let mut bytes = [0; HEADER_BYTES];
        bytes[0..2].copy_from_slice(&MAGIC);
        LittleEndian::write_u16(&mut bytes[2..4], VERSION);
        bytes[4] = self.depth;
        bytes[5] = self.cut_level;
        bytes[6] = self.normal_code as u8;
        bytes[7] = self.compression as u8;
        LittleEndian::write_u16(&mut bytes[8..10], materials);
        let world = self.world.unwrap_or(UNKNOWN_WORLD);
        LittleEndian::write_f64_into(&world.origin, &mut bytes[16..40]);
        LittleEndian::write_f64(&mut bytes[40..48], world.voxel_size);
        bytes[NAME][..self.writer.len()].copy_from_slice(self.writer.as_bytes());
        let checksum = crc32(&[&bytes[..CHECKED]]);
        LittleEndian::write_u32(&mut bytes[CHECKED..], checksum);
        bytes
    }

    /// Reads a header to its end, and returns it with the number of materials.
    pub(crate) fn read(input: &mut Input<impl Read>, limits: Limits) -> Result<(Self, u16), FormatError> {
        let version = read_version(input)?;
        if version != VERSION {
            return Err(FormatError::UnsupportedVersion { version });
        }
        let mut bytes = [0; HEADER_BYTES];
        bytes[0..2].copy_from_slice(&MAGIC);
        LittleEndian::write_u16(&mut bytes[2..4], version);
        input.read_field("header", &mut bytes[4..])?;
        Self::from_bytes(&bytes, limits)
    }

    fn from_bytes(bytes: &[u8; HEADER_BYTES], limits: Limits) -> Result<(Self, u16), FormatError> {
        let (stored, computed) = (LittleEndian::read_u32(&bytes[CHECKED..]), crc32(&[&bytes[..CHECKED]]));
        if stored != computed {
            return Err(FormatError::ChecksumMismatch { offset: 0, section: "header", stored, computed });
        }
        check_field(6, "normal code", bytes[6], 1)?;
        check_field(7, "compression", bytes[7], 1)?;
        if let Some(place) = bytes[10..16].iter().position(|byte| *byte != 0) {
            check_field(10 + place as u64, "reserved field", bytes[10 + place], 0)?;
        }
        let number = |offset: usize| LittleEndian::read_f64(&bytes[offset..offset + 8]);
        let world = WorldTransform { origin: [number(16), number(24), number(32)], voxel_size: number(40) };
        let length = bytes[NAME].iter().rposition(|byte| *byte != 0).map_or(0, |last| last + 1);
        let name = &bytes[NAME][..length];
        let writer =
            str::from_utf8(name).map_err(|_| FormatError::DamagedField { offset: 48, field: "writer" })?;
        let header = Self {
            depth: bytes[4],
            cut_level: bytes[5],
            normal_code: if bytes[6] == 0 { NormalCode::Spherical } else { NormalCode::Octahedral },
            compression: if bytes[7] == 0 { Compression::None } else { Compression::Zstandard },
            world: Some(world).filter(|world| *world != UNKNOWN_WORLD),
            writer: writer.to_owned(),
        };
        header.check()?;
        if header.depth > limits.max_depth {
            return Err(FormatError::TooDeep { offset: 4, max_depth: limits.max_depth });
        }
        Ok((header, LittleEndian::read_u16(&bytes[8..10])))
    }
}

/// What stands in the file if the place in the world is unknown.
const UNKNOWN_WORLD: WorldTransform = WorldTransform { origin: [0.0; 3], voxel_size: 0.0 };

fn check_field(offset: u64, field: &'static str, value: u8, limit: u8) -> Result<(), FormatError> {
    if value > limit {
        let (value, limit) = (u64::from(value), u64::from(limit));
        return Err(FormatError::FieldOutOfRange { offset, field, value, limit });
    }
    Ok(())
}
