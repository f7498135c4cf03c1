//! Pre-integration: opacity and colour of a ray segment between two densities, by integrals of one dimension.
//!
//! Between two sheets the density is taken as linear, so all that a ray meets there lies between two densities: the
//! mean optical depth is a difference of the integral `T(d) = ∫ τ`, divided by the difference of the densities (the
//! integral form of pre-integration; Engel, Kraus, Ertl 2001). Tables of one dimension are built in the time that it
//! takes to read them.

use crate::optics::classify::{Classifier, Entry, one_minus_exp_neg};
use wavesplat_compute::simd::{Math, Wide};

impl Classifier {
    /// Distance of densities below the table (at most 0) and above it (at least 0).
    #[inline(always)]
    fn beyond<S: Math>(&self, s: S, density: S::F) -> [S::F; 2] {
        let zero = s.splat(0.0);
        [s.min(s.sub(density, s.splat(self.lo)), zero), s.max(s.sub(density, s.splat(self.hi)), zero)]
    }

    /// Integral of the optical depth up to a density, and the nearest visible densities above and below it.
    #[inline(always)]
    fn integral<S: Math>(&self, s: S, density: S::F) -> [S::F; 3] {
        let [integral, above, below, _] = s.look_up(&self.segments, self.position_of(s, density));
        // Beyond the table the optical depth is constant.
        let [depth_lo, depth_hi] = [self.segments[0][3], self.segments[self.segments.len() - 1][3]];
        let [under, over] = self.beyond(s, density);
        let integral = s.add_mul(s.add_mul(integral, under, s.splat(depth_lo)), over, s.splat(depth_hi));
        let above = if depth_lo > 0.0 { s.add(above, under) } else { above };
        let below = if depth_hi > 0.0 { s.add(below, over) } else { below };
        [integral, above, below]
    }

    /// Visible part and optical depths of a segment, on which the density is linear between two densities.
    #[inline(always)]
    pub fn preintegrate<S: Wide>(&self, s: S, from: S::F, to: S::F) -> SegmentOpacity<S> {
        let [integral_from, above_from, below_from] = self.integral(s, from);
        let [integral_to, above_to, below_to] = self.integral(s, to);
        let change = s.sub(to, from);
        let rises = s.lt(s.splat(0.0), change);
        let inverse = s.div(s.splat(1.0), change);
        // A linear density meets every value between its ends once and none beyond them: where it rises, what is met
        // first is the lowest visible density above the start.
        // The first and last visible densities: the nearest ones inwards from both ends.
        let first = s.select(rises, above_from, below_from);
        let last = s.select(rises, below_to, above_to);
        let (zero, one) = (s.splat(0.0), s.splat(1.0));
        let first = s.min(s.max(s.mul(s.sub(first, from), inverse), zero), one);
        let last = s.min(s.max(s.mul(s.sub(last, from), inverse), zero), one);
        // Where densities are nearly equal, a difference of integrals is mostly rounding: the optical depth in the
        // middle.
        let is_level = s.lt(s.abs(change), s.splat(LEVEL / self.per_density));
        let level = if s.all_bits(is_level) == [0; 2] {
            zero
        } else {
            let [_, _, _, level] = self.look_up(s, s.mul(s.add(from, to), s.splat(0.5)));
            s.mul(level, s.splat(0.5))
        };
        let first = s.select(is_level, zero, first);
        let last = s.select(is_level, one, last);
        let split = s.select(is_level, s.splat(0.5), self.split(s, [from, inverse], [first, last]));
        let at = s.mul(s.add_mul(first, split, s.sub(last, first)), change);
        let [middle, _, _] = self.integral(s, s.add(from, at));
        // The density runs evenly along the segment, so the mean of τ over a part is its mean over the densities there:
        // the difference of `T = ∫ τ` between the ends, over the difference of the densities. T never falls, so a
        // negative difference is rounding.
        let near = s.max(s.mul(s.sub(middle, integral_from), inverse), zero);
        let far = s.max(s.mul(s.sub(integral_to, middle), inverse), zero);
        let depths = [s.select(is_level, level, near), s.select(is_level, level, far)];
        SegmentOpacity { first, last, split, depths }
    }

    /// Segments that enter or leave the densities that are opaque up to an end of the curve; `None` if none does.
    #[inline(always)]
    pub fn meets_opaque_end<S: Wide>(&self, s: S, from: S::F, to: S::F) -> Option<S::M> {
        let [lo, hi] = [s.min(from, to), s.max(from, to)];
        let [below, above] = [s.splat(self.opaque_ends[0]), s.splat(self.opaque_ends[1])];
        let meets = s.or(s.and(s.lt(lo, below), s.lt(below, hi)), s.and(s.lt(lo, above), s.lt(above, hi)));
        if s.all_bits(meets) == [0; 2] { None } else { Some(meets) }
    }

    /// Share of the visible part where its two parts meet: its middle, or where it enters or leaves the densities that
    /// are opaque up to an end of the curve. Light comes from the front of the opaque densities; averaged with the thin
    /// ones before them, it would seem to come from further in front.
    #[inline(always)]
    fn split<S: Wide>(&self, s: S, [from, inverse]: [S::F; 2], [first, last]: [S::F; 2]) -> S::F {
        let mut split = s.splat(0.5);
        let [zero, one] = [s.splat(0.0), s.splat(1.0)];
        for end in self.opaque_ends {
            if end.is_finite() {
                let at = s.mul(s.sub(s.splat(end), from), inverse);
                let share = s.div(s.sub(at, first), s.sub(last, first));
                let is_inside = s.and(s.lt(zero, share), s.lt(share, one));
                split = s.select(is_inside, share, split);
            }
        }
        split
    }

