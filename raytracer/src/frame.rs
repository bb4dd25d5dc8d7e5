//! A finished picture and what was measured beside it.

use crate::color::Light3;

/// No picture is read or asked for that has more pixels than this: they are taken for a slip of the keyboard or a broken
/// file.
pub const MAX_PIXELS: u64 = 1 << 28;

/// A picture, row by row from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Red, green, blue, opacity of each pixel, as displayed (sRGB).
    pub pixels: Vec<[u8; 4]>,
    /// Light of each pixel before exposure and tone mapping, if it was kept.
    pub light: Option<Vec<Light3>>,
    /// Pixels of which a sample met something.
    pub hit_pixels: u64,
    /// What the ray through the middle of each pixel met, if it was asked for.
    pub first_hits: Option<Vec<FirstHit>>,
}

/// What the ray through the middle of a pixel met; of a lens with an opening that from its middle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstHit {
    /// Distance from the eye in the scene; infinite where nothing was met.
    pub distance: f32,
    /// Unit normal in the scene, as it is stored or, of a smoothed voxel, of the smooth surface; zero where nothing was met.
    pub normal: [f32; 3],
    /// Cells that the ray visited, or nodes where it belongs to a beam, where that is counted: of a scene of one model and a camera
    /// without a lens.
    pub steps: u32,
    /// Octree level of the cell that was met.
    pub level: u8,
}

impl FirstHit {
    /// A ray that met nothing.
    pub const NONE: Self = Self { distance: f32::INFINITY, normal: [0.0; 3], steps: 0, level: 0 };
}

/// A picture of something other than colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Aov {
    /// Distance from the eye: bright is near.
    Depth,
    /// Normals: x, y, z from −1 to 1 as red, green, blue from 0 to 255.
    Normal,
    /// Cells that each ray visited, or nodes: bright is many.
    Steps,
    /// Octree level of the cell that was met: bright is fine.
    Level,
}

impl Aov {
    /// Its name on the command line and in file names.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Depth => "depth",
            Self::Normal => "normal",
            Self::Steps => "steps",
            Self::Level => "level",
        }
    }

    /// All of them.
    pub const ALL: [Self; 4] = [Self::Depth, Self::Normal, Self::Steps, Self::Level];
}

impl Frame {
    /// A 64-bit FNV-1a hash of the pixels' bytes: equal pictures have equal hashes.
    #[must_use]
    pub fn hash(&self) -> u64 {
        self.pixels.as_flattened().iter().fold(0xCBF2_9CE4_8422_2325, |hash: u64, &byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01B3)
        })
    }

    /// The picture of an AOV as red, green, blue, opacity; opaque where something was met. Nothing if the frame was
    /// rendered without first hits.
    #[must_use]
    pub fn aov(&self, aov: Aov) -> Option<Vec<[u8; 4]>> {
        let hits = self.first_hits.as_ref()?;
        let gray = |share: f32| [(share.clamp(0.0, 1.0) * 255.0 + 0.5) as u8; 3];
        let (mut nearest, mut farthest) = (f32::INFINITY, 0.0f32);
        let (mut most_steps, mut finest) = (1, 1);
        for hit in hits {
            most_steps = most_steps.max(hit.steps);
            if hit.distance.is_finite() {
                nearest = nearest.min(hit.distance);
                farthest = farthest.max(hit.distance);
                finest = finest.max(hit.level);
            }
        }
        let range = (farthest - nearest).max(f32::MIN_POSITIVE);
        let color = |hit: &FirstHit| match aov {
            Aov::Depth => gray(1.0 - 0.9 * (hit.distance - nearest) / range),
            Aov::Normal => hit.normal.map(|part| gray((part + 1.0) / 2.0)[0]),
            Aov::Steps => gray(hit.steps as f32 / most_steps as f32),
            Aov::Level => gray(f32::from(hit.level) / f32::from(finest)),
        };
        let is_seen = |hit: &FirstHit| hit.distance.is_finite() || aov == Aov::Steps;
        Some(
            hits.iter()
                .map(|hit| {
                    if is_seen(hit) {
                        let [red, green, blue] = color(hit);
                        [red, green, blue, 255]
                    } else {
                        [0; 4]
                    }
                })
                .collect(),
        )
    }
}
