//! Density -> colour and optical depth, once per texel, after reconstruction.
//!
//! The transfer function's opacity `a` per `opacity_unit` becomes the optical depth `τ = −ln(1 − a)`, tabulated with
//! the colour; a slab of thickness `s` then has opacity `1 − exp(−τ s)` (Engel et al., *Real-Time Volume Graphics*,
//! 2006, ch. 1). For a sheet crossed at angle θ the thickness is `dz / cos θ`: the view-angle correction of
//! high-resolution splatting. The exponential is ours, in plain f32 operations, so that every SIMD width gives the
//! same bits; it keeps its relative precision for thin slabs, which `1 − (1 − a)^s` loses.

use wavesplat_core::TransferFunction;

/// Optical depth that stands for opacity 1: opaque at any thickness above 1e-28 units.
const OPAQUE: f64 = 1e30;

/// Entries of the table, at least and at most; and how many the narrowest segment of the curves gets.
const MIN_ENTRIES: usize = 2048;
const MAX_ENTRIES: usize = 1 << 16;
const ENTRIES_PER_SEGMENT: f64 = 16.0;

/// One table entry: red, green, blue, optical depth per `opacity_unit`.
pub type Entry = [f32; 4];

/// A transfer function tabulated over densities.
#[derive(Clone, Debug)]
pub struct Classifier {
    table: Vec<Entry>,
    lo: f32,
    per_density: f32,
    /// `visible[i]`: how many of the entries before `i` have an opacity.
    visible: Vec<u32>,
    /// Total variation of a slab's associated colour and opacity up to each entry.
    variation: Vec<f32>,
}

impl Classifier {
    /// Tabulates over the densities that can occur: `range` widened by a quarter for kernels that overshoot.
    /// `density_from_sample` is `(offset, scale)` as in [`wavesplat_core::Volume::density_from_sample`].
    /// `slab_thickness`: that of a typical slab, in `opacity_unit`s, for [`Classifier::variation`].
    pub fn new(tf: &TransferFunction, density_from_sample: (f64, f64), range: [f32; 2], slab_thickness: f64) -> Self {
        let (offset, scale) = density_from_sample;
        let density = |value: f64| (value - offset) * scale;
        let mut nodes: Vec<f64> = tf.opacity_nodes().iter().map(|n| density(n.value)).collect();
        nodes.extend(tf.color_nodes().iter().map(|n| density(n.value)));
        nodes.sort_by(f64::total_cmp);
        let [min, max] = range.map(f64::from);
        let widened = 0.25 * (max - min);
        // Beyond the outer nodes the curves are constant, so the table need not go there.
        let lo = (min - widened).max(nodes[0]);
        let hi = (max + widened).min(nodes[nodes.len() - 1]);
        let (lo, hi) = if lo < hi { (lo, hi) } else { (min, max.max(min + min.abs() * 1e-6 + 1e-6)) };
        let narrowest = nodes
            .windows(2)
            .filter(|pair| pair[1] > lo && pair[0] < hi && pair[1] > pair[0])
            .fold(hi - lo, |narrowest, pair| narrowest.min(pair[1] - pair[0]));
        let entries = (ENTRIES_PER_SEGMENT * (hi - lo) / narrowest).ceil();
        let n = (entries.min(MAX_ENTRIES as f64) as usize).max(MIN_ENTRIES);
        let step = (hi - lo) / n as f64;
        let entry = |i: usize| {
            let value = (lo + i as f64 * step) / scale + offset;
            let [r, g, b] = tf.color(value);
            let depth = (-(-tf.opacity(value)).ln_1p()).min(OPAQUE);
            [r as f32, g as f32, b as f32, depth as f32]
        };
        // One entry more than cells, and one more so that the last cell has an upper end at its very end.
        let table: Vec<Entry> = (0..=n).chain([n]).map(entry).collect();
        let mut visible = vec![0];
        for (i, entry) in table.iter().enumerate() {
            visible.push(visible[i] + u32::from(entry[3] > 0.0));
        }
        let slab = |[r, g, b, depth]: Entry| {
            let opacity = one_minus_exp_neg(depth * slab_thickness as f32);
            [r * opacity, g * opacity, b * opacity, opacity]
        };
        let mut variation = vec![0.0_f32];
        for (i, pair) in table.windows(2).enumerate() {
            let (a, b) = (slab(pair[0]), slab(pair[1]));
            let change = (0..4).map(|c| (a[c] - b[c]).abs()).fold(0.0, f32::max);
            variation.push(variation[i] + change);
        }
        Self { table, lo: lo as f32, per_density: (1.0 / step) as f32, visible, variation }
    }

    /// How much a slab's colour and opacity change in all on the way up to a density: between two densities, the
    /// difference bounds how wrong one of them is for the other.
    #[inline(always)]
    pub fn variation(&self, density: f32) -> f32 {
        let position = self.position(density);
        let cell = position as u32 as usize;
        let t = position - cell as f32;
        self.variation[cell] + (self.variation[cell + 1] - self.variation[cell]) * t
    }

    /// Position in the table, `0..=n`.
    #[inline(always)]
    fn position(&self, density: f32) -> f32 {
        let last = (self.table.len() - 2) as f32;
        ((density - self.lo) * self.per_density).max(0.0).min(last)
    }

    /// Whether any density of the range has an opacity.
    pub fn any_opacity(&self, lo: f32, hi: f32) -> bool {
        let first = self.position(lo) as usize;
        let last = self.position(hi).ceil() as usize;
        self.visible[last + 1] > self.visible[first]
    }

