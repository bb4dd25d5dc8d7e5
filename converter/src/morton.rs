//! Morton codes: the bits of three coordinates in turn, x lowest.
//!
//! Ascending codes are the preorder of the octree's cells on a level, and the lowest three bits are the octant.

/// Coordinates of a block of voxels have at most this many bits.
pub(crate) const TABLE_BITS: u32 = 6;

/// The code of a coordinate on the x axis, for those below 64; shifted by one and two it is that of y and z.
#[inline]
pub(crate) fn spread_in_block(coordinate: i64) -> u32 {
    SPREAD[coordinate as usize % SPREAD.len()]
}

static SPREAD: [u32; 1 << TABLE_BITS] = {
    let mut table = [0; 1 << TABLE_BITS];
    let mut coordinate = 0;
    while coordinate < table.len() {
        table[coordinate] = spread(coordinate as u32);
        coordinate += 1;
    }
    table
};

/// Moves bit k of a coordinate of at most ten bits to bit 3k.
const fn spread(coordinate: u32) -> u32 {
    let mut code = coordinate & 0x3ff;
    code = (code | code << 16) & 0x0300_00ff;
    code = (code | code << 8) & 0x0300_f00f;
    code = (code | code << 4) & 0x030c_30c3;
    (code | code << 2) & 0x0924_9249
}

/// Moves bit 3k of a code to bit k.
const fn gather(code: u32) -> u32 {
    let mut coordinate = code & 0x0924_9249;
    coordinate = (coordinate | coordinate >> 2) & 0x030c_30c3;
    coordinate = (coordinate | coordinate >> 4) & 0x0300_f00f;
    coordinate = (coordinate | coordinate >> 8) & 0x0300_00ff;
    (coordinate | coordinate >> 16) & 0x3ff
}

/// The code of a cell whose coordinates have at most ten bits.
pub(crate) const fn encode([x, y, z]: [u32; 3]) -> u32 {
    spread(x) | spread(y) << 1 | spread(z) << 2
}

/// The cell of a code.
pub(crate) const fn decode(code: u32) -> [u32; 3] {
    [gather(code), gather(code >> 1), gather(code >> 2)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn x_is_lowest() {
        assert_eq!(
            [encode([1, 0, 0]), encode([0, 1, 0]), encode([0, 0, 1]), encode([2, 0, 0])],
            [1, 2, 4, 8]
        );
    }

    proptest! {
        #[test]
        fn bits_stand_in_turn(cell in prop::array::uniform3(0u32..1024)) {
            let code = encode(cell);
            prop_assert_eq!(decode(code), cell);
            for (axis, coordinate) in cell.iter().enumerate() {
                for bit in 0..10 {
                    prop_assert_eq!(code >> (3 * bit + axis) & 1, coordinate >> bit & 1);
                }
            }
            if cell.iter().all(|&coordinate| coordinate < 64) {
                let [x, y, z] = cell.map(|coordinate| spread_in_block(coordinate.into()));
                prop_assert_eq!(code, x | y << 1 | z << 2);
            }
        }
    }
}
