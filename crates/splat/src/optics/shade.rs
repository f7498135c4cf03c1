//! Phong shading with the reflection vector, two-sided.
//!
//! `colour · (ambient + Σ diffuse · |n·l| · light) + Σ specular · max(0, r·v)^power · light`, with the normal `n` along
//! the world gradient, `l` to the light, `v` to the eye and `r = 2 (n·l) n − l`. Two-sided: `r` is the same for `n` and
//! `−n`, so only the diffuse term needs the magnitude. Where the gradient vanishes, `|n·l|` is a parameter of the
//! shading, 0 with the headlight of other renderers, and there is no highlight.

use glam::DMat3;
use wavesplat_compute::simd::{LANES, Simd, Wide};
use wavesplat_core::{Camera, Projection, Shading};

use crate::view::family::Family;
use crate::view::index_frame::{light_direction, world_gradient_from_index};

/// Coefficients of `|world gradient|² = Σ metric · products of the index gradient`: uu, vv, ww, 2uv, 2uw, 2vw.
#[derive(Clone, Copy, Debug)]
pub struct Metric([f32; 6]);

impl Metric {
    /// The metric of index gradients along u, v, w.
    pub fn new(world_from_index: DMat3, family: &Family) -> Self {
        let on_gradient = world_gradient_from_index(world_from_index, family);
        let metric = on_gradient.transpose() * on_gradient;
        let twice = |a: usize, b: usize| 2.0 * metric.col(a)[b];
        let [uu, vv, ww] = [metric.x_axis.x, metric.y_axis.y, metric.z_axis.z];
        Self([uu, vv, ww, twice(0, 1), twice(0, 2), twice(1, 2)].map(|m| m as f32))
    }

    /// The coefficients of uu, vv, ww, uv, uw, vw.
    pub fn numbers(&self) -> [f32; 6] {
        self.0
    }

    /// Squared magnitude of the world gradient.
    #[inline(always)]
    pub fn squared<S: Wide>(&self, s: S, gradient: [S::F; 3]) -> S::F {
        let [gu, gv, gw] = gradient;
        let [uu, vv, ww, uv, uw, vw] = self.0;
        let squared = s.mul(gu, dot(s, [uu, uv, uw], gradient));
        let squared = s.add_mul(squared, gv, s.add(s.mul(s.splat(vv), gv), s.mul(s.splat(vw), gw)));
        s.add_mul(squared, s.mul(s.splat(ww), gw), gw)
    }
}

/// Lights and coefficients, converted to world space and f32.
#[derive(Clone, Debug)]
pub struct Shader {
    ambient: f32,
    diffuse: f32,
    specular: f32,
    specular_power: f32,
    lights: Vec<WorldLight>,
    /// Whether all lights are the same for all colours.
    is_grey: bool,
    /// `|n · l|` where there is no normal.
    unoriented: f32,
    /// Share of even light on cut faces ([`Shading::even_cuts`]), and factors of the colour in it.
    even_cuts: f32,
    even_light: [f32; 3],
    metric: Metric,
    /// Squared world gradients below this are rounding noise.
    vanishing: f32,
}

#[derive(Clone, Copy, Debug)]
struct WorldLight {
    /// The light's direction as a form on index gradients: `n · l`.
    on_gradient: [f32; 3],
    /// The light's direction as a form on view directions, which are forms on gradients themselves: `v · l`.
    on_view: [f32; 3],
    rgb: [f32; 3],
    /// Whether all rays run along the light.
    is_at_eye: bool,
}

/// Relative rounding of differences: densities are f32 sums of a few products.
const GRADIENT_NOISE: f64 = 4e-6;

/// Factors of a colour in even light, as [`Shader::shade`] gives them to matter without a gradient.
pub fn even_light(shading: &Shading) -> [f32; 3] {
    [0, 1, 2].map(|c| {
        let sum: f32 = shading.lights.iter().map(|light| light.rgb[c]).sum();
        shading.ambient + shading.diffuse * shading.unoriented * sum
    })
}

/// Squared world gradient that counts as 0: `GRADIENT_NOISE` of the largest density per mean voxel.
pub fn vanishing_gradient_squared(world_from_index: DMat3, range: [f32; 2]) -> f64 {
    let magnitude = f64::from(range[0].abs().max(range[1].abs()));
    let per_world = world_from_index.determinant().abs().cbrt().recip();
    (GRADIENT_NOISE * magnitude * per_world).powi(2).max(1e-36)
}

