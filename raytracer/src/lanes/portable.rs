//! Lane by lane, in plain Rust: what an instruction set's own file replaces.

/// The words of `rows[index[i]]`.
///
/// # Safety
/// All indices are less than `rows.len()`.
#[inline(always)]
pub unsafe fn gather_rows<const N: usize>(rows: &[[u32; 4]], index: [u32; N]) -> [[u32; N]; 4] {
    let mut columns = [[0; N]; 4];
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
