//! Colour by a second field: a layer is as opaque as its own density says, and has the colour of another field there.
//!
//! The field is reconstructed in sheets at the texels of the layer's, and its colour is looked up where the layer's own
//! would be: on a sheet, or, where slabs are pre-integrated, at the mean place that the slab's light comes from. Opacity
//! alone is integrated along a slab: the colour of a field that is smooth beside it changes little where the light comes
//! from. A field that is the layer's own density gives the layer's own picture, to the bit.

use std::sync::Arc;

use wavesplat_compute::simd::Wide;

use crate::optics::visibility_cache::TabulatedFunction;
use crate::sheet::field_sheets::FieldPoint;
use crate::source::nonfinite::{MIN_KNOWN, known_share};

/// The field that gives a layer its colours.
#[derive(Clone)]
pub struct FieldColor {
    /// Number among the fields of the picture.
    pub field: usize,
    /// Tables of the transfer function of the field's densities, of which the colours count.
    pub tables: Arc<TabulatedFunction>,
    /// Whether samples of the field are missing.
    pub has_mask: bool,
}

impl FieldColor {
    /// Colour of the field at a point.
    #[inline(always)]
    pub fn rgb<W: Wide>(&self, w: W, point: &FieldPoint<W>) -> [W::F; 3] {
        let [r, g, b, _] = self.tables.look_up(w, point.value(w, self.field));
        [r, g, b]
    }

    /// Factor of the layer's optical depth where samples of the field are missing: a place is drawn by the smaller known
    /// share of both. `own_missing`: the missing share of the layer's own samples, which its depth already leaves out.
    #[inline(always)]
    pub fn known_factor<W: Wide>(&self, w: W, point: &FieldPoint<W>, own_missing: Option<W::F>) -> W::F {
        let one = w.splat(1.0);
        if !self.has_mask {
            return one;
        }
        let (of_field, own) = (point.missing(w, self.field), own_missing.unwrap_or(w.splat(0.0)));
        let relative = w.div(known_share(w, of_field), w.max(known_share(w, own), w.splat(MIN_KNOWN)));
        w.select(w.lt(own, of_field), relative, one)
    }
}
