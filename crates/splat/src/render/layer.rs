//! A volume and its look, as a frame draws it, beside others or alone.

use wavesplat_core::{Shading, TransferFunction};

use crate::optics::labels::Labels;
use crate::optics::visibility_cache::VisibilityCache;
use crate::source::slices::Slices;

/// A volume and its look.
///
/// At a point of space the extinctions of layers add, and their colours, each shaded by its own gradient, mix by extinction:
/// the emission-absorption model with several media.
#[derive(Clone, Copy)]
pub struct Layer<'a> {
    /// The samples, ready for the kernel that they are drawn with.
    pub slices: &'a Slices<'a>,
    /// What values look like.
    pub transfer_function: &'a TransferFunction,
    /// Lights and coefficients; `None` draws the colours as given.
    pub shading: Option<&'a Shading>,
    /// A segmentation beside the volume, of the first layer; only drawn with `Composite::Over`.
    pub labels: Option<&'a Labels>,
    /// What is kept of the transfer function from frame to frame.
    pub cache: &'a VisibilityCache,
}
