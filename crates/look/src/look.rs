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
    /// Name of the preset.
    pub name: String,
    /// For which data it is.
    pub reason: String,
}
