//! Transfer functions for coarser levels: what a low sample stands for is many samples, classified before the mean is
//! taken.
//!
//! A thin wall between two cavities has a low sample near that of a cavity, and drawn by it the wall vanishes: the
//! picture of a coarser level gets darker, and with a hard function full of holes. What the finer levels carried is known,
//! so the opacity of a coarse value `d` is the mean opacity of the samples `v` at the positions where the coarse volume,
//! interpolated, has that value: with `P(v | d)` from a joint histogram of the two and `a` the opacity of a length `s`,
//!
//! `A(d) = Σ P(v | d) a(v)`, `a(v) = 1 − (1 − α(v))^s`,
//!
//! the colour is the mean weighted by `a`, and `α` of the coarse value is `1 − (1 − A)^(1/s)`. The mean is taken of
//! opacities of a length, not of optical depths, since what is behind something opaque does not count; `s` is the distance
//! of the finest samples. It is a trimmed mean: of the `v` behind a `d`, the lowest and the highest few in a hundred do not
//! count, since what is that rare is elsewhere as a rule, and would be drawn as a haze wherever there is a `d`.
//! What hides what, and how what is seen stands to the light, no mean over values knows: the
//! extinction is multiplied by what makes rays through the level as bright as those through the samples
//! ([`crate::brightness`]). The histogram knows no transfer function and is made once per level, from a part of the
//! samples; a new function costs a product with a small matrix, and following the rays a few times.
//!
//! Distributions of what a coarse sample stands for, in place of its mean: Younesy, Möller, Carr, "Improving the
//! quality of multi-resolution volume rendering", Eurographics Symposium on Visualization 2006. Here all places with the
//! same coarse value share one.

use wavesplat_compute::parallel;
use wavesplat_core::{ColorNode, Decoder, Joint, OpacityNode, Result, Shading, TransferFunction};

use crate::brightness::{Look, Rays};
use crate::coarse::LevelGrid;

/// Bins of the range of values.
const N_BINS: usize = 512;

/// Sides of the boxes that the histogram is made of, and how many boxes are looked at at most.
const SIDE: usize = 16;
const N_BOXES: usize = 512;

/// Number of places that tell as much of a value as the value itself does, which counts for so many.
const N_OWN: f32 = 4.0;

/// Share of all places from which a coarse value is frequent.
const FREQUENT: f32 = 0.02;

/// Share of what a coarse value stands for that is too rare to count, at either end.
const RARE: f32 = 0.02;

/// Positions within a bin at which the function is looked up.
const N_PER_BIN: usize = 4;

/// Which samples there are where a coarser level has a value.
pub struct Spread {
    lo: f64,
    hi: f64,
    /// `P(v | d)`, a row per bin of coarse values.
    shares: Vec<f32>,
    rays: Rays,
}

impl Spread {
    /// From a volume and a level of it that lies on `grid`. `spacing`: of the volume's samples along each axis, in any
    /// unit. `range`: smallest and largest sample. `budget_bytes`: of work space.
    pub fn new(
        fine: &dyn Decoder,
        coarse: &dyn Decoder,
        grid: &LevelGrid,
        spacing: [f64; 3],
        range: [f64; 2],
        budget_bytes: usize,
    ) -> Self {
        let [lo, hi] = range;
        let size = fine.size();
        let n = size.map(|n| n.div_ceil(SIDE));
        let n_all: usize = n.iter().product();
        let n_boxes = n_all.min(N_BOXES);
        // Distinct places without a pattern: multiples of a prime.
        let place = |i: usize| (i as u64 * 2_654_435_761 % n_all as u64) as usize;
        let parts = parallel::map(n_boxes, |i| {
            let b = place(i);
            let first = [b % n[0], b / n[0] % n[1], b / (n[0] * n[1])].map(|k| k * SIDE);
            let end = [0, 1, 2].map(|a| (first[a] + SIDE).min(size[a]));
            pairs(fine, coarse, grid, first, end)
        });
        let per_value = if hi > lo { N_BINS as f64 / (hi - lo) } else { 0.0 };
        let bin = |v: f32| (((f64::from(v) - lo) * per_value).max(0.0) as usize).min(N_BINS - 1);
        let mut shares = vec![0.0_f32; N_BINS * N_BINS];
        for (v, d) in parts.into_iter().flatten() {
            shares[bin(d) * N_BINS + bin(v)] += 1.0;
        }
        let mut shares = smooth(&shares);
        for (d, row) in shares.chunks_exact_mut(N_BINS).enumerate() {
            row[d] += N_OWN;
            let n: f32 = row.iter().sum();
            for share in row {
                *share /= n;
            }
        }
        Self { lo, hi, shares, rays: Rays::new([fine, coarse], grid, spacing, budget_bytes, bin) }
    }

