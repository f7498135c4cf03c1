//! Parts that compositing of one volume ([`crate::ray::over`]) and of several ([`crate::ray::over_layers`]) share.
//!
//! Both ask whether a live ray can see a layer's scan or its label medium, read the fields that these need, find the
//! part of the slab that the layer's rays draw, and light its colours. They differ in how they mix media.

use std::ops::Range;

use wavesplat_compute::simd::{Simd, Wide};

use crate::optics::classify::Classifier;
use crate::optics::modifiers::Modifiers;
use crate::optics::shade::Shader;
use crate::ray::accumulator::{Accumulator, Chunks, extent, lit};
use crate::ray::compositor::{ChunkSurfaces, Compositor, Slab, Texels};
use crate::ray::cut_faces::{CutFaces, Matter, most_missing, place_between};
use crate::ray::state::TileState;
use crate::sheet::field_sheets::{FieldPoint, FieldValues};
use crate::sheet::layer_sheets::LayerSheets;
use crate::sheet::tile_layout::{Block, Chunk};
use crate::sheet::tile_rays::Rays;
use crate::source::nonfinite::known_share;

/// Optics of a layer: from density to colour and optical depth.
#[derive(Clone, Copy)]
pub struct LayerOptics<'a> {
    /// Colour and optical depth by density.
    pub classifier: &'a Classifier,
    /// Lights and coefficients; `None` without shading.
    pub shader: Option<&'a Shader>,
    /// Gradient opacity, occlusion and shadow, labels.
    pub modifiers: &'a Modifiers,
}

impl LayerOptics<'_> {
    /// Whether colour or opacity depends on the scan's gradient. `MODIFIED`: whether there may be modifiers.
    #[inline(always)]
    pub fn needs_gradient<const MODIFIED: bool>(&self) -> bool {
        self.shader.is_some() || (MODIFIED && self.modifiers.by_gradient.is_some())
    }

    /// The scan's colour, tinted and lit at a point. `even`: share of even light, near cuts.
    #[inline(always)]
    pub fn scan_color<W: Wide, const MODIFIED: bool>(
        &self,
        w: W,
        mut rgb: [W::F; 3],
        gradient: Option<[W::F; 3]>,
        (to_eye, even): ([W::F; 3], Option<W::F>),
        point: &FieldPoint<W>,
    ) -> [W::F; 3] {
        let mut light = [None; 2];
        if MODIFIED {
            rgb = self.modifiers.tint(w, self.modifiers.rgb(w, rgb, point), point);
            light = self.modifiers.light(w, point);
        }
        lit(w, rgb, self.shader.zip(gradient), to_eye, light, even)
    }

    /// Colour of the label medium, lit at a point.
    #[inline(always)]
    pub fn label_color<W: Wide>(
        &self,
        w: W,
        rgb: [W::F; 3],
        (to_eye, even): ([W::F; 3], Option<W::F>),
        point: &FieldPoint<W>,
    ) -> [W::F; 3] {
        let shader = self.modifiers.label_shader.as_ref().zip(Some(point.gradient(w)));
        lit(w, rgb, shader, to_eye, self.modifiers.light(w, point), even)
    }
}

/// Compositing of a tile by *over*. `M`: the media, which [`AddMedia`] mixes.
pub struct OverTile<M> {
    /// Optics of the media.
    pub media: M,
    /// Field values on the front and the back sheet, at the chunks that were read last.
    pub here: [FieldValues; 2],
    /// Whether slabs are pre-integrated.
    pub needs_preintegration: bool,
    /// Colours and opacities of the rays.
    pub so_far: Accumulator,
    /// Where the rays entered matter at cuts.
    pub cuts: CutFaces,
}

/// How the media of a slab are mixed and composited.
pub trait AddMedia {
    /// Composites the front (0) or back (1) sheet as a slab of constant density between two positions.
    fn add_sheet<W: Wide>(&mut self, w: W, chunks: Chunks, rays: &Rays, slab: &mut Slab, sheet: (usize, [f32; 2]));

    /// Composites the space between two sheets with densities that are linear in between.
    fn add_slab<W: Wide>(&mut self, w: W, chunks: Chunks, rays: &Rays, slab: &mut Slab);

    /// Whether anything may be visible in a block on the front and the back sheet of a slab, or, where slabs are
    /// pre-integrated, between them. A sheet whose slab follows is the front of that one.
    #[inline(always)]
    fn wanted_sheets<S: Simd>(&self, _: S, block: Block, slab: &Slab) -> [bool; 2] {
        [true, slab.is_last(block)]
    }

    /// Adds a slab to those chunks of a block that are neither done nor missed.
    fn add_block<S: Simd>(&mut self, s: S, block: Block, rays: &Rays, slab: &mut Slab);
}

