//! Compositing by *over*, front to back (Porter and Duff 1984), with early ray termination.
//!
//! With associated colour: `C += (1 − A) c α`, `A += (1 − A) α`. Each sheet stands for the slab half way to its
//! neighbours. Where the transfer function is steep, so that opacity or colour can change by a visible amount from
//! sheet to sheet, the space between two sheets is one slab of linear density instead, pre-integrated (Engel, Kraus,
//! Ertl 2001), with colour and gradient from where most of its light comes from: a hard surface is found, and shaded,
//! at its exact place, and few sheets do the work of many.
//!
//! Projections ([`crate::ray::project`]) keep one density per ray; *first hit* ([`crate::ray::first_hit`]) looks for
//! the first crossing of an iso-value and shades there. Both take the density as linear between sheets.
//!
//! Positions here are `s`, the slice coordinate w with the sign that makes it grow along the ray.

use std::ops::Range;

use wavesplat_compute::simd::{Pair, Simd, Wide};

use crate::optics::classify::{Classifier, one_minus_exp_neg};
use crate::optics::modifiers::Modifiers;
use crate::optics::shade::Shader;
use crate::ray::accumulator::{Accumulator, Chunks, Fragment, between, extent, lit};
use crate::ray::compositor::ChunkSurfaces;
use crate::ray::compositor::{Compositor, Slab, Texels};
use crate::ray::cut_faces::{CutFaces, Matter, most_missing, place_between};
use crate::ray::state::TileState;
use crate::sheet::field_sheets::{FieldPoint, FieldValues};
use crate::sheet::tile_layout::Block;
use crate::sheet::tile_layout::Chunk;
use crate::sheet::tile_rays::Rays;
use crate::source::nonfinite::{known_between, known_share};

/// Compositing of one volume's emission and absorption.
///
/// `MODIFIED`: with [`Modifiers`], which few pictures have; a constant, so that the others do not pay for them.
pub struct Over<'a, const MODIFIED: bool> {
    classifier: &'a Classifier,
    shader: Option<&'a Shader>,
    modifiers: &'a Modifiers,
    /// Field values on the front and the back sheet, at the chunks that were read last.
    here: [FieldValues; 2],
    /// Whether slabs are pre-integrated.
    needs_preintegration: bool,
    so_far: Accumulator,
    cuts: CutFaces,
}

impl<'a, const MODIFIED: bool> Over<'a, MODIFIED> {
    /// Continues from `state`; `None`: nothing is drawn yet. `opaque`: opacity from which a ray is done. `with_depth`:
    /// whether `s_half` is wanted.
    pub fn new(
        classifier: &'a Classifier,
        shader: Option<&'a Shader>,
        modifiers: &'a Modifiers,
        needs_preintegration: bool,
        opaque: f32,
        with_depth: bool,
        mut state: Option<TileState>,
    ) -> Self {
        let cuts = CutFaces::new([shader], state.as_mut());
        let so_far = Accumulator::new(opaque, with_depth, state);
        Self { classifier, shader, modifiers, here: Default::default(), needs_preintegration, so_far, cuts }
    }

