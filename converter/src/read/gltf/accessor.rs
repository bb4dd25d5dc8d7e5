//! Numbers in the buffers of a glTF file.

use super::resource::Resources;
use ::gltf::accessor::sparse::IndexType;
use ::gltf::accessor::{DataType, Dimensions};
use ::gltf::{Accessor, buffer::View};

/// How many values an accessor without a view may have for each that it gives.
const MAX_SPARSENESS: usize = 256;

/// Reads accessors, every place of which is checked.
pub(super) struct Accessors<'a> {
    resources: &'a Resources,
}

impl<'a> Accessors<'a> {
    pub(super) fn new(resources: &'a Resources) -> Self {
        Self { resources }
    }

    /// The values of an accessor of vectors with `N` components: integers that are meant as fractions are such.
    pub(super) fn read<const N: usize>(&self, accessor: &Accessor<'_>) -> Result<Vec<[f64; N]>, String> {
        let components = components(accessor.dimensions());
        if components < N {
            return Err(format!("accessor {} has {components} components; expected {N}", accessor.index()));
        }
        let kind = accessor.data_type();
        let count = accessor.count();
        let convert = |bytes: &[u8]| number(kind, accessor.normalized(), bytes);
        let item = |bytes: &[u8]| {
            std::array::from_fn(|component| {
                convert(&bytes[component * size(kind)..(component + 1) * size(kind)])
            })
        };
        let item_size = components * size(kind);
        // Before room is made for the values: a sparse part that is really there bounds their number.
        let sparse = self.sparse_items(accessor, item_size)?;
        let mut values: Vec<[f64; N]> = match accessor.view() {
            Some(view) => {
                self.items(accessor, &view, accessor.offset(), item_size, count)?.map(item).collect()
            }
            // Zeros, of which the sparse part replaces some.
            None if count <= MAX_SPARSENESS * sparse.len() => vec![[0.0; N]; count],
            None => return Err(format!("accessor {} has no data that can be read", accessor.index())),
        };
        for (place, replacement) in sparse {
            let value = values
                .get_mut(place)
                .ok_or_else(|| format!("accessor {} replaces value {place} of {count}", accessor.index()))?;
            *value = item(replacement);
        }
        Ok(values)
    }

    /// The values of an accessor that differ from those of its view: their places, and their bytes.
    fn sparse_items(&self, accessor: &Accessor<'_>, size: usize) -> Result<Vec<(usize, &'a [u8])>, String> {
        let Some(sparse) = accessor.sparse() else { return Ok(Vec::new()) };
        let (indices, values) = (sparse.indices(), sparse.values());
        let kind = match indices.index_type() {
            IndexType::U8 => DataType::U8,
            IndexType::U16 => DataType::U16,
            IndexType::U32 => DataType::U32,
        };
        let count = sparse.count();
        let places = self.items(accessor, &indices.view(), indices.offset(), self::size(kind), count)?;
        let replacements = self.items(accessor, &values.view(), values.offset(), size, count)?;
        Ok(places.map(|place| number(kind, false, place) as usize).zip(replacements).collect())
    }

    /// As [`Self::read`], one for each of `count` vertices.
    pub(super) fn read_for_vertices<const N: usize>(
        &self,
        accessor: &Accessor<'_>,
        count: usize,
    ) -> Result<Vec<[f64; N]>, String> {
        let values = self.read(accessor)?;
        if values.len() < count {
            return Err(format!(
                "accessor {} has {} values for {count} vertices",
                accessor.index(),
                values.len()
            ));
        }
        Ok(values)
    }

    /// Indices of vertices, of which there are `vertices`.
    pub(super) fn read_indices(&self, accessor: &Accessor<'_>, vertices: usize) -> Result<Vec<u32>, String> {
        let indices = self.read::<1>(accessor)?;
        if let Some([index]) = indices.iter().find(|[index]| *index >= vertices as f64) {
            return Err(format!("index {index} is out of range: there are {vertices} vertices"));
        }
        Ok(indices.into_iter().map(|[index]| index as u32).collect())
    }

    /// The bytes of items that stand in a view.
    fn items(
        &self,
        accessor: &Accessor<'_>,
        view: &View<'_>,
        offset: usize,
        size: usize,
        count: usize,
    ) -> Result<impl Iterator<Item = &'a [u8]> + use<'a>, String> {
        let bytes = self.resources.view(view)?;
        let stride = view.stride().unwrap_or(size);
        let end = count
            .checked_sub(1)
            .map_or(Some(0), |last| last.checked_mul(stride)?.checked_add(size)?.checked_add(offset));
        if stride < size || end.is_none_or(|end| end > bytes.len()) {
            return Err(format!(
                "accessor {} of {count} values reaches beyond buffer view {}",
                accessor.index(),
                view.index()
            ));
        }
        Ok((0..count).map(move |index| &bytes[offset + index * stride..offset + index * stride + size]))
    }
}

fn components(dimensions: Dimensions) -> usize {
    match dimensions {
        Dimensions::Scalar => 1,
        Dimensions::Vec2 => 2,
        Dimensions::Vec3 => 3,
        Dimensions::Vec4 | Dimensions::Mat2 => 4,
        Dimensions::Mat3 => 9,
        Dimensions::Mat4 => 16,
    }
}

/// Length of a number in bytes.
fn size(kind: DataType) -> usize {
    match kind {
        DataType::I8 | DataType::U8 => 1,
        DataType::I16 | DataType::U16 => 2,
        DataType::U32 | DataType::F32 => 4,
    }
}

/// A number of a type from its bytes; a normalized integer is a fraction of the largest one.
fn number(kind: DataType, is_normalized: bool, bytes: &[u8]) -> f64 {
    let two = || [bytes[0], bytes[1]];
    let four = || [bytes[0], bytes[1], bytes[2], bytes[3]];
    let (number, max) = match kind {
        DataType::I8 => (f64::from(bytes[0] as i8), f64::from(i8::MAX)),
        DataType::U8 => (f64::from(bytes[0]), f64::from(u8::MAX)),
        DataType::I16 => (f64::from(i16::from_le_bytes(two())), f64::from(i16::MAX)),
        DataType::U16 => (f64::from(u16::from_le_bytes(two())), f64::from(u16::MAX)),
        DataType::U32 => (f64::from(u32::from_le_bytes(four())), f64::from(u32::MAX)),
        DataType::F32 => return f64::from(f32::from_le_bytes(four())),
    };
    if is_normalized { (number / max).max(-1.0) } else { number }
}
