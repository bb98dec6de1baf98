//! Set lanes of a group of sixteen, for use inside loops that the compiler vectorises.
//!
//! A function compiled for several instruction sets must not pass closures to the library: the
//! library's code is not recompiled for the instruction set. Loops therefore write each condition
//! into an array, one byte per lane, and this module reads the array.

use std::hint::black_box;

/// Lanes of a group.
pub(crate) const LANES: usize = 16;

/// Returns a mask with one bit per lane, from lanes that are 0 or 1.
#[inline]
fn bits(lanes: [u8; LANES]) -> u32 {
    // Without the barrier the compiler tests the lanes one by one instead of all sixteen at once.
    let bytes = u128::from_le_bytes(black_box(lanes));
    // Gathers the lowest bits of eight bytes in the highest byte.
    let packed = |eight: u64| (eight.wrapping_mul(0x0102_0408_1020_4080) >> 56) as u32;
    packed(bytes as u64) | packed((bytes >> 64) as u64) << 8
}

/// Indices of the set lanes, ascending.
#[derive(Debug)]
pub(crate) struct SetLanes(u32);

impl SetLanes {
    /// Collects the lanes that are 1. Every lane must be 0 or 1.
    #[inline]
    pub(crate) fn of(lanes: [u8; LANES]) -> Self {
        Self(bits(lanes))
    }
}

impl Iterator for SetLanes {
    type Item = usize;

    #[inline]
    fn next(&mut self) -> Option<usize> {
        if self.0 == 0 {
            return None;
        }
        let lane = self.0.trailing_zeros() as usize;
        self.0 &= self.0 - 1;
        Some(lane)
    }
}

/// Returns the indices of the marks that are 1, ascending. Every mark must be 0 or 1; most should
/// be 0.
pub(crate) fn marked(marks: &[u8]) -> impl Iterator<Item = usize> + '_ {
    let (groups, rest) = marks.as_chunks::<LANES>();
    let some = groups.iter().enumerate().filter(|(_, group)| u128::from_le_bytes(**group) != 0);
    let in_groups = some.flat_map(|(k, group)| SetLanes::of(*group).map(move |lane| k * LANES + lane));
    let in_rest = rest.iter().enumerate().filter(|(_, mark)| **mark != 0);
    in_groups.chain(in_rest.map(|(k, _)| groups.len() * LANES + k))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_found_wherever_they_are() {
        for len in [0, 1, 15, 16, 17, 64, 83] {
            let is_marked = |k: usize| k % 7 == 3 || k + 1 == len || k == 40;
            let marks: Vec<u8> = (0..len).map(|k| u8::from(is_marked(k))).collect();
            let expected: Vec<usize> = (0..len).filter(|k| is_marked(*k)).collect();
            assert_eq!(marked(&marks).collect::<Vec<_>>(), expected, "{len}");
        }
    }

    #[test]
    fn lanes_are_told_in_their_order() {
        for set in [0, 1, 0x8000, 0x1234, 0xffff_u32] {
            let lanes: [u8; LANES] = std::array::from_fn(|k| (set >> k & 1) as u8);
            assert_eq!(bits(lanes), set);
            let expected: Vec<usize> = (0..LANES).filter(|k| set >> k & 1 == 1).collect();
            assert_eq!(SetLanes::of(lanes).collect::<Vec<_>>(), expected);
        }
    }
}
