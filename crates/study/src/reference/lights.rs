//! Phong's light with the reflection vector, two-sided ([`Shading`]).

use glam::DVec3;
use wavesplat_core::{Camera, Shading};
use wavesplat_splat::view::index_frame::light_direction;

/// The lights of a picture and the weights of their terms.
pub(super) struct Lights<'a> {
    shading: &'a Shading,
    /// World direction to each light, of length 1, and its colour.
    lights: Vec<(DVec3, [f64; 3])>,
}

impl<'a> Lights<'a> {
    /// The lights as a camera sees them.
    pub fn new(shading: &'a Shading, camera: &Camera) -> Self {
        let lights = shading.lights.iter().map(|l| (light_direction(camera, l), l.rgb.map(f64::from)));
        Self { shading, lights: lights.collect() }
    }

    /// A colour in even light, which falls on matter without a surface.
    pub fn even(&self, rgb: [f64; 3]) -> [f64; 3] {
        let (ambient, diffuse) = (f64::from(self.shading.ambient), f64::from(self.shading.diffuse));
        let unoriented = diffuse * f64::from(self.shading.unoriented);
        let sum = |c: usize| self.lights.iter().map(|(_, light)| light[c]).sum::<f64>();
        [0, 1, 2].map(|c| rgb[c] * (ambient + unoriented * sum(c)))
    }

    /// A colour on a surface. `normal`: of length 1, towards either side; both give the same.
    pub fn on_surface(&self, rgb: [f64; 3], normal: DVec3, to_eye: DVec3) -> [f64; 3] {
        let shading = self.shading;
        let (ambient, diffuse) = (f64::from(shading.ambient), f64::from(shading.diffuse));
        let mut out = rgb.map(|c| c * ambient);
        for (to_light, light) in &self.lights {
            let n_l = normal.dot(*to_light);
            let reflected = 2.0 * n_l * normal - *to_light;
            let highlight = reflected.dot(to_eye).max(0.0).powf(f64::from(shading.specular_power));
            for c in 0..3 {
                out[c] += light[c] * (rgb[c] * diffuse * n_l.abs() + f64::from(shading.specular) * highlight);
            }
        }
        out
    }
}
