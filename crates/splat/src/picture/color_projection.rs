//! Colours of projections (maximum, mean, X-ray, ...): one look-up of the transfer function per pixel, after the warp.

use wavesplat_core::{Composite, Grid, TransferFunction};

/// Turns density and coverage into values and colours: one look-up per pixel, after the warp.
pub fn color_projection(rgba: &mut [[f32; 4]], grid: &Grid, tf: &TransferFunction, composite: Composite) -> Vec<f32> {
    let (offset, scale) = grid.density_from_sample();
    let mut color = |pixel: &mut [f32; 4]| {
        let coverage = f64::from(pixel[3]);
        if coverage <= 0.0 {
            *pixel = [0.0; 4];
            return f32::NAN;
        }
        let density = f64::from(pixel[0]) / coverage;
        // A sum of densities lacks the offset once per unit of length.
        let length = if composite == Composite::Sum { f64::from(pixel[1]) / coverage } else { 1.0 };
        let value = match composite {
            // The offset cancels in differences from the clear value.
            Composite::XRay { attenuation, .. } => (-attenuation * density / scale).exp(),
            _ => density / scale + offset * length,
        };
        let [r, g, b] = tf.color(value);
        let opacity = tf.opacity(value) * coverage;
        *pixel = [r * opacity, g * opacity, b * opacity, opacity].map(|c| c as f32);
        value as f32
    };
    rgba.iter_mut().map(&mut color).collect()
}
