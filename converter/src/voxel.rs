//! A voxel of the octree, before it is encoded.

use bytemuck::{Pod, Zeroable};
use octvox_format::SphericalNormal;

/// What a filled cell looks like.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Voxel {
    /// Index into the palette, from 1; 0 if the cell is empty.
    pub palette_index: u16,
    /// The normal in the code of the file ([`octvox_format::NormalCode`]).
    pub normal: [u8; 2],
}

impl Voxel {
    /// A cell without anything in it.
    pub(crate) const EMPTY: Self = Self { palette_index: 0, normal: [0; 2] };

    /// The voxel and its children flag as four bytes of a file of version 4, if its normal is a spherical one.
    #[inline]
    pub(crate) fn to_word(self, has_children: bool) -> [u8; 4] {
        let normal = SphericalNormal::from_bytes(self.normal);
        octvox_format::Voxel { palette_index: self.palette_index, normal }.to_word(has_children)
    }
}
