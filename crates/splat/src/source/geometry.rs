//! Geometry of the sheets of a base plane: where their texels lie among the samples, and footprints of the three axes.

use std::ops::Range;

use crate::kernel::footprint::Axis;
use crate::kernel::slice_taps::SliceTaps;
use crate::kernel::weights::{mirror_index, n_taps, reach};
use crate::source::field::Field;
use crate::source::slices::Slices;
use crate::view::base_plane::BasePlane;
use crate::view::common_grid::{IDENTITY_MAP, IndexMap};
use wavesplat_compute::simd::Level;
use wavesplat_core::Gradient;

/// Geometry of the sheets of one base plane, over the samples of a volume or field.
pub struct SheetGeometry<'a> {
    /// Base plane: the layout of the texels.
    pub plane: &'a BasePlane,
    /// Samples of the volume or field.
    pub slices: &'a Slices<'a>,
    /// Axes u, v, w with kernel and gradient offset.
    pub axes: [Axis; 3],
    /// SIMD level to use.
    pub level: Level,
    /// Sample position of index position 0, and change per index step, along u, v, w: fields may be coarser.
    from_index: [(f64, f64); 3],
}

impl<'a> SheetGeometry<'a> {
    /// Geometry over samples that lie on the grid of the base plane. `gradient`: its estimator, lengths in voxels;
    /// `None` where no gradient is needed.
    pub fn new(level: Level, plane: &'a BasePlane, slices: &'a Slices<'a>, gradient: Option<Gradient>) -> Self {
        let size = slices.grid().size();
        let axis = |a: usize| Axis { kernel: slices.kernel(), n_samples: size[a], gradient };
        Self { plane, slices, axes: plane.family.axes.map(axis), level, from_index: IDENTITY_MAP }
    }

    /// The same geometry for samples that lie elsewhere; `map`: their positions by index position of the base plane.
    #[must_use]
    pub fn placed(self, map: &IndexMap) -> Self {
        Self { from_index: self.plane.family.axes.map(|a| map[a]), ..self }
    }

    /// Geometry of the same texels over the samples of a field; `map`: where the field's volume lies.
    pub fn of_field(level: Level, plane: &'a BasePlane, field: &'a Field<'a>, map: &IndexMap) -> Self {
        let through = |((origin, per_index), (first, per_step)): ((f64, f64), (f64, f64))| {
            (origin + per_index * first, per_index * per_step)
        };
        let placed = [0, 1, 2].map(|a| through((field.from_index[a], map[a])));
        Self::new(level, plane, &field.slices, field.gradient).placed(&placed)
    }

    /// Sample position along w of an index position `w` of the base plane.
    pub fn own_w(&self, w: f64) -> f64 {
        let (origin, per_w) = self.from_index[2];
        origin + per_w * w
    }

    /// Index position along w, in the base plane, of a sample position: the inverse of [`SheetGeometry::own_w`].
    pub fn w_of_own(&self, own: f64) -> f64 {
        let (origin, per_w) = self.from_index[2];
        (own - origin) / per_w
    }

    /// Whether the sheets have the weights of another geometry of the same base plane, or more.
    pub fn has_weights_of(&self, other: &Self) -> bool {
        let meets_same_regions = |a: &Axis, b: &Axis| {
            (a.kernel, a.n_samples) == (b.kernel, b.n_samples) && (b.gradient.is_none() || a.gradient == b.gradient)
        };
        self.from_index == other.from_index && self.axes.iter().zip(&other.axes).all(|(a, b)| meets_same_regions(a, b))
    }

    /// Sample positions of the texels of the sheet at an index position `w`: position of texel 0 and change per texel,
    /// along u and v, and position along w.
    pub fn sheet(&self, w: f64) -> ([(f64, f64); 2], f64) {
        let [u, v] = self.plane.sheet(w);
        let [of_u, of_v, (origin_w, per_w)] = self.from_index;
        let inside = |(x, dx): (f64, f64), (origin, per_index): (f64, f64)| (origin + per_index * x, per_index * dx);
        ([inside(u, of_u), inside(v, of_v)], origin_w + per_w * w)
    }

    /// First slice that the rays meet behind the slices of some taps; `None` where there is none.
    pub fn slice_behind(&self, slices: &SliceTaps) -> Option<usize> {
        let (_, per_w) = self.from_index[2];
        let slices = slices.iter().map(|(slice, _)| *slice);
        if self.plane.family.ascending == (per_w > 0.0) {
            slices.max().map(|last| last + 1).filter(|slice| *slice < self.axes[2].n_samples)
        } else {
            slices.min()?.checked_sub(1)
        }
    }

