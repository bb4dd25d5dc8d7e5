//! OpenEXR: amounts of light and what the rays met, in channels of floats.
//!
//! Names and meanings are those of "Technical Introduction to OpenEXR": R, G, B are linear light of the primaries of
//! sRGB, multiplied by the opacity A; what stands before a dot is a layer. Beside them there are
//!
//! - `depth.Z`: distance from the eye, infinite where nothing was met;
//! - `normal.X`, `normal.Y`, `normal.Z`: the unit normal, zero where nothing was met;
//! - `level`: octree level of the cell that was met;
//! - `steps`: cells that the ray visited.

use super::{Channel, Content, Picture, checked_size};
use anyhow::{Context, bail, ensure};
use exr::image::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer};
use exr::math::Vec2;
use exr::meta::attribute::{SampleType, Text};
use exr::meta::header::{Header, LayerAttributes};
use exr::prelude::{ReadChannels, ReadLayers, WritableImage, read as reader};
use octvox_raytracer::{FirstHit, Frame, Light3};
use std::fs::File;
use std::io::{BufReader, Seek, Write};

/// The channels of a frame, in the order of their names.
///
/// # Errors
/// If the frame has no light.
pub fn channels(frame: &Frame) -> anyhow::Result<Vec<Channel>> {
    let light = frame.light.as_ref().context("the frame was rendered without keeping its light")?;
    let of_light = |name: &str, part: fn(&Light3) -> f32| Channel {
        name: name.to_owned(),
        samples: light.iter().map(part).collect(),
    };
    let opacity = frame.pixels.iter().map(|pixel| f32::from(pixel[3]) / 255.0).collect();
    let mut channels = vec![
        Channel { name: "A".to_owned(), samples: opacity },
        of_light("B", |light| light.z),
        of_light("G", |light| light.y),
        of_light("R", |light| light.x),
    ];
    if let Some(hits) = &frame.first_hits {
        let of_hits = |name: &str, part: fn(&FirstHit) -> f32| Channel {
            name: name.to_owned(),
            samples: hits.iter().map(part).collect(),
        };
        channels.extend([
            of_hits("depth.Z", |hit| hit.distance),
            of_hits("level", |hit| f32::from(hit.level)),
            of_hits("normal.X", |hit| hit.normal[0]),
            of_hits("normal.Y", |hit| hit.normal[1]),
            of_hits("normal.Z", |hit| hit.normal[2]),
            of_hits("steps", |hit| hit.steps as f32),
        ]);
    }
    Ok(channels)
}

/// Whether the crate may use threads. It starts its own, one for each of the machine.
fn is_parallel() -> bool {
    rayon::current_num_threads() > 1
}

/// Writes channels, 16 rows at a time compressed by deflate (ZIP), which loses nothing.
///
/// # Errors
/// If a channel's name cannot be written, or the file.
pub fn write(
    out: impl Write + Seek,
    [width, height]: [u32; 2],
    channels: Vec<Channel>,
) -> anyhow::Result<()> {
    let channel = |Channel { name, samples }| {
        let text = Text::new_or_none(&name).with_context(|| format!("no name of a channel: {name}"))?;
        anyhow::Ok(AnyChannel::new(text, FlatSamples::F32(samples)))
    };
    let channels = AnyChannels::sort(channels.into_iter().map(channel).collect::<anyhow::Result<_>>()?);
    let size = Vec2(width as usize, height as usize);
    let layer = Layer::new(size, LayerAttributes::default(), Encoding::SMALL_LOSSLESS, channels);
    let image = Image::from_layer(layer);
    let writer = image.write();
    let writer = if is_parallel() { writer } else { writer.non_parallel() };
    writer.to_buffered(out).map_err(bare)
}

/// # Errors
/// If the file is no OpenEXR picture, or one of several parts, of part of a picture, or of something else than floats.
pub fn read(file: File) -> anyhow::Result<Picture> {
    let bytes = file.metadata()?.len();
    let chunks = exr::block::read(BufReader::new(file), false).map_err(bare)?;
    let [header] = chunks.headers() else {
        bail!("it has {} parts, expected one", chunks.headers().len());
    };
    let size = checked_header(header, bytes)?;
    let image = reader().no_deep_data().largest_resolution_level().all_channels().first_valid_layer();
    let image = image.all_attributes();
    let image = if is_parallel() { image } else { image.non_parallel() };
    let image = image.from_chunks(chunks).map_err(bare)?;
    let channels = image.layer_data.channel_data.list.into_iter().map(|channel| Channel {
        name: channel.name.to_string(),
        samples: match channel.sample_data {
            FlatSamples::F32(samples) => samples,
            other => other.values_as_f32().collect(),
        },
    });
    Ok(Picture { size, content: Content::Channels(channels.collect()) })
}

/// The size of a picture that can be read, before memory is taken for it.
fn checked_header(header: &Header, file_bytes: u64) -> anyhow::Result<[u32; 2]> {
    /// Deflate, the densest of the compressions, writes two bits for 258 bytes at best (RFC 1951).
    const MOST_COMPRESSED: u64 = 1032;
    let Vec2(width, height) = header.layer_size;
    let size = checked_size(width as u64, height as u64)?;
    ensure!(!header.deep, "it has several samples a pixel (deep data), expected one");
    let display = header.shared_attributes.display_window;
    let is_whole =
        display.size == header.layer_size && display.position == header.own_attributes.layer_position;
    ensure!(is_whole, "its data window is not the whole picture (its display window)");
    for channel in &header.channels.list {
        let name = &channel.name;
        ensure!(
            channel.sample_type != SampleType::U32,
            "its channel {name} has whole numbers, expected floats"
        );
        ensure!(channel.sampling == Vec2(1, 1), "its channel {name} is subsampled, expected all pixels");
    }
    let promised = u64::from(size[0]) * u64::from(size[1]) * header.channels.bytes_per_pixel as u64;
    ensure!(promised / MOST_COMPRESSED <= file_bytes, "it is shorter than its header says");
    Ok(size)
}

/// An error of the crate, without the name of its kind.
fn bare(error: exr::error::Error) -> anyhow::Error {
    match error {
        exr::error::Error::Io(error) => error.into(),
        exr::error::Error::Invalid(what) => anyhow::anyhow!("it is damaged or no OpenEXR file: {what}"),
        exr::error::Error::NotSupported(what) => {
            anyhow::anyhow!("a kind of OpenEXR that is not read: {what}")
        }
        exr::error::Error::Aborted => anyhow::anyhow!("{error}"),
    }
}
