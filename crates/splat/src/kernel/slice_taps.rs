//! Weights of the slices that reach a sheet: the kernel sliced along w.

use std::ops::Deref;

use crate::kernel::weights::MAX_DIFFERENCE_TAPS;

/// One tap along the sheet axis: folded slice index and weight.
pub type SliceTap = (usize, f32);

/// The slices that reach a sheet, with their weights.
#[derive(Clone, Copy, Debug, Default)]
pub struct SliceTaps {
    pub(super) taps: [SliceTap; MAX_DIFFERENCE_TAPS],
    pub(super) n: usize,
}

impl Deref for SliceTaps {
    type Target = [SliceTap];

    fn deref(&self) -> &[SliceTap] {
        &self.taps[..self.n]
    }
}
