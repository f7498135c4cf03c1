//! Accumulated colour and opacity of rays, composited front to back, and early ray termination.
//!
//! *over* with associated colour (Porter & Duff 1984): `C += (1 − A) c α`, `A += (1 − A) α`.

use wavesplat_compute::simd::{Lanes, Simd, Wide};

use crate::optics::shade::Shader;
use crate::ray::compositor::ChunkSurfaces;
use crate::ray::compositor::Texels;
use crate::ray::state::TileState;
use crate::sheet::tile_layout::Chunk;
use crate::sheet::tile_rays::Rays;

/// Colours and opacities of the rays of a tile.
pub struct Accumulator {
    /// Opacity from which a ray is done.
    opaque: f32,
    with_depth: bool,
    rgba: Vec<[Lanes; 4]>,
    s_half: Vec<Lanes>,
    done: Vec<bool>,
}

/// One chunk (twice), or two chunks of the same block.
pub type Chunks = [Chunk; 2];

/// One fragment per ray of the chunks, ready to be composited.
pub struct Fragment<W: Wide> {
    /// Unassociated colour.
    pub rgb: [W::F; 3],
    /// Opacity.
    pub alpha: W::F,
    /// Where opacity begins along s.
    pub from: W::F,
    /// How far it extends along s.
    pub extent: W::F,
}

impl Accumulator {
    /// Continues from `state`; `None`: nothing is drawn yet. `opaque`: opacity from which a ray is done. `with_depth`:
    /// whether `s_half` is wanted.
    pub fn new(opaque: f32, with_depth: bool, state: Option<TileState>) -> Self {
        let state = state.unwrap_or_else(|| TileState {
            rgba: TileState::per_chunk([Lanes::splat(0.0); 4]),
            s_half: if with_depth { TileState::per_chunk(Lanes::splat(f32::NAN)) } else { Vec::new() },
            done: TileState::per_chunk(false),
            ..TileState::default()
        });
        Self { opaque, with_depth, rgba: state.rgba, s_half: state.s_half, done: state.done }
    }

    /// Whether no ray of the chunk can change any more.
    #[inline(always)]
    pub fn is_done(&self, chunk: Chunk) -> bool {
        self.done[chunk.index()]
    }

    /// The result of a chunk.
    pub fn finish(&self, chunk: Chunk) -> Texels {
        Texels::new(&self.rgba[chunk.index()], self.s_half.get(chunk.index()))
    }

    /// The state that the next piece of the tile continues from.
    pub fn into_state(self) -> TileState {
        TileState { rgba: self.rgba, s_half: self.s_half, done: self.done, ..TileState::default() }
    }

    /// Composites a fragment behind all earlier ones.
    #[inline(always)]
    pub fn add_fragment<W: Wide>(&mut self, w: W, chunks: Chunks, rays: &Rays, fragment: &Fragment<W>) {
        let places = [chunks[0].index(), chunks[1].index()];
        let s = w.one();
        let ([r, g, b, a], [r2, g2, b2, a2]) = (&self.rgba[places[0]], &self.rgba[places[1]]);
        let before = w.join(s.load(&a.0), s.load(&a2.0));
        let weight = w.mul(w.sub(w.splat(1.0), before), fragment.alpha);
        let [red, green, blue] = fragment.rgb;
        let red = w.part(w.add_mul(w.join(s.load(&r.0), s.load(&r2.0)), weight, red));
        let green = w.part(w.add_mul(w.join(s.load(&g.0), s.load(&g2.0)), weight, green));
        let blue = w.part(w.add_mul(w.join(s.load(&b.0), s.load(&b2.0)), weight, blue));
        let after = w.add(before, weight);
        let alpha = w.part(after);
        for k in 0..W::N {
            let [r, g, b, a] = &mut self.rgba[places[k]];
            s.store(red[k], &mut r.0);
            s.store(green[k], &mut g.0);
            s.store(blue[k], &mut b.0);
            s.store(alpha[k], &mut a.0);
        }
        if self.with_depth {
            // Opacity is taken to grow evenly along the fragment.
            let half = w.splat(0.5);
            let share = w.div(w.sub(half, before), weight);
            let crossed = w.and(w.lt(before, half), w.le(half, after));
            let place = w.add_mul(fragment.from, share, fragment.extent);
            let s_half = w.load_from(&self.s_half, places);
            w.store_to(w.select(crossed, place, s_half), &mut self.s_half, places);
        }
        // Rays that never meet the volume do not keep a chunk alive.
        let opaque = w.all_bits(w.le(w.splat(self.opaque), after));
        for k in 0..W::N {
            self.done[places[k]] = opaque[k] | rays.missed(chunks[k]) == u16::MAX;
        }
    }

