//! Projections (MIP, minimum, mean, sum, X-ray): one number per ray from the densities along it; of extremes also where
//! they are.
//!
//! Densities are linear between two sheets, so extremes are looked for on the sheets and where rays enter and leave;
//! integrals of a slab are exact. Formulas and sources: [`Composite`].

use wavesplat_compute::simd::{LANES, Lanes, Simd};
use wavesplat_core::Composite;

use crate::optics::classify::one_minus_exp_neg;
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

    /// Positions where the segments begin and end. `s`: front and back of the slab.
    #[inline(always)]
    pub fn places(&self, chunk: Chunk, rays: &Rays, [s_front, s_back]: [f32; 2]) -> [[f32; LANES]; 2] {
        let mut places = [[0.0; LANES]; 2];
        if let Some([starts, ends]) = &self.part {
            let way = s_back - s_front;
            for i in 0..LANES {
                (places[0][i], places[1][i]) = (s_front + starts[i] * way, s_front + ends[i] * way);
            }
        } else {
            let [lo, hi] = rays.lanes(chunk);
            for i in 0..LANES {
                (places[0][i], places[1][i]) = (lo.0[i].max(s_front), hi.0[i].min(s_back));
            }
        }
        places
    }
}

/// All projections but the local maximum ([`crate::ray::local_maximum`]).
pub struct Project {
    operator: Composite,
    /// See [`Project::levels`].
    levels: [f32; 2],
    value: Vec<Lanes>,
    length: Vec<Lanes>,
    /// Optical depth in front of the next sheet; empty but for attenuated maxima.
    absorbed: Vec<Lanes>,
    /// Positions of the extremes; empty where no depth is wanted.
    places: Vec<Lanes>,
}

impl Project {
    /// Continues from `state`; `None`: nothing is drawn yet. `levels`: see [`Project::levels`].
    pub fn new(operator: Composite, levels: [f32; 2], with_depth: bool, state: Option<TileState>) -> Self {
        let nothing = match operator {
            Composite::Maximum | Composite::DepthShadedMaximum { .. } | Composite::AttenuatedMaximum { .. } => {
                f32::NEG_INFINITY
            }
            Composite::Minimum => f32::INFINITY,
            _ => 0.0,
        };
        let where_wanted =
            |wanted: bool, x: f32| if wanted { TileState::per_chunk(Lanes::splat(x)) } else { Vec::new() };
        let state = state.unwrap_or_else(|| TileState {
            value: TileState::per_chunk(Lanes::splat(nothing)),
            length: TileState::per_chunk(Lanes::splat(0.0)),
            absorbed: where_wanted(matches!(operator, Composite::AttenuatedMaximum { .. }), 0.0),
            s_half: where_wanted(with_depth, f32::NAN),
            ..TileState::default()
        });
        let TileState { value, length, absorbed, s_half: places, .. } = state;
        Self { operator, levels, value, length, absorbed, places }
    }

    /// Two densities: the one that values are dimmed towards, or above which matter absorbs; and the one from which on
    /// matter dims most. 0 where an operator has none. `density` maps sample values.
    pub fn levels(operator: Composite, density: impl Fn(f64) -> f32) -> [f32; 2] {
        match operator {
            Composite::DepthShadedMaximum { black, .. } => [density(black), 0.0],
            Composite::AttenuatedMaximum { black, white, .. } => [density(black), density(white)],
            Composite::XRay { clear, .. } => [density(clear), 0.0],
            _ => [0.0; 2],
        }
    }

    /// Keeps the extreme of the rays of a chunk so far and of both ends of a segment, and where it is.
    #[inline(always)]
    fn keep(
        &mut self,
        k: usize,
        [near, far]: [&[f32; LANES]; 2],
        length: &[f32; LANES],
        places: impl Fn() -> [[f32; LANES]; 2],
        extreme: impl Fn(f32, f32) -> f32,
    ) {
        let value = &mut self.value[k].0;
        let before = *value;
        for i in 0..LANES {
            // A density that is linear between two sheets has its extremes at the ends, so no place in between need be
            // looked at.
            let new = extreme(value[i], extreme(near[i], far[i]));
            value[i] = if length[i] > 0.0 { new } else { value[i] };
        }
        let Some(kept) = self.places.get_mut(k) else { return };
        let [begin, end] = places();
        for i in 0..LANES {
            let here = if near[i] == value[i] { begin[i] } else { end[i] };
            // The first of equal extremes stays.
            kept.0[i] = if value[i] == before[i] { kept.0[i] } else { here };
        }
    }