    /// Index ranges, along x, y and z, of the samples that texels `from..=to` of the sheets between two positions need,
    /// border folded back; includes the samples that are transposed for them.
    pub fn reached(&self, from: [usize; 2], to: [usize; 2], w: [f64; 2]) -> [Range<usize>; 3] {
        let [axis_u, axis_v, axis_w] = &self.axes;
        let ends =
            [window(axis_u, self.hull(0, [from[0], to[0]], w)), window(axis_v, self.hull(1, [from[1], to[1]], w))];
        let w = w.map(|w| self.own_w(w).clamp(0.0, axis_w.last()));
        let along_w = reached(axis_w, [w[0].min(w[1]), w[0].max(w[1])]);
        let mut ranges = [0..0, 0..0, 0..0];
        for (k, [lo, hi]) in [ends[0], ends[1], along_w].into_iter().enumerate() {
            ranges[self.plane.family.axes[k]] = folded(&self.axes[k], lo, hi);
        }
        ranges
    }

    /// Maximum number of samples that the footprint of a texel reaches to either side of it, along any axis.
    pub fn reach(&self) -> usize {
        let of = |axis: &Axis| {
            let [from, to] = window(axis, [0.0, 0.0]);
            from.unsigned_abs().max(to.unsigned_abs()) as usize
        };
        self.axes.iter().map(of).max().unwrap_or(0)
    }

    /// Range of the sample positions of texels, along u (0) or v (1), on the sheets between two positions. Positions
    /// are linear in the texel and in w, so the extremes lie at the ends of both.
    pub fn hull(&self, k: usize, texels: [usize; 2], w: [f64; 2]) -> [f64; 2] {
        let mut hull = [f64::INFINITY, f64::NEG_INFINITY];
        for w in w {
            let (origin, step) = self.sheet(w).0[k];
            for i in texels {
                let x = (origin + step * i as f64).clamp(0.0, self.axes[k].last());
                hull = [hull[0].min(x), hull[1].max(x)];
            }
        }
        hull
    }
}

/// Range of the samples that indices from `lo` to `hi` stand for, with indices outside folded back.
fn folded(axis: &Axis, lo: i64, hi: i64) -> Range<usize> {
    let end = axis.n_samples as i64;
    let inside = lo.max(0)..(hi + 1).min(end);
    let (mut first, mut last) =
        if inside.is_empty() { (usize::MAX, 0) } else { (inside.start as usize, inside.end as usize - 1) };
    for i in (lo..=hi.min(-1)).chain(lo.max(end)..=hi) {
        let i = mirror_index(axis.kernel, i, axis.n_samples);
        (first, last) = (first.min(i), last.max(i));
    }
    first..last + 1
}

/// First and last sample that the footprints of texels in an interval have a weight for, even if it is 0.
pub fn window(axis: &Axis, [lo, hi]: [f64; 2]) -> [i64; 2] {
    let [from, to] = reached(axis, [lo, hi]);
    let Some(Gradient::Difference(offset)) = axis.gradient else { return [from, to] };
    // A difference that starts at a face is as long as any other; its last weights are 0.
    let first = (hi - offset).max(0.0).floor() as i64 - reach(axis.kernel) as i64;
    [from, to.max(first + axis.n_gradient_taps() as i64)]
}

/// First and last sample that values and differences at the positions of an interval reach, with one to spare for the
/// rounding of positions in f32.
pub fn reached(axis: &Axis, [lo, hi]: [f64; 2]) -> [i64; 2] {
    let margin = axis.gradient_margin() as i64;
    let before = reach(axis.kernel) as i64 + margin + 1;
    let after = (n_taps(axis.kernel) - 1 - reach(axis.kernel)) as i64 + margin + 1;
    [lo.floor() as i64 - before, hi.floor() as i64 + after]
}

#[cfg(test)]
mod tests {
    use wavesplat_compute::simd::LANES;
    use wavesplat_core::Kernel;

    use super::*;
    use crate::kernel::footprint::AxisFootprints;

    #[test]
    fn windows_hold_the_footprints_of_their_texels() {
        let places = [(40, -7.3, 0.4), (40, 30.2, 0.7), (9, -3.0, 1.0), (2, 0.0, 0.1), (40, 30.0, -1.3)];
        for (name, kernel) in Kernel::NAMES {
            let differences = [0.1, 0.5, 1.0, 1.7, 2.0, 2.5, 4.0].map(|offset| Some(Gradient::Difference(offset)));
            let smoothed = [0.5, 0.8, 1.0, 1.25].map(|deviation| Some(Gradient::Smoothed(deviation)));
            for gradient in [None].into_iter().chain(differences).chain(smoothed) {
                for (n_samples, origin, step) in places {
                    let axis = Axis { kernel, n_samples, gradient };
                    let mut footprints = AxisFootprints::default();
                    footprints.build(&axis, [origin, step], 2, 0b11);
                    let last = (n_samples - 1) as f64;
                    let ends = [origin, origin + step * (2 * LANES - 1) as f64].map(|x| x.clamp(0.0, last));
                    let [from, to] = window(&axis, [ends[0].min(ends[1]), ends[0].max(ends[1])]);
                    let [first, end] = footprints.window;
                    let holds = from <= first && end <= to;
                    assert!(holds, "{name} {gradient:?} {origin}: [{first}, {end}] in [{from}, {to}]");
                }
            }
        }
    }
}
