//! A volume and its look, as a frame draws it.

use wavesplat_core::TransferFunction;

use crate::optics::labels::Labels;
use crate::optics::visibility_cache::VisibilityCache;
use crate::source::slices::Slices;

/// A volume and its look.
#[derive(Clone, Copy)]
pub struct Layer<'a> {
    /// The samples, ready for the kernel that they are drawn with.
    pub slices: &'a Slices<'a>,
    /// What values look like.
    pub transfer_function: &'a TransferFunction,
    /// A segmentation beside the volume; only drawn with `Composite::Over`.
    pub labels: Option<&'a Labels>,
    /// What is kept of the transfer function from frame to frame.
    pub cache: &'a VisibilityCache,
}