    /// The function for the level. `spacing`: of the finest grid along each axis, in the function's `opacity_unit`s.
    /// `shading`: what the picture is lit by. `is_steep`: whether the function is, so that the level is drawn with fewer
    /// sheets. Functions of two dimensions are averaged only.
    pub fn filter(
        &self,
        tf: &TransferFunction,
        spacing: [f64; 3],
        shading: Option<&Shading>,
        is_steep: bool,
    ) -> Result<TransferFunction> {
        let length = spacing.iter().product::<f64>().cbrt();
        if tf.joint().is_some() || self.hi <= self.lo {
            return self.average(tf, length);
        }
        let look = |rgba: &[[f64; 4]]| -> Look {
            rgba.iter().map(|&[r, g, b, opacity]| [(r + g + b) / 3.0, opacity]).collect()
        };
        // One bin by itself.
        let own: Vec<_> = (0..N_BINS).map(|bin| separate(self.mean(&rgba_of(tf), bin, length), length)).collect();
        let own = look(&own);
        let with = |rare: f32| {
            let rgba = self.averages(rgba_of(tf), length, rare);
            let looks = [&own, &look(&rgba)];
            let factors = self.rays.factors(looks, shading, spacing, is_steep);
            let is_bright_enough = self.rays.is_bright_enough(looks, factors[0], spacing, is_steep);
            (rgba, factors, is_bright_enough)
        };
        let (mut rgba, mut factors, is_bright_enough) = with(RARE);
        // Where much of what is seen is rare.
        if !is_bright_enough {
            (rgba, factors, _) = with(0.0);
        }
        let [factor, gain] = factors;
        for [color @ .., opacity] in &mut rgba {
            *opacity = opacity_of(factor, *opacity);
            *color = color.map(|c| (gain * c).min(1.0));
        }
        self.function(tf, &rgba)
    }

    /// The function with opacities averaged over a `length`, in its `opacity_unit`s; nothing is too rare to count.
    pub fn average(&self, tf: &TransferFunction, length: f64) -> Result<TransferFunction> {
        if self.hi <= self.lo {
            return Ok(tf.clone());
        }
        // Gradients of coarse samples stand for themselves.
        if let Some(joint) = tf.joint() {
            let magnitudes = joint.magnitudes();
            let rows = magnitudes.iter().map(|m| self.averages(|value| joint.rgba(value, *m), length, 0.0));
            let rgba = rows.collect::<Vec<_>>().concat();
            let joint = Joint::new(self.values().collect(), magnitudes.to_vec(), rgba)?;
            return TransferFunction::two_dimensional(joint, tf.opacity_unit());
        }
        self.function(tf, &self.averages(rgba_of(tf), length, 0.0))
    }

    /// The function with these colours and opacities in the middle of every bin.
    fn function(&self, tf: &TransferFunction, rgba: &[[f64; 4]]) -> Result<TransferFunction> {
        let nodes = self.values().zip(rgba);
        let opacity = nodes.clone().map(|(value, rgba)| OpacityNode { value, opacity: rgba[3] });
        let color = nodes.map(|(value, &[r, g, b, _])| ColorNode { value, rgb: [r, g, b] });
        TransferFunction::new(opacity.collect(), color.collect(), tf.opacity_unit())?
            .with_gradient_opacity(tf.gradient_nodes().to_vec())
    }

