//! What a study has found: as it is kept between runs, and as the report shows it.

use serde::{Deserialize, Serialize};

/// A whole study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Study {
    /// Name of the model or scene, as a heading.
    pub title: String,
    /// The command that makes this study.
    pub command: String,
    /// Whether it is the short one.
    pub is_quick: bool,
    pub machine: Machine,
    /// Columns and rows of the pictures.
    pub size: [u32; 2],
    /// What errors are measured against, in a sentence; or why there is no truth.
    pub truth: String,
    /// The picture of the truth, a file name within the folder.
    pub truth_picture: Option<String>,
    /// In the order in which the report shows them.
    pub knobs: Vec<Knob>,
    /// Of all knobs; those of one knob stand together, from coarse to exact.
    pub settings: Vec<Setting>,
    /// Hard rays, tables of the thesis and others, in groups with a heading each.
    pub chapters: Vec<Chapter>,
}

/// Where it was measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    pub processor: String,
    pub threads: usize,
    /// What the program was built for.
    pub instruction_set: String,
    pub memory_bytes: u64,
    pub system: String,
    /// Version of the program.
    pub program: String,
}

/// Something that can be approximated more or less.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Knob {
    /// Short name, which settings refer to: `lod`.
    pub name: String,
    /// A heading: "Level of detail".
    pub title: String,
    /// What the place of a setting on the axis means: "pixels".
    pub axis: String,
    pub is_logarithmic: bool,
    /// What is approximated and what all settings have in common, in a few sentences.
    pub explanation: String,
    /// Why the default is what it is, in one sentence; empty if none of the settings is a default.
    pub default_reason: String,
    /// Whether its settings are points of the first plot, error over time: they make whole pictures of everything.
    pub is_on_front: bool,
}

/// One setting of a knob, measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Setting {
    /// [`Knob::name`].
    pub knob: String,
    /// As it is written: "0.5 pixels".
    pub label: String,
    /// Place on the knob's axis.
    pub place: f64,
    pub is_default: bool,
    pub is_exact: bool,
    pub cost: Cost,
    pub against_exact: Option<Errors>,
    pub against_truth: Option<Errors>,
    /// The picture, a file name within the folder.
    pub picture: Option<String>,
    /// How it differs from the truth, or without one from the exact setting: a file name within the folder.
    pub difference: Option<String>,
    /// The command that makes this picture.
    pub command: String,
}

/// What a setting costs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Cost {
    /// For a picture, in seconds.
    pub seconds: Spread,
    /// How many times that of the default picture, made in turns with it; nothing where that was not measured.
    pub relative: Option<Spread>,
    /// For a picture, where the machine counts them.
    pub instructions: Option<u64>,
    /// Rays of all kinds.
    pub rays: u64,
    /// Cells that the first ray of each pixel visited, all together.
    pub steps: u64,
    /// Memory of the octree.
    pub bytes: u64,
    /// To convert and load, in seconds; 0 where the octree is that of another setting.
    pub preparation: f64,
}

/// Of repeated measurements.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    pub median: f64,
    pub least: f64,
    pub most: f64,
    pub repetitions: u32,
}

impl Spread {
    /// Of some times; all 0 if there are none.
    pub fn of(mut seconds: Vec<f64>) -> Self {
        seconds.sort_unstable_by(f64::total_cmp);
        let at = |index: usize| seconds.get(index).copied().unwrap_or(0.0);
        Self {
            median: at(seconds.len() / 2),
            least: at(0),
            most: at(seconds.len().saturating_sub(1)),
            repetitions: seconds.len() as u32,
        }
    }

    /// All of them so many times.
    pub fn times(self, factor: f64) -> Self {
        let [median, least, most] = [self.median, self.least, self.most].map(|seconds| seconds * factor);
        Self { median, least, most, ..self }
    }
}

/// How far a picture is from another.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// Root mean square of the distances' differences where both see something, in voxels of the setting.
    pub depth_voxels: f64,
    /// The same in pixels: relative to the footprint of a pixel there.
    pub depth_pixels: f64,
    /// Mean angle between the normals where both see something, in degrees.
    pub normal_degrees: f64,
    /// Root mean square of the differences of displayed values, from 0 to 255.
    pub color: f64,
    /// Structural similarity, 1 for equal pictures.
    pub ssim: f64,
    /// Mean of ꟻLIP, 0 for equal pictures.
    pub flip: f64,
    /// Share of pixels in which just one of the two sees something.
    pub silhouette: f64,
    /// Share of pixels whose ray meets another voxel, if that was compared.
    pub other_voxels: Option<f64>,
}

/// Tables under a heading.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Chapter {
    pub title: String,
    /// In a few sentences.
    pub introduction: String,
    pub tables: Vec<Table>,
}

/// A table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Table {
    pub title: String,
    /// Under the table: what figures mean, where they come from.
    pub note: String,
    pub columns: Vec<String>,
    pub rows: Vec<Vec<String>>,
}
