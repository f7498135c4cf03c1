//! Compositing of several layers: emission and absorption of several media in one space.
//!
//! At a point of space extinctions add, `τ = Σ τ_l`, and colours mix by extinction, `c = Σ τ_l c_l / τ`, each shaded by
//! its own gradient; the mixture is composited like a single volume ([`crate::ray::over`]). So layers hide each other
//! by their depth, and their order means nothing. Layers may have grids of their own: each has its sheets at the same
//! texels, and its box, beyond which it is empty.
//!
//! Where a transfer function is steep, the space between two sheets is pre-integrated: cut into a few parts, in each of
//! which the optical depths of the layers are exact, so that surfaces that lie close together hide each other in their
//! order.

use wavesplat_compute::simd::{Simd, Wide};

use crate::optics::classify::one_minus_exp_neg;
use crate::optics::gradient_opacity::GradientOpacity;
use crate::optics::preintegrate::{N_CUTS, PartOpacities};
use crate::ray::accumulator::{Chunks, Fragment, between, extent};
use crate::ray::compositor::{Compositor, Slab};
use crate::ray::cut_faces::place_between;
use crate::ray::media::{AddMedia, LayerOptics, OverTile, SheetPart, SlabPart};
use crate::sheet::field_sheets::{FieldPoint, FieldValues};
use crate::sheet::layer_sheets::LayerSheets;
use crate::sheet::tile_layout::Block;
use crate::sheet::tile_rays::Rays;
use crate::source::nonfinite::known_between;

