//! Textures end up where they belong: against colours computed from the image by definition.

mod support;

use octvox_cli::Progress;
use octvox_converter::{
    Channel, ConvertError, DisplacementMap, Image, Material, Mesh, NormalMap, NormalMapKind, Options,
    TextureMap, Wrap, convert,
};
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::{PI, TAU};
use support::{Cell, Random, Steps, convert_to_bytes, icosphere, reached, torus, unit_voxels, voxels};

/// An image by a function of column and row, the latter from the top.
fn image(width: u32, height: u32, mut pixel: impl FnMut(u32, u32) -> [u8; 4]) -> Image {
    let pixels = (0..width * height).map(|index| pixel(index % width, index / width)).collect();
    Image::new("test", width, height, pixels).unwrap()
}

fn noise(width: u32, height: u32, seed: u64) -> Image {
    let mut random = Random(seed);
    image(width, height, |_, _| [(); 4].map(|()| random.below(256) as u8))
}

/// What all triangles of a mesh look like.
fn with(mesh: Mesh, material: Material, images: Vec<Image>, coordinates: Vec<[[f32; 2]; 3]>) -> Mesh {
    let of_triangle = vec![0; mesh.triangles().len()];
    mesh.with_images(images)
        .and_then(|mesh| mesh.with_materials(vec![material], of_triangle))
        .and_then(|mesh| mesh.with_corner_texture_coordinates(coordinates))
        .unwrap()
}

/// White, with a diffuse map.
fn painted(map: TextureMap) -> Material {
    Material { diffuse_map: Some(map), ..Material::matte("painted", [1.0; 3]) }
}

/// A rectangle at z = 2.3 from the z axis to (width, height), whose texture coordinates go from `low` to `high`.
fn rectangle(
    [width, height]: [f64; 2],
    [low, high]: [[f32; 2]; 2],
    material: Material,
    image: Image,
) -> Mesh {
    let positions = vec![[0.0, 0.0, 2.3], [width, 0.0, 2.3], [width, height, 2.3], [0.0, height, 2.3]];
    let corners = [low, [high[0], low[1]], high, [low[0], high[1]]];
    let coordinates = vec![[corners[0], corners[1], corners[2]], [corners[0], corners[2], corners[3]]];
    with(Mesh::new(positions, vec![[0, 1, 2], [0, 2, 3]]).unwrap(), material, vec![image], coordinates)
}

const WHOLE: [[f32; 2]; 2] = [[0.0; 2], [1.0; 2]];

fn light(displayed: u8) -> f64 {
    let value = f64::from(displayed) / 255.0;
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

fn displayed(light: f64) -> f64 {
    255.0 * if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 }
}

/// The colours of the voxels by column and row, seen along z.
fn colors(mesh: &Mesh, depth: u8) -> BTreeMap<[u32; 2], [u8; 3]> {
    let voxels = voxels(mesh, &unit_voxels(depth));
    voxels.into_iter().map(|([x, y, _], (color, _))| ([x, y], color)).collect()
}

#[test]
fn a_voxel_is_the_mean_of_the_texels_it_covers() {
    // Four, two and one texels across a voxel.
    for texels in [64, 32, 16] {
        let image = noise(texels, texels, 5);
        let found = colors(&rectangle([16.0; 2], WHOLE, painted(TextureMap::new(0)), image.clone()), 4);
        assert_eq!(found.len(), 256);
        let step = texels / 16;
        for ([x, y], color) in found {
            for channel in 0..3 {
                let mut sum = 0.0;
                for k in 0..step * step {
                    // The voxel above has the row before.
                    let (column, row) = (x * step + k % step, texels - 1 - (y * step + k / step));
                    sum += light(image.pixels()[(row * texels + column) as usize][channel]);
                }
                let expected = displayed(sum / f64::from(step * step));
                assert!((f64::from(color[channel]) - expected).abs() <= 0.6, "{x} {y}: {color:?} {expected}");
            }
        }
    }
}

