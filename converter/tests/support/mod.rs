//! What several tests need: small meshes, and the voxels of a converted one.

// Each test is a crate of its own and uses a part of this.
#![allow(dead_code)]

use octvox_cli::Progress;
use octvox_converter::{Mesh, Options, Report, convert};
use octvox_format::{Palette, Reader, Record, SphericalNormal, Voxel};
use std::collections::{BTreeMap, BTreeSet, VecDeque};

pub type Cell = [u32; 3];

/// Converts a mesh into bytes.
pub fn convert_to_bytes(mesh: &Mesh, options: &Options) -> (Vec<u8>, Report) {
    let mut bytes = Vec::new();
    let report = convert(mesh, options, &Progress::hidden(), &mut bytes).unwrap();
    assert_eq!(report.file_bytes, bytes.len() as u64);
    (bytes, report)
}

/// A voxel of a file and those below it.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    pub voxel: Voxel,
    pub children: Vec<Node>,
}

/// An octree as it is in the file.
pub struct Tree {
    pub palette: Palette,
    pub root: Node,
}

impl Tree {
    pub fn read(bytes: &[u8]) -> Self {
        let mut reader = Reader::new(bytes).unwrap();
        let records: Vec<Record> = reader.by_ref().map(Result::unwrap).collect();
        let palette = reader.into_palette();
        let mut records = records.into_iter();
        Self { palette, root: read_node(&mut records) }
    }

    /// The filled cells at the finest level; leaves above it count as all the cells they cover.
    pub fn leaves(&self, depth: u8) -> BTreeMap<Cell, Voxel> {
        let mut leaves = BTreeMap::new();
        collect(&self.root, [0; 3], 1 << depth, &mut leaves);
        leaves
    }

    pub fn color(&self, voxel: Voxel) -> [u8; 3] {
        self.palette.color(voxel.palette_index).unwrap()
    }
}

fn read_node(records: &mut impl Iterator<Item = Record>) -> Node {
    let record = records.next().unwrap();
    let children =
        if record.has_children { (0..8).map(|_| read_node(records)).collect() } else { Vec::new() };
    Node { voxel: record.voxel, children }
}

fn collect(node: &Node, corner: Cell, size: u32, leaves: &mut BTreeMap<Cell, Voxel>) {
    for (octant, child) in node.children.iter().enumerate() {
        let half = size / 2;
        let corner = [0, 1, 2].map(|axis| corner[axis] + (octant as u32 >> axis & 1) * half);
        collect(child, corner, half, leaves);
    }
    if node.children.is_empty() && !node.voxel.is_empty() {
        for x in 0..size {
            for y in 0..size {
                for z in 0..size {
                    leaves.insert([corner[0] + x, corner[1] + y, corner[2] + z], node.voxel);
                }
            }
        }
    }
}

/// The filled cells and what they look like, of a mesh converted with these options.
pub fn voxels(mesh: &Mesh, options: &Options) -> BTreeMap<Cell, ([u8; 3], SphericalNormal)> {
    let (bytes, report) = convert_to_bytes(mesh, options);
    let tree = Tree::read(&bytes);
    let leaves = tree.leaves(options.depth);
    assert_eq!(report.leaf_voxels, leaves.len() as u64);
    leaves.into_iter().map(|(cell, voxel)| (cell, (tree.color(voxel), voxel.normal))).collect()
}

/// Steps of a walk.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Steps {
    /// Through faces.
    Six,
    /// Through faces, edges and corners.
    TwentySix,
}

/// The unfilled cells that can be reached from the corner of the cube.
pub fn reached(filled: &BTreeSet<Cell>, side: u32, steps: Steps) -> BTreeSet<Cell> {
    assert!(!filled.contains(&[0; 3]));
    let mut reached = BTreeSet::from([[0; 3]]);
    let mut queue = VecDeque::from([[0u32; 3]]);
    while let Some(cell) = queue.pop_front() {
        for code in 0..27 {
            let step = [code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1];
            if steps == Steps::Six && step.iter().map(|s: &i32| s.abs()).sum::<i32>() != 1 {
                continue;
            }
            let next = [0, 1, 2].map(|axis| cell[axis].wrapping_add_signed(step[axis]));
            if next.iter().all(|&c| c < side) && !filled.contains(&next) && reached.insert(next) {
                queue.push_back(next);
            }
        }
    }
    reached
}

/// Options under which one world unit is a voxel and the cube begins at the origin.
pub fn unit_voxels(depth: u8) -> Options {
    let side = f64::from(1u32 << depth);
    Options {
        depth,
        bounds: Some([0.0, 0.0, 0.0, side, side, side]),
        voxel_size: Some(1.0),
        ..Options::default()
    }
}

