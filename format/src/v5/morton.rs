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

/// Every third bit, from the lowest on.
fn gather(code: u64) -> u32 {
    (0..21).fold(0, |coordinate, bit| coordinate | ((code >> (3 * bit) & 1) as u32) << bit)
}

/// The bits, three places apart.
fn spread(coordinate: u32) -> u64 {
    (0..21).fold(0, |code, bit| code | u64::from(coordinate >> bit & 1) << (3 * bit))
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
