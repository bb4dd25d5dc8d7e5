//! Levels of detail, pruning and counts of the octree in the file.

mod support;

use octvox_converter::{LodColor, Material, Mesh, Options};
use octvox_format::{Reader, SphericalNormal, Voxel, Writer, summarize};
use support::{Node, Random, Tree, convert_to_bytes, cuboid, icosphere};

/// A sphere whose triangles have materials at random.
fn colored_sphere() -> Mesh {
    let sphere = icosphere([0.0; 3], 1.0, 3);
    let mut random = Random(5);
    let materials =
        (0..9).map(|k| Material::matte(format!("m{k}"), [f64::from(k) / 9.0, 0.3, 1.0])).collect();
    let of_triangle = sphere.triangles().iter().map(|_| random.below(9) as u32).collect();
    sphere.with_materials(materials, of_triangle).unwrap()
}

fn for_each_node(node: &Node, visit: &mut impl FnMut(&Node)) {
    visit(node);
    for child in &node.children {
        for_each_node(child, visit);
    }
}

/// What the leaf voxels of a node look like, added up; leaves above the finest level count as their cells.
#[derive(Default, Clone, Copy)]
struct Surface {
    cells: f64,
    normal: [f64; 3],
    light: [f64; 3],
}

impl Surface {
    fn of(tree: &Tree, node: &Node, size: u32) -> Self {
        let mut surface = Self::default();
        if node.voxel.is_empty() {
            return surface;
        }
        if node.children.is_empty() {
            surface.cells = f64::from(size).powi(3);
            surface.normal = node.voxel.normal.decode().map(|component| f64::from(component) * surface.cells);
            surface.light = tree.color(node.voxel).map(|channel| light(channel) * surface.cells);
        }
        for child in &node.children {
            let child = Self::of(tree, child, size / 2);
            surface.cells += child.cells;
            for axis in 0..3 {
                surface.normal[axis] += child.normal[axis];
                surface.light[axis] += child.light[axis];
            }
        }
        surface
    }
}

/// Linear light of a displayed channel (IEC 61966-2-1).
fn light(channel: u8) -> f64 {
    let displayed = f64::from(channel) / 255.0;
    if displayed <= 0.04045 { displayed / 12.92 } else { ((displayed + 0.055) / 1.055).powf(2.4) }
}

/// Oklab of linear light (Ottosson 2020).
fn oklab([red, green, blue]: [f64; 3]) -> [f64; 3] {
    let l = (0.4122214708 * red + 0.5363325363 * green + 0.0514459929 * blue).cbrt();
    let m = (0.2119034982 * red + 0.6806995451 * green + 0.1073969566 * blue).cbrt();
    let s = (0.0883024619 * red + 0.2817188376 * green + 0.6299787005 * blue).cbrt();
    [
        0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s,
        1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
        0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s,
    ]
}

fn for_each_node_with_size(node: &Node, size: u32, visit: &mut impl FnMut(&Node, u32)) {
    visit(node, size);
    for child in &node.children {
        for_each_node_with_size(child, size / 2, visit);
    }
}

#[test]
fn a_node_is_filled_if_a_child_is_and_has_the_mean_normal_of_its_leaf_voxels() {
    let (bytes, _) = convert_to_bytes(&colored_sphere(), &Options { depth: 7, ..Options::default() });
    let tree = Tree::read(&bytes);
    let mut inner_nodes = 0;
    for_each_node_with_size(&tree.root, 128, &mut |node, size| {
        if node.children.is_empty() {
            return;
        }
        inner_nodes += 1;
        assert!(node.children.iter().any(|child| !child.voxel.is_empty()) && !node.voxel.is_empty());
        let mean = Surface::of(&tree, node, size).normal;
        let length = mean.iter().map(|m| m * m).sum::<f64>().sqrt();
        let cosine: f64 =
            (0..3).map(|axis| mean[axis] * f64::from(node.voxel.normal.decode()[axis]) / length).sum();
        let worst = f64::from(SphericalNormal::WORST_ANGLE_DEGREES) + 0.01;
        assert!(length < 1e-3 || cosine > worst.to_radians().cos(), "{cosine}");
    });
    assert!(inner_nodes > 1000);
}

#[test]
fn a_node_has_the_entry_nearest_to_the_mean_light_of_its_leaf_voxels() {
    let (bytes, report) = convert_to_bytes(&colored_sphere(), &Options { depth: 7, ..Options::default() });
    assert_eq!(report.palette_error, 0.0);
    let tree = Tree::read(&bytes);
    let entries: Vec<[f64; 3]> = tree.palette.colors().iter().map(|color| oklab(color.map(light))).collect();
    let mut mixed = 0;
    for_each_node_with_size(&tree.root, 128, &mut |node, size| {
        if node.voxel.is_empty() {
            return;
        }
        let surface = Surface::of(&tree, node, size);
        let mean = oklab(surface.light.map(|light| light / surface.cells));
        let distance = |entry: &[f64; 3]| (0..3).map(|k| (mean[k] - entry[k]).powi(2)).sum::<f64>().sqrt();
        let nearest = entries.iter().map(distance).fold(f64::MAX, f64::min);
        // The mean is rounded to 8 bits before, and children of one entry are not looked up.
        let found = distance(&entries[usize::from(node.voxel.palette_index) - 1]);
        assert!(found < nearest + 0.01, "{found} {nearest}");
        mixed += usize::from(nearest > 1e-3);
    });
    assert!(mixed > 100, "{mixed}");
}

