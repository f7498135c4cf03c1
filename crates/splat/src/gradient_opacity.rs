//! Gradient opacity: a factor of the optical depth by the magnitude of the gradient, so that boundaries stand out and
//! what is homogeneous recedes (Levoy, *Display of surfaces from volume data*, 1988; the curve is that of VTK's volume
//! properties and of 3D Slicer).
//!
//! The factor scales the extinction, not the opacity of a slab, so that the picture does not depend on the number of
//! sheets: opacity `α` per unit becomes `1 − (1 − α)^f`, which for faint functions is `f · α`.

use glam::DMat3;
use wavesplat_compute::simd::Wide;
use wavesplat_core::TransferFunction;

use crate::base_plane::Family;
use crate::classify::Entry;
use crate::shade::Metric;

/// Entries of the table.
const N_ENTRIES: usize = 4096;

/// A squared gradient below which the magnitude counts as 0.
const LEAST: f32 = 1e-36;

/// The curve tabulated over the magnitude of the world gradient of densities.
pub struct GradientOpacity {
    metric: Metric,
    table: Vec<Entry>,
    per_magnitude: f32,
}

impl GradientOpacity {
    /// `None` where the function has no such curve. `density_scale`: densities per sample unit.
    pub fn new(tf: &TransferFunction, world_from_index: DMat3, family: &Family, density_scale: f64) -> Option<Self> {
        // Constant beyond the last node; a curve of one node at 0 is constant everywhere.
        let last = tf.gradient_nodes().last()?.magnitude;
        let step = last.max(f64::MIN_POSITIVE) / (N_ENTRIES - 1) as f64;
        let entry = |i: usize| [tf.gradient_factor(i as f64 * step) as f32, 0.0, 0.0, 0.0];
        // One entry more, so that the last cell has an upper end at its very end.
        let table = (0..N_ENTRIES).chain([N_ENTRIES - 1]).map(entry).collect();
        let per_magnitude = if last > 0.0 { (1.0 / (step * density_scale)) as f32 } else { 0.0 };
        Some(Self { metric: Metric::new(world_from_index, family), table, per_magnitude })
    }

    /// The factor for index gradients along u, v, w.
    #[inline(always)]
    pub fn factor<W: Wide>(&self, w: W, gradient: [W::F; 3]) -> W::F {
        let squared = w.max(self.metric.squared(w, gradient), w.splat(LEAST));
        let magnitude = w.mul(squared, w.rsqrt(squared));
        let [factor, _, _, _] = w.look_up(&self.table, w.mul(magnitude, w.splat(self.per_magnitude)));
        factor
    }
}