    /// Composites the front (0) or back (1) sheet as a slab of constant density between two positions.
    #[inline(always)]
    fn add_sheet<W: Wide>(
        &mut self,
        w: W,
        chunks: Chunks,
        rays: &Rays,
        slab: &mut Slab,
        (which, [from, to]): (usize, [f32; 2]),
    ) {
        let geometry = slab.first.geometry;
        let density = if which == 0 { slab.first.front.density(w, chunks) } else { slab.first.back.density(w, chunks) };
        let scan_ahead = self.see(w, chunks, rays, [density; 2]) != [false; 2];
        let medium_ahead = MODIFIED && self.see_label_medium(w, chunks, rays, slab, which..which + 1);
        if !scan_ahead && !medium_ahead {
            return;
        }
        if MODIFIED {
            self.read_fields(w, chunks, slab, which..which + 1, [scan_ahead, medium_ahead]);
        }
        let needs_gradient = self.shader.is_some() || (MODIFIED && self.modifiers.by_gradient.is_some());
        // First, so that no live register is spilled around this call.
        if needs_gradient {
            slab.first.prepare_gradient(which, chunks[0].block());
        }
        let sheet = if which == 0 { &slab.first.front } else { &slab.first.back };
        let has_mask = geometry.slices.has_mask();
        let (begin, extent) = extent(w, chunks, rays, [from, to]);
        let full_length = w.mul(extent, rays.thickness(w, chunks));
        let (mut length, mut missing) = (full_length, None);
        if has_mask {
            let share = sheet.missing(w, chunks);
            missing = Some(share);
            length = w.mul(length, known_share(w, share));
        }
        let by_gradient = self.modifiers.by_gradient.as_ref().filter(|_| MODIFIED);
        // Before the look-up. After it, the compiler would read the table first and hold 32 of its entries on the stack
        // meanwhile, instead of 16 vectors of colours.
        let gradient = if needs_gradient { Some(sheet.gradient(w, chunks)) } else { None };
        let mut classified = self.classifier.look_up(w, density);
        if let Some((by_gradient, gradient)) = by_gradient.zip(gradient) {
            let point = FieldPoint::on(&self.here[which]);
            classified = by_gradient.classify(w, density, gradient, &point, classified);
            let [.., depth] = classified;
            if !medium_ahead && self.so_far.see_where(w, chunks, rays, w.lt(w.splat(0.0), depth)) == [false; 2] {
                return;
            }
        }
        let [r, g, b, mut depth] = classified;
        let point = FieldPoint::on(&self.here[which]);
        if MODIFIED {
            let share = if scan_ahead { self.modifiers.scan_share(w, &point, missing) } else { w.splat(0.0) };
            depth = w.mul(depth, share);
        }
        let scan_depth = w.mul(depth, length);
        let mut alpha = one_minus_exp_neg(w, scan_depth);
        let to_eye = rays.to_eye(w, chunks);
        let at = w.add_mul(begin, w.splat(0.5), extent);
        let matter = Matter { begin, extent, depth: w.mul(depth, full_length), at, missing };
        let even = self.cuts.even_share(w, chunks, rays, from, &matter);
        let mut rgb = [w.splat(0.0); 3];
        if !MODIFIED || scan_ahead {
            rgb = self.shade(w, [r, g, b], gradient, to_eye, &point, even);
        }
        if MODIFIED
            && medium_ahead
            && let Some(medium) = self.modifiers.medium(w, &point)
        {
            let matter = Matter { begin, extent, depth: w.mul(medium.0, full_length), at, missing };
            let even = self.cuts.even_share(w, chunks, rays, from, &matter);
            (rgb, alpha) = self.add_label_medium(w, (rgb, alpha, scan_depth), medium, length, (to_eye, even), &point);
        }
        self.so_far.add_fragment(w, chunks, rays, &Fragment { rgb, alpha, from: begin, extent });
    }

