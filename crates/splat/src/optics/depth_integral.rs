//! The exact integral of the optical depth over sample values, `T(v) = ∫ −ln(1 − a)`, for opacity curves `a` that are
//! linear between nodes.
//!
//! A table that adds up entries misses peaks narrower than an entry, and one entry on a node of opacity 1, where the
//! logarithm is infinite, counts for the whole space to its neighbours. The integral has a closed form instead: with
//! `u = 1 − a`, `∫ −ln u du = u − u ln u`, which is finite down to `u = 0`. So a peak that touches opacity 1 at one
//! value weighs hardly more than one of 0.999. A range of values of opacity 1 is opaque however fast rays pass it: its
//! integral is finite, but large enough for that (`Opaque`).

use wavesplat_core::OpacityNode;

/// Relative change of `1 − a` below which the closed form is mostly rounding, and Simpson's rule as good as exact.
const NEARLY_EVEN: f64 = 1e-3;

/// Optical depth that counts as opaque.
const OPAQUE_SLAB: f64 = 32.0;

/// Finite stand-in for the infinite optical depth of opacity 1. It is no larger than it must be: the sums of all
/// densities above it lose as much precision.
#[derive(Clone, Copy, Debug)]
pub(super) struct Opaque {
    /// Thickness of a typical slab, in `opacity_unit`s.
    pub slab_thickness: f64,
    /// Largest change of the value within a slab.
    pub largest_change: f64,
}

impl Opaque {
    /// Optical depth per `opacity_unit` beyond an outer node of opacity 1.
    pub fn beyond(&self) -> f64 {
        OPAQUE_SLAB / self.slab_thickness
    }

    /// Optical depth per `opacity_unit` in a range of values of opacity 1 that is `width` wide: the narrower, the
    /// larger, so that a slab that passes all of the range is opaque.
    fn within(&self, width: f64) -> f64 {
        OPAQUE_SLAB / self.slab_thickness * (0.5 * self.largest_change / width).max(1.0)
    }
}

/// The integral up to each node, and the optical depths that continue it from there.
pub(super) struct DepthIntegral<'a> {
    nodes: &'a [OpacityNode],
    /// Integral from the first node to each.
    sums: Vec<f64>,
    /// Optical depth between each node and the next; `None` where it changes.
    levels: Vec<Option<f64>>,
    opaque: Opaque,
}

impl<'a> DepthIntegral<'a> {
    /// Integrates the curve of `nodes`: at least one, in order of value.
    pub fn new(nodes: &'a [OpacityNode], opaque: Opaque) -> Self {
        let last = nodes.len() - 1;
        let mut levels = Vec::with_capacity(last);
        for (k, pair) in nodes.windows(2).enumerate() {
            levels.push((pair[0].opacity == pair[1].opacity).then(|| {
                if pair[0].opacity < 1.0 { depth_of(pair[0].opacity) } else { range_depth(nodes, k, opaque) }
            }));
        }
        let mut integral = Self { nodes, sums: vec![0.0], levels, opaque };
        for k in 0..last {
            let next = integral.sums[k] + integral.within(k, nodes[k + 1].value);
            integral.sums.push(next);
        }
        // A range that is opaque below all others must not cost these their precision: sums count from behind it.
        let start = nodes.iter().position(|node| node.opacity < 1.0).map_or(0.0, |first| integral.sums[first]);
        integral.sums.iter_mut().for_each(|sum| *sum -= start);
        integral
    }

    /// Function that returns the integral up to a value, from where the curve is first below 1: fast where each value
    /// is near the one before.
    pub fn in_turn(&self) -> impl FnMut(f64) -> f64 {
        let mut n_below = 0;
        move |value| {
            while self.nodes.get(n_below).is_some_and(|node| node.value <= value) {
                n_below += 1;
            }
            while n_below > 0 && self.nodes[n_below - 1].value > value {
                n_below -= 1;
            }
            let last = self.nodes.len() - 1;
            match n_below {
                0 => self.sums[0] + (value - self.nodes[0].value) * self.level_of(self.nodes[0].opacity),
                n if n > last => {
                    self.sums[last] + (value - self.nodes[last].value) * self.level_of(self.nodes[last].opacity)
                }
                n => self.sums[n - 1] + self.within(n - 1, value),
            }
        }
    }

    /// Optical depth of an opacity that holds beyond an outer node.
    pub fn level_of(&self, opacity: f64) -> f64 {
        if opacity < 1.0 { depth_of(opacity) } else { self.opaque.beyond() }
    }

    /// The integral from node `k` to a value up to the next.
    fn within(&self, k: usize, value: f64) -> f64 {
        let (from, to) = (self.nodes[k], self.nodes[k + 1]);
        let width = value - from.value;
        if width <= 0.0 {
            return 0.0;
        }
        if let Some(level) = self.levels[k] {
            return level * width;
        }
        // `1 − a` is interpolated, not `a`: near a node of opacity 1 it may be less than the spacing of floats below 1,
        // and it must not round to 0 there, where `−ln u` is infinite.
        let share = (width / (to.value - from.value)).min(1.0);
        let [left_from, left_to] = [1.0 - from.opacity, 1.0 - to.opacity];
        width * mean_depth(left_from, left_from + (left_to - left_from) * share)
    }
}

/// Optical depth of an opacity below 1.
fn depth_of(opacity: f64) -> f64 {
    -(-opacity).ln_1p()
}

/// Mean of `−ln u` where `u = 1 − a` goes evenly from one value to another, not both 0.
fn mean_depth(from: f64, to: f64) -> f64 {
    if from.min(to) > 0.0 && (from - to).abs() <= NEARLY_EVEN * from.min(to) {
        return -(from.ln() + 4.0 * (0.5 * (from + to)).ln() + to.ln()) / 6.0;
    }
    let antiderivative = |u: f64| if u > 0.0 { u - u * u.ln() } else { 0.0 };
    (antiderivative(from) - antiderivative(to)) / (from - to)
}

