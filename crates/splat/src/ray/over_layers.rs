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

use crate::optics::classify::{Classifier, one_minus_exp_neg};
use crate::optics::gradient_opacity::GradientOpacity;
use crate::optics::modifiers::Modifiers;
use crate::optics::preintegrate::{N_CUTS, PartOpacities};
use crate::optics::shade::Shader;
use crate::ray::accumulator::{Accumulator, Chunks, Fragment, between, extent, lit};
use crate::ray::compositor::ChunkSurfaces;
use crate::ray::compositor::{Compositor, Slab, Texels};
use crate::ray::cut_faces::{CutFaces, Matter, most_missing, place_between};
use crate::ray::state::TileState;
use crate::sheet::field_sheets::{FieldPoint, FieldValues};
use crate::sheet::layer_sheets::LayerSheets;
use crate::sheet::tile_layout::{Block, Chunk};
use crate::sheet::tile_rays::Rays;
use crate::source::nonfinite::{known_between, known_share};

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

/// Emission and absorption of several layers.
pub struct OverLayers<'a> {
    media: Vec<LayerOptics<'a>>,
    /// Field values on the front and the back sheet, at the chunks that were read last.
    here: [FieldValues; 2],
    /// Whether slabs are pre-integrated.
    needs_preintegration: bool,
    so_far: Accumulator,
    cuts: CutFaces,
}

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

impl<'a> OverLayers<'a> {
    /// Continues from `state`; `None`: nothing is drawn yet. `opaque`: opacity from which a ray is done. `with_depth`:
    /// whether `s_half` is wanted.
    pub fn new(
        media: Vec<LayerOptics<'a>>,
        needs_preintegration: bool,
        opaque: f32,
        with_depth: bool,
        mut state: Option<TileState>,
    ) -> Self {
        Self {
            cuts: CutFaces::new(media.iter().map(|medium| medium.shader), state.as_mut()),
            media,
            here: Default::default(),
            needs_preintegration,
            so_far: Accumulator::new(opaque, with_depth, state),
        }
    }

    /// Whether a live ray of any chunk can see a medium at a density from `lo` to `hi`.
    #[inline(always)]
    fn see<W: Wide>(&self, w: W, chunks: Chunks, rays: &Rays, medium: &LayerOptics, [lo, hi]: [W::F; 2]) -> bool {
        let [least, most] = medium.classifier.visible_range();
        let visible = w.and(w.le(w.splat(least), hi), w.le(lo, w.splat(most)));
        self.so_far.see_where(w, chunks, rays, visible) != [false; 2]
    }

    /// Reads the fields that a layer's medium needs on a sheet.
    #[inline(always)]
    fn read_fields<W: Wide>(&mut self, w: W, chunks: Chunks, slab: &mut Slab, which: usize, layer: usize) {
        let from = (slab.field_geometries, slab.field_panels);
        for field in self.media[layer].modifiers.fields(true, false) {
            slab.fields[which].read(w, from, field, chunks, &mut self.here[which]);
        }
    }

    /// Whether any live ray can see the label medium on a sheet. Reads its optical depth.
    #[inline(always)]
    fn see_label_medium<W: Wide>(&mut self, w: W, chunks: Chunks, rays: &Rays, slab: &mut Slab, which: usize) -> bool {
        let Some(field) = self.media[0].modifiers.label_medium_field() else { return false };
        let from = (slab.field_geometries, slab.field_panels);
        slab.fields[which].read(w, from, field, chunks, &mut self.here[which]);
        let depth = self.here[which].value(w, field);
        self.so_far.see_where(w, chunks, rays, w.lt(w.splat(0.0), depth)) != [false; 2]
    }

    /// Reads the label medium's other fields, and its gradient if shaded, after [`OverLayers::see_label_medium`].
    #[inline(always)]
    fn read_label_medium<W: Wide>(&mut self, w: W, chunks: Chunks, slab: &mut Slab, which: usize) {
        let modifiers = self.media[0].modifiers;
        let from = (slab.field_geometries, slab.field_panels);
        for field in modifiers.fields(false, true) {
            slab.fields[which].read(w, from, field, chunks, &mut self.here[which]);
        }
        if let (Some(field), true) = (modifiers.label_medium_field(), modifiers.label_shader.is_some()) {
            slab.fields[which].read_gradient(w, from, field, chunks, &mut self.here[which]);
        }
    }

    #[inline(always)]
    fn add_sheet_outlined<S: Simd>(
        &mut self,
        s: S,
        chunks: Chunks,
        rays: &Rays,
        slab: &mut Slab,
        which: (usize, [f32; 2]),
    ) {
        s.outlined(
            #[inline(always)]
            || self.add_sheet(s, chunks, rays, slab, which),
        );
    }

