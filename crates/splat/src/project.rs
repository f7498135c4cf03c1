//! Projections: one density per ray, the largest, the smallest, the mean or the integral along it.

use wavesplat_compute::simd::{LANES, Lanes, Simd};
use wavesplat_core::Composite;

use crate::composite::{Compositor, Ends, Slab, Texels};
use crate::rays::Rays;
use crate::sheet::{Block, Chunk};

/// Maximum, minimum, mean and sum of the densities along a ray.
pub struct Project {
    operator: Composite,
    value: Vec<Lanes>,
    length: Vec<Lanes>,
}

impl Project {
    /// `operator` is one of the projections.
    pub fn new(operator: Composite) -> Self {
        Self { operator, value: vec![Lanes::splat(0.0); Chunk::N], length: vec![Lanes::splat(0.0); Chunk::N] }
    }
}

impl Project {
    #[inline(always)]
    fn add_chunk<S: Simd>(&mut self, s: S, chunk: Chunk, rays: &Rays, slab: &mut Slab) {
        let Ends { front, back, whole } = Ends::new(s, chunk, slab);
        let (value, length) = (&mut self.value[chunk.index()].0, &mut self.length[chunk.index()].0);
        let [lo, hi] = rays.lanes(chunk);
        let thickness = &rays.directions(chunk).thickness.0;
        let [s_front, s_back] = slab.s;
        let per_s = 1.0 / (s_back - s_front);
        let operator = self.operator;
        for i in 0..LANES {
            // The part of the slab that is drawn, and the densities at its ends.
            let from = ((lo.0[i] - s_front) * per_s).max(0.0);
            let to = ((hi.0[i] - s_front) * per_s).min(1.0);
            let slope = back[i] - front[i];
            let near = front[i] + from * slope;
            let far = if to == 1.0 { back[i] } else { front[i] + to * slope };
            let drawn = to > from && whole >> i & 1 == 1;
            let extent = if drawn { (to - from) * (s_back - s_front) * thickness[i] } else { 0.0 };
            let empty = length[i] == 0.0;
            let new = match operator {
                Composite::Maximum if empty => near.max(far),
                Composite::Maximum => value[i].max(near.max(far)),
                Composite::Minimum if empty => near.min(far),
                Composite::Minimum => value[i].min(near.min(far)),
                _ => value[i] + 0.5 * (near + far) * extent,
            };
            value[i] = if drawn { new } else { value[i] };
            length[i] += extent;
        }
    }
}

impl Compositor for Project {
    #[inline(always)]
    fn is_done(&self, _: Chunk) -> bool {
        false
    }

    #[inline(always)]
    fn add<S: Simd>(&mut self, s: S, block: Block, rays: &Rays, slab: &mut Slab) {
        slab.prepare(s, block);
        for chunk in block.chunks() {
            if !rays.none(chunk) && !self.is_done(chunk) {
                self.add_chunk(s, chunk, rays, slab);
            }
        }
    }

    fn finish(&self, chunk: Chunk) -> Texels {
        let rgba = std::array::from_fn(|i| {
            let (value, length) = (self.value[chunk.index()].0[i], self.length[chunk.index()].0[i]);
            let covered = if length > 0.0 { 1.0 } else { 0.0 };
            let value = if self.operator == Composite::Mean && length > 0.0 { value / length } else { value };
            [value * covered, length * covered, 0.0, covered]
        });
        Texels { rgba, s_half: None }
    }
}
