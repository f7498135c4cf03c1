//! Local maximum intensity projection: the first maximum along a ray that reaches a threshold, else the global one.
//!
//! A near maximum that is bright enough hides brighter ones behind it, which a maximum projection cannot show. A ray
//! keeps the largest density so far; once that has reached the threshold, the first density below it ends the ray.
//! Source: Sato et al., *Local maximum intensity projection (LMIP)*, J. Computer Assisted Tomography 22(6), 1998.

use wavesplat_compute::simd::{LANES, Lanes, Simd};

use crate::ray::compositor::Slab;
use crate::ray::compositor::{Compositor, Texels};
use crate::ray::project::DrawnSegment;
use crate::ray::state::TileState;
use crate::sheet::tile_layout::Chunk;
use crate::sheet::tile_rays::Rays;

/// Relative difference of densities below which they count as equal: reconstruction rounds to f32 a few times, and a
/// plateau on the way up must not look like a maximum.
pub const ROUNDING: f32 = 1e-6;

/// Local maxima along the rays of a tile.
pub struct LocalMaximum {
    /// Threshold, as a density.
    threshold: f32,
    /// The largest density so far; −∞ where nothing was drawn.
    highest: Vec<Lanes>,
    /// Positions of the largest density so far; empty where no depth is wanted.
    places: Vec<Lanes>,
    /// Rays that have found their maximum, as bits.
    found: Vec<u16>,
    done: Vec<bool>,
}

impl LocalMaximum {
    /// Continues from `state`; `None`: nothing is drawn yet. `threshold` is a density.
    pub fn new(threshold: f32, with_depth: bool, state: Option<TileState>) -> Self {
        let state = state.unwrap_or_else(|| TileState {
            value: TileState::per_chunk(Lanes::splat(f32::NEG_INFINITY)),
            s_half: if with_depth { TileState::per_chunk(Lanes::splat(f32::NAN)) } else { Vec::new() },
            found: TileState::per_chunk(0),
            done: TileState::per_chunk(false),
            ..TileState::default()
        });
        let TileState { value: highest, s_half: places, found, done, .. } = state;
        Self { threshold, highest, places, found, done }
    }
}

impl Compositor for LocalMaximum {
    #[inline(always)]
    fn is_done(&self, chunk: Chunk) -> bool {
        self.done[chunk.index()]
    }

    #[inline(always)]
    fn add_chunk<S: Simd>(&mut self, s: S, chunk: Chunk, rays: &Rays, slab: &mut Slab) {
        let segment = DrawnSegment::new(s, chunk, rays, slab);
        let highest = &mut self.highest[chunk.index()].0;
        let mut found = self.found[chunk.index()];
        for (end, densities) in [&segment.near, &segment.far].into_iter().enumerate() {
            let before = *highest;
            let mut falls = 0;
            for i in 0..LANES {
                let is_drawn = segment.length[i] > 0.0;
                let least = highest[i] - ROUNDING * highest[i].abs();
                let falls_here = is_drawn && highest[i] >= self.threshold && densities[i] < least;
                falls |= u16::from(falls_here) << i;
                let goes_on = is_drawn && found >> i & 1 == 0 && !falls_here;
                highest[i] = if goes_on { highest[i].max(densities[i]) } else { highest[i] };
            }
            found |= falls;
            if let Some(kept) = self.places.get_mut(chunk.index()) {
                let places = segment.places(chunk, rays, slab.s)[end];
                for i in 0..LANES {
                    kept.0[i] = if highest[i] == before[i] { kept.0[i] } else { places[i] };
                }
            }
        }
        self.found[chunk.index()] = found;
        self.done[chunk.index()] = found | rays.missed(chunk) == u16::MAX;
    }

    fn finish(&self, chunk: Chunk) -> Texels {
        let highest = &self.highest[chunk.index()].0;
        let texel = |i: usize| if highest[i] > f32::NEG_INFINITY { [highest[i], 0.0, 0.0, 1.0] } else { [0.0; 4] };
        Texels { rgba: std::array::from_fn(texel), s_half: self.places.get(chunk.index()).map(|places| places.0) }
    }

    fn into_state(self) -> TileState {
        let Self { highest: value, places: s_half, found, done, .. } = self;
        TileState { value, s_half, found, done, ..TileState::default() }
    }
}
