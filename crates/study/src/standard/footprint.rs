//! Footprint tables: the weight of a sample at a texel.
//!
//! Buffers parallel to the slices need the kernel `h` along u and along v, since `∫ h(w) dw = 1`: a table of its
//! weights at 256 places between two samples ([`KernelTable`]) serves all texels of all sheets ([`AxisFootprint`]),
//! read with linear interpolation, since the nearest entry aliases.
//!
//! Buffers parallel to the view plane need the integral of the kernel along a ray. As in Westover's paper, the kernel
//! is taken as radially symmetric, so that one table over the squared distance from the ray serves every view
//! ([`RadialFootprint`]): `F(ρ) = 2 ∫ h(√(ρ² + t²)) dt`, normalised to unit integral over the plane. Catmull-Rom is an
//! exception: its second moment vanishes, which makes it accurate along an axis, and with it the integral
//! `4π ∫ h(r) r² dr` of its radial form, which then cannot be normalised; its footprint is `h(ρ)` itself. For the
//! Gaussian both are the same.

use wavesplat_compute::simd::{LANES, Lanes, Simd};
use wavesplat_core::Kernel;
use wavesplat_splat::kernel::weights::{radius, weight};

/// Table entries between two samples: linear interpolation between them is good to 1e-5.
const N_PHASES: usize = 256;

/// Largest factor by which a footprint is widened.
const MAX_WIDENING: f64 = 64.0;

/// Weights of the samples around a position, tabulated by its place between two samples.
pub struct KernelTable {
    kernel: Kernel,
    n_taps: usize,
    entries: Vec<[f32; 4]>,
}

impl KernelTable {
    /// The table of a kernel, with weights of sum 1.
    pub fn new(kernel: Kernel) -> Self {
        let n_taps = if kernel == Kernel::Linear { 2 } else { 4 };
        let before = n_taps / 2 - 1;
        let entry = |phase: usize| {
            let t = phase as f64 / N_PHASES as f64;
            let weights: [f64; 4] = std::array::from_fn(|tap| weight(kernel, t + before as f64 - tap as f64));
            let sum: f64 = weights.iter().sum();
            weights.map(|w| (w / sum) as f32)
        };
        // One entry more, for interpolation at the very end of the last cell.
        Self { kernel, n_taps, entries: (0..=N_PHASES).chain([N_PHASES]).map(entry).collect() }
    }

    /// First sample and weights at a position.
    #[inline(always)]
    fn taps(&self, x: f64) -> (i64, [f32; 4]) {
        let below = x.floor();
        let place = (x - below) as f32 * N_PHASES as f32;
        let entry = place as usize;
        let t = place - entry as f32;
        let (a, b) = (&self.entries[entry], &self.entries[entry + 1]);
        let mut weights = [0.0; 4];
        for k in 0..4 {
            weights[k] = a[k] + t * (b[k] - a[k]);
        }
        (below as i64 + 1 - self.n_taps as i64 / 2, weights)
    }
}

/// Factor by which a footprint is wider than the kernel, where texels are `step` samples apart.
pub fn widening(step: f64) -> f64 {
    step.abs().clamp(1.0, MAX_WIDENING)
}

/// Reach of a footprint where texels are `step` samples apart, in samples.
pub fn reach(kernel: Kernel, step: f64) -> f64 {
    radius(kernel) * widening(step)
}

/// The weights of a run of texels along an axis, in groups of [`LANES`].
#[derive(Default)]
pub struct AxisFootprint {
    /// Taps per texel.
    pub n_taps: usize,
    /// Lowest first sample of each group.
    base: Vec<i64>,
    /// First sample of each texel, counted from its group's base.
    index: Vec<Lanes<u32>>,
    /// Weights, `n_taps` vectors per group.
    weights: Vec<Lanes>,
}

impl AxisFootprint {
    /// Builds the weights of the texels at `origin + i · step`, in samples. Texels out of reach of all `n_samples`
    /// samples are moved nearer, but stay out of reach. Runs at the SIMD level of the caller.
    #[inline(always)]
    pub fn build(&mut self, table: &KernelTable, origin: f64, step: f64, n_groups: usize, n_samples: usize) {
        let widening = widening(step);
        let reach = reach(table.kernel, step);
        self.n_taps = if widening > 1.0 { (2.0 * reach).ceil() as usize + 1 } else { table.n_taps };
        self.base.resize(n_groups, 0);
        self.index.resize(n_groups, Lanes::default());
        self.weights.clear();
        self.weights.resize(n_groups * self.n_taps, Lanes::default());
        let (lo, hi) = (-reach - 1.0, n_samples as f64 + reach);
        for g in 0..n_groups {
            let weights = &mut self.weights[g * self.n_taps..(g + 1) * self.n_taps];
            let mut firsts = [0; LANES];
            for lane in 0..LANES {
                let x = (origin + step * (g * LANES + lane) as f64).clamp(lo, hi);
                if widening > 1.0 {
                    firsts[lane] = (x - reach).ceil() as i64;
                    widened(table.kernel, x - firsts[lane] as f64, widening, lane, weights);
                } else {
                    let (first, taps) = table.taps(x);
                    firsts[lane] = first;
                    for t in 0..self.n_taps.min(taps.len()) {
                        weights[t].0[lane] = taps[t];
                    }
                }
            }
            let base = firsts.iter().fold(i64::MAX, |base, first| base.min(*first));
            self.base[g] = base;
            self.index[g] = Lanes(firsts.map(|first| (first - base) as u32));
        }
    }

