//! Classification and opacity correction: density -> colour and optical depth, once per texel, after reconstruction.
//!
//! The transfer function's opacity `a` per `opacity_unit` becomes the optical depth `τ = −ln(1 − a)`, tabulated with
//! the colour; a slab of thickness `s` then has opacity `1 − exp(−τ s)` (Engel et al., *Real-Time Volume Graphics*,
//! 2006, ch. 1). For a sheet crossed at angle θ the thickness is `dz / cos θ`: the view-angle correction of
//! high-resolution splatting. The exponential is ours, in plain f32 operations, so that every SIMD width gives the
//! same bits; it keeps its relative precision for thin slabs, which `1 − (1 − a)^s` loses.
//!
//! The space between two sheets is pre-integrated where the function is steep (`preintegrate.rs`).

use crate::optics::depth_integral::{DepthIntegral, Opaque};
use crate::optics::preintegrate::segment_table;
use wavesplat_compute::simd::{Math, ROUND};
use wavesplat_core::{OpacityNode, TransferFunction};

pub use wavesplat_compute::simd::Entry;

/// Optical depth that stands for opacity 1: opaque at any thickness above 1e-28 units.
pub const OPAQUE_DEPTH: f64 = 1e30;

/// Entries of the table, at least and at most; and how many the narrowest segment of the curves gets.
const MIN_ENTRIES: usize = 2048;
const MAX_ENTRIES: usize = 1 << 16;
const ENTRIES_PER_SEGMENT: f64 = 16.0;

/// Share of the nodes' extent by which a table begins before a step at the first node: a few entries.
const BEFORE_STEP: f64 = 4.0 / MIN_ENTRIES as f64;

/// A transfer function tabulated over densities.
#[derive(Clone, Debug)]
pub struct Classifier {
    /// Red, green, blue, optical depth per `opacity_unit`.
    pub(super) table: Vec<Entry>,
    /// Integral of the optical depth; nearest visible density above and below; optical depth, capped.
    pub(super) segments: Vec<Entry>,
    pub(super) lo: f32,
    pub(super) hi: f32,
    pub(super) per_density: f32,
    /// Densities beyond which nothing is visible.
    pub(super) visible_range: [f32; 2],
    /// Densities below and above which everything is opaque; infinite if there are no such densities.
    pub(super) opaque_ends: [f32; 2],
    /// The colour, if all visible densities have the same.
    pub(super) only_color: Option<[f32; 3]>,
    /// Number of visible places before each place: entry 0, the cell from it to entry 1, entry 1, and so on. A range
    /// has an opacity if the numbers at its ends differ.
    visible: Vec<u32>,
    /// Least and largest density of the samples.
    pub(super) range: [f32; 2],
}

/// A transfer function as plain arrays, linear between their entries, for other backends.
#[derive(Clone, Copy, Debug)]
pub struct TransferTables<'a> {
    /// Red, green, blue, optical depth per `opacity_unit`; the last entry stands twice.
    pub colors: &'a [Entry],
    /// For pre-integration: ∫ of the optical depth; nearest visible density above and below; optical depth, capped.
    pub segments: &'a [Entry],
    /// Density of the first entry.
    pub first: f32,
    /// Density of the last entry.
    pub last: f32,
    /// Entries per density.
    pub per_density: f32,
    /// Densities beyond which nothing is visible.
    pub visible_range: [f32; 2],
    /// Densities below and above which all is opaque; infinite where there are none.
    pub opaque_ends: [f32; 2],
    /// The colour, if all visible densities have the same.
    pub only_color: Option<[f32; 3]>,
}

