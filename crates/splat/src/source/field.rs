//! Fields: scalar quantities beside the density, such as the light that reaches a point, or the share of a label there.
//!
//! A field has samples of its own, on the volume's grid or an evenly coarser one along the same axes.

use wavesplat_core::Gradient;

use crate::source::slices::Slices;

/// A field: its samples, and where they lie.
#[derive(Clone)]
pub struct Field<'a> {
    /// Samples of the field; their densities are its values.
    pub slices: Slices<'a>,
    /// Position in the field of index position 0 of the volume, and change per index step of the volume, along x, y, z.
    pub from_index: [(f64, f64); 3],
    /// Gradient estimator, lengths in field samples; `None` where no gradient is needed.
    pub gradient: Option<Gradient>,
}