#[test]
fn a_smooth_image_is_followed_at_any_size() {
    // No power of two, no whole number of texels to a voxel, different along both axes.
    for (width, height) in [(50, 30), (203, 77), (31, 500)] {
        let wave = |u: f64, v: f64| 0.5 + 0.4 * (TAU * u).sin() * (TAU * v).cos();
        let image = image(width, height, |column, row| {
            let (u, v) = (
                (f64::from(column) + 0.5) / f64::from(width),
                1.0 - (f64::from(row) + 0.5) / f64::from(height),
            );
            [displayed(wave(u, v)).round() as u8; 4]
        });
        for ([x, y], color) in colors(&rectangle([32.0; 2], WHOLE, painted(TextureMap::new(0)), image), 5) {
            let expected = wave((f64::from(x) + 0.5) / 32.0, (f64::from(y) + 0.5) / 32.0);
            assert!((light(color[0]) - expected).abs() < 0.025, "{x} {y}: {} {expected}", light(color[0]));
        }
    }
}

#[test]
fn a_texture_far_away_is_its_mean() {
    let image = noise(256, 256, 9);
    let mean = |channel: usize| {
        displayed(
            image.pixels().iter().map(|pixel| light(pixel[channel])).sum::<f64>() / f64::from(256 * 256),
        )
    };
    // Ten times across four voxels, and squeezed to a hundred times more along one axis.
    for repeats in [[10.0, 10.0], [10.0, 1000.0]] {
        let mesh = rectangle([4.0; 2], [[0.0; 2], repeats], painted(TextureMap::new(0)), image.clone());
        for color in colors(&mesh, 2).into_values() {
            assert!(
                (0..3).all(|channel| (f64::from(color[channel]) - mean(channel)).abs() < 1.5),
                "{color:?}"
            );
        }
    }
}

#[test]
fn colors_of_material_and_corners_multiply_the_texture() {
    let grey = image(1, 1, |_, _| [188; 4]);
    let material = Material { diffuse: [1.0, 0.5, 0.0], ..painted(TextureMap::new(0)) };
    let mesh = rectangle([4.0; 2], WHOLE, material, grey);
    let expected = |share: f64| displayed(light(188) * share);
    let half = light(128);
    let close = |mesh: &Mesh, shares: [f64; 3]| {
        colors(mesh, 2)
            .values()
            .all(|color| (0..3).all(|k| (f64::from(color[k]) - expected(shares[k])).abs() < 1.0))
    };
    assert!(close(&mesh, [1.0, half, 0.0]));
    let mesh = mesh.with_corner_colors(vec![[[0.5019608, 1.0, 1.0]; 3]; 2]).unwrap();
    assert!(close(&mesh, [half, half, 0.0]));
}

#[test]
fn what_lies_beyond_the_edges() {
    // A texel to a voxel, from one width before the image to one behind it.
    let counted = image(8, 1, |column, _| [column as u8 * 30; 4]);
    let range = [[-1.0, 0.0], [2.0, 1.0]];
    let row = |wrap| {
        let map = TextureMap { wrap: [wrap; 2], ..TextureMap::new(0) };
        let found = colors(&rectangle([24.0, 1.0], range, painted(map), counted.clone()), 5);
        (0..24).map(|x| found[&[x, 0]][0] / 30).collect::<Vec<_>>()
    };
    let (up, down): (Vec<u8>, Vec<u8>) = ((0..8).collect(), (0..8).rev().collect());
    assert_eq!(row(Wrap::Repeat), [&up[..], &up, &up].concat());
    assert_eq!(row(Wrap::Clamp), [&[0; 8][..], &up, &[7; 8]].concat());
    assert_eq!(row(Wrap::Mirror), [&down[..], &up, &down].concat());
}