#[test]
fn a_node_has_the_color_of_most_children_if_that_is_asked_for() {
    let options = Options { depth: 7, lod_color: LodColor::Majority, ..Options::default() };
    let tree = Tree::read(&convert_to_bytes(&colored_sphere(), &options).0);
    for_each_node(&tree.root, &mut |node| {
        let filled: Vec<Voxel> =
            node.children.iter().map(|child| child.voxel).filter(|voxel| !voxel.is_empty()).collect();
        let votes = |index: u16| filled.iter().filter(|voxel| voxel.palette_index == index).count();
        if let Some(most) = filled.iter().map(|voxel| votes(voxel.palette_index)).max() {
            assert_eq!(votes(node.voxel.palette_index), most);
        }
    });
}

#[test]
fn the_root_of_a_single_cell_is_its_voxel() {
    let (bytes, report) = convert_to_bytes(&colored_sphere(), &Options { depth: 0, ..Options::default() });
    assert_eq!((report.leaf_voxels, report.nodes, report.stored_voxels, report.thesis_voxels), (1, 0, 1, 1));
    assert_eq!(Tree::read(&bytes).root.children.len(), 0);
}

#[test]
fn counts_agree_with_the_file() {
    let mesh = colored_sphere();
    for depth in 0..=8 {
        for prune in [false, true] {
            let (bytes, report) = convert_to_bytes(&mesh, &Options { depth, prune, ..Options::default() });
            let summary = summarize(Reader::new(&bytes[..]).unwrap()).unwrap();
            assert!(summary.is_valid(), "{:?}", summary.first_defect);
            assert_eq!(summary.depth, depth);
            assert_eq!(summary.stored_voxels, report.stored_voxels);
            assert_eq!(summary.nodes, report.nodes);
            assert_eq!(summary.leaf_voxels, u128::from(report.leaf_voxels));
            assert_eq!(summary.file_bytes, report.file_bytes);
            assert_eq!(report.resolution, 1 << depth);
            if !prune {
                assert_eq!(report.thesis_voxels, report.stored_voxels);
            }
        }
    }
}

#[test]
fn the_bytes_are_those_of_the_writer() {
    let (bytes, _) = convert_to_bytes(&colored_sphere(), &Options { depth: 7, ..Options::default() });
    let mut reader = Reader::new(&bytes[..]).unwrap();
    let mut writer = Writer::new(Vec::new(), reader.palette()).unwrap();
    for record in &mut reader {
        let record = record.unwrap();
        if record.has_children { writer.node(record.voxel) } else { writer.leaf(record.voxel) }.unwrap();
    }
    assert!(writer.finish().unwrap() == bytes);
}

/// A stack of walls, one voxel apart, that fills a cube of cells and has one normal and one colour.
fn solid(from: u32, to: u32) -> Mesh {
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    let (low, high) = (f64::from(from), f64::from(to));
    for layer in from..to {
        let x = f64::from(layer) + 0.5;
        let first = positions.len() as u32;
        positions.extend([[x, low, low], [x, high, low], [x, high, high], [x, low, high]]);
        triangles.extend([[0, 1, 2], [0, 2, 3]].map(|triangle| triangle.map(|corner: u32| corner + first)));
    }
    Mesh::new(positions, triangles).unwrap()
}

#[test]
fn pruning_leaves_the_picture_as_it_is() {
    for mesh in
        [solid(0, 16), solid(3, 13), solid(4, 12), solid(0, 64), colored_sphere(), cuboid([0.0; 3], [1.0; 3])]
    {
        let depth = 8;
        let options = Options { depth, ..support::unit_voxels(depth) };
        let options = if mesh.positions().iter().flatten().any(|&c| c < 0.0) {
            Options { depth, ..Options::default() }
        } else {
            options
        };
        let (pruned, pruned_report) = convert_to_bytes(&mesh, &options);
        let (whole, whole_report) = convert_to_bytes(&mesh, &Options { prune: false, ..options });
        assert_eq!(Tree::read(&pruned).leaves(depth), Tree::read(&whole).leaves(depth));
        assert_eq!(pruned_report.leaf_voxels, whole_report.leaf_voxels);
        assert_eq!(pruned_report.thesis_voxels, whole_report.stored_voxels);
        assert!(pruned_report.stored_voxels <= whole_report.stored_voxels);
    }
}

#[test]
fn a_solid_cube_is_pruned_to_one_leaf() {
    // 64 and 128 cells are one block and eight of them, so both the blocks and the top of the tree are pruned.
    for (depth, size) in [(4, 8), (8, 64), (8, 128)] {
        let (bytes, report) = convert_to_bytes(&solid(0, size), &support::unit_voxels(depth));
        assert_eq!(report.leaf_voxels, u64::from(size).pow(3));
        let levels = u64::from(depth) - u64::from(size.trailing_zeros());
        assert_eq!(report.stored_voxels, 1 + 8 * levels);
        assert_eq!(Tree::read(&bytes).leaves(depth).len() as u64, report.leaf_voxels);
    }
    let (_, report) = convert_to_bytes(&solid(0, 16), &support::unit_voxels(4));
    assert_eq!((report.stored_voxels, report.nodes, report.leaf_voxels), (1, 0, 4096));
}
