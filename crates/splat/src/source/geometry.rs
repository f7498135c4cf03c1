//! Where the texels of the sheets of a base plane lie among the samples, and the footprints of its three axes.

use crate::kernel::footprint::Axis;
use crate::kernel::slice_taps::SliceTaps;
use crate::source::field::Field;
use crate::source::slices::Slices;
use crate::view::base_plane::BasePlane;
use wavesplat_compute::simd::Level;

/// Sheet-wide facts of one base plane.
pub struct SheetGeometry<'a> {
    /// Texel layout.
    pub plane: &'a BasePlane,
    /// Samples.
    pub slices: &'a Slices<'a>,
    /// Axes u, v, w with kernel and gradient offset.
    pub axes: [Axis; 3],
    /// Vectors to use.
    pub level: Level,
    /// Position among the samples of index position 0, along u, v, w, and per index step: fields may be coarser.
    from_index: [(f64, f64); 3],
}

impl<'a> SheetGeometry<'a> {
    /// `gradient_offset`: half distance of differences, voxels; `None` where no gradient is wanted.
    pub fn new(
        level: Level,
        plane: &'a BasePlane,
        slices: &'a Slices<'a>,
        size: [usize; 3],
        gradient_offset: Option<f64>,
    ) -> Self {
        let axis = |a: usize| Axis { kernel: slices.kernel(), n_samples: size[a], gradient_offset };
        Self { plane, slices, axes: plane.family.axes.map(axis), level, from_index: [(0.0, 1.0); 3] }
    }

    /// The same texels over the samples of a field.
    pub fn of_field(level: Level, plane: &'a BasePlane, field: &'a Field<'a>) -> Self {
        let size = field.slices.grid().size();
        let from_index = plane.family.axes.map(|a| field.from_index[a]);
        let own = Self::new(level, plane, &field.slices, size, field.gradient_offset);
        Self { from_index, ..own }
    }

    /// Whether its sheets have the same weights as those of another geometry of the same base plane, or more.
    pub fn has_weights_of(&self, other: &Self) -> bool {
        let is_alike = |a: &Axis, b: &Axis| {
            (a.kernel, a.n_samples) == (b.kernel, b.n_samples)
                && (b.gradient_offset.is_none() || a.gradient_offset == b.gradient_offset)
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