#[test]
fn the_corners_of_an_image_come_to_the_corners_they_belong_to() {
    let quarters = [[[255, 0, 0, 255], [0, 255, 0, 255]], [[0, 0, 255, 255], [255, 255, 0, 255]]];
    let picture = image(16, 16, |column, row| quarters[row as usize / 8][column as usize / 8]);
    // A box seen from the front, from the right and from above, and an image laid mirrored onto its back.
    let quads = [
        ([[2, 2, 12], [12, 2, 12], [12, 12, 12], [2, 12, 12]], false),
        ([[12, 2, 12], [12, 2, 2], [12, 12, 2], [12, 12, 12]], false),
        ([[2, 12, 12], [12, 12, 12], [12, 12, 2], [2, 12, 2]], false),
        ([[12, 2, 2], [2, 2, 2], [2, 12, 2], [12, 12, 2]], true),
    ];
    let (mut positions, mut triangles, mut coordinates) = (Vec::new(), Vec::new(), Vec::new());
    for (quad, mirrored) in quads {
        let first = positions.len() as u32;
        positions.extend(quad.map(|corner: [i32; 3]| corner.map(f64::from)));
        triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        let corner = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
            .map(|[u, v]: [f32; 2]| if mirrored { [1.0 - u, v] } else { [u, v] });
        coordinates.extend([[corner[0], corner[1], corner[2]], [corner[0], corner[2], corner[3]]]);
    }
    let mesh = Mesh::new(positions, triangles).unwrap();
    let mesh = with(mesh, painted(TextureMap::new(0)), vec![picture], coordinates);
    let found = voxels(&mesh, &unit_voxels(4));
    for (quad, mirrored) in quads {
        for (index, [row, column]) in [[1, 0], [1, 1], [0, 1], [0, 0]].into_iter().enumerate() {
            // The voxel three quarters of the way from the middle of the face to this corner.
            let middle = [0, 1, 2].map(|axis| quad.iter().map(|corner| corner[axis]).sum::<i32>() / 4);
            let cell = [0, 1, 2].map(|axis| {
                let place = middle[axis] * 2 + (quad[index][axis] - middle[axis]) * 3 / 2;
                (place as u32 / 2).min(12)
            });
            let [red, green, blue, _] = quarters[row][if mirrored { 1 - column } else { column }];
            assert_eq!(found[&cell].0, [red, green, blue], "{quad:?} corner {index} {cell:?}");
        }
    }
}

#[test]
fn a_texture_around_a_cylinder_has_no_seam() {
    let (sides, radius, middle) = (24, 20.0, 32.0);
    let picture = image(256, 4, |column, _| {
        let angle = TAU * (f64::from(column) + 0.5) / 256.0;
        [
            displayed(0.5 + 0.4 * angle.cos()).round() as u8,
            displayed(0.5 + 0.4 * angle.sin()).round() as u8,
            0,
            255,
        ]
    });
    let (mut positions, mut triangles, mut coordinates) = (Vec::new(), Vec::new(), Vec::new());
    for side in 0..sides {
        let angle = TAU * f64::from(side) / f64::from(sides);
        for y in [4.0, 60.0] {
            positions.push([middle + radius * angle.cos(), y, middle + radius * angle.sin()]);
        }
        let [a, b] = [2 * side, 2 * ((side + 1) % sides)];
        triangles.extend([[a, a + 1, b + 1], [a, b + 1, b]]);
        // The last side ends at u = 1, where the first begins at 0.
        let [u, w] = [side, side + 1].map(|side| side as f32 / sides as f32);
        coordinates.extend([[[u, 0.0], [u, 1.0], [w, 1.0]], [[u, 0.0], [w, 1.0], [w, 0.0]]]);
    }
    let mesh = Mesh::new(positions, triangles).unwrap();
    let mesh = with(mesh, painted(TextureMap::new(0)), vec![picture], coordinates);
    let found = voxels(&mesh, &unit_voxels(6));
    assert!(found.len() > 5000);
    for ([x, _, z], (color, _)) in found {
        let angle = (f64::from(z) + 0.5 - middle).atan2(f64::from(x) + 0.5 - middle);
        for (channel, expected) in [angle.cos(), angle.sin()].into_iter().enumerate() {
            let expected = 0.5 + 0.4 * expected;
            assert!((light(color[channel]) - expected).abs() < 0.04, "{x} {z}: {color:?} {expected}");
        }
    }
}