    /// Optical depth of the segments of the rays of a chunk, of matter that absorbs `rate` per length at the second
    /// level.
    #[inline(always)]
    fn optical_depth(&self, segment: &DrawnSegment, rate: f32) -> [f32; LANES] {
        let [black, white] = self.levels;
        let per_density = rate / (white - black);
        let mut depth = [0.0; LANES];
        for i in 0..LANES {
            let (near, far) = (segment.near[i], segment.far[i]);
            // Absorption rises from black on and no further beyond white: a ramp from black on less a ramp from white
            // on.
            let mean = mean_above(near - black, far - black) - mean_above(near - white, far - white);
            depth[i] = if segment.length[i] > 0.0 { (mean * per_density * segment.length[i]).max(0.0) } else { 0.0 };
        }
        depth
    }
}

/// The density with its excess over a level scaled by `factor`.
#[inline(always)]
pub fn dimmed(density: f32, level: f32, factor: f32) -> f32 {
    if density > level { level + (density - level) * factor } else { density }
}

/// Mean of the positive part of a density that changes linearly; of a line through 0 the triangle above it counts.
#[inline(always)]
fn mean_above(near: f32, far: f32) -> f32 {
    let (lo, hi) = (near.min(far), near.max(far).max(0.0));
    if lo >= 0.0 { 0.5 * (near + far) } else { 0.5 * hi * hi / (hi - lo) }
}

/// Fractions of light that optical depths absorb.
#[inline(always)]
pub fn absorbed_of<S: Simd>(s: S, depth: &[f32; LANES]) -> [f32; LANES] {
    let mut fractions = [0.0; LANES];
    s.store(one_minus_exp_neg(s, s.load(depth)), &mut fractions);
    fractions
}

#[inline(always)]
fn larger(a: f32, b: f32) -> f32 {
    a.max(b)
}

#[inline(always)]
fn smaller(a: f32, b: f32) -> f32 {
    a.min(b)
}

impl Compositor for Project {
    #[inline(always)]
    fn is_done(&self, _: Chunk) -> bool {
        false
    }

    #[inline(always)]
    fn add_chunk<S: Simd>(&mut self, s: S, chunk: Chunk, rays: &Rays, slab: &mut Slab) {
        let segment = DrawnSegment::new(s, chunk, rays, slab);
        let (k, s_of_slab) = (chunk.index(), slab.s);
        let places = || segment.places(chunk, rays, s_of_slab);
        let DrawnSegment { near, far, length: extent, .. } = &segment;
        let [level, _] = self.levels;
        // One loop per operator, so that none of them branches inside.
        match self.operator {
            Composite::Maximum => self.keep(k, [near, far], extent, places, larger),
            Composite::Minimum => self.keep(k, [near, far], extent, places, smaller),
            Composite::DepthShadedMaximum { .. } => {
                let ([at_zero, per_s], [begin, end]) = (rays.fade(chunk), places());
                let (mut near, mut far) = (*near, *far);
                for i in 0..LANES {
                    near[i] = dimmed(near[i], level, at_zero.0[i] + per_s.0[i] * begin[i]);
                    far[i] = dimmed(far[i], level, at_zero.0[i] + per_s.0[i] * end[i]);
                }
                self.keep(k, [&near, &far], extent, places, larger);
            }
            Composite::AttenuatedMaximum { attenuation, .. } => {
                let here = self.optical_depth(&segment, attenuation as f32);
                let absorbed = &mut self.absorbed[k].0;
                let before = absorbed_of(s, absorbed);
                for i in 0..LANES {
                    absorbed[i] += here[i];
                }
                let behind = absorbed_of(s, absorbed);
                let (mut near, mut far) = (*near, *far);
                for i in 0..LANES {
                    near[i] = dimmed(near[i], level, 1.0 - before[i]);
                    far[i] = dimmed(far[i], level, 1.0 - behind[i]);
                }
                self.keep(k, [&near, &far], extent, places, larger);
            }
            Composite::XRay { .. } => {
                for (i, value) in self.value[k].0.iter_mut().enumerate() {
                    let above = mean_above(near[i] - level, far[i] - level) * extent[i];
                    *value = if extent[i] > 0.0 { *value + above } else { *value };
                }
            }
            _ => {
                for (i, value) in self.value[k].0.iter_mut().enumerate() {
                    let integral = 0.5 * (near[i] + far[i]) * extent[i];
                    *value = if extent[i] > 0.0 { *value + integral } else { *value };
                }
            }
        }
        for (length, extent) in self.length[k].0.iter_mut().zip(extent) {
            *length += extent;
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
        Texels { rgba, s_half: self.places.get(chunk.index()).map(|places| places.0) }
    }

    fn into_state(self) -> TileState {
        let Self { value, length, absorbed, places: s_half, .. } = self;
        TileState { value, length, absorbed, s_half, ..TileState::default() }
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
