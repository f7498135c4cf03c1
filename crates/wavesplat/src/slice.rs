//! Slices and thick slabs of a volume: values on a plane, not a picture ([`wavesplat_splat::slice_plane`]).

use wavesplat_compute::parallel;
use wavesplat_core::{Error, Kernel, RenderOptions, Result};
use wavesplat_splat::ProgressCallback;
use wavesplat_splat::slice_plane::{Plane, ThickSlab, plane_values};

use crate::scene::SceneVolume;

impl SceneVolume<'_> {
    /// Values at the pixels of a plane, or of a slab of planes, in sample units, row by row; NaN outside the volume and
    /// where samples are missing. `n_threads`: as in [`crate::FrameOptions`].
    ///
    /// # Errors
    ///
    /// [`Error`] if the plane has too many pixels or none, or the volume is not in memory; [`Error::Cancelled`].
    pub fn slice(
        &self,
        plane: &Plane,
        slab: &ThickSlab,
        kernel: Kernel,
        n_threads: Option<usize>,
        callback: &dyn ProgressCallback,
    ) -> Result<Vec<f32>> {
        let (width_px, height_px) = (plane.width_px, plane.height_px);
        RenderOptions { width_px, height_px, n_threads, ..RenderOptions::default() }.validate()?;
        if slab.n_planes == 0 {
            return Err(Error::out_of_range("planes of a slab", 0, "at least 1", "give 1 for a slice"));
        }
        if let Self::Lazy(_) = self {
            let mend = "read the box around the plane, and slice it";
            return Err(Error::out_of_range("volume of a slice", "a lazy one", "in memory", mend));
        }
        let slices = parallel::with_threads(n_threads, || self.slices(kernel));
        plane_values(&slices, plane, slab, n_threads, callback)
    }
}