    /// Composites surfaces behind all earlier fragments.
    #[inline(always)]
    pub fn add_surfaces<S: Simd>(&mut self, s: S, chunk: Chunk, rays: &Rays, surfaces: &ChunkSurfaces) {
        let [r, g, b] = &surfaces.rgb;
        let fragment = Fragment {
            rgb: [s.load(r), s.load(g), s.load(b)],
            alpha: s.load(&surfaces.alpha),
            from: s.load(&surfaces.s),
            extent: s.splat(0.0),
        };
        self.add_fragment(s, [chunk; 2], rays, &fragment);
    }

    /// Per chunk: is a live ray in `visible`?
    #[inline(always)]
    pub fn see_where<W: Wide>(&self, w: W, chunks: Chunks, rays: &Rays, visible: W::M) -> [bool; 2] {
        let [first, second] = [&self.rgba[chunks[0].index()][3].0, &self.rgba[chunks[1].index()][3].0];
        let alpha = w.join(w.one().load(first), w.one().load(second));
        let is_open = w.lt(alpha, w.splat(self.opaque));
        let [first, second] = w.all_bits(w.and(visible, is_open));
        [first & !rays.idle(chunks[0]) != 0, second & !rays.idle(chunks[1]) != 0]
    }
}

/// A colour as lit where all light is dimmed to the share `open`, and the first light to `first`. `even`: share of even
/// light, near cuts.
#[inline(always)]
pub fn lit<W: Wide>(
    w: W,
    rgb: [W::F; 3],
    shader: Option<(&Shader, [W::F; 3])>,
    to_eye: [W::F; 3],
    [open, first]: [Option<W::F>; 2],
    even: Option<W::F>,
) -> [W::F; 3] {
    let mut lit = match (shader, first) {
        (Some((shader, gradient)), Some(first)) => shader.shade_in_shadow(w, rgb, gradient, to_eye, first),
        (Some((shader, gradient)), None) => shader.shade(w, rgb, gradient, to_eye),
        (None, Some(first)) => scaled(w, rgb, first),
        (None, None) => rgb,
    };
    if let Some(open) = open {
        lit = scaled(w, lit, open);
    }
    if let Some(((shader, _), share)) = shader.zip(even) {
        lit = shader.evened(w, rgb, lit, share);
    }
    lit
}

/// A vector times a number.
#[inline(always)]
fn scaled<W: Wide>(w: W, [x, y, z]: [W::F; 3], factor: W::F) -> [W::F; 3] {
    [w.mul(x, factor), w.mul(y, factor), w.mul(z, factor)]
}

/// Linear interpolation between two vectors.
#[inline(always)]
pub fn between<W: Wide>(w: W, from: [W::F; 3], to: [W::F; 3], share: W::F) -> [W::F; 3] {
    let ([a, b, c], [d, e, f]) = (from, to);
    [w.add_mul(a, share, w.sub(d, a)), w.add_mul(b, share, w.sub(e, b)), w.add_mul(c, share, w.sub(f, c))]
}

/// Start and length of the part of `[from, to]` that each ray draws.
#[inline(always)]
pub fn extent<W: Wide>(w: W, chunks: Chunks, rays: &Rays, [from, to]: [f32; 2]) -> (W::F, W::F) {
    if rays.all_draw(chunks[0], from, to) && rays.all_draw(chunks[1], from, to) {
        return (w.splat(from), w.splat(to - from));
    }
    let [lo, hi] = rays.interval(w, chunks);
    let from = w.max(w.splat(from), lo);
    let to = w.min(w.splat(to), hi);
    (from, w.max(w.sub(to, from), w.splat(0.0)))
}