/// Lights and coefficients as plain numbers, for other backends.
#[derive(Clone, Debug)]
pub struct ShaderNumbers {
    /// Weights of the colour without light, under light, and of the highlight.
    pub ambient_diffuse_specular: [f32; 3],
    /// Exponent of the highlight.
    pub specular_power: f32,
    /// `|n · l|` where there is no normal.
    pub unoriented: f32,
    /// Share of even light on cut faces.
    pub even_cuts: f32,
    /// Squared world gradients from which on there is a normal.
    pub vanishing: f32,
    /// Coefficients of the squared world gradient ([`Metric::numbers`]).
    pub metric: [f32; 6],
    /// The lights.
    pub lights: Vec<LightNumbers>,
}

/// A light as plain numbers.
#[derive(Clone, Copy, Debug)]
pub struct LightNumbers {
    /// The light's direction as a form on index gradients along u, v, w.
    pub on_gradient: [f32; 3],
    /// The light's direction as a form on view directions, which are forms on gradients themselves.
    pub on_view: [f32; 3],
    /// Colour of the light.
    pub rgb: [f32; 3],
    /// Whether all rays run along the light.
    pub is_at_eye: bool,
}

impl Shader {
    /// The lights and coefficients as plain numbers.
    pub fn numbers(&self) -> ShaderNumbers {
        let light = |light: &WorldLight| {
            let WorldLight { on_gradient, on_view, rgb, is_at_eye } = *light;
            LightNumbers { on_gradient, on_view, rgb, is_at_eye }
        };
        ShaderNumbers {
            ambient_diffuse_specular: [self.ambient, self.diffuse, self.specular],
            specular_power: self.specular_power,
            unoriented: self.unoriented,
            even_cuts: self.even_cuts,
            vanishing: self.vanishing,
            metric: self.metric.numbers(),
            lights: self.lights.iter().map(light).collect(),
        }
    }

    /// Converts a shading for a camera and a slice family. `range` bounds the densities.
    pub fn new(shading: &Shading, camera: &Camera, world_from_index: DMat3, family: &Family, range: [f32; 2]) -> Self {
        let on_gradient = world_gradient_from_index(world_from_index, family);
        let is_parallel = matches!(camera.projection(), Projection::Orthographic { .. });
        let lights = shading.lights.iter().map(|light| {
            let to_light = light_direction(camera, light);
            WorldLight {
                on_gradient: (on_gradient.transpose() * to_light).as_vec3().to_array(),
                on_view: (on_gradient.inverse() * to_light).as_vec3().to_array(),
                rgb: light.rgb,
                is_at_eye: is_parallel && (to_light + camera.forward()).length() < 1e-9,
            }
        });
        Self {
            ambient: shading.ambient,
            diffuse: shading.diffuse,
            specular: shading.specular,
            specular_power: shading.specular_power,
            lights: lights.collect(),
            is_grey: shading.lights.iter().all(|light| light.rgb == [light.rgb[0]; 3]),
            unoriented: shading.unoriented,
            even_cuts: shading.even_cuts,
            even_light: even_light(shading),
            metric: Metric::new(world_from_index, family),
            vanishing: vanishing_gradient_squared(world_from_index, range) as f32,
        }
    }

    /// Shades colours. `gradient`: per index along u, v, w; `to_eye`: unit world vectors towards the eye, as a form on
    /// gradients ([`world_gradient_from_index`]).
    #[inline(always)]
    pub fn shade<S: Wide>(&self, s: S, rgb: [S::F; 3], gradient: [S::F; 3], to_eye: [S::F; 3]) -> [S::F; 3] {
        let normal = self.normal(s, gradient, to_eye);
        if !self.is_grey {
            return self.sum_lights(s, rgb, gradient, to_eye, normal, None);
        }
        let (mut lit, mut highlight) = (s.splat(self.ambient), s.splat(0.0));
        for light in &self.lights {
            let (diffuse, specular) = self.terms(s, light, gradient, to_eye, normal);
            lit = s.add_mul(lit, diffuse, s.splat(light.rgb[0]));
            highlight = s.add_mul(highlight, specular, s.splat(light.rgb[0]));
        }
        // No closure: it would not be inlined into the vectors' own code.
        let mut shaded = rgb;
        for c in 0..3 {
            shaded[c] = s.add(s.mul(rgb[c], lit), highlight);
        }
        shaded
    }

