//! The finest voxels of the whole mesh, block by block.

use crate::ConvertError;
use crate::binning::{Bins, Contact};
use crate::block::{Block, BlockGrid};
use crate::parts::parts_without_voxel;
use crate::scan_conversion::{GridTriangle, Sample};
use crate::storage::{Storage, Stored};
use crate::surface::Surface;
use crate::texture::Coordinates;
use crate::voxel_filter::{Leaves, VoxelFilter};
use octvox_cli::Progress;
use octvox_format::NormalCode;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};

/// The voxels of a block.
#[derive(Debug)]
pub(crate) struct Subtree {
    /// Morton code of the block.
    pub code: u32,
    pub leaf_voxels: u64,
    pub leaves: Stored<Leaves>,
}

/// Which voxels a triangle marks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Rule {
    /// Those of the thin surface, see [`crate::scan_conversion`].
    Thin,
    /// All that it touches, see [`crate::conservative`].
    Touched,
}

impl Rule {
    /// What it takes for a triangle to concern a block.
    pub(crate) fn contact(self) -> Contact {
        match self {
            Self::Thin => Contact::CenterLines,
            Self::Touched => Contact::Touch,
        }
    }
}

/// Scan-converts all triangles. The subtrees come in Morton order, with normals in `code`.
///
/// Every connected part of the mesh has a voxel: one that is too small to mark any gets that of its first vertex. Where an
/// opacity map cuts a sample out, there is none; so a part of which no sample is left has no voxel.
///
/// # Errors
/// [`ConvertError::TemporaryFile`].
pub(crate) fn scan(
    surface: &Surface<'_>,
    bins: &Bins,
    grid: BlockGrid,
    rule: Rule,
    code: NormalCode,
    storage: &Storage,
    progress: &Progress,
) -> Result<Vec<Subtree>, ConvertError> {
    progress.stage("scan", bins.len() as u64);
    let marks: Vec<AtomicBool> = surface.triangles.iter().map(|_| AtomicBool::new(false)).collect();
    let scanner = Scanner { surface, grid, rule, marks: &marks, storage };
    let workspace = || Workspace::new(grid, code);
    let mut subtrees: Vec<Subtree> = (0..bins.len())
        .into_par_iter()
        .map_init(workspace, |workspace, index| {
            let (code, triangles) = bins.block(index);
            progress.add(1);
            scanner.scan_block(workspace, code, triangles, &[])
        })
        .filter_map(Result::transpose)
        .collect::<Result<_, _>>()?;

    let marks: Vec<bool> = marks.iter().map(|mark| mark.load(Ordering::Relaxed)).collect();
    let seeds = seeds_by_block(surface, grid, &marks);
    if !seeds.is_empty() {
        // Blocks without a pair are new.
        let by_code: BTreeMap<u32, usize> =
            (0..bins.len()).map(|index| (bins.block(index).0, index)).collect();
        let mut workspace = workspace();
        let mut blocks: BTreeMap<u32, Subtree> =
            subtrees.into_iter().map(|subtree| (subtree.code, subtree)).collect();
        for (&code, seeds) in &seeds {
            let subtree = match by_code.get(&code) {
                Some(&index) => scanner.scan_block(&mut workspace, code, bins.block(index).1, seeds),
                None => scanner.scan_block(&mut workspace, code, std::iter::empty(), seeds),
            };
            if let Some(subtree) = subtree?
                && let Some(replaced) = blocks.insert(code, subtree)
            {
                storage.take(replaced.leaves)?;
            }
        }
        subtrees = blocks.into_values().collect();
    }
    Ok(subtrees)
}

/// Triangles whose first vertex marks a voxel, by the block it lies in.
fn seeds_by_block(surface: &Surface<'_>, grid: BlockGrid, marks: &[bool]) -> BTreeMap<u32, Vec<usize>> {
    let mut seeds: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    if marks.contains(&false) {
        for triangle in parts_without_voxel(surface, marks) {
            let first = surface.with_normals(triangle).corners()[0];
            seeds.entry(grid.locate(first).0).or_default().push(triangle);
        }
    }
    seeds
}