#[test]
fn holes_are_cut_out_and_keep_their_color_to_themselves() {
    // The right half is a hole, painted green.
    let leaf = image(32, 32, |column, _| if column < 16 { [200, 0, 0, 255] } else { [0, 255, 0, 0] });
    let map = TextureMap::new(0);
    let opacity_map = Some(TextureMap { channel: Channel::Alpha, ..map });
    for depth in [5, 4, 3] {
        let side = f64::from(1u32 << depth);
        let material = Material { opacity_map, ..painted(map) };
        let found = colors(&rectangle([side; 2], WHOLE, material, leaf.clone()), depth);
        assert_eq!(found.len(), 1 << (2 * depth - 1));
        for ([x, _], [red, green, blue]) in found {
            assert!(x < 1 << (depth - 1));
            assert!(red.abs_diff(200) <= 1 && green <= 1 && blue == 0, "{x}: {red} {green} {blue}");
        }
    }
    // The cutoff decides where alpha is in between.
    let veil = image(4, 4, |_, _| [255, 255, 255, 100]);
    for (alpha_cutoff, count) in [(0.3, 16), (0.5, 0)] {
        let material = Material { opacity_map, alpha_cutoff, ..painted(map) };
        let mut mesh = rectangle([4.0; 2], WHOLE, material, veil.clone());
        if count == 0 {
            let all_cut_out = convert(&mesh, &unit_voxels(2), &Progress::hidden(), &mut Vec::new());
            assert!(matches!(all_cut_out, Err(ConvertError::AllCutOut)));
        }
        // A point elsewhere, so that there is something in any case.
        let mut positions = mesh.positions().to_vec();
        positions.push([0.5, 0.5, 0.5]);
        let triangles = [mesh.triangles(), &[[4, 4, 4]]].concat();
        let coordinates = [mesh.corner_texture_coordinates(), &[[[0.0; 2]; 3]]].concat();
        let materials = [mesh.materials(), &[Material::default()]].concat();
        mesh = Mesh::new(positions, triangles)
            .and_then(|mesh| mesh.with_images(vec![veil.clone()]))
            .and_then(|mesh| mesh.with_materials(materials, vec![0, 0, 1]))
            .and_then(|mesh| mesh.with_corner_texture_coordinates(coordinates))
            .unwrap();
        assert_eq!(voxels(&mesh, &unit_voxels(2)).len(), count + 1);
    }
}

#[test]
fn a_normal_map_tilts_the_normals_of_a_plane() {
    let encode = |value: f64| ((value + 1.0) * 127.5).round() as u8;
    let tilt = image(4, 4, |_, _| [encode(0.6), encode(0.0), encode(0.8), 255]);
    let kind = NormalMapKind::Tangent { strength: 1.0 };
    for (range, expected) in [(WHOLE, [0.6, 0.0, 0.8]), ([[1.0, 0.0], [0.0, 1.0]], [-0.6, 0.0, 0.8])] {
        let material =
            Material { normal_map: Some(NormalMap { map: TextureMap::new(0), kind }), ..Material::default() };
        let found = voxels(&rectangle([8.0; 2], range, material, tilt.clone()), &unit_voxels(3));
        assert_eq!(found.len(), 64);
        for (color, normal) in found.into_values() {
            assert_eq!(color, [204; 3]);
            let normal = normal.decode();
            assert!((0..3).all(|axis| (normal[axis] - expected[axis]).abs() < 0.03), "{normal:?}");
        }
    }
}

/// Longitude and latitude of the corners of a sphere's triangles, with a seam that runs across them.
fn around(mesh: &Mesh, middle: f64) -> Vec<[[f32; 2]; 3]> {
    let coordinates = |vertex: u32| {
        let [x, y, z] = mesh.positions()[vertex as usize].map(|coordinate| coordinate - middle);
        let length = (x * x + y * y + z * z).sqrt();
        [(z.atan2(x) / TAU) as f32, ((y / length).asin() / PI) as f32]
    };
    mesh.triangles().iter().map(|triangle| triangle.map(coordinates)).collect()
}

fn displaced_sphere(image: Image, multiplier: f64) -> BTreeMap<Cell, f64> {
    let sphere = icosphere([32.0; 3], 20.0, 2);
    let coordinates = around(&sphere, 32.0);
    let displacement_map = Some(DisplacementMap { map: TextureMap::new(0), multiplier });
    let mesh = with(sphere, Material { displacement_map, ..Material::default() }, vec![image], coordinates);
    let found = voxels(&mesh, &Options { displace: true, ..unit_voxels(6) });
    let radius = |cell: &Cell| cell.iter().map(|&c| (f64::from(c) + 0.5 - 32.0).powi(2)).sum::<f64>().sqrt();
    found.into_keys().map(|cell| (cell, radius(&cell))).collect()
}

