//! Projections (MIP, minimum, mean, sum, X-ray): one number per ray from the densities along it.
//!
//! Densities are linear between two sheets, so extremes are looked for on the sheets and where rays enter and leave;
//! integrals of a slab are exact. Formulas and sources: [`Composite`].

use wavesplat_compute::simd::{LANES, Lanes, Simd};
use wavesplat_core::Composite;

use crate::ray::compositor::Slab;
use crate::ray::compositor::{Compositor, Ends, Texels};
use crate::ray::state::TileState;
use crate::sheet::tile_layout::Chunk;
use crate::sheet::tile_rays::Rays;
use crate::source::nonfinite::known_part;

/// The part of a slab that each ray of a chunk draws.
pub struct DrawnSegment {
    /// Densities where it begins.
    pub near: [f32; LANES],
    /// Densities where it ends.
    pub far: [f32; LANES],
    /// Its length, in the unit of the rays' thickness; 0 where nothing is drawn.
    pub length: [f32; LANES],
    /// Begin and end as fractions of the slab; only for volumes with missing samples.
    part: Option<[[f32; LANES]; 2]>,
}

impl DrawnSegment {
    /// Clips a slab to the intervals of a chunk's rays. Its densities must be ready.
    #[inline(always)]
    pub fn new<S: Simd>(s: S, chunk: Chunk, rays: &Rays, slab: &mut Slab) -> Self {
        let Ends { front, back, missing } = Ends::new(s, chunk, slab);
        let thickness = &rays.directions(chunk).thickness.0;
        let [s_front, s_back] = slab.s;
        let mut segment = Self { near: front, far: back, length: [0.0; LANES], part: None };
        // Most segments span the whole slab.
        if missing.is_none() && rays.all_draw(chunk, s_front, s_back) {
            for i in 0..LANES {
                segment.length[i] = (s_back - s_front) * thickness[i];
            }
            return segment;
        }
        let [lo, hi] = rays.lanes(chunk);
        let per_s = 1.0 / (s_back - s_front);
        for i in 0..LANES {
            let mut from = ((lo.0[i] - s_front) * per_s).max(0.0);
            let mut to = ((hi.0[i] - s_front) * per_s).min(1.0);
            if let Some([of_front, of_back]) = &missing {
                let [first, last] = known_part(of_front[i], of_back[i]);
                (from, to) = (from.max(first), to.min(last));
                let [starts, ends] = segment.part.get_or_insert_default();
                (starts[i], ends[i]) = (from, to);
            }
            let slope = back[i] - front[i];
            segment.near[i] = front[i] + from * slope;
            // Exactly the back sheet's density where the segment ends on it.
            segment.far[i] = if to == 1.0 { back[i] } else { front[i] + to * slope };
            segment.length[i] = if to > from { (to - from) * (s_back - s_front) * thickness[i] } else { 0.0 };
        }
        segment
    }
}

/// All projections but the local maximum ([`crate::ray::local_maximum`]).
pub struct Project {
    operator: Composite,
    /// Density towards which depth shading dims, or above which X-rays are absorbed.
    level: f32,
    value: Vec<Lanes>,
    length: Vec<Lanes>,
}

impl Project {
    /// Continues from `state`; `None`: nothing is drawn yet. `level`: see [`Project::level`].
    pub fn new(operator: Composite, level: f32, state: Option<TileState>) -> Self {
        let nothing = match operator {
            Composite::Maximum | Composite::DepthShadedMaximum { .. } => f32::NEG_INFINITY,
            Composite::Minimum => f32::INFINITY,
            _ => 0.0,
        };
        let state = state.unwrap_or_else(|| TileState {
            value: TileState::per_chunk(Lanes::splat(nothing)),
            length: TileState::per_chunk(Lanes::splat(0.0)),
            ..TileState::default()
        });
        Self { operator, level, value: state.value, length: state.length }
    }

    /// Density towards which an operator dims, or above which X-rays are absorbed. `density` maps sample values.
    pub fn level(operator: Composite, density: impl Fn(f64) -> f32) -> f32 {
        match operator {
            Composite::DepthShadedMaximum { black, .. } => density(black),
            Composite::XRay { clear, .. } => density(clear),
            _ => 0.0,
        }
    }
}

