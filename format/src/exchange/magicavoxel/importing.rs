//! From a MagicaVoxel file to an octree.

use super::super::ExchangeError;
use super::chunks::{Bytes, Dictionary};
use super::default_palette::default_palette;
use super::normals::normals;
use super::octree::build;
use super::scene::{Place, Scene};
use super::{MAX_VOXELS, MODEL_SIDE, material};
use crate::v5::{Compression, Header, Levels, Planes, Subtree, Writer, code_of_cell};
use crate::{FormatError, MaterialPalette, NormalCode, WorldTransform};
use rayon::prelude::*;
use std::collections::BTreeMap;

const MAGIC: [u8; 4] = *b"VOX ";

/// Whether a file that begins so is one of MagicaVoxel.
#[must_use]
pub fn is_magicavoxel(beginning: &[u8]) -> bool {
    beginning.starts_with(&MAGIC)
}

/// A file of version 5, uncompressed and not cut, with what is shown of a MagicaVoxel file.
///
/// The models stand where the scene says; where several have a voxel, the last one counts. Of an animation the first
/// picture is taken. A voxel is one long in the world, and the octree has the least depth that holds all. Only the
/// materials in use are kept. Normals are made: away from the voxels around.
///
/// # Errors
/// [`FormatError::Exchange`] if the file is none of MagicaVoxel or damaged, or if nothing, or too much, is shown.
pub fn import(file: &[u8]) -> Result<Vec<u8>, FormatError> {
    let parts = Parts::read(file)?;
    let shown = parts.shown()?;
    let (mut corner, mut end) = ([i64::MAX; 3], [i64::MIN; 3]);
    let mut count = 0;
    shown.iter().try_for_each(|(model, place)| {
        model.each_voxel(*place, |cell, _| {
            corner = std::array::from_fn(|axis| corner[axis].min(cell[axis]));
            end = std::array::from_fn(|axis| end[axis].max(cell[axis] + 1));
            count += 1;
        })
    })?;
    if count == 0 {
        return Err(ExchangeError::Nothing.into());
    }
    let extent = (0..3).map(|axis| end[axis].abs_diff(corner[axis])).max().unwrap_or(0);
    let limit = 1 << Header::MAX_CUT_LEVEL;
    if extent > limit {
        return Err(ExchangeError::SceneTooLong { extent, limit }.into());
    }
    let depth = extent.next_power_of_two().trailing_zeros() as u8;

    let mut coded: Vec<(u64, u8)> = Vec::with_capacity(count);
    shown.iter().try_for_each(|(model, place)| {
        model.each_voxel(*place, |cell, index| {
            let cell = std::array::from_fn(|axis| (cell[axis] - corner[axis]) as u32);
            coded.push((code_of_cell(cell), index));
        })
    })?;
    coded.par_sort_by_key(|(code, _)| *code);
    // The last one of a cell, which the stable sort has left last.
    coded.reverse();
    coded.dedup_by_key(|(code, _)| *code);
    coded.reverse();

    let (materials, palette_index) = parts.palette(coded.iter().map(|(_, index)| *index))?;
    let (codes, indices): (Vec<u64>, Vec<u16>) =
        coded.into_iter().map(|(code, index)| (code, palette_index[usize::from(index)])).unzip();
    let normals = normals(&codes, depth);
    let planes = build(&codes, indices, normals, depth);
    let world = WorldTransform { origin: corner.map(|coordinate| coordinate as f64), voxel_size: 1.0 };
    write(planes, depth, world, &materials)
}

fn write(
    planes: Planes,
    depth: u8,
    world: WorldTransform,
    materials: &MaterialPalette,
) -> Result<Vec<u8>, FormatError> {
    let header = Header {
        cut_level: 0,
        compression: Compression::None,
        normal_code: NormalCode::Octahedral,
        world: Some(world),
        ..Header::new(depth)
    };
    let mut writer = Writer::new(Vec::new(), &header, materials)?;
    let subtree = Subtree { code: 0, levels: Levels::subtree(0, depth, planes)? };
    writer.subtree(&writer.encoder().encode(&subtree)?)?;
    writer.finish(&Levels::top(0, Planes::default())?)
}

/// What is in a file.
#[derive(Default)]
struct Parts<'a> {
    models: Vec<Model<'a>>,
    scene: Scene,
    /// The colours of the indices from 1 on.
    colors: Option<Vec<[u8; 3]>>,
    materials: BTreeMap<u32, Dictionary>,
}

struct Model<'a> {
    size: [u32; 3],
    /// x, y, z, index.
    voxels: &'a [[u8; 4]],
    offset: u64,
}

