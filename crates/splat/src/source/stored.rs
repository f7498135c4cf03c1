//! The samples as they are stored: what a backend with memory of its own copies.

use wavesplat_compute::simd::Level;
use wavesplat_core::Samples;

use crate::source::slices::{SampleSource, Slices, is_identity};
use crate::source::window::Window;

impl<'a> Slices<'a> {
    /// The samples in their own type, where they are the densities; `None` where these are computed.
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

    /// Densities, or coefficients, of a slice along z with those around it that the kernel folds back, row by row.
    /// `window`: columns and rows, before folding.
    pub fn density_slice(&self, z: usize, window: Window, out: &mut Vec<f32>) {
        let stride = window.n_u();
        out.clear();
        out.resize(stride * window.n_v(), 0.0);
        self.combine(Level::best(), [0, 1, 2], &[(z, 1.0)], None, window, out, stride);
    }

    /// Samples that are drawn as empty, `[z][y][x]`, where there are some.
    pub fn holes(&self) -> Option<&[bool]> {
        self.prepared.mask.as_deref()
    }
}
