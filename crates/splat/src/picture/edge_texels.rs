//! Texels around a read of a pixel with an edge ([`crate::picture::edges`]): what their rays met, how far these ran,
//! and their mean as if all had run as far as the read's.

use wavesplat_compute::simd::{LANES, Simd};

use crate::optics::classify::one_minus_exp_neg;
use crate::picture::base_picture::BasePicture;
use crate::picture::edges::Scaling;
use crate::view::silhouette::{LENGTH_TOLERANCE, PlaneSilhouette, RayHits};

/// Smallest length of a texel's ray, relative to the read's, with which the texel contributes.
const MIN_LENGTH_RATIO: f64 = 0.1;

/// Smallest length of a texel's ray, in slices, with which the texel contributes.
const MIN_LENGTH_SLICES: f64 = 0.02;

/// The sixteen texels around a position.
#[derive(Default)]
pub(super) struct Taps {
    rgba: [[f32; 4]; LANES],
    pub(super) weight: [f32; LANES],
    /// Whether the texel contributes to the read.
    is_used: [bool; LANES],
    /// Whether its ray meets the same regions as the read's.
    meets_same_regions: [bool; LANES],
    /// Whether its ray meets any region.
    is_met: [bool; LANES],
    /// For opacity, the optical depth along a ray as long as the read's; for sums, the ratio of lengths.
    depth: [f32; LANES],
    /// Whether its ray's length differs from the read's.
    is_other: [bool; LANES],
    /// Whether its ray may have stopped on the way.
    is_opaque: [bool; LANES],
}

/// The four of sixteen texels that are nearest to the position.
const MIDDLE: [usize; 4] = [5, 6, 9, 10];

/// Smallest sum of weights that is normalised to a mean.
const MIN_WEIGHT: f32 = 0.4;

impl Taps {
    #[inline(always)]
    pub(super) fn set(&mut self, k: usize, strip: &Strip, lane: usize, met: &RayHits, scaling: Scaling) {
        let length = strip.length[lane];
        let is_scaled = scaling != Scaling::None;
        self.rgba[k] = strip.rgba[lane];
        self.meets_same_regions[k] = strip.met[lane] == met.regions;
        self.is_met[k] = strip.met[lane] != 0;
        let is_long = length > MIN_LENGTH_SLICES && length >= MIN_LENGTH_RATIO * met.length;
        self.is_used[k] = self.meets_same_regions[k] && (is_long || !is_scaled);
        self.is_other[k] = is_scaled && (length - met.length).abs() > LENGTH_TOLERANCE * met.length;
        self.depth[k] = match scaling {
            Scaling::Opacity => strip.depth[lane] * met.length as f32,
            Scaling::Sum => (met.length / length) as f32,
            Scaling::None => 1.0,
        };
        self.is_opaque[k] = strip.is_opaque[lane];
    }

    /// The weighted mean, clamped to the nearest texels, no colour brighter than its opacity allows.
    #[inline(always)]
    pub(super) fn mean<S: Simd>(mut self, s: S, scaling: Scaling, t: [f32; 2], peak: f32) -> [f32; 4] {
        if self.is_used == [false; LANES] {
            self.is_used = self.meets_same_regions;
        }
        // Where boxes of layers overlap in less than a texel, no texel meets the same regions: any that meets a region
        // will do.
        if self.is_used == [false; LANES] {
            self.is_used = self.is_met;
        }
        self.scale(s, scaling);
        // Written as selections, so that it becomes vectors.
        let weight: [f32; LANES] = std::array::from_fn(|k| if self.is_used[k] { self.weight[k] } else { 0.0 });
        let total: f32 = weight.iter().sum();
        if total < MIN_WEIGHT {
            return self.nearest(t);
        }
        let mut mean = [0.0; 4];
        for k in 0..LANES {
            let weight = weight[k] / total;
            for c in 0..4 {
                mean[c] += weight * self.rgba[k][c];
            }
        }
        let has_middle = MIDDLE.iter().any(|k| self.is_used[*k]);
        let (mut least, mut most) = ([f32::INFINITY; 4], [f32::NEG_INFINITY; 4]);
        for k in (0..LANES).filter(|k| self.is_used[*k] && (!has_middle || MIDDLE.contains(k))) {
            for c in 0..4 {
                least[c] = least[c].min(self.rgba[k][c]);
                most[c] = most[c].max(self.rgba[k][c]);
            }
        }
        for c in 0..4 {
            mean[c] = mean[c].max(least[c]).min(most[c]);
        }
        mean[3] = mean[3].min(1.0);
        for c in 0..3 {
            mean[c] = mean[c].min(peak * mean[3]);
        }
        mean
    }