impl Classifier {
    /// Tabulates over the densities that can occur: `range` widened by a quarter for kernels that overshoot.
    /// `density_from_sample` is `(offset, scale)` as in [`wavesplat_core::Grid::density_from_sample`].
    /// `slab_thickness`: thickness of a typical slab, in `opacity_unit`s, which decides what counts as opaque.
    pub fn new(tf: &TransferFunction, density_from_sample: (f64, f64), range: [f32; 2], slab_thickness: f64) -> Self {
        let (offset, scale) = density_from_sample;
        let density = |value: f64| (value - offset) * scale;
        let mut values: Vec<f64> = tf.opacity_nodes().iter().map(|n| n.value).collect();
        values.extend(tf.color_nodes().iter().map(|n| n.value));
        values.sort_by(f64::total_cmp);
        let nodes: Vec<f64> = values.iter().map(|value| density(*value)).collect();
        let [min, max] = range.map(f64::from);
        let widened = 0.25 * (max - min);
        // Beyond the outer nodes the curves are constant, so the table need not go there; but a step at the first node
        // belongs to its upper side, so that the table begins before it, on the lower side.
        let begins_with_step = has_step_at(values[0], tf.opacity_nodes().iter().map(|n| n.value))
            || has_step_at(values[0], tf.color_nodes().iter().map(|n| n.value));
        let extent = nodes[nodes.len() - 1] - nodes[0];
        let before = if begins_with_step { extent * BEFORE_STEP } else { 0.0 };
        let lo = (min - widened).max(nodes[0] - before);
        let hi = (max + widened).min(nodes[nodes.len() - 1]);
        let (lo, hi) = if lo < hi { (lo, hi) } else { (min, max.max(min + min.abs() * 1e-6 + 1e-6)) };
        let narrowest = nodes
            .windows(2)
            .filter(|pair| pair[1] > lo && pair[0] < hi && pair[1] > pair[0])
            .fold(hi - lo, |narrowest, pair| narrowest.min(pair[1] - pair[0]));
        let entries = (ENTRIES_PER_SEGMENT * (hi - lo) / narrowest).ceil();
        let n = (entries.min(MAX_ENTRIES as f64) as usize).max(MIN_ENTRIES);
        let step = (hi - lo) / n as f64;
        // The ends are the outer nodes themselves: a value that rounding puts beside one would make all beyond it
        // visible.
        let value_at = |end: f64, node: usize| if end == nodes[node] { values[node] } else { end / scale + offset };
        let (first_value, last_value) = (value_at(lo, 0), value_at(hi, nodes.len() - 1));
        let mut rgba = tf.rgba_in_turn();
        // Curves are mostly level, and a logarithm takes longer than all the rest.
        let (mut opacity_before, mut depth) = (0.0, 0.0);
        let value = |i: usize| {
            let share = i as f64 / n as f64;
            first_value * (1.0 - share) + last_value * share
        };
        let entry = |i: usize| {
            let [r, g, b, opacity] = rgba(value(i));
            if opacity != opacity_before {
                (opacity_before, depth) = (opacity, (-(-opacity).ln_1p()).min(OPAQUE_DEPTH));
            }
            [r as f32, g as f32, b as f32, depth as f32]
        };
        // One entry more than cells, and one more so that the last cell has an upper end at its very end.
        let mut table: Vec<Entry> = (0..=n).chain([n]).map(entry).collect();
        // Data that stay at a lone node of opacity 1 are opaque, also where the node is between two entries.
        for around in tf.opacity_nodes().windows(3) {
            let [before, node, after] = [around[0], around[1], around[2]];
            let is_lone =
                before.opacity < 1.0 && node.opacity == 1.0 && after.opacity < 1.0 && node.value < after.value;
            let at = (density(node.value) - lo) / step;
            if is_lone && (0.0..=n as f64).contains(&at) {
                // Nothing below a step is visible.
                let at = if before.value == node.value { at.ceil() } else { at.round() };
                table[at as usize][3] = OPAQUE_DEPTH as f32;
            }
        }
        table[n + 1] = table[n];
        let opaque = Opaque { slab_thickness, largest_change: (max - min) / scale };
        let integral = DepthIntegral::new(tf.opacity_nodes(), opaque);
        let mut up_to = integral.in_turn();
        let integrals: Vec<f64> = (0..=n).chain([n]).map(|i| scale * up_to(value(i))).collect();
        // By exact integrals, so that nothing is too narrow to be seen.
        let mut seen: Vec<bool> = integrals.windows(2).map(|pair| pair[0] < pair[1]).collect();
        seen.push(false);
        let is_visible = |cell: usize| seen[cell] || table[cell][3] > 0.0 || table[cell + 1][3] > 0.0;
        let mut visible = vec![0];
        for i in 0..=n {
            for is_visible in [table[i][3] > 0.0, is_visible(i)] {
                visible.push(visible[visible.len() - 1] + u32::from(is_visible));
            }
        }
        let only_color = only_color((0..n).filter(|cell| is_visible(*cell)).map(|cell| &table[cell..cell + 2]));
        let opaque_ends = opaque_ends(tf.opacity_nodes(), density);
        let density = |i: usize| (lo + i.min(n) as f64 * step) as f32;
        let mut cells = (0..n).filter(|cell| is_visible(*cell));
        let first = cells.next();
        let visible_range = match (first, cells.next_back().or(first)) {
            (Some(first), Some(last)) => [
                if table[0][3] > 0.0 { f32::NEG_INFINITY } else { density(first) },
                if table[n][3] > 0.0 { f32::INFINITY } else { density(last + 1) },
            ],
            _ => [f32::INFINITY, f32::NEG_INFINITY],
        };
        let depth = |i: usize| {
            let depth = f64::from(table[i][3]);
            if depth < OPAQUE_DEPTH { depth } else { opaque.beyond() }
        };
        let segments = segment_table(&integrals, depth, &seen, density);
        let (lo, hi) = (lo as f32, hi as f32);
        let per_density = (1.0 / step) as f32;
        Self { table, segments, lo, hi, per_density, visible_range, opaque_ends, only_color, visible, range }
    }