    /// First sample of a texel.
    #[inline(always)]
    pub fn first(&self, i: usize) -> i64 {
        self.base[i / LANES] + i64::from(self.index[i / LANES].0[i % LANES])
    }

    /// Weight of tap `t` of a texel.
    #[inline(always)]
    pub fn weight(&self, i: usize, t: usize) -> f32 {
        self.weights[i / LANES * self.n_taps + t].0[i % LANES]
    }

    /// First and last sample that reaches a group.
    pub fn reached(&self, g: usize) -> [i64; 2] {
        let last = self.index[g].0.iter().fold(0, |last, index| last.max(*index));
        [self.base[g], self.base[g] + i64::from(last) + self.n_taps as i64 - 1]
    }

    /// The sum `Σ weight · sample` at the texels of a group; `origin` is the sample that `row` begins with.
    #[inline(always)]
    pub fn sum<S: Simd>(&self, s: S, g: usize, row: &[f32], origin: i64) -> S::F {
        let index = &self.index[g];
        let base = (self.base[g] - origin) as usize;
        let is_dense = index.0[0].max(index.0[LANES - 1]) < LANES as u32;
        let mut sum = s.splat(0.0);
        for (t, weights) in self.weights[g * self.n_taps..(g + 1) * self.n_taps].iter().enumerate() {
            let samples = match row[base + t..].first_chunk::<LANES>() {
                Some(samples) if is_dense => s.take(samples, index),
                _ => {
                    let mut samples = [0.0; LANES];
                    for lane in 0..LANES {
                        samples[lane] = row[base + t + index.0[lane] as usize];
                    }
                    s.load(&samples)
                }
            };
            sum = s.add_mul(sum, s.load(&weights.0), samples);
        }
        sum
    }
}

/// Writes the weights of a widened kernel at `x` samples behind the first tap.
fn widened(kernel: Kernel, x: f64, widening: f64, lane: usize, weights: &mut [Lanes]) {
    let at = |t: usize| weight(kernel, (x - t as f64) / widening);
    let sum: f64 = (0..weights.len()).map(at).sum();
    for (t, weights) in weights.iter_mut().enumerate() {
        weights.0[lane] = (at(t) / sum) as f32;
    }
}

/// Number of cells of the table over the squared distance; a power of two.
const N_CELLS: usize = 1024;

/// 2²³: its addition rounds a smaller number to a whole number, which then is in the low bits of the f32.
const ROUND: f32 = 8_388_608.0;

/// The footprint of a radially symmetric kernel, over the squared distance from the ray, in samples.
pub struct RadialFootprint {
    /// Squared distance beyond which the footprint is 0.
    pub radius_squared: f64,
    /// Value and slope at whole cells; twice the number of cells, so that an index modulo the length is always valid.
    cells: [[f32; 2]; 2 * N_CELLS],
    per_squared: f32,
}

impl RadialFootprint {
    /// The footprint of a kernel, of unit integral over the plane.
    pub fn new(kernel: Kernel) -> Self {
        let radius_squared = radius(kernel).powi(2);
        let step = radius_squared / N_CELLS as f64;
        let values: Vec<f64> = (0..=N_CELLS).map(|i| line_integral(kernel, i as f64 * step)).collect();
        // `∫ F dA = π ∫ F d(ρ²)`, by the trapezoid rule.
        let ends = 0.5 * (values[0] + values[N_CELLS]);
        let integral = std::f64::consts::PI * step * (values.iter().sum::<f64>() - ends);
        let mut cells = [[0.0; 2]; 2 * N_CELLS];
        for i in 0..=N_CELLS {
            let (before, after) = (values[i.saturating_sub(1)], values[(i + 1).min(N_CELLS)]);
            let apart = if i == 0 || i == N_CELLS { 1.0 } else { 2.0 };
            cells[i] = [values[i] / integral, (after - before) / (apart * integral)].map(|x| x as f32);
        }
        Self { radius_squared, cells, per_squared: (1.0 / step) as f32 }
    }

    /// Weight per area of one sample, at a squared distance of at most `radius_squared`.
    #[inline(always)]
    pub fn weight(&self, squared: f32) -> f32 {
        let place = squared * self.per_squared;
        let shifted = place + ROUND;
        let [value, slope] = self.cells[shifted.to_bits() as usize % (2 * N_CELLS)];
        value + slope * (place - (shifted - ROUND))
    }
}