    /// Like [`Shader::shade`], with only a share of the first light.
    #[inline(always)]
    pub fn shade_in_shadow<S: Wide>(
        &self,
        s: S,
        rgb: [S::F; 3],
        gradient: [S::F; 3],
        to_eye: [S::F; 3],
        share: S::F,
    ) -> [S::F; 3] {
        self.sum_lights(s, rgb, gradient, to_eye, self.normal(s, gradient, to_eye), Some(share))
    }

    /// Mixes a lit colour with the same colour in even light, which no normal, occlusion or shadow changes. `share`: of
    /// even light, where [`Shading::even_cuts`] is 1.
    #[inline(always)]
    pub fn evened<S: Wide>(&self, s: S, rgb: [S::F; 3], lit: [S::F; 3], share: S::F) -> [S::F; 3] {
        let share = s.mul(share, s.splat(self.even_cuts));
        let mut mixed = lit;
        for c in 0..3 {
            let even = s.mul(rgb[c], s.splat(self.even_light[c]));
            mixed[c] = s.add_mul(lit[c], share, s.sub(even, lit[c]));
        }
        mixed
    }

    /// Lights cut faces by their gradients, as [`Shading::even_cuts`] of 0 does.
    pub fn light_cuts_by_gradients(&mut self) {
        self.even_cuts = 0.0;
    }

    /// Whether cut faces have any even light.
    #[inline(always)]
    pub fn evens_cuts(&self) -> bool {
        self.even_cuts > 0.0
    }

    /// Whether there is a normal, the inverse magnitude of the gradient, and `n · v`.
    #[inline(always)]
    fn normal<S: Wide>(&self, s: S, gradient: [S::F; 3], to_eye: [S::F; 3]) -> (S::M, S::F, S::F) {
        let [gu, gv, gw] = gradient;
        let squared = self.metric.squared(s, gradient);
        let exists = s.lt(s.splat(self.vanishing), squared);
        let inverse = s.select(exists, s.rsqrt(squared), s.splat(0.0));
        let n_v = s.mul(s.add(s.add(s.mul(gu, to_eye[0]), s.mul(gv, to_eye[1])), s.mul(gw, to_eye[2])), inverse);
        (exists, inverse, n_v)
    }

    /// Sums the terms of all lights. The first light is multiplied by a share, where one is given.
    #[inline(always)]
    fn sum_lights<S: Wide>(
        &self,
        s: S,
        rgb: [S::F; 3],
        gradient: [S::F; 3],
        to_eye: [S::F; 3],
        normal: (S::M, S::F, S::F),
        first: Option<S::F>,
    ) -> [S::F; 3] {
        let mut lit = [s.splat(self.ambient); 3];
        let mut highlight = [s.splat(0.0); 3];
        for (k, light) in self.lights.iter().enumerate() {
            let (mut diffuse, mut specular) = self.terms(s, light, gradient, to_eye, normal);
            if let Some(share) = first.filter(|_| k == 0) {
                (diffuse, specular) = (s.mul(diffuse, share), s.mul(specular, share));
            }
            for c in 0..3 {
                lit[c] = s.add_mul(lit[c], diffuse, s.splat(light.rgb[c]));
                highlight[c] = s.add_mul(highlight[c], specular, s.splat(light.rgb[c]));
            }
        }
        let mut shaded = rgb;
        for c in 0..3 {
            shaded[c] = s.add(s.mul(rgb[c], lit[c]), highlight[c]);
        }
        shaded
    }
}

impl Shader {
    /// Diffuse and specular term of a light.
    #[inline(always)]
    fn terms<S: Wide>(
        &self,
        s: S,
        light: &WorldLight,
        gradient: [S::F; 3],
        to_eye: [S::F; 3],
        (exists, inverse, n_v): (S::M, S::F, S::F),
    ) -> (S::F, S::F) {
        let unoriented = s.splat(self.unoriented);
        if light.is_at_eye {
            let diffuse = s.mul(s.splat(self.diffuse), s.select(exists, s.abs(n_v), unoriented));
            let reflected = s.sub(s.mul(s.mul(s.splat(2.0), n_v), n_v), s.splat(1.0));
            let reflected = s.max(reflected, s.splat(0.0));
            return (diffuse, s.mul(s.splat(self.specular), raise(s, reflected, self.specular_power)));
        }
        let n_l = s.mul(dot(s, light.on_gradient, gradient), inverse);
        let l_v = dot(s, light.on_view, to_eye);
        let diffuse = s.mul(s.splat(self.diffuse), s.select(exists, s.abs(n_l), unoriented));
        let reflected = s.sub(s.mul(s.mul(s.splat(2.0), n_l), n_v), l_v);
        // Without a normal there is no reflection: r·v would be −l·v.
        let reflected = s.select(exists, s.max(reflected, s.splat(0.0)), s.splat(0.0));
        (diffuse, s.mul(s.splat(self.specular), raise(s, reflected, self.specular_power)))
    }
}

