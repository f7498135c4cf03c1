//! Level of detail: transfer function of a coarser level.
//!
//! Where a thin wall separates two cavities, the coarse samples are near the value of a cavity, and classified by them
//! the wall vanishes: the picture of a coarser level gets darker, and with a hard function full of holes. So samples
//! are classified before the mean is taken: the opacity of a coarse value `d` is the mean opacity of the samples `v` at
//! the positions where the interpolated coarse volume has that value. With `P(v | d)` of the [`LevelHistogram`] and `a`
//! the opacity of a length `s`,
//!
//! `A(d) = Σ P(v | d) a(v)`, `a(v) = 1 − (1 − α(v))^s`,
//!
//! the colour is the mean weighted by `a`, and `α` of the coarse value is `1 − (1 − A)^(1/s)`. The mean is taken of
//! opacities of a length, not of optical depths, since matter behind an opaque sample does not count; `s` is the
//! distance of the finest samples. It is a trimmed mean: of the samples `v` for a `d`, the lowest and the highest few
//! per cent do not count, since values that rare at `d` mostly occur elsewhere, and would be drawn as a haze at all
//! positions of `d`.
//!
//! A mean over values accounts neither for occlusion nor for the angles of visible surfaces to the light: the
//! extinction is then multiplied by the factor that makes rays through the level as bright as rays through the samples
//! (`level_brightness.rs`).
//!
//! Distributions of the samples that a coarse one stands for, in place of their mean: Younesy, Möller, Carr, "Improving
//! the quality of multi-resolution volume rendering", Eurographics Symposium on Visualization 2006. Here all positions
//! with the same coarse value share one distribution.

use wavesplat_core::{ColorNode, OpacityNode, Result, Shading, TransferFunction, TransferFunction2D};

use crate::level_brightness::GrayTable;
use crate::level_histogram::{LevelHistogram, N_BINS};

/// Share of the distribution of a coarse value that the trimmed mean leaves out at either end.
const TRIMMED_SHARE: f32 = 0.02;

/// Values per bin at which the function is looked up, or per part of a bin between nodes of the function.
const N_PER_PART: usize = 4;

/// Mean opacity below which nothing is drawn: a thousand coarse samples in a row would reach an opacity of a tenth.
const MIN_OPACITY: f64 = 1e-4;

impl LevelHistogram {
    /// Transfer function for the level. `spacing`: sample distance of the finest grid along each axis, in the
    /// function's `opacity_unit`s. `shading`: the picture's. `needs_preintegration`: whether the function needs
    /// pre-integration, so that the level is drawn with fewer sheets. Functions of two dimensions are only averaged.
    pub fn filter(
        &self,
        tf: &TransferFunction,
        spacing: [f64; 3],
        shading: Option<&Shading>,
        needs_preintegration: bool,
    ) -> Result<TransferFunction> {
        let length = spacing.iter().product::<f64>().cbrt();
        if tf.function_2d().is_some() || self.hi <= self.lo {
            return self.average(tf, length);
        }
        let gray = |rgba: &[[f64; 4]]| -> GrayTable {
            rgba.iter().map(|&[r, g, b, opacity]| [(r + g + b) / 3.0, opacity]).collect()
        };
        // Each of the finest samples stands for itself.
        let means = self.means(rgba_of(tf), &nodes_of(tf), length);
        let own = gray(&means.iter().map(|mean| separate(*mean, length)).collect::<Vec<_>>());
        let with = |rare: f32| {
            let rgba = self.averages(&means, rgba_of(tf), length, rare);
            let tables = [&own, &gray(&rgba)];
            let factors = self.rays.brightness_factors(tables, shading, spacing, needs_preintegration);
            let is_nearly_as_bright = self.rays.is_nearly_as_bright(tables, factors[0], spacing, needs_preintegration);
            (rgba, factors, is_nearly_as_bright)
        };
        let (mut rgba, mut factors, is_nearly_as_bright) = with(TRIMMED_SHARE);
        // Where most visible values are rare, trimming would drop them.
        if !is_nearly_as_bright {
            (rgba, factors, _) = with(0.0);
        }
        let [factor, gain] = factors;
        for [color @ .., opacity] in &mut rgba {
            *opacity = opacity_of(factor, *opacity);
            *color = color.map(|c| (gain * c).min(1.0));
        }
        self.function(tf, &rgba)
    }

    /// Transfer function with opacities averaged over a `length`, in its `opacity_unit`s, without trimming.
    pub fn average(&self, tf: &TransferFunction, length: f64) -> Result<TransferFunction> {
        if self.hi <= self.lo {
            return Ok(tf.clone());
        }
        // Gradients of coarse samples are not averaged: they stand for themselves.
        if let Some(joint) = tf.function_2d() {
            let magnitudes = joint.magnitudes();
            let row = |m: &f64| {
                let rgba = |value| joint.rgba(value, *m);
                self.averages(&self.means(rgba, joint.values(), length), rgba, length, 0.0)
            };
            let rows = magnitudes.iter().map(row);
            let rgba = rows.collect::<Vec<_>>().concat();
            let joint = TransferFunction2D::new(self.values().collect(), magnitudes.to_vec(), rgba)?;
            return TransferFunction::two_dimensional(joint, tf.opacity_unit());
        }
        let means = self.means(rgba_of(tf), &nodes_of(tf), length);
        self.function(tf, &self.averages(&means, rgba_of(tf), length, 0.0))
    }