/// The integral `∫ h(√(ρ² + t²)) dt` along a ray that passes the sample at the distance ρ; not normalised.
pub(crate) fn line_integral(kernel: Kernel, squared: f64) -> f64 {
    const N_STEPS: usize = 128;
    if kernel == Kernel::CatmullRom {
        return weight(kernel, squared.sqrt());
    }
    // Midpoints of both halves at once; the chord ends where the kernel does.
    let half = (radius(kernel).powi(2) - squared).max(0.0).sqrt();
    let step = half / N_STEPS as f64;
    let at = |i: usize| weight(kernel, (squared + ((i as f64 + 0.5) * step).powi(2)).sqrt());
    2.0 * step * (0..N_STEPS).map(at).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use wavesplat_compute::simd::Plain;

    /// Tables, widened or not, hold the kernel's normalised weights.
    #[test]
    fn axis_footprints_are_the_kernel_and_sum_to_one() {
        for (name, kernel) in Kernel::NAMES {
            let table = KernelTable::new(kernel);
            for (origin, step) in [(-1.3, 0.37), (20.0, -0.61), (0.4, 1.0), (-3.0, 2.7), (19.0, -3.1)] {
                let mut footprint = AxisFootprint::default();
                footprint.build(&table, origin, step, 2, 40);
                let wide = widening(step);
                for i in 0..2 * LANES {
                    let x = (origin + step * i as f64).clamp(-reach(kernel, step) - 1.0, 40.0 + reach(kernel, step));
                    let direct = |j: i64| weight(kernel, (x - j as f64) / wide);
                    let sum: f64 = (-400..400).map(direct).sum();
                    let mut total = 0.0;
                    for t in 0..footprint.n_taps {
                        let want = direct(footprint.first(i) + t as i64) / sum;
                        let got = f64::from(footprint.weight(i, t));
                        // The Gaussian is cut off at a two-hundredth of a grey level, which its table makes a ramp.
                        let limit = if kernel == Kernel::Gaussian { 3e-4 } else { 2e-5 };
                        assert!((got - want).abs() < limit, "{name} step {step} texel {i} tap {t}: {got} for {want}");
                        total += got;
                    }
                    assert!((total - 1.0).abs() < 1e-5, "{name} step {step} texel {i}: {total}");
                }
            }
        }
    }

    #[test]
    fn sums_of_rows_do_not_depend_on_how_they_are_read() {
        let row: Vec<f32> = (0..120).map(|i| (i as f32 * 0.7).sin()).collect();
        let table = KernelTable::new(Kernel::Bspline3);
        for step in [0.3, -0.9, 0.99, 2.5] {
            let mut footprint = AxisFootprint::default();
            footprint.build(&table, 30.0, step, 1, 90);
            let sums = footprint.sum(Plain, 0, &row, -12);
            for i in 0..LANES {
                let tap = |t: usize| footprint.weight(i, t) * row[(footprint.first(i) + t as i64 + 12) as usize];
                let want: f32 = (0..footprint.n_taps).map(tap).sum();
                assert!((sums[i] - want).abs() < 1e-6, "step {step} texel {i}");
            }
        }
    }

    /// The cone's line integral in closed form: `√(1 − ρ²) − ρ² arcosh(1/ρ)`, and `π/3` over the plane.
    #[test]
    fn radial_footprints_are_line_integrals_of_unit_mass() {
        let linear = RadialFootprint::new(Kernel::Linear);
        for rho in [0.0_f64, 0.1, 0.35, 0.5, 0.9, 0.999] {
            let exact = (1.0 - rho * rho).sqrt() - if rho > 0.0 { rho * rho * (1.0 / rho).acosh() } else { 0.0 };
            let got = f64::from(linear.weight((rho * rho) as f32));
            assert!((got - exact * 3.0 / std::f64::consts::PI).abs() < 1e-3, "{rho}: {got}");
        }
        for (name, kernel) in Kernel::NAMES {
            let footprint = RadialFootprint::new(kernel);
            let (n, side) = (400, 2.0 * radius(kernel));
            let at = |i: usize| (i as f64 + 0.5) / n as f64 * side - side / 2.0;
            let inside = |squared: f64| if squared <= footprint.radius_squared { squared as f32 } else { f32::NAN };
            let mass = |i: usize| {
                let squared = inside(at(i % n).powi(2) + at(i / n).powi(2));
                if squared.is_nan() { 0.0 } else { f64::from(footprint.weight(squared)) }
            };
            let total: f64 = (0..n * n).map(mass).sum::<f64>() * (side / n as f64).powi(2);
            assert!((total - 1.0).abs() < 1e-3, "{name}: {total}");
        }
        // From any side a Gaussian is a Gaussian.
        let gaussian = RadialFootprint::new(Kernel::Gaussian);
        let ratio = gaussian.weight(1.0) / gaussian.weight(0.0);
        assert!((f64::from(ratio) - (-2.0_f64).exp()).abs() < 2e-3, "{ratio}");
    }
}
