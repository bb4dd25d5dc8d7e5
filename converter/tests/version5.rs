//! Files of version 5: the same octree as in version 4, with finer normals, and its place in the world.

mod support;

use octvox_converter::{Compression, FileFormat, Material, Mesh, Options};
use octvox_format::v5::{Archive, Region, summarize};
use octvox_format::{AnyReader, NormalCode, Reader, Record, SphericalNormal};
use std::io::Cursor;
use support::{convert_to_bytes, icosphere, torus};

const PACKED: FileFormat = FileFormat::Version5 { compression: Compression::Zstandard };
const PLAIN: FileFormat = FileFormat::Version5 { compression: Compression::None };

fn colored_torus() -> Mesh {
    let torus = torus([5.0, -3.0, 100.0], 3.0, 1.0, 40, 20);
    let materials = (0..7).map(|k| Material::matte("", [f64::from(k) / 7.0; 3])).collect();
    let of_triangle = (0..torus.triangles().len() as u32).map(|triangle| triangle / 11 % 7).collect();
    torus.with_materials(materials, of_triangle).unwrap()
}

fn records(bytes: &[u8]) -> Vec<Record> {
    let records = AnyReader::new(Cursor::new(bytes)).unwrap().records().unwrap();
    records.collect::<Result<_, _>>().unwrap()
}

/// Degrees between two normals.
fn angle(a: [f32; 3], b: [f32; 3]) -> f64 {
    let cosine: f64 = (0..3).map(|axis| f64::from(a[axis]) * f64::from(b[axis])).sum();
    cosine.min(1.0).acos().to_degrees()
}

#[test]
fn the_octree_is_that_of_version_4() {
    let mesh = colored_torus();
    for depth in [0, 1, 5, 6, 7, 8] {
        // What is pruned depends on the normals.
        let options = Options { depth, prune: false, ..Options::default() };
        let (expected, report) = convert_to_bytes(&mesh, &options);
        let (bytes, report_5) = convert_to_bytes(&mesh, &Options { format: PACKED, ..options });
        assert_eq!((report.format, report_5.format), (4, 5));
        let colors: Vec<_> = AnyReader::new(&bytes[..])
            .unwrap()
            .materials()
            .materials()
            .iter()
            .map(|material| material.diffuse)
            .collect();
        assert_eq!(colors, Reader::new(&expected[..]).unwrap().palette().colors());
        let (expected, found) = (records(&expected), records(&bytes));
        assert_eq!(expected.len(), found.len());
        let (mut filled, mut differences) = (0, 0);
        for (expected, found) in expected.iter().zip(&found) {
            assert_eq!((expected.level, expected.octant), (found.level, found.octant));
            assert_eq!(expected.has_children, found.has_children);
            assert_eq!(expected.voxel.palette_index, found.voxel.palette_index);
            if !expected.voxel.is_empty() {
                filled += 1;
                let apart = angle(expected.voxel.normal.decode(), found.voxel.normal.decode());
                // Each code, and the levels of detail that are computed from codes, are off by so much at most.
                let worst = 3.0 * f64::from(SphericalNormal::WORST_ANGLE_DEGREES);
                differences += u64::from(apart > worst);
            }
        }
        assert_eq!(report_5.stored_voxels, filled);
        // Where normals nearly cancel out, as in large cells, anything may be left.
        assert!(depth < 5 || differences * 100 <= filled, "{differences} of {filled}");
    }
}

#[test]
fn the_file_is_valid_and_says_what_the_report_says() {
    let mesh = colored_torus();
    for (depth, format, prune) in [(0, PACKED, true), (4, PLAIN, true), (8, PACKED, true), (8, PLAIN, false)]
    {
        let options = Options { depth, format, prune, ..Options::default() };
        let (bytes, report) = convert_to_bytes(&mesh, &options);
        let reader = octvox_format::v5::Reader::new(&bytes[..]).unwrap();
        let header = reader.header().clone();
        assert_eq!((header.depth, header.normal_code), (depth, NormalCode::Octahedral));
        assert!(header.writer.starts_with("obj2vox "));
        let world = header.world.unwrap();
        assert_eq!((world.origin, world.voxel_size), (report.world.origin, report.world.voxel_size));
        let (summary, _) = summarize(reader).unwrap();
        assert!(summary.is_valid());
        assert_eq!(summary.leaf_voxels, u128::from(report.leaf_voxels));
        assert_eq!((summary.nodes, summary.stored_voxels), (report.nodes, report.stored_voxels));
        assert_eq!(summary.file_bytes, report.file_bytes);
    }
}

#[test]
fn compression_changes_the_length_and_nothing_else() {
    let mesh = colored_torus();
    let convert = |format| convert_to_bytes(&mesh, &Options { depth: 8, format, ..Options::default() }).0;
    let (packed, plain) = (convert(PACKED), convert(PLAIN));
    assert!(packed.len() * 10 < plain.len() * 9, "{} and {}", packed.len(), plain.len());
    let (packed, plain) = (Archive::of_bytes(&packed).unwrap(), Archive::of_bytes(&plain).unwrap());
    assert_eq!(packed.subtree_count(), plain.subtree_count());
    for number in 0..plain.subtree_count() {
        assert_eq!(packed.subtree(number).unwrap(), plain.subtree(number).unwrap());
    }
}

#[test]
fn a_region_can_be_read_on_its_own() {
    let mesh = icosphere([0.0; 3], 1.0, 3);
    let (bytes, _) = convert_to_bytes(&mesh, &Options { depth: 9, format: PACKED, ..Options::default() });
    let archive = Archive::of_bytes(&bytes).unwrap();
    let all = archive.subtree_count();
    let corner = archive.subtrees_in(Region { low: [0; 3], high: [256; 3] }).count();
    assert!(corner > 0 && corner * 4 < all, "{corner} of {all}");
}
