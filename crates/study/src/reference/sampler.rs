//! Colour and opacity of one sample of a ray, exact: shared by the ray caster and the literal splatters.

use glam::{DMat3, DVec3};
use wavesplat_core::{Camera, Gradient, Kernel, Shading, TransferFunction, Volume};
use wavesplat_splat::kernel::smoothed;
use wavesplat_splat::kernel::weights::{MAX_DIFFERENCE_TAPS, mirror_index};
use wavesplat_splat::optics::shade::vanishing_gradient_squared;
use wavesplat_splat::ray::cut_faces::{PER_SLICE, REACH};
use wavesplat_splat::source::nonfinite::MIN_KNOWN;
use wavesplat_splat::source::slices::Slices;

use super::lights::Lights;
use super::reached_samples::for_each_tap;

/// The samples, tables and lights that classification and shading of one volume need.
pub struct Sampler<'a> {
    pub(super) slices: &'a Slices<'a>,
    size: [usize; 3],
    pub(super) tf: &'a TransferFunction,
    pub(super) density_map: (f64, f64),
    shading: Option<&'a Shading>,
    lights: Option<Lights<'a>>,
    gradient_from_index: DMat3,
    pub(super) vanishing: f64,
    opacity_unit: f64,
}

impl<'a> Sampler<'a> {
    /// Collects what classification and shading need.
    pub fn new(
        volume: &Volume,
        slices: &'a Slices<'a>,
        tf: &'a TransferFunction,
        camera: &Camera,
        shading: Option<&'a Shading>,
    ) -> Self {
        let matrix = volume.grid().world_from_index().matrix3;
        Self {
            slices,
            size: volume.grid().size(),
            tf,
            density_map: volume.grid().density_from_sample(),
            shading,
            lights: shading.map(|shading| Lights::new(shading, camera)),
            gradient_from_index: matrix.inverse().transpose(),
            vanishing: vanishing_gradient_squared(matrix, slices.range()),
            opacity_unit: tf.opacity_unit().unwrap_or_else(|| volume.grid().default_opacity_unit()),
        }
    }

    /// Density at an index position, clamped to the volume; missing samples have the values that they were filled with.
    pub fn density(&self, position: DVec3) -> f64 {
        let mut sum = 0.0;
        for_each_tap(self.slices.kernel(), self.size, position, |at, weight| sum += weight * self.slices.at(at));
        sum
    }

    /// Value at an index position, in sample units; see [`Sampler::density`].
    pub(super) fn value(&self, position: DVec3) -> f64 {
        let (offset, scale) = self.density_map;
        self.density(position) / scale + offset
    }

    /// The missing share at an index position: the weight that the linear kernel gives to missing samples there,
    /// whatever the kernel of the densities ([`wavesplat_splat::source::nonfinite`]).
    pub fn missing(&self, position: DVec3) -> f64 {
        let mut sum = 0.0;
        if self.slices.has_mask() {
            for_each_tap(Kernel::Linear, self.size, position, |at, weight| {
                sum += if self.slices.is_hole(at) { weight } else { 0.0 };
            });
        }
        sum
    }

    /// Known share at an index position: 1 less the missing share, or 0 where that is below `MIN_KNOWN`.
    pub fn known(&self, position: DVec3) -> f64 {
        let known = 1.0 - self.missing(position);
        if known < f64::from(MIN_KNOWN) { 0.0 } else { known }
    }

    /// Index-space gradient; differences stop at the faces, and holes count as filled.
    pub(super) fn gradient(&self, position: DVec3) -> DVec3 {
        let offset = match self.gradient_spec() {
            Gradient::Difference(offset) => offset,
            Gradient::Smoothed(deviation) => return self.smoothed_gradient(position, deviation),
        };
        let mut gradient = DVec3::ZERO;
        for axis in 0..3 {
            let mut ends = [position; 2];
            ends[0][axis] = position[axis] - offset;
            ends[1][axis] = position[axis] + offset;
            let [lo, hi] = ends.map(|p| self.density(p));
            gradient[axis] = (hi - lo) / (2.0 * offset);
        }
        gradient
    }

