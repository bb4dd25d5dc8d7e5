//! The example of Bohnen 2009, figure 17, through the whole chain: nine voxels, known to the bit.

use octvox_format::{Reader, Record, SphericalNormal, Voxel, Writer};
use octvox_raytracer::{Octree, Ray, RenderOptions};
use octvox_tests::pictures::picture;
use octvox_tests::{FIGURE_17, rays};
use std::io::Cursor;

/// The records as they stand in the figure: palette index, theta, phi.
const RECORDS: [(u16, u8, u8); 9] = [
    (2, 0xA1, 0x76),
    (2, 0x3D, 0x42),
    (1, 0x91, 0xBC),
    (2, 0x1C, 0xAA),
    (1, 0x74, 0x32),
    (2, 0x4A, 0x8F),
    (1, 0x88, 0xE2),
    (2, 0xF9, 0xC5),
    (1, 0x61, 0x5D),
];

fn voxel((palette_index, theta, phi): (u16, u8, u8)) -> Voxel {
    Voxel { palette_index, normal: SphericalNormal { theta, phi: phi as i8 } }
}

fn octree() -> Octree {
    Octree::read(Cursor::new(FIGURE_17)).unwrap()
}

#[test]
fn the_reader_finds_the_records_of_the_figure() {
    let mut reader = Reader::new(&FIGURE_17[..]).unwrap();
    assert_eq!(reader.palette().colors(), [[255; 3], [0; 3]]);
    let records: Vec<Record> = reader.by_ref().collect::<Result<_, _>>().unwrap();
    let expected = RECORDS.iter().enumerate().map(|(place, &record)| Record {
        level: u8::from(place > 0),
        octant: place.saturating_sub(1) as u8,
        voxel: voxel(record),
        has_children: place == 0,
    });
    assert_eq!(records, expected.collect::<Vec<_>>());
}

#[test]
fn it_is_written_back_bit_for_bit() {
    let mut reader = Reader::new(&FIGURE_17[..]).unwrap();
    let mut writer = Writer::new(Vec::new(), reader.palette()).unwrap();
    for record in reader.by_ref() {
        let record = record.unwrap();
        if record.has_children { writer.node(record.voxel) } else { writer.leaf(record.voxel) }.unwrap();
    }
    assert_eq!(writer.finish().unwrap(), FIGURE_17);
}

#[test]
fn the_octree_in_memory_holds_the_voxels_of_the_figure() {
    let octree = octree();
    assert_eq!((octree.depth(), octree.resolution(), octree.leaf_voxels()), (1, 2, 8));
    assert_eq!((octree.bounds().low, octree.bounds().high), ([0; 3], [2; 3]));
    for (octant, &record) in RECORDS[1..].iter().enumerate() {
        let cell = [0, 1, 2].map(|axis| (octant >> axis & 1) as u32);
        assert_eq!(octree.voxel(cell).unwrap().voxel(), voxel(record), "cell {cell:?}");
    }
}

#[test]
fn a_ray_to_each_voxel_hits_it() {
    let octree = octree();
    for octant in 0..8 {
        let cell = [0, 1, 2].map(|axis| octant >> axis & 1);
        let from_outside = cell.map(|upper| if upper == 1 { 2.75 } else { -1.75 });
        let centre = cell.map(|upper| if upper == 1 { 0.75 } else { 0.25 });
        let ray = rays::between(from_outside.into(), centre.into());
        let [hit] = rays::hits_of_every_width(&octree, &[ray])[..] else { panic!() };
        let hit = hit.unwrap();
        assert_eq!(hit.cell, cell.map(|upper| upper as u32));
        assert_eq!(hit.payload.voxel(), voxel(RECORDS[1 + octant as usize]));
        // From −1.75 it is 1.75 to the corner of the cube and 2 to the centre of the voxel.
        assert_eq!(hit.distance, 1.75 / 2.0);
    }
}

#[test]
fn a_picture_from_the_front_shows_black_beside_white() {
    let octree = octree();
    let options = RenderOptions { size: [64, 64], first_hits: true, ..RenderOptions::default() };
    let frame = picture(&octree, &options);
    assert!(frame.hit_pixels > 64 * 64 / 4 && frame.hit_pixels < 64 * 64);
    // Pixel by pixel, what is seen is what a ray finds.
    let hits = frame.first_hits.as_ref().unwrap();
    assert_eq!(hits.iter().filter(|hit| hit.distance.is_finite()).count() as u64, frame.hit_pixels);
    let normals: Vec<[f32; 3]> = RECORDS[1..].iter().map(|&record| voxel(record).normal.decode()).collect();
    for hit in hits.iter().filter(|hit| hit.distance.is_finite()) {
        assert!(normals.contains(&hit.normal));
        assert_eq!(hit.level, 1);
    }
}

#[test]
fn a_ray_that_misses_the_cube_hits_nothing() {
    let ray = Ray { origin: [-1.0, 1.5, 0.5].into(), direction: [1.0, 0.0, 0.0].into() };
    assert!(rays::hits_of_every_width(&octree(), &[ray])[0].is_none());
}