    /// The nearest texel that is used, where the weights do not suffice for a mean.
    #[inline(never)]
    fn nearest(&self, t: [f32; 2]) -> [f32; 4] {
        let distance = |k: &usize| {
            let [u, v] = [k % 4, k / 4].map(|place| place as f32 - 1.0);
            (u - t[0]).powi(2) + (v - t[1]).powi(2)
        };
        let used = (0..LANES).filter(|k| self.is_used[*k]);
        used.min_by(|a, b| distance(a).total_cmp(&distance(b))).map_or([0.0; 4], |k| self.rgba[k])
    }

    /// Opaque texels give only a lower bound of the extinction: the largest that is known nearby is taken, or the
    /// largest of all where none is.
    #[inline(always)]
    fn estimate_opaque(&mut self) {
        if self.is_opaque == [false; LANES] {
            return;
        }
        let mut densest = 0.0;
        for k in 0..LANES {
            if self.is_used[k] && !self.is_opaque[k] && self.rgba[k][3] > MIN_RELIABLE_OPACITY {
                densest = self.depth[k].max(densest);
            }
        }
        for k in 0..LANES {
            if self.is_opaque[k] {
                self.depth[k] = if densest > 0.0 { self.depth[k].max(densest) } else { MAX_DEPTH };
            }
        }
    }

    /// Rescales the texels to the length of the read's ray.
    #[inline(always)]
    fn scale<S: Simd>(&mut self, s: S, scaling: Scaling) {
        if self.is_other == [false; LANES] {
            return;
        }
        match scaling {
            Scaling::None => {}
            Scaling::Sum => {
                for k in 0..LANES {
                    let factor = if self.is_other[k] { self.depth[k] } else { 1.0 };
                    (0..2).for_each(|c| self.rgba[k][c] *= factor);
                }
            }
            Scaling::Opacity => {
                self.estimate_opaque();
                let mut opacity = [0.0; LANES];
                s.store(one_minus_exp_neg(s, s.load(&self.depth)), &mut opacity);
                for k in 0..LANES {
                    let is_scaled = self.is_other[k] && self.rgba[k][3] > 0.0;
                    let factor = if is_scaled { opacity[k] / self.rgba[k][3] } else { 1.0 };
                    self.rgba[k] = self.rgba[k].map(|c| c * factor);
                }
            }
        }
    }
}

/// Sixteen texels of a row, and the rays that drew them.
pub(super) struct Strip {
    rgba: [[f32; 4]; LANES],
    met: [u8; LANES],
    length: [f64; LANES],
    /// Regions and length of all sixteen rays, where they agree.
    pub(super) level: Option<RayHits>,
    /// Optical depth per slice.
    depth: [f32; LANES],
    /// Whether the optical depth is only a lower bound.
    is_opaque: [bool; LANES],
}

/// Smallest opacity of a ray that may have stopped on the way.
const OPAQUE: f32 = 1.0 - 2e-4;

/// Smallest opacity from which extinction is estimated.
const MIN_RELIABLE_OPACITY: f32 = 0.3;

/// Optical depth of a texel that is wholly opaque.
const MAX_DEPTH: f32 = 1e6;