    /// Composites the space between two sheets with a density that is linear in between.
    #[inline(always)]
    fn add_slab<W: Wide>(&mut self, w: W, chunks: Chunks, rays: &Rays, slab: &mut Slab) {
        let geometry = slab.first.geometry;
        let [s_front, s_back] = slab.s;
        let front = slab.first.front.density(w, chunks);
        let back = slab.first.back.density(w, chunks);
        let scan_ahead = self.see(w, chunks, rays, [w.min(front, back), w.max(front, back)]) != [false; 2];
        let medium_ahead = MODIFIED && self.see_label_medium(w, chunks, rays, slab, 0..2);
        if !scan_ahead && !medium_ahead {
            return;
        }
        if MODIFIED {
            self.read_fields(w, chunks, slab, 0..2, [scan_ahead, medium_ahead]);
        }
        // First, so that no live register is spilled around this call.
        if self.shader.is_some() || (MODIFIED && self.modifiers.by_gradient.is_some()) {
            slab.first.prepare_gradient(0, chunks[0].block());
            slab.first.prepare_gradient(1, chunks[0].block());
        }
        let has_mask = geometry.slices.has_mask();
        let (from, extent) = extent(w, chunks, rays, slab.s);
        // The densities where the drawn part begins and ends.
        let per_s = w.splat(1.0 / (s_back - s_front));
        let change = w.sub(back, front);
        let begin = w.mul(w.sub(from, w.splat(s_front)), per_s);
        let end = w.add_mul(begin, extent, per_s);
        let passage = self.classifier.preintegrate(w, w.add_mul(front, begin, change), w.add_mul(front, end, change));
        let full_length = w.mul(extent, rays.thickness(w, chunks));
        // As if no sample were missing, for the whole and for the scan: the matter that a cut makes a face of.
        let mut shown_length = full_length;
        let (mut whole_length, mut length) = (full_length, full_length);
        let mut missing = None;
        if has_mask {
            missing = Some([slab.first.front.missing(w, chunks), slab.first.back.missing(w, chunks)]);
            // At the middle of the visible range for the scan, of the whole range for the label medium.
            let middle = w.mul(w.add(passage.first, passage.last), w.splat(0.5));
            let (of_scan, of_all) = (
                known_between(w, missing, w.add_mul(begin, middle, w.mul(extent, per_s))),
                known_between(w, missing, w.add_mul(begin, w.splat(0.5), w.mul(extent, per_s))),
            );
            length = w.mul(length, of_scan);
            whole_length = w.mul(whole_length, of_all);
        }
        if MODIFIED {
            // The factors at the middle of the visible range.
            let middle = w.mul(w.add(passage.first, passage.last), w.splat(0.5));
            let at = w.add_mul(begin, middle, w.mul(extent, per_s));
            if let Some(by_gradient) = &self.modifiers.by_gradient {
                let front = slab.first.front.gradient(w, chunks);
                let back = slab.first.back.gradient(w, chunks);
                let factor = by_gradient.factor(w, between(w, front, back, at));
                (length, shown_length) = (w.mul(length, factor), w.mul(shown_length, factor));
            }
            let share = if scan_ahead {
                let missing_there = missing.map(|[front, back]| w.add_mul(front, at, w.sub(back, front)));
                self.modifiers.scan_share(w, &FieldPoint::between(&self.here, at), missing_there)
            } else {
                w.splat(0.0)
            };
            (length, shown_length) = (w.mul(length, share), w.mul(shown_length, share));
        }
        let depths = [w.mul(passage.depths[0], length), w.mul(passage.depths[1], length)];
        let scan_depth = w.add(depths[0], depths[1]);
        let [mut alpha, mean] = passage.light(w, depths);
        let within = w.add_mul(passage.first, mean, w.sub(passage.last, passage.first));
        let at = w.add_mul(begin, within, w.mul(extent, per_s));
        let mut gradient = None;
        if self.shader.is_some() {
            let front = slab.first.front.gradient(w, chunks);
            let back = slab.first.back.gradient(w, chunks);
            gradient = Some(between(w, front, back, at));
        }
        let rgb = self.classifier.color(w, w.add_mul(front, at, change));
        let to_eye = rays.to_eye(w, chunks);
        let most_missing = most_missing(w, missing);
        let depth = w.mul(w.add(passage.depths[0], passage.depths[1]), shown_length);
        let visible_begin = w.add_mul(from, passage.first, extent);
        let matter =
            Matter { begin: visible_begin, extent, depth, at: place_between(w, slab.s, at), missing: most_missing };
        let even = self.cuts.even_share(w, chunks, rays, s_front, &matter);
        let mut rgb = if !MODIFIED || scan_ahead {
            self.shade(w, rgb, gradient, to_eye, &FieldPoint::between(&self.here, at), even)
        } else {
            [w.splat(0.0); 3]
        };
        // Opacity is taken to grow evenly along a fragment: its middle is put at the mean place of its light.
        let mut visible =
            (visible_begin, w.mul(w.mul(w.sub(passage.last, passage.first), extent), w.mul(w.splat(2.0), mean)));
        if MODIFIED {
            let middle = w.add_mul(begin, w.splat(0.5), w.mul(extent, per_s));
            let point = FieldPoint::between(&self.here, middle);
            if medium_ahead && let Some(medium) = self.modifiers.medium(w, &point) {
                let depth = w.mul(medium.0, full_length);
                let matter =
                    Matter { begin: from, extent, depth, at: place_between(w, slab.s, middle), missing: most_missing };
                let even = self.cuts.even_share(w, chunks, rays, s_front, &matter);
                (rgb, alpha) =
                    self.add_label_medium(w, (rgb, alpha, scan_depth), medium, whole_length, (to_eye, even), &point);
                visible = (from, extent);
            }
        }
        let (from, extent) = visible;
        self.so_far.add_fragment(w, chunks, rays, &Fragment { rgb, alpha, from, extent });
    }

