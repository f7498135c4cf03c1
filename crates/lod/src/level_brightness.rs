//! Level of detail: brightness of a coarser level beside the finest, and the factors that make them equal.
//!
//! [`ProbeRays`] know the values that they meet in both, and how the gradients stand to them. Classified by a table
//! each and lit with Phong shading, the mean brightness of a ray is
//!
//! `B = Σ T α (c (ambient + diffuse |n·l|) + specular max(0, 2 (n·l) (n·v) − l·v)^power)`,
//!
//! `|n·l|` and the highlight as means over the normals that stand to the eye as the gradient does, since only that is
//! known; `T` the transmittance so far, `c` the mean of red, green and blue. The two means tell how much the level changes the
//! brightness, whatever hides what. The factor of the coarse function's extinction that makes them equal is found by
//! the secant method.

use glam::DVec3;
use wavesplat_compute::parallel;
use wavesplat_core::{Light, LightFrame, Shading};

use crate::probe_rays::{N_COSINES, ProbeRay, ProbeRays, step_lengths};

/// Factors of the extinction: from one over this up to this.
const MAX_FACTOR: f64 = 20.0;

/// From this factor on a level may be darker all the same; it is bright enough with this share of the brightness.
const OUT_OF_REACH: f64 = 0.9 * MAX_FACTOR;
const BRIGHT_ENOUGH: f64 = 0.93;

/// How much brighter without shading, or darker, a level may get to be as bright with it: lost gradients cannot be made
/// up for by more of what has none.
const MAX_UNLIT_CHANGE: f64 = 1.25;

/// How much brighter colours may get where more extinction does not help: opaque parts have lost highlights on their
/// edges, which are rounder on a level. More would change the hue of colours that have a full channel.
const MAX_COLOR_GAIN: f64 = 1.02;

/// The search ends when the logarithms of the brightnesses differ by less, or after so many steps.
const TOLERANCE: f64 = 2e-3;
const N_STEPS: usize = 12;

/// Rays that are followed by one task.
const RAYS_PER_TASK: usize = 64;

/// Transmittance below which the rest of a ray does not count (early ray termination).
const MIN_TRANSMITTANCE: f32 = 1e-4;

/// Mean of red, green and blue, and opacity, in each bin of values.
pub(crate) type GrayTable = Vec<[f64; 2]>;

impl ProbeRays {
    /// Factors of the extinction and of the colours of the coarse table, the second near 1, that make the level as
    /// bright as the finest. `lengths`: from sample to sample along each axis, in units of the opacities. Without
    /// shading, colours are as they are. `needs_preintegration`: whether the level gets the sheets of a steep function.
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
        let is_out_of_reach = got != bounded || factor >= OUT_OF_REACH;
        let gain = if is_out_of_reach { wanted_lit / coarse_brightness(factor, &lit) } else { 1.0 };
        [factor, if gain > 1.0 { gain.min(MAX_COLOR_GAIN) } else { 1.0 }]
    }

    /// Whether the factor that [`ProbeRays::brightness_factors`] found makes the coarse table about as bright, without
    /// shading.
    pub fn is_bright_enough(
        &self,
        [fine, coarse]: [&GrayTable; 2],
        factor: f64,
        lengths: [f64; 3],
        needs_preintegration: bool,
    ) -> bool {
        if factor < OUT_OF_REACH {
            return true;
        }
        let unlit = phong_table(None);
        let wanted = self.brightness(0, fine, &unlit, lengths);
        self.brightness(coarse_sheets(needs_preintegration), coarse, &unlit, lengths.map(|length| factor * length))
            >= BRIGHT_ENOUGH * wanted
    }

    /// The factor that makes the coarse table as bright as is wanted.
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
            // At first as of a thin medium, whose brightness is proportional to its extinction.
            let slope = before.map_or(1.0, |(x, y): (f64, f64)| (excess - y) / (at - x));
            before = Some((at, excess));
            let next = at - excess / slope;
            at = if lo < next && next < hi { next } else { 0.5 * (lo + hi) };
        }
        at.exp()
    }

    /// Mean brightness of the rays; `which` of the sheets, as in [`step_lengths`]. `lengths`: from sample to sample
    /// along each axis.
    fn brightness(&self, which: usize, table: &GrayTable, light: &[[f64; 2]], lengths: [f64; 3]) -> f64 {
        let lengths = step_lengths(which, lengths);
        // By entry: emitted light, and transmittance.
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

/// Which sheets a level gets, as in [`step_lengths`].
fn coarse_sheets(needs_preintegration: bool) -> usize {
    1 + usize::from(needs_preintegration)
}

/// Phong shading by step of `|n·v|`: factor of the colour, and highlight, as means over the normals at that angle to the
/// eye. The last entry has no gradient. Lights of the world are taken to be at the eye, since levels do not know the camera.
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

/// Normals at an angle to the eye.
const N_TURNS: usize = 12;

/// Unit direction to a light in the camera's frame, and the mean of its colours.
fn of_light(light: &Light) -> (DVec3, f64) {
    let to_light = match light.frame {
        LightFrame::Camera => light.to_light.normalize(),
        LightFrame::World => DVec3::Z,
    };
    (to_light, light.rgb.iter().map(|c| f64::from(*c)).sum::<f64>() / 3.0)
}