    /// Composites the front (0) or back (1) sheet of every layer as a slab of constant density between two positions.
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
        for layer in 0..self.media.len() {
            let own = sheets(slab, layer);
            if !own.has(block) || (which == 1 && !own.is_last(block)) {
                continue;
            }
            let own_rays = own.rays.as_ref().unwrap_or(rays);
            if own_rays.draws_nothing(chunks[0]) {
                continue;
            }
            let medium = self.media[layer];
            let density = own.sheet(which).density(w, chunks);
            let is_seen = self.see(w, chunks, rays, &medium, [density; 2]);
            let (from, length) = extent(w, chunks, own_rays, ends);
            let has_mask = own.geometry.slices.has_mask();
            let missing = if has_mask { Some(own.sheet(which).missing(w, chunks)) } else { None };
            let (begin, extent, at) = (from, length, w.add_mul(from, w.splat(0.5), length));
            let (thickness, to_eye) = (own_rays.thickness(w, chunks), own_rays.to_eye(w, chunks));
            let full_length = w.mul(length, thickness);
            let mut length = full_length;
            if let Some(missing) = missing {
                length = w.mul(length, known_share(w, missing));
            }
            if is_seen {
                let mut gradient = None;
                if medium.shader.is_some() || medium.modifiers.by_gradient.is_some() {
                    own.prepare_gradient(which, block);
                    gradient = Some(own.sheet(which).gradient(w, chunks));
                }
                self.read_fields(w, chunks, slab, which, layer);
                let point = FieldPoint::on(&self.here[which]);
                let mut classified = medium.classifier.look_up(w, density);
                if let Some((by_gradient, gradient)) = medium.modifiers.by_gradient.as_ref().zip(gradient) {
                    classified = by_gradient.classify(w, density, gradient, &point, classified);
                }
                let [r, g, b, depth] = classified;
                let depth = w.mul(depth, medium.modifiers.scan_share(w, &point, missing));
                let own_rays = sheets(slab, layer).rays.as_ref().unwrap_or(rays);
                let matter = Matter { begin, extent, depth: w.mul(depth, full_length), at, missing };
                let even = self.cuts.even_share(w, chunks, own_rays, ANYWHERE, &matter);
                let rgb = shaded(w, &medium, [r, g, b], gradient, (to_eye, even), &point);
                mixture.add(w, rgb, w.mul(depth, length));
                any = true;
            }
            if layer == 0 && self.see_label_medium(w, chunks, rays, slab, which) {
                self.read_label_medium(w, chunks, slab, which);
                let point = FieldPoint::on(&self.here[which]);
                if let Some((depth, rgb)) = medium.modifiers.medium(w, &point) {
                    let own_rays = sheets(slab, layer).rays.as_ref().unwrap_or(rays);
                    let matter = Matter { begin, extent, depth: w.mul(depth, full_length), at, missing };
                    let even = self.cuts.even_share(w, chunks, own_rays, ANYWHERE, &matter);
                    mixture.add(w, label_color(w, &medium, rgb, (to_eye, even), &point), w.mul(depth, length));
                    any = true;
                }
            }
        }
        if any {
            let (from, extent) = extent(w, chunks, rays, ends);
            let (rgb, alpha) = mixture.fragment(w);
            self.so_far.add_fragment(w, chunks, rays, &Fragment { rgb, alpha, from, extent });
        }
    }

    /// Composites the space between two sheets with densities that are linear in between.
    #[inline(always)]
    fn add_slab<W: Wide>(&mut self, w: W, chunks: Chunks, rays: &Rays, slab: &mut Slab) {
        const N_PARTS: usize = N_CUTS - 1;
        let block = chunks[0].block();
        let [s_front, s_back] = slab.s;
        let (way, per_s) = (w.splat(s_back - s_front), w.splat(1.0 / (s_back - s_front)));
        let (zero, one) = (w.splat(0.0), w.splat(1.0));
        let mut parts = [OpticalSum::none(w); N_PARTS];
        // The fragment of the only medium that is visible: the usual case, in which there is nothing to mix.
        let (mut only, mut mixes) = (None, false);
        for layer in 0..self.media.len() {
            let own = sheets(slab, layer);
            if !own.has(block) {
                continue;
            }
            let own_rays = own.rays.as_ref().unwrap_or(rays);
            if own_rays.draws_nothing(chunks[0]) {
                continue;
            }
            let medium = self.media[layer];
            let (front, back) = (own.front.density(w, chunks), own.back.density(w, chunks));
            let is_seen = self.see(w, chunks, rays, &medium, [w.min(front, back), w.max(front, back)]);
            let (from, extent) = extent(w, chunks, own_rays, [s_front, s_back]);
            let (thickness, to_eye) = (own_rays.thickness(w, chunks), own_rays.to_eye(w, chunks));
            let mut missing = None;
            if own.geometry.slices.has_mask() {
                missing = Some([own.front.missing(w, chunks), own.back.missing(w, chunks)]);
            }
            // Fractions of the slab at which the layer's drawn part begins and ends, and the cuts in between.
            let begin = w.mul(w.sub(from, w.splat(s_front)), per_s);
            let end = w.add_mul(begin, extent, per_s);
            let mut cuts = [begin; N_CUTS];
            for (k, cut) in cuts.iter_mut().enumerate() {
                *cut = w.min(w.max(w.splat(k as f32 / N_PARTS as f32), begin), end);
            }
            (cuts[0], cuts[N_PARTS]) = (begin, end);
            let length = w.mul(way, thickness);
            let ends = [s_front, s_back];
            let most_missing = most_missing(w, missing);
            if is_seen {
                let mut gradients = None;
                if medium.shader.is_some() || medium.modifiers.by_gradient.is_some() {
                    own.prepare_gradient(0, block);
                    own.prepare_gradient(1, block);
                    gradients = Some([own.front.gradient(w, chunks), own.back.gradient(w, chunks)]);
                }
                for which in 0..2 {
                    self.read_fields(w, chunks, slab, which, layer);
                }
                let half = w.splat(0.5);
                let joint = medium.modifiers.by_gradient.as_ref().filter(|by_gradient| by_gradient.decides_color());
                let (PartOpacities { first, last, mut depths }, joint_rgb) = match joint.zip(gradients) {
                    Some((joint, gradients)) => joint_parts(w, joint, [front, back], gradients, &self.here, cuts),
                    None => (medium.classifier.preintegrate_parts(w, front, back, cuts), None),
                };
                // The factors at the middle of the visible range.
                let middle = w.mul(w.add(first, last), half);
                // As if no sample were missing: the matter that a cut makes a face of.
                let missing_there = missing.map(|[front, back]| w.add_mul(front, middle, w.sub(back, front)));
                let share = medium.modifiers.scan_share(w, &FieldPoint::between(&self.here, middle), missing_there);
                let mut shown_length = w.mul(length, share);
                let mut length = w.mul(length, known_between(w, missing, middle));
                length = w.mul(length, share);
                if let (None, Some((by_gradient, [g_front, g_back]))) =
                    (joint, medium.modifiers.by_gradient.as_ref().zip(gradients))
                {
                    let factor = by_gradient.factor(w, between(w, g_front, g_back, middle));
                    (length, shown_length) = (w.mul(length, factor), w.mul(shown_length, factor));
                }
                let full_depth = w.mul(w.add(depths[0], depths[1]), shown_length);
                // The mean place that the layer's own light comes from, as in [`crate::ray::over`].
                let (mut alpha, mut moment) = (zero, zero);
                for k in 0..N_PARTS {
                    depths[k] = w.mul(depths[k], length);
                    let share = w.mul(w.sub(one, alpha), one_minus_exp_neg(w, depths[k]));
                    let [near, far] = [w.max(cuts[k], first), w.min(cuts[k + 1], last)];
                    let mean = w.div(one, w.add_mul(w.splat(2.0), w.splat(0.75), depths[k]));
                    let at = w.add_mul(near, mean, w.max(w.sub(far, near), zero));
                    moment = w.add_mul(moment, share, at);
                    alpha = w.add(alpha, share);
                }
                let mut at = w.select(w.lt(zero, alpha), w.div(moment, alpha), middle);
                let change = w.sub(back, front);
                let [own_front, own_back] = [w.add_mul(front, begin, change), w.add_mul(front, end, change)];
                if joint.is_none()
                    && let Some(meets) = medium.classifier.meets_opaque_end(w, own_front, own_back)
                {
                    // The parts are those of all layers; the layer's own meet where its densities get opaque.
                    let passage = medium.classifier.preintegrate(w, own_front, own_back);
                    let drawn = w.sub(end, begin);
                    let own_length = w.mul(drawn, length);
                    let depths = [w.mul(passage.depths[0], own_length), w.mul(passage.depths[1], own_length)];
                    let [_, mean] = passage.light(w, depths);
                    let within = w.add_mul(passage.first, mean, w.sub(passage.last, passage.first));
                    at = w.select(meets, w.add_mul(begin, within, drawn), at);
                }
                let rgb =
                    joint_rgb.unwrap_or_else(|| medium.classifier.color(w, w.add_mul(front, at, w.sub(back, front))));
                let gradient = gradients.map(|[front, back]| between(w, front, back, at));
                let own_rays = sheets(slab, layer).rays.as_ref().unwrap_or(rays);
                let visible = w.select(w.le(first, begin), from, place_between(w, ends, first));
                let matter = Matter {
                    begin: visible,
                    extent,
                    depth: full_depth,
                    at: place_between(w, ends, at),
                    missing: most_missing,
                };
                let even = self.cuts.even_share(w, chunks, own_rays, ANYWHERE, &matter);
                let point = FieldPoint::between(&self.here, at);
                let rgb = shaded(w, &medium, rgb, gradient, (to_eye, even), &point);
                for k in 0..N_PARTS {
                    parts[k].add(w, rgb, depths[k]);
                }
                let extent = w.mul(at, w.splat(2.0 * (s_back - s_front)));
                mixes |= only.replace(Fragment { rgb, alpha, from: w.splat(s_front), extent }).is_some();
            }
            if layer == 0 {
                let on_front = self.see_label_medium(w, chunks, rays, slab, 0);
                let on_back = self.see_label_medium(w, chunks, rays, slab, 1);
                if on_front || on_back {
                    for which in 0..2 {
                        self.read_label_medium(w, chunks, slab, which);
                    }
                    let middle = w.mul(w.add(begin, end), w.splat(0.5));
                    let point = FieldPoint::between(&self.here, middle);
                    let full_length = length;
                    let length = w.mul(length, known_between(w, missing, middle));
                    if let Some((depth, rgb)) = medium.modifiers.medium(w, &point) {
                        let own_rays = sheets(slab, layer).rays.as_ref().unwrap_or(rays);
                        let part = w.mul(w.mul(depth, w.sub(end, begin)), full_length);
                        let matter = Matter {
                            begin: from,
                            extent,
                            depth: part,
                            at: place_between(w, ends, middle),
                            missing: most_missing,
                        };
                        let even = self.cuts.even_share(w, chunks, own_rays, ANYWHERE, &matter);
                        let rgb = label_color(w, &medium, rgb, (to_eye, even), &point);
                        for k in 0..N_PARTS {
                            let share = w.sub(cuts[k + 1], cuts[k]);
                            parts[k].add(w, rgb, w.mul(w.mul(depth, share), length));
                        }
                        mixes = true;
                    }
                }
            }
        }
        if !mixes {
            if let Some(only) = only {
                self.so_far.add_fragment(w, chunks, rays, &only);
            }
            return;
        }
        // Composites the parts front to back, and finds the mean place that light comes from.
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
        let extent = w.mul(w.mul(way, w.splat(2.0)), w.mul(moment, inverse));
        let from = w.splat(s_front);
        self.so_far.add_fragment(w, chunks, rays, &Fragment { rgb, alpha, from, extent });
    }
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

