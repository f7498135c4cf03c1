//! Light on shapes: the scene's lights by the formula of [`crate::optics::shade`], on both sides of a surface, dimmed
//! by the matter around it ([`crate::optics::occlusion`]).

use glam::{DVec3, Vec3};
use wavesplat_core::{Camera, Shading};

use crate::optics::occlusion::LightFields;
use crate::source::field::Field;
use crate::view::common_grid::{IndexMap, to_layer};

/// Lights and coefficients, in world space.
pub struct ShapeLight<'a> {
    ambient: f32,
    diffuse: f32,
    specular: f32,
    power: f32,
    /// Unit directions to the lights, and their colours.
    lights: Vec<(Vec3, [f32; 3])>,
    fields: &'a [Field<'static>],
    /// Fields that hold light, and the map to the grid that they lie on.
    occlusion: Option<(LightFields, IndexMap)>,
}

impl<'a> ShapeLight<'a> {
    /// The lights of a shading. `fields`: all fields of the plan; `occlusion`: the fields among them that hold light,
    /// and the map from the frame's index space to the first layer's.
    pub fn new(
        shading: &Shading,
        camera: &Camera,
        fields: &'a [Field<'static>],
        occlusion: Option<(LightFields, IndexMap)>,
    ) -> Self {
        let light = |light| crate::view::index_frame::light_direction(camera, light).as_vec3();
        Self {
            ambient: shading.ambient,
            diffuse: shading.diffuse,
            specular: shading.specular,
            power: shading.specular_power,
            lights: shading.lights.iter().map(|own| (light(own), own.rgb)).collect(),
            fields,
            occlusion,
        }
    }

    /// A colour as lit. `normal` and `to_eye`: of any length but 0; `index`: position in the index space of the frame.
    pub fn shade(&self, rgb: [f32; 3], normal: Vec3, to_eye: Vec3, index: DVec3) -> [f32; 3] {
        let (normal, to_eye) = (normal.normalize_or_zero(), to_eye.normalize_or_zero());
        let [open, first] = self.openness(index);
        let mut lit = rgb.map(|c| c * self.ambient);
        let n_v = normal.dot(to_eye);
        for (k, (to_light, color)) in self.lights.iter().enumerate() {
            let n_l = normal.dot(*to_light);
            let reflected = (2.0 * n_l * n_v - to_light.dot(to_eye)).max(0.0);
            let highlight = self.specular * raised(reflected, self.power);
            let share = if k == 0 { first } else { 1.0 };
            for c in 0..3 {
                lit[c] += share * color[c] * (rgb[c] * self.diffuse * n_l.abs() + highlight);
            }
        }
        lit.map(|c| c * open)
    }

    /// Factors of all light and of the first light at an index position.
    fn openness(&self, index: DVec3) -> [f32; 2] {
        let Some((LightFields { openness, shadow }, map)) = self.occlusion else { return [1.0; 2] };
        let index = to_layer(&map, index);
        [openness, shadow].map(|term| {
            let Some((field, strength)) = term else { return 1.0 };
            (1.0 - strength * (1.0 - value_at(&self.fields[field], index))).max(0.0)
        })
    }
}

/// Value of a field at an index position of the first layer, linear between its samples; beyond them the nearest
/// sample.
fn value_at(field: &Field, index: DVec3) -> f32 {
    let size = field.slices.grid().size();
    let place = [0, 1, 2].map(|a| {
        let (from, per) = field.from_index[a];
        let at = (from + per * index[a]).clamp(0.0, (size[a] - 1) as f64);
        let first = (at as usize).min(size[a].saturating_sub(2));
        (first, at - first as f64)
    });
    let mut sum = 0.0;
    for corner in 0..8 {
        let mut weight = 1.0;
        let at = [0, 1, 2].map(|a| {
            let (first, share) = place[a];
            let is_next = corner >> a & 1;
            weight *= if is_next == 1 { share } else { 1.0 - share };
            (first + is_next).min(size[a] - 1)
        });
        if weight > 0.0 {
            sum += weight * field.slices.at(at);
        }
    }
    sum as f32
}

/// `base` to a power: by repeated squaring for whole numbers, which gives the same bits on every machine.
fn raised(base: f32, power: f32) -> f32 {
    if power.fract() != 0.0 {
        return base.powf(power);
    }
    let (mut result, mut factor, mut rest) = (1.0, base, power as u32);
    while rest > 0 {
        if rest & 1 == 1 {
            result *= factor;
        }
        factor *= factor;
        rest >>= 1;
    }
    result
}
