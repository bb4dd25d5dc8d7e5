//! Pictures in files, of the kind that the file's extension says.

mod exr;
mod png;

use anyhow::{Context, bail, ensure};
use octvox_cli::write_atomically;
use octvox_raytracer::{Frame, MAX_PIXELS};
use std::fs::File;
use std::path::Path;

/// How a file holds a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PictureKind {
    /// Eight bits a channel, as displayed.
    Png,
    /// Amounts of light and what the rays met, as floats.
    Exr,
}

impl PictureKind {
    fn name(self) -> &'static str {
        match self {
            Self::Png => "PNG",
            Self::Exr => "OpenEXR",
        }
    }

    /// # Errors
    /// If the extension is that of no kind.
    pub fn of(path: &Path) -> anyhow::Result<Self> {
        let is = |wanted: &str| path.extension().is_some_and(|found| found.eq_ignore_ascii_case(wanted));
        match () {
            () if is("png") => Ok(Self::Png),
            () if is("exr") => Ok(Self::Exr),
            () => bail!(
                "{}: pictures are PNG or OpenEXR files, name one that ends in .png or .exr",
                path.display()
            ),
        }
    }
}

/// A picture as its file holds it.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Columns and rows.
    pub size: [u32; 2],
    /// Row by row from the top.
    pub content: Content,
}

/// What a picture holds of each pixel.
#[derive(Debug, Clone, PartialEq)]
pub enum Content {
    /// Red, green, blue, opacity, as displayed (sRGB).
    Displayed(Vec<[u8; 4]>),
    /// Numbers, each kind in a channel of its own, in the order of the channels' names.
    Channels(Vec<Channel>),
}

/// A number for each pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    pub name: String,
    pub samples: Vec<f32>,
}

impl Content {
    pub fn kind(&self) -> PictureKind {
        match self {
            Self::Displayed(_) => PictureKind::Png,
            Self::Channels(_) => PictureKind::Exr,
        }
    }

    /// The numbers of a channel.
    pub fn channel(&self, name: &str) -> Option<&[f32]> {
        match self {
            Self::Displayed(_) => None,
            Self::Channels(channels) => {
                let channel = channels.iter().find(|channel| channel.name == name)?;
                Some(&channel.samples)
            }
        }
    }
}

impl Picture {
    /// What a file of this kind holds of a frame.
    ///
    /// # Errors
    /// If light is to be kept that the frame does not have.
    pub fn of_frame(frame: &Frame, kind: PictureKind) -> anyhow::Result<Self> {
        let content = match kind {
            PictureKind::Png => Content::Displayed(frame.pixels.clone()),
            PictureKind::Exr => Content::Channels(exr::channels(frame)?),
        };
        Ok(Self { size: [frame.width, frame.height], content })
    }

    /// # Errors
    /// If the file cannot be read, or is not the picture that its extension says.
    pub fn read(path: &Path) -> anyhow::Result<Self> {
        let kind = PictureKind::of(path)?;
        let read = || {
            let file = File::open(path)?;
            match kind {
                PictureKind::Png => png::read(file),
                PictureKind::Exr => exr::read(file),
            }
        };
        read().with_context(|| format!("{}: cannot read the picture", path.display()))
    }

    /// # Errors
    /// If the extension is not that of what the picture holds, or the file cannot be written.
    pub fn write(self, path: &Path) -> anyhow::Result<()> {
        let (kind, holds) = (PictureKind::of(path)?, self.content.kind());
        ensure!(kind == holds, "{}: the picture is one for a {} file", path.display(), holds.name());
        match self.content {
            Content::Displayed(pixels) => write_png(path, self.size, &pixels),
            Content::Channels(channels) => write_atomically(path, |out| exr::write(out, self.size, channels)),
        }
    }
}

/// Writes a frame as the kind of picture that the extension says.
pub fn write_frame(path: &Path, frame: &Frame) -> anyhow::Result<()> {
    match PictureKind::of(path)? {
        PictureKind::Png => write_png(path, [frame.width, frame.height], &frame.pixels),
        kind => Picture::of_frame(frame, kind).with_context(|| path.display().to_string())?.write(path),
    }
}

/// Writes pixels as a PNG file.
pub fn write_png(path: &Path, size: [u32; 2], pixels: &[[u8; 4]]) -> anyhow::Result<()> {
    write_atomically(path, |out| png::write(out, size, pixels))
}

