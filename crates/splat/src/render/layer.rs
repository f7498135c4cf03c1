//! Layer of a frame: a volume and its look.

use wavesplat_core::{Shading, TransferFunction};

use crate::optics::labels::Labels;
use crate::optics::visibility_cache::VisibilityCache;
use crate::source::slices::Slices;

/// A volume and its look; a frame draws one or several.
///
/// At a point in space, the extinctions of the layers add, and their colours, each shaded by its own gradient, mix by
/// extinction: the emission-absorption model with several media.
#[derive(Clone, Copy)]
pub struct Layer<'a> {
    /// The samples, ready for the kernel that they are drawn with.
    pub slices: &'a Slices<'a>,
    /// Colour and opacity by value.
    pub transfer_function: &'a TransferFunction,
    /// Lights and coefficients; `None` draws the colours as given.
    pub shading: Option<&'a Shading>,
    /// A segmentation of the volume; only the first layer's is drawn, and only with `Composite::Over`.
    pub labels: Option<&'a Labels>,
    /// A field that gives the layer its colours in place of its own samples, with `Composite::Over` and
    /// `Composite::FirstHit`.
    pub color: Option<ColorField<'a>>,
    /// Cache of tables made from the transfer function, kept from frame to frame.
    pub cache: &'a VisibilityCache,
}

/// A field whose values are coloured, where a layer's own values say how opaque it is.
///
/// Its axes are parallel to the axes of the first layer, and it covers the layer that it colours.
#[derive(Clone, Copy)]
pub struct ColorField<'a> {
    /// The field's samples, ready for the layer's kernel.
    pub slices: &'a Slices<'a>,
    /// Transfer function of the field's values; its colours count.
    pub transfer_function: &'a TransferFunction,
    /// Cache of tables made from the transfer function.
    pub cache: &'a VisibilityCache,
}
