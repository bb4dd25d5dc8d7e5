//! Values between key frames.

use super::error::{SceneFileError, SceneProblem};
use super::text::Text;
use super::value::FrameNumber;
use glam::DVec3;
use toml::Spanned;

/// Values at key frames, in ascending order. Before the first and after the last nothing changes.
#[derive(Debug, Clone)]
pub(super) struct Track<T> {
    keys: Vec<(u32, T)>,
}

/// Where a frame is between two key frames.
struct Between {
    /// The key at or before it.
    key: usize,
    /// 0 at that key, 1 at the next.
    share: f64,
}

impl<T: Copy> Track<T> {
    /// `own` is the value outside of the key frames, which is that of frame 0.
    pub fn new(
        text: &Text,
        name: &'static str,
        own: Option<T>,
        keys: impl IntoIterator<Item = (u32, Option<Spanned<T>>)>,
    ) -> Result<Self, SceneFileError> {
        let mut track = Self { keys: own.map(|own| (0, own)).into_iter().collect() };
        for (frame, value) in keys {
            let Some(value) = value else { continue };
            if frame == 0 && own.is_some() {
                return Err(text.error(&value.span(), SceneProblem::TwiceAtFirst { key: name }));
            }
            track.keys.push((frame, value.into_inner()));
        }
        Ok(track)
    }

    /// The value at a frame, straight from key to key; `None` if there are no keys.
    pub fn at(&self, frame: u32, blend: impl Fn(T, T, f64) -> T) -> Option<T> {
        let Between { key, share } = self.between(frame)?;
        let value = self.keys[key].1;
        Some(if share > 0.0 { blend(value, self.keys[key + 1].1, share) } else { value })
    }

    fn between(&self, frame: u32) -> Option<Between> {
        let after = self.keys.partition_point(|(key, _)| *key <= frame);
        let (first, last) = (0, self.keys.len().checked_sub(1)?);
        if after == first || after > last {
            return Some(Between { key: if after == first { first } else { last }, share: 0.0 });
        }
        let [from, to] = [self.keys[after - 1].0, self.keys[after].0];
        Some(Between { key: after - 1, share: f64::from(frame - from) / f64::from(to - from) })
    }
}

impl Track<DVec3> {
    /// The point at a frame on a smooth curve through those of the keys (Catmull and Rom, "A class of local interpolating
    /// splines", 1974), whose speed at a key is the mean from the key before to the one after.
    pub fn smooth(&self, frame: u32) -> Option<DVec3> {
        let Between { key, share: t } = self.between(frame)?;
        let (from, start) = self.keys[key];
        if t == 0.0 {
            return Some(start);
        }
        let (to, end) = self.keys[key + 1];
        let speed = |key: usize| {
            let (before, after) =
                (self.keys[key.saturating_sub(1)], self.keys[(key + 1).min(self.keys.len() - 1)]);
            (after.1 - before.1) / f64::from(after.0 - before.0)
        };
        let length = f64::from(to - from);
        let (leaving, arriving) = (speed(key) * length, speed(key + 1) * length);
        let squared = t * t;
        let cubed = squared * t;
        // Hermite's polynomials.
        Some(
            start * (2.0 * cubed - 3.0 * squared + 1.0)
                + leaving * (cubed - 2.0 * squared + t)
                + end * (3.0 * squared - 2.0 * cubed)
                + arriving * (cubed - squared),
        )
    }
}

/// The frames of a list of keys, which must ascend.
pub(super) fn frames(
    text: &Text,
    keys: impl IntoIterator<Item = Spanned<FrameNumber>>,
) -> Result<Vec<u32>, SceneFileError> {
    let mut frames: Vec<u32> = Vec::new();
    for key in keys {
        let frame = key.get_ref().0;
        if let Some(&previous) = frames.last().filter(|previous| **previous >= frame) {
            return Err(text.error(&key.span(), SceneProblem::FrameOrder { frame, previous }));
        }
        frames.push(frame);
    }
    Ok(frames)
}