impl<'a> Parts<'a> {
    fn read(file: &'a [u8]) -> Result<Self, ExchangeError> {
        if !is_magicavoxel(file) {
            return Err(ExchangeError::NotMagicaVoxel { found: file.iter().copied().take(4).collect() });
        }
        let mut bytes = Bytes::new(file);
        bytes.take(MAGIC.len(), "magic number")?;
        bytes.number("version")?;
        let offset = bytes.offset;
        let main = bytes.chunk()?;
        if main.kind != *b"MAIN" {
            let value = String::from_utf8_lossy(&main.kind).into_owned();
            return Err(ExchangeError::DamagedField { offset, field: "first chunk", value });
        }
        let mut parts = Self::default();
        let mut size = None;
        let mut children = main.children;
        while !children.is_empty() {
            let mut chunk = children.chunk()?;
            let content = &mut chunk.content;
            match &chunk.kind {
                b"SIZE" => size = Some(read_size(content)?),
                b"XYZI" => parts.models.push(Model::read(content, size.take())?),
                b"RGBA" => parts.colors = Some(read_colors(content)?),
                b"MATL" => {
                    let index = content.number("material")?;
                    parts.materials.insert(index, content.dictionary("material")?);
                }
                b"nTRN" => parts.scene.add_transform(*content)?,
                b"nGRP" => parts.scene.add_group(*content)?,
                b"nSHP" => parts.scene.add_shape(*content)?,
                b"LAYR" => parts.scene.add_layer(*content)?,
                // Cameras, notes, and what else is not shown.
                _ => {}
            }
        }
        Ok(parts)
    }

    /// The models that are shown, and where.
    fn shown(&self) -> Result<Vec<(&Model<'a>, Place)>, ExchangeError> {
        let shown: Vec<_> = if self.scene.is_empty() {
            // A file without a scene has one model, or several pictures of an animation.
            self.models.iter().take(1).map(|model| (model, model.at_origin())).collect()
        } else {
            let model = |(model, place)| Some((self.models.get(model as usize)?, place));
            self.scene.models()?.into_iter().filter_map(model).collect()
        };
        let count = shown.iter().fold(0_u64, |sum, (model, _)| sum.saturating_add(model.voxels.len() as u64));
        if count > MAX_VOXELS {
            return Err(ExchangeError::SceneTooLarge { what: "voxels", limit: MAX_VOXELS });
        }
        Ok(shown)
    }

    /// The materials of the indices in use, and for each index its palette index.
    fn palette(&self, used: impl Iterator<Item = u8>) -> Result<(MaterialPalette, [u16; 256]), FormatError> {
        let mut is_used = [false; 256];
        used.for_each(|index| is_used[usize::from(index)] = true);
        let colors = self.colors.clone().unwrap_or_else(default_palette);
        let mut palette_index = [0; 256];
        let mut materials = Vec::new();
        for index in (1..256).filter(|index| is_used[*index]) {
            // An index beyond the palette is black.
            let color = colors.get(index - 1).copied().unwrap_or_default();
            materials.push(material::import(color, self.materials.get(&(index as u32))));
            palette_index[index] = materials.len() as u16;
        }
        Ok((MaterialPalette::new(materials)?, palette_index))
    }
}

fn read_size(content: &mut Bytes<'_>) -> Result<[u32; 3], ExchangeError> {
    const PART: &str = "size of a model";
    let offset = content.offset;
    let size = [content.number(PART)?, content.number(PART)?, content.number(PART)?];
    if size.iter().any(|side| !(1..=MODEL_SIDE).contains(side)) {
        return Err(ExchangeError::DamagedField { offset, field: PART, value: format!("{size:?}") });
    }
    Ok(size)
}

fn read_colors(content: &mut Bytes<'_>) -> Result<Vec<[u8; 3]>, ExchangeError> {
    let bytes = content.take(4 * 255, "palette")?;
    Ok(bytes.as_chunks().0.iter().map(|[red, green, blue, _]| [*red, *green, *blue]).collect())
}

impl<'a> Model<'a> {
    fn read(content: &mut Bytes<'a>, size: Option<[u32; 3]>) -> Result<Self, ExchangeError> {
        const PART: &str = "voxels of a model";
        let offset = content.offset;
        let Some(size) = size else {
            return Err(ExchangeError::Truncated { offset, part: "size of a model" });
        };
        let count = content.count(4, PART)?;
        let voxels = content.take(4 * count, PART)?.as_chunks().0;
        Ok(Self { size, voxels, offset })
    }

    /// The place at which the model's corner is the origin.
    fn at_origin(&self) -> Place {
        Place { translation: self.size.map(|side| i64::from(side / 2)), ..Place::ORIGIN }
    }

    /// Visits the voxels as they are at a place, with our axes. The place is that of the model's middle: of an even number of
    /// cells the plane between them, of an odd one the lower face of the middle cell.
    fn each_voxel(&self, place: Place, mut visit: impl FnMut([i64; 3], u8)) -> Result<(), ExchangeError> {
        for (number, &[x, y, z, index]) in self.voxels.iter().enumerate() {
            let local = [x, y, z].map(i64::from);
            let is_inside = (0..3).all(|axis| local[axis] < i64::from(self.size[axis]));
            if !is_inside || index == 0 {
                let (offset, value) =
                    (self.offset + 4 + 4 * number as u64, format!("{:?}", [x, y, z, index]));
                return Err(ExchangeError::DamagedField { offset, field: "voxel", value });
            }
            // Twice the middle of the cell, so that a turn leaves whole numbers.
            let middle = std::array::from_fn(|axis| 2 * (local[axis] - i64::from(self.size[axis] / 2)) + 1);
            let turned = place.rotation.apply(middle);
            let [x, y, z] =
                std::array::from_fn(|axis| (turned[axis] + 2 * place.translation[axis]).div_euclid(2));
            visit([x, z, -y - 1], index);
        }
        Ok(())
    }
}
