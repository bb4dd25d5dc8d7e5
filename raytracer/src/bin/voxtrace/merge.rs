//! `voxtrace merge`: parts of a picture to the whole.

use crate::picture_file::{Channel, Content, Picture, PictureKind};
use anyhow::{Context, bail, ensure};
use octvox_cli::{CommonArgs, print_json, print_line};
use serde::Serialize;
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// Parts, all PNG or all OpenEXR: each as large as the whole picture and transparent where it shows nothing
    #[arg(value_name = "PART", required = true)]
    parts: Vec<PathBuf>,
    /// The picture to write, of the same kind
    #[arg(short, long, value_name = "PICTURE")]
    output: PathBuf,
    /// Allow pixels that no part shows; they stay transparent
    #[arg(long)]
    partial: bool,
}

const EXAMPLES: &str = "\
Examples:
  voxtrace render bunny.vox --size 640x640 --region 0,0,640,320 -o top.png
  voxtrace render bunny.vox --size 640x640 --region 0,320,640,320 -o bottom.png
  voxtrace merge top.png bottom.png -o bunny.png";

#[derive(Serialize)]
struct Report {
    width: u32,
    height: u32,
    parts: usize,
    /// Those that a part shows.
    pixels: u64,
}

/// Parts put into one picture.
struct Merged {
    picture: Picture,
    /// Number of the first part that shows each pixel.
    shown_by: Vec<Option<u32>>,
}

pub fn run(arguments: &Arguments, common: &CommonArgs) -> anyhow::Result<()> {
    let report = write_merged(arguments)?;
    if common.json {
        return print_json(&report);
    }
    let Report { width, height, parts, pixels } = report;
    let parts_word = if parts == 1 { "part" } else { "parts" };
    print_line(&format!(
        "{}: {width}x{height}, {parts} {parts_word}, {pixels} pixels",
        arguments.output.display()
    ))
}

fn write_merged(arguments: &Arguments) -> anyhow::Result<Report> {
    let Arguments { parts, output, partial } = arguments;
    let kind = PictureKind::of(output)?;
    for part in parts {
        ensure!(
            PictureKind::of(part)? == kind,
            "{} cannot become part of {}; PNG files make a PNG file, OpenEXR files an OpenEXR file",
            part.display(),
            output.display()
        );
    }
    let Merged { picture, shown_by } = merge(parts)?;
    let [width, height] = picture.size;
    let missing = shown_by.iter().filter(|part| part.is_none()).count();
    if let Some(first) = shown_by.iter().position(Option::is_none).filter(|_| !partial) {
        bail!(
            "{}: {missing} of {} pixels are shown by no part, the first at {}; add the parts that show them, or use --partial",
            output.display(),
            shown_by.len(),
            position(first, width)
        );
    }
    picture.write(output)?;
    Ok(Report { width, height, parts: parts.len(), pixels: (shown_by.len() - missing) as u64 })
}

/// Puts parts into one picture; pixels that none shows are those of the first.
fn merge(paths: &[PathBuf]) -> anyhow::Result<Merged> {
    let (first, rest) = paths.split_first().context("there are no parts")?;
    let picture = Picture::read(first)?;
    let shown_by = shown(&picture, first)?.map(|is_shown| is_shown.then_some(0)).collect();
    let mut merged = Merged { picture, shown_by };
    for (number, path) in (1..).zip(rest) {
        let part = Picture::read(path)?;
        check_alike(&merged.picture, &part, first, path)?;
        for (place, is_shown) in shown(&part, path)?.enumerate() {
            match merged.shown_by[place] {
                _ if !is_shown => {}
                None => {
                    copy_pixel(&mut merged.picture.content, &part.content, place);
                    merged.shown_by[place] = Some(number);
                }
                Some(other) => ensure!(
                    is_same_pixel(&merged.picture.content, &part.content, place),
                    "{} and {} both show the pixel at {} and differ; render both again with the same settings",
                    paths[other as usize].display(),
                    path.display(),
                    position(place, part.size[0])
                ),
            }
        }
    }
    Ok(merged)
}

/// Whether each pixel of a part is other than transparent.
fn shown<'a>(part: &'a Picture, path: &Path) -> anyhow::Result<Box<dyn Iterator<Item = bool> + 'a>> {
    if let Content::Displayed(pixels) = &part.content {
        return Ok(Box::new(pixels.iter().map(|pixel| pixel[3] != 0)));
    }
    let opacity = part.content.channel("A");
    let opacity = opacity
        .with_context(|| format!("{}: there is no channel A, which tells what it shows", path.display()))?;
    Ok(Box::new(opacity.iter().map(|&opacity| opacity != 0.0)))
}

/// Whether two pictures can be parts of one.
fn check_alike(one: &Picture, other: &Picture, one_path: &Path, other_path: &Path) -> anyhow::Result<()> {
    let ([width, height], [other_width, other_height]) = (one.size, other.size);
    ensure!(
        one.size == other.size,
        "{} is {width}x{height}, {} is {other_width}x{other_height}; each part is as large as the whole picture",
        one_path.display(),
        other_path.display()
    );
    if let (Content::Channels(channels), Content::Channels(other_channels)) = (&one.content, &other.content) {
        let names = |channels: &[Channel]| {
            channels.iter().map(|channel| channel.name.as_str()).collect::<Vec<_>>().join(", ")
        };
        let (names, other_names) = (names(channels), names(other_channels));
        ensure!(
            names == other_names,
            "{} has the channels {names}, {} has {other_names}; render both again with the same settings",
            one_path.display(),
            other_path.display()
        );
    }
    Ok(())
}

/// Equal to the bit, so that numbers that are none are equal to themselves.
fn is_same_pixel(one: &Content, other: &Content, place: usize) -> bool {
    match (one, other) {
        (Content::Displayed(one), Content::Displayed(other)) => one[place] == other[place],
        (Content::Channels(one), Content::Channels(other)) => one
            .iter()
            .zip(other)
            .all(|(one, other)| one.samples[place].to_bits() == other.samples[place].to_bits()),
        _ => false,
    }
}

fn copy_pixel(to: &mut Content, from: &Content, place: usize) {
    match (to, from) {
        (Content::Displayed(to), Content::Displayed(from)) => to[place] = from[place],
        (Content::Channels(to), Content::Channels(from)) => {
            for (to, from) in to.iter_mut().zip(from) {
                to.samples[place] = from.samples[place];
            }
        }
        // The kinds of all parts have been compared.
        _ => {}
    }
}

/// Column and row of a pixel, as in `--region`.
fn position(place: usize, width: u32) -> String {
    let width = width as usize;
    format!("{},{}", place % width, place / width)
}

#[cfg(test)]
mod tests;
