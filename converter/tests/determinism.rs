//! The bytes depend on the mesh and the options alone.

mod support;

use octvox_converter::{Compression, FileFormat, Material, Mesh, Options};
use support::{Random, convert_to_bytes, icosphere, torus};

/// A sphere and a torus with many colours and normals of their own, over several blocks at depth 7.
struct Parts {
    positions: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    normals: Vec<[[f32; 3]; 3]>,
    colors: Vec<[[f32; 3]; 3]>,
    materials: Vec<u32>,
}

impl Parts {
    fn new() -> Self {
        let (sphere, torus) = (icosphere([0.0; 3], 1.0, 3), torus([0.3, 0.1, 0.2], 1.0, 0.4, 40, 20));
        let mut positions = sphere.positions().to_vec();
        let first = positions.len() as u32;
        positions.extend_from_slice(torus.positions());
        let mut triangles = sphere.triangles().to_vec();
        triangles.extend(torus.triangles().iter().map(|triangle| triangle.map(|vertex| vertex + first)));
        let mut random = Random(1);
        let mut corners = || {
            triangles
                .iter()
                .map(|_| [(); 3].map(|()| [(); 3].map(|()| random.fraction() as f32 - 0.1)))
                .collect()
        };
        let (normals, colors) = (corners(), corners());
        let materials = (0..triangles.len()).map(|triangle| triangle as u32 % 3).collect();
        Self { positions, triangles, normals, colors, materials }
    }

    fn mesh(&self) -> Mesh {
        let material = |grey: f64| Material::matte(grey.to_string(), [grey, 0.5, 1.0]);
        Mesh::new(self.positions.clone(), self.triangles.clone())
            .and_then(|mesh| {
                mesh.with_materials([0.2, 0.9, 1.0].map(material).to_vec(), self.materials.clone())
            })
            .and_then(|mesh| mesh.with_corner_normals(self.normals.clone()))
            .and_then(|mesh| mesh.with_corner_colors(self.colors.clone()))
            .unwrap()
    }

    /// Puts the triangles into another order.
    fn shuffle(&mut self, random: &mut Random) {
        let mut order: Vec<usize> = (0..self.triangles.len()).collect();
        random.shuffle(&mut order);
        self.triangles = order.iter().map(|&index| self.triangles[index]).collect();
        self.normals = order.iter().map(|&index| self.normals[index]).collect();
        self.colors = order.iter().map(|&index| self.colors[index]).collect();
        self.materials = order.iter().map(|&index| self.materials[index]).collect();
    }

    /// Begins each triangle with another corner, and reverses some if asked to.
    fn turn(&mut self, random: &mut Random, reverse: bool) {
        for index in 0..self.triangles.len() {
            let steps = random.below(3) as usize;
            self.triangles[index].rotate_left(steps);
            self.normals[index].rotate_left(steps);
            self.colors[index].rotate_left(steps);
            if reverse && random.below(2) == 0 {
                self.triangles[index].reverse();
                self.normals[index].reverse();
                self.colors[index].reverse();
            }
        }
    }
}

fn options() -> [Options; 5] {
    let options = Options { depth: 7, palette_size: 200, ..Options::default() };
    [
        options.clone(),
        Options { conservative: true, ..options.clone() },
        Options { depth: 3, palette_size: 32_767, ..options.clone() },
        Options {
            depth: 6,
            format: FileFormat::Version5 { compression: Compression::Zstandard },
            ..options.clone()
        },
        Options {
            format: FileFormat::Version5 { compression: Compression::None },
            conservative: true,
            depth: 4,
            ..options
        },
    ]
}

#[test]
fn order_rotation_and_orientation_of_triangles_do_not_matter() {
    let mut random = Random(2);
    let mut parts = Parts::new();
    let expected = options().map(|options| convert_to_bytes(&parts.mesh(), &options).0);
    for _ in 0..2 {
        parts.shuffle(&mut random);
        parts.turn(&mut random, true);
        let found = options().map(|options| convert_to_bytes(&parts.mesh(), &options).0);
        assert!(found == expected);
    }
}

#[test]
fn computed_normals_do_not_depend_on_order_and_rotation() {
    let mut random = Random(3);
    let mut parts = Parts::new();
    let bytes = |parts: &Parts| {
        let mesh = Mesh::new(parts.positions.clone(), parts.triangles.clone()).unwrap();
        convert_to_bytes(&mesh, &Options { depth: 7, crease_degrees: 14.0, ..Options::default() }).0
    };
    let expected = bytes(&parts);
    for _ in 0..3 {
        parts.shuffle(&mut random);
        parts.turn(&mut random, false);
        assert!(bytes(&parts) == expected);
    }
}

#[test]
fn the_number_of_threads_does_not_matter() {
    let mesh = Parts::new().mesh();
    let convert_with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| options().map(|options| convert_to_bytes(&mesh, &options).0))
    };
    let expected = convert_with(1);
    assert!(expected.iter().all(|bytes| bytes.len() > 1000));
    for threads in [2, 7] {
        assert!(convert_with(threads) == expected, "{threads} threads");
    }
}