/// An axis-aligned box of twelve triangles.
pub fn cuboid(min: [f64; 3], max: [f64; 3]) -> Mesh {
    let corner = |k: usize| [0, 1, 2].map(|axis| if k >> axis & 1 == 1 { max[axis] } else { min[axis] });
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh::new((0..8).map(corner).collect(), triangles).unwrap()
}

/// A sphere of 20 · 4^`steps` triangles, turned so that nothing is parallel to an axis.
pub fn icosphere(center: [f64; 3], radius: f64, steps: u32) -> Mesh {
    let golden = (1.0 + 5.0f64.sqrt()) / 2.0;
    let mut positions: Vec<[f64; 3]> = Vec::new();
    for (a, b) in [(-1.0, golden), (1.0, golden), (-1.0, -golden), (1.0, -golden)] {
        positions.extend([[a, b, 0.0], [0.0, a, b], [b, 0.0, a]]);
    }
    // Faces of an icosahedron: three vertices at the smallest distance, 2, from each other.
    let distance = |a: [f64; 3], b: [f64; 3]| (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>();
    let near = |a: usize, b: usize| (distance(positions[a], positions[b]) - 4.0).abs() < 1e-9;
    let mut triangles = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b) && near(b, c) && near(a, c) {
                    triangles.push(outward(&positions, [a as u32, b as u32, c as u32]));
                }
            }
        }
    }
    for _ in 0..steps {
        (positions, triangles) = subdivide(&positions, &triangles);
    }
    let (sine, cosine) = 0.3f64.sin_cos();
    for position in &mut positions {
        let length = distance(*position, [0.0; 3]).sqrt();
        let [x, y, z] = position.map(|coordinate| coordinate / length * radius);
        let (x, y) = (cosine * x - sine * y, sine * x + cosine * y);
        let (y, z) = (cosine * y - sine * z, sine * y + cosine * z);
        *position = [center[0] + x, center[1] + y, center[2] + z];
    }
    Mesh::new(positions, triangles).unwrap()
}

/// The triangle, turned so that it is counterclockwise seen from outside of the origin.
fn outward(positions: &[[f64; 3]], [a, b, c]: [u32; 3]) -> [u32; 3] {
    let [p, q, r] = [a, b, c].map(|vertex| positions[vertex as usize]);
    let volume = p[0] * (q[1] * r[2] - q[2] * r[1])
        + p[1] * (q[2] * r[0] - q[0] * r[2])
        + p[2] * (q[0] * r[1] - q[1] * r[0]);
    if volume > 0.0 { [a, b, c] } else { [a, c, b] }
}

fn subdivide(positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let mut positions = positions.to_vec();
    let mut middles = BTreeMap::new();
    let mut finer = Vec::new();
    for &[a, b, c] in triangles {
        let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(p, q)| {
            *middles.entry((p.min(q), p.max(q))).or_insert_with(|| {
                let (p, q): ([f64; 3], [f64; 3]) = (positions[p as usize], positions[q as usize]);
                let radius = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
                let middle = [0, 1, 2].map(|axis| (p[axis] + q[axis]) / 2.0);
                // Back onto the sphere.
                positions.push(middle.map(|x| x * radius(p) / radius(middle)));
                positions.len() as u32 - 1
            })
        });
        finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    (positions, finer)
}

/// A torus around the z axis.
pub fn torus(center: [f64; 3], radius: f64, tube: f64, around: u32, across: u32) -> Mesh {
    let angle = |k: u32, count: u32| (f64::from(k) + 0.37) / f64::from(count) * std::f64::consts::TAU;
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for i in 0..around {
        for j in 0..across {
            let (u, v) = (angle(i, around), angle(j, across));
            let reach = radius + tube * v.cos();
            positions.push([
                center[0] + reach * u.cos(),
                center[1] + reach * u.sin(),
                center[2] + tube * v.sin(),
            ]);
            let at = |i: u32, j: u32| (i % around) * across + j % across;
            let quad = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            triangles.extend([[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]]);
        }
    }
    Mesh::new(positions, triangles).unwrap()
}

/// A tetrahedron.
pub fn tetrahedron(corners: [[f64; 3]; 4]) -> Mesh {
    Mesh::new(corners.to_vec(), vec![[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]]).unwrap()
}

/// Numbers that look random, always the same (Steele, Lea and Flood 2014, SplitMix).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    pub fn below(&mut self, end: u64) -> u64 {
        self.next() % end
    }

    /// From 0 to 1.
    pub fn fraction(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for index in (1..items.len()).rev() {
            items.swap(index, self.below(index as u64 + 1) as usize);
        }
    }
}