    /// Transfer function with these colours and opacities in the middle of every bin.
    fn function(&self, tf: &TransferFunction, rgba: &[[f64; 4]]) -> Result<TransferFunction> {
        let mut opacity = Vec::with_capacity(N_BINS);
        for (bin, (value, &[.., own])) in self.values().zip(rgba).enumerate() {
            // A single bin of opacity 1 is opaque over its whole width; a single node would have no width.
            let is_opaque = |bin: usize| rgba.get(bin).is_some_and(|rgba| rgba[3] == 1.0);
            let is_alone = is_opaque(bin) && !is_opaque(bin + 1) && !(bin > 0 && is_opaque(bin - 1));
            let half = if is_alone { 0.5 * self.step() } else { 0.0 };
            opacity.push(OpacityNode { value: value - half, opacity: own });
            if is_alone {
                opacity.push(OpacityNode { value: value + half, opacity: own });
            }
        }
        let color = self.values().zip(rgba).map(|(value, &[r, g, b, _])| ColorNode { value, rgb: [r, g, b] });
        TransferFunction::new(opacity, color.collect(), tf.opacity_unit())?
            .with_gradient_opacity(tf.gradient_nodes().to_vec())
    }

    /// Mean of associated colour and opacity of a `length` over each bin. `nodes`: values in order, between which the
    /// function is linear, so that a peak thinner than a bin has the weight of its width.
    fn means(&self, rgba: impl Fn(f64) -> [f64; 4], nodes: &[f64], length: f64) -> Vec<[f64; 4]> {
        let mean = |bin: usize| {
            let [begin, end] = [bin, bin + 1].map(|bin| self.lo + bin as f64 * self.step());
            let (from, to) = (nodes.partition_point(|node| *node <= begin), nodes.partition_point(|node| *node < end));
            let inside = nodes.get(from..to).unwrap_or_default();
            let (mut sum, mut before) = ([0.0_f64; 4], begin);
            for after in inside.iter().copied().chain([end]) {
                let share = (after - before) / (self.step() * N_PER_PART as f64);
                for k in 0..N_PER_PART {
                    let [r, g, b, opacity] = rgba(before + (k as f64 + 0.5) / N_PER_PART as f64 * (after - before));
                    let opacity = opacity_of(length, opacity) * share;
                    [r, g, b, 1.0].into_iter().zip(&mut sum).for_each(|(c, sum)| *sum += c * opacity);
                }
                before = after;
            }
            sum
        };
        (0..N_BINS).map(mean).collect()
    }

    /// Colour and opacity of every bin, averaged over the samples at its coarse values, without the `rare` share at
    /// either end. `own`: the means of the bins for a `length`.
    fn averages(&self, own: &[[f64; 4]], rgba: impl Fn(f64) -> [f64; 4], length: f64, rare: f32) -> Vec<[f64; 4]> {
        let average = |(row, value): (&[f32], f64)| {
            let mut sum = [0.0; 4];
            for (share, own) in trimmed(row, rare).zip(own).filter(|(share, _)| *share > 0.0) {
                (0..4).for_each(|c| sum[c] += f64::from(share) * own[c]);
            }
            if sum[3] < MIN_OPACITY {
                let [r, g, b, _] = rgba(value);
                return [r, g, b, 0.0];
            }
            separate(sum, length)
        };
        self.shares.chunks_exact(N_BINS).zip(self.values()).map(average).collect()
    }
}

/// Weights of a trimmed mean: `shares` without the `rare` part at either end, normalised to a sum of 1.
fn trimmed(shares: &[f32], rare: f32) -> impl Iterator<Item = f32> {
    let mut left = [rare, 1.0 - 2.0 * rare];
    shares.iter().map(move |share| {
        let mut share = *share;
        // The first part is trimmed below, the next one counts, the rest is trimmed above.
        let [_, counted] = left.each_mut().map(|left| {
            let taken = share.min(*left);
            *left -= taken;
            share -= taken;
            taken
        });
        counted / (1.0 - 2.0 * rare)
    })
}

/// Opacity correction: opacity of a length, from the opacity of a unit.
fn opacity_of(length: f64, opacity: f64) -> f64 {
    (-(length * (-opacity).ln_1p()).exp_m1()).clamp(0.0, 1.0)
}

/// Colour, and opacity of a unit, from associated colour and opacity of a length.
fn separate([r, g, b, opacity]: [f64; 4], length: f64) -> [f64; 4] {
    let [r, g, b] = [r, g, b].map(|c| if opacity > 0.0 { (c / opacity).clamp(0.0, 1.0) } else { 0.0 });
    // Shares add up to 1 but for rounding, and opaque values must stay opaque.
    let opacity = if opacity > 1.0 - 1e-6 { 1.0 } else { opacity };
    [r, g, b, opacity_of(1.0 / length, opacity)]
}

/// Values between which a function is linear, in order.
fn nodes_of(tf: &TransferFunction) -> Vec<f64> {
    let opacity = tf.opacity_nodes().iter().map(|node| node.value);
    let mut values: Vec<f64> = opacity.chain(tf.color_nodes().iter().map(|node| node.value)).collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}

/// Colour and opacity of a function's values.
fn rgba_of(tf: &TransferFunction) -> impl Fn(f64) -> [f64; 4] {
    |value| {
        let [r, g, b] = tf.color(value);
        [r, g, b, tf.opacity(value)]
    }
}