#[test]
fn a_displaced_surface_is_closed_even_at_seams() {
    for seed in 0..3 {
        // Coarse enough for high towers beside deep pits, different on both sides of the seam.
        let found = displaced_sphere(noise(24, 12, seed), 8.0);
        let (low, high) =
            found.values().fold((f64::MAX, 0.0f64), |(low, high), &r| (low.min(r), high.max(r)));
        assert!(low < 22.0 && high > 25.0, "{low} {high}");
        let outside = reached(&found.into_keys().collect::<BTreeSet<Cell>>(), 64, Steps::Six);
        assert!(outside.contains(&[63; 3]));
        assert!(!outside.contains(&[32; 3]), "there is a hole");
    }
}

#[test]
fn displacement_moves_by_the_height_times_its_multiplier() {
    for (value, multiplier) in [(255, 6.0), (255, -6.0), (0, 6.0), (128, 6.0)] {
        let found = displaced_sphere(image(4, 4, |_, _| [value; 4]), multiplier);
        // The middles of the flat triangles are nearer than 20.
        let expected = 19.7 + f64::from(value) / 255.0 * multiplier;
        assert!(found.values().all(|radius| (radius - expected).abs() < 1.2), "{value} {multiplier}");
    }
}

/// A triangle, its texture coordinates and its material.
type Part = ([u32; 3], [[f32; 2]; 3], u32);

#[test]
fn the_order_of_triangles_and_the_number_of_threads_do_not_matter() {
    let torus = torus([0.0; 3], 1.0, 0.4, 24, 12);
    let mut random = Random(11);
    let coordinates =
        torus.triangles().iter().map(|_| [(); 3].map(|()| [(); 2].map(|()| 3.0 * random.fraction() as f32)));
    let mut parts: Vec<Part> = torus
        .triangles()
        .iter()
        .zip(coordinates)
        .map(|(&triangle, uv)| (triangle, uv, triangle[0] % 2))
        .collect();
    let map = TextureMap::new(0);
    let materials = vec![
        Material {
            normal_map: Some(NormalMap { map, kind: NormalMapKind::Height { multiplier: 0.1 } }),
            opacity_map: Some(TextureMap { channel: Channel::Alpha, ..map }),
            alpha_cutoff: 0.4,
            ..painted(map)
        },
        Material {
            normal_map: Some(NormalMap { map, kind: NormalMapKind::Tangent { strength: 1.0 } }),
            displacement_map: Some(DisplacementMap { map, multiplier: 0.1 }),
            ..painted(TextureMap { wrap: [Wrap::Mirror; 2], ..map })
        },
    ];
    let mesh = |parts: &[Part]| {
        Mesh::new(torus.positions().to_vec(), parts.iter().map(|part| part.0).collect())
            .and_then(|mesh| mesh.with_images(vec![noise(64, 32, 3)]))
            .and_then(|mesh| {
                mesh.with_materials(materials.clone(), parts.iter().map(|part| part.2).collect())
            })
            .and_then(|mesh| mesh.with_corner_texture_coordinates(parts.iter().map(|part| part.1).collect()))
            .unwrap()
    };
    let options = [
        Options { depth: 7, ..Options::default() },
        Options { depth: 6, conservative: true, ..Options::default() },
        Options { depth: 2, ..Options::default() },
        Options { depth: 6, displace: true, ..Options::default() },
    ];
    let bytes = |parts: &[_]| options.clone().map(|options| convert_to_bytes(&mesh(parts), &options).0);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let expected = pool.install(|| bytes(&parts));
    random.shuffle(&mut parts);
    for (triangle, coordinates, _) in &mut parts {
        let steps = random.below(3) as usize;
        triangle.rotate_left(steps);
        coordinates.rotate_left(steps);
    }
    assert!(bytes(&parts) == expected);
}
