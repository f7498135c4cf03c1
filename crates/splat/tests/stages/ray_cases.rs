//! The fixtures of the operators along rays, with the answers of the formulas.

use crate::cases::{ENTRY, FORMULAS, Random, TOLERANCE, curves, with_curves};
use crate::fixture::{Case, Fixture};
use crate::formulas::{self, Light};

const N_RAYS: usize = 16;
const N_SHEETS: usize = 6;

/// Densities[sheet][ray] at s = 0, 1, 2, ..., smooth enough to be thin here and opaque there.
fn ray_densities(random: &mut Random) -> Vec<f64> {
    let mut densities: Vec<f64> = random.many(N_SHEETS * N_RAYS).iter().map(|x| (x * 256.0).floor()).collect();
    // Nothing at all; a plateau; the whole range.
    (0..N_SHEETS).for_each(|k| densities[k * N_RAYS] = 8.0);
    (0..N_SHEETS).for_each(|k| densities[k * N_RAYS + 1] = [40.0, 100.0, 100.0, 100.0, 40.0, 20.0][k]);
    (0..N_SHEETS).for_each(|k| densities[k * N_RAYS + 2] = [0.0, 255.0, 0.0, 255.0, 0.0, 255.0][k]);
    densities
}

fn of_ray(densities: &[f64], ray: usize) -> Vec<f64> {
    densities.iter().skip(ray).step_by(N_RAYS).copied().collect()
}

/// Whole rays, rays that begin and end between sheets, and slices wider apart.
const RAYS: [(&str, [f64; 2], f64); 3] = [
    ("whole rays", [0.0, 5.0], 1.0),
    ("from s = 0.75 to 3.25", [0.75, 3.25], 1.0),
    ("slices 2.5 apart", [0.0, 5.0], 2.5),
];

fn rays_case(name: String, densities: &[f64], interval: [f64; 2], length_per_s: f64) -> Case {
    Case::new(name)
        .with_array("interval", interval)
        .with("length_per_s", length_per_s)
        .with_array("density", densities.iter().copied())
}

pub fn over() -> Fixture {
    let mut random = Random(31);
    let mut cases = Vec::new();
    for (curves_name, curves) in curves() {
        for (rays, interval, per_s) in RAYS {
            for is_preintegrated in [false, true] {
                let densities = ray_densities(&mut random);
                let light = |ray: usize| -> Light {
                    let densities = of_ray(&densities, ray);
                    if is_preintegrated {
                        formulas::over_segments(&curves, &densities, interval, per_s, 0.25 * ENTRY)
                    } else {
                        formulas::over(&curves, &densities, interval, per_s)
                    }
                };
                let lights: Vec<Light> = (0..N_RAYS).map(light).collect();
                let kind = if is_preintegrated { "pre-integrated" } else { "sheets" };
                let case = rays_case(format!("{curves_name}, {rays}, {kind}"), &densities, interval, per_s);
                let channel = |c: usize| lights.iter().map(|light| light.rgba[c]).collect::<Vec<_>>();
                let case = with_curves(case, &curves)
                    .with("pre_integrated", f64::from(u8::from(is_preintegrated)))
                    .answer("r", channel(0))
                    .answer("g", channel(1))
                    .answer("b", channel(2))
                    .answer("a", channel(3))
                    .answer("s_half", lights.iter().map(|light| light.s_half));
                cases.push(case);
            }
        }
    }
    Fixture {
        stage: "over",
        what: "Emission and absorption, front to back, without early ray termination. Sixteen rays through sheets at s = 0, \
               1, 2, ... with density[sheet][ray]; interval, the part of s that is drawn; length_per_s, length along a ray \
               per s. Associated colour and opacity, and s of opacity 1/2, null where it is not reached. Each sheet stands \
               for what is nearer to it than to others; pre_integrated: densities are linear from sheet to sheet, the \
               colour belongs to the place where the light comes from on the mean. The transfer function is as in \
               classify.",
        made_from: FORMULAS,
        // Tolerance of a position: rounding of opacities near 1/2, divided by the opacity that is gathered there.
        tolerance: [1e-5, 4e-5],
        exact: &[],
        cases,
    }
}

/// Density that dims most, and optical depth per length there, of attenuated maxima.
const WHITE: f64 = 208.0;
const ATTENUATION: f64 = 0.25;

