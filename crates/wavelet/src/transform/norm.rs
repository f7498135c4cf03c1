//! Norms of wavelet basis functions: amplitudes, which make coefficients comparable across levels, subbands and
//! families.
//!
//! A coefficient `c` stands for `c · f` with its basis function f, which synthesis makes of a single 1. Its amplitude
//! is `|c|` times a norm of f: [`Norm::L2`], the root of the sum of squares over the finest grid (for B-splines the
//! root of the integral, with the finest spacing 1), which weights its error in the mean square; or [`Norm::Peak`], the
//! largest value of |f|. f is a product over the axes, and so are its norms. They are exact for every coefficient,
//! boundary functions included, but for peaks of B-splines, which are sampled at every eighth of a knot interval.

use std::ops::Range;

use wavesplat_compute::parallel;

use super::plan::TransformPlan;
use super::real::Real;
use super::spline::{MAX_ORDER, SparseColumn, gram, knots, values};
use super::step::LevelStep;
use crate::family::WaveletFamily;

/// Norm of a basis function.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Norm {
    /// Root of the sum (or integral) of squares, finest spacing 1.
    L2,
    /// Largest absolute value.
    Peak,
}

/// Norms of all basis functions along one axis.
#[derive(Clone, Debug, Default)]
pub struct AxisNorms {
    l2: BandNorms,
    peak: BandNorms,
}

/// Norms of scaling functions at levels `0..=n_levels`, of wavelets at levels `0..n_levels`.
#[derive(Clone, Debug, Default)]
struct BandNorms {
    low: Vec<Vec<f64>>,
    high: Vec<Vec<f64>>,
}

impl TransformPlan {
    /// Norms along one axis, one per coefficient in the order of the data: of the wavelets of a level (`detail`), or of
    /// the scaling functions of its low-pass box. The norm of a coefficient in space is the product over the axes: in
    /// [`TransformPlan::subband`] of `level`, details of `level` where the band's bit is set and scaling functions of
    /// `level + 1` where not.
    ///
    /// # Panics
    /// Where there is no such level or axis.
    pub fn norms(&self, norm: Norm, axis: usize, level: usize, detail: bool) -> &[f64] {
        let norms = &self.axes()[axis].norms;
        let bands = match norm {
            Norm::L2 => &norms.l2,
            Norm::Peak => &norms.peak,
        };
        if detail { &bands.high[level] } else { &bands.low[level] }
    }

    /// Factor from the coefficients in the middle of a subband to their amplitudes; boundary functions differ. 0 where
    /// the band is empty.
    ///
    /// # Panics
    /// Where `level` is not below [`TransformPlan::n_levels`].
    pub fn band_norm(&self, norm: Norm, level: usize, band: usize) -> f64 {
        let middle = |norms: &[f64]| norms.get(norms.len() / 2).copied().unwrap_or(0.0);
        (0..3).map(|axis| middle(self.band_norms(norm, axis, level, band))).product()
    }

    fn band_norms(&self, norm: Norm, axis: usize, level: usize, band: usize) -> &[f64] {
        let detail = band >> axis & 1 == 1;
        self.norms(norm, axis, if detail { level } else { level + 1 }, detail)
    }
}

/// Multiplies every coefficient by the norm of its function; thresholds apply to the absolute value of the result.
///
/// # Panics
/// Where the number of coefficients is not the plan's number of samples.
pub fn to_amplitudes<T: Real>(plan: &TransformPlan, norm: Norm, coefficients: &mut [T]) {
    scale(plan, norm, coefficients, |factor| factor);
}

/// Undoes [`to_amplitudes`], to rounding.
///
/// # Panics
/// Where the number of amplitudes is not the plan's number of samples.
pub fn from_amplitudes<T: Real>(plan: &TransformPlan, norm: Norm, amplitudes: &mut [T]) {
    scale(plan, norm, amplitudes, f64::recip);
}

fn scale<T: Real>(plan: &TransformPlan, norm: Norm, data: &mut [T], factor: impl Fn(f64) -> f64 + Sync + Send) {
    plan.check_len(data.len());
    for_each_row(plan, norm, data, |row, norms| {
        for (c, norm) in row.iter_mut().zip(norms.iter()) {
            *c = *c * T::from_f64(factor(norm));
        }
    });
}

