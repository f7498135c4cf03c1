//! Transposed slices: samples of a tile for a run of slices across x, laid out side by side along u.
//!
//! Slices across x have their samples a whole row apart in memory; read sheet by sheet, every sample costs a cache
//! line. A panel reads each row of x once for a dozen slices, while the cache line is at hand, and transposes it. For
//! volumes that are decoded in blocks it loads the box that these slices need, whichever way they lie.

use wavesplat_compute::simd::LANES;

use crate::kernel::footprint::Axis;
use crate::kernel::slice_taps::SliceTap;
use crate::source::block_cache::DensityBox;
use crate::source::geometry::SheetGeometry;
use crate::source::geometry::reached;
use crate::source::geometry::window;
use crate::source::window::{SumRows, Window, sum_slices};

/// Panel: densities of a box of samples, slice by slice.
pub struct TransposedSlices {
    /// Range of the sheets that the panel serves, as sample positions along w; empty at first.
    run: [f64; 2],
    /// The first of [`LANES`] slices.
    first: usize,
    window: Option<Window>,
    stride: usize,
    densities: Vec<f32>,
    /// The loaded box, if boxes must be loaded.
    part: DensityBox,
    /// Whether the densities are read from the loaded box, not transposed.
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
            part: DensityBox::default(),
            is_part: false,
        }
    }
}

impl TransposedSlices {
    /// Makes sure that the panel has the slices that the sheets at `w` need, if they lie across the rows of samples or
    /// must be loaded. `ends`: the first and the last sheet that are drawn; nothing beyond them is read. `texels`
    /// returns the first and the last texel that all served sheets need; it is passed a function that returns whether
    /// the sheet at a position is served.
    pub fn cover(
        &mut self,
        geometry: &SheetGeometry,
        w: [f64; 2],
        ends: [f64; 2],
        texels: impl FnOnce(&dyn Fn(f64) -> bool) -> [[usize; 2]; 2],
    ) {
        let [axis_u, axis_v, axis_w] = &geometry.axes;
        let across = geometry.plane.family.axes[0] != 0;
        if !across && !geometry.slices.must_load() {
            return;
        }
        // Beyond the first and the last slice, where other layers go on, a sheet shows the nearest slice at texel
        // positions of its own: the panel does not serve it.
        if !w.iter().all(|w| (0.0..=axis_w.last()).contains(&geometry.own_w(*w))) {
            *self = Self::default();
            return;
        }
        let own = |w: f64| geometry.own_w(w).clamp(0.0, axis_w.last());
        let [w, ends] = [w, ends].map(|w| w.map(own));
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
        let (lowest, highest) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
        let run = [run[0].max(lowest), run[1].min(highest)];
        self.run = run;
        self.first = reached(axis_w, run)[0].max(0) as usize;
        let [from, to] = texels(&|w| run[0] <= own(w) && own(w) <= run[1]);
        let between = run.map(|own| geometry.w_of_own(own));
        let along = |axis: &Axis, k: usize| window(axis, geometry.hull(k, [from[k], to[k]], between));
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
            geometry.slices.write_transposed(level, axes, self.first, window, part, &mut self.densities, self.stride);
        }
    }

    /// Writes `out[v · stride + u] = Σ weight · density` over the slices of `taps`; returns `false` if the panel does
    /// not have them.
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
                let starts = |slice: usize| (slice - self.first) * plane + first[0];
                let lines = |r: usize| (first[1] + r) * self.stride;
                let out = SumRows { out, stride, room: stride, n: window.n_u(), n_rows: window.n_v() };
                sum_slices(&self.densities, taps, None, starts, lines, out, &|d| d);
            },
        );
        true
    }
}