impl<M> OverTile<M> {
    /// Continues from `state`; `None`: nothing is drawn yet. `shaders`: of the media. `opaque`: opacity from which a ray
    /// is done. `with_depth`: whether `s_half` is wanted.
    pub fn new<'a>(
        media: M,
        shaders: impl IntoIterator<Item = Option<&'a Shader>>,
        needs_preintegration: bool,
        (opaque, with_depth): (f32, bool),
        mut state: Option<TileState>,
    ) -> Self {
        let cuts = CutFaces::new(shaders, state.as_mut());
        let so_far = Accumulator::new(opaque, with_depth, state);
        Self { media, here: Default::default(), needs_preintegration, so_far, cuts }
    }

    /// Per chunk: can a live ray see any density from `lo` to `hi`?
    #[inline(always)]
    pub fn see<W: Wide>(
        &self,
        w: W,
        chunks: Chunks,
        rays: &Rays,
        classifier: &Classifier,
        [lo, hi]: [W::F; 2],
    ) -> [bool; 2] {
        let [least, most] = classifier.visible_range();
        self.so_far.see_where(w, chunks, rays, w.and(w.le(w.splat(least), hi), w.le(lo, w.splat(most))))
    }

    /// Whether any live ray can see the label medium on the front (0) and back (1) sheets `which`. Reads its optical
    /// depth.
    #[inline(always)]
    pub fn see_label_medium<W: Wide>(
        &mut self,
        w: W,
        chunks: Chunks,
        rays: &Rays,
        slab: &mut Slab,
        which: Range<usize>,
        modifiers: &Modifiers,
    ) -> bool {
        let Some(field) = modifiers.label_medium_field() else { return false };
        let from = (slab.field_geometries, slab.field_panels);
        let mut most = w.splat(0.0);
        for k in which {
            slab.fields[k].read(w, from, field, chunks, &mut self.here[k]);
            most = w.max(most, self.here[k].value(w, field));
        }
        self.so_far.see_where(w, chunks, rays, w.lt(w.splat(0.0), most)) != [false; 2]
    }

    /// Reads the fields that the scan and the label medium need (except its optical depth, which was read before) on
    /// the front (0) and back (1) sheets `which`.
    #[inline(always)]
    pub fn read_fields<W: Wide>(
        &mut self,
        w: W,
        chunks: Chunks,
        slab: &mut Slab,
        which: Range<usize>,
        modifiers: &Modifiers,
        [scan, medium]: [bool; 2],
    ) {
        let from = (slab.field_geometries, slab.field_panels);
        for k in which {
            for field in modifiers.fields(scan, medium) {
                slab.fields[k].read(w, from, field, chunks, &mut self.here[k]);
            }
            if medium
                && modifiers.label_shader.is_some()
                && let Some(field) = modifiers.label_medium_field()
            {
                slab.fields[k].read_gradient(w, from, field, chunks, &mut self.here[k]);
            }
        }
    }
}

impl<M> OverTile<M>
where
    Self: AddMedia,
{
    /// Adds the front and the back sheet of a slab, or the space between them, to one chunk or two. `wanted`: sheets on
    /// which something may be visible.
    #[inline(always)]
    pub fn add_chunks<W: Wide>(&mut self, w: W, chunks: Chunks, rays: &Rays, slab: &mut Slab, wanted: [bool; 2]) {
        if self.needs_preintegration {
            return w.one().outlined(
                #[inline(always)]
                || self.add_slab(w, chunks, rays, slab),
            );
        }
        let [s_front, s_back] = slab.s;
        let half = 0.5 * (s_back - s_front);
        let sheets = [[s_front - half, s_front + half], [s_back - half, s_back]];
        for (which, ends) in sheets.into_iter().enumerate() {
            if wanted[which] {
                w.one().outlined(
                    #[inline(always)]
                    || self.add_sheet(w, chunks, rays, slab, (which, ends)),
                );
            }
        }
    }
}

impl<M> Compositor for OverTile<M>
where
    Self: AddMedia,
{
    const TAKES_SURFACES: bool = true;

    #[inline(always)]
    fn covered(&self, block: Block, slab: &Slab) -> [f32; 2] {
        if self.needs_preintegration { slab.s } else { slab.covered_by_sheets(slab.is_last(block)) }
    }

    #[inline(always)]
    fn add_surfaces<S: Simd>(&mut self, s: S, chunk: Chunk, rays: &Rays, surfaces: &ChunkSurfaces) {
        self.so_far.add_surfaces(s, chunk, rays, surfaces);
    }

    fn reads_back_sheet(&self) -> bool {
        self.needs_preintegration
    }

    #[inline(always)]
    fn is_done(&self, chunk: Chunk) -> bool {
        self.so_far.is_done(chunk)
    }

    #[inline(always)]
    fn add_chunk<S: Simd>(&mut self, s: S, chunk: Chunk, rays: &Rays, slab: &mut Slab) {
        let wanted = self.wanted_sheets(s, chunk.block(), slab);
        self.add_chunks(s, [chunk; 2], rays, slab, wanted);
    }

    #[inline(always)]
    fn add<S: Simd>(&mut self, s: S, block: Block, rays: &Rays, slab: &mut Slab) {
        self.add_block(s, block, rays, slab);
    }

    fn finish(&self, chunk: Chunk) -> Texels {
        self.so_far.finish(chunk)
    }

    fn into_state(self) -> TileState {
        TileState { entries: self.cuts.into_entries(), ..self.so_far.into_state() }
    }
}

