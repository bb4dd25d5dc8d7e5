//! What the shader needs to know of a voxel.

use bytemuck::{Pod, Zeroable};
use octvox_format::{SphericalNormal, Voxel};

/// A voxel's palette index and normal in 32 bits; kept apart from the structure, read once per hit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Pod, Zeroable)]
#[repr(transparent)]
pub struct Payload(u32);

impl Payload {
    /// Index into the palette, counted from 1; 0 means empty.
    #[must_use]
    pub fn palette_index(self) -> u16 {
        self.0 as u16
    }

    /// The code of the surface normal.
    #[must_use]
    pub fn normal(self) -> SphericalNormal {
        let [_, _, theta, phi] = self.0.to_le_bytes();
        SphericalNormal::from_bytes([theta, phi])
    }

    /// Index and normal.
    #[must_use]
    pub fn voxel(self) -> Voxel {
        Voxel { palette_index: self.palette_index(), normal: self.normal() }
    }

    /// Whether there is nothing to see.
    #[must_use]
    pub fn is_empty(self) -> bool {
        self.palette_index() == 0
    }
}

impl From<Voxel> for Payload {
    fn from(voxel: Voxel) -> Self {
        let [low, high] = voxel.palette_index.to_le_bytes();
        let [theta, phi] = voxel.normal.to_bytes();
        Self(u32::from_le_bytes([low, high, theta, phi]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_voxel_comes_back() {
        let normal = SphericalNormal { theta: 200, phi: -7 };
        let payload = Payload::from(Voxel { palette_index: 0x7FFF, normal });
        assert_eq!(payload.palette_index(), 0x7FFF);
        assert_eq!(payload.normal(), normal);
        assert!(!payload.is_empty());
        assert!(Payload::default().is_empty());
    }
}
