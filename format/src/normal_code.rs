//! Which of the two codes the normals of a file are in.

use crate::{OctahedralNormal, SphericalNormal};

/// How the two bytes of a normal are to be understood.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum NormalCode {
    /// [`SphericalNormal`], the only code of version 4.
    Spherical,
    /// [`OctahedralNormal`], which is more accurate.
    #[default]
    Octahedral,
}

impl NormalCode {
    /// The code nearest to a direction of any length, as in the file.
    #[must_use]
    #[inline]
    pub fn encode(self, normal: [f32; 3]) -> [u8; 2] {
        match self {
            Self::Spherical => SphericalNormal::encode(normal).to_bytes(),
            Self::Octahedral => OctahedralNormal::encode(normal).to_bytes(),
        }
    }

    /// The unit vector of a code. Every pair of bytes is one.
    #[must_use]
    #[inline]
    pub fn decode(self, code: [u8; 2]) -> [f32; 3] {
        match self {
            Self::Spherical => SphericalNormal::from_bytes(code).decode(),
            Self::Octahedral => OctahedralNormal::from_bytes(code).decode(),
        }
    }

    /// `spherical` or `octahedral`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Spherical => "spherical",
            Self::Octahedral => "octahedral",
        }
    }
}

/// A table from one code to the other: there are only 65,536 normals, and a file has many voxels.
#[derive(Debug)]
pub(crate) struct Recoding {
    /// By the code as a little-endian number; empty if source and target are the same code.
    table: Vec<[u8; 2]>,
}

impl Recoding {
    pub fn new(source: NormalCode, target: NormalCode) -> Self {
        let recode = |bits: u16| target.encode(source.decode(bits.to_le_bytes()));
        let table = if source == target { Vec::new() } else { (0..=u16::MAX).map(recode).collect() };
        Self { table }
    }

    #[inline]
    pub fn apply(&self, code: [u8; 2]) -> [u8; 2] {
        self.table.get(usize::from(u16::from_le_bytes(code))).copied().unwrap_or(code)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_code_is_left_alone() {
        for code in [NormalCode::Spherical, NormalCode::Octahedral] {
            let same = Recoding::new(code, code);
            // Not the canonical code of its direction.
            assert_eq!(same.apply([0, 17]), [0, 17]);
        }
    }

    #[test]
    fn the_other_code_is_the_nearest() {
        let recoding = Recoding::new(NormalCode::Spherical, NormalCode::Octahedral);
        for bits in 0..=u16::MAX {
            let spherical = SphericalNormal::from_bytes(bits.to_le_bytes());
            let octahedral = OctahedralNormal::from_bytes(recoding.apply(spherical.to_bytes()));
            assert_eq!(octahedral, OctahedralNormal::encode(spherical.decode()));
        }
    }
}
