//! Level of detail: brightness of a coarser level beside the finest, and the factors that make them equal.
//!
//! [`ProbeRays`] have the values along rays through both levels, and the angle of the gradients to the rays. Classified
//! by a table per level and lit with Phong shading, the mean brightness of a ray is
//!
//! `B = Σ T α (c (ambient + diffuse |n·l|) + specular max(0, 2 (n·l) (n·v) − l·v)^power)`,
//!
//! with `T` the transmittance so far and `c` the mean of red, green and blue; `|n·l|` and the highlight are means over
//! all normals at the gradient's angle to the eye, since only that angle is known. The ratio of the two means is the
//! change of brightness by the level, occlusion along the rays included. The secant method finds the factor of the
//! coarse function's extinction that makes the means equal.

use glam::DVec3;
use wavesplat_compute::parallel;
use wavesplat_core::{Light, LightFrame, Shading};

use crate::probe_rays::{N_COSINES, ProbeRay, ProbeRays, step_lengths};

/// Largest factor of the extinction; the least is its reciprocal.
const MAX_FACTOR: f64 = 20.0;

/// Factor from which on a level may still be too dark; this share of the brightness is then bright enough.
const SUSPECT_FACTOR: f64 = 0.9 * MAX_FACTOR;
const BRIGHT_ENOUGH: f64 = 0.93;

/// Largest change of the unshaded brightness, up or down, that is accepted to match the shaded one: more matter without
/// gradients cannot make up for lost gradients.
const MAX_UNLIT_CHANGE: f64 = 1.25;

/// Largest factor of colours where more extinction does not help: opaque parts have lost highlights on their edges,
/// which are rounder on a level. More would change the hue of colours with a channel at 1.
const MAX_COLOR_GAIN: f64 = 1.02;

/// End of the search: tolerance of the difference of the logarithms of the brightnesses, and largest number of steps.
const TOLERANCE: f64 = 2e-3;
const N_STEPS: usize = 12;

/// Rays per task.
const RAYS_PER_TASK: usize = 64;

/// Transmittance below which a ray ends (early ray termination).
const MIN_TRANSMITTANCE: f32 = 1e-4;

/// Mean of red, green and blue, and opacity, of each bin of values.
pub(crate) type GrayTable = Vec<[f64; 2]>;

impl ProbeRays {
    /// Factors of the extinction and of the colours of the coarse table, the second near 1, that make the level as
    /// bright as the finest. `lengths`: sample spacing along each axis, in opacity units. Without shading the factor of
    /// the colours is 1. `needs_preintegration`: whether the level gets the sheets of a steep function.
    pub fn brightness_factors(
        &self,
        [fine, coarse]: [&GrayTable; 2],
        shading: Option<&Shading>,
        lengths: [f64; 3],
        needs_preintegration: bool,
    ) -> [f64; 2] {
        let (lit, unlit) = (phong_table(shading), phong_table(None));
        let wanted_lit = self.brightness(0, fine, &lit, lengths);
        let mut factor = self.factor_for(wanted_lit, coarse, needs_preintegration, &lit, lengths);
        if shading.is_none() {
            return [factor, 1.0];
        }
        let coarse_brightness = |factor: f64, light: &[[f64; 2]]| {
            self.brightness(coarse_sheets(needs_preintegration), coarse, light, lengths.map(|length| factor * length))
        };
        let (wanted, got) = (self.brightness(0, fine, &unlit, lengths), coarse_brightness(factor, &unlit));
        let bounded = got.clamp(wanted / MAX_UNLIT_CHANGE, wanted * MAX_UNLIT_CHANGE);
        if got != bounded {
            factor = self.factor_for(bounded, coarse, needs_preintegration, &unlit, lengths);
        }
        let is_out_of_reach = got != bounded || factor >= SUSPECT_FACTOR;
        let gain = if is_out_of_reach { wanted_lit / coarse_brightness(factor, &lit) } else { 1.0 };
        [factor, if gain > 1.0 { gain.min(MAX_COLOR_GAIN) } else { 1.0 }]
    }

    /// Whether the factor that [`ProbeRays::brightness_factors`] found makes the coarse table nearly as bright as the
    /// fine one, or brighter, without shading. `lengths`: as there.
    pub fn is_nearly_as_bright(
        &self,
        [fine, coarse]: [&GrayTable; 2],
        factor: f64,
        lengths: [f64; 3],
        needs_preintegration: bool,
    ) -> bool {
        if factor < SUSPECT_FACTOR {
            return true;
        }
        let unlit = phong_table(None);
        let wanted = self.brightness(0, fine, &unlit, lengths);
        self.brightness(coarse_sheets(needs_preintegration), coarse, &unlit, lengths.map(|length| factor * length))
            >= BRIGHT_ENOUGH * wanted
    }

