//! Samples of a tile for a run of slices, turned so that they lie side by side along u.
//!
//! Slices across x have their samples a whole row apart in memory; read sheet by sheet, every sample costs a cache
//! line. A panel reads each row of x once for a dozen slices, where the line is at hand, and turns it. Of volumes that
//! are decoded in blocks it loads what the dozen slices need, whichever way they lie.

use wavesplat_compute::simd::LANES;

use crate::kernel::footprint::Axis;
use crate::kernel::slice_taps::SliceTap;
use crate::kernel::weights::{n_taps, reach};
use crate::source::block_cache::Part;
use crate::source::geometry::SheetGeometry;
use crate::source::window::{Window, sum_slices};

/// Densities of a box of samples, slice by slice.
pub struct TransposedSlices {
    /// Positions of sheets that it serves; none at first.
    run: [f64; 2],
    /// The first of [`LANES`] slices.
    first: usize,
    window: Option<Window>,
    stride: usize,
    densities: Vec<f32>,
    /// The box, where it had to be loaded.
    part: Part,
    /// Whether the densities are in the box and not turned.
    is_part: bool,
}

impl Default for TransposedSlices {
    fn default() -> Self {
        Self {
            run: [f64::INFINITY, f64::NEG_INFINITY],
            first: 0,
            window: None,
            stride: 0,
            densities: Vec::new(),
            part: Part::default(),
            is_part: false,
        }
    }
}

impl TransposedSlices {
    /// Makes sure that the slices that reach the sheets at `w` are there, if the slices lie across the rows of samples.
    /// `texels` tells the first and the last texel that is wanted of all sheets that the panel will serve.
    pub fn cover(
        &mut self,
        geometry: &SheetGeometry,
        w: [f64; 2],
        texels: impl FnOnce(&dyn Fn(f64) -> bool) -> [[usize; 2]; 2],
    ) {
        let [axis_u, axis_v, axis_w] = &geometry.axes;
        let across = geometry.plane.family.axes[0] != 0;
        if !geometry.is_own_grid() || (!across && !geometry.slices.must_load()) {
            return;
        }
        if w.iter().all(|w| self.run[0] <= *w && *w <= self.run[1]) {
            return;
        }
        // As far ahead as the slices of a panel serve.
        let spare = reached(axis_w, [0.0, 0.0]);
        let served = (LANES as i64 - 1 - (spare[1] - spare[0])) as f64;
        let needed = (w[1] - w[0]).abs();
        if served < needed.ceil() {
            // Sheets too far apart, or kernels too wide: every slice would be turned several times.
            self.window = None;
            return;
        }
        let (lo, hi) = (w[0].min(w[1]), w[0].max(w[1]));
        let run = if w[0] < w[1] { [lo, (lo.floor() + served).max(hi)] } else { [(hi.ceil() - served).min(lo), hi] };
        self.run = run;
        self.first = reached(axis_w, run)[0].max(0) as usize;
        let [from, to] = texels(&|w| run[0] <= w && w <= run[1]);
        let along = |axis: &Axis, k: usize| {
            let mut hull = [f64::INFINITY, f64::NEG_INFINITY];
            for w in run {
                let (origin, step) = geometry.plane.sheet(w)[k];
                for i in [from[k], to[k]] {
                    let x = (origin + step * i as f64).clamp(0.0, (axis.n_samples - 1) as f64);
                    hull = [hull[0].min(x), hull[1].max(x)];
                }
            }
            window(axis, hull)
        };
        let window = Window { u: along(axis_u, 0), v: along(axis_v, 1) };
        self.window = Some(window);
        self.stride = window.n_u().next_multiple_of(LANES);
        let axes = geometry.plane.family.axes;
        let last = (self.first + LANES).min(axis_w.n_samples) - 1;
        geometry.slices.load(axes, window, [self.first, last], &mut self.part);
        self.is_part = !across;
        if across {
            self.densities.resize(self.stride * window.n_v() * LANES, 0.0);
            let (level, part) = (geometry.level, &self.part);
            geometry.slices.turn(level, axes, self.first, window, part, &mut self.densities, self.stride);
        }
    }

    /// `out[v · stride + u] = Σ weight · density` over the slices of `taps`, or `false` if they are not here.
    pub fn combine(
        &self,
        geometry: &SheetGeometry,
        taps: &[SliceTap],
        window: Window,
        out: &mut [f32],
        stride: usize,
    ) -> bool {
        let Some(all) = self.window else { return false };
        let level = geometry.level;
        if self.is_part {
            let axes = geometry.plane.family.axes;
            geometry.slices.combine_part(level, axes, &self.part, taps, window, out, stride);
            return true;
        }
        let first = [window.u[0] - all.u[0], window.v[0] - all.v[0]].map(|i| i as usize);
        let plane = self.stride * all.n_v();
        level.run(
            #[inline(always)]
            || {
                for r in 0..window.n_v() {
                    let row = &mut out[r * stride..];
                    let n_room = stride.min(row.len());
                    let from = |slice: usize| (slice - self.first) * plane + (first[1] + r) * self.stride + first[0];
                    sum_slices(&self.densities, taps, from, &mut row[..n_room], window.n_u(), &|d| d);
                }
            },
        );
        true
    }
}

/// First and last sample that footprints of texels in an interval hold a weight for, be it 0.
fn window(axis: &Axis, [lo, hi]: [f64; 2]) -> [i64; 2] {
    let [from, to] = reached(axis, [lo, hi]);
    let Some(offset) = axis.gradient_offset else { return [from, to] };
    // A difference that starts at a face is as long as any other; its last weights are 0.
    let first = (hi - offset).max(0.0).floor() as i64 - reach(axis.kernel) as i64;
    [from, to.max(first + axis.n_difference_taps(offset) as i64)]
}

/// First and last sample that values and differences at the positions of an interval reach, with one to spare for
/// positions in f32.
fn reached(axis: &Axis, [lo, hi]: [f64; 2]) -> [i64; 2] {
    let offset = axis.gradient_offset.map_or(0, |offset| offset.ceil() as i64);
    let before = reach(axis.kernel) as i64 + offset + 1;
    let after = (n_taps(axis.kernel) - 1 - reach(axis.kernel)) as i64 + offset + 1;
    [lo.floor() as i64 - before, hi.floor() as i64 + after]
}

#[cfg(test)]
mod tests {
    use wavesplat_core::Kernel;

    use super::*;
    use crate::kernel::footprint::AxisFootprints;

    #[test]
    fn windows_hold_the_footprints_of_their_texels() {
        let places = [(40, -7.3, 0.4), (40, 30.2, 0.7), (9, -3.0, 1.0), (2, 0.0, 0.1), (40, 30.0, -1.3)];
        for (name, kernel) in Kernel::NAMES {
            for gradient_offset in [None, Some(0.1), Some(0.5), Some(1.0), Some(1.7), Some(2.0), Some(2.5), Some(4.0)] {
                for (n_samples, origin, step) in places {
                    let axis = Axis { kernel, n_samples, gradient_offset };
                    let mut footprints = AxisFootprints::default();
                    footprints.build(&axis, [origin, step], 2, 0b11);
                    let last = (n_samples - 1) as f64;
                    let ends = [origin, origin + step * (2 * LANES - 1) as f64].map(|x| x.clamp(0.0, last));
                    let [from, to] = window(&axis, [ends[0].min(ends[1]), ends[0].max(ends[1])]);
                    let [first, end] = footprints.window;
                    let holds = from <= first && end <= to;
                    assert!(holds, "{name} {gradient_offset:?} {origin}: [{first}, {end}] in [{from}, {to}]");
                }
            }
        }
    }
}
