//! Surfaces of shapes on the rays of a tile: which come next, and matter cut where they lie.
//!
//! A slab is composited part by part: up to the next surface of each ray, then these surfaces, then on from there. Rays
//! are clipped to the parts ([`Rays::cut`]), as they are to the volume's box, so matter is weighted exactly.

use wavesplat_compute::simd::{LANES, Lanes, Simd};

use crate::ray::compositor::{ChunkSurfaces, Compositor, Slab};
use crate::ray::state::TileState;
use crate::shapes::fragments::{Fragments, ShapeFragment};
use crate::sheet::tile_layout::{Block, Chunk};
use crate::sheet::tile_rays::Rays;

/// Surfaces on the rays of a tile, and how many of them each ray has passed.
pub struct TileSurfaces<'a> {
    fragments: &'a Fragments,
    /// First texel of the tile.
    first: [usize; 2],
    /// Numbers of passed surfaces, chunk by chunk.
    passed: Vec<[u8; LANES]>,
    /// Place of the next surface of each ray that is not opaque, chunk by chunk; infinite where there is none.
    ahead: Vec<Lanes>,
    /// The nearest of these of each chunk.
    next: Vec<f32>,
}

impl<'a> TileSurfaces<'a> {
    /// Surfaces on the rays of a tile whose first texel is `first`, after those that a state has passed.
    pub fn new(fragments: &'a Fragments, first: [usize; 2], passed: Vec<[u8; LANES]>) -> Self {
        let passed = if passed.is_empty() { TileState::per_chunk([0; LANES]) } else { passed };
        let (ahead, next) = (Lanes::splat(f32::INFINITY), f32::INFINITY);
        let (ahead, next) = (TileState::per_chunk(ahead), TileState::per_chunk(next));
        let mut surfaces = Self { fragments, first, passed, ahead, next };
        for chunk in Chunk::all() {
            if surfaces.has_any(chunk) {
                (0..LANES).for_each(|lane| surfaces.look_ahead(chunk, lane));
                surfaces.find_next(chunk);
            }
        }
        surfaces
    }

    /// Numbers of passed surfaces, for the state.
    pub fn into_passed(self) -> Vec<[u8; LANES]> {
        self.passed
    }

    /// Surfaces of a ray that it has not passed.
    #[inline(always)]
    pub fn rest(&self, chunk: Chunk, lane: usize) -> &'a [ShapeFragment] {
        let [i, j] = [self.first[0] + chunk.strip * LANES + lane, self.first[1] + chunk.row];
        &self.fragments.of(i, j)[usize::from(self.passed[chunk.index()][lane])..]
    }

    /// Whether any ray of a chunk has a surface.
    fn has_any(&self, chunk: Chunk) -> bool {
        let [i, j] = [self.first[0] + chunk.strip * LANES, self.first[1] + chunk.row];
        self.fragments.any_in_row(i, j, LANES)
    }

    /// Whether any ray of a chunk has a surface that it has not passed.
    pub fn has_rest(&self, chunk: Chunk) -> bool {
        self.has_any(chunk) && (0..LANES).any(|lane| !self.rest(chunk, lane).is_empty())
    }

    /// Finds the next surface of a ray.
    #[inline(always)]
    fn look_ahead(&mut self, chunk: Chunk, lane: usize) {
        // Rays end at opaque surfaces, so these come after all matter.
        let first = self.rest(chunk, lane).first().filter(|surface| surface.alpha < 1.0);
        self.ahead[chunk.index()].0[lane] = first.map_or(f32::INFINITY, |surface| surface.s);
    }

    #[inline(always)]
    fn find_next(&mut self, chunk: Chunk) {
        self.next[chunk.index()] = self.ahead[chunk.index()].0.into_iter().fold(f32::INFINITY, f32::min);
    }

    /// Ends rays where they meet an opaque surface: nothing behind it is drawn.
    pub fn end_rays(&self, rays: &mut Rays) {
        for chunk in Chunk::all().filter(|chunk| self.has_rest(*chunk)) {
            let mut ends = Lanes::splat(f32::INFINITY);
            for (lane, end) in ends.0.iter_mut().enumerate() {
                if let Some(last) = self.rest(chunk, lane).last().filter(|last| last.alpha >= 1.0) {
                    *end = last.s;
                }
            }
            rays.end_at(chunk, &ends);
        }
    }

    /// Whether any ray of a block meets a surface before a place.
    #[inline(always)]
    pub fn has_before(&self, block: Block, s: f32) -> bool {
        block.chunks().any(|chunk| self.next[chunk.index()] < s)
    }

    /// Adds a slab, and the surfaces that lie in it or were left out in front of it, to the chunks of a block.
    #[inline(always)]
    pub fn add_slab<S: Simd, C: Compositor>(
        &mut self,
        s: S,
        block: Block,
        compositor: &mut C,
        rays: &mut Rays,
        slab: &mut Slab,
    ) {
        let covered = compositor.covered(block, slab);
        for chunk in block.chunks() {
            if rays.draws_nothing(chunk) || compositor.is_done(chunk) {
                continue;
            }
            if self.next[chunk.index()] < covered[1] {
                self.add_parts(s, chunk, compositor, rays, slab, covered);
            } else {
                compositor.add_chunk(s, chunk, rays, slab);
            }
        }
    }

    #[inline(always)]
    fn add_parts<S: Simd, C: Compositor>(
        &mut self,
        s: S,
        chunk: Chunk,
        compositor: &mut C,
        rays: &mut Rays,
        slab: &mut Slab,
        [from, to]: [f32; 2],
    ) {
        let mut begins = Lanes::splat(f32::NEG_INFINITY);
        loop {
            let mut ends = self.ahead[chunk.index()];
            ends.0.iter_mut().for_each(|end| *end = end.min(to));
            if (0..LANES).any(|lane| begins.0[lane].max(from) < ends.0[lane]) {
                let kept = rays.cut(chunk, [&begins, &ends]);
                let kept_of_layers = slab.cut(chunk, [&begins, &ends]);
                compositor.add_chunk(s, chunk, rays, slab);
                rays.restore(chunk, kept);
                slab.restore(chunk, kept_of_layers);
            }
            let Some(surfaces) = self.pass(chunk, to) else { break };
            compositor.add_surfaces(s, chunk, rays, &surfaces);
            begins = ends;
            if compositor.is_done(chunk) {
                break;
            }
        }
        self.find_next(chunk);
    }

    /// Passes the next surface of each ray, where it lies in front of a place; `None` where none does.
    #[inline(always)]
    fn pass(&mut self, chunk: Chunk, to: f32) -> Option<ChunkSurfaces> {
        let mut surfaces = ChunkSurfaces { rgb: [[0.0; LANES]; 3], alpha: [0.0; LANES], s: [to; LANES] };
        let mut any = false;
        for lane in 0..LANES {
            if self.ahead[chunk.index()].0[lane] < to {
                let surface = self.rest(chunk, lane)[0];
                (surfaces.s[lane], surfaces.alpha[lane]) = (surface.s, surface.alpha);
                for c in 0..3 {
                    surfaces.rgb[c][lane] = surface.rgb[c];
                }
                self.passed[chunk.index()][lane] += 1;
                self.look_ahead(chunk, lane);
                any = true;
            }
        }
        any.then_some(surfaces)
    }
}
