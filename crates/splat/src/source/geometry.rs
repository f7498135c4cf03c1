//! Where the texels of the sheets of a base plane lie among the samples, and the footprints of its three axes.

use crate::kernel::footprint::{Axis, Difference};
use crate::kernel::footprint_table::Weights;
use crate::kernel::noise::noisy_entries;
use crate::kernel::slice_taps::SliceTaps;
use crate::source::field::Field;
use crate::source::slices::Slices;
use crate::view::base_plane::BasePlane;
use wavesplat_compute::simd::Level;
use wavesplat_core::Variant;

/// Sheet-wide facts of one base plane.
pub struct SheetGeometry<'a> {
    /// Texel layout.
    pub plane: &'a BasePlane,
    /// Samples.
    pub slices: &'a Slices<'a>,
    /// Axes u, v, w with kernel and gradient offset.
    pub axes: [Axis; 3],
    /// Entries per sample distance of a footprint table with noise on the samples, where there is one.
    pub noisy_entries: Option<u32>,
    /// Vectors to use.
    pub level: Level,
    /// Position among the samples of index position 0, along u, v, w, and per index step: fields may be coarser.
    from_index: [(f64, f64); 3],
}

impl<'a> SheetGeometry<'a> {
    /// `gradient_offset`: half distance of differences, voxels; `None` where no gradient is wanted. `sheet_step`: slice
    /// distances between sheets.
    pub fn new(
        level: Level,
        plane: &'a BasePlane,
        slices: &'a Slices<'a>,
        size: [usize; 3],
        gradient_offset: Option<f64>,
        variant: &Variant,
        sheet_step: f64,
    ) -> Self {
        let [u, v, w] = plane.family.axes;
        let axis = |a: usize, weights, difference: &dyn Fn(f64) -> Difference| Axis {
            kernel: slices.kernel(),
            n_samples: size[a],
            difference: gradient_offset.map(difference),
            weights,
        };
        let within = |a: usize| axis(a, Weights::within(variant), &|d| Difference::within(variant.gradient, d));
        let across = |d| Difference::across(variant.gradient, d, sheet_step);
        let axes = [within(u), within(v), axis(w, Weights::across(variant), &across)];
        Self { plane, slices, axes, noisy_entries: noisy_entries(variant), level, from_index: [(0.0, 1.0); 3] }
    }

    /// The same texels over the samples of a field, which has no variants.
    pub fn of_field(level: Level, plane: &'a BasePlane, field: &'a Field<'a>) -> Self {
        let size = field.slices.grid().size();
        let from_index = plane.family.axes.map(|a| field.from_index[a]);
        let own = Self::new(level, plane, &field.slices, size, field.gradient_offset, &Variant::default(), 1.0);
        Self { from_index, ..own }
    }

    /// Whether its sheets have the same weights as those of another geometry of the same base plane, or more.
    pub fn has_weights_of(&self, other: &Self) -> bool {
        let is_alike = |a: &Axis, b: &Axis| {
            (a.kernel, a.n_samples, a.weights) == (b.kernel, b.n_samples, b.weights)
                && (b.difference.is_none() || a.difference == b.difference)
        };
        self.from_index == other.from_index && self.axes.iter().zip(&other.axes).all(|(a, b)| is_alike(a, b))
    }

    /// Whether index positions are those of the samples.
    pub fn is_own_grid(&self) -> bool {
        self.from_index == [(0.0, 1.0); 3]
    }

    /// Where the texels of the sheet at an index position w lie among the samples: position of texel 0 and change per
    /// texel, along u and v, and position along w.
    pub fn sheet(&self, w: f64) -> ([(f64, f64); 2], f64) {
        let [u, v] = self.plane.sheet(w);
        let [of_u, of_v, (origin_w, per_w)] = self.from_index;
        let inside = |(x, dx): (f64, f64), (origin, per_index): (f64, f64)| (origin + per_index * x, per_index * dx);
        ([inside(u, of_u), inside(v, of_v)], origin_w + per_w * w)
    }

    /// The first slice that the rays meet behind some.
    pub fn slice_behind(&self, slices: &SliceTaps) -> Option<usize> {
        let (_, per_w) = self.from_index[2];
        let slices = slices.iter().map(|(slice, _)| *slice);
        if self.plane.family.ascending == (per_w > 0.0) {
            slices.max().map(|last| last + 1).filter(|slice| *slice < self.axes[2].n_samples)
        } else {
            slices.min()?.checked_sub(1)
        }
    }
}
