//! Compares ways to make a palette: their error in Oklab and their time.
//!
//!     cargo bench -p octvox-converter --bench palettes -- [PICTURE.png …]
//!
//! Always on ten million different colours (generated), and on the pictures that are named. `PALETTE.md` has the results.
//! `cut + k-means` is what `obj2vox` does; `merge` is what Bohnen 2009 does, in Oklab; `quantette` is the crate of that
//! name, which makes palettes of up to 256 colours.

// The modules of the library bring more than is needed here, and tests that a program without a harness does not run.
#![allow(dead_code, unused_imports)]

mod merge;
mod quantette_crate;

#[path = "../../src/color_set.rs"]
mod color_set;
#[path = "../../src/color_space.rs"]
mod color_space;
#[path = "../../src/kd_tree.rs"]
mod kd_tree;
#[path = "../../src/nearest_color.rs"]
mod nearest_color;
#[path = "../../src/palette_cut.rs"]
mod palette_cut;
#[path = "../../src/palette_kmeans.rs"]
mod palette_kmeans;
#[path = "../../src/palette_reduction.rs"]
mod palette_reduction;

use color_space::{oklab_to_displayed, to_oklab};
use nearest_color::NearestColor;
use octvox_cli::Progress;
use palette_cut::{WeightedColor, cut};
use palette_kmeans::refine;
use palette_reduction::{Family, reduce};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::time::Instant;

/// Different colours, ascending, and how often each is used.
struct Colors {
    colors: Vec<[u8; 3]>,
    counts: Vec<u64>,
}

fn main() -> Result<(), image::ImageError> {
    // Cargo adds `--bench`.
    for path in std::env::args().skip(1).filter(|argument| !argument.starts_with('-')) {
        let picture = image::open(&path)?.into_rgb8();
        println!("\n{}", path);
        compare(&of_picture(&picture), &[256, 2048]);
    }
    println!("\ngenerated");
    compare(&ten_million(), &[256, 32_767]);
    Ok(())
}

fn compare(colors: &Colors, sizes: &[usize]) {
    println!("{} colours, {} uses", colors.colors.len(), colors.counts.iter().sum::<u64>());
    println!("{:>8}  {:16} {:>12} {:>10} {:>8}", "entries", "method", "RMS (Oklab)", "largest", "seconds");
    for &size in sizes.iter().filter(|size| **size < colors.colors.len()) {
        let merged =
            report(colors, size, "merge", || merge::merge_colors(&colors.colors, &colors.counts, size).0);
        report(colors, size, "merge + k-means", || lloyd(colors, &merged, 8));
        report(colors, size, "cut", || {
            let mut weighted: Vec<_> = (0..colors.colors.len()).map(|index| colors.weighted(index)).collect();
            let all = 0..weighted.len();
            cut(&mut weighted, &[all], size).concat().into_iter().map(oklab_to_displayed).collect()
        });
        report(colors, size, "cut + k-means", || {
            let family = Family { colors: &colors.colors, voxels: &colors.counts };
            reduce(&[family], size, &Progress::hidden()).remove(0).palette
        });
        if let Ok(size) = u16::try_from(size)
            && size <= 256
        {
            report(colors, size.into(), "quantette Wu", || quantette_crate::wu(colors, size));
            report(colors, size.into(), "quantette k-means", || quantette_crate::kmeans(colors, size));
        }
    }
}

/// Times a method, and measures the palette with every colour at its nearest entry.
fn report(colors: &Colors, size: usize, method: &str, make: impl FnOnce() -> Vec<[u8; 3]>) -> Vec<[u8; 3]> {
    let start = Instant::now();
    let palette = make();
    let seconds = start.elapsed().as_secs_f64();
    let entries: Vec<[f32; 3]> = palette.iter().map(|&color| to_oklab(color)).collect();
    let nearest = NearestColor::new(&entries, colors.colors.len());
    let (sum, largest) = colors
        .colors
        .par_iter()
        .zip(&colors.counts)
        .map(|(&color, &count)| {
            let oklab = to_oklab(color);
            let entry = entries[nearest.nearest(oklab)];
            let square: f64 = (0..3).map(|axis| f64::from(oklab[axis] - entry[axis]).powi(2)).sum();
            (square * count as f64, square)
        })
        .reduce(|| (0.0, 0.0), |a, b| (a.0 + b.0, f64::max(a.1, b.1)));
    let error = (sum / colors.counts.iter().sum::<u64>() as f64).sqrt();
    println!("{size:>8}  {method:16} {error:>12.5} {:>10.4} {seconds:>8.2}", largest.sqrt());
    palette
}

fn lloyd(colors: &Colors, palette: &[[u8; 3]], passes: usize) -> Vec<[u8; 3]> {
    let mut palette: Vec<[f32; 3]> = palette.iter().map(|&color| to_oklab(color)).collect();
    for _ in 0..passes {
        palette = refine(&palette, colors.colors.len(), |index| colors.weighted(index));
    }
    palette.into_iter().map(oklab_to_displayed).collect()
}

impl Colors {
    fn weighted(&self, index: usize) -> WeightedColor {
        WeightedColor { oklab: to_oklab(self.colors[index]), voxels: self.counts[index] }
    }
}

fn of_picture(picture: &image::RgbImage) -> Colors {
    let mut counts = BTreeMap::new();
    for pixel in picture.pixels() {
        *counts.entry(pixel.0).or_insert(0) += 1;
    }
    Colors { colors: counts.keys().copied().collect(), counts: counts.into_values().collect() }
}

/// Three of five of all displayed colours, each used once.
fn ten_million() -> Colors {
    // Marsaglia 2003, "Xorshift RNGs".
    let mut state = 1u64;
    let mut random = move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state
    };
    let colors: Vec<[u8; 3]> = (0..1u32 << 24)
        .filter(|_| random() % 5 < 3)
        .map(|code| [code >> 16, code >> 8, code].map(|channel| channel as u8))
        .collect();
    Colors { counts: vec![1; colors.len()], colors }
}
