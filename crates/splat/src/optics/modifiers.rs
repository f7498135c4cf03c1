//! Optional per-texel terms: gradient opacity, colour by a second field, ambient occlusion and shadow, labels.
//!
//! Light: the colour is multiplied by the openness of the place, and the first light's part by the share of this light
//! that gets there ([`crate::optics::occlusion`]). Labels: of the scan's optical depth the share `Σ c_l f_l` is left,
//! its colour is mixed with the colour of the labels that tint it, and labels with an opacity of their own add the
//! medium `Σ c_l τ_l`, with `c_l` the coverage of label `l` ([`crate::optics::labels`]).

use wavesplat_compute::simd::Wide;

use crate::optics::field_color::FieldColor;
use crate::optics::gradient_opacity::GradientOpacity;
use crate::optics::labels::LabelFields;
use crate::optics::occlusion::LightFields;
use crate::optics::shade::Shader;
use crate::sheet::field_sheets::FieldPoint;

/// Optional terms of a layer; none as a rule.
#[derive(Clone, Default)]
pub struct Modifiers {
    /// Gradient opacity, or a transfer function of two dimensions.
    pub by_gradient: Option<GradientOpacity>,
    /// Field that gives the layer its colours.
    pub color: Option<FieldColor>,
    /// Fields that hold light, with their strengths.
    pub light: Option<LightFields>,
    /// Fields that hold the effects of labels.
    pub labels: Option<LabelFields>,
    /// Shader of the label medium, where the picture is shaded.
    pub label_shader: Option<Shader>,
}

/// Optical depth below which colours do not matter; keeps divisions finite.
const LEAST: f32 = 1e-20;

impl Modifiers {
    /// Whether there is any term.
    pub fn any(&self) -> bool {
        self.by_gradient.is_some() || self.color.is_some() || self.light.is_some() || self.labels.is_some()
    }

    /// The field of the label medium's optical depth.
    #[inline(always)]
    pub fn label_medium_field(&self) -> Option<usize> {
        self.labels.as_ref().and_then(|labels| labels.medium)
    }

    /// Fields for the scan, if `scan`, and for the label medium beside its optical depth, if `medium`.
    #[inline(always)]
    pub fn fields(&self, scan: bool, medium: bool) -> impl Iterator<Item = usize> + use<> {
        let labels = self.labels.unwrap_or_default();
        let four = |first: Option<usize>| first.map_or(0..0, |first| first..first + 4);
        let light = self.light.map(|light| [light.openness, light.shadow]).unwrap_or_default();
        let light = light.into_iter().flatten().map(|(field, _)| field);
        let color = self.color.as_ref().map(|color| color.field);
        let of_scan = labels.scan.into_iter().chain(four(labels.tint)).chain(color).filter(move |_| scan);
        light.chain(of_scan).chain(four(labels.medium).skip(1).filter(move |_| medium))
    }

    /// Share of the scan's optical depth that labels leave.
    #[inline(always)]
    fn left_by_labels<W: Wide>(&self, w: W, point: &FieldPoint<W>) -> W::F {
        match self.labels.as_ref().and_then(|labels| labels.scan) {
            Some(field) => point.value(w, field),
            None => w.splat(1.0),
        }
    }

    /// Share of the scan's optical depth that labels leave, where the field that colours it is known. `own_missing`: the
    /// missing share of the scan's own samples.
    #[inline(always)]
    pub fn scan_share<W: Wide>(&self, w: W, point: &FieldPoint<W>, own_missing: Option<W::F>) -> W::F {
        let left = self.left_by_labels(w, point);
        match &self.color {
            Some(color) => w.mul(left, color.known_factor(w, point, own_missing)),
            None => left,
        }
    }

    /// The scan's colour before tint and light: from the field that colours it, or `own`, by its density.
    #[inline(always)]
    pub fn rgb<W: Wide>(&self, w: W, own: [W::F; 3], point: &FieldPoint<W>) -> [W::F; 3] {
        match &self.color {
            // A function of two fields has given it already.
            Some(color) if !self.by_gradient.as_ref().is_some_and(GradientOpacity::decides_color) => {
                color.rgb(w, point)
            }
            _ => own,
        }
    }

    /// The scan's colour with the tint of labels.
    #[inline(always)]
    pub fn tint<W: Wide>(&self, w: W, rgb: [W::F; 3], point: &FieldPoint<W>) -> [W::F; 3] {
        let Some(labels) = &self.labels else { return rgb };
        let Some(tint) = labels.tint else { return rgb };
        // Tints relative to the share of the scan that labels leave.
        let of_scan = w.div(w.splat(1.0), w.max(self.left_by_labels(w, point), w.splat(LEAST)));
        let kept = w.sub(w.splat(1.0), w.mul(point.value(w, tint), of_scan));
        let mut tinted = rgb;
        for c in 0..3 {
            tinted[c] = w.add_mul(w.mul(rgb[c], kept), point.value(w, tint + 1 + c), of_scan);
        }
        tinted
    }

    /// Optical depth and colour of the label medium.
    #[inline(always)]
    pub fn medium<W: Wide>(&self, w: W, point: &FieldPoint<W>) -> Option<(W::F, [W::F; 3])> {
        let field = self.label_medium_field()?;
        let depth = w.max(point.value(w, field), w.splat(0.0));
        let inverse = w.div(w.splat(1.0), w.max(depth, w.splat(LEAST)));
        let mut color = [inverse; 3];
        for c in 0..3 {
            color[c] = w.mul(point.value(w, field + 1 + c), inverse);
        }
        Some((depth, color))
    }

    /// Factors of all light, and of the first light.
    #[inline(always)]
    pub fn light<W: Wide>(&self, w: W, point: &FieldPoint<W>) -> [Option<W::F>; 2] {
        let Some(light) = &self.light else { return [None; 2] };
        [factor(w, light.openness, point), factor(w, light.shadow, point)]
    }
}

/// Factor of light by a field: 1 less `strength` times the share of light that is blocked.
#[inline(always)]
fn factor<W: Wide>(w: W, term: Option<(usize, f32)>, point: &FieldPoint<W>) -> Option<W::F> {
    let (field, strength) = term?;
    let blocked = w.sub(w.splat(1.0), point.value(w, field));
    Some(w.max(w.sub(w.splat(1.0), w.mul(w.splat(strength), blocked)), w.splat(0.0)))
}
