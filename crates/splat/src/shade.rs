//! Phong shading with the reflection vector, two-sided, as VTK's volume mappers have it.
//!
//! `colour · (ambient + Σ diffuse · |n·l| · light) + Σ specular · max(0, r·v)^power · light`, with the normal `n` along
//! the world gradient, `l` to the light, `v` to the eye and `r = 2 (n·l) n − l`. Two-sided: `r` is the same for `n`
//! and `−n`, so only the diffuse term needs the magnitude. Where the gradient vanishes only the ambient term is left.
//! The world gradient is the index-space difference times the inverse transpose of `world_from_index`.

use glam::{DMat3, DVec3};
use wavesplat_core::{Camera, LightFrame, Shading};

use crate::base_plane::Family;

/// Lights and coefficients with everything turned into world space and f32.
#[derive(Clone, Debug)]
pub struct Shader {
    ambient: f32,
    diffuse: f32,
    specular: f32,
    specular_power: f32,
    lights: Vec<WorldLight>,
    /// World gradient from the index gradient along u, v, w; columns.
    world_from_gradient: [[f32; 3]; 3],
    /// Squared world gradients below this are rounding noise.
    vanishing: f32,
}

#[derive(Clone, Copy, Debug)]
struct WorldLight {
    to_light: [f32; 3],
    rgb: [f32; 3],
}

/// Densities are f32 sums of a few products: differences below this share of their magnitude are rounding.
const GRADIENT_NOISE: f64 = 4e-6;

/// Squared world gradient that counts as none: `GRADIENT_NOISE` of the largest density per mean voxel.
pub fn vanishing_gradient_squared(world_from_index: DMat3, range: [f32; 2]) -> f64 {
    let magnitude = f64::from(range[0].abs().max(range[1].abs()));
    let per_world = world_from_index.determinant().abs().cbrt().recip();
    (GRADIENT_NOISE * magnitude * per_world).powi(2).max(1e-36)
}

impl Shader {
    /// `range` bounds the densities.
    pub fn new(shading: &Shading, camera: &Camera, world_from_index: DMat3, family: &Family, range: [f32; 2]) -> Self {
        let gradient = world_from_index.inverse().transpose();
        let lights = shading
            .lights
            .iter()
            .map(|light| WorldLight { to_light: light_direction(camera, light).as_vec3().to_array(), rgb: light.rgb });
        Self {
            ambient: shading.ambient,
            diffuse: shading.diffuse,
            specular: shading.specular,
            specular_power: shading.specular_power,
            lights: lights.collect(),
            world_from_gradient: family.axes.map(|a| gradient.col(a).as_vec3().to_array()),
            vanishing: vanishing_gradient_squared(world_from_index, range) as f32,
        }
    }

    /// Shades `N` texels. `gradient`: per index along u, v, w; `to_eye`: unit world vectors.
    #[inline(always)]
    pub fn shade<const N: usize>(&self, rgb: &mut [[f32; N]; 3], gradient: &[[f32; N]; 3], to_eye: &[[f32; N]; 3]) {
        let [cu, cv, cw] = &self.world_from_gradient;
        let mut normal = [[0.0_f32; N]; 3];
        for i in 0..N {
            let [gu, gv, gw] = [gradient[0][i], gradient[1][i], gradient[2][i]];
            let gx = cu[0] * gu + cv[0] * gv + cw[0] * gw;
            let gy = cu[1] * gu + cv[1] * gv + cw[1] * gw;
            let gz = cu[2] * gu + cv[2] * gv + cw[2] * gw;
            let squared = gx * gx + gy * gy + gz * gz;
            let inverse = if squared > self.vanishing { 1.0 / squared.sqrt() } else { 0.0 };
            normal[0][i] = gx * inverse;
            normal[1][i] = gy * inverse;
            normal[2][i] = gz * inverse;
        }
        let mut lit = [[self.ambient; N]; 3];
        let mut highlight = [[0.0_f32; N]; 3];
        for light in &self.lights {
            let [lx, ly, lz] = light.to_light;
            let mut diffuse = [0.0_f32; N];
            let mut specular = [0.0_f32; N];
            for i in 0..N {
                let [nx, ny, nz] = [normal[0][i], normal[1][i], normal[2][i]];
                let [vx, vy, vz] = [to_eye[0][i], to_eye[1][i], to_eye[2][i]];
                let n_l = nx * lx + ny * ly + nz * lz;
                let n_v = nx * vx + ny * vy + nz * vz;
                let l_v = lx * vx + ly * vy + lz * vz;
                diffuse[i] = self.diffuse * n_l.abs();
                // Without a normal there is no reflection: r·v would be −l·v.
                let exists = nx * nx + ny * ny + nz * nz > 0.0;
                specular[i] = if exists { (2.0 * n_l * n_v - l_v).max(0.0) } else { 0.0 };
            }
            raise(&mut specular, self.specular_power);
            for c in 0..3 {
                for i in 0..N {
                    lit[c][i] += diffuse[i] * light.rgb[c];
                    highlight[c][i] += self.specular * specular[i] * light.rgb[c];
                }
            }
        }
        for c in 0..3 {
            for i in 0..N {
                rgb[c][i] = rgb[c][i] * lit[c][i] + highlight[c][i];
            }
        }
    }
}