    /// Factor of the extinction that gives the coarse table the brightness `wanted`.
    fn factor_for(
        &self,
        wanted: f64,
        coarse: &GrayTable,
        needs_preintegration: bool,
        light: &[[f64; 2]],
        lengths: [f64; 3],
    ) -> f64 {
        if wanted <= 0.0 {
            return 1.0;
        }
        // Bracket, estimate and last error of the logarithm of the factor.
        let [mut lo, mut hi] = [-MAX_FACTOR.ln(), MAX_FACTOR.ln()];
        let (mut at, mut before) = (0.0, None);
        for _ in 0..N_STEPS {
            let brightness = self.brightness(
                coarse_sheets(needs_preintegration),
                coarse,
                light,
                lengths.map(|length| f64::exp(at) * length),
            );
            let excess = (brightness / wanted).ln();
            if excess.abs() < TOLERANCE {
                break;
            }
            if excess < 0.0 {
                lo = at;
            } else {
                hi = at;
            }
            // The first slope is 1, which a thin medium has: its brightness is proportional to its extinction.
            let slope = before.map_or(1.0, |(x, y): (f64, f64)| (excess - y) / (at - x));
            before = Some((at, excess));
            let next = at - excess / slope;
            at = if lo < next && next < hi { next } else { 0.5 * (lo + hi) };
        }
        at.exp()
    }

    /// Mean brightness of the rays. `which`: index of the sheets, as in [`step_lengths`]; `lengths`: sample spacing
    /// along each axis.
    fn brightness(&self, which: usize, table: &GrayTable, light: &[[f64; 2]], lengths: [f64; 3]) -> f64 {
        let lengths = step_lengths(which, lengths);
        // Emitted light and transmittance of each probe entry.
        let of_axis = lengths.map(|length| -> Vec<[f32; 2]> {
            let entries = table.iter().flat_map(|&[color, opacity]| {
                let alpha = -(length * (-opacity).ln_1p()).exp_m1();
                light
                    .iter()
                    .map(move |[matte, gloss]| [alpha * (color * matte + gloss), 1.0 - alpha].map(|entry| entry as f32))
            });
            entries.collect()
        });
        let of_ray = |ray: &ProbeRay| {
            let of_entry = &of_axis[ray.axis];
            let (mut sum, mut transmittance) = (0.0_f32, 1.0_f32);
            for entry in &ray.entries[which] {
                let [emitted, passed] = of_entry[usize::from(*entry)];
                sum += transmittance * emitted;
                transmittance *= passed;
                if transmittance < MIN_TRANSMITTANCE {
                    break;
                }
            }
            f64::from(sum)
        };
        let sums = parallel::map(self.0.len().div_ceil(RAYS_PER_TASK), |task| {
            let rays = self.0[task * RAYS_PER_TASK..].iter().take(RAYS_PER_TASK);
            rays.map(of_ray).sum::<f64>()
        });
        sums.into_iter().sum::<f64>() / self.0.len() as f64
    }
}

/// Index of the sheets that a level gets, as in [`step_lengths`].
fn coarse_sheets(needs_preintegration: bool) -> usize {
    1 + usize::from(needs_preintegration)
}

/// Phong shading by step of `|n·v|`: factor of the colour, and highlight, as means over the normals at that angle to
/// the eye. The last entry is for points without a gradient. World lights are taken to be at the eye, since levels do
/// not know the camera.
fn phong_table(shading: Option<&Shading>) -> Vec<[f64; 2]> {
    let Some(shading) = shading else { return vec![[1.0, 0.0]; N_COSINES + 1] };
    let Shading { ambient, diffuse, specular, specular_power, unoriented, .. } = *shading;
    let [ambient, diffuse, specular, power] = [ambient, diffuse, specular, specular_power].map(f64::from);
    let lights: Vec<(DVec3, f64)> = shading.lights.iter().map(of_light).collect();
    let lit = |step: usize| {
        let cosine = (step as f64 + 0.5) / N_COSINES as f64;
        let sine = (1.0 - cosine * cosine).sqrt();
        let mut sums = [0.0; 2];
        for turn in 0..N_TURNS {
            let (s, c) = ((turn as f64 + 0.5) * std::f64::consts::TAU / N_TURNS as f64).sin_cos();
            let normal = DVec3::new(sine * c, sine * s, cosine);
            for (to_light, brightness) in &lights {
                let n_l = normal.dot(*to_light);
                sums[0] += brightness * n_l.abs();
                sums[1] += brightness * (2.0 * n_l * cosine - to_light.z).max(0.0).powf(power);
            }
        }
        [ambient + diffuse * sums[0] / N_TURNS as f64, specular * sums[1] / N_TURNS as f64]
    };
    let even = lights.iter().map(|(_, brightness)| brightness).sum::<f64>() * f64::from(unoriented);
    (0..N_COSINES).map(lit).chain([[ambient + diffuse * even, 0.0]]).collect()
}

/// Number of normals that sample an angle to the eye.
const N_TURNS: usize = 12;

/// Unit direction to a light in the camera's frame, and the mean of its colours.
fn of_light(light: &Light) -> (DVec3, f64) {
    let to_light = match light.frame {
        LightFrame::Camera => light.to_light.normalize(),
        LightFrame::World => DVec3::Z,
    };
    (to_light, light.rgb.iter().map(|c| f64::from(*c)).sum::<f64>() / 3.0)
}