/// Optical depth in the range of values of opacity 1 that holds the space after node `k`.
fn range_depth(nodes: &[OpacityNode], k: usize, opaque: Opaque) -> f64 {
    let first = nodes[..=k].iter().rposition(|node| node.opacity < 1.0).map_or(0, |below| below + 1);
    let after = nodes[k..].iter().position(|node| node.opacity < 1.0).map_or(nodes.len(), |n| k + n);
    let width = nodes[after - 1].value - nodes[first].value;
    if first == 0 || after == nodes.len() || width <= 0.0 {
        // The curve stays opaque beyond its outer nodes.
        return opaque.beyond();
    }
    opaque.within(width)
}

#[cfg(test)]
mod tests {
    use super::*;

    const OPAQUE: Opaque = Opaque { slab_thickness: 0.5, largest_change: 100.0 };

    fn nodes(curve: &[(f64, f64)]) -> Vec<OpacityNode> {
        curve.iter().map(|&(value, opacity)| OpacityNode { value, opacity }).collect()
    }

    /// The midpoint rule on very many values knows nothing of the closed form.
    #[test]
    fn it_is_the_sum_of_very_many_depths() {
        for curve in [
            &[(0.0, 0.0), (1.0, 0.3), (1.0, 0.8), (4.0, 0.1), (9.0, 0.1)][..],
            &[(2.0, 0.9), (2.5, 0.0), (7.0, 1e-5), (8.0, 0.999_999)],
            &[(3.0, 0.0), (5.0, 1.0), (7.0, 0.0)],
            &[(3.0, 0.5), (3.1, 0.500_01), (6.0, 0.2)],
        ] {
            let curve = nodes(curve);
            let integral = DepthIntegral::new(&curve, OPAQUE);
            let mut up_to = integral.in_turn();
            let opacity = |value: f64| {
                let after = curve.partition_point(|node| node.value <= value);
                let (a, b) = (curve[after.max(1) - 1], curve[after.min(curve.len() - 1)]);
                let share = if b.value > a.value { (value - a.value) / (b.value - a.value) } else { 0.0 };
                a.opacity + (b.opacity - a.opacity) * share
            };
            for (from, to) in [(0.0, 10.0), (2.9, 5.0), (4.5, 5.5), (4.999, 5.001), (-3.0, 1.5)] {
                const N: usize = 400_000;
                let step = (to - from) / N as f64;
                let want: f64 = (0..N).map(|i| step * -(-opacity(from + (i as f64 + 0.5) * step)).ln_1p()).sum();
                let got = up_to(to) - up_to(from);
                assert!((got - want).abs() < 1e-4 * want + 1e-9, "{curve:?} {from} {to}: {got} for {want}");
            }
        }
    }

    #[test]
    fn a_node_of_opacity_1_weighs_like_one_of_almost_1() {
        let peak = |top: f64| {
            let curve = nodes(&[(49.0, 0.0), (50.0, top), (51.0, 0.0)]);
            DepthIntegral::new(&curve, OPAQUE).in_turn()(60.0)
        };
        assert!((peak(1.0) - 2.0).abs() < 1e-12);
        assert!(peak(1.0) > peak(0.9999) && peak(1.0) < 1.002 * peak(0.9999), "{} {}", peak(1.0), peak(0.9999));
    }

    #[test]
    fn it_is_finite_where_a_value_is_as_near_to_a_node_of_1_as_it_can_be() {
        for at in [0.6, 1.0 / 3.0, 1e-3, 700.0, -1000.0] {
            let curve = nodes(&[(at - 0.5, 0.2), (at, 1.0), (at + 0.2, 0.9)]);
            let integral = DepthIntegral::new(&curve, OPAQUE);
            let mut up_to = integral.in_turn();
            let [before, on, after] = [at.next_down(), at, at.next_up()].map(&mut up_to);
            assert!(
                before.is_finite() && before <= on && on <= after && after - before < 1e-9,
                "{before} {on} {after}"
            );
        }
    }

    #[test]
    fn what_is_opaque_below_costs_no_precision_above() {
        let curve = nodes(&[(10.0, 1.0), (60.0, 1.0), (60.0, 0.2), (70.0, 0.2), (80.0, 1.0)]);
        let integral = DepthIntegral::new(&curve, OPAQUE);
        let mut up_to = integral.in_turn();
        assert_eq!(up_to(60.0), 0.0);
        assert!((up_to(70.0) + 10.0 * 0.8_f64.ln()).abs() < 1e-9);
        assert!(0.5 * (up_to(11.0) - up_to(10.0)) > 31.0 && 0.5 * (up_to(9.0) - up_to(8.0)) > 31.0);
        assert!(0.5 * (up_to(91.0) - up_to(90.0)) > 31.0);
    }

    #[test]
    fn a_range_of_opacity_1_is_opaque_however_fast_it_is_passed() {
        for width in [1e-6, 0.01, 1.0, 49.0] {
            let curve = nodes(&[(10.0, 0.0), (10.0, 1.0), (10.0 + width, 1.0), (10.0 + width, 0.0)]);
            let integral = DepthIntegral::new(&curve, OPAQUE);
            let mut up_to = integral.in_turn();
            let opacity_of_slab = 1.0 - (-0.5 * up_to(110.0) / 100.0).exp();
            assert!(up_to(9.9) == 0.0 && opacity_of_slab > 0.999_999, "{width}: {opacity_of_slab}");
            assert_eq!(up_to(70.0), up_to(90.0));
        }
    }
}