/// Working memory of a thread.
struct Workspace {
    samples: Vec<Sample<3>>,
    filter: VoxelFilter<3>,
    lit_samples: Vec<Sample<6>>,
    lit_filter: VoxelFilter<6>,
}

impl Workspace {
    fn new(grid: BlockGrid, code: NormalCode) -> Self {
        Self {
            samples: Vec::new(),
            filter: VoxelFilter::new(grid.block_depth, code),
            lit_samples: Vec::new(),
            lit_filter: VoxelFilter::new(grid.block_depth, code),
        }
    }
}

struct Scanner<'a> {
    surface: &'a Surface<'a>,
    grid: BlockGrid,
    rule: Rule,
    /// Whether a triangle has marked a voxel.
    marks: &'a [AtomicBool],
    storage: &'a Storage,
}

impl Scanner<'_> {
    /// The voxels of a block; `None` if there are none.
    fn scan_block(
        &self,
        workspace: &mut Workspace,
        code: u32,
        triangles: impl Iterator<Item = usize> + Clone,
        seeds: &[usize],
    ) -> Result<Option<Subtree>, ConvertError> {
        let block = self.grid.block(code);
        let all = triangles.clone().chain(seeds.iter().copied());
        let leaves = if let Some(color) = self.surface.common_color(all) {
            let samples = &mut workspace.samples;
            samples.clear();
            for index in triangles {
                self.mark(
                    index,
                    &self.surface.with_normals(index),
                    &block,
                    |normal, ()| Some(normal),
                    samples,
                );
            }
            for &index in seeds {
                self.mark_first(&self.surface.with_normals(index), |normal, ()| Some(normal), samples);
            }
            workspace.filter.filter(samples, color)
        } else {
            let samples = &mut workspace.lit_samples;
            samples.clear();
            for index in triangles {
                if let Some((triangle, appearance)) = self.surface.textured(index) {
                    self.mark(
                        index,
                        &triangle,
                        &block,
                        |values, point| appearance.of(values, point),
                        samples,
                    );
                } else {
                    let triangle = self.surface.with_normals_and_light(index);
                    self.mark(index, &triangle, &block, |values, ()| Some(values), samples);
                }
            }
            for &index in seeds {
                if let Some((triangle, appearance)) = self.surface.textured(index) {
                    self.mark_first(&triangle, |values, point| appearance.of(values, point), samples);
                } else {
                    let triangle = self.surface.with_normals_and_light(index);
                    self.mark_first(&triangle, |values, ()| Some(values), samples);
                }
            }
            workspace.lit_filter.filter(samples, [0; 3])
        };
        let Some(leaves) = leaves else { return Ok(None) };
        let leaf_voxels = leaves.normals.len() as u64;
        Ok(Some(Subtree { code, leaf_voxels, leaves: self.storage.put(leaves)? }))
    }

    /// Adds the samples of a triangle. One that is cut out entirely has been there all the same.
    fn mark<const N: usize, T: Coordinates>(
        &self,
        index: usize,
        triangle: &GridTriangle<N, T>,
        block: &Block,
        look: impl Fn([i16; N], T::Point) -> Option<[i16; N]>,
        samples: &mut Vec<Sample<N>>,
    ) {
        let before = samples.len();
        let mut is_cut = false;
        let mut look = |values, point| {
            let seen = look(values, point);
            is_cut |= seen.is_none();
            seen
        };
        match self.rule {
            Rule::Thin => triangle.scan(block, &mut look, samples),
            Rule::Touched => triangle.scan_touched(block, &mut look, samples),
        }
        if samples.len() > before || is_cut {
            self.marks[index].store(true, Ordering::Relaxed);
        }
    }

    /// Adds a sample at the first corner of a triangle, unless it is cut out.
    fn mark_first<const N: usize, T: Coordinates>(
        &self,
        triangle: &GridTriangle<N, T>,
        look: impl Fn([i16; N], T::Point) -> Option<[i16; N]>,
        samples: &mut Vec<Sample<N>>,
    ) {
        let point = T::mean(triangle.coordinates(), [1.0, 0.0, 0.0]);
        if let Some(values) = look(triangle.values()[0], point) {
            let (_, cell) = self.grid.locate(triangle.corners()[0]);
            samples.push(Sample { cell, finish: triangle.finish(), values });
        }
    }
}
