//! The way a volume is shown: transfer function, light, operator and background, as plain data.

use wavesplat_core::{Composite, Shading, TransferFunction};

/// A transfer function with the light, the operator and the background that it is made for.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    /// Colours and opacities of the values.
    pub transfer_function: TransferFunction,
    /// Light; `None` draws the colours as given.
    pub shading: Option<Shading>,
    /// Operator along a ray.
    pub composite: Composite,
    /// Straight colour and opacity behind the volume; `None` leaves it open.
    pub background: Option<[f32; 4]>,
    /// Name of the view that it is made for; `None` is the view that suits the volume.
    pub view: Option<&'static str>,
    /// Whether the corner nearest to the eye is left out, so that planes through the middle are seen.
    pub is_cut_open: bool,
    /// Name of the preset, or "auto".
    pub name: String,
    /// For which data it is.
    pub reason: String,
}

/// Settings of light that differ from the default, by name.
pub type LightSettings = &'static [(&'static str, f64)];

/// The light of settings.
pub(crate) fn light_of(settings: LightSettings) -> Shading {
    let mut shading = Shading::default();
    for &(name, value) in settings {
        let value = value as f32;
        match name {
            "ambient" => shading.ambient = value,
            "diffuse" => shading.diffuse = value,
            "specular" => shading.specular = value,
            "ambient_occlusion" => shading.ambient_occlusion = value,
            _ => unreachable!("a test makes the light of every preset"),
        }
    }
    shading
}