/// Calls `work` with every row of every subband, and the norms of its coefficients' functions.
pub(crate) fn for_each_row<T: Send>(
    plan: &TransformPlan,
    norm: Norm,
    data: &mut [T],
    work: impl Fn(&mut [T], RowNorms<'_>) + Sync + Send,
) {
    let [nx, ny, _] = plan.size();
    parallel::for_each_chunk(data, nx * ny, |z, slice| {
        for_each_row_of_slice(plan, norm, z, |first, norms| work(&mut slice[first..first + norms.len()], norms));
    });
}

/// Calls `work` for every row of every subband in slice `z` of the coefficients, with the row's first position in the
/// slice and the norms of its coefficients' functions.
pub(crate) fn for_each_row_of_slice(
    plan: &TransformPlan,
    norm: Norm,
    z: usize,
    mut work: impl FnMut(usize, RowNorms<'_>),
) {
    let nx = plan.size()[0];
    let mut rows_of_box = |[xs, ys, zs]: [Range<usize>; 3], [along_x, along_y, along_z]: [&[f64]; 3]| {
        if zs.contains(&z) && !xs.is_empty() {
            for (y, norm_y) in ys.zip(along_y) {
                work(y * nx + xs.start, RowNorms { along_x, y: *norm_y, z: along_z[z - zs.start] });
            }
        }
    };
    for level in 0..plan.n_levels() {
        for band in 1..8 {
            let norms = [0, 1, 2].map(|axis| plan.band_norms(norm, axis, level, band));
            rows_of_box(plan.subband(level, band), norms);
        }
    }
    let coarsest = plan.n_levels();
    let norms = [0, 1, 2].map(|axis| plan.norms(norm, axis, coarsest, false));
    rows_of_box(plan.low_size(coarsest).map(|n| 0..n), norms);
}

/// Norms of the functions of a row of coefficients.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RowNorms<'a> {
    along_x: &'a [f64],
    y: f64,
    z: f64,
}

impl<'a> RowNorms<'a> {
    /// Norm of each coefficient's function.
    #[inline(always)]
    pub fn iter(self) -> impl Iterator<Item = f64> + 'a {
        let Self { along_x, y, z } = self;
        along_x.iter().map(move |x| x * y * z)
    }

    pub fn len(self) -> usize {
        self.along_x.len()
    }
}

impl AxisNorms {
    /// Computes the norms of all basis functions, synthesised to the finest grid.
    pub fn new(family: WaveletFamily, n: usize, steps: &[LevelStep]) -> Self {
        let measure = FunctionMeasure::new(family, n);
        let mut norms = Self::default();
        let mut scaling: Vec<SparseColumn> = (0..n).map(|i| SparseColumn { first: i, values: vec![1.0] }).collect();
        norms.push(&measure, &scaling, false);
        for step in steps {
            let functions: Vec<SparseColumn> = step
                .functions()
                .iter()
                .map(|taps| {
                    let first = taps.iter().map(|tap| scaling[tap.index].first).min().unwrap_or(0);
                    let end = taps.iter().map(|tap| scaling[tap.index].end()).max().unwrap_or(0);
                    let mut values = vec![0.0; end - first];
                    for tap in taps {
                        let fine = &scaling[tap.index];
                        for (value, f) in values[fine.first - first..].iter_mut().zip(&fine.values) {
                            *value += tap.weight * f;
                        }
                    }
                    SparseColumn { first, values }
                })
                .collect();
            let (low, high) = functions.split_at(step.n_low);
            norms.push(&measure, low, false);
            norms.push(&measure, high, true);
            scaling = low.to_vec();
        }
        norms
    }

    fn push(&mut self, measure: &FunctionMeasure, functions: &[SparseColumn], detail: bool) {
        let l2 = functions.iter().map(|f| measure.l2(f)).collect();
        let peak = functions.iter().map(|f| measure.peak(f)).collect();
        let bands = [(&mut self.l2, l2), (&mut self.peak, peak)];
        for (bands, norms) in bands {
            if detail { bands.high.push(norms) } else { bands.low.push(norms) }
        }
    }
}

/// Computes norms of functions on the finest grid, from samples or from spline coefficients.
enum FunctionMeasure {
    Samples,
    Splines {
        order: usize,
        gram: Vec<[f64; MAX_ORDER]>,
        /// Values of the functions of each interval at its eighths, both ends included.
        eighths: Vec<[[f64; MAX_ORDER]; 9]>,
    },
}

impl FunctionMeasure {
    fn new(family: WaveletFamily, n: usize) -> Self {
        match family.semi_orthogonal_order() {
            // Fewer coefficients than one interval needs carry no spline; they are never split.
            Some(order) if n >= order => {
                let breaks: Vec<f64> = (0..n + 2 - order).map(|i| i as f64).collect();
                let knots = knots(&breaks, order);
                let at = |interval: usize, eighth: usize| {
                    values(&knots, order, interval, interval as f64 + eighth as f64 / 8.0)
                };
                let eighths = (0..breaks.len() - 1).map(|i| std::array::from_fn(|eighth| at(i, eighth))).collect();
                Self::Splines { order, gram: gram(&breaks, order), eighths }
            }
            _ => Self::Samples,
        }
    }

    fn l2(&self, f: &SparseColumn) -> f64 {
        let sum: f64 = match self {
            Self::Samples => f.values.iter().map(|x| x * x).sum(),
            Self::Splines { order, gram, .. } => (f.first..f.end())
                .map(|i| {
                    let beside: f64 = (1..*order).map(|d| gram[i].get(d).map_or(0.0, |g| g * f.at(i + d))).sum();
                    f.at(i) * (gram[i][0] * f.at(i) + 2.0 * beside)
                })
                .sum(),
        };
        sum.sqrt()
    }

    fn peak(&self, f: &SparseColumn) -> f64 {
        match self {
            Self::Samples => f.values.iter().fold(0.0, |a, b| a.max(b.abs())),
            Self::Splines { order, eighths, .. } => {
                let touched = f.first.saturating_sub(order - 1)..eighths.len().min(f.end());
                let value = |i: usize, at: &[f64; MAX_ORDER]| (0..*order).map(|k| at[k] * f.at(i + k)).sum::<f64>();
                let points = touched.flat_map(|i| eighths[i].iter().map(move |at| value(i, at).abs()));
                points.fold(0.0, f64::max)
            }
        }
    }
}