/// World direction to a light, unit length.
pub fn light_direction(camera: &Camera, light: &wavesplat_core::Light) -> DVec3 {
    let to_light = light.to_light.normalize();
    match light.frame {
        LightFrame::World => to_light,
        LightFrame::Camera => to_light.x * camera.right() + to_light.y * camera.up() - to_light.z * camera.forward(),
    }
}

/// Raises numbers of `0..=1` to one power: repeated squaring where it is a whole number, the library's power else.
#[inline(always)]
fn raise<const N: usize>(x: &mut [f32; N], power: f32) {
    if power.fract() != 0.0 {
        for x in x {
            *x = x.powf(power);
        }
        return;
    }
    let mut remaining = power as u32;
    let mut result = [1.0_f32; N];
    while remaining > 0 {
        if remaining & 1 == 1 {
            for i in 0..N {
                result[i] *= x[i];
            }
        }
        remaining >>= 1;
        for x in x.iter_mut() {
            *x *= *x;
        }
    }
    *x = result;
}

#[cfg(test)]
mod tests {
    use super::*;
    use wavesplat_core::{Light, Projection};

    fn shade_one(shading: &Shading, gradient: [f32; 3], to_eye: [f32; 3]) -> [f32; 3] {
        let projection = Projection::Orthographic { parallel_scale: 1.0 };
        let camera = Camera::new(DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO, DVec3::Y, projection).unwrap();
        let family = Family::of(camera.forward());
        let shader = Shader::new(shading, &camera, DMat3::IDENTITY, &family, [0.0, 255.0]);
        let mut rgb = [[0.5_f32; 1]; 3];
        shader.shade(&mut rgb, &gradient.map(|g| [g]), &to_eye.map(|v| [v]));
        rgb.map(|c| c[0])
    }

    #[test]
    fn phong_at_known_angles() {
        let shading = Shading::default();
        let facing = shade_one(&shading, [0.0, 0.0, -8.0], [0.0, 0.0, 1.0]);
        assert!((facing[0] - (0.5 * 0.8 + 0.2)).abs() < 1e-6, "{facing:?}");
        let turned_away = shade_one(&shading, [0.0, 0.0, 8.0], [0.0, 0.0, 1.0]);
        assert_eq!(facing, turned_away, "two-sided");
        let grazing = shade_one(&shading, [3.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
        assert!((grazing[0] - 0.05).abs() < 1e-6, "{grazing:?}");
        // At 30 degrees: diffuse cos 30, specular cos(60)^10.
        let (s, c) = 30.0_f32.to_radians().sin_cos();
        let oblique = shade_one(&shading, [s, 0.0, c], [0.0, 0.0, 1.0]);
        assert!((oblique[0] - (0.5 * (0.1 + 0.7 * c) + 0.2 * 0.5_f32.powi(10))).abs() < 1e-6, "{oblique:?}");
    }

    #[test]
    fn a_vanishing_gradient_leaves_the_ambient_term() {
        for gradient in [[0.0; 3], [1e-9, 0.0, 0.0]] {
            assert_eq!(shade_one(&Shading::default(), gradient, [0.0, 0.0, 1.0]), [0.05; 3]);
        }
    }

    #[test]
    fn world_lights_have_their_colour_and_powers_may_be_fractions() {
        let light = Light { frame: LightFrame::World, to_light: DVec3::new(2.0, 0.0, 0.0), rgb: [1.0, 0.5, 0.0] };
        let shading = Shading { lights: vec![light], specular_power: 2.5, ..Shading::default() };
        let got = shade_one(&shading, [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
        for (got, want) in got.iter().zip([0.4, 0.225, 0.05]) {
            assert!((got - want).abs() < 1e-6, "{got} for {want}");
        }
    }
}
