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

use wavesplat_compute::simd::{Pair, Simd, Wide};

use crate::optics::classify::one_minus_exp_neg;
use crate::ray::accumulator::{Chunks, Fragment, between};
use crate::ray::compositor::{Compositor, Slab};
use crate::ray::media::{AddMedia, LayerOptics, OverTile, SheetPart, SlabPart};
use crate::sheet::field_sheets::FieldPoint;
use crate::sheet::tile_layout::Block;
use crate::sheet::tile_rays::Rays;
use crate::source::nonfinite::known_between;

/// Emission and absorption of one volume.
///
/// `MODIFIED`: with [`crate::optics::modifiers::Modifiers`], which few pictures have; a constant, so that the others do
/// not pay for them.
pub struct One<'a, const MODIFIED: bool>(pub LayerOptics<'a>);

impl<const MODIFIED: bool> AddMedia for OverTile<One<'_, MODIFIED>> {
    #[inline(always)]
    fn add_sheet<W: Wide>(
        &mut self,
        w: W,
        chunks: Chunks,
        rays: &Rays,
        slab: &mut Slab,
        (which, ends): (usize, [f32; 2]),
    ) {
        let optics = self.media.0;
        let LayerOptics { classifier, modifiers, .. } = optics;
        let density = if which == 0 { slab.first.front.density(w, chunks) } else { slab.first.back.density(w, chunks) };
        let scan_ahead = self.see(w, chunks, rays, classifier, [density; 2]) != [false; 2];
        let only = which..which + 1;
        let medium_ahead = MODIFIED && self.see_label_medium(w, chunks, rays, slab, only.clone(), modifiers);
        if !scan_ahead && !medium_ahead {
            return;
        }
        if MODIFIED {
            self.read_fields(w, chunks, slab, only, modifiers, [scan_ahead, medium_ahead]);
        }
        let needs_gradient = optics.needs_gradient::<MODIFIED>();
        // First, so that no live register is spilled around this call.
        if needs_gradient {
            slab.first.prepare_gradient(which, chunks[0].block());
        }
        let part = SheetPart::new(w, chunks, rays, slab.first, which, ends);
        // Before the look-up. After it, the compiler would read the table first and hold 32 of its entries on the stack
        // meanwhile, instead of 16 vectors of colours.
        let gradient = if needs_gradient { Some(slab.first.sheet(which).gradient(w, chunks)) } else { None };
        let mut classified = classifier.look_up(w, density);
        let point = FieldPoint::on(&self.here[which]);
        let by_gradient = modifiers.by_gradient.as_ref().filter(|_| MODIFIED);
        if let Some((by_gradient, gradient)) = by_gradient.zip(gradient) {
            classified = by_gradient.classify(w, density, gradient, &point, classified);
            let [.., depth] = classified;
            let visible = w.lt(w.splat(0.0), depth);
            if !medium_ahead && self.so_far.see_where(w, chunks, rays, visible) == [false; 2] {
                return;
            }
        }
        let [r, g, b, mut depth] = classified;
        if MODIFIED {
            let share = if scan_ahead { modifiers.scan_share(w, &point, part.missing) } else { w.splat(0.0) };
            depth = w.mul(depth, share);
        }
        let scan_depth = w.mul(depth, part.length);
        let mut alpha = one_minus_exp_neg(w, scan_depth);
        let to_eye = rays.to_eye(w, chunks);
        let even = self.cuts.even_share(w, chunks, rays, ends[0], &part.matter(w, depth));
        let mut rgb = [w.splat(0.0); 3];
        if !MODIFIED || scan_ahead {
            rgb = optics.scan_color::<W, MODIFIED>(w, [r, g, b], gradient, (to_eye, even), &point);
        }
        if MODIFIED
            && medium_ahead
            && let Some((depth, color)) = modifiers.medium(w, &point)
        {
            let even = self.cuts.even_share(w, chunks, rays, ends[0], &part.matter(w, depth));
            let color = optics.label_color(w, color, (to_eye, even), &point);
            (rgb, alpha) = with_label_medium(w, (rgb, alpha, scan_depth), color, w.mul(depth, part.length));
        }
        let fragment = Fragment { rgb, alpha, from: part.begin, extent: part.extent };
        self.so_far.add_fragment(w, chunks, rays, &fragment);
    }

    #[inline(always)]
    fn add_slab<W: Wide>(&mut self, w: W, chunks: Chunks, rays: &Rays, slab: &mut Slab) {
        let optics = self.media.0;
        let LayerOptics { classifier, shader, modifiers } = optics;
        let front = slab.first.front.density(w, chunks);
        let back = slab.first.back.density(w, chunks);
        let range = [w.min(front, back), w.max(front, back)];
        let scan_ahead = self.see(w, chunks, rays, classifier, range) != [false; 2];
        let medium_ahead = MODIFIED && self.see_label_medium(w, chunks, rays, slab, 0..2, modifiers);
        if !scan_ahead && !medium_ahead {
            return;
        }
        if MODIFIED {
            self.read_fields(w, chunks, slab, 0..2, modifiers, [scan_ahead, medium_ahead]);
        }
        // First, so that no live register is spilled around this call.
        if optics.needs_gradient::<MODIFIED>() {
            slab.first.prepare_gradient(0, chunks[0].block());
            slab.first.prepare_gradient(1, chunks[0].block());
        }
        let part = SlabPart::new(w, chunks, rays, slab.first, slab.s);
        let (change, half) = (w.sub(back, front), w.splat(0.5));
        // Between the densities where the drawn part begins and ends.
        let [near, far] = [w.add_mul(front, part.begin, change), w.add_mul(front, part.end, change)];
        let passage = classifier.preintegrate(w, near, far);
        let full_length = w.mul(part.extent, rays.thickness(w, chunks));
        // The factors of the scan at the middle of its visible range.
        let middle = part.fraction(w, w.mul(w.add(passage.first, passage.last), half));
        // As if no sample were missing: the matter that a cut makes a face of.
        let (mut length, mut shown_length) = (full_length, full_length);
        if part.missing.is_some() {
            length = w.mul(length, known_between(w, part.missing, middle));
        }
        if MODIFIED {
            if let Some(by_gradient) = &modifiers.by_gradient {
                let front = slab.first.front.gradient(w, chunks);
                let back = slab.first.back.gradient(w, chunks);
                let factor = by_gradient.factor(w, between(w, front, back, middle));
                (length, shown_length) = (w.mul(length, factor), w.mul(shown_length, factor));
            }
            let mut share = w.splat(0.0);
            if scan_ahead {
                let point = FieldPoint::between(&self.here, middle);
                share = modifiers.scan_share(w, &point, part.missing_at(w, middle));
            }
            (length, shown_length) = (w.mul(length, share), w.mul(shown_length, share));
        }
        let depths = [w.mul(passage.depths[0], length), w.mul(passage.depths[1], length)];
        let scan_depth = w.add(depths[0], depths[1]);
        let [mut alpha, mean] = passage.light(w, depths);
        let at = part.fraction(w, w.add_mul(passage.first, mean, w.sub(passage.last, passage.first)));
        let mut gradient = None;
        if shader.is_some() {
            let front = slab.first.front.gradient(w, chunks);
            let back = slab.first.back.gradient(w, chunks);
            gradient = Some(between(w, front, back, at));
        }
        let mut rgb = classifier.color(w, w.add_mul(front, at, change));
        let to_eye = rays.to_eye(w, chunks);
        let depth = w.mul(w.add(passage.depths[0], passage.depths[1]), shown_length);
        let mut from = w.add_mul(part.from, passage.first, part.extent);
        let even = self.cuts.even_share(w, chunks, rays, slab.s[0], &part.matter(w, from, depth, at));
        if !MODIFIED || scan_ahead {
            let point = FieldPoint::between(&self.here, at);
            rgb = optics.scan_color::<W, MODIFIED>(w, rgb, gradient, (to_eye, even), &point);
        } else {
            rgb = [w.splat(0.0); 3];
        }
        // Opacity is taken to grow evenly along a fragment: its middle is put at the mean place of its light.
        let visible = w.mul(w.sub(passage.last, passage.first), part.extent);
        let mut extent = w.mul(visible, w.mul(w.splat(2.0), mean));
        if MODIFIED && medium_ahead {
            let middle = part.fraction(w, half);
            let point = FieldPoint::between(&self.here, middle);
            if let Some((depth, color)) = modifiers.medium(w, &point) {
                let matter = part.matter(w, part.from, w.mul(depth, full_length), middle);
                let even = self.cuts.even_share(w, chunks, rays, slab.s[0], &matter);
                let color = optics.label_color(w, color, (to_eye, even), &point);
                let known = w.mul(full_length, known_between(w, part.missing, middle));
                (rgb, alpha) = with_label_medium(w, (rgb, alpha, scan_depth), color, w.mul(depth, known));
                (from, extent) = (part.from, part.extent);
            }
        }
        self.so_far.add_fragment(w, chunks, rays, &Fragment { rgb, alpha, from, extent });
    }

    #[inline(always)]
    fn wanted_sheets<S: Simd>(&self, s: S, block: Block, slab: &Slab) -> [bool; 2] {
        let (front, back) = (&slab.first.front, &slab.first.back);
        // A sheet whose slab follows is the front of that one.
        let has_back = self.needs_preintegration || slab.is_last(block);
        if MODIFIED && self.media.0.modifiers.label_medium_field().is_some() {
            return [true, has_back];
        }
        let of_front = front.extremes(s, block);
        if self.needs_preintegration {
            let of_back = back.extremes(s, block);
            // Densities between the sheets are linear, so the extremes of both sheets bound them.
            return [self.is_visible(s, [s.min(of_front[0], of_back[0]), s.max(of_front[1], of_back[1])]); 2];
        }
        [self.is_visible(s, of_front), has_back && self.is_visible(s, back.extremes(s, block))]
    }

    #[inline(always)]
    fn add_block<S: Simd>(&mut self, s: S, block: Block, rays: &Rays, slab: &mut Slab) {
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
            let has_label_medium = MODIFIED && self.media.0.modifiers.label_medium_field().is_some();
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
}

