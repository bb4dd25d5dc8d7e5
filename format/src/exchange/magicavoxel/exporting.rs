//! From an octree to a MagicaVoxel file.

use super::super::{ExchangeError, Leaf};
use super::chunks::{chunk, dictionary};
use super::reduced_palette::ReducedPalette;
use super::{MAX_VOXELS, MODEL_SIDE, material};
use crate::{FormatError, MaterialPalette};
use std::collections::BTreeMap;
use std::io::Write;

/// The version of the format that is written.
const VERSION: u32 = 150;
/// The finest level: MagicaVoxel shows models as far as 1000 cells or so from the middle of its world.
const MAX_DEPTH: u8 = 11;

/// Writes the filled cells of the level `depth` as models of at most 256³ voxels, which stand side by side in the middle of
/// the world, and returns the output.
///
/// The palette is kept if at most 255 materials are in use. If there are more, materials become their diffuse colours, and of
/// these 255 are chosen by median cut. Normals have no place in the file.
///
/// # Errors
/// The first error of the leaves; [`ExchangeError::TooFineForMagicaVoxel`]; [`FormatError::Write`].
pub fn export<W: Write>(
    leaves: impl Iterator<Item = Result<Leaf, FormatError>>,
    depth: u8,
    materials: &MaterialPalette,
    mut output: W,
) -> Result<W, FormatError> {
    let models = Models::read(leaves, depth)?;
    let palette = ReducedPalette::new(&models.uses, materials);
    let mut children = Vec::new();
    for voxels in models.blocks.values() {
        children.extend(chunk(b"SIZE", &[models.side.to_le_bytes(); 3].concat()));
        // At most 2²⁴.
        let mut content = (voxels.len() as u32).to_le_bytes().to_vec();
        content.extend(voxels.iter().flat_map(|([x, y, z], index)| [*x, *y, *z, palette.index_of(*index)]));
        children.extend(chunk(b"XYZI", &content));
    }
    children.extend(models.scene());
    children.extend(chunk(b"RGBA", &palette.colors()));
    for (index, material) in (1_u32..).zip(palette.materials()) {
        if let Some(entries) = material::export(material) {
            children.extend(chunk(b"MATL", &[&index.to_le_bytes()[..], &dictionary(&entries)].concat()));
        }
    }
    // Not even as many voxels as there may be reach the limit.
    let length = u32::try_from(children.len()).unwrap_or(u32::MAX);
    let head = [*b"VOX ", VERSION.to_le_bytes(), *b"MAIN", [0; 4], length.to_le_bytes()];
    output
        .write_all(head.as_flattened())
        .and_then(|()| output.write_all(&children))
        .and_then(|()| output.flush())
        .map_err(|source| FormatError::Write { offset: 0, source })?;
    Ok(output)
}

/// The models of a file, with MagicaVoxel's axes.
struct Models {
    resolution: u32,
    /// Length of the edges of a model.
    side: u32,
    /// The voxels of each model in it, and their palette indices, by the place of the model among models.
    blocks: BTreeMap<[u32; 3], Vec<([u8; 3], u16)>>,
    /// How many voxels each palette index has.
    uses: BTreeMap<u16, u64>,
}

impl Models {
    fn read(leaves: impl Iterator<Item = Result<Leaf, FormatError>>, depth: u8) -> Result<Self, FormatError> {
        let resolution = 1_u64 << depth.min(63);
        let too_fine = |voxels| ExchangeError::TooFineForMagicaVoxel {
            resolution,
            voxels,
            resolution_limit: 1 << MAX_DEPTH,
            voxel_limit: MAX_VOXELS,
        };
        if depth > MAX_DEPTH {
            return Err(too_fine(0).into());
        }
        let resolution = resolution as u32;
        let side = resolution.min(MODEL_SIDE);
        let mut models = Self { resolution, side, blocks: BTreeMap::new(), uses: BTreeMap::new() };
        let mut voxels = 0_u64;
        for leaf in leaves {
            let leaf = leaf?;
            if leaf.level > depth {
                return Err(FormatError::TooDeep { offset: 0, max_depth: depth });
            }
            let (corner, edge) = leaf.cube(depth);
            voxels += u64::from(edge).pow(3);
            if voxels > MAX_VOXELS {
                return Err(too_fine(voxels).into());
            }
            let index = leaf.voxel.palette_index;
            *models.uses.entry(index).or_default() += u64::from(edge).pow(3);
            for z in corner[2]..corner[2] + edge {
                for y in corner[1]..corner[1] + edge {
                    for x in corner[0]..corner[0] + edge {
                        models.add([x, resolution - 1 - z, y], index);
                    }
                }
            }
        }
        Ok(models)
    }

    fn add(&mut self, cell: [u32; 3], palette_index: u16) {
        let block = cell.map(|coordinate| coordinate / self.side);
        // A side is at most 256.
        let place = cell.map(|coordinate| (coordinate % self.side) as u8);
        self.blocks.entry(block).or_default().push((place, palette_index));
    }

    /// The chunks that say where the models are: the volume stands on the ground, in the middle.
    fn scene(&self) -> Vec<u8> {
        let none = dictionary(&[]);
        let words = |words: &[u32]| words.iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<u8>>();
        let transform = |node: u32, child: u32, frame: &[(&str, String)]| {
            let rest = words(&[child, u32::MAX, 0, 1]);
            chunk(b"nTRN", &[&node.to_le_bytes()[..], &none, &rest, &dictionary(frame)].concat())
        };
        let count = self.blocks.len() as u32;
        let mut chunks = transform(0, 1, &[]);
        let children: Vec<u32> = (0..count).map(|number| 2 + 2 * number).collect();
        chunks
            .extend(chunk(b"nGRP", &[words(&[1]), none.clone(), words(&[count]), words(&children)].concat()));
        for (number, block) in (0..).zip(self.blocks.keys()) {
            let [x, y, z] = self.middle(*block);
            chunks.extend(transform(2 + 2 * number, 3 + 2 * number, &[("_t", format!("{x} {y} {z}"))]));
            let shape = [words(&[3 + 2 * number]), none.clone(), words(&[1, number]), none.clone()];
            chunks.extend(chunk(b"nSHP", &shape.concat()));
        }
        chunks
    }

    /// Where the middle of a model is.
    fn middle(&self, block: [u32; 3]) -> [i64; 3] {
        let half = i64::from(self.resolution / 2);
        let shift = [half, half, 0];
        std::array::from_fn(|axis| i64::from(block[axis] * self.side + self.side / 2) - shift[axis])
    }
}