pub fn project() -> Fixture {
    let mut random = Random(41);
    let mut cases = Vec::new();
    for operator in ["maximum", "minimum", "mean", "sum", "x-ray", "depth-shaded maximum", "attenuated maximum"] {
        for (rays, interval, per_s) in RAYS {
            let densities = ray_densities(&mut random);
            let (level, strength) = (if operator == "x-ray" { 96.0 } else { 16.0 }, 0.75);
            // Fades from the nearest point that is drawn to the farthest.
            let fade = |s: f64| 1.0 - strength * (s - interval[0]) / (interval[1] - interval[0]);
            let answers: Vec<[f64; 2]> = (0..N_RAYS)
                .map(|ray| {
                    let parts = formulas::drawn(&of_ray(&densities, ray), interval);
                    formulas::project(operator, &parts, per_s, [level, WHITE, ATTENUATION], fade)
                })
                .collect();
            let mut case =
                rays_case(format!("{operator}, {rays}"), &densities, interval, per_s).with_text("operator", operator);
            if ["x-ray", "depth-shaded maximum", "attenuated maximum"].contains(&operator) {
                case = case.with("level", level);
            }
            if operator == "depth-shaded maximum" {
                case = case.with("strength", strength);
            }
            if operator == "attenuated maximum" {
                case = case.with("white", WHITE).with("attenuation", ATTENUATION);
            }
            let case = case
                .answer("value", answers.iter().map(|answer| answer[0]))
                .answer("length", answers.iter().map(|answer| answer[1]));
            cases.push(case);
        }
    }
    Fixture {
        stage: "project",
        what: "Projections of sixteen rays through sheets at s = 0, 1, 2, ... with density[sheet][ray], linear in between; \
               interval, the part of s that is drawn; length_per_s, length along a ray per s. value: the extreme, or the \
               integral over the length: of the density (mean, sum), or of its excess over level (x-ray). Depth shading \
               multiplies the excess over level by 1 - strength (s - interval[0]) / (interval[1] - interval[0]) first, at the \
               ends of each space between two sheets. Attenuation multiplies it by exp(-attenuation I) instead, where I is the \
               integral over the length, so far, of what rises from 0 at level to 1 at white. length: of the way.",
        made_from: FORMULAS,
        tolerance: [1e-5, 1e-5],
        exact: &[],
        cases,
    }
}

pub fn first_hit() -> Fixture {
    let mut random = Random(53);
    let case = |(rays, interval, per_s): (&str, [f64; 2], f64)| {
        let (_, curves) = &curves()[0];
        let densities = ray_densities(&mut random);
        let iso = 100.5;
        let places: Vec<f64> =
            (0..N_RAYS).map(|ray| formulas::first_hit(&of_ray(&densities, ray), interval, iso)).collect();
        let channel =
            |c: usize| places.iter().map(|s| if s.is_nan() { 0.0 } else { curves.color(iso)[c] }).collect::<Vec<_>>();
        with_curves(rays_case(rays.to_owned(), &densities, interval, per_s), curves)
            .with("iso", iso)
            .answer("found", places.iter().map(|s| if s.is_nan() { 0.0 } else { 1.0 }))
            .answer("s_half", places.iter().copied())
            .answer("r", channel(0))
            .answer("g", channel(1))
            .answer("b", channel(2))
    };
    Fixture {
        stage: "first_hit",
        what: "The first place of sixteen rays, as in over, where the density crosses iso between two sheets, from either \
               side: s_half, null where there is none. The colour belongs to iso, without shading.",
        made_from: FORMULAS,
        tolerance: TOLERANCE,
        exact: &["found"],
        cases: RAYS.into_iter().map(case).collect(),
    }
}

pub fn local_maximum() -> Fixture {
    let mut random = Random(61);
    let case = |(rays, interval, per_s): (&str, [f64; 2], f64)| {
        let densities = ray_densities(&mut random);
        let threshold = 96.5;
        let answers: Vec<[f64; 2]> = (0..N_RAYS)
            .map(|ray| formulas::local_maximum(&formulas::drawn(&of_ray(&densities, ray), interval), threshold))
            .collect();
        rays_case(rays.to_owned(), &densities, interval, per_s)
            .with("threshold", threshold)
            .answer("value", answers.iter().map(|answer| answer[0]))
            .answer("found", answers.iter().map(|answer| answer[1]))
    };
    Fixture {
        stage: "local_maximum",
        what: "The first local maximum of at least threshold of sixteen rays, as in project: the largest density before the \
               first that falls below it by more than 1e-6 of it, looked for at the ends of each space between two sheets. \
               found: whether there is one; else the value is the largest density.",
        made_from: FORMULAS,
        tolerance: TOLERANCE,
        exact: &["found"],
        cases: RAYS.into_iter().map(case).collect(),
    }
}