#[inline(always)]
fn dot<S: Wide>(s: S, form: [f32; 3], x: [S::F; 3]) -> S::F {
    s.add(s.add(s.mul(s.splat(form[0]), x[0]), s.mul(s.splat(form[1]), x[1])), s.mul(s.splat(form[2]), x[2]))
}

/// Raises numbers to a power: by repeated squaring if it is a whole number, else by the library.
#[inline(always)]
fn raise<S: Wide>(s: S, mut x: S::F, power: f32) -> S::F {
    if power.fract() != 0.0 {
        let [mut first, mut second] = [[0.0; LANES]; 2];
        let parts = s.part(x);
        s.one().store(parts[0], &mut first);
        s.one().store(parts[1], &mut second);
        let powers = [first.map(|x| x.powf(power)), second.map(|x| x.powf(power))];
        return s.join(s.one().load(&powers[0]), s.one().load(&powers[1]));
    }
    // From the lowest bit that is set; the square after the highest is not needed.
    let mut remaining = power as u32;
    while remaining & 1 == 0 {
        remaining >>= 1;
        x = s.mul(x, x);
    }
    let mut result = x;
    while remaining > 1 {
        remaining >>= 1;
        x = s.mul(x, x);
        if remaining & 1 == 1 {
            result = s.mul(result, x);
        }
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use wavesplat_compute::simd::Plain;
    use wavesplat_core::Light;
    use wavesplat_core::LightFrame;

    fn shade_one(shading: &Shading, gradient: [f32; 3], to_eye: [f32; 3]) -> [f32; 3] {
        let projection = Projection::Orthographic { parallel_scale: 1.0 };
        let camera = Camera::new(DVec3::new(0.0, 0.0, 5.0), DVec3::ZERO, DVec3::Y, projection).unwrap();
        let family = Family::of(camera.forward());
        let shader = Shader::new(shading, &camera, DMat3::IDENTITY, &family, [0.0, 255.0]);
        let all = |x: [f32; 3]| x.map(|x| [x; LANES]);
        shader.shade(Plain, all([0.5; 3]), all(gradient), all(to_eye)).map(|c| c[0])
    }

    #[test]
    fn phong_at_known_angles() {
        let shading = Shading::headlight();
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
            assert_eq!(shade_one(&Shading::headlight(), gradient, [0.0, 0.0, 1.0]), [0.05; 3]);
        }
    }

    #[test]
    fn matter_without_a_gradient_has_a_share_of_the_light_of_a_face() {
        let even = Shading { unoriented: 0.5, lights: vec![Light::KEY, Light::FILL], ..Shading::headlight() };
        let got = shade_one(&even, [0.0; 3], [0.0, 0.0, 1.0]);
        assert!((got[0] - 0.5 * (0.1 + 0.7 * 0.5 * 1.3)).abs() < 1e-6, "{got:?}");
        let coloured = Light { rgb: [1.0, 0.5, 0.0], ..Light::KEY };
        let got = shade_one(&Shading { lights: vec![coloured], ..even }, [0.0; 3], [0.0, 0.0, 1.0]);
        assert!((got[1] - 0.5 * (0.1 + 0.7 * 0.5 * 0.5)).abs() < 1e-6 && (got[2] - 0.05).abs() < 1e-6, "{got:?}");
    }

    #[test]
    fn world_lights_have_their_colour_and_powers_may_be_fractions() {
        let light = Light { frame: LightFrame::World, to_light: DVec3::new(2.0, 0.0, 0.0), rgb: [1.0, 0.5, 0.0] };
        let shading = Shading { lights: vec![light], specular_power: 2.5, ..Shading::headlight() };
        let got = shade_one(&shading, [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
        for (got, want) in got.iter().zip([0.4, 0.225, 0.05]) {
            assert!((got - want).abs() < 1e-6, "{got} for {want}");
        }
    }
}