/// A medium's colour, tinted and lit at a point.
#[inline(always)]
fn shaded<W: Wide>(
    w: W,
    medium: &LayerOptics,
    rgb: [W::F; 3],
    gradient: Option<[W::F; 3]>,
    (to_eye, even): ([W::F; 3], Option<W::F>),
    point: &FieldPoint<W>,
) -> [W::F; 3] {
    let rgb = medium.modifiers.tint(w, medium.modifiers.rgb(w, rgb, point), point);
    lit(w, rgb, medium.shader.zip(gradient), to_eye, medium.modifiers.light(w, point), even)
}

/// Colour of the label medium, lit at a point.
#[inline(always)]
fn label_color<W: Wide>(
    w: W,
    medium: &LayerOptics,
    rgb: [W::F; 3],
    (to_eye, even): ([W::F; 3], Option<W::F>),
    point: &FieldPoint<W>,
) -> [W::F; 3] {
    let shader = medium.modifiers.label_shader.as_ref().map(|shader| (shader, point.gradient(w)));
    lit(w, rgb, shader, to_eye, medium.modifiers.light(w, point), even)
}

impl Compositor for OverLayers<'_> {
    const TAKES_SURFACES: bool = true;

    #[inline(always)]
    fn covered(&self, block: Block, slab: &Slab) -> [f32; 2] {
        let is_last = slab.first.is_last(block) || slab.more.iter().any(|own| own.is_last(block));
        if self.needs_preintegration { slab.s } else { slab.covered_by_sheets(is_last) }
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
        let chunks = [chunk; 2];
        if self.needs_preintegration {
            return s.outlined(
                #[inline(always)]
                || self.add_slab(s, chunks, rays, slab),
            );
        }
        let [s_front, s_back] = slab.s;
        let half = 0.5 * (s_back - s_front);
        self.add_sheet_outlined(s, chunks, rays, slab, (0, [s_front - half, s_front + half]));
        let block = chunk.block();
        if slab.first.is_last(block) || slab.more.iter().any(|own| own.is_last(block)) {
            // No slab of a layer follows whose front this sheet would be.
            self.add_sheet_outlined(s, chunks, rays, slab, (1, [s_back - half, s_back]));
        }
    }

    fn finish(&self, chunk: Chunk) -> Texels {
        self.so_far.finish(chunk)
    }

    fn into_state(self) -> TileState {
        TileState { entries: self.cuts.into_entries(), ..self.so_far.into_state() }
    }
}
