//! How an image lies on a surface, and which of its values counts.

/// An image laid onto a surface by texture coordinates.
///
/// A point with texture coordinates `(u, v)` shows the image at `offset + scale · (u, v)`, where u goes from 0 at the left
/// edge to 1 at the right, and v from 0 at the **bottom** edge to 1 at the top. Every value `x` of the image (0 to 1) is
/// taken as `base + gain · x`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TextureMap {
    /// Index into the images of the mesh.
    pub image: usize,
    /// Added to the scaled coordinates (`-o`).
    pub offset: [f32; 2],
    /// Multiplies the coordinates (`-s`).
    pub scale: [f32; 2],
    /// What lies beyond the edges, along u and v.
    pub wrap: [Wrap; 2],
    /// Which value of the image counts.
    pub channel: Channel,
    /// Added to every value (the first number of `-mm`).
    pub base: f32,
    /// Multiplies every value (the second number of `-mm`).
    pub gain: f32,
}

/// What a texture shows beyond its edges.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Wrap {
    /// The same again.
    #[default]
    Repeat,
    /// Its outermost pixels.
    Clamp,
    /// Its mirror image, then the same again.
    Mirror,
}

/// Which value of a pixel counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Channel {
    /// Red, green and blue; their luminance where a single number is needed.
    #[default]
    Color,
    /// Red.
    Red,
    /// Green.
    Green,
    /// Blue.
    Blue,
    /// Alpha.
    Alpha,
    /// Brightness: a weighted mean of red, green and blue.
    Luminance,
}

impl TextureMap {
    /// An image as it is, repeated, once for each unit of the texture coordinates.
    #[must_use]
    pub const fn new(image: usize) -> Self {
        Self {
            image,
            offset: [0.0; 2],
            scale: [1.0; 2],
            wrap: [Wrap::Repeat; 2],
            channel: Channel::Color,
            base: 0.0,
            gain: 1.0,
        }
    }
}