/// Emission and absorption of several layers.
pub struct Several<'a>(pub &'a [LayerOptics<'a>]);

/// Number of parts that a pre-integrated slab is cut into.
const N_PARTS: usize = N_CUTS - 1;

/// Sums over layers: optical depth times colour, and optical depth.
#[derive(Clone, Copy)]
struct OpticalSum<W: Wide>([W::F; 3], W::F);

/// Start of a slab as far as even light is asked for: rays may enter one layer far behind another.
const ANYWHERE: f32 = f32::NEG_INFINITY;

/// Cap of optical depths: opaque, yet finite when multiplied and summed over layers.
const MAX_DEPTH: f32 = 1e30;

/// Optical depth below which colours do not matter; keeps divisions finite.
const MIN_DEPTH: f32 = 1e-20;

impl<W: Wide> OpticalSum<W> {
    #[inline(always)]
    fn none(w: W) -> Self {
        Self([w.splat(0.0); 3], w.splat(0.0))
    }

    /// Adds a medium.
    #[inline(always)]
    fn add(&mut self, w: W, rgb: [W::F; 3], depth: W::F) {
        let depth = w.min(depth, w.splat(MAX_DEPTH));
        for c in 0..3 {
            self.0[c] = w.add_mul(self.0[c], depth, rgb[c]);
        }
        self.1 = w.add(self.1, depth);
    }

    /// Colour and opacity of the mixture.
    #[inline(always)]
    fn fragment(&self, w: W) -> ([W::F; 3], W::F) {
        let inverse = w.div(w.splat(1.0), w.max(self.1, w.splat(MIN_DEPTH)));
        let [r, g, b] = self.0;
        ([w.mul(r, inverse), w.mul(g, inverse), w.mul(b, inverse)], one_minus_exp_neg(w, self.1))
    }
}

/// The sheets of a layer.
#[inline(always)]
fn sheets<'s, 'b>(slab: &'s mut Slab<'_, 'b>, layer: usize) -> &'s mut LayerSheets<'b> {
    if layer == 0 { slab.first } else { &mut slab.more[layer - 1] }
}

impl AddMedia for OverTile<Several<'_>> {
    #[inline(always)]
    fn add_sheet<W: Wide>(
        &mut self,
        w: W,
        chunks: Chunks,
        rays: &Rays,
        slab: &mut Slab,
        (which, ends): (usize, [f32; 2]),
    ) {
        let block = chunks[0].block();
        let mut mixture = OpticalSum::none(w);
        let mut any = false;
        for layer in 0..self.media.0.len() {
            let own = sheets(slab, layer);
            if !own.draws(rays, chunks[0]) || (which == 1 && !own.is_last(block)) {
                continue;
            }
            let medium = self.media.0[layer];
            let LayerOptics { classifier, modifiers, .. } = medium;
            let density = own.sheet(which).density(w, chunks);
            let sees_scan = self.see(w, chunks, rays, classifier, [density; 2]) != [false; 2];
            let only = which..which + 1;
            let sees_medium = layer == 0 && self.see_label_medium(w, chunks, rays, slab, only.clone(), modifiers);
            if !sees_scan && !sees_medium {
                continue;
            }
            any = true;
            self.read_fields(w, chunks, slab, only, modifiers, [sees_scan, sees_medium]);
            let own = sheets(slab, layer);
            let mut gradient = None;
            if sees_scan && medium.needs_gradient::<true>() {
                own.prepare_gradient(which, block);
                gradient = Some(own.sheet(which).gradient(w, chunks));
            }
            let own_rays = own.rays.as_ref().unwrap_or(rays);
            let part = SheetPart::new(w, chunks, own_rays, own, which, ends);
            let to_eye = own_rays.to_eye(w, chunks);
            let point = FieldPoint::on(&self.here[which]);
            if sees_scan {
                let mut classified = classifier.look_up(w, density);
                if let Some((by_gradient, gradient)) = modifiers.by_gradient.as_ref().zip(gradient) {
                    classified = by_gradient.classify(w, density, gradient, &point, classified);
                }
                let [r, g, b, depth] = classified;
                let depth = w.mul(depth, modifiers.scan_share(w, &point, part.missing));
                let even = self.cuts.even_share(w, chunks, own_rays, ANYWHERE, &part.matter(w, depth));
                let rgb = medium.scan_color::<W, true>(w, [r, g, b], gradient, (to_eye, even), &point);
                mixture.add(w, rgb, w.mul(depth, part.length));
            }
            if sees_medium && let Some((depth, rgb)) = modifiers.medium(w, &point) {
                let even = self.cuts.even_share(w, chunks, own_rays, ANYWHERE, &part.matter(w, depth));
                mixture.add(w, medium.label_color(w, rgb, (to_eye, even), &point), w.mul(depth, part.length));
            }
        }
        if any {
            let (from, extent) = extent(w, chunks, rays, ends);
            let (rgb, alpha) = mixture.fragment(w);
            self.so_far.add_fragment(w, chunks, rays, &Fragment { rgb, alpha, from, extent });
        }
    }

    #[inline(always)]
    fn add_slab<W: Wide>(&mut self, w: W, chunks: Chunks, rays: &Rays, slab: &mut Slab) {
        let mut parts = [OpticalSum::none(w); N_PARTS];
        // The fragment of the only medium that is visible: the usual case, in which there is nothing to mix.
        let (mut only, mut mixes) = (None, false);
        for layer in 0..self.media.0.len() {
            let own = sheets(slab, layer);
            if !own.draws(rays, chunks[0]) {
                continue;
            }
            let LayerOptics { classifier, modifiers, .. } = self.media.0[layer];
            let densities @ [front, back] = [own.front.density(w, chunks), own.back.density(w, chunks)];
            let range = [w.min(front, back), w.max(front, back)];
            let sees_scan = self.see(w, chunks, rays, classifier, range) != [false; 2];
            let sees_medium = layer == 0 && self.see_label_medium(w, chunks, rays, slab, 0..2, modifiers);
            if !sees_scan && !sees_medium {
                continue;
            }
            self.read_fields(w, chunks, slab, 0..2, modifiers, [sees_scan, sees_medium]);
            let s = slab.s;
            let own = sheets(slab, layer);
            let mut gradients = None;
            if sees_scan && self.media.0[layer].needs_gradient::<true>() {
                own.prepare_gradient(0, chunks[0].block());
                own.prepare_gradient(1, chunks[0].block());
                gradients = Some([own.front.gradient(w, chunks), own.back.gradient(w, chunks)]);
            }
            let own_rays = own.rays.as_ref().unwrap_or(rays);
            let part = SlabPart::new(w, chunks, own_rays, own, s);
            let mut cuts = [part.begin; N_CUTS];
            for (k, cut) in cuts.iter_mut().enumerate() {
                *cut = w.min(w.max(w.splat(k as f32 / N_PARTS as f32), part.begin), part.end);
            }
            (cuts[0], cuts[N_PARTS]) = (part.begin, part.end);
            let length = w.mul(w.splat(s[1] - s[0]), own_rays.thickness(w, chunks));
            let layer =
                LayerSlab { optics: self.media.0[layer], rays: own_rays, part, cuts, length, densities, gradients };
            if sees_scan {
                mixes |= only.replace(self.add_scan(w, chunks, &layer, &mut parts)).is_some();
            }
            if sees_medium {
                self.add_label_medium(w, chunks, &layer, &mut parts);
                mixes = true;
            }
        }
        if mixes {
            only = Some(mixed(w, slab.s, &parts));
        }
        if let Some(fragment) = only {
            self.so_far.add_fragment(w, chunks, rays, &fragment);
        }
    }

    #[inline(always)]
    fn add_block<S: Simd>(&mut self, s: S, block: Block, rays: &Rays, slab: &mut Slab) {
        self.add_one_by_one(s, block, rays, slab);
    }
}