impl Strip {
    /// The strip with a number along u, in row `j` of the base plane.
    pub(super) fn new(plane: &PlaneSilhouette, picture: &BasePicture, scaling: Scaling, [strip, j]: [i64; 2]) -> Self {
        let i = strip * LANES as i64;
        let (mut met, length) = plane.rendered(i as f64, j as f64);
        let (mut rgba, mut depth, mut is_opaque) = ([[0.0; 4]; LANES], [0.0; LANES], [false; LANES]);
        let [n_u, n_v] = picture.plane.size;
        let row = usize::try_from(j).ok().filter(|j| *j < n_v).map(|j| picture.row(j));
        for lane in 0..LANES {
            let texel = usize::try_from(i + lane as i64).ok().filter(|i| *i < n_u);
            match row.zip(texel) {
                Some((row, i)) => rgba[lane] = row[i],
                None => met[lane] = 0,
            }
            if scaling == Scaling::Opacity && rgba[lane][3] > 0.0 && met[lane] != 0 {
                let opacity = rgba[lane][3];
                is_opaque[lane] = opacity >= OPAQUE;
                depth[lane] = (optical_depth(opacity.min(OPAQUE)) / length[lane].max(f64::MIN_POSITIVE)) as f32;
            }
        }
        let first = RayHits { regions: met[0], length: length[0] };
        let is_uniform = (1..LANES).all(|k| first.is_like(&RayHits { regions: met[k], length: length[k] }));
        Self { rgba, met, length, level: is_uniform.then_some(first), depth, is_opaque }
    }
}

/// Optical depth `−ln(1 − opacity)`, by the series of the inverse hyperbolic tangent: with sums and products alone, so
/// that every processor gives the same bits.
fn optical_depth(opacity: f32) -> f64 {
    let rest = 1.0 - f64::from(opacity.max(0.0));
    // rest = m · 2^e with m from √½ to √2, ln m = 2 artanh((m − 1) / (m + 1)).
    let bits = rest.to_bits();
    let (mut exponent, mut m) = ((bits >> 52) as i32 - 1023, f64::from_bits(bits & ((1 << 52) - 1) | 1023 << 52));
    if m > std::f64::consts::SQRT_2 {
        (exponent, m) = (exponent + 1, 0.5 * m);
    }
    let s = (m - 1.0) / (m + 1.0);
    let square = s * s;
    let series = (0..8).rev().fold(0.0, |sum, k| 1.0 / f64::from(2 * k + 1) + square * sum);
    -(2.0 * s * series + f64::from(exponent) * std::f64::consts::LN_2)
}

/// Direct-mapped cache of strips, by base plane and place.
#[derive(Default)]
pub(super) struct Strips(Vec<Option<([i64; 3], Strip)>>);

/// Cache entries along u and v, powers of two.
const N_PLACES: [i64; 2] = [4, 16];

impl Strips {
    /// Returns the cached strip of a base plane at a place, or makes it.
    #[inline(always)]
    pub(super) fn get(&mut self, plane: usize, [strip, j]: [i64; 2], make: impl FnOnce() -> Strip) -> &Strip {
        let n = (N_PLACES[0] * N_PLACES[1]) as usize;
        if self.0.is_empty() {
            self.0.resize_with(n, || None);
        }
        let place = (j.rem_euclid(N_PLACES[1]) * N_PLACES[0] + strip.rem_euclid(N_PLACES[0])) as usize;
        let key = [plane as i64, strip, j];
        let entry = &mut self.0[place];
        if entry.as_ref().is_none_or(|(of, _)| *of != key) {
            *entry = None;
        }
        &entry.get_or_insert_with(|| (key, make())).1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_optical_depth_is_that_of_the_opacity() {
        for opacity in [0.0, 1e-6, 1e-3, 0.1, 0.29, 0.3, 0.5, 0.7, 0.9, 0.99, 0.9995, OPAQUE] {
            let (got, want) = (optical_depth(opacity), -(-f64::from(opacity)).ln_1p());
            assert!((got - want).abs() <= 1e-9 * want + 1e-15, "{opacity}: {got} for {want}");
        }
    }
}
