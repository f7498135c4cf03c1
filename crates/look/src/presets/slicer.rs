//! Presets of 3D Slicer: its points and its light.
//!
//! Opacities are for one world unit, as VTK's `ScalarOpacityUnitDistance` is 1 where Slicer leaves it. VTK's magnitudes
//! of the gradient are per mean of the three spacings. The light is one white headlight, or none; colours above our
//! usual shoulder are compressed.

use wavesplat_core::{Composite, Result, Shading};

use super::preset::function;
use crate::colors::Rgb;
use crate::look::Look;

/// A preset of 3D Slicer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlicerPreset {
    /// Slicer's name for it.
    pub name: &'static str,
    /// Whether it is shaded.
    pub is_lit: bool,
    /// Weight of ambient light.
    pub ambient: f64,
    /// Weight of the diffuse term.
    pub diffuse: f64,
    /// Weight of the specular term.
    pub specular: f64,
    /// Exponent of the specular term.
    pub specular_power: f64,
    /// Values and opacities.
    pub opacity: &'static [(f64, f64)],
    /// Values and colours.
    pub color: &'static [(f64, Rgb)],
    /// Magnitudes of the gradient, per mean spacing, and factors of the extinction.
    pub gradient_opacity: &'static [(f64, f64)],
}

impl SlicerPreset {
    /// Whether its values are Hounsfield units.
    pub fn is_hounsfield(&self) -> bool {
        self.name.starts_with("CT-")
    }

    /// Its look. `spacing`: mean spacing of the volume's samples.
    pub fn look(&self, spacing: f64) -> Result<Look> {
        let gradients = self.gradient_opacity.iter().map(|&(magnitude, factor)| [magnitude.max(0.0) / spacing, factor]);
        let mut gradients: Vec<_> = gradients.collect();
        // Where the factor is 1 for all, gradients need not be looked at.
        if !gradients.iter().any(|&[magnitude, factor]| magnitude > 0.0 && factor != 1.0) {
            gradients.clear();
        }
        let opacity: Vec<_> = self.opacity.iter().map(|&(value, opacity)| [value, opacity]).collect();
        let color: Vec<_> = self.color.iter().map(|&(value, [r, g, b])| [value, r, g, b]).collect();
        let light = Shading {
            ambient: self.ambient as f32,
            diffuse: self.diffuse as f32,
            specular: self.specular as f32,
            specular_power: self.specular_power.max(1.0) as f32,
            shoulder: Shading::default().shoulder,
            ..Shading::headlight()
        };
        Ok(Look {
            transfer_function: function(&opacity, &color, Some(1.0), &gradients)?,
            shading: self.is_lit.then_some(light),
            composite: Composite::Over,
            background: None,
            view: None,
            is_cut_open: false,
            name: self.name.to_owned(),
            reason: format!("3D Slicer's {}.", self.name),
        })
    }
}
