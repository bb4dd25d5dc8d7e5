//! Which cells of an octree are filled: a child mask for each node, level by level.

/// The child masks of an octree, from the root's level down to the one above the finest.
///
/// Within a level the nodes stand in Morton order. Bit k of a mask says whether the child of octant k is filled, so the
/// set bits of a level, in order, are the nodes of the next one.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Structure {
    pub levels: Vec<Vec<u8>>,
}

impl Structure {
    /// From a bit for each cell of the finest level in Morton order, of which there are 8^`depth`. At least one is set.
    pub(crate) fn from_occupancy(occupied: &[u64], depth: u32) -> Self {
        let mut levels = vec![Vec::new(); depth as usize];
        // The masks of all cells of a level, empty ones too, eight at a time.
        let mut above: Vec<u64> = Vec::new();
        let mut dense = occupied;
        for level in levels.iter_mut().rev() {
            let next: Vec<u64> = dense
                .chunks(8)
                .map(|words| {
                    let mut masks = [0; 8];
                    for (mask, &word) in masks.iter_mut().zip(words) {
                        *mask = filled_bytes(word);
                    }
                    u64::from_le_bytes(masks)
                })
                .collect();
            for &word in dense.iter().filter(|word| **word != 0) {
                level.extend(word.to_le_bytes().into_iter().filter(|&mask| mask != 0));
            }
            above = next;
            dense = &above;
        }
        drop(above);
        Self { levels }
    }

    /// From the Morton codes of the filled cells of the finest level, ascending and without repetition.
    pub(crate) fn from_codes(codes: &[u32], depth: u32) -> Self {
        let mut levels = vec![Vec::new(); depth as usize];
        let mut codes = codes.to_vec();
        for level in levels.iter_mut().rev() {
            let masks: &mut Vec<u8> = level;
            let mut parents: Vec<u32> = Vec::new();
            for code in codes {
                if parents.last() != Some(&(code >> 3)) {
                    parents.push(code >> 3);
                    masks.push(0);
                }
                if let Some(mask) = masks.last_mut() {
                    *mask |= 1 << (code & 7);
                }
            }
            codes = parents;
        }
        Self { levels }
    }

    /// Calls `visit` with the Morton code of each filled cell of the finest level, in Morton order.
    pub(crate) fn for_each_leaf(&self, mut visit: impl FnMut(u32)) {
        let mut codes = vec![0u32];
        let Some((finest, upper)) = self.levels.split_last() else { return visit(0) };
        for masks in upper {
            let mut next = Vec::with_capacity(masks.len() * 4);
            for (&code, &mask) in codes.iter().zip(masks) {
                for_each_bit(mask, |octant| next.push(code << 3 | octant));
            }
            codes = next;
        }
        for (&code, &mask) in codes.iter().zip(finest) {
            for_each_bit(mask, |octant| visit(code << 3 | octant));
        }
    }

    /// Number of nodes that have children: cubes that are leaves above the finest level have none.
    pub(crate) fn nodes_with_children(&self) -> u64 {
        self.levels.iter().flatten().filter(|mask| **mask != 0).count() as u64
    }
}

/// Calls `visit` with the number of each bit that is set, ascending.
#[inline]
fn for_each_bit(mask: u8, mut visit: impl FnMut(u32)) {
    let mut rest = mask;
    while rest != 0 {
        visit(rest.trailing_zeros());
        rest &= rest - 1;
    }
}

/// A bit for each byte of the word that is not zero.
pub(crate) fn filled_bytes(word: u64) -> u8 {
    const LOW: u64 = 0x7f7f_7f7f_7f7f_7f7f;
    // The highest bit of each byte: whether it or any below is set. No sum leaves its byte.
    let highest = (((word & LOW) + LOW) | word) & !LOW;
    // Moves bit 8k + 7 to bit 56 + k; no two products meet at a bit.
    ((highest >> 7).wrapping_mul(0x0102_0408_1020_4080) >> 56) as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn bytes_that_are_not_zero(bytes: [u8; 8], kept: u8) {
            let bytes: [u8; 8] = std::array::from_fn(|k| if kept >> k & 1 == 1 { bytes[k] } else { 0 });
            let expected = (0..8).fold(0, |mask, k| mask | u8::from(bytes[k] != 0) << k);
            prop_assert_eq!(filled_bytes(u64::from_le_bytes(bytes)), expected);
        }

        #[test]
        fn occupancy_and_codes_give_the_same(depth in 0u32..4, picks in prop::collection::vec(any::<u32>(), 1..60)) {
            let cells = 1u32 << (3 * depth);
            let codes: Vec<u32> =
                picks.iter().map(|pick| pick % cells).collect::<std::collections::BTreeSet<_>>().into_iter().collect();
            let mut occupied = vec![0u64; (cells as usize).div_ceil(64)];
            for &code in &codes {
                occupied[code as usize / 64] |= 1 << (code % 64);
            }
            let structure = Structure::from_occupancy(&occupied, depth);
            prop_assert_eq!(&structure, &Structure::from_codes(&codes, depth));
            for (level, masks) in structure.levels.iter().enumerate() {
                let shift = 3 * (depth as usize - level);
                let nodes: std::collections::BTreeSet<u32> = codes.iter().map(|code| code >> shift).collect();
                prop_assert_eq!(masks.len(), nodes.len());
                prop_assert!(masks.iter().all(|&mask| mask != 0));
            }
        }
    }
}
