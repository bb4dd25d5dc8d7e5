//! Morton codes: the cells of a level in the order of the file.

/// The coordinates of a cell from its Morton code: of each three bits the lowest is of x, the next of y, the highest
/// of z.
#[must_use]
pub fn cell_of_code(code: u64) -> [u32; 3] {
    [code, code >> 1, code >> 2].map(gather)
}

/// The Morton code of a cell whose coordinates have at most 21 bits.
#[must_use]
pub fn code_of_cell(cell: [u32; 3]) -> u64 {
    let [x, y, z] = cell.map(spread);
    x | y << 1 | z << 2
}

/// For runs of 1, 2, 4, 8 and 16 bits: their length, and the places of their bits when the runs begin three lengths apart.
const SPREAD: [(u32, u64); 5] = [
    (1, 0x1249_2492_4924_9249),
    (2, 0x10C3_0C30_C30C_30C3),
    (4, 0x100F_00F0_0F00_F00F),
    (8, 0x001F_0000_FF00_00FF),
    (16, 0x001F_0000_0000_FFFF),
];

/// Every third bit, from the lowest on.
fn gather(code: u64) -> u32 {
    let [first, steps @ ..] = SPREAD;
    let mut bits = code & first.1;
    let mut distance = 2 * first.0;
    for (length, places) in steps {
        bits = (bits | bits >> distance) & places;
        distance = 2 * length;
    }
    (bits | bits >> distance) as u32 & ((1 << 21) - 1)
}

/// The lowest 21 bits, three places apart.
fn spread(coordinate: u32) -> u64 {
    let bits = u64::from(coordinate) & ((1 << 21) - 1);
    SPREAD.iter().rev().fold(bits, |bits, (length, places)| (bits | bits << (2 * length)) & places)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_code_is_a_path_of_octants() {
        // Octants x + 2y + 4z from the root down: 1 (x), 6 (y and z), 3 (x and y).
        assert_eq!(cell_of_code(0o163), [0b101, 0b011, 0b010]);
        assert_eq!(cell_of_code((1 << 63) - 1), [(1 << 21) - 1; 3]);
    }

    #[test]
    fn cells_come_back() {
        for code in (0..1 << 63).step_by(0x3FF_FFFF_FFFF_FFA7 / 1000) {
            assert_eq!(code_of_cell(cell_of_code(code)), code);
        }
    }
}