    /// The middle of every bin.
    fn values(&self) -> impl Iterator<Item = f64> + Clone {
        (0..N_BINS).map(|bin| self.lo + (bin as f64 + 0.5) * self.step())
    }

    /// Values from one bin to the next.
    fn step(&self) -> f64 {
        (self.hi - self.lo) / N_BINS as f64
    }

    /// Mean of associated colour and opacity of a `length` over a bin.
    fn mean(&self, rgba: &impl Fn(f64) -> [f64; 4], bin: usize, length: f64) -> [f64; 4] {
        let mut sum = [0.0_f64; 4];
        for k in 0..N_PER_BIN {
            let value = self.lo + (bin as f64 + (k as f64 + 0.5) / N_PER_BIN as f64) * self.step();
            let [r, g, b, opacity] = rgba(value);
            let opacity = opacity_of(length, opacity) / N_PER_BIN as f64;
            [r, g, b, 1.0].into_iter().zip(&mut sum).for_each(|(c, sum)| *sum += c * opacity);
        }
        sum
    }

    /// Colour and opacity of every bin, averaged over what its coarse values stand for but the `rare` share at either
    /// end, opacities of a `length`.
    fn averages(&self, rgba: impl Fn(f64) -> [f64; 4], length: f64, rare: f32) -> Vec<[f64; 4]> {
        let own: Vec<_> = (0..N_BINS).map(|bin| self.mean(&rgba, bin, length)).collect();
        let average = |(row, value): (&[f32], f64)| {
            let mut sum = [0.0; 4];
            for (share, own) in trimmed(row, rare).zip(&own).filter(|(share, _)| *share > 0.0) {
                (0..4).for_each(|c| sum[c] += f64::from(share) * own[c]);
            }
            if sum[3] < LEAST {
                let [r, g, b, _] = rgba(value);
                return [r, g, b, 0.0];
            }
            separate(sum, length)
        };
        self.shares.chunks_exact(N_BINS).zip(self.values()).map(average).collect()
    }
}

/// Shares of which a `rare` part at either end is left out; they add up to one again.
fn trimmed(shares: &[f32], rare: f32) -> impl Iterator<Item = f32> {
    let mut left = [rare, 1.0 - 2.0 * rare];
    shares.iter().map(move |share| {
        let mut share = *share;
        // What is left out below, then what counts; the rest is above.
        let [_, counted] = left.each_mut().map(|left| {
            let taken = share.min(*left);
            *left -= taken;
            share -= taken;
            taken
        });
        counted / (1.0 - 2.0 * rare)
    })
}

/// Opacity of a length, of that of a unit.
fn opacity_of(length: f64, opacity: f64) -> f64 {
    (-(length * (-opacity).ln_1p()).exp_m1()).clamp(0.0, 1.0)
}

/// Colour, and opacity of a unit, from associated colour and opacity of a length.
fn separate([r, g, b, opacity]: [f64; 4], length: f64) -> [f64; 4] {
    let [r, g, b] = [r, g, b].map(|c| if opacity > 0.0 { (c / opacity).clamp(0.0, 1.0) } else { 0.0 });
    // Shares add up to one but for rounding, and what is solid stays so.
    let opacity = if opacity > 1.0 - 1e-6 { 1.0 } else { opacity };
    [r, g, b, opacity_of(1.0 / length, opacity)]
}

/// Colour and opacity of a function's values.
fn rgba_of(tf: &TransferFunction) -> impl Fn(f64) -> [f64; 4] {
    |value| {
        let [r, g, b] = tf.color(value);
        [r, g, b, tf.opacity(value)]
    }
}

