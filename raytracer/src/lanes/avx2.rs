//! What AVX2 adds to `wide`: gathers.

/// Gathers of words, by the instruction.
pub mod gather {
    use std::arch::x86_64::{__m128i, __m256i, _mm_mask_i32gather_epi32, _mm256_mask_i32gather_epi32};

    macro_rules! gather {
        ($name:ident, $count:literal, $vector:ty, $instruction:ident) => {
            /// `table[index[i]]` for each lane whose mask word is all ones, elsewhere `otherwise[i]`.
            ///
            /// # Safety
            /// In each lane whose mask word is set, the index is less than `table.len()`, which is at most 2³¹.
            #[inline(always)]
            pub unsafe fn $name(
                table: &[u32],
                index: [u32; $count],
                mask: [u32; $count],
                otherwise: [u32; $count],
            ) -> [u32; $count] {
                let (index, mask, otherwise): ($vector, $vector, $vector) =
                    (bytemuck::cast(index), bytemuck::cast(mask), bytemuck::cast(otherwise));
                // SAFETY: this file is compiled only with AVX2 enabled; the caller promises that the lanes
                // whose mask is set, and no others are read, have their index within the table.
                let words = unsafe { $instruction::<4>(otherwise, table.as_ptr().cast(), index, mask) };
                bytemuck::cast(words)
            }
        };
    }

    gather!(four, 4, __m128i, _mm_mask_i32gather_epi32);
    gather!(eight, 8, __m256i, _mm256_mask_i32gather_epi32);
}
