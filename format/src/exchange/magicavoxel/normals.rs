//! Normals for voxels that have none: away from where other voxels are.

use crate::v5::{cell_of_code, code_of_cell};
use crate::{NormalCode, OctahedralNormal};
use rayon::prelude::*;

/// The normal of each cell of a level that is named by its Morton code, ascending: the sum of the directions to those of the
/// 26 cells around it that are empty. Cells beyond the cube are empty too.
pub(super) fn normals(codes: &[u64], depth: u8) -> Vec<[u8; 2]> {
    let side = 1_i64 << depth;
    let is_filled = |cell: [i64; 3]| {
        let is_inside = cell.iter().all(|coordinate| (0..side).contains(coordinate));
        is_inside && codes.binary_search(&code_of_cell(cell.map(|coordinate| coordinate as u32))).is_ok()
    };
    let normal = |code: &u64| {
        let cell = cell_of_code(*code).map(i64::from);
        let mut sum = [0.0_f32; 3];
        for z in -1..=1_i64 {
            for y in -1..=1_i64 {
                for x in -1..=1_i64 {
                    let way = [x, y, z];
                    let steps = x.abs() + y.abs() + z.abs();
                    if steps > 0 && !is_filled(std::array::from_fn(|axis| cell[axis] + way[axis])) {
                        let length = (steps as f32).sqrt();
                        (0..3).for_each(|axis| sum[axis] += way[axis] as f32 / length);
                    }
                }
            }
        }
        NormalCode::Octahedral.encode(snapped(sum))
    };
    codes.par_iter().map(normal).collect()
}

/// Without what rounding has left of directions that cancel out.
fn snapped(vector: [f32; 3]) -> [f32; 3] {
    vector.map(|component| if component.abs() < 1e-4 { 0.0 } else { component })
}

/// The mean of some normals; the first if they cancel out.
pub(super) fn mean(normals: &[[u8; 2]]) -> [u8; 2] {
    let Some((first, others)) = normals.split_first() else { return OctahedralNormal::default().to_bytes() };
    if others.iter().all(|normal| normal == first) {
        return *first;
    }
    let mut sum = [0.0; 3];
    for normal in normals {
        let direction = NormalCode::Octahedral.decode(*normal);
        (0..3).for_each(|axis| sum[axis] += direction[axis]);
    }
    let sum = snapped(sum);
    if sum == [0.0; 3] { *first } else { NormalCode::Octahedral.encode(sum) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_faces_of_a_box_face_outwards() {
        // A box of 6³ cells in the middle of 8³.
        let mut codes: Vec<u64> = (0..512)
            .filter(|code| cell_of_code(*code).iter().all(|coordinate| (1..7).contains(coordinate)))
            .collect();
        codes.sort_unstable();
        let normals = normals(&codes, 3);
        let normal =
            |cell| NormalCode::Octahedral.decode(normals[codes.binary_search(&code_of_cell(cell)).unwrap()]);
        assert_eq!(normal([1, 3, 4]), [-1.0, 0.0, 0.0]);
        assert_eq!(normal([3, 6, 4]), [0.0, 1.0, 0.0]);
        assert_eq!(normal([3, 4, 1]), [0.0, 0.0, -1.0]);
        let corner = normal([6, 6, 6]);
        assert!(corner.iter().all(|component| (component - 0.577).abs() < 0.01), "{corner:?}");
    }

    #[test]
    fn means_lie_between() {
        let encode = |normal| NormalCode::Octahedral.encode(normal);
        let [x, y, back] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]].map(encode);
        assert_eq!(mean(&[x, y]), encode([1.0, 1.0, 0.0]));
        assert_eq!(mean(&[x, back]), x);
        assert_eq!(mean(&[y, y]), y);
    }
}
