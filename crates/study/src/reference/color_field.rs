//! A second field that gives a volume of the ray caster its colours.

use glam::{DAffine3, DVec3};
use wavesplat_core::{Grid, Kernel, TransferFunction, Volume};
use wavesplat_splat::source::nonfinite::MIN_KNOWN;
use wavesplat_splat::source::slices::Slices;

use super::reached_samples::for_each_tap;

/// A field whose values are coloured, where a layer's own samples say how opaque it is.
#[derive(Clone, Copy)]
pub struct CastColor<'a> {
    /// The field's samples, anywhere in space; beyond them the nearest counts.
    pub volume: &'a Volume<'a>,
    /// Transfer function of the field's values; its colours count.
    pub transfer_function: &'a TransferFunction,
}

/// The field, and the map from the layer's index positions to the field's.
pub(super) struct CastField<'a> {
    slices: &'a Slices<'a>,
    tf: &'a TransferFunction,
    from_layer: DAffine3,
}

impl<'a> CastField<'a> {
    /// The field over a layer's grid.
    pub(super) fn new(color: CastColor<'a>, slices: &'a Slices<'a>, layer: &Grid) -> Self {
        let from_layer = color.volume.grid().index_from_world() * layer.world_from_index();
        Self { slices, tf: color.transfer_function, from_layer }
    }

    /// Known share of the field at an index position of the layer: 1 less the weight that the linear kernel gives to
    /// missing samples there, or 0 where that is below `MIN_KNOWN`.
    pub(super) fn known(&self, position: DVec3) -> f64 {
        let mut known = 1.0;
        if self.slices.has_mask() {
            self.for_each_tap(Kernel::Linear, position, |at, weight| {
                known -= if self.slices.is_hole(at) { weight } else { 0.0 };
            });
        }
        if known < f64::from(MIN_KNOWN) { 0.0 } else { known }
    }

    /// Value of the field at an index position of the layer.
    pub(super) fn value(&self, position: DVec3) -> f64 {
        let mut density = 0.0;
        self.for_each_tap(self.slices.kernel(), position, |at, weight| density += weight * self.slices.at(at));
        let (offset, scale) = self.slices.grid().density_from_sample();
        density / scale + offset
    }

    /// Colour of a value.
    pub(super) fn rgb(&self, value: f64) -> [f64; 3] {
        self.tf.color(value)
    }

    fn for_each_tap(&self, kernel: Kernel, position: DVec3, add: impl FnMut([usize; 3], f64)) {
        for_each_tap(kernel, self.slices.grid().size(), self.from_layer.transform_point3(position), add);
    }
}
