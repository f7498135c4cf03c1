//! Where the texels of the sheets of a base plane lie among the samples, and the footprints of its three axes.

use std::ops::Range;

use crate::kernel::footprint::Axis;
use crate::kernel::slice_taps::SliceTaps;
use crate::kernel::weights::{mirror_index, n_taps, reach};
use crate::source::field::Field;
use crate::source::slices::Slices;
use crate::view::base_plane::BasePlane;
use crate::view::common_grid::{IndexMap, SAME};
use wavesplat_compute::simd::Level;
use wavesplat_core::Gradient;

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
    /// `gradient`: how it is estimated, voxels; `None` where none is wanted.
    pub fn new(level: Level, plane: &'a BasePlane, slices: &'a Slices<'a>, gradient: Option<Gradient>) -> Self {
        let size = slices.grid().size();
        let axis = |a: usize| Axis { kernel: slices.kernel(), n_samples: size[a], gradient };
        Self { plane, slices, axes: plane.family.axes.map(axis), level, from_index: SAME }
    }

    /// The same for samples that lie elsewhere: `map`, of index positions of the base plane.
    #[must_use]
    pub fn placed(self, map: &IndexMap) -> Self {
        Self { from_index: self.plane.family.axes.map(|a| map[a]), ..self }
    }

    /// The same texels over the samples of a field beside a volume that lies at `map`.
    pub fn of_field(level: Level, plane: &'a BasePlane, field: &'a Field<'a>, map: &IndexMap) -> Self {
        let through = |((origin, per_index), (first, per_step)): ((f64, f64), (f64, f64))| {
            (origin + per_index * first, per_index * per_step)
        };
        let placed = [0, 1, 2].map(|a| through((field.from_index[a], map[a])));
        Self::new(level, plane, &field.slices, field.gradient).placed(&placed)
    }

    /// A position along w as one of the samples.
    pub fn own_w(&self, w: f64) -> f64 {
        let (origin, per_w) = self.from_index[2];
        origin + per_w * w
    }

    /// The position along w at which the samples have one of theirs.
    pub fn w_of_own(&self, own: f64) -> f64 {
        let (origin, per_w) = self.from_index[2];
        (own - origin) / per_w
    }

    /// Whether its sheets have the same weights as those of another geometry of the same base plane, or more.
    pub fn has_weights_of(&self, other: &Self) -> bool {
        let is_alike = |a: &Axis, b: &Axis| {
            (a.kernel, a.n_samples) == (b.kernel, b.n_samples) && (b.gradient.is_none() || a.gradient == b.gradient)
        };
        self.from_index == other.from_index && self.axes.iter().zip(&other.axes).all(|(a, b)| is_alike(a, b))
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

    /// Index ranges, along x, y and z, of the samples that texels `from..=to` of the sheets between two positions are made
    /// of, border folded back; also of what is transposed for them.
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

    /// Samples that the footprint of a texel reaches on either side of it, at most, along any axis.
    pub fn reach(&self) -> usize {
        let of = |axis: &Axis| {
            let [from, to] = window(axis, [0.0, 0.0]);
            from.unsigned_abs().max(to.unsigned_abs()) as usize
        };
        self.axes.iter().map(of).max().unwrap_or(0)
    }

    /// Positions among the samples between which texels lie, along u (0) or v (1), on the sheets between two positions.
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

/// The samples that indices from `lo` to `hi` stand for, what lies outside folded back.
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

/// First and last sample that footprints of texels in an interval hold a weight for, be it 0.
pub fn window(axis: &Axis, [lo, hi]: [f64; 2]) -> [i64; 2] {
    let [from, to] = reached(axis, [lo, hi]);
    let Some(Gradient::Difference(offset)) = axis.gradient else { return [from, to] };
    // A difference that starts at a face is as long as any other; its last weights are 0.
    let first = (hi - offset).max(0.0).floor() as i64 - reach(axis.kernel) as i64;
    [from, to.max(first + axis.n_gradient_taps() as i64)]
}

/// First and last sample that values and differences at the positions of an interval reach, with one to spare for
/// positions in f32.
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