impl<const MODIFIED: bool> OverTile<One<'_, MODIFIED>> {
    /// Per chunk: can a live ray see anything in the space between the two sheets?
    #[inline(always)]
    fn see_slab<W: Wide>(&self, w: W, chunks: Chunks, rays: &Rays, slab: &Slab) -> [bool; 2] {
        let (front, back) = (slab.first.front.density(w, chunks), slab.first.back.density(w, chunks));
        self.see(w, chunks, rays, self.media.0.classifier, [w.min(front, back), w.max(front, back)])
    }

    /// Whether any density between two is visible, in any lane.
    #[inline(always)]
    fn is_visible<S: Simd>(&self, s: S, [lo, hi]: [S::F; 2]) -> bool {
        let [least, most] = self.media.0.classifier.visible_range();
        s.bits(s.and(s.le(s.splat(least), hi), s.le(lo, s.splat(most)))) != 0
    }
}

/// Colour and opacity of the scan and the label medium in the same space. Colours mix by extinction: where both media
/// are opaque, opacities would weigh them equally.
#[inline(always)]
fn with_label_medium<W: Wide>(
    w: W,
    (rgb, alpha, scan_depth): ([W::F; 3], W::F, W::F),
    color: [W::F; 3],
    depth: W::F,
) -> ([W::F; 3], W::F) {
    let own = one_minus_exp_neg(w, depth);
    let sum = w.add(scan_depth, depth);
    let share = w.select(w.lt(w.splat(0.0), sum), w.div(depth, sum), w.splat(0.0));
    (between(w, rgb, color, share), w.sub(w.add(alpha, own), w.mul(alpha, own)))
}