    /// Total variation of a slab's associated colour and opacity from the least density to the greatest.
    /// `slab_thickness`: in `opacity_unit`s.
    pub fn variation(&self, slab_thickness: f64) -> f32 {
        let slab = |&[r, g, b, depth]: &Entry| {
            let opacity = -(-f64::from(depth) * slab_thickness).exp_m1() as f32;
            [r * opacity, g * opacity, b * opacity, opacity]
        };
        let mut before = slab(&self.table[0]);
        let mut variation = 0.0_f32;
        for pair in self.table.windows(2).filter(|pair| pair[0] != pair[1]) {
            let own = slab(&pair[1]);
            variation += (0..4).map(|c| (before[c] - own[c]).abs()).fold(0.0, f32::max);
            before = own;
        }
        variation
    }

    /// The tables as plain arrays.
    pub fn arrays(&self) -> TransferTables<'_> {
        TransferTables {
            colors: &self.table,
            segments: &self.segments,
            first: self.lo,
            last: self.hi,
            per_density: self.per_density,
            visible_range: self.visible_range,
            opaque_ends: self.opaque_ends,
            only_color: self.only_color,
        }
    }

    /// Densities beyond which nothing is visible.
    pub fn visible_range(&self) -> [f32; 2] {
        self.visible_range
    }

    /// Position in the table, `0..=n`.
    #[inline(always)]
    fn position(&self, density: f32) -> f32 {
        let last = (self.table.len() - 2) as f32;
        ((density - self.lo) * self.per_density).max(0.0).min(last)
    }

    /// Whether any density of the range has an opacity.
    pub fn any_opacity(&self, lo: f32, hi: f32) -> bool {
        // Entries are even places, and cells odd.
        let place = |density: f32| {
            let position = self.position(density);
            2 * position as usize + usize::from(position.fract() > 0.0)
        };
        self.visible[place(hi) + 1] > self.visible[place(lo)]
    }

    /// Colour and optical depth of one density.
    pub fn look_up_one(&self, density: f32) -> Entry {
        let position = self.position(density);
        let cell = position as u32 as usize;
        let t = position - cell as f32;
        let (a, b) = (&self.table[cell], &self.table[cell + 1]);
        [a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t, a[2] + (b[2] - a[2]) * t, a[3] + (b[3] - a[3]) * t]
    }

    /// Colour and optical depth of densities.
    #[inline(always)]
    pub fn look_up<S: Math>(&self, s: S, density: S::F) -> [S::F; 4] {
        s.look_up(&self.table, self.position_of(s, density))
    }

    /// Colour of densities; undefined where opacity is 0.
    #[inline(always)]
    pub fn color<S: Math>(&self, s: S, density: S::F) -> [S::F; 3] {
        if let Some(color) = self.only_color {
            return [s.splat(color[0]), s.splat(color[1]), s.splat(color[2])];
        }
        let [r, g, b, _] = self.look_up(s, density);
        [r, g, b]
    }

    #[inline(always)]
    pub(super) fn position_of<S: Math>(&self, s: S, density: S::F) -> S::F {
        s.mul(s.sub(density, s.splat(self.lo)), s.splat(self.per_density))
    }
}