/// A size that a header says, before memory is taken for it.
fn checked_size(width: u64, height: u64) -> anyhow::Result<[u32; 2]> {
    let size = u32::try_from(width).ok().zip(u32::try_from(height).ok());
    match size {
        Some((columns, rows)) if width * height <= MAX_PIXELS => Ok([columns, rows]),
        _ => bail!("it says that it has {width}x{height} pixels, more than {MAX_PIXELS}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use octvox_raytracer::{FirstHit, Light3};

    /// A frame with odd numbers in it.
    pub fn frame(first_hits: bool) -> Frame {
        let (width, height) = (37, 21);
        let area = 0..width * height;
        let light = |at: u32| Light3::new(at as f32 / 7.0, 1e-30 * at as f32, 65_504.0 * 4.0);
        let met = |at: u32| {
            if at.is_multiple_of(3) {
                return FirstHit { steps: at, ..FirstHit::NONE };
            }
            FirstHit { distance: at as f32 / 3.0, normal: [0.6, 0.0, -0.8], steps: 1 << 20 | at, level: 23 }
        };
        Frame {
            width,
            height,
            pixels: area.clone().map(|at| [at as u8, 1, 254, 255]).collect(),
            light: Some(area.clone().map(light).collect()),
            hit_pixels: 0,
            first_hits: first_hits.then(|| area.map(met).collect()),
        }
    }

    fn line(error: &anyhow::Error) -> String {
        format!("{error:#}")
    }

    #[test]
    fn what_is_written_is_read() {
        let folder = tempfile::tempdir().unwrap();
        for (name, first_hits) in [("a.png", false), ("a.EXR", false), ("b.exr", true)] {
            let path = folder.path().join(name);
            let frame = frame(first_hits);
            write_frame(&path, &frame).unwrap();
            let picture = Picture::read(&path).unwrap();
            assert!(picture == Picture::of_frame(&frame, PictureKind::of(&path).unwrap()).unwrap(), "{name}");
            let again = folder.path().join(format!("again-{name}"));
            picture.write(&again).unwrap();
            assert!(std::fs::read(&path).unwrap() == std::fs::read(again).unwrap(), "{name}");
        }
    }

    #[test]
    fn channels_are_those_of_the_frame() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let frame = frame(true);
        write_frame(&path, &frame).unwrap();
        let Picture { size, content } = Picture::read(&path).unwrap();
        assert_eq!(size, [frame.width, frame.height]);
        let sample = |name: &str, at: usize| content.channel(name).unwrap()[at];
        for (at, hit) in frame.first_hits.as_ref().unwrap().iter().enumerate() {
            let light = frame.light.as_ref().unwrap()[at];
            assert_eq!(["R", "G", "B"].map(|name| sample(name, at)), light.to_array());
            assert_eq!(["normal.X", "normal.Y", "normal.Z"].map(|name| sample(name, at)), hit.normal);
            let rest = ["A", "depth.Z", "level", "steps"].map(|name| sample(name, at));
            assert_eq!(rest, [1.0, hit.distance, f32::from(hit.level), hit.steps as f32]);
        }
        assert!(content.channel("Z").is_none());
    }

    #[test]
    fn a_file_does_not_depend_on_threads() {
        let folder = tempfile::tempdir().unwrap();
        let files = [1, 3].map(|threads| {
            let path = folder.path().join(format!("{threads}.exr"));
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| write_frame(&path, &frame(true))).unwrap();
            std::fs::read(path).unwrap()
        });
        assert!(files[0] == files[1]);
    }

    #[test]
    fn other_extensions_are_errors() {
        for path in ["a.jpg", "a", ".png"] {
            let expected =
                format!("{path}: pictures are PNG or OpenEXR files, name one that ends in .png or .exr");
            assert_eq!(line(&write_frame(path.as_ref(), &frame(false)).unwrap_err()), expected);
            assert_eq!(line(&Picture::read(path.as_ref()).unwrap_err()), expected);
        }
    }

    #[test]
    fn nothing_is_written_of_a_frame_without_light() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let frame = Frame { light: None, ..frame(false) };
        let error = line(&write_frame(&path, &frame).unwrap_err());
        assert_eq!(error, format!("{}: the frame was rendered without keeping its light", path.display()));
        let displayed = Picture::of_frame(&frame, PictureKind::Png).unwrap();
        assert!(line(&displayed.write(&path).unwrap_err()).contains("one for a PNG file"));
        assert!(!path.exists());
    }

    /// Every truncation, and every changed byte: an error or a picture.
    fn damage(path: &Path) {
        let whole = std::fs::read(path).unwrap();
        for end in 0..whole.len() {
            std::fs::write(path, &whole[..end]).unwrap();
            let read = Picture::read(path);
            // The last chunk of a PNG says only that it is the last.
            assert!(read.is_err() || end + 12 >= whole.len(), "{} bytes of {}", end, path.display());
        }
        for at in 0..whole.len() {
            for change in [1, 0x80, 0xFF] {
                let mut bytes = whole.clone();
                bytes[at] ^= change;
                std::fs::write(path, &bytes).unwrap();
                if let Err(error) = Picture::read(path) {
                    assert!(
                        line(&error).starts_with(&format!("{}: cannot read the picture: ", path.display()))
                    );
                }
            }
        }
    }

    #[test]
    fn damaged_files_are_no_panics() {
        let folder = tempfile::tempdir().unwrap();
        let frame = frame(false);
        let rows = 18 * frame.width as usize;
        let light = frame.light.map(|light| light[..rows].to_vec());
        let small = Frame { height: 18, pixels: frame.pixels[..rows].to_vec(), light, ..frame };
        let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        for name in ["a.png", "a.exr"] {
            let path = folder.path().join(name);
            write_frame(&path, &small).unwrap();
            alone.install(|| damage(&path));
        }
    }

    #[test]
    fn more_pixels_than_can_be_rendered_are_not_read() {
        assert_eq!(checked_size(1 << 14, 1 << 14).unwrap(), [1 << 14, 1 << 14]);
        for size in [[1 << 14, (1 << 14) + 1], [1 << 33, 0], [u64::MAX, u64::MAX]] {
            assert!(checked_size(size[0], size[1]).is_err());
        }
    }
}