impl OverTile<Several<'_>> {
    /// Adds a layer's scan to the parts of a slab. Returns its fragment if there is nothing else.
    #[inline(always)]
    fn add_scan<W: Wide>(
        &mut self,
        w: W,
        chunks: Chunks,
        layer: &LayerSlab<W>,
        parts: &mut [OpticalSum<W>; N_PARTS],
    ) -> Fragment<W> {
        let &LayerSlab { optics, ref part, cuts, densities: [front, back], gradients, .. } = layer;
        let LayerOptics { classifier, modifiers, .. } = optics;
        let joint = modifiers.by_gradient.as_ref().filter(|by_gradient| by_gradient.decides_color());
        let (PartOpacities { first, last, mut depths }, joint_rgb) = match joint.zip(gradients) {
            Some((joint, gradients)) => joint_parts(w, joint, layer.densities, gradients, &self.here, cuts),
            None => (classifier.preintegrate_parts(w, front, back, cuts), None),
        };
        // The factors at the middle of the visible range.
        let middle = w.mul(w.add(first, last), w.splat(0.5));
        let point = FieldPoint::between(&self.here, middle);
        let share = modifiers.scan_share(w, &point, part.missing_at(w, middle));
        // As if no sample were missing: the matter that a cut makes a face of.
        let mut shown_length = w.mul(layer.length, share);
        let mut length = w.mul(w.mul(layer.length, known_between(w, part.missing, middle)), share);
        if joint.is_none()
            && let Some((by_gradient, [on_front, on_back])) = modifiers.by_gradient.as_ref().zip(gradients)
        {
            let factor = by_gradient.factor(w, between(w, on_front, on_back, middle));
            (length, shown_length) = (w.mul(length, factor), w.mul(shown_length, factor));
        }
        let full_depth = w.mul(w.add(depths[0], depths[1]), shown_length);
        for depth in &mut depths {
            *depth = w.mul(*depth, length);
        }
        let (alpha, mut at) = light_alone(w, cuts, &PartOpacities { first, last, depths }, middle);
        let change = w.sub(back, front);
        let [near, far] = [w.add_mul(front, part.begin, change), w.add_mul(front, part.end, change)];
        if joint.is_none()
            && let Some(meets) = classifier.meets_opaque_end(w, near, far)
        {
            // The parts are common to all layers; the layer's own meet where its densities get opaque.
            let passage = classifier.preintegrate(w, near, far);
            let drawn = w.sub(part.end, part.begin);
            let own_length = w.mul(drawn, length);
            let depths = [w.mul(passage.depths[0], own_length), w.mul(passage.depths[1], own_length)];
            let [_, mean] = passage.light(w, depths);
            let within = w.add_mul(passage.first, mean, w.sub(passage.last, passage.first));
            at = w.select(meets, w.add_mul(part.begin, within, drawn), at);
        }
        let rgb = joint_rgb.unwrap_or_else(|| classifier.color(w, w.add_mul(front, at, change)));
        let mut gradient = None;
        if let Some([on_front, on_back]) = gradients {
            gradient = Some(between(w, on_front, on_back, at));
        }
        let begin = w.select(w.le(first, part.begin), part.from, place_between(w, part.s, first));
        let matter = part.matter(w, begin, full_depth, at);
        let even = self.cuts.even_share(w, chunks, layer.rays, ANYWHERE, &matter);
        let point = FieldPoint::between(&self.here, at);
        let to_eye = layer.rays.to_eye(w, chunks);
        let rgb = optics.scan_color::<W, true>(w, rgb, gradient, (to_eye, even), &point);
        for k in 0..N_PARTS {
            parts[k].add(w, rgb, depths[k]);
        }
        let [s_front, s_back] = part.s;
        Fragment { rgb, alpha, from: w.splat(s_front), extent: w.mul(at, w.splat(2.0 * (s_back - s_front))) }
    }

    /// Adds the label medium, which lies in the first layer, to the parts of a slab.
    #[inline(always)]
    fn add_label_medium<W: Wide>(
        &mut self,
        w: W,
        chunks: Chunks,
        layer: &LayerSlab<W>,
        parts: &mut [OpticalSum<W>; N_PARTS],
    ) {
        let LayerSlab { optics, part, cuts, .. } = layer;
        let middle = w.mul(w.add(part.begin, part.end), w.splat(0.5));
        let point = FieldPoint::between(&self.here, middle);
        let Some((depth, rgb)) = optics.modifiers.medium(w, &point) else { return };
        let whole = w.mul(w.mul(depth, w.sub(part.end, part.begin)), layer.length);
        let matter = part.matter(w, part.from, whole, middle);
        let even = self.cuts.even_share(w, chunks, layer.rays, ANYWHERE, &matter);
        let rgb = optics.label_color(w, rgb, (layer.rays.to_eye(w, chunks), even), &point);
        let length = w.mul(layer.length, known_between(w, part.missing, middle));
        for k in 0..N_PARTS {
            let share = w.sub(cuts[k + 1], cuts[k]);
            parts[k].add(w, rgb, w.mul(w.mul(depth, share), length));
        }
    }
}