/// Whether a curve, whose nodes are at `values`, has a step at a value.
fn has_step_at(value: f64, values: impl Iterator<Item = f64>) -> bool {
    values.filter(|other| *other == value).count() > 1
}

/// Densities up to which, and from which, the curve has opacity 1 to its end; infinite where that end is below 1.
fn opaque_ends(nodes: &[OpacityNode], density: impl Fn(f64) -> f64) -> [f32; 2] {
    let is_clear = |node: &OpacityNode| node.opacity < 1.0;
    let n_first = nodes.iter().position(is_clear).unwrap_or(nodes.len());
    let n_last = nodes.iter().rev().position(is_clear).unwrap_or(nodes.len());
    [
        if n_first == 0 { f32::NEG_INFINITY } else { density(nodes[n_first - 1].value) as f32 },
        if n_last == 0 { f32::INFINITY } else { density(nodes[nodes.len() - n_last].value) as f32 },
    ]
}

/// The colour that all entries have; `None` where they differ.
fn only_color<'a>(entries: impl Iterator<Item = &'a [Entry]>) -> Option<[f32; 3]> {
    let mut only = None;
    for &[r, g, b, _] in entries.flatten() {
        if *only.get_or_insert([r, g, b]) != [r, g, b] {
            return None;
        }
    }
    only
}

/// `1 − exp(−x)` for `x ≥ 0`, to about 1e-7 relative.
///
/// Split `x = n ln 2 + r`, `|r| ≤ ln 2 / 2`; then `exp(−x) − 1 = 2^−n (exp(−r) − 1) + (2^−n − 1)`, the bracket by its
/// Taylor series. Thin slabs have `n = 0`: only the series is left, and nothing cancels.
#[inline(always)]
pub fn one_minus_exp_neg<S: Math>(s: S, x: S::F) -> S::F {
    // ln 2 in two parts, so that n · high is exact.
    const LN2_HIGH: f32 = 0.693_359_4;
    const LN2_LOW: f32 = -2.121_944_4e-4;
    macro_rules! c {
        ($x:expr) => {
            s.splat($x)
        };
    }
    // From 80 on the result is 1 in f32, and n stays within the exponents that `exp2_neg` makes.
    let x = s.min(x, c!(80.0));
    let shifted = s.add(s.mul(x, c!(std::f32::consts::LOG2_E)), c!(ROUND));
    let n = s.sub(shifted, c!(ROUND));
    let y = s.sub(s.mul(n, c!(LN2_LOW)), s.sub(x, s.mul(n, c!(LN2_HIGH))));
    let series = s.add_mul(c!(1.0 / 720.0), y, c!(1.0 / 5040.0));
    let series = s.add_mul(c!(1.0 / 24.0), y, s.add_mul(c!(1.0 / 120.0), y, series));
    let series = s.add_mul(c!(0.5), y, s.add_mul(c!(1.0 / 6.0), y, series));
    let series = s.add_mul(y, s.mul(y, y), series);
    let power = s.exp2_neg(shifted);
    s.sub(s.sub(c!(1.0), power), s.mul(power, series))
}

