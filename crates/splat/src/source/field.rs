//! Fields: scalar quantities beside the density, such as how much light gets to a point, or how much of it is a label.
//!
//! A field has samples of its own, on the volume's grid or an evenly coarser one along the same axes.

use wavesplat_core::Gradient;

use crate::source::slices::Slices;

/// Samples of a field and where they lie.
#[derive(Clone)]
pub struct Field<'a> {
    /// Their values are densities.
    pub slices: Slices<'a>,
    /// Index position in the field of index position 0 of the volume, along x, y and z, and per index step of it.
    pub from_index: [(f64, f64); 3],
    /// How its gradient is estimated, field samples; `None` where that is not wanted.
    pub gradient: Option<Gradient>,
}
