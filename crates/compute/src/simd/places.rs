//! Places of sixteen lanes in a row of numbers, for [`Simd::gather`](super::Simd::gather).

use super::{LANES, Lanes};

/// Indices of sixteen lanes in a row; they rise or fall from lane to lane.
#[derive(Clone, Copy, Debug, Default)]
pub struct Places {
    /// Index of each lane.
    pub(super) index: Lanes<u32>,
    /// Lowest index of the first and of the last eight lanes.
    #[cfg_attr(
        not(any(target_arch = "x86_64", target_feature = "simd128")),
        allow(dead_code, reason = "only permutations of a few registers need it")
    )]
    pub(super) starts: [u32; 2],
    nearness: Nearness,
}

/// How near to the row's beginning, and to each other, the places of sixteen lanes lie.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Nearness {
    /// All indices are below 16, and the indices of each eight lanes span at most 8 numbers.
    Near,
    /// All indices are below 32, and the indices of each eight lanes span at most 16 numbers.
    Far,
    /// Any indices.
    #[default]
    Any,
}

/// Numbers from a row's beginning on that may be read of places that are [`Nearness::Near`].
pub const NEAR_ROOM: usize = 24;

/// The same of places that are [`Nearness::Far`].
pub const FAR_ROOM: usize = 48;

impl Places {
    /// Places at indices that rise or fall from lane to lane.
    #[inline(always)]
    pub fn new(index: Lanes<u32>) -> Self {
        const HALF: usize = LANES / 2;
        let i = &index.0;
        let (a, b, c, d) = (i[0], i[HALF - 1], i[HALF], i[LANES - 1]);
        let spans = a.abs_diff(b).max(c.abs_diff(d)) as usize;
        let last = a.max(d) as usize;
        let nearness = if last < LANES && spans < HALF {
            Nearness::Near
        } else if last < 2 * LANES && spans < LANES {
            Nearness::Far
        } else {
            Nearness::Any
        };
        Self { index, starts: [a.min(b), c.min(d)], nearness }
    }

    /// Index of each lane.
    pub fn index(&self) -> &Lanes<u32> {
        &self.index
    }

    /// How near the places lie.
    #[inline(always)]
    pub fn nearness(&self) -> Nearness {
        self.nearness
    }
}
