//! Which shader a plan needs, and what the CPU alone draws.

use wavesplat_core::{Composite, Gradient};
use wavesplat_splat::kernel::footprint::Axis;
use wavesplat_splat::kernel::weights::{n_taps, reach};
use wavesplat_splat::render::plan::{Operator, Plan};
use wavesplat_splat::source::slices::Slices;

use crate::failure::{Failure, GpuResult};
use crate::permutation::{
    ByGradient, FieldKinds, Format, GpuOperator, GpuProjection, GradientTaps, LayerKind, Permutation, SourceKind,
};
use crate::samples::Apron;

/// The samples of a plan: of its layers, then of its fields, each with the gradient that is wanted of it.
pub(crate) fn sources_of<'a>(plan: &'a Plan, slices: &[&'a Slices<'a>]) -> Vec<(&'a Slices<'a>, Option<Gradient>)> {
    let of_layers = slices.iter().enumerate().map(|(k, slices)| {
        let gradient = plan.families.first().and_then(|family| family.layers[k].gradient);
        (*slices, gradient)
    });
    let of_fields = plan.fields.fields.iter().map(|field| (&field.slices, field.gradient));
    of_layers.chain(of_fields).collect()
}

/// The shader of a plan. `gather`: whether the device fetches four samples at once.
pub(crate) fn permutation_of(plan: &Plan, slices: &[&Slices], gather: bool) -> GpuResult<Permutation> {
    if slices.iter().any(|slices| slices.is_surveyed()) {
        return Err(Failure::NotOnGpu("lazy volumes are drawn by the CPU".to_owned()));
    }
    if slices.iter().any(|slices| slices.must_load()) {
        return Err(Failure::NotOnGpu("a level that is decoded block by block is drawn by the CPU".to_owned()));
    }
    let family = plan.families.first().ok_or_else(|| Failure::NotOnGpu("nothing is in view".to_owned()))?;
    let operator = match plan.operator {
        Operator::Over { pre_integrated, .. } => GpuOperator::Over { pre_integrated },
        Operator::FirstHit { .. } => GpuOperator::FirstHit,
        Operator::LocalMaximum { .. } => GpuOperator::Project(GpuProjection::LocalMaximum),
        Operator::Project { composite, .. } => GpuOperator::Project(match composite {
            Composite::Maximum => GpuProjection::Maximum,
            Composite::Minimum => GpuProjection::Minimum,
            Composite::DepthShadedMaximum { .. } => GpuProjection::DepthShaded,
            Composite::XRay { .. } => GpuProjection::XRay,
            _ => GpuProjection::Integral,
        }),
    };
    let layers = family.layers.iter().map(|layer| LayerKind {
        is_shaded: layer.shader.is_some(),
        by_gradient: match &layer.modifiers.by_gradient {
            None => ByGradient::Nothing,
            Some(by_gradient) if by_gradient.decides_color() => ByGradient::Both,
            Some(_) => ByGradient::Factor,
        },
    });
    let sources = sources_of(plan, slices).into_iter().map(|(slices, gradient)| SourceKind {
        kernel: slices.kernel(),
        format: Format::of(slices),
        gradient: gradient_taps(slices, gradient),
        has_holes: slices.has_mask(),
        page_side: None,
    });
    let mut fields = FieldKinds::default();
    if let Some(light) = plan.fields.light {
        fields.openness = light.openness.map(|(field, _)| field);
        fields.shadow = light.shadow.map(|(field, _)| field);
    }
    if let Some(labels) = plan.fields.labels {
        (fields.scan, fields.tint, fields.matter) = (labels.scan, labels.tint, labels.matter);
        fields.matter_is_shaded = family.layers[0].modifiers.label_shader.is_some();
    }
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

/// Samples that reconstruction reaches beyond the sample below a position, at least what the usual light needs, so that
/// other lights find the samples there.
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