/// Counts of neighbouring coarse values together, but none with more than its own: chance steps from bin to bin would
/// make a smooth function one that has to be pre-integrated. Frequent values stand for themselves: what is solid, or
/// clear, stays so.
fn smooth(counts: &[f32]) -> Vec<f32> {
    let n: Vec<f32> = counts.chunks_exact(N_BINS).map(|row| row.iter().sum()).collect();
    let frequent = FREQUENT * n.iter().sum::<f32>();
    let mut smooth = vec![0.0; counts.len()];
    for (d, row) in smooth.chunks_exact_mut(N_BINS).enumerate() {
        if n[d] > frequent {
            row.copy_from_slice(&counts[d * N_BINS..][..N_BINS]);
            continue;
        }
        for (k, weight) in [1.0, 2.0, 3.0, 2.0, 1.0].into_iter().enumerate() {
            let Some(from) = (d + k).checked_sub(2).filter(|from| *from < N_BINS) else { continue };
            let weight = weight / 9.0 * (n[d].max(N_OWN) / n[from].max(N_OWN)).min(1.0);
            for (sum, count) in row.iter_mut().zip(&counts[from * N_BINS..]) {
                *sum += weight * count;
            }
        }
    }
    smooth
}

/// Mean opacity that is not worth drawing: of a thousand coarse samples in a row it would make a tenth.
const LEAST: f64 = 1e-4;

/// Sample and interpolated coarse value at every place of a box of the finest grid.
fn pairs(
    fine: &dyn Decoder,
    coarse: &dyn Decoder,
    grid: &LevelGrid,
    first: [usize; 3],
    end: [usize; 3],
) -> Vec<(f32, f32)> {
    let n @ [nx, ny, nz] = [0, 1, 2].map(|a| end[a] - first[a]);
    let mut values = vec![0.0; nx * ny * nz];
    fine.decode(first, end, &mut values);
    let last = coarse.size().map(|n| n - 1);
    // Where each place lies between coarse samples: the lower one and the share of the upper one.
    let between = |a: usize| -> Vec<(usize, f32)> {
        let at = |i: usize| {
            let mut index = [0.0; 3];
            index[a] = (first[a] + i) as f64;
            let x = grid.level_from_finest(index)[a].clamp(0.0, last[a] as f64);
            let below = (x as usize).min(last[a].saturating_sub(1));
            (below, (x - below as f64) as f32)
        };
        (0..n[a]).map(at).collect()
    };
    let axes = [0, 1, 2].map(between);
    let lo = [0, 1, 2].map(|a| axes[a][0].0);
    let hi = [0, 1, 2].map(|a| (axes[a][n[a] - 1].0 + 2).min(last[a] + 1));
    let [cx, cy, cz] = [0, 1, 2].map(|a| hi[a] - lo[a]);
    let mut low = vec![0.0; cx * cy * cz];
    coarse.decode(lo, hi, &mut low);
    let mut pairs = Vec::with_capacity(values.len());
    for (k, &(z, tz)) in axes[2].iter().enumerate() {
        for (j, &(y, ty)) in axes[1].iter().enumerate() {
            let row = |dy: usize, dz: usize| {
                let (y, z) = ((y - lo[1] + dy).min(cy - 1), (z - lo[2] + dz).min(cz - 1));
                &low[(z * cy + y) * cx..][..cx]
            };
            let rows = [row(0, 0), row(1, 0), row(0, 1), row(1, 1)];
            let weights = [(1.0 - ty) * (1.0 - tz), ty * (1.0 - tz), (1.0 - ty) * tz, ty * tz];
            for (i, &(x, tx)) in axes[0].iter().enumerate() {
                let (x0, x1) = (x - lo[0], (x - lo[0] + 1).min(cx - 1));
                let d: f32 = rows.iter().zip(weights).map(|(row, w)| w * (row[x0] * (1.0 - tx) + row[x1] * tx)).sum();
                pairs.push((values[(k * ny + j) * nx + i], d));
            }
        }
    }
    pairs
}