/// The part that a layer's rays draw of a slab of constant density, by one sheet.
pub struct SheetPart<W: Wide> {
    /// Where it begins along s.
    pub begin: W::F,
    /// How far it extends along s.
    pub extent: W::F,
    /// Length of the rays in it, less the missing share.
    pub length: W::F,
    /// Missing share, of volumes with missing samples.
    pub missing: Option<W::F>,
    full_length: W::F,
}

impl<W: Wide> SheetPart<W> {
    /// The part of `ends` that rays draw with the front (0) or back (1) sheet.
    #[inline(always)]
    pub fn new(w: W, chunks: Chunks, rays: &Rays, sheets: &LayerSheets, which: usize, ends: [f32; 2]) -> Self {
        let (begin, extent) = extent(w, chunks, rays, ends);
        let full_length = w.mul(extent, rays.thickness(w, chunks));
        let (mut length, mut missing) = (full_length, None);
        if sheets.geometry.slices.has_mask() {
            let share = sheets.sheet(which).missing(w, chunks);
            missing = Some(share);
            length = w.mul(length, known_share(w, share));
        }
        Self { begin, extent, length, missing, full_length }
    }

    /// A medium of an optical depth per length, as cut faces ask for it: as if no sample were missing.
    #[inline(always)]
    pub fn matter(&self, w: W, depth: W::F) -> Matter<W> {
        let at = w.add_mul(self.begin, w.splat(0.5), self.extent);
        let depth = w.mul(depth, self.full_length);
        Matter { begin: self.begin, extent: self.extent, depth, at, missing: self.missing }
    }
}

/// The part that a layer's rays draw of the space between two sheets.
pub struct SlabPart<W: Wide> {
    /// Where it begins along s.
    pub from: W::F,
    /// How far it extends along s.
    pub extent: W::F,
    /// Fraction of the slab at which it begins.
    pub begin: W::F,
    /// Its share of the slab.
    pub drawn: W::F,
    /// Fraction of the slab at which it ends.
    pub end: W::F,
    /// Missing shares on both sheets, of volumes with missing samples.
    pub missing: Option<[W::F; 2]>,
    /// Positions of the sheets.
    pub s: [f32; 2],
}

impl<W: Wide> SlabPart<W> {
    /// The part that rays draw between sheets at two positions.
    #[inline(always)]
    pub fn new(w: W, chunks: Chunks, rays: &Rays, sheets: &LayerSheets, s: [f32; 2]) -> Self {
        let [s_front, s_back] = s;
        let (from, extent) = extent(w, chunks, rays, s);
        let per_s = w.splat(1.0 / (s_back - s_front));
        let begin = w.mul(w.sub(from, w.splat(s_front)), per_s);
        let end = w.add_mul(begin, extent, per_s);
        let mut missing = None;
        if sheets.geometry.slices.has_mask() {
            missing = Some([sheets.front.missing(w, chunks), sheets.back.missing(w, chunks)]);
        }
        Self { from, extent, begin, drawn: w.mul(extent, per_s), end, missing, s }
    }

    /// Fraction of the slab at a fraction of the part.
    #[inline(always)]
    pub fn fraction(&self, w: W, share: W::F) -> W::F {
        w.add_mul(self.begin, share, self.drawn)
    }

    /// Missing share at a fraction of the slab.
    #[inline(always)]
    pub fn missing_at(&self, w: W, fraction: W::F) -> Option<W::F> {
        let [front, back] = self.missing?;
        Some(w.add_mul(front, fraction, w.sub(back, front)))
    }

    /// A medium as cut faces ask for it, given where it begins along s, its optical depth if no sample were missing,
    /// and the fraction of the slab that its light comes from.
    #[inline(always)]
    pub fn matter(&self, w: W, begin: W::F, depth: W::F, at: W::F) -> Matter<W> {
        Matter {
            begin,
            extent: self.extent,
            depth,
            at: place_between(w, self.s, at),
            missing: most_missing(w, self.missing),
        }
    }
}
