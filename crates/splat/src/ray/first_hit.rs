//! First hit, a shaded isosurface: the first crossing of an iso-value along each ray, in the colour of that value, or of
//! another field at the place of the crossing ([`FieldColor`]).

use wavesplat_compute::simd::{LANES, Lanes, Simd};

use crate::optics::classify::Classifier;
use crate::optics::field_color::FieldColor;
use crate::optics::shade::Shader;
use crate::ray::accumulator::between;
use crate::ray::compositor::ChunkSurfaces;
use crate::ray::compositor::Slab;
use crate::ray::compositor::{Compositor, Ends, Texels};
use crate::ray::state::TileState;
use crate::sheet::field_sheets::{FieldPoint, FieldValues};
use crate::sheet::tile_layout::Chunk;
use crate::sheet::tile_rays::Rays;
use crate::source::nonfinite::MISSING;

/// The first crossing of one iso-value along each ray of a tile.
pub struct FirstHit<'a> {
    iso: f32,
    rgb: [f32; 3],
    shader: Option<&'a Shader>,
    color: Option<&'a FieldColor>,
    /// Values of the field on the front and the back sheet, at the chunk that was read last.
    here: [FieldValues; 2],
    rgba: Vec<[Lanes; 4]>,
    s_hit: Vec<Lanes>,
    hit: Vec<u16>,
    done: Vec<bool>,
}

impl<'a> FirstHit<'a> {
    /// Continues from `state`; `None`: nothing is drawn yet. `iso` is a density. `color`: the field that colours the
    /// surface; `None` for the colour of `iso`.
    pub fn new(
        iso: f32,
        classifier: &Classifier,
        shader: Option<&'a Shader>,
        color: Option<&'a FieldColor>,
        state: Option<TileState>,
    ) -> Self {
        let state = state.unwrap_or_else(|| TileState {
            rgba: TileState::per_chunk([Lanes::splat(0.0); 4]),
            s_half: TileState::per_chunk(Lanes::splat(f32::NAN)),
            found: TileState::per_chunk(0),
            done: TileState::per_chunk(false),
            ..TileState::default()
        });
        let [r, g, b, _] = classifier.look_up_one(iso);
        Self {
            iso,
            rgb: [r, g, b],
            shader,
            color,
            here: Default::default(),
            rgba: state.rgba,
            s_hit: state.s_half,
            hit: state.found,
            done: state.done,
        }
    }
}

impl Compositor for FirstHit<'_> {
    const TAKES_SURFACES: bool = true;

    #[inline(always)]
    fn add_surfaces<S: Simd>(&mut self, _: S, chunk: Chunk, _: &Rays, surfaces: &ChunkSurfaces) {
        let rgba = &mut self.rgba[chunk.index()];
        for i in 0..LANES {
            let before = rgba[3].0[i];
            let weight = (1.0 - before) * surfaces.alpha[i];
            for c in 0..3 {
                rgba[c].0[i] += weight * surfaces.rgb[c][i];
            }
            rgba[3].0[i] += weight;
            if before < 0.5 && rgba[3].0[i] >= 0.5 {
                self.s_hit[chunk.index()].0[i] = surfaces.s[i];
            }
        }
    }

    #[inline(always)]
    fn is_done(&self, chunk: Chunk) -> bool {
        self.done[chunk.index()]
    }

    #[inline(always)]
    fn add_chunk<S: Simd>(&mut self, s: S, chunk: Chunk, rays: &Rays, slab: &mut Slab) {
        let [s_front, s_back] = slab.s;
        let Ends { front, back, missing } = Ends::new(s, chunk, slab);
        let [lo, hi] = rays.lanes(chunk);
        let mut at = [0.0; LANES];
        let mut new = 0;
        for i in 0..LANES {
            let (a, b) = (front[i] - self.iso, back[i] - self.iso);
            // A surface is crossed, from either side; a ray that starts inside has met a cut face, not a surface.
            let crosses = (a < 0.0) != (b < 0.0);
            // Zero of the line from a to b; where the signs differ, a and b do, and nothing is divided by 0.
            at[i] = a / (a - b);
            let place = s_front + (s_back - s_front) * at[i];
            let inside = place >= lo.0[i] && place <= hi.0[i];
            let known = missing.as_ref().is_none_or(|[front, back]| front[i] + (back[i] - front[i]) * at[i] < MISSING);
            new |= u16::from(crosses && inside && known) << i;
        }
        new &= !self.hit[chunk.index()] & !rays.missed(chunk);
        if new == 0 {
            return;
        }
        let mut rgb = [s.splat(self.rgb[0]), s.splat(self.rgb[1]), s.splat(self.rgb[2])];
        if let Some(color) = self.color {
            // Elsewhere there is no crossing, and the place of one is no number.
            (0..LANES).filter(|i| new >> i & 1 == 0).for_each(|i| at[i] = 0.0);
            let from = (slab.field_geometries, slab.field_panels);
            for (which, here) in self.here.iter_mut().enumerate() {
                slab.fields[which].read(s, from, color.field, [chunk; 2], here);
            }
            let point = FieldPoint::between(&self.here, s.load(&at));
            if color.has_mask {
                new &= s.bits(s.lt(point.missing(s, color.field), s.splat(MISSING)));
            }
            rgb = color.rgb(s, &point);
        }
        if new == 0 {
            return;
        }
        if let Some(shader) = self.shader {
            slab.first.prepare_gradient(0, chunk.block());
            slab.first.prepare_gradient(1, chunk.block());
            let front = slab.first.front.gradient(s, [chunk; 2]);
            let back = slab.first.back.gradient(s, [chunk; 2]);
            let at = s.load(&at);
            let gradient = between(s, front, back, at);
            rgb = shader.shade(s, rgb, gradient, rays.to_eye(s, [chunk; 2]));
        }
        let rgba = &mut self.rgba[chunk.index()];
        let mut shaded = [[1.0; LANES]; 4];
        for c in 0..3 {
            s.store(rgb[c], &mut shaded[c]);
        }
        for i in (0..LANES).filter(|i| new >> i & 1 == 1) {
            // Surfaces of shapes may lie in front.
            let left = 1.0 - rgba[3].0[i];
            for c in 0..4 {
                rgba[c].0[i] += left * shaded[c][i];
            }
            if left > 0.5 {
                self.s_hit[chunk.index()].0[i] = s_front + (s_back - s_front) * at[i];
            }
        }
        self.hit[chunk.index()] |= new;
        self.done[chunk.index()] = self.hit[chunk.index()] | rays.missed(chunk) == u16::MAX;
    }

    fn finish(&self, chunk: Chunk) -> Texels {
        Texels::new(&self.rgba[chunk.index()], Some(&self.s_hit[chunk.index()]))
    }

    fn into_state(self) -> TileState {
        TileState { rgba: self.rgba, s_half: self.s_hit, found: self.hit, done: self.done, ..TileState::default() }
    }
}