    /// Colour and optical depth of one density.
    #[inline(always)]
    pub fn look_up(&self, density: f32) -> Entry {
        let position = self.position(density);
        let cell = position as u32 as usize;
        let t = position - cell as f32;
        let (a, b) = (&self.table[cell], &self.table[cell + 1]);
        [a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t, a[2] + (b[2] - a[2]) * t, a[3] + (b[3] - a[3]) * t]
    }
}

/// `1 − exp(−x)` for `x ≥ 0`, to about 1e-7 relative.
///
/// Split `x = n ln 2 + r`, `|r| ≤ ln 2 / 2`; then `exp(−x) − 1 = 2^−n (exp(−r) − 1) + (2^−n − 1)`, the bracket by its
/// Taylor series.
#[inline(always)]
pub fn one_minus_exp_neg(x: f32) -> f32 {
    // Adding and taking away 1.5 · 2^23 rounds to an integer, which then stands in the low bits.
    const ROUND: f32 = 12_582_912.0;
    // ln 2 in two parts, so that n · high is exact.
    const LN2_HIGH: f32 = 0.693_359_4;
    const LN2_LOW: f32 = -2.121_944_4e-4;
    let x = x.min(80.0);
    let shifted = x * std::f32::consts::LOG2_E + ROUND;
    let n = shifted - ROUND;
    let y = -((x - n * LN2_HIGH) - n * LN2_LOW);
    let series = 1.0 / 720.0 + y * (1.0 / 5040.0);
    let series = 1.0 / 24.0 + y * (1.0 / 120.0 + y * series);
    let series = y + y * y * (0.5 + y * (1.0 / 6.0 + y * series));
    let exponent = 127_u32.wrapping_sub(shifted.to_bits().wrapping_sub(ROUND.to_bits()));
    let power = f32::from_bits(exponent << 23);
    (1.0 - power) - power * series
}

#[cfg(test)]
mod tests {
    use super::*;
    use wavesplat_core::{ColorNode, OpacityNode};

    fn classifier(nodes: &[(f64, f64)], range: [f32; 2]) -> (TransferFunction, Classifier) {
        let opacity = nodes.iter().map(|&(value, opacity)| OpacityNode { value, opacity }).collect();
        let color =
            vec![ColorNode { value: 0.0, rgb: [1.0, 0.5, 0.0] }, ColorNode { value: 200.0, rgb: [0.0, 0.5, 1.0] }];
        let tf = TransferFunction::new(opacity, color, None).unwrap();
        let classifier = Classifier::new(&tf, (0.0, 1.0), range, 1.0);
        (tf, classifier)
    }

    #[test]
    fn exponential_is_precise_for_thin_and_thick_slabs() {
        for i in 0..20_000 {
            let x = 1e-6_f32 * 1.001_f32.powi(i).min(1e9);
            let want = -(-f64::from(x)).exp_m1();
            let got = f64::from(one_minus_exp_neg(x));
            assert!((got - want).abs() <= 2.5e-7 * want, "{x}: {got} for {want}");
        }
        assert_eq!(one_minus_exp_neg(0.0), 0.0);
        assert_eq!(one_minus_exp_neg(1e30), 1.0);
        assert_eq!(one_minus_exp_neg(f32::INFINITY), 1.0);
    }

    #[test]
    fn the_table_follows_the_curves() {
        let (tf, classifier) = classifier(&[(20.0, 0.0), (60.0, 0.3), (61.0, 0.9), (180.0, 0.1)], [0.0, 255.0]);
        for i in 0..5100 {
            let density = i as f32 * 0.05;
            let [r, _, b, depth] = classifier.look_up(density);
            let opacity = 1.0 - f64::from(-depth).exp();
            assert!((opacity - tf.opacity(f64::from(density))).abs() < 4e-3, "{density}: {opacity}");
            let [want_r, _, want_b] = tf.color(f64::from(density));
            assert!((f64::from(r) - want_r).abs() < 1e-3 && (f64::from(b) - want_b).abs() < 1e-3, "{density}");
        }
    }

    #[test]
    fn opacity_1_is_opaque_at_any_thickness() {
        let (_, classifier) = classifier(&[(99.0, 0.0), (100.0, 1.0)], [0.0, 255.0]);
        for density in [100.0, 100.5, 255.0, 1e9] {
            assert_eq!(one_minus_exp_neg(classifier.look_up(density)[3] * 1e-6), 1.0, "{density}");
        }
        assert_eq!(classifier.look_up(99.0)[3], 0.0);
        assert!(!classifier.any_opacity(-10.0, 98.9) && classifier.any_opacity(98.0, 99.5));
        assert!(!classifier.any_opacity(-10.0, -5.0) && !classifier.any_opacity(99.0, 99.0));
    }

    #[test]
    fn curves_that_miss_the_data_are_constant() {
        for (node, expected) in [(-500.0, 0.7), (500.0, 0.7)] {
            let opacity = vec![OpacityNode { value: node, opacity: 0.7 }];
            let tf = TransferFunction::new(opacity, vec![ColorNode { value: node, rgb: [0.2; 3] }], None).unwrap();
            let classifier = Classifier::new(&tf, (0.0, 1.0), [7.0, 7.0], 1.0);
            let depth = classifier.look_up(7.0)[3];
            assert!((1.0 - (-depth).exp() - expected as f32).abs() < 1e-6);
            assert!(classifier.any_opacity(7.0, 7.0));
        }
    }
}
