//! A frame in one of several sizes and samplings, with its plan.

use wavesplat_compute::simd::Level;
use wavesplat_core::{Camera, RenderOptions, Result};

use crate::quality::ladder::Sampling;
use crate::render::layer::Layer;
use crate::render::plan::Plan;

/// A planned frame that can be planned again in other sizes and samplings.
pub(crate) struct SampledFrame<'a> {
    /// Layers that are drawn.
    pub layers: &'a [Layer<'a>],
    /// Options, with size and sampling.
    pub options: RenderOptions,
    /// Plan of the frame with these options.
    pub plan: Plan,
}

impl<'a> SampledFrame<'a> {
    /// Plans a frame with a sampling.
    pub fn new(layers: &'a [Layer<'a>], camera: &Camera, options: &RenderOptions, sampling: Sampling) -> Result<Self> {
        let Sampling { sheets_per_slice, oversampling } = sampling;
        let options = RenderOptions { sheets_per_slice, oversampling, ..options.clone() };
        let plan = Plan::new(Level::best(), layers, camera, &options)?;
        Ok(Self { layers, options, plan })
    }
}

impl SampledFrame<'_> {
    /// The same frame with other options of size and sampling; light and labels are kept.
    pub fn with_options(&self, options: RenderOptions) -> Result<Self> {
        let plan = self.plan.resampled(self.layers, &options)?;
        Ok(Self { layers: self.layers, options, plan })
    }
}