    /// Reads the fields that the scan and the label medium need (except its optical depth, which was read before) on
    /// the front (0) and back (1) sheets `which`.
    #[inline(always)]
    fn read_fields<W: Wide>(
        &mut self,
        w: W,
        chunks: Chunks,
        slab: &mut Slab,
        which: Range<usize>,
        [scan, medium]: [bool; 2],
    ) {
        let from = (slab.field_geometries, slab.field_panels);
        for k in which {
            for field in self.modifiers.fields(scan, medium) {
                slab.fields[k].read(w, from, field, chunks, &mut self.here[k]);
            }
            if medium
                && self.modifiers.label_shader.is_some()
                && let Some(field) = self.modifiers.label_medium_field()
            {
                slab.fields[k].read_gradient(w, from, field, chunks, &mut self.here[k]);
            }
        }
    }

    /// The scan's colour, tinted and lit at a point. `even`: share of even light, near cuts.
    #[inline(always)]
    fn shade<W: Wide>(
        &self,
        w: W,
        rgb: [W::F; 3],
        gradient: Option<[W::F; 3]>,
        to_eye: [W::F; 3],
        point: &FieldPoint<W>,
        even: Option<W::F>,
    ) -> [W::F; 3] {
        let (mut rgb, mut light) = (rgb, [None; 2]);
        if MODIFIED {
            rgb = self.modifiers.tint(w, self.modifiers.rgb(w, rgb, point), point);
            light = self.modifiers.light(w, point);
        }
        lit(w, rgb, self.shader.zip(gradient), to_eye, light, even)
    }

    /// Whether any live ray can see the label medium on the front (0) and back (1) sheets `which`. Reads its optical
    /// depth.
    #[inline(always)]
    fn see_label_medium<W: Wide>(
        &mut self,
        w: W,
        chunks: Chunks,
        rays: &Rays,
        slab: &mut Slab,
        which: Range<usize>,
    ) -> bool {
        let Some(field) = self.modifiers.label_medium_field() else { return false };
        let from = (slab.field_geometries, slab.field_panels);
        let mut most = w.splat(0.0);
        for k in which {
            slab.fields[k].read(w, from, field, chunks, &mut self.here[k]);
            most = w.max(most, self.here[k].value(w, field));
        }
        self.so_far.see_where(w, chunks, rays, w.lt(w.splat(0.0), most)) != [false; 2]
    }

    /// Mixes the label medium into the scan's colour and opacity in the same space. Colours mix by extinction: where
    /// both media are opaque, opacities would weigh them equally.
    #[inline(always)]
    fn add_label_medium<W: Wide>(
        &self,
        w: W,
        (rgb, alpha, scan_depth): ([W::F; 3], W::F, W::F),
        (depth, color): (W::F, [W::F; 3]),
        length: W::F,
        (to_eye, even): ([W::F; 3], Option<W::F>),
        point: &FieldPoint<W>,
    ) -> ([W::F; 3], W::F) {
        let own_depth = w.mul(depth, length);
        let own = one_minus_exp_neg(w, own_depth);
        let shader = self.modifiers.label_shader.as_ref().zip(Some(point.gradient(w)));
        let color = lit(w, color, shader, to_eye, self.modifiers.light(w, point), even);
        let sum = w.add(scan_depth, own_depth);
        let share = w.select(w.lt(w.splat(0.0), sum), w.div(own_depth, sum), w.splat(0.0));
        let mut mixed = rgb;
        for c in 0..3 {
            mixed[c] = w.add_mul(rgb[c], share, w.sub(color[c], rgb[c]));
        }
        (mixed, w.sub(w.add(alpha, own), w.mul(alpha, own)))
    }

    /// Per chunk: can a live ray see any density from `lo` to `hi`?
    #[inline(always)]
    fn see<W: Wide>(&self, w: W, chunks: Chunks, rays: &Rays, [lo, hi]: [W::F; 2]) -> [bool; 2] {
        let [least, most] = self.classifier.visible_range();
        self.so_far.see_where(w, chunks, rays, w.and(w.le(w.splat(least), hi), w.le(lo, w.splat(most))))
    }

    /// Per chunk: can a live ray see anything in the space between the two sheets?
    #[inline(always)]
    fn see_slab<W: Wide>(&self, w: W, chunks: Chunks, rays: &Rays, slab: &Slab) -> [bool; 2] {
        let (front, back) = (slab.first.front.density(w, chunks), slab.first.back.density(w, chunks));
        self.see(w, chunks, rays, [w.min(front, back), w.max(front, back)])
    }
}