/// The density with its excess over a level scaled by `factor`.
#[inline(always)]
fn dimmed(density: f32, level: f32, factor: f32) -> f32 {
    if density > level { level + (density - level) * factor } else { density }
}

/// Mean of the positive part of a density that changes linearly; of a line through 0 the triangle above it counts.
#[inline(always)]
fn mean_above(near: f32, far: f32) -> f32 {
    let (lo, hi) = (near.min(far), near.max(far).max(0.0));
    if lo >= 0.0 { 0.5 * (near + far) } else { 0.5 * hi * hi / (hi - lo) }
}

impl Compositor for Project {
    #[inline(always)]
    fn is_done(&self, _: Chunk) -> bool {
        false
    }

    #[inline(always)]
    fn add_chunk<S: Simd>(&mut self, s: S, chunk: Chunk, rays: &Rays, slab: &mut Slab) {
        let segment = DrawnSegment::new(s, chunk, rays, slab);
        let (value, length) = (&mut self.value[chunk.index()].0, &mut self.length[chunk.index()].0);
        let DrawnSegment { near, far, length: extent, part } = &segment;
        let level = self.level;
        // One loop per operator, so that none of them branches inside.
        let mut new = *value;
        match self.operator {
            Composite::Maximum => {
                for i in 0..LANES {
                    new[i] = new[i].max(near[i].max(far[i]));
                }
            }
            Composite::Minimum => {
                for i in 0..LANES {
                    new[i] = new[i].min(near[i].min(far[i]));
                }
            }
            Composite::DepthShadedMaximum { .. } => {
                let ([at_zero, per_s], [lo, hi]) = (rays.fade(chunk), rays.lanes(chunk));
                for i in 0..LANES {
                    let [mut s_near, mut s_far] = [lo.0[i].max(slab.s[0]), hi.0[i].min(slab.s[1])];
                    if let Some([starts, ends]) = part {
                        let way = slab.s[1] - slab.s[0];
                        (s_near, s_far) = (slab.s[0] + starts[i] * way, slab.s[0] + ends[i] * way);
                    }
                    let near = dimmed(near[i], level, at_zero.0[i] + per_s.0[i] * s_near);
                    let far = dimmed(far[i], level, at_zero.0[i] + per_s.0[i] * s_far);
                    new[i] = new[i].max(near.max(far));
                }
            }
            Composite::XRay { .. } => {
                for i in 0..LANES {
                    new[i] += mean_above(near[i] - level, far[i] - level) * extent[i];
                }
            }
            _ => {
                for i in 0..LANES {
                    new[i] += 0.5 * (near[i] + far[i]) * extent[i];
                }
            }
        }
        for i in 0..LANES {
            value[i] = if extent[i] > 0.0 { new[i] } else { value[i] };
            length[i] += extent[i];
        }
    }

    fn finish(&self, chunk: Chunk) -> Texels {
        let rgba = std::array::from_fn(|i| {
            let (value, length) = (self.value[chunk.index()].0[i], self.length[chunk.index()].0[i]);
            if length <= 0.0 {
                return [0.0; 4];
            }
            let value = if self.operator == Composite::Mean { value / length } else { value };
            [value, length, 0.0, 1.0]
        });
        Texels { rgba, s_half: None }
    }

    fn into_state(self) -> TileState {
        TileState { value: self.value, length: self.length, ..TileState::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_positive_of_a_line_has_the_mean_of_its_integral() {
        for (near, far) in [(1.0, 3.0), (3.0, 1.0), (-1.0, 3.0), (3.0, -1.0), (-2.0, -1.0), (0.0, 0.0), (0.0, 2.0)] {
            let n = 20_000;
            let at = |k: i32| near + (far - near) * (f64::from(k) + 0.5) / f64::from(n);
            let want = (0..n).map(|k| at(k).max(0.0)).sum::<f64>() / f64::from(n);
            let got = f64::from(mean_above(near as f32, far as f32));
            assert!((got - want).abs() < 1e-6, "{near} to {far}: {got} for {want}");
        }
    }
}