#[cfg(test)]
mod tests {
    use super::*;
    use wavesplat_compute::simd::{LANES, Plain};
    use wavesplat_core::ColorNode;

    fn one_minus_exp_neg(x: f32) -> f32 {
        super::one_minus_exp_neg(Plain, [x; LANES])[0]
    }

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
            let [r, _, b, depth] = classifier.look_up_one(density);
            let opacity = 1.0 - f64::from(-depth).exp();
            assert!((opacity - tf.opacity(f64::from(density))).abs() < 4e-3, "{density}: {opacity}");
            let [want_r, _, want_b] = tf.color(f64::from(density));
            assert!((f64::from(r) - want_r).abs() < 1e-3 && (f64::from(b) - want_b).abs() < 1e-3, "{density}");
        }
    }

    /// Densities of wide types are scaled; rounding must not put the first entry above the node that it stands for.
    #[test]
    fn nothing_below_a_step_is_visible_whatever_the_range() {
        let opacity = [(37.0, 0.0), (38.0, 1.0)].map(|(value, opacity)| OpacityNode { value, opacity });
        let color = vec![ColorNode { value: 38.0, rgb: [1.0, 0.9, 0.8] }];
        let tf = TransferFunction::new(opacity.to_vec(), color, None).unwrap();
        for i in 0..500 {
            let (min, max) = (-3.0 - f64::from(i) * 0.0137, 150.0 + f64::from(i) * 0.73);
            let map = (min, 1.0 / (max - min));
            let classifier = Classifier::new(&tf, map, [0.0, 1.0], 1.0);
            let density = |value: f64| ((value - map.0) * map.1) as f32;
            assert!(!classifier.any_opacity(0.0, density(36.9)), "{min} {max}");
            assert!(classifier.any_opacity(density(37.2), 1.0));
        }
    }

    #[test]
    fn opacity_1_is_opaque_at_any_thickness() {
        let (_, classifier) = classifier(&[(99.0, 0.0), (100.0, 1.0)], [0.0, 255.0]);
        for density in [100.0, 100.5, 255.0, 1e9] {
            assert_eq!(one_minus_exp_neg(classifier.look_up_one(density)[3] * 1e-6), 1.0, "{density}");
        }
        assert_eq!(classifier.look_up_one(99.0)[3], 0.0);
        assert!(!classifier.any_opacity(-10.0, 98.9) && classifier.any_opacity(98.0, 99.5));
        assert!(!classifier.any_opacity(-10.0, -5.0) && !classifier.any_opacity(99.0, 99.0));
    }

    #[test]
    fn nothing_is_visible_before_a_step_at_the_first_node() {
        let shell = [(40.0, 0.0), (40.0, 0.6), (60.0, 0.6), (60.0, 0.0)];
        let opacity = shell.map(|(value, opacity)| OpacityNode { value, opacity });
        let color = [(40.0, [1.0, 0.0, 0.0]), (40.0, [0.0, 1.0, 0.0]), (50.0, [0.0, 0.0, 1.0])];
        let color = color.map(|(value, rgb)| ColorNode { value, rgb });
        let tf = TransferFunction::new(opacity.to_vec(), color.to_vec(), None).unwrap();
        let classifier = Classifier::new(&tf, (0.0, 1.0), [0.0, 100.0], 0.5);
        assert_eq!(classifier.look_up_one(39.9), [1.0, 0.0, 0.0, 0.0]);
        assert!(classifier.look_up_one(40.1)[1] > 0.9 && classifier.look_up_one(40.1)[3] > 0.9);
        assert!(!classifier.any_opacity(0.0, 39.9) && !classifier.any_opacity(60.1, 100.0));
        assert!(classifier.visible_range()[0] > 39.0 && classifier.visible_range()[1] < 61.0);
        let passage = classifier.preintegrate(Plain, [0.0; LANES], [100.0; LANES]);
        let mean: f32 = passage.depths.iter().map(|depth| depth[0]).sum();
        assert!((mean + 0.2 * 0.4_f32.ln()).abs() < 1e-4, "{mean}");
    }

    /// Two thousandths of an entry of the largest table wide.
    #[test]
    fn what_is_thinner_than_an_entry_is_seen_and_weighs_what_it_is_wide() {
        for top in [0.1, 1.0] {
            let nodes =
                [(0.0, 0.0), (100.000_3, 0.0), (100.000_303, top), (100.000_306, 0.0), (200.0, 0.0), (255.0, 0.1)];
            let (_, classifier) = classifier(&nodes, [0.0, 255.0]);
            assert!(classifier.table.len() == MAX_ENTRIES + 2 && classifier.any_opacity(100.0, 100.01));
            assert!(!classifier.any_opacity(0.0, 99.9) && !classifier.any_opacity(100.1, 199.9));
            let passage = classifier.preintegrate(Plain, [99.0; LANES], [101.0; LANES]);
            let weight: f32 = passage.depths.iter().map(|depth| 2.0 * depth[0]).sum();
            let mean = if top == 1.0 { 1.0 } else { 1.0 + (1.0 - top) * (-top).ln_1p() / top };
            assert!((f64::from(weight) / (6e-6 * mean) - 1.0).abs() < 0.02, "{top}: {weight}");
            assert!((passage.first[0] - 0.5).abs() < 0.01 && (passage.last[0] - 0.5).abs() < 0.01);
        }
    }

    /// A passage is the mean of many look-ups, and begins and ends where they see something.
    #[test]
    fn a_passage_is_the_mean_of_its_densities() {
        for nodes in [
            &[(20.0, 0.0), (60.0, 0.3), (61.0, 0.9), (180.0, 0.1)][..],
            &[(99.0, 0.0), (100.0, 0.5), (120.0, 0.5), (121.0, 0.0), (200.0, 0.0), (220.0, 0.7)],
            &[(100.0, 0.4)],
        ] {
            let (_, classifier) = classifier(nodes, [0.0, 255.0]);
            for (from, to) in
                [(0.0, 255.0), (255.0, 0.0), (90.0, 110.0), (118.0, 260.0), (-60.0, 130.0), (50.0, 50.001)]
            {
                let passage = classifier.preintegrate(Plain, [from; LANES], [to; LANES]);
                let n = 100_000;
                let at = |k: usize| from + (to - from) * (k as f32 + 0.5) / n as f32;
                let depths: Vec<f32> = (0..n).map(|k| classifier.look_up_one(at(k))[3]).collect();
                let mean = depths.iter().map(|d| f64::from(*d)).sum::<f64>() / n as f64;
                let depth: f32 = passage.depths.iter().map(|d| d[0]).sum();
                assert!(
                    (f64::from(depth) - mean).abs() < 2e-3 * (1.0 + mean),
                    "{nodes:?} {from} {to}: {depth}, {mean}"
                );
                if let (Some(first), Some(last)) =
                    (depths.iter().position(|d| *d > 0.0), depths.iter().rposition(|d| *d > 0.0))
                {
                    // To a table entry.
                    assert!((passage.first[0] - first as f32 / n as f32).abs() < 0.01, "{nodes:?} {from} {to}");
                    assert!((passage.last[0] - last as f32 / n as f32).abs() < 0.01, "{nodes:?} {from} {to}");
                }
            }
        }
    }

    #[test]
    fn curves_that_miss_the_data_are_constant() {
        for (node, expected) in [(-500.0, 0.7), (500.0, 0.7)] {
            let opacity = vec![OpacityNode { value: node, opacity: 0.7 }];
            let tf = TransferFunction::new(opacity, vec![ColorNode { value: node, rgb: [0.2; 3] }], None).unwrap();
            let classifier = Classifier::new(&tf, (0.0, 1.0), [7.0, 7.0], 1.0);
            let depth = classifier.look_up_one(7.0)[3];
            assert!((1.0 - (-depth).exp() - expected as f32).abs() < 1e-6);
            assert!(classifier.any_opacity(7.0, 7.0));
        }
    }
}
