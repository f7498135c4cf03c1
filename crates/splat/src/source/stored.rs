//! Samples as they are stored, for backends that copy them into memory of their own.

use wavesplat_compute::simd::Level;
use wavesplat_core::Samples;

use crate::source::slices::{SampleSource, Slices, is_identity};
use crate::source::window::Window;

impl<'a> Slices<'a> {
    /// Samples in their own type, if they are the densities; `None` where densities are computed from them.
    pub fn own_samples(&self) -> Option<Samples<'a>> {
        match &self.source {
            SampleSource::Samples(samples)
                if self.prepared.densities.is_none() && is_identity(self.grid().density_from_sample()) =>
            {
                Some(*samples)
            }
            _ => None,
        }
    }

    /// Writes densities, or coefficients, of a slice along z, row by row, with the border that the kernel folds back.
    /// `window`: columns and rows, before folding.
    pub fn density_slice(&self, z: usize, window: Window, out: &mut Vec<f32>) {
        let stride = window.n_u();
        out.clear();
        out.resize(stride * window.n_v(), 0.0);
        self.combine(Level::best(), [0, 1, 2], &[(z, 1.0)], None, window, out, stride);
    }

    /// Mask of the samples that are drawn as empty, `[z][y][x]`; `None` where there are none.
    pub fn holes(&self) -> Option<&[bool]> {
        self.prepared.mask.as_deref()
    }
}
