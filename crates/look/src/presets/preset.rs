//! A preset of ours: its fields, and the look that it makes over a volume's values.

use wavesplat_core::{ColorNode, Composite, Error, GradientNode, OpacityNode, Result, TransferFunction};

use crate::colors::Rgb;
use crate::look::{LightSettings, Look, light_of};
use crate::scale::{Scale, Span};

/// Thickness of the slab that opacities are for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OpacityUnit {
    /// The geometric mean of the volume's spacings.
    Voxel,
    /// World units.
    World(f64),
    /// Share of the longest side of the volume's box.
    Share(f64),
}

/// A preset of ours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preset {
    /// Its name.
    pub name: &'static str,
    /// Kind of data that it is for, one of [`GROUPS`](crate::presets::GROUPS).
    pub kind: &'static str,
    /// For which data it is.
    pub description: &'static str,
    /// Scale of its values.
    pub scale: Scale,
    /// Thickness that its opacities are for.
    pub opacity_unit: OpacityUnit,
    /// Values and opacities.
    pub opacity: &'static [(f64, f64)],
    /// Values and colours.
    pub color: &'static [(f64, Rgb)],
    /// Magnitudes of the gradient and factors of the extinction.
    pub gradient_opacity: &'static [(f64, f64)],
    /// Settings of [`Shading`](wavesplat_core::Shading) that differ from its default, by name; `None` draws the colours as given.
    pub shading: Option<LightSettings>,
    /// Operator along a ray.
    pub composite: Composite,
    /// Whether it is made for a white background.
    pub is_on_white: bool,
    /// Whether the brain alone is drawn with it, by an extraction that this crate has not.
    pub is_of_brain: bool,
}

/// A preset without light, on any background, whose opacities are for a voxel.
pub(super) const NO_LIGHT: Preset = Preset {
    name: "",
    kind: "any",
    description: "",
    scale: Scale::Fraction,
    opacity_unit: OpacityUnit::Voxel,
    opacity: &[],
    color: &[],
    gradient_opacity: &[],
    shading: None,
    composite: Composite::Over,
    is_on_white: false,
    is_of_brain: false,
};

impl Preset {
    /// Its look; `span`: the values of a volume, which relative scales and units need.
    pub fn look(&self, span: Option<Span>) -> Result<Look> {
        let is_relative = !self.scale.is_absolute() || matches!(self.opacity_unit, OpacityUnit::Share(_));
        if is_relative && span.is_none() {
            let mend = "pass the values of your volume to `Look::preset_over`";
            return Err(Error::out_of_range(format!("preset {:?}", self.name), self.scale.name(), "absolute", mend));
        }
        let span = span.unwrap_or(Span { low: 0.0, high: 1.0, longest_side: 1.0 });
        if is_relative && !(span.low < span.high && (self.scale != Scale::Log || span.low > 0.0)) {
            let mend = "pass the values that count as the volume's smallest and largest";
            let found = format!("{} to {}", span.low, span.high);
            return Err(Error::out_of_range(format!("preset {:?}: the span", self.name), found, "growing", mend));
        }
        let pairs = |nodes: &[(f64, f64)]| nodes.iter().map(|&(value, part)| [value, part]).collect::<Vec<_>>();
        let opacity = self.scale.placed(&pairs(self.opacity), span.low, span.high);
        let colors: Vec<_> = self.color.iter().map(|&(value, [r, g, b])| [value, r, g, b]).collect();
        let colors = self.scale.placed(&colors, span.low, span.high);
        let gradients = self.scale.widened(&pairs(self.gradient_opacity), span.low, span.high);
        let unit = match self.opacity_unit {
            OpacityUnit::Voxel => None,
            OpacityUnit::World(unit) => Some(unit),
            OpacityUnit::Share(share) => Some(share * span.longest_side),
        };
        Ok(Look {
            transfer_function: function(&opacity, &colors, unit, &gradients)?,
            shading: self.shading.map(light_of),
            composite: self.composite,
            background: self.is_on_white.then_some([1.0; 4]),
            view: None,
            is_cut_open: false,
            name: self.name.to_owned(),
            reason: self.description.to_owned(),
        })
    }
}

/// A transfer function of nodes as rows: value and opacity; value, red, green, blue; magnitude and factor.
pub(super) fn function(
    opacity: &[[f64; 2]],
    color: &[[f64; 4]],
    unit: Option<f64>,
    gradients: &[[f64; 2]],
) -> Result<TransferFunction> {
    let opacity = opacity.iter().map(|&[value, opacity]| OpacityNode { value, opacity }).collect();
    let color = color.iter().map(|&[value, r, g, b]| ColorNode { value, rgb: [r, g, b] }).collect();
    let gradients = gradients.iter().map(|&[magnitude, factor]| GradientNode { magnitude, factor }).collect();
    TransferFunction::new(opacity, color, unit)?.with_gradient_opacity(gradients)
}
