//! What can be wrong with a scene file, and where.

use crate::CameraError;
use std::path::PathBuf;

/// Why a scene file does not describe a picture.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneFileError {
    /// The file cannot be read.
    #[error("{}: cannot read: {source}", path.display())]
    Read {
        /// The scene file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// Something that the file says.
    #[error("{}:{line}:{column}: {problem}", path.display())]
    At {
        /// The scene file.
        path: PathBuf,
        /// Counted from 1.
        line: usize,
        /// Characters, counted from 1.
        column: usize,
        /// What is wrong there.
        problem: SceneProblem,
    },
}

/// What is wrong at a place of a scene file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneProblem {
    /// Not TOML, a key that is not known, or a value that its key cannot have.
    #[error("{0}")]
    Invalid(String),
    /// The file has no model.
    #[error("there is nothing to see; add a [[model]] with a `name` and a `file`")]
    NoModel,
    /// A name is empty.
    #[error("`{key}` is empty; give a name")]
    EmptyName {
        /// The key.
        key: &'static str,
    },
    /// Two models have one name.
    #[error("there is already a model `{name}`; give each another name")]
    SameName {
        /// The name.
        name: String,
    },
    /// No model has this name.
    #[error("there is no model `{name}`; the file has {known}")]
    UnknownModel {
        /// The name.
        name: String,
        /// The names that there are.
        known: String,
    },
    /// A `.vox` cannot be converted.
    #[error("`resolution` is for meshes, a .vox file has its own; leave it out")]
    ResolutionOfVox,
    /// The palette has no such entry.
    #[error("the palette of model `{model}` has no entry {entry}; its entries are 1 to {last}")]
    NoEntry {
        /// The model's name.
        model: String,
        /// The palette index.
        entry: u16,
        /// The last palette index.
        last: usize,
    },
    /// No entry of the palette has this colour.
    #[error(
        "no entry of the palette of model `{model}` has the colour {color}; \
         `voxinfo --histogram` shows the colours that there are"
    )]
    NoColor {
        /// The model's name.
        model: String,
        /// The colour as #rrggbb.
        color: String,
    },
    /// Nothing is chosen.
    #[error("this changes no entry of the palette of model `{model}`; choose one or leave it out")]
    NothingChosen {
        /// The model's name.
        model: String,
    },
    /// A key that is of no use here.
    #[error("`{key}` is of no use for {of}; {advice}")]
    Useless {
        /// The key.
        key: &'static str,
        /// What it stands in.
        of: &'static str,
        /// What to do.
        advice: String,
    },
    /// A key that is needed here.
    #[error("{of} needs `{key}`; add it")]
    Lacking {
        /// The key.
        key: &'static str,
        /// What it should stand in.
        of: &'static str,
    },
    /// Two keys that say the same.
    #[error("`{key}` and `{other}` exclude each other; leave one of them out")]
    Both {
        /// One key.
        key: &'static str,
        /// The other.
        other: &'static str,
    },
    /// Key frames out of order.
    #[error("frame {frame} does not come after frame {previous}; give key frames in ascending order")]
    FrameOrder {
        /// The frame.
        frame: u32,
        /// That of the key before.
        previous: u32,
    },
    /// A value for the first frame both outside of the keys and in one.
    #[error("`{key}` of frame 0 is also given outside of the key frames; leave one of them out")]
    TwiceAtFirst {
        /// The key.
        key: &'static str,
    },
    /// Two numbers out of order.
    #[error("{what} {low} is more than {high}; give the smaller number first")]
    Order {
        /// What the numbers are.
        what: &'static str,
        /// The number that should be the smaller.
        low: f64,
        /// The number that should be the larger.
        high: f64,
    },
    /// An area light without an area.
    #[error("`right` and `up` are along each other, so the lamp has no area; give two different directions")]
    NoArea,
    /// A scattered area without an extent.
    #[error("the area is empty; give [xmin, zmin, xmax, zmax], each minimum below its maximum")]
    EmptyArea,
    /// Too much for an area.
    #[error(
        "only {placed} of {count} found a place at a distance of {distance}; \
         make the area larger, the distance smaller or the count"
    )]
    TooDense {
        /// How many should stand there.
        count: u32,
        /// How many do.
        placed: u32,
        /// The least distance.
        distance: f64,
    },
    /// The camera sees nothing.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// Fewer rays at most than at least.
    #[error("`most_samples` {most} is less than `samples` {least}; raise it or leave it out")]
    Samples {
        /// The most.
        most: u32,
        /// The least.
        least: u32,
    },
    /// No way of displaying has this name.
    #[error("there is no tone `{name}`; it is one of {known}")]
    UnknownTone {
        /// The name.
        name: String,
        /// The names that there are.
        known: String,
    },
    /// A picture of the surroundings that cannot be used.
    #[error("{}: {reason}", picture.display())]
    Picture {
        /// Its file.
        picture: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
}