    /// The derivative of the samples smoothed by a B-spline.
    fn smoothed_gradient(&self, position: DVec3, deviation: f64) -> DVec3 {
        let kernel = self.slices.kernel();
        let taps = [0, 1, 2].map(|a| {
            let last = (self.size[a] - 1) as f64;
            let (first, weights) = smoothed::taps(kernel, position[a].clamp(0.0, last), deviation);
            let sample = |t: usize| mirror_index(kernel, first + t as i64, self.size[a]);
            (0..MAX_DIFFERENCE_TAPS)
                .filter(|t| weights[0][*t] != 0.0)
                .map(|t| (sample(t), [weights[0][t], weights[1][t]]))
                .collect::<Vec<_>>()
        });
        let [along_x, along_y, along_z] = &taps;
        let mut gradient = DVec3::ZERO;
        for (z, [value_z, slope_z]) in along_z {
            for (y, [value_y, slope_y]) in along_y {
                let [mut value, mut slope] = [0.0; 2];
                for (x, [value_x, slope_x]) in along_x {
                    let density = self.slices.at([*x, *y, *z]);
                    value += value_x * density;
                    slope += slope_x * density;
                }
                gradient.x += slope * value_y * value_z;
                gradient.y += value * slope_y * value_z;
                gradient.z += value * value_y * slope_z;
            }
        }
        gradient
    }

    /// Optical depth per `opacity_unit` of a density and an index-space gradient; infinite for opacity 1.
    pub fn optical_depth(&self, density: f64, index_gradient: DVec3) -> f64 {
        let (offset, scale) = self.density_map;
        self.tf.optical_depth(density / scale + offset, self.magnitude(index_gradient))
    }

    /// Magnitude of the gradient, sample units per world unit.
    fn magnitude(&self, index_gradient: DVec3) -> f64 {
        let (_, scale) = self.density_map;
        (self.gradient_from_index * index_gradient).length() / scale
    }

    /// Whether a density can be seen whatever its gradient.
    pub(crate) fn may_be_seen(&self, density: f64) -> bool {
        let (offset, scale) = self.density_map;
        self.tf.opacity(density / scale + offset) > 0.0
    }

    /// Whether the gradient matters: for the optical depth, the colour, or light.
    pub fn needs_gradient(&self) -> bool {
        self.tf.has_gradient() || self.shading.is_some()
    }

    /// Estimator of the gradient.
    pub fn gradient_spec(&self) -> Gradient {
        self.shading.map_or_else(|| Shading::default().gradient, |s| s.gradient)
    }

    /// Unassociated colour of a density and an index-space gradient, without light.
    pub fn unshaded(&self, density: f64, index_gradient: DVec3) -> [f64; 3] {
        let (offset, scale) = self.density_map;
        self.tf.color_at(density / scale + offset, self.magnitude(index_gradient))
    }

    /// Unassociated colour of a density and an index-space gradient, shaded with it. Cut faces have no even light: the
    /// literal splatters are the method as published.
    pub fn shade(&self, density: f64, index_gradient: DVec3, to_eye: DVec3) -> [f64; 3] {
        self.light(self.unshaded(density, index_gradient), index_gradient, to_eye, self.vanishing, 0.0)
    }

    /// Share of even light at a place so far behind the entry of its ray, in slices: cut faces are no surfaces, and
    /// show their values in even light.
    pub fn even_share(&self, behind_entry: f64) -> f64 {
        let share = (f64::from(PER_SLICE) * (f64::from(REACH) - behind_entry)).clamp(0.0, 1.0);
        share * self.shading.map_or(0.0, |shading| f64::from(shading.even_cuts))
    }

    /// A colour shaded with an index-space gradient, which counts as none where its square in the world is at most
    /// `vanishing`. `even`: share of even light, which falls on matter without a gradient.
    pub(super) fn light(
        &self,
        rgb: [f64; 3],
        index_gradient: DVec3,
        to_eye: DVec3,
        vanishing: f64,
        even: f64,
    ) -> [f64; 3] {
        let Some(lights) = &self.lights else { return rgb };
        let gradient = self.gradient_from_index * index_gradient;
        let in_even_light = lights.even(rgb);
        if gradient.length_squared() <= vanishing {
            return in_even_light;
        }
        let out = lights.on_surface(rgb, gradient.normalize(), to_eye);
        [0, 1, 2].map(|c| out[c] + even * (in_even_light[c] - out[c]))
    }

    /// The thickness that opacities belong to.
    pub fn opacity_unit(&self) -> f64 {
        self.opacity_unit
    }
}
