//! Sentences of the page.

use super::super::front::{Front, NEAR};
use super::escape::escape;
use super::number::figure;

/// A number of things: "1 setting", "40 settings".
pub fn count(number: usize, thing: &str) -> String {
    let ending = if number == 1 { "" } else { "s" };
    format!("{} {thing}{ending}", octvox_cli::grouped(number as u64))
}

/// How far a setting is from the front, as a sentence; empty for one that is not on the plot.
pub fn distance(front: &Front, setting: usize) -> String {
    match front.distance(setting) {
        None => String::new(),
        Some(_) if front.contains(setting) => "It is on the front.".to_string(),
        Some(1.0) => "It is as good as one on the front.".to_string(),
        Some(distance) if distance <= NEAR => {
            format!("It is within {} % of the front.", figure((distance - 1.0) * 100.0))
        }
        Some(distance) => format!("It is off the front by a factor of {}.", figure(distance)),
    }
}

/// What the columns of the tables mean.
const GLOSSARY: [(&str, &str); 14] = [
    (
        "Time, least, most",
        "Of a picture, without loading and converting: the median of repeated measurements, and the least and \
         the greatest of them. Each picture is made in turns with the default one and told as a multiple of that, \
         whose time is the median over the whole study: what slows the machine for a while slows both.",
    ),
    ("Instructions", "Of the processor, in all threads, for a picture, where the machine counts them."),
    ("Rays", "Of all kinds for a picture: from the eye, to lamps, mirrored, refracted, around."),
    ("Steps", "Cells of the octree that the first ray of each pixel visited, all together."),
    ("Octree", "What the octree takes in memory. A MiB is 1,048,576 bytes."),
    (
        "Preparation",
        "Time to convert the model and to load it; nothing where the octree is that of another setting.",
    ),
    (
        "FLIP",
        "How much two pictures differ when they are shown in turn at the same place, as seen by a person: the \
         mean over all pixels, 0 for equal pictures and at most 1 (Andersson and others, “ꟻLIP: A Difference \
         Evaluator for Alternating Images”, 2020).",
    ),
    (
        "1 − SSIM",
        "Structural similarity, taken from 1: 0 for equal pictures, near 1 for unrelated ones (Wang and \
         others, “Image Quality Assessment: From Error Visibility to Structural Similarity”, 2004).",
    ),
    ("Colour", "Root mean square of the differences of displayed values, which reach from 0 to 255."),
    (
        "Depth in voxels",
        "Root mean square of the differences of distances from the eye, in sides of a voxel of the setting, \
         over pixels in which both pictures show something.",
    ),
    ("Depth in pixels", "The same relative to what a pixel covers at that distance."),
    ("Normal", "Mean angle between the normals, over pixels in which both pictures show something."),
    ("Outline", "Share of the pixels in which just one of the two pictures shows something."),
    ("Other voxel", "Share of the pixels whose ray meets another voxel."),
];

/// The section that explains the figures.
pub fn glossary() -> String {
    let mut html =
        "<section id=\"glossary\">\n<h2>What the figures mean</h2>\n<dl class=\"glossary\">\n".to_string();
    for (word, meaning) in GLOSSARY {
        html += &format!("<dt>{}</dt><dd>{}</dd>\n", escape(word), escape(meaning));
    }
    html + "</dl>\n</section>\n"
}