impl<const MODIFIED: bool> Over<'_, MODIFIED> {
    #[inline(always)]
    fn add_sheet_outlined<W: Wide>(
        &mut self,
        w: W,
        chunks: Chunks,
        rays: &Rays,
        slab: &mut Slab,
        which: (usize, [f32; 2]),
    ) {
        w.one().outlined(
            #[inline(always)]
            || self.add_sheet(w, chunks, rays, slab, which),
        );
    }

    /// Adds the front and the back sheet of a slab, or the space between them, to one chunk or two. `wanted`: sheets on
    /// which something may be visible.
    #[inline(always)]
    fn add_chunks<W: Wide>(&mut self, w: W, chunks: Chunks, rays: &Rays, slab: &mut Slab, [front, back]: [bool; 2]) {
        if self.needs_preintegration {
            return w.one().outlined(
                #[inline(always)]
                || self.add_slab(w, chunks, rays, slab),
            );
        }
        let [s_front, s_back] = slab.s;
        let half = 0.5 * (s_back - s_front);
        if front {
            self.add_sheet_outlined(w, chunks, rays, slab, (0, [s_front - half, s_front + half]));
        }
        if back {
            self.add_sheet_outlined(w, chunks, rays, slab, (1, [s_back - half, s_back]));
        }
    }

    /// Whether anything may be visible in a block on the front and the back sheet of a slab, or, where slabs are
    /// pre-integrated, between them.
    #[inline(always)]
    fn wanted_sheets<S: Simd>(&self, s: S, block: Block, slab: &Slab) -> [bool; 2] {
        let (front, back) = (&slab.first.front, &slab.first.back);
        // A sheet whose slab follows is the front of that one.
        let has_back = self.needs_preintegration || slab.first.is_last(block);
        if MODIFIED && self.modifiers.label_medium_field().is_some() {
            return [true, has_back];
        }
        let of_front = front.extremes(s, block);
        if self.needs_preintegration {
            let of_back = back.extremes(s, block);
            return [self.is_visible(s, [s.min(of_front[0], of_back[0]), s.max(of_front[1], of_back[1])]); 2];
        }
        [self.is_visible(s, of_front), has_back && self.is_visible(s, back.extremes(s, block))]
    }

    /// Whether any density between two is visible, in any lane.
    #[inline(always)]
    fn is_visible<S: Simd>(&self, s: S, [lo, hi]: [S::F; 2]) -> bool {
        let [least, most] = self.classifier.visible_range();
        s.bits(s.and(s.le(s.splat(least), hi), s.le(lo, s.splat(most)))) != 0
    }
}

impl<const MODIFIED: bool> Compositor for Over<'_, MODIFIED> {
    const TAKES_SURFACES: bool = true;

    #[inline(always)]
    fn covered(&self, block: Block, slab: &Slab) -> [f32; 2] {
        if self.needs_preintegration { slab.s } else { slab.covered_by_sheets(slab.first.is_last(block)) }
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
        let wanted = self.wanted_sheets(s, block, slab);
        if wanted == [false; 2] {
            return;
        }
        if !S::HAS_ROOM_FOR_PAIRS {
            return self.add_one_by_one(s, block, rays, slab);
        }
        for [first, second] in block.pairs() {
            let (one, other) = (
                !rays.draws_nothing(first) && !self.is_done(first),
                !rays.draws_nothing(second) && !self.is_done(second),
            );
            // At a hard surface one of the two chunks often sees nothing. The label medium is looked for later.
            let has_label_medium = MODIFIED && self.modifiers.label_medium_field().is_some();
            let seen = if one && other && self.needs_preintegration && !has_label_medium {
                self.see_slab(Pair(s), [first, second], rays, slab)
            } else {
                [one, other]
            };
            match seen {
                [true, true] => self.add_chunks(Pair(s), [first, second], rays, slab, wanted),
                [false, false] => {}
                [one, _] => self.add_chunks(s, [if one { first } else { second }; 2], rays, slab, wanted),
            }
        }
    }

    fn finish(&self, chunk: Chunk) -> Texels {
        self.so_far.finish(chunk)
    }

    fn into_state(self) -> TileState {
        TileState { entries: self.cuts.into_entries(), ..self.so_far.into_state() }
    }
}
