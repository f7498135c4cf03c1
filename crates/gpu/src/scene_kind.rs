//! The shader that a plan needs, and the scenes that only the CPU draws.

use wavesplat_core::{Composite, Gradient};
use wavesplat_splat::kernel::footprint::Axis;
use wavesplat_splat::kernel::weights::{n_taps, reach};
use wavesplat_splat::optics::shade::Shader;
use wavesplat_splat::render::plan::{Operator, Plan};
use wavesplat_splat::source::slices::Slices;

use crate::failure::{Failure, GpuResult};
use crate::permutation::{
    ByGradient, FieldKinds, Format, GpuOperator, GpuProjection, GradientTaps, LayerKind, Permutation, SourceKind,
};
use crate::samples::Apron;

/// Samples of a source.
pub(crate) struct SourceSamples<'a> {
    /// One, or four on the same grid that are stored side by side.
    pub slices: Vec<&'a Slices<'a>>,
    /// Gradient that is needed of the first.
    pub gradient: Option<Gradient>,
    /// Index of the first among the plan's fields; `None` for a layer.
    pub field: Option<usize>,
}

impl<'a> SourceSamples<'a> {
    /// The first of its slices.
    pub fn first(&self) -> &'a Slices<'a> {
        self.slices[0]
    }
}

/// Sources of a plan: its layers, then its fields; the four fields of a tint or label medium make one source.
pub(crate) fn sources_of<'a>(plan: &'a Plan, slices: &[&'a Slices<'a>]) -> Vec<SourceSamples<'a>> {
    let of_layer = |(k, slices): (usize, &&'a Slices<'a>)| SourceSamples {
        slices: vec![*slices],
        gradient: plan.families.first().and_then(|family| family.layers[k].gradient),
        field: None,
    };
    let mut sources: Vec<SourceSamples> = slices.iter().enumerate().map(of_layer).collect();
    let labels = plan.fields.labels.unwrap_or_default();
    let fields = &plan.fields.fields;
    let mut field = 0;
    while field < fields.len() {
        let n = if [labels.tint, labels.medium].contains(&Some(field)) { 4 } else { 1 };
        sources.push(SourceSamples {
            slices: fields[field..field + n].iter().map(|field| &field.slices).collect(),
            gradient: fields[field].gradient,
            field: Some(field),
        });
        field += n;
    }
    sources
}

/// Permutation of a plan. `gather`: whether the device fetches four samples at once.
pub(crate) fn permutation_of(plan: &Plan, slices: &[&Slices], gather: bool) -> GpuResult<Permutation> {
    if slices.iter().any(|slices| slices.is_surveyed()) {
        return Err(Failure::DrawnByCpu("lazy volumes are drawn by the CPU".to_owned()));
    }
    if plan.layers.iter().any(|layer| layer.color.is_some()) {
        return Err(Failure::DrawnByCpu("layers that another field colours are drawn by the CPU".to_owned()));
    }
    if plan.shapes.is_some() {
        return Err(Failure::DrawnByCpu("scenes with surfaces, lines or points are drawn by the CPU".to_owned()));
    }
    if slices.iter().any(|slices| slices.must_load()) {
        return Err(Failure::DrawnByCpu("a level that is decoded block by block is drawn by the CPU".to_owned()));
    }
    let family = plan.families.first().ok_or_else(|| Failure::DrawnByCpu("nothing is in view".to_owned()))?;
    let operator = match plan.operator {
        Operator::Over { pre_integrated, .. } => GpuOperator::Over { pre_integrated },
        Operator::FirstHit { .. } => GpuOperator::FirstHit,
        Operator::LocalMaximum { .. } => GpuOperator::Project(GpuProjection::LocalMaximum),
        Operator::Project { composite, .. } => GpuOperator::Project(match composite {
            Composite::Maximum => GpuProjection::Maximum,
            Composite::Minimum => GpuProjection::Minimum,
            Composite::DepthShadedMaximum { .. } => GpuProjection::DepthShaded,
            Composite::AttenuatedMaximum { .. } => GpuProjection::Attenuated,
            Composite::XRay { .. } => GpuProjection::XRay,
            _ => GpuProjection::Integral,
        }),
    };
    let layers = family.layers.iter().map(|layer| LayerKind {
        is_shaded: layer.shader.is_some(),
        evens_cuts: layer.shader.as_ref().is_some_and(Shader::evens_cuts),
        by_gradient: match &layer.modifiers.by_gradient {
            None => ByGradient::Nothing,
            Some(by_gradient) if by_gradient.decides_color() => ByGradient::Both,
            Some(_) => ByGradient::Factor,
        },
    });
    let sources = sources_of(plan, slices);
    // Index among the sources of fields.
    let place = |field: Option<usize>| {
        let of_fields = || sources.iter().filter_map(|source| source.field);
        field.and_then(|field| of_fields().position(|own| own == field))
    };
    let mut fields = FieldKinds::default();
    if let Some(light) = plan.fields.light {
        fields.openness = place(light.openness.map(|(field, _)| field));
        fields.shadow = place(light.shadow.map(|(field, _)| field));
    }
    if let Some(labels) = plan.fields.labels {
        (fields.scan, fields.tint, fields.medium) = (place(labels.scan), place(labels.tint), place(labels.medium));
        fields.label_medium_is_shaded = family.layers[0].modifiers.label_shader.is_some();
    }
    let sources = sources.iter().map(|source| SourceKind {
        kernel: source.first().kernel(),
        format: if source.slices.len() > 1 { Format::Four } else { Format::of(source.first()) },
        gradient: gradient_taps(source.first(), source.gradient),
        has_holes: source.first().has_mask(),
    });
    Ok(Permutation {
        operator,
        layers: layers.collect(),
        sources: sources.collect(),
        fields,
        gather,
        with_depth: plan.with_depth,
        counted: false,
    })
}

fn gradient_taps(slices: &Slices, gradient: Option<Gradient>) -> GradientTaps {
    let axis = Axis { kernel: slices.kernel(), n_samples: 2, gradient };
    match gradient {
        None => GradientTaps::Nothing,
        Some(Gradient::Difference(_)) => GradientTaps::Difference,
        Some(Gradient::Smoothed(_)) => {
            GradientTaps::Smoothed { n: axis.n_gradient_taps(), before: reach(axis.kernel) + axis.gradient_margin() }
        }
    }
}

/// Apron of a source: the samples that reconstruction reaches beyond the sample below a position, and no less than
/// default shading needs, so that a change of shading finds the samples uploaded.
pub(crate) fn apron_of(source: &SourceKind) -> Apron {
    let before = reach(source.kernel);
    // Quads are read two by two.
    let after = if n_taps(source.kernel) > 2 { 4 - before } else { 1 };
    let (low, high) = match source.gradient {
        GradientTaps::Smoothed { n, before } => (before, n.next_multiple_of(2) - before),
        _ => (before, after),
    };
    Apron { low: low.max(before).max(2), high: high.max(after).max(4) }
}