    /// Visible part of a segment, as [`Classifier::preintegrate`], and optical depths of parts of it. `cuts`: rising
    /// fractions of the segment, between which the parts lie.
    #[inline(always)]
    pub fn preintegrate_parts<S: Wide>(&self, s: S, from: S::F, to: S::F, cuts: [S::F; N_CUTS]) -> PartOpacities<S> {
        let change = s.sub(to, from);
        let inverse = s.div(s.splat(1.0), change);
        let rises = s.lt(s.splat(0.0), change);
        let begin = s.add_mul(from, cuts[0], change);
        let end = s.add_mul(from, cuts[N_CUTS - 1], change);
        let [mut before, above_begin, below_begin] = self.integral(s, begin);
        let [_, above_end, below_end] = self.integral(s, end);
        let share = |density: S::F| {
            let at = s.mul(s.sub(density, from), inverse);
            s.min(s.max(at, cuts[0]), cuts[N_CUTS - 1])
        };
        let first = share(s.select(rises, above_begin, below_begin));
        let last = share(s.select(rises, below_end, above_end));
        let is_level = s.lt(s.abs(change), s.splat(LEVEL * N_CUTS as f32 / self.per_density));
        let [_, _, _, level] = self.look_up(s, s.mul(s.add(from, to), s.splat(0.5)));
        let mut depths = [level; N_CUTS - 1];
        for k in 0..N_CUTS - 1 {
            let [integral, _, _] = self.integral(s, s.add_mul(from, cuts[k + 1], change));
            let steep = s.max(s.mul(s.sub(integral, before), inverse), s.splat(0.0));
            depths[k] = s.select(is_level, s.mul(level, s.sub(cuts[k + 1], cuts[k])), steep);
            before = integral;
        }
        PartOpacities {
            first: s.select(is_level, cuts[0], first),
            last: s.select(is_level, cuts[N_CUTS - 1], last),
            depths,
        }
    }
}

/// Number of ends of the parts of a slab of several layers: matter in one part hides matter in the next.
pub const N_CUTS: usize = 3;

/// Visible part of a segment between two densities, and optical depths of parts of it.
pub struct PartOpacities<S: Math> {
    /// Share of the way where the first visible density is met.
    pub first: S::F,
    /// Share of the way where the last visible density is left.
    pub last: S::F,
    /// Optical depth per `opacity_unit` of the whole way's length, of each part.
    pub depths: [S::F; N_CUTS - 1],
}

/// Difference of densities, in table entries, below which a difference of integrals is mostly rounding.
pub const LEVEL: f32 = 0.25;

/// Visible part of a segment between two densities, and its optical depths.
pub struct SegmentOpacity<S: Math> {
    /// Share of the way where the first visible density is met.
    pub first: S::F,
    /// Share of the way where the last visible density is left.
    pub last: S::F,
    /// Share of the visible part where its two parts meet, which show where its light comes from.
    pub split: S::F,
    /// Optical depth per `opacity_unit` of the whole way's length, of each of the two parts.
    pub depths: [S::F; 2],
}

impl<S: Math> SegmentOpacity<S> {
    /// Opacity of the visible part, and the mean place that its light comes from, as a share of it. `depths`: optical
    /// depths of its two parts.
    ///
    /// In a part of even extinction and depth τ that place is `1/τ − 1/(e^τ − 1)` of its length, which `1 / (2 + ¾ τ)`
    /// approximates to 0.06: the middle of a thin part, the front of an opaque one.
    #[inline(always)]
    pub fn light(&self, s: S, depths: [S::F; 2]) -> [S::F; 2] {
        let (zero, one) = (s.splat(0.0), s.splat(1.0));
        let parts = [[zero, self.split], [self.split, s.sub(one, self.split)]];
        let [mut alpha, mut moment] = [zero; 2];
        for (depth, [start, long]) in depths.into_iter().zip(parts) {
            let share = s.mul(s.sub(one, alpha), one_minus_exp_neg(s, depth));
            let mean = s.div(one, s.add_mul(s.splat(2.0), s.splat(0.75), depth));
            moment = s.add_mul(moment, share, s.add_mul(start, mean, long));
            alpha = s.add(alpha, share);
        }
        [alpha, s.select(s.lt(zero, alpha), s.div(moment, alpha), s.splat(0.5))]
    }
}

/// Table of `(∫ τ, nearest visible density above, nearest below, τ)`. `integrals`: ∫ τ up to each entry; `seen`:
/// whether each cell, from its entry to the next, has anything visible.
pub(super) fn segment_table(
    integrals: &[f64],
    depths: impl Fn(usize) -> f64,
    seen: &[bool],
    density: impl Fn(usize) -> f32,
) -> Vec<Entry> {
    let n = integrals.len();
    let mut segments: Vec<Entry> = Vec::with_capacity(n);
    let mut below = density(0);
    for i in 0..n {
        let depth = depths(i);
        below = if depth > 0.0 || (i > 0 && seen[i - 1]) { density(i) } else { below };
        segments.push([integrals[i] as f32, 0.0, below, depth as f32]);
    }
    let mut above = density(n - 1);
    for i in (0..n).rev() {
        above = if seen[i] || segments[i][3] > 0.0 { density(i) } else { above };
        segments[i][1] = above;
    }
    segments
}
