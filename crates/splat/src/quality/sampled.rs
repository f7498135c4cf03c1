//! A frame in one of several sizes and samplings, with its plan.

use wavesplat_core::{RenderOptions, Result};

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

impl SampledFrame<'_> {
    /// The same frame with other options of size and sampling; light and labels are kept.
    pub fn with_options(&self, options: RenderOptions) -> Result<Self> {
        let plan = self.plan.resampled(self.layers, &options)?;
        Ok(Self { layers: self.layers, options, plan })
    }
}