/// A layer in the space between two sheets.
struct LayerSlab<'a, W: Wide> {
    optics: LayerOptics<'a>,
    /// The layer's own rays.
    rays: &'a Rays,
    /// The part of the slab that these draw.
    part: SlabPart<W>,
    /// Fractions of the slab at which its parts begin and end, within what the rays draw.
    cuts: [W::F; N_CUTS],
    /// Length of the rays between the sheets.
    length: W::F,
    /// Densities on both sheets.
    densities: [W::F; 2],
    /// Gradients on both sheets, where they are needed.
    gradients: Option<[[W::F; 3]; 2]>,
}

/// Opacity of a layer if there is no other, and the fraction of the slab that its light comes from on the mean, as in
/// [`crate::ray::over`]; `otherwise`, where it has none.
#[inline(always)]
fn light_alone<W: Wide>(w: W, cuts: [W::F; N_CUTS], layer: &PartOpacities<W>, otherwise: W::F) -> (W::F, W::F) {
    let (zero, one) = (w.splat(0.0), w.splat(1.0));
    let (mut alpha, mut moment) = (zero, zero);
    for k in 0..N_PARTS {
        let share = w.mul(w.sub(one, alpha), one_minus_exp_neg(w, layer.depths[k]));
        let [near, far] = [w.max(cuts[k], layer.first), w.min(cuts[k + 1], layer.last)];
        let mean = w.div(one, w.add_mul(w.splat(2.0), w.splat(0.75), layer.depths[k]));
        let at = w.add_mul(near, mean, w.max(w.sub(far, near), zero));
        moment = w.add_mul(moment, share, at);
        alpha = w.add(alpha, share);
    }
    (alpha, w.select(w.lt(zero, alpha), w.div(moment, alpha), otherwise))
}

/// The fragment of the parts of a slab, composited front to back, at the mean place that light comes from.
#[inline(always)]
fn mixed<W: Wide>(w: W, [s_front, s_back]: [f32; 2], parts: &[OpticalSum<W>; N_PARTS]) -> Fragment<W> {
    let (zero, one) = (w.splat(0.0), w.splat(1.0));
    let (mut rgb, mut alpha, mut moment) = ([zero; 3], zero, zero);
    for (k, part) in parts.iter().enumerate() {
        let (color, opacity) = part.fragment(w);
        let share = w.mul(w.sub(one, alpha), opacity);
        for c in 0..3 {
            rgb[c] = w.add_mul(rgb[c], share, color[c]);
        }
        alpha = w.add(alpha, share);
        moment = w.add_mul(moment, share, w.splat((k as f32 + 0.5) / N_PARTS as f32));
    }
    let inverse = w.div(one, w.max(alpha, w.splat(MIN_DEPTH)));
    for c in 0..3 {
        rgb[c] = w.mul(rgb[c], inverse);
    }
    let extent = w.mul(w.mul(w.splat(s_back - s_front), w.splat(2.0)), w.mul(moment, inverse));
    Fragment { rgb, alpha, from: w.splat(s_front), extent }
}

/// Part opacities and colour of a two-dimensional transfer function between two sheets. It has no integral over
/// density, so its values on both sheets count, linear in between.
#[inline(always)]
fn joint_parts<W: Wide>(
    w: W,
    joint: &GradientOpacity,
    [front, back]: [W::F; 2],
    [on_front, on_back]: [[W::F; 3]; 2],
    here: &[FieldValues; 2],
    cuts: [W::F; N_CUTS],
) -> (PartOpacities<W>, Option<[W::F; 3]>) {
    let unknown = [w.splat(0.0); 4];
    let [r, g, b, depth] = joint.classify(w, front, on_front, &FieldPoint::on(&here[0]), unknown);
    let [r2, g2, b2, depth2] = joint.classify(w, back, on_back, &FieldPoint::on(&here[1]), unknown);
    let mut depths = [w.splat(0.0); N_CUTS - 1];
    for k in 0..N_CUTS - 1 {
        let middle = w.mul(w.add(cuts[k], cuts[k + 1]), w.splat(0.5));
        let there = w.add_mul(depth, middle, w.sub(depth2, depth));
        depths[k] = w.mul(there, w.sub(cuts[k + 1], cuts[k]));
    }
    let share = w.div(depth2, w.max(w.add(depth, depth2), w.splat(MIN_DEPTH)));
    let parts = PartOpacities { first: cuts[0], last: cuts[N_CUTS - 1], depths };
    (parts, Some(between(w, [r, g, b], [r2, g2, b2], share)))
}
