//! Lane by lane, in plain Rust: what an instruction set's own file replaces.

/// `table[index[i]]` for each lane whose mask word is not zero, elsewhere `otherwise[i]`.
///
/// # Safety
/// In each lane whose mask word is not zero, the index is less than `table.len()`.
#[inline(always)]
pub unsafe fn gather<const N: usize>(
    table: &[u32],
    index: [u32; N],
    mask: [u32; N],
    otherwise: [u32; N],
) -> [u32; N] {
    let mut out = otherwise;
    for lane in 0..N {
        if mask[lane] != 0 {
            debug_assert!((index[lane] as usize) < table.len());
            // SAFETY: the mask word is set, so the caller promises that the index is within the table.
            out[lane] = unsafe { *table.get_unchecked(index[lane] as usize) };
        }
    }
    out
}

/// The first three words of `rows[index[i]]`.
///
/// # Safety
/// All indices are less than `rows.len()`.
#[inline(always)]
pub unsafe fn gather_rows<const N: usize>(rows: &[[u32; 4]], index: [u32; N]) -> [[u32; N]; 3] {
    let mut columns = [[0; N]; 3];
    for lane in 0..N {
        debug_assert!((index[lane] as usize) < rows.len());
        // SAFETY: the caller promises that the row is there.
        let row = unsafe { rows.get_unchecked(index[lane] as usize) };
        for (column, word) in columns.iter_mut().zip(row) {
            column[lane] = *word;
        }
    }
    columns
}
